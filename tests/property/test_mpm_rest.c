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
        const rest_case c = {(rest_edge)edge, spline, shifts[k], degrees * 0.017453292519943295,
                             0.0};
        rest_check(context, &c, 500);
      }
}

TEST(ground_rests_beside_edges) {
  const double shifts[] = {0.3, 0.6};
  rests(REST_WALLS, REST_EDGES - 1, 0.0, 2, shifts);
}

/* The top of a box, six cells wide, that ends 0.6 cells before its edges. Elastic ground at rest
 * adds 0.3 cells at an edge: up to a tenth of the top bears nothing. */
TEST(ground_rests_beside_inset_edges) {
  for (int k = 0; k < 3; k++) {
    const rest_case c = {REST_BOX, 3, 0.3 * k, 0.3 * (k == 2), 0.6};
    const rest_result r = rest_run(context, &c, 500, 100);
    for (int side = 0; side < 2; side++) assert_true(fabs(r.wall[side]) < 0.02);
    assert_true(fabs(r.floor) < 0.02 && fabs(r.body) < 0.1);
    assert_true(r.kinetic < 1e-4);
  }
}

TEST(ground_rests_on_a_turned_grid) {
  const double shift = 0.3;
  rests(REST_WALLS, REST_BOX, 17.0, 1, &shift);
}
