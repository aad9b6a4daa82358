/* operator.h - the matrix of the pressures that are implicit in time (implicit.c), as a product
 * with `direction`. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/water/system.h"

/* The matrix's diagonal at cell k of block g, an unknown that this rank counts, m3/Pa. */
double mpsi_pore_diagonal_of(const mps_mpm *mpm, const mpsi_pore_system *s, int64_t g, int k,
                             const int *shift);
/* Velocities of the nodes of block g, per dt, under the pressures `direction` alone. */
void mpsi_pore_find_velocities(mps_mpm *mpm, mpsi_pore_system *s, int64_t g, double factor);
/* Velocities of nodes, per dt, under the pressures `direction`, as contacts let them (contacts.h).
 * Collective. */
mps_status mpsi_pore_find_motion(mps_mpm *mpm, const char *function);
/* G^T v of cell k of block g, m3/s. */
double mpsi_pore_squeeze_of(const mps_mpm *mpm, const mpsi_pore_system *s, int64_t g, int k,
                            const int *shift);
/* `product`: the matrix times `direction`; `*along`: their product. Collective. */
mps_status mpsi_pore_apply(mps_mpm *mpm, const char *function, double *along);
