/* test_fluid_energy_long.c - test_fluid_energy.c with the whole table of forced walls, 300 periods
 * of a wall on a spring, and finer blocks and waves. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_energy.h"

/* Finer steps and all shapes. */
TEST(vibrating_walls_are_damped_and_feel_the_added_mass) {
  const double omega[] = {60.0, 125.0, 250.0}, coarse[] = {0.0045, 0.004, 0.002, 0.001, 0.0005},
               fine[] = {0.0031, 0.001};
  for (int power = 0; power <= 2; power++)
    for (int w = 0; w < 3; w++) {
      for (size_t k = 0; k < sizeof coarse / sizeof *coarse; k++)
        forced_check(context, 0.02, coarse[k], power, omega[w], 0.006);
      for (size_t k = 0; k < sizeof fine / sizeof *fine; k++)
        forced_check(context, 0.01, fine[k], power, omega[w], 0.006);
    }
}

TEST(walls_on_springs_do_not_grow) {
  spring_check(context, 0.02, 0.004, 211800.0, 300.0);
  spring_check(context, 0.02, 0.0023, 1e6, 300.0);
  spring_check(context, 0.02, 0.002, 211800.0, 100.0);
  spring_check(context, 0.02, 0.004, 1e6, 300.0); /* omega dt = .52: too long, but no growth */
}

TEST(blocks_that_strike_keep_the_energy_of_theory) {
  for (int k = 0; k < 3; k++) {
    blocks_check(context, 10, 0.25 * k, 0.06); /* coarse: a gap of a spacing's part counts */
    blocks_check(context, 20, 0.25 * k, 0.03);
  }
  for (int k = 0; k < 3; k++) blocks_check(context, 40, 0.5 * k, 0.03);
  blocks_check(context, 20, 1.0, 0.03);
}

/* The loss at d/10, d/20, d/40 falls with the spacing, from d/20 on by little. */
TEST(standing_waves_last) {
  double loss[3];
  for (int k = 0; k < 3; k++) {
    loss[k] = 1.0 - standing_kept(context, 0.03 / (1 << k), NAN, 20.0);
    print_message("20 periods leave %.4f of the amplitude at d/%d\n", 1.0 - loss[k], 10 << k);
  }
  assert_true(loss[1] < 0.025 && loss[1] > -0.005);
  assert_true(loss[1] < 0.6 * loss[0]); /* order .8 */
  assert_true(loss[2] < loss[1] && loss[2] > -0.01);
}
