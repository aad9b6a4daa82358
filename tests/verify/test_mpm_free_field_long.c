/* test_mpm_free_field_long.c - a layer between free-field sides on an absorbing base, shaken by
 * steady S and P waves, on fine cells: amplification against the closed form of a layer on a half
 * space. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_free_field.h"
#include "test_fixture.h"

static void check(double share, int shear, double flip_time, double bar) {
  const field_response r = field_shake_layer(context, 0.25, share, shear, flip_time);
  field_print_response(&r);
  NEAR(r.amplification, r.exact, bar * r.exact);
  assert_true(r.apart < 1e-6);
  assert_true(r.rough < 2e-3); /* noise of particles that nodes do not see */
}

TEST(layer_amplifies) {
  static const double share[] = {0.5, 1.0, 2.0, 3.0};
  for (int shear = 0; shear < 2; shear++)
    for (size_t q = 0; q < sizeof share / sizeof *share; q++) {
      /* the transfers damp the third mode, of 32 cells a wave length (docs/verification), unless
       * flip_time is of its period or the tenth of that */
      check(share[q], shear, 0.0, share[q] < 3.0 ? 0.02 : 0.15);
      check(share[q], shear, 0.1, 0.02);
    }
}
