/* test_body_measure.c - a rigid body in a plane model is the whole body: forces are those of the
 * solver's measure, and soil and water together give the sum, whatever the measure of either.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_tank.h"
#include "mpm_scene.h"
#include "test_fixture.h"

#define SPACING 0.02

static const double measures[] = {1.0, 0.5, 2.0};

/* A box of .2 x .1 m about (x, y). */
static mps_body *make_box(int32_t motion, double x, double y, double mass) {
  DEF(body, def, .motion = motion, .position[0] = x, .position[1] = y);
  if (motion == MPS_BODY_MOTION_FREE) {
    def.mass = mass, def.inertia[2] = mass * (0.2 * 0.2 + 0.1 * 0.1) / 12.0;
    def.gravity[1] = -TANK_G;
  }
  MAKE_KEPT(body, box, create_box, context, &def, 0.2, 0.1);
  return box;
}

/* Soil of `measure` in x0 to x1, y0 to y0 + .1 m, falling at `speed`. */
static mpm_scene make_soil(double measure, double x0, double x1, double y0, double speed) {
  const double v0[] = {0.0, -speed}, none[4] = {0.0};
  mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, x0, y0, x1, y0 + 0.1);
  mpm_scene_affine(&s, v0, none);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 2.0 * SPACING, .measure = measure,
        .gravity[1] = -TANK_G, .lower[0] = -0.2, .upper[0] = 1.0, .lower[1] = -0.2,
        .upper[1] = 1.0);
  return s;
}

/* A tank .6 x .2 m of water of `measure` with the box in it. */
static tank make_water(double measure, mps_body *box, int32_t mover, mps_contact **contact) {
  tank t = {NULL, NULL};
  DEF(fluid, def, .level = 0.2, .measure = measure, .dt = 1e-3);
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = SPACING);
  for (int j = 0; j < 10; j++)
    for (int i = 0; i < 30; i++) {
      const double p[2] = {(i + 0.5) * SPACING, (j + 0.5) * SPACING};
      double d;
      OK(mps_body_distance(box, 1, p, &d, NULL, NULL, NULL));
      if (d > 0.4 * SPACING) OK(mps_particles_append(t.water, 1, p));
    }
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, 0.6, 0.0, -1.0, 0.0, NULL);
  *contact = tank_body(t.fluid, box, mover);
  return t;
}

static mps_contact *add_contact(mpm_scene *soil, mps_body *box, int32_t mover) {
  DEF(contact, def, .friction = 0.3, .mover = mover);
  mps_contact *contact = NULL;
  OK(mps_mpm_add_contact(soil->mpm, box, &def, &contact));
  return contact;
}

static mps_body_state state_of(mps_body *body) {
  mps_body_state s;
  OK(mps_body_get_state(body, &s));
  return s;
}

/* Whether two bodies have moved alike. */
static void same_motion(const mps_body_state *a, const mps_body_state *b, double tolerance) {
  for (int c = 0; c < 2; c++) {
    NEAR(a->position[c], b->position[c], tolerance);
    NEAR(a->velocity[c], b->velocity[c], tolerance);
  }
  NEAR(a->rotation[2], b->rotation[2], tolerance);
  NEAR(a->spin[2], b->spin[2], tolerance);
}

/* ---- soil ------------------------------------------------------------------------------------ */

/* The block strikes the box beside its middle: twice the thickness and mass, the same motion. */
TEST(a_box_struck_by_soil) {
  mps_body_state first = {0};
  for (int k = 0; k < 3; k++) {
    scoped_body *box = make_box(MPS_BODY_MOTION_FREE, 0.4, 0.1, 10.0 * measures[k]);
    scoped_mpm_scene soil = make_soil(measures[k], 0.42, 0.52, 0.16, 1.0);
    scoped_contact *contact = add_contact(&soil, box, MPS_CONTACT_MOVER_SOLVER);
    OK(mps_mpm_run(soil.mpm, 0.02, 1000, NULL, NULL));
    const mps_body_state now = state_of(box);
    mps_reaction r;
    OK(mps_body_get_reaction(box, -1, &r));
    print_message("measure %g m: velocity %.6f m/s, spin %.6f rad/s, impulse %.6f N s\n",
                  measures[k], now.velocity[1], now.spin[2], r.impulse[1]);
    if (k == 0) first = now;
    assert_true(now.velocity[1] < -TANK_G * 0.02 - 0.1 && now.spin[2] < -1.0);
    same_motion(&now, &first, 1e-9);
    NEAR(r.impulse[1], 10.0 * measures[k] * (now.velocity[1] + TANK_G * now.time),
         1e-9 * measures[k]);
  }
}

/* In axisymmetry the measure is an angle, by default the whole ring. */
TEST(a_ring_of_soil) {
  const double angles[] = {1.0, NAN};
  double force[2];
  for (int k = 0; k < 2; k++) {
    scoped_mpm_scene s = mpm_scene_begin(context, SPACING, 0.0, 0.0, 1e5);
    mps_body_def at = mps_body_defaults();
    mps_reaction r;
    mpm_scene_box(&s, 0.0, 0.0, 0.2, 0.1);
    DEF(mpm, def, .cell = 2.0 * SPACING, .geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC,
        .measure = angles[k], .lower[0] = 0.0, .upper[0] = 0.4, .lower[1] = 0.0, .upper[1] = 0.4);
    mpm_scene_solve(&s, &def);
    at.position[1] = 0.1 + 0.049; /* presses 1 mm */
    MAKE(body, plate, create_box, context, &at, 1.0, 0.1);
    DEF(contact, push, .inside = MPS_CONTACT_INSIDE_PUSH);
    OK(mps_mpm_add_contact(s.mpm, plate, &push, NULL));
    OK(mps_mpm_step(s.mpm, 20));
    OK(mps_body_get_reaction(plate, -1, &r));
    force[k] = r.impulse[1];
  }
  assert_true(force[0] > 0.0);
  NEAR(force[1], 2.0 * TANK_PI * force[0], 1e-9 * force[0]);
}

/* ---- water ----------------------------------------------------------------------------------- */

/* The box is held, then floats: forces are those of the measure, motions the same. */
TEST(a_box_in_water) {
  mps_body_state first = {0};
  double held[3];
  for (int k = 0; k < 3; k++) {
    scoped_body *box = make_box(MPS_BODY_MOTION_FREE, 0.3, 0.19, 8.0 * measures[k]);
    const double load[3] = {0.0, -60.0 * measures[k], 0.0};
    const double moment[3] = {0.0, 0.0, 0.5 * measures[k]};
    mps_reaction felt, given;
    scoped_contact *wet = NULL;
    scoped_tank t = make_water(measures[k], box, MPS_CONTACT_MOVER_OTHER, &wet);
    OK(mps_fluid_step(t.fluid, 5));
    OK(mps_body_get_reaction(box, -1, &felt));
    OK(mps_contact_get_reaction(wet, -1, &given));
    assert_true(given.force[1] > 0.0 && felt.count == given.count);
    NEAR(felt.force[1], given.force[1], 1e-12 * given.force[1]);
    NEAR(felt.moment[2], given.moment[2], 1e-12 * given.force[1]);
    NEAR(felt.impulse[1], given.impulse[1], 1e-12 * given.force[1]);
    held[k] = felt.force[1];
    OK(mps_body_set_load(box, load, moment));
    mps_contact_destroy(&wet);
    wet = tank_body(t.fluid, box, MPS_CONTACT_MOVER_SOLVER);
    FAILS(mps_body_advance(box, 1e-3), MPS_ERROR_STATE, "moves this body");
    OK(mps_fluid_step(t.fluid, 20));
    const mps_body_state now = state_of(box);
    OK(mps_body_get_reaction(box, -1, &felt));
    OK(mps_contact_get_reaction(wet, -1, &given));
    print_message("measure %g m: held %.4f N, floats at %.6f m/s, %.4f rad/s, force on the body "
                  "%.4f N, by the water %.4f N\n",
                  measures[k], held[k], now.velocity[1], now.spin[2], felt.force[1],
                  given.force[1]);
    NEAR(felt.force[1], given.force[1], 0.02 * given.force[1]);
    NEAR(held[k], measures[k] * held[0], 1e-9 * held[0]);
    if (k == 0) first = now;
    assert_true(now.velocity[1] < -0.01 && now.spin[2] > 0.01);
    same_motion(&now, &first, 1e-6);
  }
}

/* ---- both ------------------------------------------------------------------------------------ */

/* What soil and water of unit measure each exert, and both together for any of either. */
TEST(a_box_held_in_soil_and_water) {
  double unit[2] = {0.0, 0.0};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      scoped_body *box = make_box(MPS_BODY_MOTION_DRIVEN, 0.3, 0.19, 0.0);
      scoped_mpm_scene soil = make_soil(measures[a], 0.22, 0.38, 0.24, 0.0);
      scoped_contact *contact = add_contact(&soil, box, MPS_CONTACT_MOVER_OTHER);
      scoped_contact *wet = NULL;
      scoped_tank t = make_water(measures[b], box, MPS_CONTACT_MOVER_OTHER, &wet);
      mps_reaction by_soil, by_water, all;
      OK(mps_fluid_step(t.fluid, 3));
      OK(mps_mpm_run(soil.mpm, 3e-3, 1000, NULL, NULL));
      OK(mps_fluid_step(t.fluid, 1));
      OK(mps_contact_get_reaction(contact, -1, &by_soil));
      OK(mps_contact_get_reaction(wet, -1, &by_water));
      OK(mps_body_get_reaction(box, -1, &all));
      if (a + b == 0) unit[0] = by_soil.force[1], unit[1] = by_water.force[1];
      assert_true(unit[0] < -1.0 && unit[1] > 1.0);
      NEAR(all.force[1], measures[a] * unit[0] + measures[b] * unit[1],
           1e-8 * (fabs(unit[0]) + unit[1]));
      NEAR(all.impulse[1], by_soil.impulse[1] + by_water.impulse[1], 1e-12);
      NEAR(all.moment[2], by_soil.moment[2] + by_water.moment[2], 1e-9);
      assert_int_equal(all.count, by_soil.count + by_water.count);
    }
}

/* Soil falls on a box that floats: its momentum is what gravity, water and soil have given, and the
 * same motion follows where everything is twice as thick. `mover`: the soil, or the water. */
static void both_move_a_box(bool water_moves) {
  mps_body_state first = {0};
  for (int k = 0; k < 3; k++) {
    const double mass = 30.0 * measures[k];
    scoped_body *box = make_box(MPS_BODY_MOTION_FREE, 0.3, 0.19, mass);
    scoped_mpm_scene soil = make_soil(measures[k], 0.26, 0.38, 0.26, 0.5);
    mps_contact *contact =
        add_contact(&soil, box, water_moves ? MPS_CONTACT_MOVER_OTHER : MPS_CONTACT_MOVER_SOLVER);
    scoped_contact *wet = NULL;
    scoped_tank t = make_water(
        measures[k], box, water_moves ? MPS_CONTACT_MOVER_SOLVER : MPS_CONTACT_MOVER_OTHER, &wet);
    mps_reaction by_soil, all;
    if (!water_moves) {
      mps_contact_destroy(&wet);
      FAILS(mps_fluid_add_contact(t.fluid, box, NULL, &wet), MPS_ERROR_STATE,
            "another solver moves the body");
      wet = tank_body(t.fluid, box, MPS_CONTACT_MOVER_OTHER);
    }
    for (int n = 1; n <= 40; n++) {
      OK(mps_mpm_run(soil.mpm, 1e-3 * n, 1000, NULL, NULL));
      OK(mps_fluid_step(t.fluid, 1));
    }
    if (!water_moves) OK(mps_mpm_step(soil.mpm, 1)); /* the water's last */
    const mps_body_state now = state_of(box);
    OK(mps_contact_get_reaction(contact, -1, &by_soil));
    OK(mps_body_get_reaction(box, -1, &all));
    print_message("measure %g m, the %s moves the box: %.6f m/s, %.4f rad/s, impulses by all "
                  "%.4f, by the soil %.4f N s\n",
                  measures[k], water_moves ? "water" : "soil", now.velocity[1], now.spin[2],
                  all.impulse[1], by_soil.impulse[1]);
    assert_true(by_soil.impulse[1] < -0.1 * measures[k]);
    NEAR(mass * now.velocity[1], all.impulse[1] - mass * TANK_G * now.time, 1e-9 * mass);
    if (k == 0) first = now;
    same_motion(&now, &first, 1e-5);
    mps_contact_destroy(&contact);
  }
}

TEST(soil_moves_a_box_in_water) { both_move_a_box(false); }

TEST(water_moves_a_box_under_soil) { both_move_a_box(true); }
