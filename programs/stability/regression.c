/* regression.c - the regression of stability limits, Yoshida (14)-(16), by least squares, and the
 * printed coefficients of its Table 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "regression.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Yoshida, Table 2: b11 b12 b13, b21 b22 b23. */
static const double printed_s[2][3] = {{0.264375, 1.621563, 2.540176},
                                       {0.04089, 0.262491, 0.438239}};
static const double printed_p[2][3] = {{0.304301, 1.666102, 2.614558},
                                       {0.046261, 0.263985, 0.392512}};

limit_fit limit_fit_printed(char wave) {
  const double(*table)[3] = wave == 'S' ? printed_s : printed_p;
  limit_fit fit = {.rms = NAN};
  for (int k = 0; k < 3; k++) fit.b1[k] = table[0][k], fit.b2[k] = table[1][k];
  return fit;
}

static double power_of_ten(const double b[3], double log_h) {
  return pow(10.0, (b[0] * log_h + b[1]) * log_h + b[2]); /* (15), (16) */
}

double limit_fit_dt(const limit_fit *fit, double R, double V, double h) {
  const double log_h = log10(h);
  return power_of_ten(fit->b1, log_h) * pow(R / V, power_of_ten(fit->b2, log_h)); /* (14) */
}

/* ---- least squares --------------------------------------------------------------------------- */

/* Coefficients of the rows x^(columns-1) ... x 1 against y, by modified Gram-Schmidt. False: the
 * points do not determine them. `room` holds rows * (columns + 1). */
static bool fit_polynomial(int64_t rows, int columns, const double *x, const double *y,
                           double *room, double *coefficients) {
  double R[3][4] = {{0.0}};
  double *q = room, *right = room + rows * columns;
  if (rows < columns) return false;
  for (int64_t r = 0; r < rows; r++) {
    double power = 1.0;
    for (int c = columns - 1; c >= 0; c--, power *= x[r]) q[c * rows + r] = power;
    right[r] = y[r];
  }
  for (int c = 0; c < columns; c++) {
    double length = 0.0, former = 0.0, power = 0.0;
    for (int64_t r = 0; r < rows; r++) {
      length += q[c * rows + r] * q[c * rows + r];
      power = pow(x[r], columns - 1 - c);
      former += power * power;
    }
    R[c][c] = sqrt(length);
    if (!(R[c][c] > 1e-10 * sqrt(former))) return false;
    for (int64_t r = 0; r < rows; r++) q[c * rows + r] /= R[c][c];
    for (int k = c + 1; k <= columns; k++) { /* the last one is the right-hand side */
      double *other = k < columns ? q + k * rows : right;
      for (int64_t r = 0; r < rows; r++) R[c][k] += q[c * rows + r] * other[r];
      for (int64_t r = 0; r < rows; r++) other[r] -= R[c][k] * q[c * rows + r];
    }
  }
  for (int c = columns - 1; c >= 0; c--) {
    coefficients[c] = R[c][columns];
    for (int k = c + 1; k < columns; k++) coefficients[c] -= R[c][k] * coefficients[k];
    coefficients[c] /= R[c][c];
  }
  return true;
}

/* ---- the regression -------------------------------------------------------------------------- */

typedef struct limits {
  int64_t count;
  const double *R, *V, *h, *dt;
  double h_max;
  double *x, *y, *room;
  char *why;
} limits;

static bool check(const limits *l) {
  const double *const columns[4] = {l->R, l->V, l->h, l->dt};
  const char *const names[4] = {"R", "V", "h", "dt"};
  for (int c = 0; c < 4; c++)
    for (int64_t k = 0; k < l->count; k++)
      if (!isfinite(columns[c][k]) || columns[c][k] <= 0.0) {
        snprintf(l->why, 160, "%s[%lld] is %g, must be finite and > 0", names[c], (long long)k,
                 columns[c][k]);
        return false;
      }
  return true;
}

/* The distinct damping ratios, ascending. */
static bool collect_dampings(const limits *l, limit_fit *fit) {
  for (int64_t k = 0; k < l->count; k++) {
    int at = 0;
    while (at < fit->dampings && fit->h[at] < l->h[k]) at++;
    if (at < fit->dampings && fit->h[at] == l->h[k]) continue;
    if (fit->dampings == FIT_MOST_DAMPINGS) {
      snprintf(l->why, 160, "there are more than %d distinct damping ratios", FIT_MOST_DAMPINGS);
      return false;
    }
    for (int m = fit->dampings; m > at; m--) fit->h[m] = fit->h[m - 1];
    fit->h[at] = l->h[k];
    fit->dampings++;
  }
  return true;
}

/* (14): log dt = log a1 + a2 log(R/V), for each h. */
static bool fit_powers(const limits *l, limit_fit *fit) {
  for (int m = 0; m < fit->dampings; m++) {
    int64_t rows = 0;
    double line[2] = {0.0, 0.0};
    for (int64_t k = 0; k < l->count; k++) {
      if (l->h[k] != fit->h[m]) continue;
      l->x[rows] = log10(l->R[k] / l->V[k]);
      l->y[rows++] = log10(l->dt[k]);
    }
    if (!fit_polynomial(rows, 2, l->x, l->y, l->room, line)) {
      snprintf(l->why, 160, "h = %g has %lld cases: at least 2 distinct R/V are needed", fit->h[m],
               (long long)rows);
      return false;
    }
    fit->a2[m] = line[0];
    fit->a1[m] = pow(10.0, line[1]);
  }
  return true;
}

/* (15), (16): log a1 and log a2 as quadratics of log h. */
static bool fit_quadratics(const limits *l, limit_fit *fit) {
  double x[FIT_MOST_DAMPINGS], y[FIT_MOST_DAMPINGS], z[FIT_MOST_DAMPINGS];
  double room[4 * FIT_MOST_DAMPINGS];
  int rows = 0;
  for (int m = 0; m < fit->dampings && fit->h[m] <= l->h_max; m++, rows++) {
    if (!(fit->a2[m] > 0.0)) {
      snprintf(l->why, 160, "the exponent a2 for h = %g is %g, must be > 0: dt must grow with R/V",
               fit->h[m], fit->a2[m]);
      return false;
    }
    x[rows] = log10(fit->h[m]);
    y[rows] = log10(fit->a1[m]);
    z[rows] = log10(fit->a2[m]);
  }
  if (fit_polynomial(rows, 3, x, y, room, fit->b1) && fit_polynomial(rows, 3, x, z, room, fit->b2))
    return true;
  snprintf(l->why, 160, "%d damping ratios are at most h_max = %g: at least 3 are needed", rows,
           l->h_max);
  return false;
}

bool limit_fit_make(int64_t count, const double *R, const double *V, const double *h,
                    const double *dt, double h_max, limit_fit *out, char why[160]) {
  limit_fit fit = {0};
  double *memory = malloc((size_t)(count > 0 ? count : 1) * 5 * sizeof *memory);
  limits l = {.count = count, .R = R, .V = V, .h = h, .dt = dt, .h_max = h_max, .why = why};
  if (!memory) {
    snprintf(why, 160, "out of memory");
    return false;
  }
  l.x = memory;
  l.y = memory + count;
  l.room = memory + 2 * count;
  const bool ok =
      check(&l) && collect_dampings(&l, &fit) && fit_powers(&l, &fit) && fit_quadratics(&l, &fit);
  free(memory);
  if (!ok) return false;
  double sum = 0.0;
  int64_t used = 0;
  for (int64_t k = 0; k < count; k++) {
    if (h[k] > h_max) continue;
    const double error = limit_fit_dt(&fit, R[k], V[k], h[k]) / dt[k] - 1.0;
    sum += error * error;
    used++;
  }
  fit.rms = sqrt(sum / (double)used);
  *out = fit;
  return true;
}
