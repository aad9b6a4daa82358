/* model.c - ground and footing of a run of mps-footing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "footing.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

#include <math.h>
#include <stdlib.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define CONCRETE 2400.0 /* kg/m3: of a strip that turns */
#define HEAVY 1e15      /* kg/m: nothing changes the speed of such a strip */
#define ROUNDED 0.6     /* cells: edges of a footing that sinks */
#define PAPER_RAMP 0.1  /* s to full speed at the paper's rate; the same path at others */
#define RAMP 12.0       /* times of it in the path */
/* By which the sides of a rough base lean inwards where weight alone bears it. A node a cell above
 * the strip beyond the inset edge then lies in no body: in one, it takes from the ground beside the
 * edge the support that turns its velocities, and N_gamma jumps by a tenth as the edge passes a
 * line of nodes. */
#define LEAN 0.3

/* ---- building -------------------------------------------------------------------------------- */

/* A strip that keeps its speed, whatever the reaction, and turns by the moment about the load's
 * line, where its reference point is. */
static mps_status make_turning(mps_context *context, const settings *s, simulation *sim) {
  const double a = s->half_width, e = s->eccentricity, high = s->half_width;
  const double corner[8] = {-a - e, -0.5 * high, a - e,  -0.5 * high,
                            a - e,  0.5 * high,  -a - e, 0.5 * high};
  mps_body_def def = mps_body_defaults();
  sim->ramp = 0.0;
  sim->t_end = s->run.settlement / s->run.rate;
  def.motion = MPS_BODY_MOTION_FREE;
  def.position[0] = e, def.position[1] = s->depth + 0.5 * high;
  def.velocity[1] = -s->run.rate;
  def.mass = HEAVY;
  def.inertia[2] = CONCRETE * 2.0 * a * high * ((4.0 * a * a + high * high) / 12.0 + e * e);
  return mps_body_create_polygon(context, &def, 4, corner, &sim->m.body[0]);
}

/* With insets a strip that has sunk by 0.12 B bears 4.74 c, less than at the start; rounded 5.5 c.
 */
static bool sinks(const simulation *sim) {
  return sim->s.twice && sim->now == FOOTING_DEFORMED && sim->s.inset > 0.0;
}

static double lean_of(const simulation *sim) {
  const settings *s = &sim->s;
  const bool leans = s->mu > 0.0 && s->inset > 0.0 && !sinks(sim) && footing_weight_bears(s);
  return leans ? LEAN : 0.0;
}

/* Speed up over the ramp, then constant until the settlement is reached. */
static mps_status make_footing(mps_context *context, const settings *s, simulation *sim) {
  const double speed = s->run.rate;
  if (footing_is_whole(s)) return make_turning(context, s, sim);
  sim->ramp =
      s->paper ? PAPER_RAMP * fmin(1.0, 0.5e-3 / speed) : s->run.settlement / (RAMP * speed);
  sim->t_end = s->run.settlement / speed + 0.5 * sim->ramp;
  const double t[] = {0.0, sim->ramp, sim->t_end + 1.0}, v[] = {0.0, speed, speed};
  mps_signal *down = NULL;
  mps_status status =
      mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &down);
  mps_body_def def = mps_body_defaults();
  const double height = s->half_width;
  def.position[1] = s->depth + 0.5 * height;
  const double top = s->half_width - lean_of(sim) * height;
  const double half[8] = {0.0, -0.5 * height, s->half_width, -0.5 * height,
                          top, 0.5 * height,  0.0,           0.5 * height};
  const double whole[8] = {-s->half_width, -0.5 * height, s->half_width, -0.5 * height, top,
                           0.5 * height,   -top,          0.5 * height};
  if (status == MPS_OK)
    status = mps_body_create_polygon(context, &def, 4, s->shape == CIRCLE ? half : whole,
                                     &sim->m.body[0]);
  if (status == MPS_OK) status = mps_body_drive(sim->m.body[0], 1, down, -1.0);
  mps_signal_destroy(&down);
  return status;
}

static mps_status add_contact(const settings *s, simulation *sim) {
  mps_contact_def contact = mps_contact_defaults();
  contact.friction = s->mu;
  contact.method = s->contact;
  if (s->contact == MPS_CONTACT_METHOD_PENALTY && s->k > 0.0) contact.penalty = s->k;
  if (s->contact == MPS_CONTACT_METHOD_IMPULSE)
    contact.corner = (sinks(sim) ? ROUNDED : s->corner) * s->h;
  /* Of a leaning corner the library takes cot(a/2) times the inset of a right angle, a its angle.
   */
  if (!sinks(sim))
    contact.inset = s->inset * s->h * tan(0.5 * (90.0 * DEGREE - atan(lean_of(sim))));
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
    law.young = s->run.young, law.poisson = s->poisson, law.cohesion = cohesion;
    law.friction = law.dilation = 0.0;
    return mps_material_create_mohr_coulomb(context, &law, out);
  }
  mps_material_von_mises_def law = mps_material_von_mises_defaults();
  law.young = s->run.young, law.poisson = s->poisson;
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
  law.young = s->run.young, law.poisson = s->poisson, law.cohesion = s->cohesion;
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

mps_status footing_build_model(mps_context *context, simulation *sim) {
  const settings *s = &sim->s;
  mps_status status = make_ground(context, s, &sim->m);
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
  return status == MPS_OK ? add_layer_and_surcharge(context, s, &sim->m) : status;
}

/* Half a strip 1 m long, all of it under an
 * eccentric load, or the circle. */
double footing_area(const settings *s) {
  if (s->shape == CIRCLE) return 180.0 * DEGREE * s->half_width * s->half_width;
  return footing_is_whole(s) ? 2.0 * s->half_width : s->half_width;
}
