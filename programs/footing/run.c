/* run.c - settings of mps-footing, and the course of its runs.
 *
 * The capacity q of limit analysis is of ground in its first shape, and does not depend on its
 * stiffness; a footing on soft ground has sunk before it is reached. So ground with E < 1e4 q is
 * computed twice: with 1.6e4 q, which fails after 1/700 of the half width a, and as it is. Path and
 * speed follow from the stiffness: all the ground below yields after some 10 a q/E, and inertia
 * adds about v (rho E)^1/2 to q. SPDX-License-Identifier: BSD-3-Clause */
#include "common/compare.h"
#include "common/ranks.h"
#include "footing.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SOFT 1e4    /* E over q: below, the ground changes its shape before it fails */
#define STIFF 1.6e4 /* of the run that does not */
#define PATH 23.3   /* settlement, a q/E */
/* The same where weight alone bears the base: a smooth one fails after 4.5, a rough one after 6.
 * From there on q grows by a twentieth, or falls, as particles that dilate share the pressure ever
 * less evenly. */
#define WEIGHT_PATH 6.8
#define ROUGH_PATH 11.0
#define PAPER_SAND 4e-3 /* m */
/* Speed, q/(rho E)^1/2: 2 mm/s by default. Sand creeps on for long, the more so where its weight
 * alone gives it strength. Particles keep their share of the motion for a time, of the run. With
 * both, strips and circles on five cells are within 2 % wherever their edges lie, and half the step
 * changes them by less. */
#define CLAY_SPEED 0.039
#define SAND_SPEED 0.0136
#define SLOWER 0.2
#define SLOWER_ROUGH 0.1
/* q over the weight of half a width, N_gamma, below which a smooth base is pressed more slowly, by
 * the root of it: of 30 degrees. */
#define WEAK 7.65
#define CLAY_FLIP 0.067
#define GROWING_FLIP 0.0167 /* of clay that is weakest at the surface: slower */
#define WEIGHT_FLIP 0.085
#define ROUGH_FLIP 0.0245
#define STEEPEST 50.0 /* degrees: the largest --phi */
#define DEGREE (3.14159265358979323846 / 180.0)

/* ---- settings -------------------------------------------------------------------------------- */

bool footing_is_whole(const settings *s) { return s->eccentricity > 0.0; }

bool footing_is_thin(const settings *s) { return s->depth < 1.5 * s->half_width * (1.0 - 1e-9); }

double footing_scale(const settings *s) {
  const footing_limits l = footing_find_limits(s);
  const double one = s->mu > 0.0 ? l.rough : l.smooth, other = s->mu > 0.0 ? l.smooth : l.rough;
  const double top = 5.14 * (s->top > 0.0 ? s->top_cohesion : s->cohesion);
  return isfinite(one) ? one : isfinite(other) ? other : top;
}

/* Of the capacity of sand, what its weight bears. */
static double share_of_weight(const settings *s) {
  settings weightless = *s;
  weightless.gravity = 0.0;
  const bool other = s->cohesion > 0.0 || s->surcharge > 0.0;
  return s->model != DRUCKER_PRAGER || s->gravity == 0.0 ? 0.0
         : other ? 1.0 - footing_scale(&weightless) / footing_scale(s)
                 : 1.0;
}

/* On which the speed depends, Pa: inertia counts most where the ground is weak, at the surface of
 * clay whose strength grows. */
static double slow_scale(const settings *s, double q) {
  if (s->model != DRUCKER_PRAGER)
    return CLAY_SPEED * (s->gradient > 0.0 ? fmin(q, 2.0 * s->cohesion) : q);
  const double share = share_of_weight(s), half_weight = s->density * s->gravity * s->half_width;
  double slower = s->mu > 0.0 ? SLOWER_ROUGH : SLOWER;
  if (s->mu == 0.0 && share > 0.0) slower *= sqrt(fmin(1.0, q / half_weight / WEAK));
  return SAND_SPEED * q * (1.0 - (1.0 - slower) * share);
}

bool footing_weight_bears(const settings *s) { return share_of_weight(s) > 0.5; }

/* What is left open of a run on ground of the modulus `young`. */
static footing_pace pace_of(const settings *s, double young, double rate, double settlement) {
  const bool cone = s->model == DRUCKER_PRAGER;
  const double q = footing_scale(s);
  const double path = !footing_weight_bears(s) ? PATH : s->mu > 0.0 ? ROUGH_PATH : WEIGHT_PATH;
  footing_pace p = {young, rate, settlement};
  if (isnan(rate)) p.rate = slow_scale(s, q) / sqrt(s->density * young);
  if (isnan(settlement)) p.settlement = fmin(0.5, path * q / young) * s->half_width;
  if (isnan(settlement) && s->paper && cone) p.settlement = PAPER_SAND;
  return p;
}

/* Of the time of the path. A slower run has more steps, each of which leaves noise that softens the
 * ground while particles keep it: they keep it for less. NaN: the library's. */
static double usual_flip_time(const settings *s) {
  const bool clay = s->model != DRUCKER_PRAGER;
  const footing_pace *p = &s->pace[FOOTING_UNDEFORMED];
  const double slower = fmin(1.0, p->rate / pace_of(s, p->young, NAN, NAN).rate);
  const double share = clay          ? (s->gradient > 0.0 ? GROWING_FLIP : CLAY_FLIP)
                       : s->mu > 0.0 ? ROUGH_FLIP
                                     : WEIGHT_FLIP;
  if (!clay && !footing_weight_bears(s)) return NAN;
  return share * p->settlement / p->rate * pow(slower, clay ? 3.0 : 2.0);
}

/* The runs: of the ground as it is, and of stiff ground, where they differ. */
static void plan(settings *s) {
  const double q = footing_scale(s), stiff = STIFF * q;
  s->pace[FOOTING_DEFORMED] = pace_of(s, s->young, s->rate, s->settlement);
  s->pace[FOOTING_UNDEFORMED] = s->pace[FOOTING_DEFORMED];
  s->twice = !s->paper && s->young < SOFT * q;
  if (s->twice)
    s->pace[FOOTING_UNDEFORMED] = pace_of(s, stiff, s->rate * sqrt(s->young / stiff), NAN);
  if (!s->paper && isnan(s->flip_time)) s->flip_time = usual_flip_time(s);
  s->rate = s->pace[FOOTING_DEFORMED].rate, s->settlement = s->pace[FOOTING_DEFORMED].settlement;
}

/* By default as wide as a weightless mechanism, and deeper. */
static bool take_ground(settings *s) {
  double *const sides[] = {&s->width, &s->depth};
  if (s->domain) return options_lengths(s->domain, "m", 2, sides);
  const double phi = s->model == DRUCKER_PRAGER ? footing_find_strength(s).phi : 0.0;
  const double fan = tan(0.785398163397 + 0.5 * phi) * exp(1.57079632679 * tan(phi));
  const double wide = 1.1 * (1.0 + (s->mu > 0.0 ? 2.0 : 1.0) * fan);
  const double low = s->model == DRUCKER_PRAGER ? 3.0 : 4.0;
  s->width = s->half_width * fmax(6.0, wide), s->depth = s->half_width * fmax(low, 0.4 * wide);
  s->width = s->h * ceil(s->width / s->h - 1e-9), s->depth = s->h * ceil(s->depth / s->h - 1e-9);
  return true;
}

static const char *check_eccentricity(const settings *s) {
  if (s->eccentricity == 0.0) return NULL;
  if (s->model == DRUCKER_PRAGER || s->shape == CIRCLE || s->top > 0.0 || s->gradient > 0.0 ||
      footing_is_thin(s))
    return "--eccentricity is for a strip on even, deep ground of --law vonmises";
  if (s->eccentricity > s->half_width - 2.0 * s->h * (1.0 - 1e-9))
    return "--eccentricity must be at least 2 cells of --cell less than --half-width";
  return NULL;
}

static const char *check_ground(const settings *s, const option *table) {
  const bool cone = s->model == DRUCKER_PRAGER, grows = s->gradient > 0.0;
  const bool layer = !cone && s->shape == STRIP && !grows;
  if (grows && (cone || s->shape == CIRCLE))
    return "--strength-gradient is for --law vonmises and --shape strip";
  if (grows && s->top > 0.0) return "--strength-gradient and --top exclude each other";
  if (s->width < 3.0 * s->half_width || (!layer && footing_is_thin(s)))
    return "--soil must be at least 3 half widths of the footing wide and 1.5 deep: as far as "
           "the ground moves when it fails; a strip on cohesive ground may have a thinner layer";
  if (s->depth < s->h * (4.0 - 1e-9)) return "--soil must be at least 4 cells of --cell deep";
  if (!cone && options_given(table, "surcharge")) return "--surcharge is for --law druckerprager";
  if ((s->top > 0.0) != (s->top_cohesion > 0.0)) return "--top and --top-cohesion need one another";
  if (cone && s->top > 0.0) return "--top and --top-cohesion are for --law vonmises";
  if (ranks_launched() > 1 && (s->top > 0.0 || s->surcharge > 0.0))
    return "--top and --surcharge are for one process";
  if (s->top > 0.0 && s->top < s->h * (1.0 - 1e-9))
    return "--top must be at least a cell of --cell";
  if (s->top > s->depth - s->h)
    return "--top must leave at least a cell of --cell of the ground below";
  if (s->cohesion == 0.0 && (!cone || (s->gravity == 0.0 && s->surcharge == 0.0)))
    return "--cohesion 0 is for --law druckerprager with weight or --surcharge";
  return NULL;
}

/* A smooth base that weight alone bears: 1 cell up to 35 degrees, from 40 on .95
 * (docs/verification/wls-mpm/footing.md has the capacities). */
static double inset_on_weight(const settings *s) {
  const double degrees = footing_find_strength(s).phi / DEGREE;
  return 1.0 - 0.01 * fmin(fmax(0.0, degrees - 35.0), 5.0);
}

/* An inset that makes a face on this ground as wide as its edges say: more where weight alone bears
 * it, less where a rough base holds such sand. An eccentric load presses ground at rest. */
static double usual_inset(const settings *s) {
  if (s->eccentricity > 0.0) return 0.0;
  if (s->model != DRUCKER_PRAGER) return s->volumetric == MPS_MPM_VOLUMETRIC_POINT ? 0.9 : 0.6;
  if (s->surcharge > 0.0) return 0.65;
  return !footing_weight_bears(s) ? 0.75 : s->mu > 0.0 ? 0.4 : inset_on_weight(s);
}

/* Cones that pass outside the pyramid in plane strain have no limit from some angle on. */
static const char *check_cone(const settings *s) {
  static char why[200];
  const double phi = footing_find_strength(s).phi / DEGREE;
  if (s->model != DRUCKER_PRAGER || !(phi > STEEPEST + 1e-9)) return NULL;
  (void)snprintf(
      why, sizeof why,
      "--cone and --phi give the ground %s %.3g degrees in plane strain, must be at most "
      "%g: take --cone planestrain, or less --phi",
      phi < 90.0 - 1e-9 ? "an angle of friction of" : "more than", phi, STEEPEST);
  return why;
}

const char *footing_settle(settings *s, const option *table) {
  const bool cone = s->model == DRUCKER_PRAGER;
  const char *steep = check_cone(s);
  if (steep) return steep;
  if (!take_ground(s)) return "--soil must be two lengths in m, WxH, such as 5x2";
  options_whole("soil", &s->width, "--cell", s->h);
  options_whole("soil", &s->depth, "--cell", s->h);
  if (!cone &&
      (options_given(table, "phi") || options_given(table, "psi") || options_given(table, "e0") ||
       options_given(table, "emax") || options_given(table, "cone")))
    return "--phi, --psi, --e0, --emax and --cone are for --law druckerprager";
  if (cone && s->shape == CIRCLE) return "--shape circle is for --law vonmises";
  if (s->contact == MPS_CONTACT_METHOD_PENALTY && options_given(table, "corner"))
    return "--corner is for --contact impulse";
  if (isnan(s->gravity)) s->gravity = cone ? 9.81 : 0.0;
  const char *edges =
      mpm_model_settle_edges(table, s->contact, usual_inset(s), &s->corner, &s->inset);
  if (edges) return edges;
  const double cells = (footing_is_whole(s) ? 2.0 : 1.0) * s->width * s->depth / (s->h * s->h);
  const char *large = mpm_model_too_large(cells * (double)s->ppc);
  if (large) return large;
  const char *eccentric = check_eccentricity(s);
  if (eccentric) return eccentric;
  if (s->half_width < s->h * (2.0 - 1e-9)) return "--half-width must be at least 2 cells of --cell";
  const char *ground = check_ground(s, table);
  if (ground) return ground;
  if (s->top > 0.0)
    options_whole("top", &s->top, "the particles' spacing", s->h / sqrt((double)s->ppc));
  if (isnan(s->psi)) s->psi = s->phi;
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (sand_check(&s->voids)) return sand_check(&s->voids);
  plan(s);
  if (s->settlement > 0.5 * s->half_width * (1.0 + 1e-9))
    return "--settlement must be at most half of --half-width";
  if (s->section > s->width || s->section < (footing_is_whole(s) ? -s->width : 0.0))
    return "--section must be in the ground, whose left side is 0, or of an eccentric load the "
           "width of --soil to the left";
  return NULL;
}

/* ---- runs ------------------------------------------------------------------------------------ */

/* The run so far, for a restart; the rows of the present one are in the solver's history. */
static void pass(void *user, resume_bytes *b) {
  simulation *sim = user;
  resume_pass(b, &sim->now, sizeof sim->now);
  resume_pass(b, &sim->undeformed_rows, sizeof sim->undeformed_rows);
  if (resume_wrong(b, sim->now < 0 || sim->now > FOOTING_DEFORMED || sim->undeformed_rows < 0 ||
                          sim->undeformed_rows > FOOTING_SAMPLES)) {
    sim->now = sim->undeformed_rows = 0;
    return;
  }
  resume_pass(b, sim->undeformed, (size_t)sim->undeformed_rows * sizeof *sim->undeformed);
}

static void name_course(simulation *sim) {
  static const rows_column columns[] = {
      {"settlement", "m", 0}, {"pressure", "Pa", 0}, {"impulse", "N s", 0}, {0}};
  settings *s = &sim->s;
  const footing_pace *p = &s->pace[sim->now];
  s->run = *p;
  const bool lost = sim->course.saves.lost;
  sim->course = mpm_course_of(&s->course, &sim->m, s->out, "mps-footing 5", pass, sim);
  sim->course.what = s->twice && sim->now == 0 ? "ground_undeformed" : "ground";
  sim->course.duration = p->settlement / p->rate;
  sim->course.columns = columns;
  sim->course.saves.lost = lost;
}

mps_status footing_build(mps_context *context, void *user) {
  simulation *sim = user;
  sim->context = context;
  name_course(sim);
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = mpm_course_load(&sim->course, context); /* which run it is */
  name_course(sim);
  if (status == MPS_OK) status = footing_build_model(context, sim);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* A sample of the path: the position of the footing, and the pressure on it, from the impulse since
 * the last sample. */
static mps_status take_sample(simulation *sim) {
  const settings *s = &sim->s;
  mps_reaction reaction;
  mps_body_state body;
  mps_status status = mps_body_get_reaction(sim->m.body[0], -1, &reaction);
  if (status == MPS_OK) status = mps_body_get_state(sim->m.body[0], &body);
  if (status != MPS_OK) return status;
  const int rows = footing_rows(sim);
  const footing_row last = rows > 0 ? *footing_row_of(sim, rows - 1) : (footing_row){0};
  footing_row now = {.t = mps_mpm_time(sim->m.mpm), .impulse = reaction.impulse[1]};
  now.path = s->depth + 0.5 * s->half_width - body.position[1];
  now.q = (now.impulse - last.impulse) / (now.t - last.t) / footing_area(s);
  return mpm_course_add(&sim->course, &now);
}

/* The path in equal parts. */
static mps_status march_one(simulation *sim) {
  const double share = sim->s.twice ? 0.5 : 1.0;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, share * sim->now, share, 0.0, sim->t_end);
  if (footing_rows(sim) == 0) status = mpm_course_sample(&sim->course, 0, FOOTING_SAMPLES);
  while (footing_rows(sim) < FOOTING_SAMPLES && status == MPS_OK) {
    const double t = sim->t_end * (footing_rows(sim) + 1) / FOOTING_SAMPLES;
    status = mpm_model_advance(&sim->m, t, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = take_sample(sim);
    if (status == MPS_OK)
      status = mpm_course_sample(&sim->course, footing_rows(sim), FOOTING_SAMPLES);
  }
  return mpm_course_end(&sim->course, status);
}

/* Keeps the first run's rows, and makes the second. */
static mps_status go_on(simulation *sim) {
  sim->undeformed_rows = footing_rows(sim);
  memcpy(sim->undeformed, sim->course.rows.row,
         (size_t)sim->undeformed_rows * sizeof *sim->undeformed);
  mpm_model_destroy(&sim->m);
  sim->now = FOOTING_DEFORMED;
  name_course(sim);
  const mps_status status = footing_build_model(sim->context, sim);
  return status == MPS_OK ? mpm_course_begin(&sim->course, sim->context, false) : status;
}

/* Of the mean over the last fifth of the path in ground of the first shape. */
static void warn_of_bound(const simulation *sim) {
  const bool kept = sim->now == FOOTING_DEFORMED;
  const footing_row *row = kept ? sim->undeformed : sim->course.rows.row;
  if ((kept ? sim->undeformed_rows : footing_rows(sim)) < FOOTING_SAMPLES) return;
  const footing_row *last = row + FOOTING_SAMPLES - 1, *from = last - FOOTING_SAMPLES / 5;
  const double q = (last->impulse - from->impulse) / (last->t - from->t) / footing_area(&sim->s);
  compare_bound(sim->m.a, "the bearing capacity", q, footing_find_limits(&sim->s).source,
                footing_find_bound(&sim->s));
}

mps_status footing_march(void *user) {
  simulation *sim = user;
  mps_particles *whole;
  mps_status status = march_one(sim);
  if (status == MPS_OK && sim->s.twice && sim->now == FOOTING_UNDEFORMED) {
    status = go_on(sim);
    if (status == MPS_OK) status = march_one(sim);
  }
  warn_of_bound(sim);
  mps_status brought = mpm_model_whole(&sim->m, &whole); /* for footing_finish */
  if (brought == MPS_OK && status == MPS_OK) brought = footing_take_section(sim);
  return status == MPS_OK ? brought : status;
}
