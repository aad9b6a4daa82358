/* quasi_newton.c - IQN-ILS: with V the differences of residuals and W those of answers, the newest
 * first, x = H + W alpha where |V alpha + r| is least. V = Q R by Gram and Schmidt; a column of
 * which too little is left is passed over.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "coupling_private.h"

#include <math.h>
#include <string.h>

double mpsi_coupling_dot(int64_t n, const double *a, const double *b) {
  double sum = 0.0;
  for (int64_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

void mpsi_coupling_learn(mps_coupling *c) {
  const int32_t most = c->def.columns, kept = c->columns < most ? c->columns : most - 1;
  const mpsi_coupling_column first = c->column[kept]; /* the oldest, or a free one */
  memmove(c->column + 1, c->column, (size_t)kept * sizeof *c->column);
  c->column[0] = first;
  c->column[0].step = c->steps;
  for (int64_t i = 0; i < c->def.size; i++) {
    first.residual[i] = c->residual[i] - c->last_residual[i];
    first.answer[i] = c->answer[i] - c->last_answer[i];
  }
  c->columns = kept + 1;
}

void mpsi_coupling_forget(mps_coupling *c, int64_t oldest, int64_t newest) {
  int32_t kept = 0;
  for (int32_t k = 0; k < c->columns; k++) {
    const mpsi_coupling_column column = c->column[k];
    if (column.step < oldest || column.step >= newest) continue;
    c->column[k] = c->column[kept]; /* no memory is lost */
    c->column[kept++] = column;
  }
  c->columns = kept;
}

/* Orthogonalises column k against the first `rank` of the basis, twice; false where less than the
 * filter's share of it is left. Coefficients go to column `rank` of the triangle. */
static bool orthogonalise(mps_coupling *c, int32_t k, int32_t rank) {
  const int64_t n = c->def.size, most = c->def.columns;
  double *q = c->basis + rank * n, *r = c->triangle + rank * most;
  memcpy(q, c->column[k].residual, (size_t)n * sizeof *q);
  const double whole = sqrt(mpsi_coupling_dot(n, q, q));
  memset(r, 0, (size_t)(rank + 1) * sizeof *r);
  for (int pass = 0; pass < 2; pass++)
    for (int32_t j = 0; j < rank; j++) {
      const double *p = c->basis + j * n, along = mpsi_coupling_dot(n, p, q);
      r[j] += along;
      for (int64_t i = 0; i < n; i++) q[i] -= along * p[i];
    }
  const double left = sqrt(mpsi_coupling_dot(n, q, q));
  if (!(left > c->def.filter * whole) || !(left > 0.0)) return false;
  r[rank] = left;
  for (int64_t i = 0; i < n; i++) q[i] /= left;
  return true;
}

bool mpsi_coupling_quasi_newton(mps_coupling *c) {
  const int64_t n = c->def.size, most = c->def.columns;
  int32_t rank = 0, used[64];
  for (int32_t k = 0; k < c->columns && rank < n && rank < 64; k++)
    if (orthogonalise(c, k, rank)) used[rank++] = k;
  if (rank == 0) return false;
  for (int32_t j = 0; j < rank; j++)
    c->share[j] = -mpsi_coupling_dot(n, c->basis + j * n, c->residual);
  memcpy(c->x, c->answer, (size_t)n * sizeof *c->x);
  for (int32_t j = rank - 1; j >= 0; j--) { /* R alpha = -Q^T r */
    const double *answer = c->column[used[j]].answer;
    const double alpha = c->share[j] / c->triangle[j * most + j];
    for (int32_t i = 0; i < j; i++) c->share[i] -= alpha * c->triangle[j * most + i];
    for (int64_t i = 0; i < n; i++) c->x[i] += alpha * answer[i];
  }
  return true;
}
