/* series.c - integrals over samples by the trapezium rule, cut between samples: an omitted end
 * would include the mean, which may be many times an amplitude.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "series.h"

#include <math.h>
#include <stdbool.h>

#define TWO_PI 6.28318530717958647692

static double at(const series *s, const double *first, int64_t k) {
  return *(const double *)(const void *)((const char *)first + (size_t)k * s->stride);
}

/* Integrals of the value times 1, cos(wt) and sin(wt); false where the samples do not reach. */
static bool integrate(const series *s, double w, double from, double to, double *sum) {
  const double slack = 1e-9 * fabs(to - from);
  sum[0] = sum[1] = sum[2] = 0.0;
  if (s->count < 2 || at(s, s->t, 0) > from + slack || at(s, s->t, s->count - 1) < to - slack)
    return false;
  for (int64_t k = 1; k < s->count; k++) {
    const double t[2] = {at(s, s->t, k - 1), at(s, s->t, k)};
    const double v[2] = {at(s, s->value, k - 1), at(s, s->value, k)};
    const double ends[2] = {fmax(t[0], from), fmin(t[1], to)};
    for (int e = 0; e < 2 && ends[0] < ends[1]; e++) {
      const double part = (ends[e] - t[0]) / (t[1] - t[0]);
      const double half = 0.5 * (ends[1] - ends[0]) * ((1.0 - part) * v[0] + part * v[1]);
      sum[0] += half, sum[1] += half * cos(w * ends[e]), sum[2] += half * sin(w * ends[e]);
    }
  }
  return true;
}

double series_harmonic(const series *s, double period, double from, double to, double *phase) {
  const double whole = floor((to - from) / period + 1e-6) * period;
  double sum[3];
  if (phase) *phase = NAN;
  if (!(whole >= period) || !integrate(s, TWO_PI / period, to - whole, to, sum)) return NAN;
  if (phase) *phase = atan2(sum[1], sum[2]);
  return 2.0 * hypot(sum[1], sum[2]) / whole;
}

double series_mean(const series *s, double from, double to) {
  double sum[3];
  return integrate(s, 0.0, from, to, sum) ? sum[0] / (to - from) : NAN;
}

double series_wave_decay(const series *kinetic, double period, double from, double to) {
  enum { PARTS = 4 }; /* of a period, between means */
  double n = 0.0, st = 0.0, sy = 0.0, stt = 0.0, sty = 0.0;
  if (!(to - from >= 2.0 * period * (1.0 - 1e-6))) return NAN;
  for (int64_t k = 0;; k++) {
    const double start = from + (double)k * period / PARTS;
    if (start + period > to + 1e-6 * period) break;
    const double y = log(series_mean(kinetic, start, fmin(start + period, to)));
    const double t = start - from;
    n += 1.0, st += t, sy += y, stt += t * t, sty += t * y;
  }
  return -0.5 * (n * sty - st * sy) / (n * stt - st * st);
}
