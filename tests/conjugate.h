/* conjugate.h - plain conjugate gradients, for tests that bring their own solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_CONJUGATE_H
#define MPS_TEST_CONJUGATE_H

#include <mps/base.h>

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* y = A x for all rows. */
typedef mps_status test_multiply_fn(const void *matrix, const double *x, double *y);

static inline double test_dot(int64_t n, const double *a, const double *b) {
  double sum = 0.0;
  for (int64_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* A x = b of n rows from x = 0, to half of the tolerance. */
static inline mps_status test_conjugate(int64_t n, test_multiply_fn *multiply, const void *matrix,
                                        const double *b, double tolerance, double *x,
                                        int64_t *iterations) {
  const size_t bytes = (size_t)n * sizeof(double);
  double *r = memcpy(malloc(bytes), b, bytes), *d = memcpy(malloc(bytes), b, bytes);
  double *q = malloc(bytes), rr = test_dot(n, r, r);
  const double enough = 0.5 * tolerance * sqrt(rr);
  mps_status status = MPS_OK;
  for (*iterations = 0; status == MPS_OK && sqrt(rr) > enough && *iterations < 20 * n;
       ++*iterations) {
    status = multiply(matrix, d, q);
    const double step = rr / test_dot(n, d, q), former = rr;
    for (int64_t i = 0; i < n; i++) x[i] += step * d[i], r[i] -= step * q[i];
    rr = test_dot(n, r, r);
    for (int64_t i = 0; i < n; i++) d[i] = r[i] + rr / former * d[i];
  }
  free(r);
  free(d);
  free(q);
  return status;
}

#endif
