/* solitary.c - a solitary wave on its way: crests of the gauges before structure, rock and zone,
 * beside the height that is asked for; the speed by the times at which they pass the first and the
 * last; the largest level that is left behind it, before what the end sends back arrives.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>

#define AROUND 0.5 /* periods 2 pi/(k c) about the asked crest in which it is sought */
#define BEHIND 0.6 /* after which the level is that of trailing waves */

/* The highest sample between two times and the vertex of the parabola through it and those beside:
 * its time, its level. */
static double find_crest(const flume *m, int gauge, double from, double to, double *level) {
  int64_t at = -1;
  for (int64_t k = 1; k + 1 < m->samples; k++) {
    const double z = m->sample[k].level[gauge];
    if (m->sample[k].t < from || m->sample[k].t > to || isnan(z)) continue;
    if (at < 0 || z > m->sample[at].level[gauge]) at = k;
  }
  *level = NAN;
  if (at < 0) return NAN;
  const flume_sample *p = &m->sample[at];
  const double a = p[-1].level[gauge], b = p->level[gauge], c = p[1].level[gauge];
  const double bend = a - 2.0 * b + c, shift = bend < 0.0 ? 0.5 * (a - c) / bend : 0.0;
  *level = b - 0.25 * (a - c) * shift;
  return p->t + shift * 0.5 * (p[1].t - p[-1].t);
}

static double find_largest(const flume *m, int gauge, double from, double to) {
  double most = NAN;
  for (int64_t k = 0; k < m->samples; k++)
    if (m->sample[k].t >= from && m->sample[k].t <= to)
      most = fmax(most, fabs(m->sample[k].level[gauge]));
  return most;
}

void flume_find_solitary(const flume *m, flume_figures *f) {
  const double d = m->s.depth, H = m->s.height, period = m->s.period;
  const double speed = sqrt(WAVES_G * (d + H)), start = FLUME_SOLITARY_START * period;
  double least = INFINITY, most = -INFINITY, first = NAN, last = NAN;
  for (int j = 0; j < m->fronts; j++) {
    const int g = m->front[j];
    const double x = m->s.gauge[g], due = start + x / speed;
    double level;
    const double t = find_crest(m, g, due - AROUND * period, due + AROUND * period, &level);
    if (x < least) least = x, first = t, f->crest_first = level;
    if (x <= most) continue;
    const double back = start + (2.0 * m->toe - x) / speed - BEHIND * period;
    most = x, last = t, f->crest_last = level;
    f->trailing = find_largest(m, g, t + BEHIND * period, back) / H;
  }
  f->speed = (most - least) / (last - first);
}
