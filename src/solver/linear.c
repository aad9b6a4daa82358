/* linear.c - see linear.h. SPDX-License-Identifier: BSD-3-Clause */
#include "linear.h"

#include "core/base/given.h"
#include "domain/domain_internal.h"

#define CALLBACK(name) "the callback " name " of mps_solver_set_linear_solver"
#define ALLOWED 1.01      /* times the tolerance, and the residual that a result says by 2 */
#define ROUNDING 1e-12    /* of |b|: the smallest tolerance that is required */
#define UNTOUCHED -3e-301 /* behind the solution */
enum { BEHIND = 8 };      /* entries there */

/* ---- the solver that is set ------------------------------------------------------------------ */

/* Whether it is of the processes that the solver has. */
static mps_status check_ranks(const mps_solver *s, const char *function,
                              const mps_linear_solver_def *def) {
  const int32_t rank = s->domain ? mps_domain_rank(s->domain) : 0;
  const int32_t ranks = s->domain ? mps_domain_size(s->domain) : 1;
  if (def->rank == rank && def->ranks == ranks) return MPS_OK;
  return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                   "the linear solver is rank %d of %d processes, must be rank %d of the %d of the "
                   "solver's domain",
                   (int)def->rank, (int)def->ranks, (int)rank, (int)ranks);
}

static mps_status check(mps_solver *s, const char *function, int32_t equation,
                        const mps_linear_solver_def *user, mps_linear_solver_def *def) {
  if (s->kind->equation == 0)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "equation is %s, and the solver has none to solve",
                     mpsi_name_of("mps_linear_equation", equation).text);
  if (equation != s->kind->equation)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "equation is %s, that of the solver is %s",
                     mpsi_name_of("mps_linear_equation", equation).text,
                     mpsi_name_of("mps_linear_equation", s->kind->equation).text);
  mps_status status = s->kind->linear_ready ? s->kind->linear_ready(s, function) : MPS_OK;
  if (status == MPS_OK && user)
    status = MPSI_DEF_READ(s->context, function, mps_linear_solver_def, user, def);
  return status == MPS_OK && user ? check_ranks(s, function, def) : status;
}

/* Status of all ranks, and whether all have such a solver. */
static mps_status agree(mps_solver *s, const char *function, mps_status status, bool set,
                        const mps_linear_solver_def *def) {
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "having a linear solver", set);
  mpsi_give(&given, "having forget", def->forget != NULL);
  MPSI_GIVE(&given, def, least);
  return mpsi_domain_agree_given(s->domain, function, status, &given);
}

mps_status mps_solver_set_linear_solver(mps_solver *s, int32_t equation,
                                        const mps_linear_solver_def *user) {
  if (!s) return mpsi_null(__func__, "solver");
  mps_linear_solver_def def = mps_linear_solver_defaults();
  mpsi_linear *linear = NULL;
  MPSI_TRY(mpsi_solver_enter(s, __func__));
  mps_status status = check(s, __func__, equation, user, &def);
  if (status == MPS_OK && user && !(linear = mpsi_alloc(s->context, 1, sizeof *linear)))
    status = mpsi_fail_memory(s->context, __func__, sizeof *linear);
  status = agree(s, __func__, status, user != NULL, &def);
  if (status != MPS_OK) {
    mpsi_free(s->context, linear);
    return status;
  }
  if (linear) *linear = (mpsi_linear){.def = def};
  mpsi_linear_drop(s);
  s->linear = linear;
  if (s->kind->linear_changed) s->kind->linear_changed(s);
  return MPS_OK;
}

void mpsi_linear_drop(mps_solver *s) {
  mpsi_linear *l = s->linear;
  s->linear = NULL;
  if (!l) return;
  mpsi_release(l->def.release, l->def.user);
  MPSI_FREE(s->context, l->x.item, l);
}

bool mpsi_linear_serves(const mps_solver *s, int64_t rows) {
  return s->linear && rows >= s->linear->def.least;
}

/* After a callback that began with mpsi_guard_close, which gave `former`. */
static mps_status leave(mps_solver *s, const char *function, mpsi_guard former, mps_status status) {
  const mpsi_guard own = s->guard;
  s->guard = former;
  return mpsi_callback_status(s->context, function, own.callback, own.failures, status);
}

mps_status mpsi_linear_forget(mps_solver *s, const char *function) {
  mpsi_linear *l = s->linear;
  if (!l || !l->def.forget) return MPS_OK;
  l->valid = l->known = false;
  const mpsi_guard former = mpsi_guard_close(&s->guard, s->context, CALLBACK("forget"));
  return leave(s, function, former, l->def.forget(l->def.user));
}

/* ---- the matrix ------------------------------------------------------------------------------ */

static uint64_t mix(uint64_t hash, int64_t number) {
  hash = (hash ^ (uint64_t)number) * UINT64_C(0x9e3779b97f4a7c15);
  return hash ^ hash >> 29;
}

static uint64_t pattern_of(const mps_linear_matrix *a) {
  uint64_t hash = mix(mix(mix(0, a->all), a->first), a->rows);
  for (int64_t i = 0; i <= a->rows; i++) hash = mix(hash, a->start[i]);
  for (int64_t k = 0; k < a->start[a->rows]; k++) hash = mix(hash, a->column[k]);
  return hash;
}

mps_status mpsi_linear_hand(mps_solver *s, const char *function, mps_linear_matrix *a) {
  mpsi_linear *l = s->linear;
  const uint64_t pattern = pattern_of(a);
  double changed = !l->known || pattern != l->pattern;
  const bool good = mpsi_room_ensure(s->context, &l->x, a->rows + BEHIND, sizeof(double));
  l->valid = l->known = false;
  mps_status status = good ? MPS_OK : mpsi_fail_memory(s->context, function, (size_t)a->rows * 8);
  MPSI_TRY(mpsi_domain_agree_max(s->domain, function, status, 1, &changed));
  a->struct_size = sizeof *a;
  a->change = changed != 0.0 ? MPS_LINEAR_CHANGE_PATTERN : MPS_LINEAR_CHANGE_VALUES;
  const mpsi_guard former = mpsi_guard_close(&s->guard, s->context, CALLBACK("matrix"));
  status = leave(s, function, former, l->def.matrix(l->def.user, a));
  MPSI_TRY(s->kind->agree(s, function, status));
  l->valid = l->known = true;
  l->pattern = pattern, l->first = a->first, l->rows = a->rows;
  return MPS_OK;
}

/* ---- the solution ---------------------------------------------------------------------------- */

/* Where a result says that the solution has not come to the tolerance, or is none. */
static mps_status check_result(const mps_solver *s, const char *function, double tolerance) {
  const mpsi_linear *l = s->linear;
  const double *x = l->x.item;
  for (int k = 0; k < BEHIND; k++)
    if (x[l->rows + k] != UNTOUCHED)
      return mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                       CALLBACK("solve") " has written x[%lld], of %lld rows",
                       (long long)(l->rows + k), (long long)l->rows);
  for (int64_t k = 0; k < l->rows; k++)
    if (!isfinite(x[k]))
      return mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                       CALLBACK("solve") " has given x[%lld] = %g in row %lld", (long long)k, x[k],
                       (long long)(l->first + k));
  if (l->result.iterations < 0)
    return mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                     CALLBACK("solve") " says %lld iterations, must be >= 0",
                     (long long)l->result.iterations);
  if (l->result.residual < 0.0 || l->result.residual > ALLOWED * tolerance + ROUNDING)
    return mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                     CALLBACK("solve") " has not converged: it says a residual of %g of the right "
                                       "side after %lld iterations, allowed is %g",
                     l->result.residual, (long long)l->result.iterations, tolerance);
  return MPS_OK;
}

mps_status mpsi_linear_solve(mps_solver *s, const char *function, double tolerance, const double *b,
                             double *x) {
  mpsi_linear *l = s->linear;
  double *own = l->x.item;
  memcpy(own, x, (size_t)l->rows * sizeof *own);
  for (int k = 0; k < BEHIND; k++) own[l->rows + k] = UNTOUCHED;
  l->result = (mps_linear_result){.struct_size = sizeof l->result, .residual = NAN};
  const mpsi_guard former = mpsi_guard_close(&s->guard, s->context, CALLBACK("solve"));
  mps_status status = l->def.solve(l->def.user, b, tolerance, own, &l->result);
  status = leave(s, function, former, status);
  if (status == MPS_OK) status = check_result(s, function, tolerance);
  status = s->kind->agree(s, function, status);
  if (status == MPS_OK) memcpy(x, own, (size_t)l->rows * sizeof *own);
  return status;
}

mps_status mpsi_linear_check(mps_solver *s, const char *function, double tolerance, double rounding,
                             double rr, double bb) {
  const double residual = bb > 0.0 ? sqrt(rr / bb) : rr == 0.0 ? 0.0 : INFINITY;
  const double said = s->linear->result.residual;
  mps_status status = MPS_OK;
  rounding = fmax(ROUNDING, rounding);
  if (!(residual <= ALLOWED * tolerance + rounding))
    status = mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                       CALLBACK("solve") " has the residual %g of the right side, allowed is %g",
                       residual, tolerance);
  else if (residual > 2.0 * said + rounding)
    status = mpsi_fail(s->context, function, MPS_ERROR_NUMERIC,
                       CALLBACK("solve") " says a residual of %g of the right side, it is %g", said,
                       residual);
  if (status != MPS_OK) mpsi_fail_where(s->context, s->kind->steps(s), -1);
  return s->kind->agree(s, function, status);
}
