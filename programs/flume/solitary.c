/* solitary.c - a solitary wave on its way: crests of the gauges before structure, rock and zone,
 * beside the height that is asked for; the speed by the times at which they pass the first of 4
 * depths from the maker on and the last; the largest level that is left behind it, before what the
 * end sends back arrives.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>

#define AROUND 0.5 /* periods 2 pi/(k c) about the asked crest in which it is sought */
#define SIDE 6     /* samples, of a sixtieth of a period by default */
#define NEAR 4.0   /* depths from the maker where the wave takes its shape: no speed */
#define BEHIND 0.6 /* after which the level is that of trailing waves */

/* Vertex of the parabola of least squares through the highest sample between two times and SIDE
 * beside it on either side: its time, its level. */
static double find_crest(const flume *m, int gauge, double from, double to, double *level) {
  int64_t at = -1;
  for (int64_t k = SIDE; k + SIDE < m->samples; k++) {
    const double z = m->sample[k].level[gauge];
    if (m->sample[k].t < from || m->sample[k].t > to || isnan(z)) continue;
    if (at < 0 || z > m->sample[at].level[gauge]) at = k;
  }
  *level = NAN;
  if (at < 0) return NAN;
  /* samples are even: of z = p + q s + r s^2 over s = -SIDE to SIDE */
  double sum[3] = {0.0}, two = 0.0, four = 0.0;
  const double n = 2.0 * SIDE + 1.0;
  for (int s = -SIDE; s <= SIDE; s++) {
    const double z = m->sample[at + s].level[gauge], square = (double)(s * s);
    sum[0] += z, sum[1] += s * z, sum[2] += square * z;
    two += square, four += square * square;
  }
  const double r = (n * sum[2] - two * sum[0]) / (n * four - two * two), q = sum[1] / two;
  const double shift = -0.5 * q / r, p = (sum[0] - r * two) / n;
  if (!(r < 0.0 && fabs(shift) <= SIDE)) return NAN;
  *level = p + 0.5 * q * shift;
  return m->sample[at].t + shift * (m->sample[at + 1].t - m->sample[at - 1].t) / 2.0;
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
  double nearest = INFINITY, least = INFINITY, most = -INFINITY, first = NAN, last = NAN;
  for (int j = 0; j < m->fronts; j++) {
    const int g = m->front[j];
    const double x = m->s.gauge[g], due = start + x / speed;
    double level;
    const double t = find_crest(m, g, due - AROUND * period, due + AROUND * period, &level);
    if (x < nearest) nearest = x, f->crest_first = level;
    if (x < least && x >= NEAR * d) least = x, first = t;
    if (x <= most) continue;
    const double back = start + (2.0 * m->toe - x) / speed - BEHIND * period;
    most = x, last = t, f->crest_last = level;
    f->trailing = find_largest(m, g, t + BEHIND * period, back) / H;
  }
  f->speed = (most - least) / (last - first);
}
