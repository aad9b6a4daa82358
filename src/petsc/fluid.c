/* fluid.c - the fluid's pressure equation solved by PETSc. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

static mps_status take(void *user, int64_t rows, const int64_t *start, const int32_t *column,
                       const double *value) {
  const mpsi_petsc_matrix a = {
      .all = rows, .rows = rows, .block = 1, .start = start, .column = column, .value = value};
  return mpsi_petsc_take(user, &a);
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        int64_t *iterations) {
  return mpsi_petsc_solve(user, b, tolerance, x, iterations);
}

static mps_status forget(void *user) {
  mpsi_petsc_forget(user);
  return MPS_OK;
}

mps_status mps_petsc_solve_fluid(mps_petsc_solver *solver, mps_fluid *fluid, int64_t least) {
  mps_fluid_solver_def def = mps_fluid_solver_defaults();
  if (!solver || !fluid) return MPS_ERROR_ARGUMENT;
  if (solver->size > 1) return MPS_ERROR_UNSUPPORTED; /* a fluid is of one process */
  def.user = solver;
  def.matrix = take;
  def.solve = solve;
  def.forget = forget;
  def.least = least;
  return mps_fluid_set_solver(fluid, &def);
}
