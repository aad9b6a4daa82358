/* elastic.c - equations of implicit elasticity solved by PETSc, each process with its part of the
 * rows. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

static mps_status take(void *user, const mps_elastic_matrix *m, size_t size) {
  if (size < sizeof *m) return MPS_ERROR_UNSUPPORTED; /* an older libmps */
  const mpsi_petsc_matrix a = {.all = m->all,
                               .first = m->first,
                               .rows = m->rows,
                               .block = m->block,
                               .start = m->start,
                               .column = m->column,
                               .value = m->value,
                               .modes = m->modes,
                               .mode = m->mode};
  return mpsi_petsc_take(user, &a);
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        int64_t *iterations) {
  return mpsi_petsc_solve(user, b, tolerance, x, iterations);
}

mps_status mps_petsc_solve_elastic(mps_petsc_solver *solver, mps_elastic *elastic) {
  mps_elastic_solver_def def = mps_elastic_solver_defaults();
  mps_elastic_def body = {0};
  if (!solver) return MPS_ERROR_ARGUMENT;
  if (!elastic || mps_elastic_get_def(elastic, &body) != MPS_OK)
    return mps_context_set_error(solver->context, MPS_ERROR_ARGUMENT, __func__, "elastic is NULL");
  const int32_t ranks = body.domain ? mps_domain_size(body.domain) : 1;
  if (solver->size > 1 && (ranks != solver->size || mps_domain_rank(body.domain) != solver->rank))
    return mpsi_petsc_refuse_ranks(solver, __func__, ranks);
  def.part = solver->rank, def.parts = solver->size;
  def.user = solver;
  def.matrix = take;
  def.solve = solve;
  return mps_elastic_set_solver(elastic, &def);
}
