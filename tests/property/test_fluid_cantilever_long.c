/* test_fluid_cantilever_long.c - test_fluid_cantilever.c with steps of 4, 2 and 1 ms over 8 s.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_cantilever.h"

TEST(a_cantilever_does_not_grow) {
  for (int k = 0; k < 3; k++)
    for (int r = 1; r <= 2; r++)
      assert_true(cantilever_growth(context, 0.004 / (1 << k), 0.5 * r, 8.0) < 0.0);
}
