/* test_fluid_polyline.c - polylines as boundaries: definitions that are refused, readings, changes,
 * files. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.05

static mps_particles *water;
static mps_fluid *fluid;

/* 16 x 8 particles on y = 0 between x = 0 and .8 m. */
static int make(void **state) {
  DEF(particles, set, .spacing = L0);
  if (mps_particles_create(context, &set, &water) != MPS_OK) return 1;
  for (int n = 0; n < 128; n++) {
    const double at[2] = {(n % 16 + 0.5) * L0, (n / 16 + 0.5) * L0};
    if (mps_particles_append(water, 1, at) != MPS_OK) return 1;
  }
  DEF(fluid, def, .level = 0.4);
  return mps_fluid_create(context, water, &def, &fluid) == MPS_OK ? 0 : 1;
}

static int drop(void **state) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  return 0;
}

static mps_status add(int64_t count, const double (*corner)[3], int32_t *number) {
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .corners = corner ? corner[0] : NULL,
      .corner_count = count);
  return mps_fluid_add_boundary(fluid, &def, number);
}

static void refused(int64_t count, const double (*corner)[3], const char *why) {
  char message[512];
  int32_t number = 77;
  assert_int_equal(add(count, corner, &number), MPS_ERROR_ARGUMENT);
  snprintf(message, sizeof message, "%s", mps_context_error(context)->message);
  if (!strstr(message, why)) fail_msg("\"%s\" has no \"%s\"", message, why);
  assert_int_equal(number, 77);
}

static const double bed[4][3] = {
    {0.0, 0.8, 0.0}, {0.0, 0.0, 0.0}, {0.8, 0.0, 0.0}, {0.8, 0.8, 0.0}};

TEST_EACH(wrong_corners_are_refused, make, drop) {
  const double nan_x[2][3] = {{0.0, 0.0, 0.0}, {NAN, 0.0, 0.0}};
  const double off_plane[2][3] = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.1}};
  const double short_one[2][3] = {{0.0, 0.0, 0.0}, {0.04, 0.0, 0.0}};
  const double reverse[2][3] = {{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
  const double sharp[3][3] = {{-1.0, 0.2, 0.0}, {2.0, -0.2, 0.0}, {-1.0, -0.15, 0.0}};
  const double thin[3][3] = {{-1.0, -1.0, 0.0}, {0.4, -0.1, 0.0}, {-0.9, -1.1, 0.0}};
  const double loop[4][3] = {
      {-1.0, -0.1, 0.0}, {3.0, -0.1, 0.0}, {3.0, -0.5, 0.0}, {2.0, 1.0, 0.0}};
  refused(1, bed, "corner_count is 1");
  refused(-3, bed, "corner_count is -3");
  refused(20000, bed, "corner_count is 20000");
  refused(4, NULL, "corners is NULL");
  refused(2, nan_x, "number 1 of the polyline has the coordinate nan");
  refused(2, off_plane, "coordinate 0.1 m");
  refused(2, short_one, "is 0.04 m long");
  refused(2, reverse, "inside the polyline");
  refused(3, sharp, "degrees of fluid");
  refused(3, thin, "degrees of fluid");
  refused(4, loop, "cross each other");
}

TEST_EACH(other_members_are_refused, make, drop) {
  DEF(fluid_boundary, def, .corners = bed[0], .corner_count = 4, .kind = MPS_BOUNDARY_OPEN);
  assert_int_equal(mps_fluid_add_boundary(fluid, &def, NULL), MPS_ERROR_ARGUMENT);
  def.kind = MPS_BOUNDARY_DRIVEN;
  assert_int_equal(mps_fluid_add_boundary(fluid, &def, NULL), MPS_ERROR_ARGUMENT);
  def.kind = MPS_BOUNDARY_HELD, def.nodes = bed[0], def.node_count = 2;
  assert_int_equal(mps_fluid_add_boundary(fluid, &def, NULL), MPS_ERROR_ARGUMENT);
}

static mps_status add_plane(double x, double nx, double ny) {
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .point[0] = x, .normal[0] = nx,
      .normal[1] = ny);
  return mps_fluid_add_boundary(fluid, &def, NULL);
}

TEST_EACH(planes_meet_polylines_at_right_angles, make, drop) {
  const double flat[2][3] = {{0.0, 0.0, 0.0}, {0.8, 0.0, 0.0}};
  const double slope[3][3] = {{0.0, 0.0, 0.0}, {0.85, 0.0, 0.0}, {1.85, 0.5, 0.0}};
  OK(add_plane(0.0, 1.0, 0.0));
  OK(add(2, flat, NULL));
  OK(add_plane(0.8, -1.0, 0.0));
  OK(mps_fluid_remove_boundary(fluid, 1));
  refused(3, slope, "from boundary 2"); /* its corner */
  OK(mps_fluid_remove_boundary(fluid, 2));
  OK(add(3, slope, NULL));
  assert_int_equal(add_plane(1.3, -1.0, 0.0), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(context)->message, "passes boundary"));
}

/* In a box of one polyline, and in one of three planes. */
TEST_EACH(readings_are_those_of_planes, make, drop) {
  int32_t number = -1;
  int64_t points = 0;
  double x[90], p[30], one = 0.0;
  mps_reaction r;
  OK(add(4, bed, &number));
  assert_int_equal(number, 0);
  OK(mps_fluid_step(fluid, 50));
  OK(mps_fluid_get_boundary_points(fluid, 0, 30, &points, x, p));
  OK(mps_fluid_get_reaction(fluid, 0, &r));
  assert_int_equal(points, 32); /* 8 + 16 + 8 */
  assert_int_equal(r.count, 32);
  NEAR(r.force[1] / (9810.0 * 0.4 * 0.8), 1.0, 2e-3);
  NEAR(r.force[0], 0.0, 1e-4);
  for (int k = 0; k < 30; k++) {
    NEAR(p[k], 9810.0 * (0.4 - x[3 * k + 1]), 10.0);
    OK(mps_fluid_get_pressure(fluid, 0, 1, x + 3 * k, &one));
    NEAR(one, p[k], 1e-9);
  }
  double force[12], moment[4];
  OK(mps_fluid_get_segments(fluid, 0, 4, &points, force, moment));
  assert_int_equal(points, 3);
  NEAR(force[4], r.force[1], 1e-9);
  NEAR(force[0] / (0.5 * 9810.0 * 0.4 * 0.4), 1.0, 2e-3);
  NEAR(force[6], -force[0], 1e-4);
  NEAR(moment[0] + moment[1] + moment[2], r.moment[2], 1e-9);
  assert_int_equal(mps_fluid_get_segments(fluid, 1, 4, &points, force, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_get_segments(fluid, 0, -1, &points, NULL, NULL), MPS_ERROR_ARGUMENT);
  const double off[3] = {0.4, 0.2, 0.0};
  assert_int_equal(mps_fluid_get_pressure(fluid, 0, 1, off, &one), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_fluid_set_boundary_motion(fluid, 0, NULL, &one), MPS_ERROR_ARGUMENT);
  const double outside[2] = {1.0, 0.2}, close[2] = {0.79, 0.6}, free_place[2] = {0.4, 0.6};
  assert_int_equal(mps_particles_append(water, 1, outside), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_particles_append(water, 1, close), MPS_ERROR_ARGUMENT);
  OK(mps_particles_append(water, 1, free_place));
}

TEST_EACH(polylines_are_changed_and_removed, make, drop) {
  const double wide[4][3] = {
      {-0.1, 0.8, 0.0}, {-0.1, -0.1, 0.0}, {0.9, -0.1, 0.0}, {0.9, 0.8, 0.0}};
  OK(add(4, bed, NULL));
  OK(mps_fluid_step(fluid, 2));
  DEF(fluid_boundary, def, .kind = MPS_BOUNDARY_ROLLER, .corners = wide[0], .corner_count = 4);
  OK(mps_fluid_set_boundary(fluid, 0, &def));
  OK(mps_fluid_step(fluid, 2));
  def.corner_count = 1;
  assert_int_equal(mps_fluid_set_boundary(fluid, 0, &def), MPS_ERROR_ARGUMENT);
  OK(mps_fluid_step(fluid, 2));
  OK(mps_fluid_remove_boundary(fluid, 0));
  OK(mps_fluid_step(fluid, 2)); /* it falls */
  assert_int_equal(mps_fluid_remove_boundary(fluid, 0), MPS_ERROR_ARGUMENT);
}

TEST_EACH(a_snapshot_is_of_its_polyline, make, drop) {
  scoped_snapshot *snapshot = NULL;
  mps_reaction before, after;
  const double other[4][3] = {{0.0, 0.8, 0.0}, {0.0, 0.0, 0.0}, {0.9, 0.0, 0.0}, {0.9, 0.8, 0.0}};
  OK(add(4, bed, NULL));
  OK(mps_fluid_step(fluid, 5));
  OK(mps_fluid_snapshot(fluid, &snapshot));
  OK(mps_fluid_step(fluid, 5));
  OK(mps_fluid_get_reaction(fluid, 0, &before));
  OK(mps_fluid_rollback(fluid, snapshot));
  OK(mps_fluid_step(fluid, 5));
  OK(mps_fluid_get_reaction(fluid, 0, &after));
  assert_memory_equal(before.force, after.force, sizeof after.force);
  assert_memory_equal(before.impulse, after.impulse, sizeof after.impulse);
  const mps_status saved = mps_fluid_save(fluid, "polyline.h5", NULL);
  if (saved != MPS_ERROR_UNSUPPORTED) { /* without HDF5 */
    OK(saved);
    OK(mps_fluid_restore(fluid, "polyline.h5", NULL));
    remove("polyline.h5");
  }
  OK(mps_fluid_remove_boundary(fluid, 0));
  OK(add(4, other, NULL));
  assert_int_equal(mps_fluid_rollback(fluid, snapshot), MPS_ERROR_STATE);
}
