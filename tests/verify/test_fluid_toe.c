/* test_fluid_toe.c - water at rest before bodies whose sloping faces reach the bed, at every angle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_toe.h"

TEST(water_rests_before_faces_of_every_slope) {
  for (double angle = 15.0; angle <= 165.0; angle += 15.0) {
    const toe s = {.angle = angle, .rows = 12};
    toe_check(&s, 2.0, angle < 45.0 ? 0.06 : 0.03, 0.03);
  }
}

TEST(water_rests_before_slopes_on_a_vertical_toe) {
  const double angles[2] = {135.0, 153.43494882292202}; /* 1:1 and 1:2 */
  for (int k = 0; k < 2; k++) {
    const toe s = {.angle = angles[k], .vertical = 2.0 * TOE_DEPTH / 16, .rows = 16};
    toe_check(&s, 2.0, 0.02, 0.02);
  }
}

TEST(a_face_almost_flat_on_the_bed_is_refused) {
  const double a = tan(14.0 * TANK_PI / 180.0);
  const double xy[] = {1.0, 0.0, 1.4, 0.0, 1.4, 0.4 * a, 0.6, 0.4 * a};
  const mps_body_def at = mps_body_defaults();
  scoped_tank t = tank_make(context, 2.0, 0.1, 0.02, NULL, 2e-3);
  MAKE(body, body, create_polygon, context, &at, 4, xy);
  assert_int_equal(mps_fluid_add_contact(t.fluid, body, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(context)->message, "enclose 14 degrees of fluid"));
}
