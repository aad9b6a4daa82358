/* scenes.c - see scenes.h. SPDX-License-Identifier: BSD-3-Clause */
#include "scenes.h"

#include <math.h>

/* Ends the function that makes a scene with the status of a call that failed. */
#define TRY(call)                                                                                  \
  do {                                                                                             \
    const mps_status status = (call);                                                              \
    if (status != MPS_OK) return status;                                                           \
  } while (0)

const char *const scene_names[SCENES] = {"mpm", "dynamics", "elastic", "fluid"};

static mps_status fill(scene *s, double spacing, double width, double height) {
  mps_particles_def def = mps_particles_defaults();
  const double lower[2] = {0.0, 0.0}, upper[2] = {width, height};
  def.spacing = spacing;
  TRY(mps_particles_create(s->context, &def, &s->set));
  return mps_particles_fill_box(s->set, lower, upper, NULL);
}

/* A block of sand that falls by a millimetre and bears a free disc. */
static mps_status make_mpm(scene *s) {
  mps_material_drucker_prager_def sand = mps_material_drucker_prager_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_body_def disc = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  TRY(fill(s, 0.05, 0.8, 0.4));
  TRY(mps_particles_set(s->set, "density", 0, 1600.0));
  sand.young = 1e6, sand.poisson = 0.3, sand.friction = 0.55, sand.cohesion = 100.0;
  TRY(mps_material_create_drucker_prager(s->context, &sand, &s->law));
  def.cell = 0.1, def.gravity[1] = -9.81;
  def.lower[0] = -0.4, def.lower[1] = 0.0, def.upper[0] = 1.2;
  TRY(mps_mpm_create(s->context, s->set, s->law, &def, &s->mpm));
  s->solver = mps_mpm_solver(s->mpm);
  disc.motion = MPS_BODY_MOTION_FREE;
  disc.mass = 50.0, disc.inertia[2] = 1.0;
  disc.position[0] = 0.4, disc.position[1] = 0.602, disc.gravity[1] = -9.81;
  TRY(mps_body_create_disc(s->context, &disc, 0.2, &s->body));
  contact.friction = 0.4;
  return mps_mpm_add_contact(s->mpm, s->body, &contact, &s->contact);
}

/* A column of soil on a half space, from which a wavelet comes. */
static mps_status make_dynamics(scene *s) {
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics_boundary_def base = mps_dynamics_boundary_defaults();
  TRY(fill(s, 1.0, 4.0, 12.0));
  TRY(mps_particles_set(s->set, "density", 0, 1800.0));
  TRY(mps_particles_set(s->set, "shear_velocity", 0, 150.0));
  TRY(mps_particles_set(s->set, "pressure_velocity", 0, 400.0));
  TRY(mps_particles_set(s->set, "damping", 0, 0.02));
  TRY(mps_signal_create_ricker(s->context, 8.0, 0.05, 1.0, &s->signal));
  def.dt = 1e-3;
  TRY(mps_dynamics_create(s->context, s->set, &def, &s->dynamics));
  s->solver = mps_dynamics_solver(s->dynamics);
  base.kind = MPS_BOUNDARY_ABSORBING;
  base.upper[1] = 1.0;
  base.signal[0] = s->signal;
  return mps_dynamics_add_boundary(s->dynamics, &base, NULL);
}

/* A cantilever that starts at rest under its weight. */
static mps_status make_elastic(scene *s) {
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic_boundary_def clamp = mps_elastic_boundary_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  TRY(fill(s, 0.1, 2.0, 0.4));
  TRY(mps_particles_set(s->set, "young", 0, 1e8));
  TRY(mps_particles_set(s->set, "poisson", 0, 0.25));
  TRY(mps_particles_set(s->set, "density", 0, 2400.0));
  def.gravity[1] = -9.81;
  TRY(mps_elastic_create(s->context, s->set, &def, &s->elastic));
  s->solver = mps_elastic_solver(s->elastic);
  clamp.upper[0] = 0.1;
  TRY(mps_elastic_add_boundary(s->elastic, &clamp, NULL));
  motion.dt = 2e-3;
  return mps_elastic_start(s->elastic, &motion);
}

/* Water that a piston pushes against a wall. */
static mps_status make_fluid(scene *s) {
  static const double wall[3][4] = {{0.0, 0.0, 0.0, 1.0}, {0.0, 0.0, 1.0, 0.0}, {1.0, 0.0, -1.0, 0.0}};
  mps_fluid_def def = mps_fluid_defaults();
  TRY(fill(s, 0.05, 1.0, 0.3));
  TRY(mps_signal_create_sine(s->context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0, &s->signal));
  def.level = 0.3, def.dt = 2e-3, def.tolerance = 1e-12;
  TRY(mps_fluid_create(s->context, s->set, &def, &s->fluid));
  s->solver = mps_fluid_solver(s->fluid);
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def side = mps_fluid_boundary_defaults();
    side.kind = MPS_BOUNDARY_ROLLER;
    side.point[0] = wall[k][0], side.point[1] = wall[k][1];
    side.normal[0] = wall[k][2], side.normal[1] = wall[k][3];
    if (k == 1) side.signal = s->signal;
    TRY(mps_fluid_add_boundary(s->fluid, &side, NULL));
  }
  return MPS_OK;
}

mps_status scene_make(scene *s, int kind) {
  static mps_status (*const make[SCENES])(scene *) = {make_mpm, make_dynamics, make_elastic, make_fluid};
  mps_context_def def = mps_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  TRY(mps_context_create(&def, &s->context, NULL, 0));
  return make[kind](s);
}

void scene_drop(scene *s) {
  mps_contact_destroy(&s->contact);
  mps_mpm_destroy(&s->mpm);
  mps_dynamics_destroy(&s->dynamics);
  mps_elastic_destroy(&s->elastic);
  mps_fluid_destroy(&s->fluid);
  mps_body_destroy(&s->body);
  mps_signal_destroy(&s->signal);
  mps_material_destroy(&s->law);
  mps_particles_destroy(&s->set);
  mps_context_destroy(&s->context);
  s->solver = NULL;
}
