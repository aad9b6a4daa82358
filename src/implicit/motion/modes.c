/* modes.c - lowest eigenmodes K phi = omega^2 M phi by ARPACK: the largest eigenvalues of the
 * symmetric operator M^1/2 K^-1 M^1/2 are 1 / omega^2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/implicit_solver.h"
#include "implicit/solve/system.h"
#include "implicit/solve/foreign.h"

#include <string.h>

#ifdef MPSI_ARPACK
#include <arpack.h>

typedef struct lanczos {
  int32_t n, count, basis; /* basis: Lanczos vectors kept */
  double *residual, *vectors, *work, *worku, *values;
  a_int *select;
  double *root; /* sqrt(mass) of each unknown */
} lanczos;

static bool allocate(mps_context *context, lanczos *s) {
  const int64_t n = s->n, b = s->basis;
  return (s->residual = mpsi_alloc(context, n, sizeof(double))) &&
         (s->vectors = mpsi_alloc(context, n * b, sizeof(double))) &&
         (s->work = mpsi_alloc(context, 3 * n, sizeof(double))) &&
         (s->worku = mpsi_alloc(context, b * (b + 8), sizeof(double))) &&
         (s->values = mpsi_alloc(context, b, sizeof(double))) &&
         (s->select = mpsi_alloc(context, b, sizeof(a_int))) &&
         (s->root = mpsi_alloc(context, n, sizeof(double)));
}

static void release(mps_context *context, lanczos *s) {
  MPSI_FREE(context, s->residual, s->vectors, s->work, s->worku, s->values, s->select, s->root);
}

/* y = M^1/2 K^-1 M^1/2 x */
static mps_status operate(mps_elastic *e, const char *function, const lanczos *s, const double *x,
                          double *y) {
  for (int32_t c = 0; c < s->n; c++) e->rhs[c] = s->root[c] * x[c];
  const mps_status status = mpsi_elastic_backsolve(e, function, 1, e->rhs, e->solution);
  for (int32_t c = 0; c < s->n; c++) y[c] = s->root[c] * e->solution[c];
  return status;
}

static mps_status iterate(mps_elastic *e, const char *function, lanczos *s) {
  a_int ido = 0, info = 1, parameters[11] = {0}, pointers[14] = {0};
  const a_int length = s->basis * (s->basis + 8);
  parameters[0] = 1;    /* exact shifts */
  parameters[2] = 1000; /* restarts */
  parameters[6] = 1;    /* an ordinary eigenproblem */
  /* A fixed start vector, so that the result is reproducible. */
  for (int32_t c = 0; c < s->n; c++) s->residual[c] = 1.0 + 0.5 * sin(1.0 + 2.3 * c);
  for (;;) {
    dsaupd_c(&ido, "I", s->n, "LM", s->count, 0.0, s->residual, s->basis, s->vectors, s->n,
             parameters, pointers, s->work, s->worku, length, &info);
    if (ido != 1 && ido != -1) break;
    MPSI_TRY(operate(e, function, s, s->work + pointers[0] - 1, s->work + pointers[1] - 1));
    if (mpsi_cancelled(e->context))
      return mpsi_fail(e->context, function, MPS_ERROR_CANCELLED, "cancelled");
  }
  if (info == 0)
    dseupd_c(1, "A", s->select, s->values, s->vectors, s->n, 0.0, "I", s->n, "LM", s->count, 0.0,
             s->residual, s->basis, s->vectors, s->n, parameters, pointers, s->work, s->worku,
             length, &info);
  if (info != 0)
    return mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                     "ARPACK found %d of %d modes (info %d)", parameters[4], s->count, info);
  return MPS_OK;
}

static void deliver(const mps_elastic *e, const lanczos *s, double *omega, double *shapes) {
  const int64_t all = e->n * e->dim;
  for (int32_t k = 0; k < s->count; k++) {
    const int32_t from = s->count - 1 - k; /* ARPACK: ascending, so omega descending */
    omega[k] = 1.0 / sqrt(s->values[from]);
    if (!shapes) continue;
    double *v = s->vectors + (int64_t)from * s->n;
    for (int32_t c = 0; c < s->n; c++) v[c] /= s->root[c]; /* y.y = 1 is phi.M phi = 1 */
    memset(e->work, 0, (size_t)all * sizeof *e->work);
    mpsi_elastic_expand(e, v, false, e->work);
    mpsi_elastic_to_caller(e, 1, e->work, shapes + k * 3 * e->n);
  }
}

static mps_status solve(mps_elastic *e, const char *function, int32_t count, double *omega,
                        double *shapes) {
  lanczos s = {.n = (int32_t)e->unknowns, .count = count};
  s.basis = 2 * count + 20 < s.n ? 2 * count + 20 : s.n;
  mps_status status = MPS_OK;
  if (!allocate(e->context, &s)) {
    release(e->context, &s);
    return mpsi_fail_memory(e->context, function, (size_t)s.n * (size_t)s.basis * sizeof(double));
  }
  for (int64_t k = 0; k < e->n * e->dim; k++)
    if (e->dof[k] >= 0) s.root[e->dof[k]] = sqrt(e->mass[k / e->dim]);
  /* ARPACK keeps the state of an iteration in variables of its own. */
  if (mpsi_foreign_lock_arpack()) {
    status = iterate(e, function, &s);
    mpsi_foreign_unlock_arpack();
  } else {
    status = mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "called from a hook within another calculation of modes on this thread");
  }
  if (status == MPS_OK) deliver(e, &s, omega, shapes);
  release(e->context, &s);
  return status;
}
#else
static mps_status solve(mps_elastic *e, const char *function, int32_t count, double *omega,
                        double *shapes) {
  return mpsi_fail(e->context, function, MPS_ERROR_UNSUPPORTED,
                   "this libmps was built without ARPACK");
}
#endif

static mps_status find_modes(mps_elastic *e, const char *function, int64_t count, double *omega,
                             double *shapes, double **mass) {
  MPSI_TRY(mpsi_elastic_read_mass(e, function, mass));
  MPSI_TRY(mpsi_elastic_prepare(e, function));
  if (count < 1 || count >= e->unknowns)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld, must be at least 1 and below the %lld unknowns",
                     (long long)count, (long long)e->unknowns);
  if (e->unknowns > INT32_MAX / 64)
    return mpsi_fail(e->context, function, MPS_ERROR_UNSUPPORTED,
                     "%lld unknowns are too many for ARPACK's integers", (long long)e->unknowns);
  MPSI_TRY(mpsi_elastic_factor(e, function, 0.0));
  return solve(e, function, (int32_t)count, omega, shapes);
}

mps_status mps_elastic_modes(mps_elastic *e, int64_t count, double *omega, double *shapes) {
  if (!e) return mpsi_null(__func__, "elastic");
  if (!omega) return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "omega is NULL");
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_elastic_agree_same(e, __func__, status, "count", (double)count);
  if (status != MPS_OK) return mpsi_elastic_leave(e, status);
  e->within = true;
  double *mass = e->mass; /* a motion under way and a load of gravity keep theirs */
  status = find_modes(e, __func__, count, omega, shapes, &mass);
  mpsi_elastic_finish_mass(e, mass, status == MPS_OK && !mass);
  return mpsi_elastic_leave(e, status);
}
