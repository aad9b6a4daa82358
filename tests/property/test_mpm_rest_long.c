/* test_mpm_rest_long.c - ground at rest beside edges of every kind for 3000 steps, at ten shifts of
 * the grid and on turned grids. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_rest.h"
#include "test_fixture.h"

static void rests(rest_edge last, double degrees, int shifts) {
  for (int edge = REST_WALLS; edge <= (int)last; edge++)
    for (int32_t spline = 2; spline <= 3; spline++)
      for (int k = 0; k < shifts; k++) {
        const double shift = (double)k / shifts;
        const rest_case c = {(rest_edge)edge, spline, shift, degrees * 0.017453292519943295, 0.0};
        rest_check(context, &c, 3000);
      }
}

TEST(along_the_grid) { rests(REST_EDGES - 1, 0.0, 10); }
TEST(turned_by_17_degrees) { rests(REST_BOX, 17.0, 3); }
TEST(turned_by_45_degrees) { rests(REST_BOX, 45.0, 3); }
