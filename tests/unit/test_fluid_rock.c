/* test_fluid_rock.c - permeable regions: definitions that are refused, removal, snapshots; pressure
 * probes on bodies. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include <mps/body.h>
#include <mps/fluid_rock.h>

#define L0 0.05

static mps_particles *water;
static mps_fluid *fluid;

static int make(void **state) {
  (void)state;
  const double normal[3][3] = {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, 1.2}};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = L0;
  if (mps_particles_create(context, &set, &water) != MPS_OK) return 1;
  for (int n = 0; n < 24 * 8; n++) {
    const double at[2] = {(n % 24 + 0.5) * L0, (n / 24 + 0.5) * L0};
    if (at[0] > 0.4 && at[0] < 0.8) continue;
    if (mps_particles_append(water, 1, at) != MPS_OK) return 1;
  }
  def.level = 0.4;
  if (mps_fluid_create(context, water, &def, &fluid) != MPS_OK) return 1;
  for (int k = 0; k < 3; k++) {
    mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
    wall.kind = MPS_BOUNDARY_ROLLER;
    wall.normal[0] = normal[k][0], wall.normal[1] = normal[k][1], wall.point[0] = normal[k][2];
    if (mps_fluid_add_boundary(fluid, &wall, NULL) != MPS_OK) return 1;
  }
  return 0;
}

static int drop(void **state) {
  (void)state;
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return 0;
}

static const double square[4][3] = {
    {0.4, 0.0, 0.0}, {0.8, 0.0, 0.0}, {0.8, 1.0, 0.0}, {0.4, 1.0, 0.0}};

static mps_fluid_rock_def stones(void) {
  mps_fluid_rock_def def = mps_fluid_rock_defaults();
  def.corners = square[0], def.corner_count = 4;
  def.porosity = 0.45, def.diameter = 0.02;
  return def;
}

static void refused(const mps_fluid_rock_def *def, const char *why) {
  int32_t number = 77;
  assert_int_equal(mps_fluid_add_rock(fluid, def, &number), MPS_ERROR_ARGUMENT);
  if (!strstr(mps_context_error(context)->message, why))
    fail_msg("\"%s\" has no \"%s\"", mps_context_error(context)->message, why);
  assert_int_equal(number, 77);
}

static void wrong_rocks_are_refused(void **state) {
  (void)state;
  const double off[3][3] = {{0.0, 0.0, 0.0}, {1.0, NAN, 0.0}, {0.0, 1.0, 0.0}};
  mps_fluid_rock_def def = stones();
  refused(NULL, "NULL");
  def.porosity = NAN;
  refused(&def, "porosity of the rock is nan, must be 0.1 to 1");
  def.porosity = 0.0;
  refused(&def, "porosity of the rock is 0");
  def = stones(), def.diameter = -1.0;
  refused(&def, "diameter of the rock is -1");
  def = stones(), def.alpha = -2.0;
  refused(&def, "alpha of the rock is -2");
  def = stones(), def.KC = 0.0;
  refused(&def, "KC of the rock is 0");
  def = stones(), def.corner_count = 2;
  refused(&def, "corner_count of the rock is 2");
  def = stones(), def.corners = off[0], def.corner_count = 3;
  refused(&def, "number 1 of the rock has the coordinate nan");
  assert_int_equal(mps_fluid_remove_rock(fluid, 0), MPS_ERROR_ARGUMENT);
}

static void rocks_are_added_and_removed(void **state) {
  (void)state;
  mps_fluid_rock_def def = stones();
  mps_snapshot *snapshot = NULL;
  int32_t number[3];
  for (int k = 0; k < 3; k++) mps_assert_ok(context, mps_fluid_add_rock(fluid, &def, &number[k]));
  assert_int_equal(number[2], 2);
  mps_assert_ok(context, mps_fluid_step(fluid, 3));
  mps_assert_ok(context, mps_fluid_snapshot(fluid, &snapshot));
  mps_assert_ok(context, mps_fluid_remove_rock(fluid, 1));
  assert_int_equal(mps_fluid_remove_rock(fluid, 1), MPS_ERROR_ARGUMENT);
  mps_assert_ok(context, mps_fluid_step(fluid, 3));
  mps_assert_ok(context, mps_fluid_add_rock(fluid, &def, &number[1]));
  assert_int_equal(number[1], 1);
  mps_assert_ok(context, mps_fluid_rollback(fluid, snapshot));
  for (int k = 0; k < 2; k++) { /* of another resistance, or another shape */
    double corners[3 * 4];
    mps_fluid_rock_def other = def;
    memcpy(corners, def.corners, 3 * (size_t)def.corner_count * sizeof *corners);
    if (k == 0)
      other.alpha *= 2.0;
    else
      corners[0] -= 0.01, other.corners = corners;
    mps_assert_ok(context, mps_fluid_remove_rock(fluid, 1));
    mps_assert_ok(context, mps_fluid_add_rock(fluid, &other, NULL));
    assert_int_equal(mps_fluid_rollback(fluid, snapshot), MPS_ERROR_STATE);
  }
  for (int k = 0; k < 3; k++) mps_assert_ok(context, mps_fluid_remove_rock(fluid, k));
  assert_int_equal(mps_fluid_rollback(fluid, snapshot), MPS_ERROR_STATE);
  mps_assert_ok(context, mps_fluid_step(fluid, 3));
  mps_snapshot_destroy(&snapshot);
}

/* Water between the wall at 0 and a box at rest: pressures on its face are hydrostatic. */
static void bodies_have_pressure_probes(void **state) {
  (void)state;
  const double xy[8] = {0.4, 0.0, 0.8, 0.0, 0.8, 0.6, 0.4, 0.6}, off[3] = {0.3, 0.2, 0.0};
  mps_body_def def = mps_body_defaults();
  mps_fluid_contact_def with = mps_fluid_contact_defaults();
  mps_body *box = NULL;
  mps_contact *contact = NULL;
  double p[2];
  const double at[6] = {0.4, 0.1, 0.0, 0.8, 0.3, 0.0};
  with.kind = MPS_BOUNDARY_ROLLER;
  mps_assert_ok(context, mps_body_create_polygon(context, &def, 4, xy, &box));
  mps_assert_ok(context, mps_fluid_add_contact(fluid, box, &with, &contact));
  mps_assert_ok(context, mps_fluid_step(fluid, 50));
  mps_assert_ok(context, mps_fluid_get_body_pressure(fluid, contact, 2, at, p));
  mps_assert_near(p[0], 9810.0 * 0.3, 15.0);
  mps_assert_near(p[1], 9810.0 * 0.1, 15.0);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, contact, 1, off, p), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, NULL, 1, at, p), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, contact, -1, at, p), MPS_ERROR_ARGUMENT);
  mps_contact_destroy(&contact);
  mps_body_destroy(&box);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(wrong_rocks_are_refused, make, drop),
      cmocka_unit_test_setup_teardown(rocks_are_added_and_removed, make, drop),
      cmocka_unit_test_setup_teardown(bodies_have_pressure_probes, make, drop)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
