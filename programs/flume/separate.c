/* separate.c - incident and reflected waves by the gauges before structure, rock, a bed that is not
 * level, or zone, beside the linear target there, and the waves that pass by the gauges behind. One
 * set of progressive waves to either side describes neither both waters nor what is between them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>

#define LOWEST 0.5 /* band of the separation, over the frequency of the peak */
#define HIGHEST 2.2
#define REGULAR_LOWEST 0.8 /* without what is bound to a regular wave */
#define REGULAR_HIGHEST 1.2

/* Gauges of one water, and what is separated. */
typedef struct part {
  const int *gauge;
  int count;
  bool target; /* the linear one in place of the run */
  double *t, *one, *level;
} part;

/* Levels; where there is no surface the last one before. */
static mps_status fill_levels(const flume *m, const part *p) {
  for (int n = 0; n < p->count; n++) {
    const int g = p->gauge[n];
    double last = 0.0;
    mps_status status = MPS_OK;
    if (p->target)
      status = mps_waves_get_levels(m->waves, m->s.gauge[g], m->samples, p->t, p->one, NULL);
    if (status != MPS_OK) return status;
    for (int64_t k = 0; k < m->samples; k++) {
      const double now = p->target ? p->one[k] : m->sample[k].level[g];
      if (isfinite(now)) last = now;
      p->level[k * p->count + n] = last;
    }
  }
  return MPS_OK;
}

static mps_separation_def band_of(const flume *m, const flume_figures *f) {
  const bool regular = m->s.waves == FLUME_REGULAR;
  mps_separation_def def = mps_separation_defaults();
  def.depth = m->s.depth, def.gravity = WAVES_G;
  def.from = f->from, def.to = f->to;
  def.lower = (regular ? REGULAR_LOWEST : LOWEST) / m->s.period;
  def.upper = (regular ? REGULAR_HIGHEST : HIGHEST) / m->s.period;
  def.samples = m->samples;
  return def;
}

static mps_status separate(app *a, const flume *m, flume_figures *f, const part *p, int64_t most,
                           double *frequency, double *incident, double *reflected,
                           mps_separation *out) {
  double position[FLUME_GAUGES];
  mps_separation_def def = band_of(m, f);
  if (p->gauge == m->rear) def.depth -= flume_ground_at(m, m->s.gauge[p->gauge[0]]);
  for (int n = 0; n < p->count; n++) position[n] = m->s.gauge[p->gauge[n]];
  def.gauges = p->count, def.position = position;
  def.times = p->t, def.levels = p->level;
  const mps_status status = fill_levels(m, p);
  if (status != MPS_OK) return status;
  return mps_separation_find(a->context, &def, most, frequency ? &f->bands : NULL, frequency,
                             incident, reflected, out);
}

static void warn(app *a, const char *what) {
  app_warn(a, "no %s: %s", what, mps_context_error(a->context)->message);
}

/* A separation that is not possible, as with too few samples a wave, is a warning. */
bool flume_separate(app *a, const flume *m, flume_figures *f) {
  const size_t n = (size_t)m->samples;
  const int64_t most = (int64_t)(band_of(m, f).upper * (f->to - f->from)) + 2;
  double *room = malloc(n * (size_t)(m->gauges + 2) * sizeof *room);
  mps_separation target;
  f->frequency = calloc(4 * (size_t)most, sizeof(double));
  if (!room || !f->frequency) {
    free(room);
    return app_no_memory(a);
  }
  part p = {m->front, m->fronts, true, room, room + n, room + 2 * n};
  f->incident = f->frequency + most, f->reflected = f->incident + most;
  f->target = f->reflected + most;
  for (int64_t k = 0; k < m->samples; k++) p.t[k] = m->sample[k].t;
  if (m->fronts >= 2) {
    mps_status status = separate(a, m, f, &p, most, NULL, f->target, NULL, &target);
    p.target = false;
    if (status == MPS_OK)
      status = separate(a, m, f, &p, most, f->frequency, f->incident, f->reflected, &f->split);
    f->separated = status == MPS_OK;
    if (f->separated) f->target_height = target.incident_height;
    if (!f->separated) warn(a, "incident and reflected waves");
  }
  p.gauge = m->rear, p.count = m->rears, p.target = false;
  if (f->separated && m->rears >= 2) {
    f->passed = separate(a, m, f, &p, most, NULL, NULL, NULL, &f->behind) == MPS_OK;
    if (!f->passed) warn(a, "transmitted waves");
  }
  free(room);
  return true;
}
