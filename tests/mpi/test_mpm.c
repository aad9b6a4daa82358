/* test_mpm.c - WLS-MPM on the ranks that mpirun starts: each rank computes the body alone, then all
 * of them together, compares its share bit for bit, and all see that no particle is lost.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"

#include <mps/petsc.h>

static mps_context *own;
static mps_domain *domain;

static void compare_scene(void **state) {
  const int what = *(const int *)*state;
  compare_shares(own, domain, compute, what, what < PRESS ? 60 : 120);
}

int main(void) {
  static int which[] = {SLIDE, SPREAD, RING, ROOM, PRESS, PLATES};
  own = test_context(MPS_EXECUTOR_SERIAL, 1);
  const mps_status status = mps_petsc_domain_create_world(own, &domain);
  if (status != MPS_OK) {
    fprintf(stderr, "no domain: %s\n", mps_status_text(status));
    return 1;
  }
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(compare_scene, &which[SLIDE]),
      cmocka_unit_test_prestate(compare_scene, &which[SPREAD]),
      cmocka_unit_test_prestate(compare_scene, &which[RING]),
      cmocka_unit_test_prestate(compare_scene, &which[ROOM]),
      cmocka_unit_test_prestate(compare_scene, &which[4]),
      cmocka_unit_test_prestate(compare_scene, &which[5]),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
  return failed;
}
