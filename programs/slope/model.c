/* model.c - ground of a slope with a strength divided by a factor, and its motion.
 *
 * The ground begins at rest with the geostatic stress below its surface, which is no equilibrium:
 * it adjusts elastically within some times H/c of a wave, or flows where the strength does not
 * suffice. The slope has failed by loss of equilibrium: the hundredth part of its particles that
 * moves most does not come to rest. A flow's speed is of the order of g H/c times the share of the
 * strength that is missing, as grid and transfers resist it like a viscosity of rho c h; so rest is
 * a speed below 1e-3 g H/c, whatever the stiffness. Equilibrium is that of the first shape, since
 * the modulus of a trial is at least 1e4 times the stress. SPDX-License-Identifier: BSD-3-Clause */
#include "slope.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define AT_REST 1e-3 /* of the largest kinetic energy */
#define FAR 0.05     /* of the height: what has run out has moved more */

#define STIFF 1e4   /* of the greatest stress: no ground changes its shape before it fails */
#define WAVES 100.0 /* (H + base)/c, the time of a trial */
#define WINDOW 6    /* samples over which a speed is taken on the way */
#define STEADY 0.8  /* of the speed in the window before: it does not come to rest */

double slope_young(const settings *s) {
  const double stress = s->density * s->gravity * (s->height + s->base);
  return s->runout ? s->young : fmax(s->young, STIFF * stress);
}

static double wave_speed(const settings *s) { return sqrt(slope_young(s) / s->density); }

double slope_duration(const settings *s) {
  return s->runout ? s->falls * sqrt(s->height / s->gravity)
                   : WAVES * (s->height + s->base) / wave_speed(s);
}

double slope_speed(const settings *s, const trial *t, int samples) {
  const int last = t->rows - 1, first = last - samples;
  if (first < 0) return NAN;
  const double speed = (t->moved[last] - t->moved[first]) / (t->t[last] - t->t[first]);
  return speed * wave_speed(s) / (s->gravity * s->height);
}

/* ---- ground ---------------------------------------------------------------------------------- */

/* x grows from the crest to the toe; ground below the toe's level where there is a base. */
static mps_status fill(const settings *s, mps_particles *set) {
  const double edge = s->crest, foot = s->crest + s->slope * s->height, top = s->base + s->height;
  const double deep[] = {0.0,  0.0,     foot + s->toe, 0.0, foot + s->toe, s->base,
                         foot, s->base, edge,          top, 0.0,           top};
  const double bare[] = {0.0, 0.0, foot, 0.0, edge, top, 0.0, top};
  return s->base > 0.0 ? mps_particles_fill_polygon(set, 6, deep, NULL)
                       : mps_particles_fill_polygon(set, 4, bare, NULL);
}

/* The geostatic stress below a surface as the slope's; a vertical cut is a steep one. */
static mps_status set_stress(const settings *s, mps_particles *set) {
  const mps_geostatic_layer layer = {
      .thickness = INFINITY, .k0 = s->poisson / (1.0 - s->poisson), .density = NAN};
  const double run = fmax(s->slope * s->height, 1e-6 * s->height);
  const double line[] = {s->crest, s->base + s->height, s->crest + run, s->base};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.layers = &layer, def.layer_count = 1;
  def.gravity = s->gravity;
  def.surface_line = line, def.surface_points = 2;
  return mps_particles_set_geostatic(set, &def);
}

/* The cohesion that grows with the depth below the crest, `law` having the largest, at the base. */
static mps_status let_grow(const settings *s, double largest, mps_particles *set,
                           mps_context *context, mps_material **law) {
  const double deep = s->base + s->height, depth[] = {0.0, deep};
  const double factor[] = {s->cohesion / largest, 1.0};
  mps_geostatic_def ground = mps_geostatic_defaults();
  mps_material *even = *law;
  ground.surface = deep;
  *law = NULL;
  mps_status status = mps_particles_set_profile(set, "strength_factor", 2, depth, factor, &ground);
  if (status == MPS_OK) status = mps_material_create_by_field(context, even, law);
  mps_material_destroy(&even);
  return status;
}

static mps_status make_law(simulation *sim) {
  const settings *s = &sim->s;
  const double largest = s->cohesion + s->gradient * (s->base + s->height);
  const double factor = sim->trial[sim->now].factor;
  mps_material_mohr_coulomb_def law = mps_material_mohr_coulomb_defaults();
  law.young = slope_young(s), law.poisson = s->poisson;
  law.friction = atan(tan(s->phi * DEGREE) / factor);
  law.dilation = fmin(s->psi * DEGREE, law.friction);
  law.cohesion = largest / factor;
  law.void_ratio = s->voids.e0, law.max_void_ratio = s->voids.e_max;
  if (s->runout) {
    law.residual_friction = atan(tan(s->residual_phi * DEGREE) / factor);
    law.residual_cohesion = s->residual_cohesion / factor;
    law.slip = s->slip;
    law.band = (s->spline ? 1.5 : 1.4) * s->h;
  }
  mps_status status = mps_material_create_mohr_coulomb(sim->context, &law, &sim->m.material);
  if (status == MPS_OK && s->gradient > 0.0)
    status = let_grow(s, largest, sim->m.particles, sim->context, &sim->m.material);
  return status;
}

/* Where each particle is before the first step. */
static mps_status note_start(simulation *sim) {
  mps_particles *whole;
  mps_view x, id;
  mps_status status = mpm_model_whole(&sim->m, &whole);
  if (status == MPS_OK && whole) {
    status = mps_particles_view(whole, "position", &x);
    if (status == MPS_OK) status = mps_particles_view(whole, "id", &id);
    free(sim->start);
    sim->starts = status == MPS_OK ? x.shape[0] : 0;
    sim->start = malloc((size_t)(2 * sim->starts + 1) * sizeof *sim->start);
    if (!sim->start) status = MPS_ERROR_MEMORY;
    for (int64_t k = 0; status == MPS_OK && k < sim->starts; k++) {
      const int64_t i = *mps_view_i64(&id, k, 0);
      for (int c = 0; c < 2; c++) sim->start[2 * i + c] = *mps_view_f64(&x, k, c);
    }
  }
  return mpm_model_tell(&sim->m, status, 0, NULL);
}

mps_status slope_build_trial(simulation *sim) {
  const settings *s = &sim->s;
  mpm_model *m = &sim->m;
  mps_particles_def set = mps_particles_defaults();
  set.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mpm_model_particles(m, sim->context, &set);
  if (status == MPS_OK) status = fill(s, m->particles);
  if (status == MPS_OK) status = mps_particles_set(m->particles, "density", 0, s->density);
  if (status == MPS_OK)
    status = slope_is_wet(s) ? slope_wet(&sim->s, m->particles) : set_stress(s, m->particles);
  if (status == MPS_OK) status = make_law(sim);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  if (!s->runout) def.flip_time = 0.0; /* a trial asks whether the slope rests, not how it flows */
  def.gravity[1] = -s->gravity;
  def.lower[0] = def.lower[1] = 0.0;
  if (s->base > 0.0) def.upper[0] = s->crest + s->slope * s->height + s->toe;
  status = mpm_model_create(m, sim->context, status, &def);
  if (status == MPS_OK) status = mps_mpm_set_side(m->mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  return status == MPS_OK ? note_start(sim) : status;
}

/* ---- motion ---------------------------------------------------------------------------------- */

typedef struct motion {
  double moved, front, lost, kinetic; /* m: of all but 1 % of the particles; J/m */
} motion;

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static mps_status measure_whole(const simulation *sim, mps_particles *set, motion *out) {
  const settings *s = &sim->s;
  mps_view x, v, mass, id;
  mps_status status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "velocity", &v);
  if (status == MPS_OK) status = mps_particles_view(set, "mass", &mass);
  if (status == MPS_OK) status = mps_particles_view(set, "id", &id);
  if (status != MPS_OK) return status;
  const int64_t count = x.shape[0];
  const double half = 0.5 * mps_particles_spacing(set);
  double *moved = malloc((size_t)count * sizeof *moved);
  int64_t *rows = mpm_rows_by_id(set);
  *out = (motion){.front = s->crest + s->slope * s->height};
  for (int64_t i = 0; moved && rows && i < count; i++) {
    const int64_t k = rows[i];
    const double *from = sim->start + 2 * *mps_view_i64(&id, k, 0);
    const double vx = *mps_view_f64(&v, k, 0), vy = *mps_view_f64(&v, k, 1);
    const double place = *mps_view_f64(&x, k, 0);
    moved[i] = hypot(place - from[0], *mps_view_f64(&x, k, 1) - from[1]);
    out->kinetic += 0.5 * *mps_view_f64(&mass, k, 0) * (vx * vx + vy * vy);
    if (!(moved[i] > FAR * s->height)) continue;
    out->lost = fmax(out->lost, s->crest - from[0] + half);
    out->front = fmax(out->front, place + half);
  }
  status = moved && rows ? MPS_OK : MPS_ERROR_MEMORY;
  const int64_t last = (int64_t)(0.99 * (double)(count - 1));
  if (status == MPS_OK) {
    qsort(moved, (size_t)count, sizeof *moved, ascending);
    out->moved = moved[last];
  }
  free(moved);
  free(rows);
  return status;
}

static mps_status measure(simulation *sim, motion *out) {
  mps_particles *whole;
  *out = (motion){.lost = 0.0};
  mps_status status = mpm_model_whole(&sim->m, &whole);
  if (status == MPS_OK && whole) status = measure_whole(sim, whole, out);
  return mpm_model_tell(&sim->m, status, sizeof *out / sizeof(double), &out->moved);
}

static mps_status sample(simulation *sim, trial *now) {
  const settings *s = &sim->s;
  motion m;
  const mps_status status = measure(sim, &m);
  if (status != MPS_OK) return status;
  now->t[now->rows] = mps_mpm_time(sim->m.mpm);
  now->moved[now->rows++] = m.moved;
  sim->front = m.front - s->crest - s->slope * s->height;
  sim->lost = m.lost;
  sim->kinetic = m.kinetic;
  sim->peak = fmax(sim->peak, m.kinetic);
  sim->m.samples++;
  return MPS_OK;
}

/* Ground that flows passes the farthest place where it was before the last `samples`, and stays
 * beyond it; ground that oscillates about its equilibrium, elastically, comes back. */
static bool flows_on(const trial *t, int samples) {
  const int last = t->rows - 1;
  double most = 0.0, least = INFINITY;
  for (int k = 0; k <= last - samples; k++) most = fmax(most, t->moved[k]);
  for (int k = last - samples / 2; k <= last; k++) least = fmin(least, t->moved[k]);
  return least > most;
}

/* A run-out until it rests. A trial until it rests or flows steadily; or the speed over the last
 * quarter of its time decides. */
static bool has_ended(const simulation *sim, trial *now) {
  if (!sim->s.runout) {
    const bool whole = now->rows == SLOPE_SAMPLES + 1;
    const double last = slope_speed(&sim->s, now, WINDOW);
    const double before = 2.0 * slope_speed(&sim->s, now, 2 * WINDOW) - last;
    now->failed = whole
                      ? slope_speed(&sim->s, now, SLOPE_SAMPLES / 4) > SLOPE_FLOWS &&
                            flows_on(now, SLOPE_SAMPLES / 4)
                      : last > 3.0 * SLOPE_FLOWS && last > STEADY * before && flows_on(now, WINDOW);
    return whole || now->failed || fmax(fabs(last), fabs(before)) < 0.5 * SLOPE_FLOWS;
  }
  return now->rows > SLOPE_SAMPLES / 10 && sim->kinetic <= AT_REST * sim->peak;
}

mps_status slope_march_trial(simulation *sim) {
  trial *now = &sim->trial[sim->now];
  const double end = slope_duration(&sim->s);
  mps_status status = MPS_OK;
  for (int k = now->rows; k <= SLOPE_SAMPLES && !now->ended && status == MPS_OK; k++) {
    if (k > 0) status = mpm_model_advance(&sim->m, end * k / SLOPE_SAMPLES, INT64_MAX, NULL, NULL);
    if (status == MPS_OK) status = sample(sim, now);
    const bool ended = status == MPS_OK && has_ended(sim, now);
    if (status == MPS_OK) now->ended = ended || k == SLOPE_SAMPLES;
    if (status == MPS_OK)
      status = mpm_course_sample(&sim->course, ended ? SLOPE_SAMPLES : k, SLOPE_SAMPLES);
    if (ended) break;
  }
  return status;
}
