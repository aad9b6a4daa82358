/* outside.h - the equation of pressures that are implicit in time for a linear solver of the
 * caller. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/water/system.h"

/* Memory of this rank's rows. */
struct mpsi_pore_outside {
  int64_t all, first, rows; /* of all ranks; this rank's */
  int64_t *start;
  int32_t *column;
  double *value, *right, *solution;
  mpsi_room start_room, column_room, value_room, vector_room;
};

/* Whether the present equation is the caller's to solve. */
bool mpsi_pore_solved_outside(const mps_mpm *mpm);
/* The solution of the caller's solver to `direction`, from `residual` and `inverse`; a residual of
 * at most `tolerance` is asked for. Collective. */
mps_status mpsi_pore_solve_outside(mps_mpm *mpm, const char *function, double tolerance);
void mpsi_pore_free_outside(mps_context *context, mpsi_pore_outside *outside);
