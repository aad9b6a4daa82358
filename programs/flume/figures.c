/* figures.c - what a run of mps-flume is about: incident and reflected waves and the target in the
 * same window, forces beside Goda's, safeties of a caisson, discharge beside EurOtop's, loss of
 * height. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/progress.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MEAN_OF_MAKER 0.02   /* of the height, m */
#define LEAST_OF_STORM 100.0 /* periods, of a mean discharge */

static bool in_window(const flume_figures *f, double t) {
  return t >= f->from - 1e-9 && t <= f->to + 1e-9;
}

/* ---- the window ------------------------------------------------------------------------------ */

static double group_velocity(const flume_settings *s, double wave_length) {
  const double kd = 2.0 * WAVES_PI * s->depth / wave_length;
  return 0.5 * (1.0 + 2.0 * kd / sinh(2.0 * kd)) * wave_length / s->period;
}

/* From when waves have been to the wall and half the way back, to the end; a whole number of
 * periods of regular waves. */
static bool find_window(const flume *m, flume_figures *f) {
  const flume_settings *s = &m->s;
  const double first = m->samples ? m->sample[0].t : 0.0;
  const double last = m->samples ? m->sample[m->samples - 1].t : 0.0;
  const double way = 1.5 * m->toe / group_velocity(s, m->wave_length);
  f->from = fmax(isnan(s->window[0]) ? s->ramp + way : s->window[0], first);
  f->to = fmin(isnan(s->window[1]) ? last : s->window[1], last);
  if (s->waves == FLUME_REGULAR)
    f->to = f->from + floor((f->to - f->from) / s->period + 1e-6) * s->period;
  return f->to - f->from >= 2.0 * s->period * (1.0 - 1e-9);
}

/* ---- waves ----------------------------------------------------------------------------------- */

/* Slope of the logarithm of the levels' deviations over gauges that span a wave length at least. */
static void find_loss(const flume *m, flume_figures *f) {
  double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, least = INFINITY, most = -INFINITY;
  for (int j = 0; j < m->fronts; j++) {
    const int g = m->front[j];
    double sum = 0.0, square = 0.0, n = 0.0;
    for (int64_t k = 0; k < m->samples; k++) {
      const double level = m->sample[k].level[g];
      if (!in_window(f, m->sample[k].t) || isnan(level)) continue;
      sum += level, square += level * level, n += 1.0;
    }
    least = fmin(least, m->s.gauge[g]), most = fmax(most, m->s.gauge[g]);
    const double x = m->s.gauge[g] / m->wave_length, variance = square / n - sum * sum / (n * n);
    const double y = 0.5 * log(variance);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  const double n = m->fronts, spread = sxx - sx * sx / n;
  if (most - least >= m->wave_length) f->loss = -(sxy - sx * sy / n) / spread;
}

/* ---- loads ----------------------------------------------------------------------------------- */

typedef struct safety {
  double sliding, overturning;
} safety;

static void keep_least(safety *least, double weight, double arm, double friction, double force,
                       double moment, double uplift, double uplift_moment) {
  if (force > 0.0) least->sliding = fmin(least->sliding, friction * (weight - uplift) / force);
  if (moment > 0.0)
    least->overturning = fmin(least->overturning, (weight * arm - uplift_moment) / moment);
}

/* Of the base of a caisson, front to heel. */
static double base_width(const flume *m) {
  double least = INFINITY;
  for (int k = 0; k < m->shape.body; k++)
    if (fabs(m->shape.body_point[k][1] - m->heel[1]) < 1e-9)
      least = fmin(least, m->shape.body_point[k][0]);
  return flume_has_body(m) ? m->heel[0] - least : m->s.width;
}

/* A triangle from the wave's pressure at the foot to 0 at the heel. */
static double triangle_uplift(const flume *m, const flume_sample *p) {
  return 0.5 * base_width(m) * fmax(p->foot - m->rest.foot, 0.0);
}

static void find_safeties(const flume *m, const flume_sample *p, safety *stated, safety *bedding) {
  const flume_rest *r = &m->rest;
  const double force = p->force - r->force, moment = p->moment - r->moment;
  const double U = triangle_uplift(m, p);
  keep_least(stated, r->weight, r->arm, m->s.friction, force, moment, U,
             2.0 / 3.0 * U * base_width(m));
  if (flume_has_body(m))
    keep_least(bedding, r->weight, r->arm, m->s.friction, force, moment, p->uplift - r->uplift,
               p->uplift_moment - r->uplift_moment);
}

static void find_forces(const flume *m, flume_figures *f) {
  safety stated = {INFINITY, INFINITY}, bedding = stated;
  f->force_peak = -INFINITY, f->force_least = INFINITY;
  for (int64_t k = 0; k < m->samples; k++) {
    const flume_sample *p = &m->sample[k];
    if (!in_window(f, p->t)) continue;
    f->force_least = fmin(f->force_least, p->force);
    if (flume_is_caisson(m)) find_safeties(m, p, &stated, &bedding);
    if (p->force <= f->force_peak) continue;
    f->force_peak = p->force, f->peak_at = p->t, f->foot_peak = p->foot - m->rest.foot;
    f->uplift_peak = p->uplift - m->rest.uplift, f->uplift_triangle = triangle_uplift(m, p);
  }
  f->sliding = stated.sliding, f->overturning = stated.overturning;
  f->sliding_bedding = bedding.sliding, f->overturning_bedding = bedding.overturning;
}

/* Depth over the rock just before a body, at most that of its base. */
static double berm_depth(const flume *m, double front) {
  double top = 0.0;
  for (double y = 0.0; y < m->s.depth; y += 0.25 * m->s.spacing)
    if (flume_rock_at(m, front - m->s.spacing, y) >= 0) top = y + 0.25 * m->s.spacing;
  return m->s.depth - fmax(top, m->heel[1]);
}

/* Height and period of the design wave. */
static void find_goda(app *a, const flume *m, flume_figures *f) {
  const flume_settings *s = &m->s;
  const bool regular = s->waves == FLUME_REGULAR, caisson = flume_is_caisson(m);
  mps_goda_def def = mps_goda_defaults();
  f->front = m->heel[0] - base_width(m);
  if (s->wall != FLUME_VERTICAL && !caisson) return;
  def.height = f->split.incident_height * (regular ? sqrt(0.5) : 1.8);
  def.period = regular ? s->period : f->split.peak_period;
  const double front = flume_has_body(m) ? f->front : m->toe;
  def.depth = s->depth - flume_ground_at(m, front - 0.5 * s->spacing);
  def.crest = s->wall == FLUME_CAISSON ? s->crest : 10.0 * s->depth;
  def.width = caisson ? base_width(m) : s->depth;
  if (caisson) def.weight = m->rest.weight, def.arm = m->rest.arm;
  if (flume_has_body(m)) {
    double top = -INFINITY;
    for (int k = 0; k < m->shape.body; k++) top = fmax(top, m->shape.body_point[k][1]);
    def.crest = top - s->depth;
    def.base = s->depth - m->heel[1];
    def.berm_depth = berm_depth(m, m->heel[0] - def.width);
  }
  f->front = m->heel[0] - def.width, f->crest = def.crest;
  def.friction = s->friction, def.density = WAVES_DENSITY, def.gravity = WAVES_G;
  f->has_goda = mps_goda_evaluate(a->context, &def, &f->goda) == MPS_OK;
  if (!f->has_goda) app_warn(a, "no force by Goda: %s", mps_context_error(a->context)->message);
}

/* Of regular waves at an upright wall on a level bed. */
static void find_sainflou(app *a, const flume *m, flume_figures *f) {
  const flume_settings *s = &m->s;
  const bool upright = s->wall == FLUME_VERTICAL || s->wall == FLUME_CAISSON;
  mps_sainflou_def def = mps_sainflou_defaults();
  mps_sainflou answer;
  if (s->waves != FLUME_REGULAR || !upright || m->ground[m->grounds - 1][1] != 0.0) return;
  def.height = f->split.incident_height * sqrt(0.5), def.period = s->period, def.depth = s->depth;
  def.density = WAVES_DENSITY, def.gravity = WAVES_G;
  if (mps_sainflou_evaluate(a->context, &def, &answer) == MPS_OK)
    f->force_sainflou = answer.crest_force - 0.5 * WAVES_DENSITY * WAVES_G * s->depth * s->depth;
  else
    app_warn(a, "no force by Sainflou: %s", mps_context_error(a->context)->message);
}

static double passed_at(const flume *m, double t) {
  double volume = 0.0;
  for (int64_t k = 0; k < m->samples && m->sample[k].t <= t + 1e-9; k++)
    volume = m->sample[k].volume;
  return volume;
}

static void warn_of_places(app *a, const flume *m, const flume_figures *f) {
  const double most = MEAN_OF_MAKER * m->s.height;
  if (m->maker && fabs(f->mean_maker) > most)
    app_warn(a,
             "the maker stood %.3g m from its place in the mean, more than %g of the waves' height",
             f->mean_maker, MEAN_OF_MAKER);
  if (m->end && fabs(f->mean_end) > most)
    app_warn(a,
             "the far piston stood %.3g m from its place in the mean, more than %g of the waves' "
             "height",
             f->mean_end, MEAN_OF_MAKER);
}

/* Means over the window of the level at the gauges before structure, rock or zone, of the water
 * before the crest, and of the pistons, whose way from their places is water that the level lacks.
 */
static void find_means(app *a, const flume *m, flume_figures *f) {
  double maker = 0.0, end = 0.0, level = 0.0, levels = 0.0, water = 0.0, samples = 0.0;
  const double filled = (double)m->filled * m->s.spacing * m->s.spacing;
  for (int64_t k = 0; k < m->samples; k++) {
    if (!in_window(f, m->sample[k].t)) continue;
    water += m->sample[k].water / filled, samples += 1.0;
    maker += m->sample[k].maker, end += m->sample[k].end;
    for (int j = 0; j < m->fronts; j++) {
      const double here = m->sample[k].level[m->front[j]];
      if (!isnan(here)) level += here, levels += 1.0;
    }
  }
  f->mean_level = level / levels;
  f->mean_maker = maker / samples;
  if (m->end) f->mean_end = end / samples;
  warn_of_places(a, m, f);
  if (m->filled > 0) f->water = water / samples;
  flume_warn_of_collisions(a, m);
}

static void find_discharge(app *a, const flume *m, flume_figures *f) {
  const flume_settings *s = &m->s;
  mps_eurotop_def def = mps_eurotop_defaults();
  if (!flume_is_open(m)) return;
  f->discharge = (passed_at(m, f->to) - passed_at(m, f->from)) / (f->to - f->from);
  if (s->waves == FLUME_REGULAR || !(s->wall == FLUME_CAISSON || s->wall == FLUME_SLOPE)) return;
  def.wall = s->wall == FLUME_SLOPE ? MPS_EUROTOP_WALL_SLOPE : MPS_EUROTOP_WALL_VERTICAL;
  def.height = f->split.incident_height, def.period = f->split.energy_period;
  def.depth = s->depth, def.crest = s->crest, def.cotangent = s->cotangent;
  def.gravity = WAVES_G;
  f->has_eurotop = mps_eurotop_evaluate(a->context, &def, &f->eurotop) == MPS_OK;
  if (f->has_eurotop && f->to - f->from < LEAST_OF_STORM * s->period)
    app_warn(a, "the window has some %.0f waves: the formula's mean discharge is that of hundreds",
             (f->to - f->from) / s->period);
  if (!f->has_eurotop)
    app_warn(a, "no discharge by EurOtop: %s", mps_context_error(a->context)->message);
}

/* Of a sea from a dike, tanh(a xi^b), a = .167 (1 - exp(-3.2 gamma)), b = 1.49 (gamma - .38)^2 +
 * .86 with the roughness gamma = 1 of smooth slopes, xi by Hm0 and T(m-1,0) in deep water, for
 * crests of .5 Hm0 and more (Zanuttigh and van der Meer 2008). */
static void find_reflection(const flume *m, flume_figures *f) {
  const flume_settings *s = &m->s;
  const double H = f->split.incident_height, T = f->split.energy_period;
  if (s->wall != FLUME_SLOPE || s->waves == FLUME_REGULAR || s->crest < 0.5 * H) return;
  const double xi = sqrt(WAVES_G * T * T / (2.0 * WAVES_PI * H)) / s->cotangent;
  f->reflection = tanh(0.167 * (1.0 - exp(-3.2)) * pow(xi, 1.49 * 0.62 * 0.62 + 0.86));
}

/* ---- all ------------------------------------------------------------------------------------- */

bool flume_find_figures(app *a, flume *m, flume_figures *f) {
  memset(f, 0, sizeof *f);
  f->target_height = f->sliding = f->overturning = f->discharge = f->loss = NAN;
  f->mean_level = f->mean_maker = f->mean_end = f->water = NAN;
  f->run_up = f->run_up_layer = f->run_up_mean = f->run_up_highest = NAN;
  f->force_mean = f->force_harmonic = f->force_linear = f->force_sainflou = NAN;
  f->bound = f->bound_stokes = f->unbound = f->back = f->length = NAN;
  f->force_peak = f->force_least = f->foot_peak = f->peak_at = NAN;
  f->uplift_peak = f->uplift_triangle = f->sliding_bedding = f->overturning_bedding = NAN;
  f->force_still = m->rest.force;
  if (!flume_find_thin(a, m, f)) return false;
  f->reflection = f->thrown = NAN;
  f->crest_first = f->crest_last = f->speed = f->trailing = NAN;
  if (m->s.waves == FLUME_SOLITARY) {
    f->from = 0.0, f->to = m->samples ? m->sample[m->samples - 1].t : 0.0;
    flume_find_solitary(m, f);
    if (flume_is_loaded(m)) find_forces(m, f);
    return flume_find_run_up(a, m, f);
  }
  if (!find_window(m, f)) {
    if (!progress_interrupted()) /* else its own line says enough */
      app_warn(
          a,
          "the run is too short for incident and reflected waves, which need two periods from %.4g "
          "s on",
          f->from);
    return true;
  }
  if (m->gauges >= 2 && !flume_separate(a, m, f)) return false;
  find_means(a, m, f);
  if (flume_is_loaded(m)) find_forces(m, f);
  if (!flume_is_loaded(m) && m->shape.rocks == 0 && m->fronts >= 3) find_loss(m, f);
  flume_find_regular_forces(m, f);
  flume_find_harmonics(m, f);
  if (f->separated) find_goda(a, m, f);
  if (f->separated) find_sainflou(a, m, f);
  if (f->separated) find_discharge(a, m, f);
  flume_find_thrown(a, m, f);
  if (f->separated) find_reflection(m, f);
  return flume_find_run_up(a, m, f);
}

void flume_free_figures(flume_figures *f) {
  free(f->frequency);
  free(f->thin);
  memset(f, 0, sizeof *f);
}
