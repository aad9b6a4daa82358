/* test_fluid_toe_long.c - as verify/fluid_toe, with finer water.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_toe.h"

TEST(finer_water_rests_closer_to_hydrostatics) {
  for (int rows = 24; rows <= 36; rows += 12)
    for (double angle = 15.0; angle <= 165.0; angle += 10.0) {
      const toe s = {.angle = angle, .rows = rows};
      toe_check(&s, 2.0, angle < 45.0 ? 0.04 : 0.015, 0.02);
    }
}
