/* model.c - ground and footing of mps-footing, and the run.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "common/ranks.h"
#include "footing.h"

#include <mps/soil.h>
#include <mps/experimental/settle.h>
#include <mps/experimental/soil.h>

#include <math.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define TOLERANCE 2e-3 /* of the ground at rest, on the way */
#define SETTLE_STEPS 200000
#define CONCRETE 2400.0 /* kg/m3: of a strip that turns */
#define HEAVY 1e15      /* kg/m: nothing changes the speed of such a strip */
#define RAMP 0.1        /* s to full speed at the paper's rate; the same path at others */

/* ---- settings -------------------------------------------------------------------------------- */

static double unit_of(const settings *s) { return s->top > 0.0 ? s->top_cohesion : s->cohesion; }

/* Clay yields all around after some 25 c/E of the half width. */
static double clay_settlement(const settings *s) {
  return fmin(0.5 * s->half_width, fmax(0.6e-3, 120.0 * s->half_width * unit_of(s) / s->young));
}

/* Up to which the force of inertia, rate (rho E)^1/2, is the same part of the cohesion: a longer
 * path in as many steps. */
static double faster(const settings *s) {
  const double times = unit_of(s) / 10e3 * sqrt(1e9 / s->young);
  return fmin(60.0, fmax(1.0, times));
}

static const char *check_eccentricity(const settings *s) {
  if (s->eccentricity == 0.0) return NULL;
  if (s->model == DRUCKER_PRAGER || s->shape == CIRCLE || s->top > 0.0 || s->gradient > 0.0 ||
      footing_is_thin(s))
    return "--eccentricity is for a strip on even, deep ground of --law vonmises";
  if (s->settled) return "--eccentricity and --quasi-static exclude each other";
  if (s->eccentricity > s->half_width - 2.0 * s->h * (1.0 - 1e-9))
    return "--eccentricity must be at least 2 cells of --cell less than --half-width";
  return NULL;
}

const char *footing_settle(settings *s, const option *table) {
  const bool cone = s->model == DRUCKER_PRAGER;
  double *const sides[] = {&s->width, &s->depth};
  if (!options_lengths(s->domain, "m", 2, sides))
    return "--soil must be two lengths in m, WxH, such as 5x2";
  options_whole("soil", &s->width, "--cell", s->h);
  options_whole("soil", &s->depth, "--cell", s->h);
  if (!cone &&
      (options_given(table, "phi") || options_given(table, "psi") || options_given(table, "e0") ||
       options_given(table, "emax") || options_given(table, "cone")))
    return "--phi, --psi, --e0, --emax and --cone are for --law druckerprager";
  if (cone && s->shape == CIRCLE) return "--shape circle is for --law vonmises";
  if (s->contact == MPS_CONTACT_METHOD_PENALTY && options_given(table, "corner"))
    return "--corner is for --contact impulse";
  const bool point = s->volumetric == MPS_MPM_VOLUMETRIC_POINT;
  const double ended = cone ? (s->surcharge > 0.0 ? 0.65 : 0.75) : point ? 0.9 : 0.6;
  const double inset = s->eccentricity > 0.0 || s->settled ? 0.0 : ended;
  const char *edges = mpm_model_settle_edges(table, s->contact, inset, &s->corner, &s->inset);
  if (edges) return edges;
  const double cells = (footing_is_whole(s) ? 2.0 : 1.0) * s->width * s->depth / (s->h * s->h);
  const char *large = mpm_model_too_large(cells * (double)s->ppc);
  if (large) return large;
  const char *eccentric = check_eccentricity(s);
  if (eccentric) return eccentric;
  if (s->half_width < s->h * (2.0 - 1e-9)) return "--half-width must be at least 2 cells of --cell";
  if (!s->settled && options_given(table, "rest-tolerance"))
    return "--rest-tolerance is for --quasi-static";
  const bool grows = s->gradient > 0.0, layer = !cone && s->shape == STRIP && !grows;
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
  if (s->top > s->depth - s->h)
    return "--top must leave at least a cell of --cell of the ground below";
  if (isnan(s->rate)) s->rate = (s->settled ? 1.5e-3 : 0.5e-3) * (cone ? 1.0 : faster(s));
  if (isnan(s->psi)) s->psi = s->phi;
  if (s->psi > s->phi) return "--psi must be at most --phi";
  if (sand_check(&s->voids)) return sand_check(&s->voids);
  if (isnan(s->settlement)) s->settlement = cone ? 4e-3 : clay_settlement(s);
  if (s->settlement > 0.5 * s->half_width)
    return "--settlement must be at most half of --half-width";
  if (isnan(s->gravity)) s->gravity = cone ? 9.81 : 0.0;
  if (s->section > s->width || s->section < (footing_is_whole(s) ? -s->width : 0.0))
    return "--section must be in the ground, whose left side is 0, or of an eccentric load the "
           "width of --soil to the left";
  return NULL;
}

bool footing_is_whole(const settings *s) { return s->eccentricity > 0.0; }

bool footing_is_thin(const settings *s) { return s->depth < 1.5 * s->half_width * (1.0 - 1e-9); }

footing_unit footing_unit_of(const settings *s) {
  const double cohesion = unit_of(s);
  const double weight = s->density * s->gravity * s->half_width;
  if (s->surcharge > 0.0) return (footing_unit){s->surcharge, "surcharge"};
  if (s->model == DRUCKER_PRAGER && weight > 100.0 * cohesion)
    return (footing_unit){weight, "{/Symbol r} g B/2"};
  return (footing_unit){cohesion, "cohesion"};
}

/* ---- building -------------------------------------------------------------------------------- */

/* A strip that keeps its speed, whatever the reaction, and turns by the moment about the load's
 * line, where its reference point is. */
static mps_status make_turning(mps_context *context, const settings *s, simulation *sim) {
  const double a = s->half_width, e = s->eccentricity, high = s->half_width;
  const double corner[8] = {-a - e, -0.5 * high, a - e,  -0.5 * high,
                            a - e,  0.5 * high,  -a - e, 0.5 * high};
  mps_body_def def = mps_body_defaults();
  sim->ramp = 0.0;
  sim->t_end = s->settlement / s->rate;
  def.motion = MPS_BODY_MOTION_FREE;
  def.position[0] = e, def.position[1] = s->depth + 0.5 * high;
  def.velocity[1] = -s->rate;
  def.mass = HEAVY;
  def.inertia[2] = CONCRETE * 2.0 * a * high * ((4.0 * a * a + high * high) / 12.0 + e * e);
  return mps_body_create_polygon(context, &def, 4, corner, &sim->m.body[0]);
}

/* Speed up over the ramp, then constant until the settlement is reached. */
static mps_status make_footing(mps_context *context, const settings *s, simulation *sim) {
  const double speed = s->rate;
  if (footing_is_whole(s)) return make_turning(context, s, sim);
  sim->ramp = RAMP * fmin(1.0, 0.5e-3 / s->rate);
  sim->t_end = s->settlement / speed + 0.5 * sim->ramp;
  const double t[] = {0.0, sim->ramp, sim->t_end + 1.0}, v[] = {0.0, speed, speed};
  mps_signal *down = NULL;
  mps_status status =
      mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &down);
  mps_body_def def = mps_body_defaults();
  const double height = s->half_width;
  def.position[1] = s->depth + 0.5 * height;
  const double half[8] = {0.0,           -0.5 * height, s->half_width, -0.5 * height,
                          s->half_width, 0.5 * height,  0.0,           0.5 * height};
  if (status == MPS_OK)
    status = s->shape == CIRCLE
                 ? mps_body_create_polygon(context, &def, 4, half, &sim->m.body[0])
                 : mps_body_create_box(context, &def, 2.0 * s->half_width, height, &sim->m.body[0]);
  if (status == MPS_OK) status = mps_body_drive(sim->m.body[0], 1, down, -1.0);
  mps_signal_destroy(&down);
  return status;
}

static mps_status add_contact(const settings *s, simulation *sim) {
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = s->mu;
  contact.method = s->contact;
  if (s->contact == MPS_CONTACT_METHOD_PENALTY && s->k > 0.0) contact.penalty = s->k;
  if (s->contact == MPS_CONTACT_METHOD_IMPULSE) contact.corner = s->corner * s->h;
  contact.inset = s->inset * s->h;
  return mps_mpm_add_contact(sim->m.mpm, sim->m.body[0], &contact, NULL);
}

/* Ground at rest under its own weight, (57), and the surcharge. */
static mps_status set_stress(mps_particles *set, const settings *s) {
  if (s->gravity == 0.0) {
    const double k0 = s->poisson / (1.0 - s->poisson), across = -s->surcharge;
    const double stress[4] = {k0 * across, across, k0 * across, 0.0};
    mps_status status = MPS_OK;
    for (int c = 0; c < 4 && status == MPS_OK; c++)
      status = mps_particles_set(set, "stress", c, stress[c]);
    return status;
  }
  const mps_geostatic_layer layer = {
      .thickness = INFINITY, .k0 = s->poisson / (1.0 - s->poisson), .density = NAN};
  mps_geostatic_def def = mps_geostatic_defaults();
  def.layers = &layer, def.layer_count = 1;
  def.gravity = s->gravity;
  def.surface = s->depth;
  def.surcharge = s->surcharge;
  return mps_particles_set_geostatic(set, &def);
}

static mps_status make_ground(mps_context *context, const settings *s, mpm_model *m) {
  const double lo[2] = {footing_is_whole(s) ? -s->width : 0.0, 0.0}, hi[2] = {s->width, s->depth};
  mps_particles_def def = mps_particles_defaults();
  def.spacing = s->h / sqrt((double)s->ppc);
  mps_status status = mpm_model_particles(m, context, &def);
  if (status == MPS_OK) status = mps_particles_fill_box(m->particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(m->particles, "density", 0, s->density);
  return status == MPS_OK && s->gravity + s->surcharge > 0.0 ? set_stress(m->particles, s) : status;
}

/* In plane strain von Mises' law has the shear strength c of Tresca's; under a circle it has not.
 */
static mps_status make_clay(mps_context *context, const settings *s, double cohesion,
                            mps_material **out) {
  if (s->shape == CIRCLE) {
    mps_material_mohr_coulomb_def law = mps_material_mohr_coulomb_defaults();
    law.young = s->young, law.poisson = s->poisson, law.cohesion = cohesion;
    law.friction = law.dilation = 0.0;
    return mps_material_create_mohr_coulomb(context, &law, out);
  }
  mps_material_von_mises_def law = mps_material_von_mises_defaults();
  law.young = s->young, law.poisson = s->poisson;
  law.yield_stress = sqrt(3.0) * cohesion; /* (54) */
  return mps_material_create_von_mises(context, &law, out);
}

/* Clay whose strength grows with depth: its factor goes with each particle. */
static mps_status make_growing_clay(mps_context *context, const settings *s, mps_particles *set,
                                    mps_material **out) {
  const double depth[] = {0.0, s->depth};
  const double factor[] = {1.0, 1.0 + s->gradient * s->depth / s->cohesion};
  mps_geostatic_def ground = mps_geostatic_defaults();
  mps_material *clay = NULL;
  ground.surface = s->depth;
  mps_status status = mps_particles_set_profile(set, "strength_factor", 2, depth, factor, &ground);
  if (status == MPS_OK) status = make_clay(context, s, s->cohesion, &clay);
  if (status == MPS_OK) status = mps_material_create_by_field(context, clay, out);
  mps_material_destroy(&clay);
  return status;
}

static mps_status make_material(mps_context *context, const settings *s, mps_particles *set,
                                mps_material **out) {
  if (s->gradient > 0.0) return make_growing_clay(context, s, set, out);
  if (s->model == VON_MISES) return make_clay(context, s, s->cohesion, out);
  mps_material_drucker_prager_def law = mps_material_drucker_prager_defaults();
  law.cone = s->cone;
  law.young = s->young, law.poisson = s->poisson, law.cohesion = s->cohesion;
  law.friction = s->phi * DEGREE, law.dilation = s->psi * DEGREE;
  law.void_ratio = s->voids.e0, law.max_void_ratio = s->voids.e_max;
  return mps_material_create_drucker_prager(context, &law, out);
}

/* Ids of the particles above `level`, from x = `from` on. */
static mps_status choose(const settings *s, mps_particles *set, double from, double level,
                         int64_t *count, int64_t *ids) {
  mps_view x, id;
  mps_status status = mps_particles_view(set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(set, "id", &id);
  const double little = 1e-6 * s->h;
  *count = 0;
  for (int64_t k = 0; status == MPS_OK && k < x.shape[0]; k++)
    if (*mps_view_f64(&x, k, 0) > from + little && *mps_view_f64(&x, k, 1) > level + little)
      ids[(*count)++] = *mps_view_i64(&id, k, 0);
  return status;
}

/* The clay of the upper layer, and the surcharge on the uppermost particles beside the footing. */
static mps_status add_layer_and_surcharge(mps_context *context, const settings *s, mpm_model *m) {
  mps_particles *set = m->particles;
  int64_t *ids = malloc((size_t)(mps_particles_count(set) + 1) * sizeof *ids), count;
  mps_status status = ids ? MPS_OK : MPS_ERROR_MEMORY;
  mps_material *clay = NULL;
  if (status == MPS_OK && s->top > 0.0) {
    status = choose(s, set, 0.0, s->depth - s->top, &count, ids);
    if (status == MPS_OK) status = make_clay(context, s, s->top_cohesion, &clay);
    if (status == MPS_OK && count > 0) status = mps_mpm_set_material(m->mpm, clay, ids, count);
    mps_material_destroy(&clay);
  }
  if (status == MPS_OK && s->surcharge > 0.0) {
    mps_mpm_load_def load = mps_mpm_load_defaults();
    status = choose(s, set, s->half_width, s->depth - mps_particles_spacing(set), &count, ids);
    load.ids = ids, load.id_count = count;
    load.traction[1] = -s->surcharge;
    if (status == MPS_OK && count > 0) status = mps_mpm_add_load(m->mpm, &load, NULL);
  }
  free(ids);
  return status;
}

mps_status footing_build(mps_context *context, void *user) {
  simulation *sim = user;
  const settings *s = &sim->s;
  sim->samples = s->settled ? FOOTING_SETTLED : FOOTING_SAMPLES;
  static const rows_column columns[] = {
      {"settlement", "m", 0}, {"pressure", "Pa", 0}, {"impulse", "N s", 0}, {0}};
  const double end = s->settlement / s->rate;
  sim->course = (mpm_course){.options = &s->course,
                             .m = &sim->m,
                             .directory = s->out,
                             .what = "ground",
                             .duration = end,
                             .key = "mps-footing 4",
                             .table = options_read(),
                             .columns = columns};
  mps_status status = mpm_course_peek(&sim->course, context);
  if (status == MPS_OK) status = make_ground(context, s, &sim->m);
  if (status == MPS_OK) status = make_material(context, s, sim->m.particles, &sim->m.material);
  mps_mpm_def def = mps_mpm_defaults();
  def.geometry = s->shape == CIRCLE ? MPS_MPM_GEOMETRY_AXISYMMETRIC : MPS_MPM_GEOMETRY_PLANE_STRAIN;
  def.cell = s->h;
  def.courant = s->courant;
  def.spline = s->spline + 2;
  def.volumetric = s->volumetric;
  def.flip_time = s->flip_time;
  mpm_method_define(&s->method, &def);
  def.lower[0] = footing_is_whole(s) ? -s->width : 0.0;
  def.lower[1] = 0.0;
  def.upper[0] = s->width;
  def.gravity[1] = -s->gravity;
  if (status == MPS_OK) status = make_footing(context, s, sim);
  status = mpm_model_create(&sim->m, context, status, &def);
  status = mpm_method_choose(&s->method, sim->m.mpm, status);
  if (status == MPS_OK)
    status = mps_mpm_set_side(sim->m.mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0);
  if (status == MPS_OK) status = add_contact(s, sim);
  if (status == MPS_OK) status = add_layer_and_surcharge(context, s, &sim->m);
  return status == MPS_OK ? mpm_course_begin(&sim->course, context, true) : status;
}

/* Area of the base that the force of the model acts on: half a strip 1 m long, all of it under an
 * eccentric load, or the circle. */
static double footing_area(const settings *s) {
  if (s->shape == CIRCLE) return 180.0 * DEGREE * s->half_width * s->half_width;
  return footing_is_whole(s) ? 2.0 * s->half_width : s->half_width;
}

/* ---- running --------------------------------------------------------------------------------- */

/* A sample of the path: the position of the footing, and the pressure on it, from the impulse since
 * the last sample or, at rest, from the force. */
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
  const double force =
      s->settled ? reaction.force[1] : (now.impulse - last.impulse) / (now.t - last.t);
  now.path = s->depth + 0.5 * s->half_width - body.position[1];
  now.q = force / footing_area(s);
  return mpm_course_add(&sim->course, &now);
}

/* Brings the ground to rest, or continues doing so where Ctrl-C has cut it short. The pressure
 * falls as long as that lasts: where it is measured, the tolerance is the user's. */
static mps_status come_to_rest(simulation *sim) {
  mps_mpm_settle_def rest = mps_mpm_settle_defaults();
  rest.tolerance = 2 * footing_rows(sim) < sim->samples ? TOLERANCE : sim->s.tolerance;
  rest.max_steps = SETTLE_STEPS;
  return mps_mpm_settle(sim->m.mpm, &rest, NULL);
}

/* The path in equal parts. After each of them the ground comes to rest under the footing where a
 * quasi-static run is requested: overshoot by inertia is removed. */
mps_status footing_march(void *user) {
  simulation *sim = user;
  mps_particles *whole;
  mps_status status = MPS_OK;
  progress_part(&sim->m.a->bar, 0.0, 1.0, 0.0, sim->t_end);
  if (footing_rows(sim) == 0) status = mpm_course_sample(&sim->course, 0, sim->samples);
  while (footing_rows(sim) < sim->samples && status == MPS_OK) {
    const double t = sim->t_end * (footing_rows(sim) + 1) / sim->samples;
    status = mpm_model_advance(&sim->m, t, INT64_MAX, NULL, NULL);
    if (status == MPS_OK && sim->s.settled) status = come_to_rest(sim);
    if (status == MPS_OK) status = take_sample(sim);
    if (status == MPS_OK) status = mpm_course_sample(&sim->course, footing_rows(sim), sim->samples);
  }
  status = mpm_course_end(&sim->course, status);
  mps_status brought = mpm_model_whole(&sim->m, &whole); /* for footing_finish */
  if (brought == MPS_OK && status == MPS_OK) brought = footing_take_section(sim);
  return status == MPS_OK ? brought : status;
}
