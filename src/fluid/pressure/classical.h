/* classical.h - the classical scheme's own parts.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* The classical scheme, see classical.c; gamma 0: the library's own. */
typedef struct mpsi_fluid_classical {
  double gamma, n0, n_wide, lambda; /* sums over the lattice; lambda: mean of r^2, m2 */
} mpsi_fluid_classical;

mps_status mpsi_fluid_classical_look(mps_fluid *fluid, const char *function, mps_status status);
void mpsi_fluid_classical_rows(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_classical_solution(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_classical_accelerate(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
