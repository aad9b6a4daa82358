/* test_fluid_pressure.c - pressures along walls as arrays: still water has p = rho g depth, and the
 * sum over the points is what the wall exerts. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define DEPTH 0.5 /* m; spacing .025: 20 rows */

static tank still(void) {
  tank t = tank_make(context, 0.6, DEPTH, 0.025, NULL, 2e-3);
  OK(mps_fluid_step(t.fluid, 3));
  return t;
}

TEST(pressures_of_still_water) {
  scoped_tank t = still();
  double x[3 * 64], p[64];
  int64_t count = 0;
  const int32_t walls[] = {TANK_BED, TANK_LEFT, TANK_RIGHT};
  for (int w = 0; w < 3; w++) {
    OK(mps_fluid_get_boundary_points(t.fluid, walls[w], 64, &count, x, p));
    assert_int_equal(count, walls[w] == TANK_BED ? 24 : 20);
    double force = 0.0;
    for (int64_t k = 0; k < count; k++) {
      NEAR(p[k], 1000.0 * TANK_G * (DEPTH - x[3 * k + 1]), 5e-4);
      assert_true(x[3 * k + 2] == 0.0);
      force += 0.025 * p[k];
    }
    mps_reaction r;
    OK(mps_fluid_get_reaction(t.fluid, walls[w], &r));
    const double size = hypot(r.force[0], r.force[1]);
    NEAR(size, force, 1e-9 * size);
    /* The bed carries the weight; a side, the triangle of pressure, by its own points exactly. */
    NEAR(size, 1000.0 * TANK_G * DEPTH * (walls[w] == TANK_BED ? 0.6 : 0.5 * DEPTH), 1e-6 * size);
  }
  /* A list too short receives the number. */
  OK(mps_fluid_get_boundary_points(t.fluid, TANK_LEFT, 2, &count, NULL, p));
  assert_int_equal(count, 20);
  OK(mps_fluid_get_boundary_points(t.fluid, TANK_LEFT, 0, &count, NULL, NULL));
  assert_int_equal(count, 20);
}

TEST(pressures_at_given_points) {
  scoped_tank t = still();
  const double x[] = {0.0, 0.013, 0.0, 0.0, 0.217, 0.0, 0.0, 0.46, 0.0, 0.0, 0.8, 0.0};
  double p[4] = {-1.0, -1.0, -1.0, -1.0};
  OK(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 4, x, p));
  for (int k = 0; k < 3; k++) NEAR(p[k], 1000.0 * TANK_G * (DEPTH - x[3 * k + 1]), 5e-4);
  assert_true(p[3] == 0.0); /* above the water */
}

TEST(bad_questions_are_refused) {
  scoped_tank t = still();
  const double off[] = {0.001, 0.1, 0.0}, nowhere[] = {NAN, 0.1, 0.0};
  double p = 7.0;
  int64_t count = -1;
  REFUSES(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, off, &p), "0.001 m off the wall");
  REFUSES(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, nowhere, &p), "nan");
  REFUSES(mps_fluid_get_pressure(t.fluid, TANK_LEFT, -1, off, &p), "count is -1");
  REFUSES(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, NULL, &p), "x is NULL");
  REFUSES(mps_fluid_get_boundary_points(t.fluid, TANK_LEFT, -1, &count, NULL, NULL),
          "capacity is -1");
  REFUSES(mps_fluid_get_boundary_points(t.fluid, 5, 0, &count, NULL, NULL), "number is 5");
  assert_true(p == 7.0 && count == -1);
}
