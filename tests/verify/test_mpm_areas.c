/* test_mpm_areas.c - the shear that curved and flat surfaces bear by a strength, against strength
 * times area: cylinders that turn in clay, a shaft that is pulled out of a ring of it, a sphere, a
 * plate with sharp edges.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define CELL 0.05     /* m */
#define COHESION 10e3 /* Pa */
#define PRESSURE 80e3 /* Pa, of the clay on the body */
#define RIM 5.0       /* cells of clay around the body */

typedef struct clay {
  int32_t geometry, spline, along; /* particles along a cell */
  double radius;                   /* m, of what is cut out of the lattice */
  double shift;                    /* of the lattice, in its spacings */
} clay;

static int dim_of(const clay *c) { return c->geometry == MPS_MPM_GEOMETRY_SPACE ? 3 : 2; }

static mps_status is_outside(void *user, const double *x, int32_t *inside) {
  const clay *c = user;
  double square = x[0] * x[0];
  if (c->geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC) square += x[1] * x[1];
  if (c->geometry == MPS_MPM_GEOMETRY_SPACE) square += x[2] * x[2];
  *inside = square > c->radius * c->radius;
  return MPS_OK;
}

static mps_status press(void *user, const double *x, double *stress) {
  for (int k = 0; k < 3; k++) stress[k] = -PRESSURE;
  return MPS_OK;
}

/* A square or cube of clay with a hole, a ring in axisymmetry. */
static mpm_scene make_clay(clay *c, double cohesion) {
  const double outer = CELL * ceil(c->radius / CELL + RIM), spacing = CELL / c->along;
  mpm_scene s = {.context = context};
  DEF(particles, set, .dim = dim_of(c), .spacing = spacing);
  for (int a = 0; a < 2; a++) set.origin[a] = c->shift * spacing;
  OK(mps_particles_create(context, &set, &s.particles));
  double low[3], high[3];
  DEF(mpm, def, .geometry = c->geometry, .spline = c->spline, .cell = CELL,
      .volumetric = MPS_MPM_VOLUMETRIC_CELL);
  for (int a = 0; a < 3; a++) {
    const bool radial = c->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && a == 0;
    def.lower[a] = radial ? 0.0 : -outer, def.upper[a] = outer;
    low[a] = def.lower[a] + 1e-9, high[a] = outer - 1e-9;
  }
  OK(mps_particles_fill_where(s.particles, low, high, is_outside, c, NULL));
  OK(mps_particles_set(s.particles, "density", 0, 2000.0));
  OK(mps_particles_set_stress(s.particles, press, NULL));
  DEF(material_von_mises, law, .young = 5e6, .poisson = 0.3, .yield_stress = sqrt(3.0) * cohesion);
  OK(mps_material_create_von_mises(context, &law, &s.material));
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  for (int32_t side = 0; side < 2 * set.dim; side++)
    if (c->geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC || side != 0)
      mpm_scene_side(&s, side, MPS_BOUNDARY_HELD, 0.0);
  return s;
}

/* The mean reaction over the last fifth of so many steps in which the body moves. */
static void run_body(mpm_scene *s, mps_body *body, double strength, const mps_body_motion *motion,
                     int64_t steps, double *force, double *moment) {
  DEF(contact, def, .friction = 10.0, .strength = strength);
  scoped_contact *contact = NULL;
  OK(mps_mpm_add_contact(s->mpm, body, &def, &contact));
  OK(mps_body_set_motion(body, motion));
  OK(mps_mpm_step(s->mpm, steps - steps / 5));
  *force = *moment = 0.0;
  for (int64_t k = 0; k < steps / 5; k++) {
    mps_reaction r;
    OK(mps_mpm_step(s->mpm, 1));
    OK(mps_contact_get_reaction(contact, -1, &r));
    *force -= r.force[1] / (double)(steps / 5);
    *moment -= r.moment[2] / (double)(steps / 5);
  }
  mps_body_destroy(&body);
}

/* Moment of a cylinder or sphere that turns with `speed` (m/s) at its surface, over strength times
 * surface times arm. */
static double turn(clay *c, double strength, double speed, int64_t steps) {
  mpm_scene s = make_clay(c, COHESION);
  mps_body *body = NULL;
  mps_body_def def = mps_body_defaults();
  mps_body_motion motion = mps_body_motion_defaults();
  const double R = c->radius;
  double force, moment, arm = 2.0 * PI * R * R;
  if (dim_of(c) == 3) arm = PI * PI * R * R * R;
  OK(dim_of(c) == 3 ? mps_body_create_sphere(context, &def, R, &body)
                    : mps_body_create_disc(context, &def, R, &body));
  motion.spin[2] = speed / R;
  run_body(&s, body, strength, &motion, steps, &force, &moment);
  mpm_scene_end(&s);
  return moment / (strength * arm);
}

/* ---- tests ----------------------------------------------------------------------------------- */

static double farther(double a, double b) { return fabs(a - 1.0) > fabs(b - 1.0) ? a : b; }

TEST(cylinders_turn) {
  double farthest = 1.0;
  for (int k = 0; k < 20; k++) {
    clay c = {.spline = 2 + k % 2, .along = 2 + k / 2 % 2, .shift = k / 4 % 2 ? 0.3 : 0.0};
    c.radius = CELL * (k < 8 ? 4.0 : k < 16 ? 8.0 : 16.0);
    if (test_quick() && k != 5) continue;
    const double part = turn(&c, 0.5 * COHESION, 0.2, 400); /* overlaps have come out */
    print_message("R/h %g, degree %d, %d a cell, shifted by %g: moment %.4f\n", c.radius / CELL,
                  c.spline, c.along * c.along, c.shift, part);
    farthest = farther(part, farthest);
    if (k == 7 || k == 15 || k == 19) {
      print_message("R/h %g: the moment farthest from 1 is %.4f\n", c.radius / CELL, farthest);
      farthest = 1.0;
    }
    NEAR(part, 1.0, 0.03);
  }
}

/* The clay at the surface shears with it: its particles leave the rows of the lattice. */
TEST(clay_flows) {
  for (int k = 0; k < (test_quick() ? 0 : 2); k++) {
    clay c = {.spline = 3, .along = 2 + k, .radius = 8.0 * CELL, .shift = 0.3};
    const double part = turn(&c, COHESION, 1.0, 600);
    print_message("as strong as the clay, %d a cell: moment %.4f\n", c.along * c.along, part);
    NEAR(part, 1.0, 0.03);
  }
}

TEST(spheres_turn) {
  double farthest = 1.0;
  for (int k = 0; k < (test_quick() ? 1 : 2); k++) {
    clay c = {
        .geometry = MPS_MPM_GEOMETRY_SPACE, .spline = 2 + k, .along = 2, .radius = 4.0 * CELL};
    c.shift = 0.3 * k;
    const double part = turn(&c, 0.5 * COHESION, 0.5, 120);
    print_message("sphere, degree %d: moment %.4f\n", c.spline, part);
    farthest = farther(part, farthest);
    NEAR(part, 1.0, 0.03);
  }
  print_message("sphere: the moment farthest from 1 is %.4f\n", farthest);
}

/* A shaft beyond both ends of a ring, the particles beside it in rows: force strength times 2 pi R
 * times the ring's length. */
TEST(shafts_are_pulled) {
  for (int k = 0; k < 4; k++) {
    clay c = {.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC, .spline = 2 + k % 2, .along = 2 + k / 2};
    c.radius = 3.0 * CELL;
    scoped_mpm_scene s = make_clay(&c, 1e3 * COHESION);
    const double length = 2.0 * CELL * ceil(c.radius / CELL + RIM), strength = 0.5 * COHESION;
    mps_body_def def = mps_body_defaults();
    WITH_DEFAULTS(mps_body_motion, motion, .velocity[1] = 0.5);
    double force, moment;
    MAKE_KEPT(body, shaft, create_box, context, &def, 2.0 * c.radius, 4.0 * length);
    run_body(&s, shaft, strength, &motion, 120, &force, &moment);
    force /= strength * 2.0 * PI * c.radius * length;
    print_message("shaft, degree %d, %d a cell: force %.4f\n", c.spline, c.along * c.along, force);
    NEAR(force, 1.0, 1e-3);
  }
}
