/* mps/pore_solver.h - the solution for the implicit pressures of the pore water
 * (MPS_PORE_SCHEME_IMPLICIT of mps/pore_water.h): its report, and another solver in place of the
 * library's own (a direct solver to check with, an algebraic multigrid).
 *
 * Each step has one equation A x = b, symmetric and positive definite, with one row a cell that is
 * filled and no part of a drained surface: [S + dt T + dt^2 G^T m^-1 G] d = b (docs/pore-water.md),
 * with rows and columns divided by the roots of their diagonals, so that the diagonal is 1. A row
 * has up to 49 entries in the plane and 343 in space, of both signs. Rows are in the order of the
 * cells of the grid and change as particles move. The library's own solver is conjugate gradients
 * with a coarse space of blocks of cells, whose iterations hardly grow with the number of cells
 * (docs/pore-water.md).
 *
 * Thread rule: as mps/mpm.h; the callbacks are called by the thread that steps, outside of the
 * context's executor. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_PORE_SOLVER_H
#define LIBMPS_PORE_SOLVER_H

#include "pore_water.h"

MPS_EXTERN_C_BEGIN

/** A, by rows: rows first to first + rows - 1 of `all`, on the ranks of a domain in their order
 *  (`rows` may be 0 there), in one process all. Row i has the columns column[start[i - first]] to
 *  column[start[i - first + 1] - 1], ascending, with the diagonal and both halves; `rows` + 1
 *  starts, start[0] is 0. The arrays are valid and unchanged until mps_pore_solve_fn returns. */
typedef mps_status (*mps_pore_rows_fn)(void *user, int64_t all, int64_t first, int64_t rows,
                                       const int64_t *start, const int32_t *column,
                                       const double *value);

/** Solves A x = b with the last matrix. Both arrays are of all rows; `b` and the start in `x`, 0,
 *  are set in this rank's; of `x` this rank's rows receive the solution: |b - A x| <= `tolerance`
 *  |b| over all ranks, which the library checks. `iterations` (0 at the call) may be set, for the
 *  report. Called once a step, on all ranks. */
typedef mps_status (*mps_pore_solve_fn)(void *user, const double *b, double tolerance, double *x,
                                        int64_t *iterations);

/** Discards the solver's data of former equations (a preconditioner), so that later solutions
 *  depend on later equations alone. Snapshot, rollback, save and restore call it first: a run that
 *  continues after them has the bits of one that continues from the snapshot or the file. */
typedef mps_status (*mps_pore_forget_fn)(void *user);

typedef struct mps_pore_solver_def {
  uint32_t struct_size;
  int32_t reserved;
  void *user;                /* passed to all; the caller's own */
  mps_pore_rows_fn rows;     /* no default */
  mps_pore_solve_fn solve;   /* no default */
  mps_pore_forget_fn forget; /* default NULL: the solver has no such data */
  int64_t least; /* least number of rows, of all ranks; fewer are solved by the library; >= 0;
                    default 0 */
} mps_pore_solver_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_pore_solver_def_init(mps_pore_solver_def *def, size_t size);
static inline mps_pore_solver_def mps_pore_solver_defaults(void) {
  mps_pore_solver_def def;
  memset(&def, 0, sizeof def);
  if (mps_pore_solver_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Sets a solver, between steps; `def` NULL: the library's own. The callbacks may query the solver
 *  of the ground, not step or destroy it. A status of a callback fails the step, as does a residual
 *  above the tolerance (MPS_ERROR_NUMERIC). The solver is part of no snapshot and no file, and
 *  is not called with explicit pressures, nor in steps in which ground that water fills bears on a
 *  body: contacts there are part of the matrix and join cells far apart. MPS_ERROR_ARGUMENT: a
 * member of `def` missing or out of range; MPS_ERROR_STATE: no water, a step has failed, or a
 * callback is running; MPS_ERROR_MEMORY. Collective. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_pore_solver(mps_mpm *mpm,
                                                         const mps_pore_solver_def *def);

/** The solution for the implicit pressures in the last step. */
typedef struct mps_pore_report {
  int64_t unknowns;   /* cells with a pressure of their own, of all ranks */
  int64_t coarse;     /* unknowns of the coarse equation; 0: without one */
  int64_t iterations; /* of the conjugate gradients, or as the caller's solver says */
} mps_pore_report;
/** All are 0 before the first step and with explicit pressures. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library; MPS_ERROR_STATE: no water. Not collective. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_pore_report_sized(const mps_mpm *mpm,
                                                               mps_pore_report *out, size_t size);
static inline mps_status mps_mpm_get_pore_report(const mps_mpm *mpm, mps_pore_report *out) {
  return mps_mpm_get_pore_report_sized(mpm, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
