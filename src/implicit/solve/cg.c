/* cg.c - preconditioned conjugate gradients on the assembled matrix, for factors beyond the memory
 * limit. Preconditioner: symmetric Gauss-Seidel, (D + L) D^-1 (D + L^T), which exists for every
 * positive definite matrix and needs no memory but the diagonal.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cg.h"
#include "implicit/base/implicit_solver.h"

#include <string.h>

typedef struct cg {
  const mps_elastic *e;
  const double *diagonal; /* shift included */
  int64_t n;
} cg;

static void multiply(const cg *s, const double *x, double *y) {
  const mps_elastic *e = s->e;
  for (int64_t c = 0; c < s->n; c++) y[c] = s->diagonal[c] * x[c];
  for (int64_t c = 0; c < s->n; c++) {
    double sum = 0.0;
    for (int64_t k = e->column[c] + 1; k < e->column[c + 1]; k++) {
      y[e->row[k]] += e->value[k] * x[c];
      sum += e->value[k] * x[e->row[k]];
    }
    y[c] += sum;
  }
}

static void precondition(const cg *s, const double *r, double *z) {
  const mps_elastic *e = s->e;
  memcpy(z, r, (size_t)s->n * sizeof *z);
  for (int64_t c = 0; c < s->n; c++) { /* (D + L) z = r */
    z[c] /= s->diagonal[c];
    for (int64_t k = e->column[c] + 1; k < e->column[c + 1]; k++)
      z[e->row[k]] -= e->value[k] * z[c];
  }
  for (int64_t c = s->n - 1; c >= 0; c--) { /* (D + L^T) z = D z */
    double sum = s->diagonal[c] * z[c];
    for (int64_t k = e->column[c] + 1; k < e->column[c + 1]; k++) sum -= e->value[k] * z[e->row[k]];
    z[c] = sum / s->diagonal[c];
  }
}

static double dot(const double *a, const double *b, int64_t n) {
  double sum = 0.0;
  for (int64_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* x = A^-1 b; work is r, z, p, q. */
static mps_status iterate(const cg *s, const char *function, const double *b, double *x,
                          double *work, int64_t limit, int64_t *iterations, bool *good) {
  mps_context *context = s->e->context;
  const int64_t n = s->n;
  double *r = work, *z = work + n, *p = work + 2 * n, *q = work + 3 * n;
  const double target = s->e->def.tolerance * sqrt(dot(b, b, n));
  memset(x, 0, (size_t)n * sizeof *x);
  memcpy(r, b, (size_t)n * sizeof *r);
  double length = sqrt(dot(r, r, n)), old = 1.0;
  int64_t it = 0;
  for (; it < limit && length > target; it++) {
    precondition(s, r, z);
    const double rz = dot(r, z, n), beta = it ? rz / old : 0.0;
    for (int64_t c = 0; c < n; c++) p[c] = z[c] + beta * p[c];
    multiply(s, p, q);
    const double curvature = dot(p, q, n);
    if (!(curvature > 0.0) && good) {
      *good = false;
      return MPS_OK;
    }
    if (!(curvature > 0.0))
      return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                       "conjugate gradients: the matrix is not positive definite (p.Kp = %g at "
                       "iteration %lld)",
                       curvature, (long long)it);
    const double step = rz / curvature;
    for (int64_t c = 0; c < n; c++) {
      x[c] += step * p[c];
      r[c] -= step * q[c];
    }
    old = rz;
    length = sqrt(dot(r, r, n));
    if (it % 64 == 0 && mpsi_cancelled(context))
      return mpsi_fail(context, function, MPS_ERROR_CANCELLED, "cancelled at CG iteration %lld",
                       (long long)it);
  }
  *iterations += it;
  if (length <= target) return MPS_OK;
  if (good) {
    *good = false;
    return MPS_OK;
  }
  return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                   "conjugate gradients reached |r|/|b| = %g in %lld iterations, tolerance is %g",
                   length * s->e->def.tolerance / target, (long long)it, s->e->def.tolerance);
}

mps_status mpsi_elastic_cg(mps_elastic *e, const char *function, double shift, const double *rhs,
                           double *solution, bool *good) {
  const int64_t n = e->unknowns;
  if (!e->cg_work) e->cg_work = mpsi_alloc(e->context, 5 * n, sizeof *e->cg_work);
  double *work = e->cg_work; /* kept with the matrix: a step allocates nothing */
  if (!work) return mpsi_fail_memory(e->context, function, (size_t)(5 * n) * sizeof *work);
  double *diagonal = work + 4 * n;
  for (int64_t k = 0; k < e->n * e->dim; k++)
    if (e->dof[k] >= 0)
      diagonal[e->dof[k]] =
          e->value[e->column[e->dof[k]]] + (shift != 0.0 ? shift * e->mass[k / e->dim] : 0.0);
  const cg s = {.e = e, .diagonal = diagonal, .n = n};
  const int64_t most = e->def.iterations > 0 ? e->def.iterations : 10 * n;
  const int64_t limit = good && most > MPSI_CG_PATIENCE ? MPSI_CG_PATIENCE : most;
  return iterate(&s, function, rhs, solution, work, limit, &e->report.iterations, good);
}
