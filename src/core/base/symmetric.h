/* symmetric.h - symmetric tensors in space: the order of their components, principal values.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

/* Component k of a stress or strain is (row[k], column[k]): xx, yy, zz, xy, zx, yz; in 2D the first
 * four. */
extern const int mpsi_symmetric_row[6], mpsi_symmetric_column[6];

/* Principal values of a symmetric matrix, in no order, by Jacobi's rotations: directions orthogonal
 * to the last bits also where values coincide. Column k of `axis` (may be NULL) is the direction of
 * value[k]. Of a matrix with NaN: NaN. */
void mpsi_symmetric_principal(const double (*matrix)[3], double *value, double (*axis)[3]);
