/* test_mpm.c - WLS-MPM on the ranks that mpirun starts: each rank computes the body alone, then all
 * of them together, compares its share bit for bit, and all see that no particle is lost.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_ranks.h"

#include <mps/petsc.h>

static mps_context *own;
static mps_domain *domain;

static void compare_scene(void **state) {
  const int what = *(const int *)*state;
  const int64_t steps = 60;
  result alone = {0}, share = {0};
  mps_assert_ok(own, compute(own, NULL, what, steps, &alone));
  mps_assert_ok(own, compute(own, domain, what, steps, &share));
  int64_t *seen = calloc((size_t)alone.count, sizeof *seen);
  compare(&alone, &share, seen);
  for (int64_t first = 0; first < alone.count;
       first += 64) { /* none is lost; totals tell doubles */
    double most[64] = {0.0};
    const int64_t count = alone.count - first < 64 ? alone.count - first : 64;
    for (int64_t k = 0; k < count; k++) most[k] = (double)seen[first + k];
    mps_assert_ok(own, mps_domain_max(domain, 64, most));
    for (int64_t k = 0; k < count; k++) mps_assert_near(most[k], 1.0, 0.0);
  }
  free(seen);
  drop(&alone);
  drop(&share);
}

int main(void) {
  static int which[SCENES] = {SLIDE, SPREAD, RING, ROOM};
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
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
  return failed;
}
