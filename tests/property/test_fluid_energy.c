/* test_fluid_energy.c - water drives no wall that vibrates, blocks of it that strike keep the
 * energy that theory leaves them, and its waves and vortices last.
 * tests/property/test_fluid_energy_long.c has more of each.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_energy.h"

TEST(a_vibrating_wall_is_damped_and_feels_the_added_mass) {
  const struct {
    double dt, omega;
    int power;
  } runs[] = {{0.0045, 125.0, 0}, {0.0045, 250.0, 1}, {0.0045, 125.0, 2}, {0.0045, 250.0, 2},
              {0.002, 250.0, 2},  {0.0005, 60.0, 1},  {0.004, 60.0, 2},   {0.0005, 60.0, 2}};
  for (size_t k = 0; k < sizeof runs / sizeof *runs; k++)
    forced_check(context, 0.02, runs[k].dt, runs[k].power, runs[k].omega, 0.006);
}

TEST(a_wall_on_a_spring_does_not_grow) { spring_check(context, 0.02, 0.004, 211800.0, 30.0); }

TEST(blocks_that_strike_keep_the_energy_of_theory) {
  blocks_check(context, 10, 0.3, 0.04);
  for (int k = 0; k < 3; k++) blocks_check(context, 15, 0.5 * k, 0.03);
  blocks_check(context, 20, 0.3, 0.03);
  blocks_check(context, 40, 0.0, 0.03); /* whose first step is too long */
}

/* The loss falls faster than the spacing, and short steps do not add to it without end. */
TEST(standing_waves_last) {
  const double coarse = standing_kept(context, 0.03, NAN, 12.0);
  const double fine = standing_kept(context, 0.02, NAN, 12.0);
  const double brief = standing_kept(context, 0.03, 0.002, 12.0);
  print_message("20 periods leave %.4f of the amplitude at d/10, %.4f at d/15; %.4f at d/10 with "
                "steps of 2 ms\n",
                coarse, fine, brief);
  assert_true(coarse > 0.97 && coarse < 1.005);
  assert_true(fine > 0.99 && fine < 1.005);
  assert_true(1.0 - fine < (1.0 - coarse) * 0.02 / 0.03);
  assert_true(brief > 0.94 && brief < 1.005);
}

TEST(vortices_under_water_do_not_expand) {
  for (int k = 1; k <= 3; k++) vortex_check(context, 0.02, 5.0 * k);
  vortex_check(context, 0.02, -10.0);
  vortex_check(context, 0.025, 10.0);
  vortex_check(context, 0.0125, 10.0);
}
