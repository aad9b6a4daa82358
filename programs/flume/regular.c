/* regular.c - force of regular waves on an upright wall: the mean of the highest force of each
 * wave, to be compared with design formulas of the wave height, which the highest of all waves of a
 * run is not; the amplitude of the first harmonic, and that of a linear standing wave whose
 * incident and reflected height is H, rho g H tanh(kd)/k. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>

/* Fourier coefficient at the frequency of the waves over the window, by the trapezoidal rule. */
static double find_harmonic(const flume *m, double from, double to) {
  const double omega = 2.0 * WAVES_PI / m->s.period;
  double sum[2] = {0.0, 0.0}, span = 0.0;
  for (int64_t k = 1; k < m->samples; k++) {
    const flume_sample *p = &m->sample[k - 1], *q = &m->sample[k];
    const double half = 0.5 * (q->t - p->t);
    if (p->t < from - half || q->t > to + half) continue;
    const double a = p->force - m->rest.force, b = q->force - m->rest.force;
    sum[0] += half * (a * cos(omega * p->t) + b * cos(omega * q->t));
    sum[1] += half * (a * sin(omega * p->t) + b * sin(omega * q->t));
    span += 2.0 * half;
  }
  return 2.0 * hypot(sum[0], sum[1]) / span;
}

/* Mean over the whole periods of the window. */
static double find_mean_peak(const flume *m, double from, double to) {
  const int64_t periods = llround((to - from) / m->s.period);
  double sum = 0.0;
  int64_t k = 0;
  for (int64_t n = 0; n < periods; n++) {
    const double end = from + (double)(n + 1) * m->s.period;
    double most = -INFINITY;
    for (; k < m->samples && m->sample[k].t <= end; k++)
      if (m->sample[k].t > end - m->s.period) most = fmax(most, m->sample[k].force);
    sum += most - m->rest.force;
  }
  return sum / (double)periods;
}

void flume_find_regular_forces(const flume *m, flume_figures *f) {
  const bool upright = m->s.wall == FLUME_VERTICAL || m->s.wall == FLUME_CAISSON;
  const bool level = m->ground[m->grounds - 1][1] == 0.0;
  if (m->s.waves != FLUME_REGULAR || !upright || !level || !f->separated) return;
  const double k = 2.0 * WAVES_PI / m->wave_length, H = sqrt(0.5) * f->split.incident_height;
  f->force_mean = find_mean_peak(m, f->from, f->to);
  f->force_harmonic = find_harmonic(m, f->from, f->to);
  f->force_linear = WAVES_DENSITY * WAVES_G * H * tanh(k * m->s.depth) / k;
}
