/* linear_solver.c - PETSc in place of the library's linear solvers, each process with its part of
 * the rows. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

static mps_status take(void *user, const mps_linear_matrix *m) {
  if (m->struct_size < sizeof *m) return MPS_ERROR_UNSUPPORTED; /* an older libmps */
  return mpsi_petsc_take(user, m);
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        mps_linear_result *result) {
  return mpsi_petsc_solve(user, b, tolerance, x, &result->iterations);
}

static mps_status forget(void *user) {
  mpsi_petsc_forget(user);
  return MPS_OK;
}

mps_status mps_petsc_linear_solver(mps_petsc_solver *solver, mps_linear_solver_def *def) {
  if (!solver) return mps_context_set_error(NULL, MPS_ERROR_ARGUMENT, __func__, "solver is NULL");
  if (!def)
    return mps_context_set_error(solver->context, MPS_ERROR_ARGUMENT, __func__, "def is NULL");
  *def = mps_linear_solver_defaults();
  def->rank = solver->rank, def->ranks = solver->size;
  def->user = solver;
  def->matrix = take, def->solve = solve, def->forget = forget;
  return MPS_OK;
}
