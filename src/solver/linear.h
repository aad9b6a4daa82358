/* linear.h - the caller's linear solver (mps/experimental/linear_solver.h): its calls, the checks
 * of what they return, and the agreement of ranks. A solver assembles its rows and computes
 * residuals by its own operator:
 *
 *   if (mpsi_linear_serves(&s->base, rows)) {
 *     if (the matrix has changed) status = mpsi_linear_hand(&s->base, function, &matrix);
 *     status = mpsi_linear_solve(&s->base, function, tolerance, b, x);
 *     status = mpsi_linear_check(&s->base, function, tolerance, 0.0, rr, bb);
 *   }
 *
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/room.h"
#include "solver_base.h"

#include <mps/experimental/linear_solver.h>

struct mpsi_linear {
  mps_linear_solver_def def;
  bool valid;       /* the callbacks have the present matrix; a solver that keeps its matrix resets
                       it when that changes */
  bool known;       /* `pattern` is that of the last matrix */
  uint64_t pattern; /* hash of sizes, starts and columns */
  int64_t first, rows;
  mpsi_room x; /* the solution, and entries behind it that must stay */
  mps_linear_result result;
};

/* Whether an equation of so many rows, of all ranks, is the caller's to solve. */
bool mpsi_linear_serves(const mps_solver *solver, int64_t rows);
/* The following are collective, with a status that ranks have agreed on. Members of `matrix` that
 * the call sets: struct_size, change. */
mps_status mpsi_linear_hand(mps_solver *solver, const char *function, mps_linear_matrix *matrix);
/* This rank's rows of b and x, which is the start; on an error x is unchanged. */
mps_status mpsi_linear_solve(mps_solver *solver, const char *function, double tolerance,
                             const double *b, double *x);
/* Whether the solution is one: rr and bb are |b - A x|^2 and |b|^2 of all ranks; `rounding`: that
 * part of |b| may be rounding. */
mps_status mpsi_linear_check(mps_solver *solver, const char *function, double tolerance,
                             double rounding, double rr, double bb);
/* Lets it discard data of former equations. This rank's status. */
mps_status mpsi_linear_forget(mps_solver *solver, const char *function);
void mpsi_linear_drop(mps_solver *solver); /* accepts that there is none */
