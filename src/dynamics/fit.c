/* fit.c - the regression of stability limits, Yoshida (14)-(16), by LAPACK least squares, and the
 * printed coefficients of its Table 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/internal.h"

#include <mps/dynamics.h>

#include <lapacke.h>

/* Yoshida, Table 2: b11 b12 b13, b21 b22 b23. */
static const double printed_s[2][3] = {{0.264375, 1.621563, 2.540176},
                                       {0.04089, 0.262491, 0.438239}};
static const double printed_p[2][3] = {{0.304301, 1.666102, 2.614558},
                                       {0.046261, 0.263985, 0.392512}};

mps_status mps_limit_fit_printed(mps_context *context, char wave, mps_limit_fit *out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  if (wave != 'S' && wave != 'P')
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "wave is '%c' (%d), allowed are 'S' and 'P'", wave, wave);
  const double(*table)[3] = wave == 'S' ? printed_s : printed_p;
  *out = (mps_limit_fit){.rms = NAN};
  for (int k = 0; k < 3; k++) out->b1[k] = table[0][k], out->b2[k] = table[1][k];
  return MPS_OK;
}

static double power_of_ten(const double b[3], double log_h) {
  return pow(10.0, (b[0] * log_h + b[1]) * log_h + b[2]); /* (15), (16) */
}

double mps_limit_fit_dt(const mps_limit_fit *fit, double R, double V, double h) {
  if (!fit || !(R > 0.0) || !(V > 0.0) || !(h > 0.0)) return NAN;
  const double log_h = log10(h);
  return power_of_ten(fit->b1, log_h) * pow(R / V, power_of_ten(fit->b2, log_h)); /* (14) */
}

static mps_status check(mps_context *context, int64_t count, const double *R, const double *V,
                        const double *h, const double *dt, double h_max) {
  static const char *const function = "mps_dynamics_fit_limits";
  if (count < 1 || !R || !V || !h || !dt)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld, and R, V, h and dt must not be NULL", (long long)count);
  if (!(h_max > 0.0))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "h_max is %g, must be > 0", h_max);
  const double *const columns[4] = {R, V, h, dt};
  const char *const names[4] = {"R", "V", "h", "dt"};
  for (int c = 0; c < 4; c++)
    for (int64_t k = 0; k < count; k++)
      if (!isfinite(columns[c][k]) || columns[c][k] <= 0.0)
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "%s[%lld] is %g, must be finite and > 0", names[c], (long long)k,
                         columns[c][k]);
  return MPS_OK;
}

/* The distinct damping ratios, ascending. */
static mps_status collect_dampings(mps_context *context, int64_t count, const double *h,
                                   mps_limit_fit *fit) {
  for (int64_t k = 0; k < count; k++) {
    int at = 0;
    while (at < fit->dampings && fit->h[at] < h[k]) at++;
    if (at < fit->dampings && fit->h[at] == h[k]) continue;
    if (fit->dampings == MPS_FIT_MAX_DAMPINGS)
      return mpsi_fail(context, "mps_dynamics_fit_limits", MPS_ERROR_ARGUMENT,
                       "there are more than %d distinct damping ratios", MPS_FIT_MAX_DAMPINGS);
    for (int m = fit->dampings; m > at; m--) fit->h[m] = fit->h[m - 1];
    fit->h[at] = h[k];
    fit->dampings++;
  }
  return MPS_OK;
}

/* Least squares of the rows x^(columns-1) ... x 1 against y: `coefficients` has one a column.
 * MPS_ERROR_NUMERIC, for the caller to record, when the points do not determine them. */
static mps_status fit_polynomial(mps_context *context, int64_t rows, int columns, const double *x,
                                 const double *y, double *coefficients) {
  if (rows < columns) return MPS_ERROR_NUMERIC;
  double *a = mpsi_alloc(context, rows * (columns + 1), sizeof *a);
  if (!a)
    return mpsi_fail_memory(context, "mps_dynamics_fit_limits",
                            (size_t)(rows * (columns + 1)) * sizeof *a);
  double *b = a + rows * columns, singular[3];
  lapack_int rank = 0;
  for (int64_t r = 0; r < rows; r++) {
    double power = 1.0;
    for (int c = columns - 1; c >= 0; c--, power *= x[r]) a[c * rows + r] = power;
    b[r] = y[r];
  }
  const lapack_int info =
      LAPACKE_dgelsd(LAPACK_COL_MAJOR, (lapack_int)rows, columns, 1, a, (lapack_int)rows, b,
                     (lapack_int)rows, singular, 1e-10, &rank);
  for (int c = 0; c < columns; c++) coefficients[c] = b[c];
  mpsi_free(context, a);
  return info == 0 && rank == columns ? MPS_OK : MPS_ERROR_NUMERIC;
}

/* (14): log dt = log a1 + a2 log(R/V), for each h. */
static mps_status fit_powers(mps_context *context, int64_t count, const double *R, const double *V,
                             const double *h, const double *dt, double *x, double *y,
                             mps_limit_fit *fit) {
  for (int m = 0; m < fit->dampings; m++) {
    int64_t rows = 0;
    double line[2] = {0.0, 0.0};
    for (int64_t k = 0; k < count; k++) {
      if (h[k] != fit->h[m]) continue;
      x[rows] = log10(R[k] / V[k]);
      y[rows++] = log10(dt[k]);
    }
    const mps_status status = fit_polynomial(context, rows, 2, x, y, line);
    if (status == MPS_ERROR_NUMERIC)
      return mpsi_fail(context, "mps_dynamics_fit_limits", MPS_ERROR_NUMERIC,
                       "h = %g has %lld cases: at least 2 distinct R/V are needed", fit->h[m],
                       (long long)rows);
    if (status != MPS_OK) return status;
    fit->a2[m] = line[0];
    fit->a1[m] = pow(10.0, line[1]);
  }
  return MPS_OK;
}

/* (15), (16): log a1 and log a2 as quadratics of log h. */
static mps_status fit_quadratics(mps_context *context, double h_max, double *x, double *y,
                                 mps_limit_fit *fit) {
  int rows = 0;
  double *z = y + MPS_FIT_MAX_DAMPINGS;
  for (int m = 0; m < fit->dampings && fit->h[m] <= h_max; m++, rows++) {
    if (!(fit->a2[m] > 0.0))
      return mpsi_fail(context, "mps_dynamics_fit_limits", MPS_ERROR_NUMERIC,
                       "the exponent a2 for h = %g is %g, must be > 0: dt must grow with R/V",
                       fit->h[m], fit->a2[m]);
    x[rows] = log10(fit->h[m]);
    y[rows] = log10(fit->a1[m]);
    z[rows] = log10(fit->a2[m]);
  }
  mps_status status = fit_polynomial(context, rows, 3, x, y, fit->b1);
  if (status == MPS_OK) status = fit_polynomial(context, rows, 3, x, z, fit->b2);
  if (status == MPS_ERROR_NUMERIC)
    return mpsi_fail(context, "mps_dynamics_fit_limits", status,
                     "%d damping ratios are at most h_max = %g: at least 3 are needed", rows,
                     h_max);
  return status;
}

mps_status mps_dynamics_fit_limits(mps_context *context, int64_t count, const double *R,
                                   const double *V, const double *h, const double *dt, double h_max,
                                   mps_limit_fit *out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  mps_limit_fit fit = {0};
  mps_status status = check(context, count, R, V, h, dt, h_max);
  if (status == MPS_OK) status = collect_dampings(context, count, h, &fit);
  if (status != MPS_OK) return status;
  const int64_t room = count + 2 * MPS_FIT_MAX_DAMPINGS;
  double *x = mpsi_alloc(context, 2 * room, sizeof *x);
  if (!x) return mpsi_fail_memory(context, __func__, (size_t)room * 2 * sizeof *x);
  status = fit_powers(context, count, R, V, h, dt, x, x + room, &fit);
  if (status == MPS_OK) status = fit_quadratics(context, h_max, x, x + room, &fit);
  mpsi_free(context, x);
  if (status != MPS_OK) return status;
  double sum = 0.0;
  int64_t used = 0;
  for (int64_t k = 0; k < count; k++) {
    if (h[k] > h_max) continue;
    const double error = mps_limit_fit_dt(&fit, R[k], V[k], h[k]) / dt[k] - 1.0;
    sum += error * error;
    used++;
  }
  fit.rms = sqrt(sum / (double)used);
  *out = fit;
  return MPS_OK;
}
