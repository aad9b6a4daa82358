/* baseline.c - what an accelerogram goes through before it is integrated: cosine taper of its ends
 * and removal of the trend of its velocity. Fit and formulas: docs/signals.md.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "signal_private.h"

#include <lapacke.h>

#define PI 3.14159265358979323846
#define DEGREE_MAX 3

void mpsi_taper(int64_t count, const double *times, double *accelerations, double length) {
  if (!(length > 0.0)) return;
  const double start = times[0], end = times[count - 1];
  for (int64_t i = 0; i < count; i++) {
    const double inside = fmin(times[i] - start, end - times[i]);
    if (inside < length) accelerations[i] *= 0.5 * (1.0 - cos(PI * inside / length));
  }
}

/* Velocity from rest, v[i] = sum of h (a0 + a1)/2: exact where the acceleration is linear between
 * samples. Returns the largest |v|; not finite where v overflows. */
static double integrate(int64_t count, const double *times, const double *accelerations,
                        double *velocities) {
  double largest = 0.0;
  velocities[0] = 0.0;
  for (int64_t i = 1; i < count; i++) {
    const double h = times[i] - times[i - 1];
    velocities[i] = velocities[i - 1] + 0.5 * h * (accelerations[i - 1] + accelerations[i]);
    largest = isfinite(velocities[i]) ? fmax(largest, fabs(velocities[i])) : INFINITY;
    if (!isfinite(largest)) break;
  }
  return largest;
}

/* Least squares: c[k - 1] of p(s) = sum of c[k - 1] s^k, k = 1..degree, with s = t/T in 0..1 so
 * that the columns are of one size. Each row is weighted with the root of the time it stands for:
 * the sum approximates the integral of (v - p)^2, also where steps are uneven. `velocities` (count,
 * scaled to at most 1) are replaced. */
static mps_status fit_trend(mps_context *context, const char *function, int degree, int64_t count,
                            const double *times, double *velocities, double c[DEGREE_MAX]) {
  double *columns = mpsi_alloc(context, count, (size_t)degree * sizeof *columns);
  if (!columns)
    return mpsi_fail_memory(context, function, (size_t)count * (size_t)degree * sizeof *columns);
  const double end = times[count - 1];
  for (int64_t i = 0; i < count; i++) {
    const double before = times[i > 0 ? i - 1 : 0], after = times[i + 1 < count ? i + 1 : i];
    const double weight = sqrt(0.5 * (after - before) / end), s = times[i] / end;
    double power = weight;
    for (int k = 0; k < degree; k++) columns[k * count + i] = power *= s;
    velocities[i] *= weight;
  }
  double work[64]; /* at least degree + max(degree, 1) */
  const lapack_int rows = (lapack_int)count;
  const lapack_int info = LAPACKE_dgels_work(LAPACK_COL_MAJOR, 'N', rows, degree, 1, columns, rows,
                                             velocities, rows, work, 64);
  for (int k = 0; k < degree; k++) c[k] = velocities[k];
  mpsi_free(context, columns);
  if (info == 0) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                   "the baseline of degree %d cannot be fitted: the times are too unevenly spaced",
                   degree);
}

/* a(t) - dp/dt, in place. `velocities` is room for count numbers. */
static mps_status remove_trend(mps_context *context, const char *function, int degree,
                               int64_t count, const double *times, double *accelerations,
                               double *velocities) {
  const double end = times[count - 1];
  const double largest = integrate(count, times, accelerations, velocities);
  if (!isfinite(largest))
    return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                     "the velocity overflows when the record is integrated");
  if (largest == 0.0) return MPS_OK;
  double c[DEGREE_MAX] = {0};
  if (degree == 0) { /* MPS_SIGNAL_BASELINE_MEAN */
    c[0] = velocities[count - 1] / largest;
  } else {
    for (int64_t i = 0; i < count; i++) velocities[i] /= largest;
    MPSI_TRY(fit_trend(context, function, degree, count, times, velocities, c));
  }
  for (int64_t i = 0; i < count; i++) {
    const double s = times[i] / end;
    accelerations[i] -= largest / end * (c[0] + s * (2.0 * c[1] + s * 3.0 * c[2]));
    if (!isfinite(accelerations[i]))
      return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                       "the baseline correction overflows at t = %g s", times[i]);
  }
  return MPS_OK;
}

mps_status mpsi_baseline_correct(mps_context *context, const char *function, int32_t baseline,
                                 int64_t count, const double *times, double *accelerations) {
  if (baseline == MPS_SIGNAL_BASELINE_NONE) return MPS_OK;
  const int degree = baseline == MPS_SIGNAL_BASELINE_MEAN        ? 0 /* no fit */
                     : baseline == MPS_SIGNAL_BASELINE_LINEAR    ? 1
                     : baseline == MPS_SIGNAL_BASELINE_QUADRATIC ? 2
                                                                 : 3;
  if (count < degree + 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "baseline %d needs at least %d samples, the record has %lld", (int)baseline,
                     degree + 1, (long long)count);
  double *velocities = mpsi_alloc(context, count, sizeof *velocities);
  if (!velocities) return mpsi_fail_memory(context, function, (size_t)count * sizeof *velocities);
  const mps_status status =
      remove_trend(context, function, degree, count, times, accelerations, velocities);
  mpsi_free(context, velocities);
  return status;
}
