/* test_fluid_clearance.c - bodies and polylines keep re apart: those nearer are refused, and at
 * that distance both are right. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.05
#define RE (3.1 * L0)

static mps_particles *water;
static mps_fluid *fluid;
static mps_body *box;
static mps_contact *contact;

/* Bed and two sides of a polyline, 2 m wide, with water of .8 m around a box of .4 x .3 m whose
 * lower side is at .18 m = 1.16 re, its left one as far from the wall. */
static const double basin[4][3] = {
    {0.0, 1.2, 0.0}, {0.0, 0.0, 0.0}, {2.0, 0.0, 0.0}, {2.0, 1.2, 0.0}};
static const double middle[2] = {0.38, 0.33};

static int make(void **state) {
  DEF(particles, set, .spacing = L0);
  if (mps_particles_create(context, &set, &water) != MPS_OK) return 1;
  for (int n = 0; n < 40 * 16; n++) {
    const double at[2] = {(n % 40 + 0.5) * L0, (n / 40 + 0.5) * L0};
    if (fabs(at[0] - middle[0]) < 0.2 + 0.4 * L0 && fabs(at[1] - middle[1]) < 0.15 + 0.4 * L0)
      continue;
    if (mps_particles_append(water, 1, at) != MPS_OK) return 1;
  }
  DEF(fluid, def, .level = 0.8);
  return mps_fluid_create(context, water, &def, &fluid) == MPS_OK ? 0 : 1;
}

static int drop(void **state) {
  mps_contact_destroy(&contact);
  mps_body_destroy(&box);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return 0;
}

static mps_status add_basin(double left, double bottom) {
  double corner[4][3];
  memcpy(corner, basin, sizeof corner);
  corner[0][0] = corner[1][0] = left, corner[1][1] = corner[2][1] = bottom;
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .corners = corner[0], .corner_count = 4);
  return mps_fluid_add_boundary(fluid, &def, NULL);
}

static mps_status add_box(double x, double y) {
  DEF(fluid_contact, with, .kind = MPS_BOUNDARY_ROLLER, .mover = MPS_CONTACT_MOVER_OTHER);
  const double xy[8] = {-0.2, -0.15, 0.2, -0.15, 0.2, 0.15, -0.2, 0.15};
  DEF(body, def, .position[0] = x, .position[1] = y);
  mps_body_destroy(&box);
  OK(mps_body_create_polygon(context, &def, 4, xy, &box));
  return mps_fluid_add_contact(fluid, box, &with, &contact);
}

static void says(const char *why) {
  const char *message = mps_context_error(context)->message;
  if (!strstr(message, why)) fail_msg("\"%s\" has no \"%s\"", message, why);
}

TEST_EACH(a_body_near_a_polyline_is_refused, make, drop) {
  OK(add_basin(0.0, 0.0));
  assert_int_equal(add_box(0.2 + 0.9 * RE, 1.5), MPS_ERROR_ARGUMENT); /* in the air, at the wall */
  says("body is 0.1395 m from segment 0 of the polyline of boundary 0");
  assert_int_equal(add_box(1.0, 0.15 - 0.1 * RE), MPS_ERROR_ARGUMENT); /* through the bed */
  says("body is 0 m from segment 1");
  assert_null(contact);
  OK(mps_fluid_step(fluid, 2));
  OK(add_box(middle[0], middle[1]));
}

TEST_EACH(a_polyline_near_a_body_is_refused, make, drop) {
  OK(add_box(middle[0], middle[1]));
  const double inside[4][3] = {{0.3, 0.3, 0.0}, {0.35, 0.4, 0.0}, {0.4, 0.3, 0.0}, {0.3, 0.3, 0.0}};
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .corners = inside[0], .corner_count = 4);
  assert_int_equal(mps_fluid_add_boundary(fluid, &def, NULL), MPS_ERROR_ARGUMENT);
  says("m from body 0, must be at least re = 0.155 m");
  OK(add_basin(0.0, 0.0));
}

/* Where the radius of weights in rock is larger than the distance, the rock is refused, and the
 * water stays as it was. */
TEST_EACH(rock_whose_weights_reach_further_is_refused, make, drop) {
  const double corner[3][3] = {{0.5, 0.0, 0.0}, {1.5, 0.0, 0.0}, {1.0, 0.1, 0.0}};
  DEF(fluid_rock, rock, .corners = corner[0], .corner_count = 3, .porosity = 0.45,
      .diameter = 0.02);
  OK(add_basin(0.0, 0.0));
  OK(add_box(0.2 + 1.05 * RE, 1.5));
  assert_int_equal(mps_fluid_add_rock(fluid, &rock, NULL), MPS_ERROR_ARGUMENT);
  says("porosity of the rock: its weights have the radius 0.178885 m, but body 0 is 0.16275 m from "
       "segment 0 of the polyline of boundary 0");
  mps_contact_destroy(&contact);
  DEF(fluid_boundary, side, .point[0] = -1.05 * RE, .normal[0] = 1.0);
  OK(mps_fluid_add_boundary(fluid, &side, NULL));
  assert_int_equal(mps_fluid_add_rock(fluid, &rock, NULL), MPS_ERROR_ARGUMENT);
  says("the corner at (0, 0) m of the polyline of boundary 0 is 0.16275 m from boundary 1");
  OK(mps_fluid_step(fluid, 2));
  OK(mps_fluid_remove_boundary(fluid, 1));
  OK(mps_fluid_add_rock(fluid, &rock, NULL));
  OK(mps_fluid_step(fluid, 2));
}

/* Beyond re the images in both are right: the box has its buoyancy, and the bed the pressure of the
 * water above it. */
TEST_EACH(beside_each_other_both_are_right, make, drop) {
  mps_reaction r;
  double p[2], level;
  const double below[6] = {0.38, 0.0, 0.0, 1.5, 0.0, 0.0}, side[3] = {0.0, 0.3, 0.0}, far = 1.5;
  OK(add_basin(0.0, 0.0));
  OK(add_box(middle[0], middle[1]));
  DEF(fluid_load, damping, .all = 1, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 5.0);
  OK(mps_fluid_add_load(fluid, &damping, NULL));
  OK(mps_fluid_step(fluid, 400));
  OK(mps_contact_get_reaction(contact, 0, &r));
  OK(mps_fluid_get_levels(fluid, 1, &far, &level));
  OK(mps_fluid_get_pressure(fluid, 0, 2, below, p));
  const double buoyancy = 9810.0 * 0.4 * 0.3;
  printf("buoyancy %.4f of that of the box, sideways %.4f; pressure on the bed %.4f below it, %.4f "
         "beside it, of hydrostatics\n",
         r.force[1] / buoyancy, r.force[0] / buoyancy, p[0] / (9810.0 * level),
         p[1] / (9810.0 * level));
  NEAR(r.force[1] / buoyancy, 1.0, 0.03);
  NEAR(r.force[0] / buoyancy, 0.0, 0.03);
  NEAR(p[0] / (9810.0 * level), 1.0, 0.02);
  NEAR(p[1] / (9810.0 * level), 1.0, 0.02);
  OK(mps_fluid_get_pressure(fluid, 0, 1, side, p));
  NEAR(p[0] / (9810.0 * (level - 0.3)), 1.0, 0.02);
}

/* A body that sinks towards the bed: the step in which it comes nearer than re is not made, and
 * the fluid continues where the body is taken back. */
TEST_EACH(a_body_that_comes_near_ends_the_step, make, drop) {
  mps_body_motion motion = mps_body_motion_defaults();
  mps_status status = MPS_OK;
  double y = middle[1];
  OK(add_basin(0.0, 0.0));
  OK(add_box(middle[0], middle[1]));
  OK(mps_fluid_set_dt(fluid, 0.005));
  motion.velocity[1] = -0.48;
  while (status == MPS_OK && y > 0.2) {
    motion.position[1] = y -= 0.0024;
    OK(mps_body_set_motion(box, &motion));
    status = mps_fluid_step(fluid, 1);
  }
  assert_int_equal(status, MPS_ERROR_STATE);
  says("body 0 comes within 0.1536 m of segment 1 of the polyline of boundary 0");
  NEAR(y, 0.3036, 1e-9);
  const int64_t made = mps_fluid_steps(fluid);
  motion.position[1] = y + 0.0024, motion.velocity[1] = 0.0;
  OK(mps_body_set_motion(box, &motion));
  OK(mps_fluid_step(fluid, 3));
  assert_int_equal(mps_fluid_steps(fluid), made + 3);
}
