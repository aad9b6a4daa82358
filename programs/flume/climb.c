/* climb.c - how the water climbs the structure of mps-flume: the head of the level before an
 * upright face over its crest, and the tongue on a slope; from their records the discharge of
 * events too low for particles, that of particles thrown over a crest, and run-up beside
 * EurOtop's.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/tongue.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Heads, in spacings, that are continued: of events that are lower than this less than half of the
 * law of the weir passes in particles (docs/verification/fluid/flume.md). */
#define THIN 1.3
#define PAUSE 0.25    /* periods, between two events */
#define STATION 2.0   /* spacings before the face: as far as the weights of a level reach */
#define UPRIGHT 0.1   /* most of run over rise of an upright face */
#define GENTLEST 0.01 /* least and most tangent of a slope whose tongue is read */
#define STEEPEST 1.0
#define EDGE 2.0 /* spacings along the slope from its end: a layer within them has passed it */
#define MOST_THROWN 0.1 /* of the discharge, from which on it is warned of */
#define LEAST_WAVES 50  /* for what 2 % of them exceed */

/* ---- the structure --------------------------------------------------------------------------- */

/* The front edge of the crest, above a face that is upright from below the water at rest. */
static bool find_crest(const flume *m, double *edge) {
  const flume_shapes *p = &m->shape;
  int top = 0;
  if (!flume_is_open(m)) return false;
  for (int k = 1; k < p->structure; k++)
    if (p->structure_point[k][1] > p->structure_point[top][1] + 1e-9) top = k;
  if (top == 0) return false;
  const double *foot = p->structure_point[top - 1];
  memcpy(edge, p->structure_point[top], 2 * sizeof *edge);
  return fabs(edge[0] - foot[0]) <= UPRIGHT * (edge[1] - foot[1]) &&
         foot[1] <= m->s.depth - 2.0 * m->s.spacing;
}

bool flume_has_head(const flume *m) {
  double edge[2];
  return find_crest(m, edge);
}

/* The first part of the face, where it leaves the water at rest. */
static bool find_slope(const flume *m, tongue_slope *slope) {
  const double *a = m->shape.structure_point[0], *b = m->shape.structure_point[1];
  if (!flume_has_structure(m) || !(a[1] < m->s.depth && b[1] > m->s.depth)) return false;
  const double run = b[0] - a[0], rise = b[1] - a[1];
  *slope = (tongue_slope){{a[0], a[1]}, atan2(rise, run), hypot(run, rise)};
  return run > 0.0 && rise >= GENTLEST * run && rise <= STEEPEST * run;
}

bool flume_has_slope(const flume *m) {
  tongue_slope slope;
  return find_slope(m, &slope);
}

/* ---- samples --------------------------------------------------------------------------------- */

mps_status flume_measure_climb(flume *m, flume_sample *sample) {
  double edge[2], level;
  tongue_slope slope;
  tongue t;
  sample->head = sample->run_up = sample->resolved = sample->layer = NAN;
  if (find_crest(m, edge)) {
    const double station = edge[0] - STATION * m->s.spacing;
    const mps_status status = mps_fluid_get_levels(m->fluid, 1, &station, &level);
    if (status != MPS_OK) return status;
    sample->head = level - edge[1];
  }
  if (!find_slope(m, &slope)) return MPS_OK;
  if (!tongue_find(m->water, &slope, m->s.spacing, &t)) return MPS_ERROR_MEMORY;
  const double low = slope.foot[1] - m->s.depth, rise = sin(slope.angle);
  sample->layer = low + t.layer * rise;
  if (isfinite(t.end))
    sample->run_up = low + t.end * rise, sample->resolved = low + t.resolved * rise;
  return MPS_OK;
}

/* ---- discharge of low heads ------------------------------------------------------------------ */

bool flume_find_thin(app *a, const flume *m, flume_figures *f) {
  const size_t n = (size_t)m->samples;
  mps_overtopping_def def = mps_overtopping_defaults();
  mps_overtopping out;
  if (!flume_has_head(m) || n < 2) return true;
  double *room = malloc(3 * n * sizeof *room);
  f->thin = calloc(n, sizeof *f->thin);
  if (!room || !f->thin) {
    free(room);
    return app_no_memory(a);
  }
  for (size_t k = 0; k < n; k++) {
    room[k] = m->sample[k].t, room[n + k] = m->sample[k].head;
    room[2 * n + k] = m->sample[k].volume;
  }
  def.samples = m->samples, def.times = room, def.heads = room + n, def.volumes = room + 2 * n;
  def.resolved = THIN * m->s.spacing, def.pause = PAUSE * m->s.period;
  def.depth = m->s.depth - m->shape.structure_point[0][1], def.gravity = WAVES_G;
  const mps_status status = mps_overtopping_find(a->context, &def, m->samples, f->thin, &out);
  f->thin_events = out.thin_events;
  free(room);
  return app_check(a, status);
}

/* Between two times (s). */
double flume_thin_between(const flume *m, const flume_figures *f, double from, double to) {
  double first = 0.0, last = 0.0;
  for (int64_t k = 0; f->thin && k < m->samples; k++) {
    if (m->sample[k].t <= from + 1e-9) first = f->thin[k];
    if (m->sample[k].t <= to + 1e-9) last = f->thin[k];
  }
  return f->thin ? (last - first) / (to - from) : NAN;
}

/* ---- particles thrown over a crest ------------------------------------------------------------
 */

/* The highest reading of the layer on the slope in a period before sample k and at it. */
static double layer_before(const flume *m, int64_t k) {
  double most = -INFINITY;
  for (int64_t j = k; j >= 0 && m->sample[j].t >= m->sample[k].t - m->s.period; j--)
    most = fmax(most, m->sample[j].layer);
  return most;
}

/* Water flows over a crest where the layer on the slope before it has come to its end: the last
 * particle of one that has lies within EDGE spacings of that. What passes else is thrown. */
void flume_find_thrown(app *a, const flume *m, flume_figures *f) {
  tongue_slope slope;
  if (!flume_is_open(m) || !find_slope(m, &slope) || isnan(f->discharge)) return;
  const double end = slope.length - EDGE * m->s.spacing;
  const double edge = slope.foot[1] - m->s.depth + end * sin(slope.angle);
  double thrown = 0.0, highest = -INFINITY;
  for (int64_t k = 1; k < m->samples; k++) {
    const double passed = m->sample[k].volume - m->sample[k - 1].volume;
    if (m->sample[k].t < f->from || m->sample[k].t > f->to) continue;
    highest = fmax(highest, m->sample[k].layer);
    if (passed > 0.0 && layer_before(m, k) < edge) thrown += passed;
  }
  f->thrown = thrown / (f->to - f->from);
  if (f->thrown > MOST_THROWN * f->discharge)
    app_warn(
        a,
        "%.3g of the %.3g m2/s have passed the crest in particles that breakers throw up, while "
        "the layer on the slope stayed below it, at %.3g m at most: water of the spacing "
        "squared each, which no formula has",
        f->thrown, f->discharge, highest);
}

/* ---- run-up ---------------------------------------------------------------------------------- */

static int compare_heights(const void *a, const void *b) {
  const double p = *(const double *)a, q = *(const double *)b;
  return p < q ? 1 : p > q ? -1 : 0;
}

static double reading(const flume_sample *p, bool layer) { return layer ? p->layer : p->run_up; }

/* The highest reading of each climb, from one crossing of the mean upwards to the next, in falling
 * order. */
static int64_t find_climbs(const flume *m, const flume_figures *f, bool layer, double *height) {
  double sum = 0.0, n = 0.0, before = NAN, top = NAN;
  int64_t count = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int64_t k = 0; k < m->samples; k++) {
      const double t = m->sample[k].t, now = reading(&m->sample[k], layer);
      if (t < f->from || t > f->to || isnan(now)) continue;
      if (pass == 0) {
        sum += now, n += 1.0;
        continue;
      }
      if (before < sum / n && now >= sum / n) {
        if (!isnan(top)) height[count++] = top;
        top = now;
      }
      if (!isnan(top)) top = fmax(top, now);
      before = now;
    }
  qsort(height, (size_t)count, sizeof *height, compare_heights);
  return count;
}

/* Incident waves of the window by crossings at the gauges, their mean. */
static bool count_waves(const flume *m, const flume_figures *f, double *waves) {
  *waves = 0.0;
  for (int g = 0; g < m->gauges; g++) {
    flume_statistics s;
    if (!flume_find_statistics(m, g, f->from, f->to, &s)) return false;
    *waves += (double)s.waves / m->gauges;
  }
  return true;
}

/* What a share of `waves` waves exceeds, of `count` climbs in falling order, linear between two. */
static double exceeded(const double *height, int64_t count, double rank) {
  const int64_t k = (int64_t)floor(rank);
  if (k < 1 || k >= count) return NAN;
  return height[k - 1] + (rank - (double)k) * (height[k] - height[k - 1]);
}

static void find_formula(app *a, const flume *m, flume_figures *f) {
  tongue_slope slope;
  mps_eurotop_def def = mps_eurotop_defaults();
  if (m->s.waves == FLUME_REGULAR || !f->separated || !find_slope(m, &slope)) return;
  def.wall = MPS_EUROTOP_WALL_SLOPE;
  def.height = f->split.incident_height, def.period = f->split.energy_period;
  def.depth = m->s.depth - slope.foot[1], def.cotangent = 1.0 / tan(slope.angle);
  def.gravity = WAVES_G;
  f->has_formula = mps_eurotop_find_run_up(a->context, &def, &f->formula) == MPS_OK;
}

/* Of a solitary wave: the highest reading of all. */
static void find_single_climb(const flume *m, flume_figures *f) {
  for (int64_t k = 0; k < m->samples; k++)
    f->run_up_highest = fmax(f->run_up_highest, m->sample[k].run_up);
  f->climbs = isnan(f->run_up_highest) ? 0 : 1, f->run_up_mean = f->run_up_highest;
}

bool flume_find_run_up(app *a, const flume *m, flume_figures *f) {
  double waves = 0.0, sum = 0.0;
  if (!flume_has_slope(m)) return true;
  if (m->s.waves == FLUME_SOLITARY) {
    find_single_climb(m, f);
    return true;
  }
  double *height = calloc((size_t)m->samples + 1, sizeof *height);
  if (!height || !count_waves(m, f, &waves)) {
    free(height);
    return app_no_memory(a);
  }
  /* a layer that has reached the end of the face has passed it */
  const double *top = m->shape.structure_point[1];
  const bool many = waves >= LEAST_WAVES;
  int64_t count = find_climbs(m, f, true, height);
  if (many) f->run_up_layer = exceeded(height, count, 0.02 * waves);
  if (f->run_up_layer > top[1] - m->s.depth - 2.0 * m->s.spacing) f->run_up_layer = NAN;
  count = find_climbs(m, f, false, height);
  for (int64_t k = 0; k < count; k++) sum += height[k];
  f->climbs = count;
  if (count > 0) f->run_up_highest = height[0], f->run_up_mean = sum / (double)count;
  if (many) f->run_up = exceeded(height, count, 0.02 * waves);
  find_formula(a, m, f);
  free(height);
  return true;
}
