/* test_mpm.c - WLS-MPM on the ranks that mpirun starts: each rank computes the body alone, then all
 * of them together, compares its share bit for bit, and all see that no particle is lost.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"
#include "world.h"

static void compare_scene(void **state) {
  const int what = *(const int *)*state;
  compare_shares(own, domain, compute, what, what < PRESS ? 60 : 120);
}

/* Particles put in and taken out between steps. */
static void compare_changes(void **state) {
  const int what = *(const int *)*state;
  compare_shares(own, domain, compute_changes, what, 24);
}

int main(void) {
  static int which[] = {SLIDE, SPREAD, RING, ROOM, PRESS, PLATES, PILES};
  if (!begin_world()) return 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(compare_scene, &which[SLIDE]),
      cmocka_unit_test_prestate(compare_scene, &which[SPREAD]),
      cmocka_unit_test_prestate(compare_scene, &which[RING]),
      cmocka_unit_test_prestate(compare_scene, &which[ROOM]),
      cmocka_unit_test_prestate(compare_scene, &which[4]),
      cmocka_unit_test_prestate(compare_scene, &which[5]),
      cmocka_unit_test_prestate(compare_scene, &which[6]),
      cmocka_unit_test_prestate(compare_changes, &which[SPREAD]),
  };
  return end_world(cmocka_run_group_tests(tests, NULL, NULL));
}
