/* test_fluid_rock.c - permeable regions: definitions that are refused, removal, snapshots; pressure
 * probes on bodies. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.05

static mps_particles *water;
static mps_fluid *fluid;

static int make(void **state) {
  const double normal[3][3] = {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, 1.2}};
  DEF(particles, set, .spacing = L0);
  if (mps_particles_create(context, &set, &water) != MPS_OK) return 1;
  for (int n = 0; n < 24 * 8; n++) {
    const double at[2] = {(n % 24 + 0.5) * L0, (n / 24 + 0.5) * L0};
    if (at[0] > 0.4 && at[0] < 0.8) continue;
    if (mps_particles_append(water, 1, at) != MPS_OK) return 1;
  }
  DEF(fluid, def, .level = 0.4);
  if (mps_fluid_create(context, water, &def, &fluid) != MPS_OK) return 1;
  for (int k = 0; k < 3; k++) {
    DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .normal[0] = normal[k][0],
        .normal[1] = normal[k][1], .point[0] = normal[k][2]);
    if (mps_fluid_add_boundary(fluid, &wall, NULL) != MPS_OK) return 1;
  }
  return 0;
}

static int drop(void **state) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return 0;
}

static const double square[4][3] = {
    {0.4, 0.0, 0.0}, {0.8, 0.0, 0.0}, {0.8, 1.0, 0.0}, {0.4, 1.0, 0.0}};

static mps_fluid_rock_def stones(void) {
  DEF(fluid_rock, def, .corners = square[0], .corner_count = 4, .porosity = 0.45, .diameter = 0.02);
  return def;
}

static void refused(const mps_fluid_rock_def *def, const char *why) {
  int32_t number = 77;
  assert_int_equal(mps_fluid_add_rock(fluid, def, &number), MPS_ERROR_ARGUMENT);
  if (!strstr(mps_context_error(context)->message, why))
    fail_msg("\"%s\" has no \"%s\"", mps_context_error(context)->message, why);
  assert_int_equal(number, 77);
}

TEST_EACH(wrong_rocks_are_refused, make, drop) {
  const double off[3][3] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.1}, {0.0, 1.0, 0.0}};
  mps_fluid_rock_def def = stones();
  refused(NULL, "NULL");
  def = stones(), def.corners = off[0], def.corner_count = 3;
  refused(&def, "number 1 of the rock has z 0.1 m, must be 0");
  assert_int_equal(mps_fluid_remove_rock(fluid, 0), MPS_ERROR_ARGUMENT);
}

TEST_EACH(rocks_are_added_and_removed, make, drop) {
  mps_fluid_rock_def def = stones();
  scoped_snapshot *snapshot = NULL;
  int32_t number[3];
  for (int k = 0; k < 3; k++) OK(mps_fluid_add_rock(fluid, &def, &number[k]));
  assert_int_equal(number[2], 2);
  OK(mps_fluid_step(fluid, 3));
  OK(mps_fluid_snapshot(fluid, &snapshot));
  OK(mps_fluid_remove_rock(fluid, 1));
  assert_int_equal(mps_fluid_remove_rock(fluid, 1), MPS_ERROR_ARGUMENT);
  OK(mps_fluid_step(fluid, 3));
  OK(mps_fluid_add_rock(fluid, &def, &number[1]));
  assert_int_equal(number[1], 1);
  OK(mps_fluid_rollback(fluid, snapshot));
  for (int k = 0; k < 2; k++) { /* of another resistance, or another shape */
    double corners[3 * 4];
    mps_fluid_rock_def other = def;
    memcpy(corners, def.corners, 3 * (size_t)def.corner_count * sizeof *corners);
    if (k == 0)
      other.alpha *= 2.0;
    else
      corners[0] -= 0.01, other.corners = corners;
    OK(mps_fluid_remove_rock(fluid, 1));
    OK(mps_fluid_add_rock(fluid, &other, NULL));
    assert_int_equal(mps_fluid_rollback(fluid, snapshot), MPS_ERROR_STATE);
  }
  for (int k = 0; k < 3; k++) OK(mps_fluid_remove_rock(fluid, k));
  assert_int_equal(mps_fluid_rollback(fluid, snapshot), MPS_ERROR_STATE);
  OK(mps_fluid_step(fluid, 3));
}

/* Water between the wall at 0 and a box at rest: pressures on its face are hydrostatic. */
TEST_EACH(bodies_have_pressure_probes, make, drop) {
  const double xy[8] = {0.4, 0.0, 0.8, 0.0, 0.8, 0.6, 0.4, 0.6}, off[3] = {0.3, 0.2, 0.0};
  mps_body_def def = mps_body_defaults();
  DEF(fluid_contact, with, .kind = MPS_BOUNDARY_ROLLER);
  scoped_contact *contact = NULL;
  double p[2];
  const double at[6] = {0.4, 0.1, 0.0, 0.8, 0.3, 0.0};
  MAKE(body, box, create_polygon, context, &def, 4, xy);
  OK(mps_fluid_add_contact(fluid, box, &with, &contact));
  OK(mps_fluid_step(fluid, 50));
  OK(mps_fluid_get_body_pressure(fluid, contact, 2, at, p));
  NEAR(p[0], 9810.0 * 0.3, 15.0);
  NEAR(p[1], 9810.0 * 0.1, 15.0);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, contact, 1, off, p), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, NULL, 1, at, p), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_get_body_pressure(fluid, contact, -1, at, p), MPS_ERROR_ARGUMENT);
}
