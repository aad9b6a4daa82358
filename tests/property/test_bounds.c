/* test_bounds.c - physics held to bounds that no parameter may break, with a few draws of the
 * parameters; more of them in test_bounds_long.c. SPDX-License-Identifier: BSD-3-Clause */
#include "bounds.h"
#include "bounds_undone.h"
#include "test_fixture.h"

#ifndef BOUNDS_DRAWS
#define BOUNDS_DRAWS 4
#endif

TEST(porosity_stays_between_0_and_1) {
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_porosity(context, k);
}

TEST(energy_of_a_closed_scene_falls) {
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_energy(context, k);
}

TEST(a_smooth_wall_bears_nothing_along_itself) {
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_wall(context, k);
}

TEST(a_footing_stays_below_its_upper_bound) {
  double margin = -INFINITY;
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_footing(context, k, &margin);
  print_message("largest part of the upper bound beyond it: %.2f h/b, allowed %.2f h/b\n", margin,
                BOUNDS_OVERSHOOT);
}

TEST(a_closed_tank_keeps_its_level) {
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_tank(context, k);
}

TEST(settlement_is_the_water_that_left) {
  for (int k = 0; k < BOUNDS_DRAWS; k++) bounds_consolidation(context, k);
}

/* Three grids, three stiffnesses, dry and wet. */
TEST(a_step_of_ground_beyond_bounds_is_undone) {
  for (int k = 0; k < 18; k++) {
    undone_mpm_load(context, k % 3, k / 3 % 3, k >= 9);
    undone_mpm_dt(context, k % 3, k / 3 % 3, k >= 9);
  }
}

TEST(a_step_of_dynamics_beyond_bounds_is_undone) {
  for (int k = 0; k < 27; k++) undone_dynamics(context, k % 3, k / 3 % 3, k / 9);
}

TEST(a_step_of_water_beyond_bounds_is_undone) {
  for (int k = 0; k < 9; k++) undone_fluid(context, k % 3, 40.0 + 8.0 * (k / 3));
}

TEST(a_step_of_elasticity_beyond_bounds_is_undone) {
  for (int k = 0; k < 9; k++) undone_elastic(context, k % 3, k / 3);
}
