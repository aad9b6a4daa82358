/* pore_water.c - the implicit pressures of pore water solved by PETSc.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

static mps_status take(void *user, int64_t all, int64_t first, int64_t rows, const int64_t *start,
                       const int32_t *column, const double *value) {
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

mps_status mps_petsc_solve_pore_water(mps_petsc_solver *solver, mps_mpm *mpm, int64_t least) {
  mps_pore_solver_def def = mps_pore_solver_defaults();
  mps_mpm_def of = {0};
  if (!solver) return MPS_ERROR_ARGUMENT;
  if (!mpm || mps_mpm_get_def(mpm, &of) != MPS_OK)
    return mps_context_set_error(solver->context, MPS_ERROR_ARGUMENT, __func__, "mpm is NULL");
  const int32_t ranks = of.domain ? mps_domain_size(of.domain) : 1;
  if (ranks != solver->size || (ranks > 1 && mps_domain_rank(of.domain) != solver->rank))
    return mpsi_petsc_refuse_ranks(solver, __func__, ranks);
  def.user = solver;
  def.rows = take;
  def.solve = solve;
  def.forget = forget;
  def.least = least;
  return mps_mpm_set_pore_solver(mpm, &def);
}
