/* outside.h - a solver of the caller for the pressures that are implicit in time
 * (mps/pore_solver.h). SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_WATER_SOLVE_OUTSIDE_H
#define MPSI_MPM_WATER_SOLVE_OUTSIDE_H

#include "mpm/water/system.h"

#include <mps/pore_solver.h>

struct mpsi_pore_outside {
  mps_pore_solver_def def;
  int64_t all, first, rows; /* of all ranks; this rank's */
  int64_t *start;
  int32_t *column;
  double *value, *right, *solution;
  mpsi_room start_room, column_room, value_room, vector_room;
};

/* Whether the present equation is the caller's to solve. */
bool mpsi_pore_solved_outside(const mpsi_water *water);
/* The solution of the caller's solver to `direction`, from `residual` and `inverse`; a residual of
 * at most `tolerance` is asked for. Collective. */
mps_status mpsi_pore_solve_outside(mps_mpm *mpm, const char *function, double tolerance);
/* Lets the caller's solver discard its data of former equations. */
mps_status mpsi_pore_forget(mps_mpm *mpm, const char *function);
void mpsi_pore_drop_solver(mps_context *context, mpsi_water *water); /* accepts that it has none */

#endif
