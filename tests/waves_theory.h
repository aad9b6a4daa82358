/* waves_theory.h - linear theory of src/waves for tests: wave number (rad/m) and transfer of a
 * piston in water of `depth` (m). SPDX-License-Identifier: BSD-3-Clause */
#ifndef TEST_WAVES_THEORY_H
#define TEST_WAVES_THEORY_H

#include "waves/dispersion.h"

static inline double theory_y(double period, double depth, double gravity) {
  const double omega = 2.0 * 3.14159265358979323846 / period;
  return omega * omega * depth / gravity;
}

static inline double theory_number(double period, double depth, double gravity) {
  return mpsi_waves_depths(theory_y(period, depth, gravity)) / depth;
}

/* Amplitude of the waves far away, and of the level at the piston in phase with it, over X. */
static inline double theory_far(double period, double depth, double gravity) {
  return mpsi_waves_far(mpsi_waves_depths(theory_y(period, depth, gravity)));
}

static inline double theory_near(double period, double depth, double gravity) {
  return mpsi_waves_near(theory_y(period, depth, gravity));
}

#endif
