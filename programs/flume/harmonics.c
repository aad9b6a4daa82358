/* harmonics.c - second harmonic of regular waves over the first: that bound to it, the free wave
 * that the maker sends besides, and the free one that comes back, by least squares over the gauges,
 *
 *   a2(x) = B exp(-2 i k x) + F exp(-i k2 x) + R exp(i k2 x),
 *
 * k2 the wave number of twice the frequency. k is that of the waves as they are, which fits the
 * first harmonic at the gauges: high waves are 1 to 3 % longer than linear ones, and with the
 * linear k what B has over ten depths would count as free. Beside B stands Stokes' second order,
 * a k cosh kd (2 + cosh 2kd)/(4 sinh^3 kd). SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <complex.h>
#include <math.h>

enum { MOST = 9, LEAST_GAUGES = 5, TRIALS = 241 };
#define WIDEST 0.12    /* of the linear k: trials of k to both sides */
#define LEAST_TURN 0.7 /* rad, between bound and free wave over the gauges */

typedef struct system {
  int unknowns;
  double complex a[MOST][MOST], b[MOST];
} system;

/* Adds the equation sum row x = right, in the sense of least squares. */
static void add(system *s, const double complex *row, double complex right) {
  for (int i = 0; i < s->unknowns; i++) {
    for (int j = 0; j < s->unknowns; j++) s->a[i][j] += conj(row[i]) * row[j];
    s->b[i] += conj(row[i]) * right;
  }
}

/* Gauss with pivots of the diagonal, which is positive. False where an unknown is not determined.
 */
static bool solve(system *s, double complex *x) {
  const int n = s->unknowns;
  for (int k = 0; k < n; k++) {
    const double scale = creal(s->a[k][k]);
    if (!(scale > 1e-12)) return false;
    for (int i = k + 1; i < n; i++) {
      const double complex factor = s->a[i][k] / s->a[k][k];
      for (int j = k; j < n; j++) s->a[i][j] -= factor * s->a[k][j];
      s->b[i] -= factor * s->b[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    x[k] = s->b[k];
    for (int j = k + 1; j < n; j++) x[k] -= s->a[k][j] * x[j];
    x[k] /= s->a[k][k];
  }
  return true;
}

/* Amplitudes of the first and the second harmonic at a gauge, of exp(i omega t), beside the mean
 * and two higher ones. */
static bool find_amplitudes(const flume *m, const flume_figures *f, int gauge,
                            double complex amplitude[2]) {
  const double omega = 2.0 * WAVES_PI / m->s.period;
  system s = {.unknowns = MOST};
  double complex x[MOST];
  for (int64_t k = 0; k < m->samples; k++) {
    const double t = m->sample[k].t, level = m->sample[k].level[gauge];
    if (t < f->from - 1e-9 || t > f->to + 1e-9 || isnan(level)) continue;
    double complex row[MOST] = {1.0};
    for (int n = 1; 2 * n < MOST; n++)
      row[2 * n - 1] = cos(n * omega * t), row[2 * n] = -sin(n * omega * t);
    add(&s, row, level);
  }
  if (!solve(&s, x)) return false;
  amplitude[0] = creal(x[1]) + I * creal(x[2]), amplitude[1] = creal(x[3]) + I * creal(x[4]);
  return true;
}

/* The level at x of waves of amplitude 1 and the wave numbers k[]; negative: they come back. */
static void level_of(const double *k, int count, double x, double complex *row) {
  for (int n = 0; n < count; n++) row[n] = cexp(-I * k[n] * x);
}

/* Amplitudes of such waves from a harmonic at the gauges. Returns the sum of squares that is left,
 * INFINITY where they are not determined. */
static double fit(const flume *m, double complex (*amplitude)[2], int harmonic, int count,
                  const double *k, double complex *wave) {
  system s = {.unknowns = count};
  double complex row[3];
  double sum = 0.0;
  for (int g = 0; g < m->fronts; g++) {
    level_of(k, count, m->s.gauge[m->front[g]], row);
    add(&s, row, amplitude[g][harmonic]);
  }
  if (!solve(&s, wave)) return INFINITY;
  for (int g = 0; g < m->fronts; g++) {
    double complex left = amplitude[g][harmonic];
    level_of(k, count, m->s.gauge[m->front[g]], row);
    for (int n = 0; n < count; n++) left -= row[n] * wave[n];
    sum += creal(left * conj(left));
  }
  return sum;
}

/* Wave number with which incident and reflected waves fit the first harmonic best; NAN where that
 * is an end of the trials: there is none then. */
static double find_number(const flume *m, double complex (*amplitude)[2], double complex *wave) {
  const double linear = 2.0 * WAVES_PI / m->wave_length;
  double best = INFINITY, number = NAN;
  for (int n = 0; n < TRIALS; n++) {
    const double k = linear * (1.0 + WIDEST * (2.0 * n / (TRIALS - 1) - 1.0));
    double complex trial[2] = {0.0};
    const double left = fit(m, amplitude, 0, 2, (double[]){k, -k}, trial);
    if (!(left < best)) continue;
    best = left, number = n > 0 && n < TRIALS - 1 ? k : NAN;
    wave[0] = trial[0], wave[1] = trial[1];
  }
  return number;
}

/* Wave number of a frequency by Newton's method on k tanh kd = omega^2/g. */
static double linear_number(double omega, double depth) {
  const double y = omega * omega * depth / WAVES_G;
  double q = fmax(y, sqrt(y));
  for (int n = 0; n < 60; n++) {
    const double T = tanh(q);
    q -= (q * T - y) / (T + q * (1.0 - T * T));
  }
  return q / depth;
}

void flume_find_harmonics(const flume *m, flume_figures *f) {
  double complex amplitude[FLUME_GAUGES][2], first[2] = {0.0}, second[3];
  double least = INFINITY, most = -INFINITY;
  if (m->s.waves != FLUME_REGULAR || flume_is_loaded(m) || m->shape.rocks > 0 ||
      m->fronts < LEAST_GAUGES)
    return;
  for (int g = 0; g < m->fronts; g++) {
    if (!find_amplitudes(m, f, m->front[g], amplitude[g])) return;
    least = fmin(least, m->s.gauge[m->front[g]]), most = fmax(most, m->s.gauge[m->front[g]]);
  }
  const double k2 = linear_number(4.0 * WAVES_PI / m->s.period, m->s.depth);
  const double k = find_number(m, amplitude, first);
  if (!((k2 - 2.0 * k) * (most - least) > LEAST_TURN)) return;
  if (!isfinite(fit(m, amplitude, 1, 3, (double[]){2.0 * k, k2, -k2}, second))) return;
  const double a = cabs(first[0]), kd = 2.0 * WAVES_PI / m->wave_length * m->s.depth;
  f->bound = cabs(second[0]) / a, f->unbound = cabs(second[1]) / a, f->back = cabs(second[2]) / a;
  f->bound_stokes =
      a / m->s.depth * kd * cosh(kd) * (2.0 + cosh(2.0 * kd)) / (4.0 * pow(sinh(kd), 3.0));
  f->length = 2.0 * WAVES_PI / k;
}
