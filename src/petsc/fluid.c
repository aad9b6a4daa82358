/* fluid.c - the fluid's pressure equation solved by PETSc. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

static mps_status take(void *user, int64_t rows, const int64_t *start, const int32_t *column,
                       const double *value) {
  const mpsi_petsc_matrix a = {
      .all = rows, .rows = rows, .block = 1, .start = start, .column = column, .value = value};
  return mpsi_petsc_take(user, &a);
}

static mps_status take_rows(void *user, int64_t all, int64_t first, int64_t rows,
                            const int64_t *start, const int32_t *column, const double *value) {
  const mpsi_petsc_matrix a = {.all = all,
                               .first = first,
                               .rows = rows,
                               .block = 1,
                               .start = start,
                               .column = column,
                               .value = value};
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
  mps_fluid_def of = {0};
  if (!solver) return MPS_ERROR_ARGUMENT;
  if (!fluid || mps_fluid_get_def(fluid, &of) != MPS_OK)
    return mps_context_set_error(solver->context, MPS_ERROR_ARGUMENT, __func__, "fluid is NULL");
  const int32_t ranks = of.domain ? mps_domain_size(of.domain) : 1;
  if (ranks != solver->size || (ranks > 1 && mps_domain_rank(of.domain) != solver->rank))
    return mpsi_petsc_refuse_ranks(solver, __func__, ranks);
  def.user = solver;
  def.matrix = take;
  def.rows = take_rows;
  def.solve = solve;
  def.forget = forget;
  def.least = least;
  return mps_fluid_set_solver(fluid, &def);
}
