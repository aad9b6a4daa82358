/* test_fluid_readings.c - readings of a fluid between steps follow from its state: after a rollback
 * or an abandoned step they are the same, bit for bit, as before.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_readings.h"

#define SPACING 0.025

/* A column that falls, with a load on a part of it and forces on some particles; what `kind` adds.
 */
enum { CLOSED, SPILLS, AFLOAT };

typedef struct scene {
  tank t;
  mps_body *body;
  mps_contact *contact; /* of the body and the water */
  double right;
} scene;

static void push_some(mps_particles *water) {
  OK(mps_particles_add_field(water, "external_force", 0));
  EDIT(force, water, "external_force")
    for (int64_t i = 0; i < mps_particles_count(water); i += 7) *mps_edit_f64(&force, i, 0) = 0.3;
}

static void add_box(scene *s) {
  int64_t ids[200], count = 0;
  mps_view id = view_field(s->t.water, "id");
  mps_view x = view_field(s->t.water, "position");
  for (int64_t i = 0; i < id.shape[0]; i++)
    if (fabs(*mps_view_f64(&x, i, 0) - 0.3) < 0.05 && *mps_view_f64(&x, i, 1) > 0.3)
      ids[count++] = *mps_view_i64(&id, i, 0);
  OK(mps_particles_remove(s->t.water, ids, count));
  DEF(body, def, .motion = MPS_BODY_MOTION_FREE, .gravity[1] = -TANK_G, .position[0] = 0.3,
      .position[1] = 0.4, .mass = 12.0, .inertia[2] = 0.04);
  OK(mps_body_create_box(context, &def, 0.1, 0.2, &s->body));
  s->contact = tank_body(s->t.fluid, s->body, MPS_CONTACT_MOVER_SOLVER);
}

static scene make(int kind) {
  scene s = {.right = kind == SPILLS ? (double)NAN : 1.2};
  mps_fluid_boundary_def end = mps_fluid_boundary_defaults();
  end.kind = MPS_BOUNDARY_ROLLER; /* slip */
  USING(particles, mps_particles_create(context, &given, &s.t.water), .spacing = SPACING);
  tank_fill(s.t.water, 0.6, 0.4, NULL, NULL);
  push_some(s.t.water);
  OK(mps_fluid_create(context, s.t.water, NULL, &s.t.fluid));
  tank_wall(s.t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(s.t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  end.point[0] = kind == SPILLS ? 0.65 : s.right, end.normal[0] = -1.0;
  if (kind == SPILLS) end.kind = MPS_BOUNDARY_OPEN;
  OK(mps_fluid_add_boundary(s.t.fluid, &end, NULL));
  DEF(fluid_load, load, .lower[0] = 0.5, .acceleration[0] = 1.0);
  OK(mps_fluid_add_load(s.t.fluid, &load, NULL));
  load.kind = MPS_FLUID_LOAD_PRESSURE, load.pressure = 30.0;
  OK(mps_fluid_add_load(s.t.fluid, &load, NULL));
  if (kind == AFLOAT) add_box(&s);
  return s;
}

static void drop_scene(scene *s) {
  tank_free(&s->t);
  mps_contact_destroy(&s->contact);
  mps_body_destroy(&s->body);
}

static void read_scene(scene *s, readings *r) { read_all(s->t.fluid, s->right, s->contact, r); }

/* At every step, those after which the set is sorted too. */
static void readings_survive(int kind, int64_t every) {
  static readings before, after;
  mps_snapshot *kept = NULL;
  SCOPED(drop_scene) scene s = make(kind);
  for (int64_t k = 0; k < 70; k += every) {
    read_scene(&s, &before);
    OK(mps_fluid_snapshot(s.t.fluid, &kept));
    OK(mps_fluid_begin_step(s.t.fluid, NAN));
    OK(mps_fluid_solve_pressure(s.t.fluid));
    OK(mps_fluid_abandon_step(s.t.fluid));
    read_scene(&s, &after);
    same_readings(&before, &after);
    OK(mps_fluid_step(s.t.fluid, 3));
    OK(mps_fluid_rollback(s.t.fluid, kept));
    read_scene(&s, &after);
    same_readings(&before, &after);
    OK(mps_fluid_step(s.t.fluid, every));
    mps_snapshot_destroy(&kept);
  }
}

TEST(of_a_column_that_falls) { readings_survive(CLOSED, test_quick() ? 15 : 5); }
TEST(of_water_that_leaves) { readings_survive(SPILLS, test_quick() ? 15 : 5); }
TEST(of_a_body_afloat) { readings_survive(AFLOAT, test_quick() ? 30 : 10); }

/* Particles moved by the caller, and new walls: the surface is found before it is read, and a
 * snapshot between both changes nothing. */
TEST(of_what_the_caller_changes) {
  static readings before, after;
  scoped_snapshot *kept = NULL;
  SCOPED(drop_scene) scene s = make(CLOSED);
  OK(mps_fluid_step(s.t.fluid, 10));
  EDIT(x, s.t.water, "position")
    for (int64_t i = 0; i < mps_particles_count(s.t.water); i++) *mps_edit_f64(&x, i, 1) += 0.003;
  OK(mps_fluid_snapshot(s.t.fluid, &kept));
  read_scene(&s, &before);
  OK(mps_fluid_step(s.t.fluid, 2));
  OK(mps_fluid_rollback(s.t.fluid, kept));
  read_scene(&s, &after);
  same_readings(&before, &after);
  mps_snapshot_destroy(&kept);
  OK(mps_fluid_snapshot(s.t.fluid, &kept));
  OK(mps_fluid_step(s.t.fluid, 2));
  OK(mps_fluid_rollback(s.t.fluid, kept));
  read_scene(&s, &after);
  same_readings(&before, &after);
}

/* In an open step levels are those of its beginning. */
TEST(in_an_open_step) {
  const double station[2] = {0.3, 0.55};
  double before[2], after[2];
  SCOPED(drop_scene) scene s = make(CLOSED);
  for (int k = 0; k < 2; k++) {
    if (k == 1) OK(mps_fluid_get_levels(s.t.fluid, 2, station, before));
    OK(mps_fluid_begin_step(s.t.fluid, NAN));
    OK(mps_fluid_get_levels(s.t.fluid, 2, station, after));
    if (k == 0) NEAR(after[0], 0.4, 0.1 * SPACING);
    if (k == 1) assert_memory_equal(before, after, sizeof before);
    OK(mps_fluid_solve_pressure(s.t.fluid));
    OK(mps_fluid_end_step(s.t.fluid));
  }
}
