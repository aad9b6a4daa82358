/* linear_plug.h - a linear solver of one process for tests: conjugate gradients from the start
 * that they are given, with the diagonal of the first matrix since `forget`, and faults on demand.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_LINEAR_PLUG_H
#define MPS_TEST_LINEAR_PLUG_H

#include "test_common.h"

typedef enum linear_fault {
  LINEAR_FINE,
  LINEAR_SCALES,    /* the solution, by 1.001 */
  LINEAR_SAYS_LESS, /* a residual far below that of the solution, which is small enough */
  LINEAR_GIVES_UP,  /* says that the residual is large */
  LINEAR_NAN,
  LINEAR_WRITES_ON,   /* one row too many */
  LINEAR_LEAVES_ROWS, /* does nothing */
  LINEAR_COUNTS_BELOW_0,
  LINEAR_STEPS, /* the solver */
  LINEAR_FAULTS
} linear_fault;

typedef struct linear_plug {
  linear_fault fault;
  mps_status matrix_status, solve_status, forget_status;
  mps_solver *solver; /* for LINEAR_STEPS */
  int matrices, patterns, solutions, forgotten, released;
  int64_t rows, iterations; /* iterations: of all solutions */
  int32_t block, modes;
  int64_t *start;
  int32_t *column;
  double *value, *mode, *diagonal;
} linear_plug;

static inline void *linear_copy(const void *from, size_t bytes) {
  void *to = malloc(bytes + 1);
  return from ? memcpy(to, from, bytes) : to;
}

static inline void linear_plug_drop(linear_plug *p) {
  void *const parts[] = {p->start, p->column, p->value, p->mode, p->diagonal};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) free(parts[k]);
  p->start = NULL, p->column = NULL, p->value = NULL, p->mode = NULL, p->diagonal = NULL;
}

static inline double linear_entry(const linear_plug *p, int64_t i, int64_t j) {
  for (int64_t k = p->start[i]; k < p->start[i + 1]; k++)
    if (p->column[k] == j) return p->value[k];
  return 0.0;
}

/* The largest |a_ij - a_ji|; columns must ascend and have the diagonal. */
static inline double linear_asymmetry(const linear_plug *p) {
  double worst = 0.0;
  for (int64_t i = 0; i < p->rows; i++) {
    assert_true(linear_entry(p, i, i) > 0.0);
    for (int64_t k = p->start[i]; k < p->start[i + 1]; k++) {
      assert_true(k == p->start[i] || p->column[k] > p->column[k - 1]);
      worst = fmax(worst, fabs(p->value[k] - linear_entry(p, p->column[k], i)));
    }
  }
  return worst;
}

static inline mps_status linear_matrix(void *user, const mps_linear_matrix *m) {
  linear_plug *p = user;
  double *diagonal = p->diagonal;
  p->matrices++;
  p->patterns += m->change == MPS_LINEAR_CHANGE_PATTERN;
  if (p->matrix_status != MPS_OK) return p->matrix_status;
  assert_int_equal(m->struct_size, sizeof *m);
  assert_true(m->first == 0 && m->rows == m->all && m->start[0] == 0);
  const size_t rows = (size_t)m->rows, entries = (size_t)m->start[m->rows];
  if (m->change == MPS_LINEAR_CHANGE_VALUES) { /* it is as it says */
    assert_int_equal(m->rows, p->rows);
    assert_memory_equal(m->start, p->start, (rows + 1) * sizeof *m->start);
    assert_memory_equal(m->column, p->column, entries * sizeof *m->column);
  }
  p->diagonal = NULL;
  linear_plug_drop(p);
  p->rows = m->rows, p->block = m->block, p->modes = m->modes;
  p->start = linear_copy(m->start, (rows + 1) * sizeof *m->start);
  p->column = linear_copy(m->column, entries * sizeof *m->column);
  p->value = linear_copy(m->value, entries * sizeof *m->value);
  p->mode = linear_copy(m->mode, rows * (size_t)m->modes * sizeof *m->mode);
  p->diagonal = m->change == MPS_LINEAR_CHANGE_VALUES ? diagonal : NULL;
  if (p->diagonal) return MPS_OK;
  free(diagonal);
  p->diagonal = linear_copy(NULL, rows * sizeof *p->diagonal);
  for (int64_t i = 0; i < p->rows; i++) p->diagonal[i] = linear_entry(p, i, i);
  return MPS_OK;
}

static inline void linear_multiply(const linear_plug *p, const double *x, double *y) {
  for (int64_t i = 0; i < p->rows; i++) {
    y[i] = 0.0;
    for (int64_t k = p->start[i]; k < p->start[i + 1]; k++) y[i] += p->value[k] * x[p->column[k]];
  }
}

static inline double linear_dot(int64_t n, const double *a, const double *b) {
  double sum = 0.0;
  for (int64_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* From x on, to half of the tolerance; returns the residual. */
static inline double linear_iterate(const linear_plug *p, const double *b, double tolerance,
                                    double *x, int64_t *iterations) {
  const int64_t n = p->rows;
  double *r = calloc((size_t)(4 * n), sizeof *r), *z = r + n, *d = z + n, *q = d + n;
  const double bb = linear_dot(n, b, b);
  double former = 1.0;
  linear_multiply(p, x, q);
  for (int64_t i = 0; i < n; i++) r[i] = b[i] - q[i];
  double rr = linear_dot(n, r, r);
  for (*iterations = 0; rr > 0.25 * tolerance * tolerance * bb && *iterations < 20 * n;
       ++*iterations) {
    for (int64_t i = 0; i < n; i++) z[i] = r[i] / p->diagonal[i];
    const double rz = linear_dot(n, r, z);
    for (int64_t i = 0; i < n; i++) d[i] = z[i] + rz / former * d[i];
    linear_multiply(p, d, q);
    const double step = rz / linear_dot(n, d, q);
    for (int64_t i = 0; i < n; i++) x[i] += step * d[i], r[i] -= step * q[i];
    rr = linear_dot(n, r, r);
    former = rz;
  }
  free(r);
  return bb > 0.0 ? sqrt(rr / bb) : 0.0;
}

static inline mps_status linear_solve(void *user, const double *b, double tolerance, double *x,
                                      mps_linear_result *result) {
  linear_plug *p = user;
  p->solutions++;
  assert_true(tolerance > 0.0 && result->iterations == 0 && isnan(result->residual));
  if (p->solve_status != MPS_OK) return p->solve_status;
  if (p->fault == LINEAR_STEPS) return mps_solver_step(p->solver, 1);
  if (p->fault == LINEAR_LEAVES_ROWS) {
    for (int64_t i = 0; i < p->rows; i++) x[i] = 0.0;
    return MPS_OK;
  }
  result->residual = linear_iterate(p, b, tolerance, x, &result->iterations);
  p->iterations += result->iterations;
  for (int64_t i = 0; p->fault == LINEAR_SCALES && i < p->rows; i++) x[i] *= 1.001;
  for (int64_t i = 0; p->fault == LINEAR_SAYS_LESS && i < p->rows; i++)
    x[i] *= 1.0 + 0.4 * tolerance;
  if (p->fault == LINEAR_SAYS_LESS) result->residual = 1e-3 * tolerance;
  if (p->fault == LINEAR_GIVES_UP) result->residual = 0.5;
  if (p->fault == LINEAR_NAN) x[p->rows / 2] = NAN;
  if (p->fault == LINEAR_WRITES_ON) x[p->rows] = 0.0;
  if (p->fault == LINEAR_COUNTS_BELOW_0) result->iterations = -1;
  return MPS_OK;
}

static inline mps_status linear_forget(void *user) {
  linear_plug *p = user;
  p->forgotten++;
  free(p->diagonal);
  p->diagonal = NULL;
  return p->forget_status;
}

static inline void linear_release(void *user) { ((linear_plug *)user)->released++; }

static inline mps_linear_solver_def linear_plug_def(linear_plug *p) {
  DEF(linear_solver, def, .user = p, .release = linear_release, .matrix = linear_matrix,
      .solve = linear_solve, .forget = linear_forget);
  return def;
}

#endif
