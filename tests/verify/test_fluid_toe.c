/* test_fluid_toe.c - water at rest before bodies whose sloping faces reach the bed, at every angle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_toe.h"

static void water_rests_before_faces_of_every_slope(void **state) {
  (void)state;
  for (double angle = 15.0; angle <= 165.0; angle += 15.0) {
    const toe s = {.angle = angle, .rows = 12};
    toe_check(&s, 2.0, angle < 45.0 ? 0.06 : 0.03, 0.03);
  }
}

static void water_rests_before_slopes_on_a_vertical_toe(void **state) {
  (void)state;
  const double angles[2] = {135.0, 153.43494882292202}; /* 1:1 and 1:2 */
  for (int k = 0; k < 2; k++) {
    const toe s = {.angle = angles[k], .vertical = 2.0 * TOE_DEPTH / 16, .rows = 16};
    toe_check(&s, 2.0, 0.02, 0.02);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_rests_before_faces_of_every_slope),
      cmocka_unit_test(water_rests_before_slopes_on_a_vertical_toe),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
