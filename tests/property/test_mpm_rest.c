/* test_mpm_rest.c - ground at rest stays at rest beside edges of every kind, wherever the grid
 * lies: some shifts of the grid and fewer steps than in test_mpm_rest_long.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_rest.h"
#include "test_fixture.h"

static void rests(rest_edge first, rest_edge last, double degrees, int count,
                  const double *shifts) {
  for (int edge = (int)first; edge <= (int)last; edge++)
    for (int32_t spline = 2; spline <= 3; spline++)
      for (int k = 0; k < count; k++) {
        const rest_case c = {(rest_edge)edge, spline, shifts[k], degrees * 0.017453292519943295};
        rest_check(context, &c, 500);
      }
}

TEST(ground_rests_beside_edges) {
  const double shifts[] = {0.3, 0.6};
  rests(REST_WALLS, REST_EDGES - 1, 0.0, 2, shifts);
}

TEST(ground_rests_on_a_turned_grid) {
  const double shift = 0.3;
  rests(REST_WALLS, REST_BOX, 17.0, 1, &shift);
}
