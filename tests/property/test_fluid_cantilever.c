/* test_fluid_cantilever.c - an elastic wall that oscillates in front of water gains no energy from
 * it, with the trapezoidal rule (rho_inf 1) and with one that damps high frequencies.
 * tests/property/test_fluid_cantilever_long.c has shorter steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_cantilever.h"

TEST(a_cantilever_does_not_grow) {
  assert_true(cantilever_growth(context, 0.004, 1.0, 3.0) < 0.0);
  assert_true(cantilever_growth(context, 0.004, 0.5, 3.0) < 0.0);
}
