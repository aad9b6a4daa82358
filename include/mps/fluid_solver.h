/* mps/fluid_solver.h - another solver of the fluid's pressure equation in place of the library's
 * own: an algebraic multigrid for large fluids, a direct solver to check with.
 *
 * Each step has one equation A x = b, symmetric and positive definite, with one row a particle in
 * the present order of the set and about 33 entries a row; x is the reduced pressure. The matrix
 * changes at every step, as the neighbours do. The library's own solver (conjugate gradients with
 * an incomplete factor, deflated by a coarse space from 5000 particles on) takes a number of
 * iterations that hardly grows with the number of particles (docs/fluid.md).
 *
 * Thread rule: as mps/fluid.h; the callbacks are called by the thread that steps, outside of the
 * context's executor.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_SOLVER_H
#define LIBMPS_FLUID_SOLVER_H

#include "fluid.h"

MPS_EXTERN_C_BEGIN

/** A, by rows: row i has the columns column[start[i]] to column[start[i + 1] - 1], ascending, with
 *  the diagonal and both halves; `rows` + 1 starts, start[0] is 0. A particle apart from the rest
 *  has a row of its diagonal alone, 1. The arrays are valid and unchanged until the next call. */
typedef mps_status (*mps_fluid_matrix_fn)(void *user, int64_t rows, const int64_t *start,
                                          const int32_t *column, const double *value);

/** Solves A x = b with the last matrix. `x` (`rows` values) holds a good start and receives the
 *  solution: |b - A x| <= `tolerance` |b|, which the library checks. `iterations` (0 at the call)
 *  may be set, for the report. Called once a step, and in a step in parts once for every
 *  mps_fluid_solve_pressure. */
typedef mps_status (*mps_fluid_solve_fn)(void *user, const double *b, double tolerance, double *x,
                                         int64_t *iterations);

/** A on the ranks of a domain (mps_fluid_def.domain): rows first to first + rows - 1 of `all`
 *  (`rows` may be 0), in the order of the ranks; otherwise as mps_fluid_matrix_fn.
 *  mps_fluid_solve_fn then has arrays of all rows, of which `b` and the start in `x` are set in
 *  this rank's; `x` receives the solution of all rows on every rank. Both are called on all ranks.
 *  */
typedef mps_status (*mps_fluid_rows_fn)(void *user, int64_t all, int64_t first, int64_t rows,
                                        const int64_t *start, const int32_t *column,
                                        const double *value);

/** Discards the solver's data of former equations (a preconditioner), so that later solutions
 *  depend on later equations alone. Snapshot, rollback, save and restore call it first: a run that
 *  continues after them has the bits of one that continues from the snapshot or the file. */
typedef mps_status (*mps_fluid_forget_fn)(void *user);

typedef struct mps_fluid_solver_def {
  uint32_t struct_size;
  int32_t reserved;
  void *user;                 /* passed to all; the caller's own */
  mps_fluid_matrix_fn matrix; /* no default */
  mps_fluid_solve_fn solve;   /* no default */
  int64_t least; /* least number of particles; a smaller fluid is solved by the library; >= 0;
                    default 0 */
  mps_fluid_forget_fn forget; /* default NULL: the solver has no such data */
  mps_fluid_rows_fn
      rows; /* in place of `matrix` on several ranks; default NULL: MPS_ERROR_UNSUPPORTED there */
} mps_fluid_solver_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_fluid_solver_def_init(mps_fluid_solver_def *def, size_t size);
static inline mps_fluid_solver_def mps_fluid_solver_defaults(void) {
  mps_fluid_solver_def def;
  memset(&def, 0, sizeof def);
  if (mps_fluid_solver_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Sets a solver, between steps; `def` NULL: the library's own. The callbacks may query the fluid,
 *  not step or destroy it. A status of a callback ends the step, which is undone, as does a
 *  residual above the tolerance (MPS_ERROR_NUMERIC). The solver is part of no snapshot and no file.
 *  MPS_ERROR_ARGUMENT: a member of `def` missing or out of range; MPS_ERROR_STATE: a step is open,
 *  or a callback is running; MPS_ERROR_UNSUPPORTED: no `rows` on several ranks. Collective. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_solver(mps_fluid *fluid,
                                                      const mps_fluid_solver_def *def);

MPS_EXTERN_C_END
#endif
