/* statistics.c - the waves of a gauge one by one: a wave lasts from one crossing of the mean level
 * upwards to the next, its height is that of its crest above its trough. Where waves of a narrow
 * band are Rayleigh distributed H1/3 is 1.00, H1/10 1.27 and the highest of N waves about
 * (ln(N)/2)^1/2 of Hm0 = 4 standard deviations. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>

static int compare_heights(const void *a, const void *b) {
  const double p = *(const double *)a, q = *(const double *)b;
  return p < q ? 1 : p > q ? -1 : 0;
}

static double mean_of(const double *height, int64_t count) {
  double sum = 0.0;
  for (int64_t k = 0; k < count; k++) sum += height[k];
  return count > 0 ? sum / (double)count : NAN;
}

/* Moments of the levels in the window; samples without a surface are left out. */
static void find_moments(const flume *m, int gauge, double from, double to, flume_statistics *s) {
  double sum = 0.0, n = 0.0, moment[2] = {0.0, 0.0};
  for (int64_t k = 0; k < m->samples; k++) {
    const double level = m->sample[k].level[gauge];
    if (m->sample[k].t >= from && m->sample[k].t <= to && !isnan(level)) sum += level, n += 1.0;
  }
  s->mean = sum / n;
  for (int64_t k = 0; k < m->samples; k++) {
    const double z = m->sample[k].level[gauge] - s->mean;
    if (m->sample[k].t < from || m->sample[k].t > to || isnan(z)) continue;
    moment[0] += z * z / n, moment[1] += z * z * z / n;
  }
  s->Hm0 = 4.0 * sqrt(moment[0]);
  s->skewness = moment[1] / pow(moment[0], 1.5);
}

bool flume_find_statistics(const flume *m, int gauge, double from, double to, flume_statistics *s) {
  double *height = calloc((size_t)m->samples + 1, sizeof *height);
  double before = NAN, then = NAN, crest = 0.0, trough = 0.0, first = NAN, last = NAN;
  if (!height) return false;
  *s = (flume_statistics){.waves = 0};
  find_moments(m, gauge, from, to, s);
  for (int64_t k = 0; k < m->samples; k++) {
    const double t = m->sample[k].t, z = m->sample[k].level[gauge] - s->mean;
    if (t < from || t > to || isnan(z)) continue;
    if (before < 0.0 && z >= 0.0) { /* between two samples the level is a straight line */
      const double at = then + (t - then) * before / (before - z);
      if (isnan(first))
        first = at;
      else
        height[s->waves++] = crest - trough;
      last = at, crest = trough = 0.0;
    }
    crest = fmax(crest, z), trough = fmin(trough, z);
    before = z, then = t;
  }
  qsort(height, (size_t)s->waves, sizeof *height, compare_heights);
  s->period = s->waves > 0 ? (last - first) / (double)s->waves : NAN;
  s->third = mean_of(height, (s->waves + 2) / 3);
  s->tenth = mean_of(height, (s->waves + 9) / 10);
  s->highest = s->waves > 0 ? height[0] : NAN;
  free(height);
  return true;
}
