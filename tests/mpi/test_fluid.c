/* test_fluid.c - the fluid on the ranks that mpirun starts: each rank computes it alone, then all
 * of them together, and compares bit for bit. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid_ranks.h"

#include <mps/petsc.h>

static mps_context *own;
static mps_domain *domain;

static void test_collapse(void **state) {
  (void)state, compare_shares(own, domain, compute, COLLAPSE, 12);
}
static void test_afloat(void **state) {
  (void)state, compare_shares(own, domain, compute, AFLOAT, 6);
}
static void test_spill(void **state) {
  (void)state, compare_shares(own, domain, compute, SPILL, 24);
}

int main(void) {
  own = test_context(MPS_EXECUTOR_SERIAL, 1);
  const mps_status status = mps_petsc_domain_create_world(own, &domain);
  if (status != MPS_OK) {
    fprintf(stderr, "no domain: %s\n", mps_status_text(status));
    return 1;
  }
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_collapse),
      cmocka_unit_test(test_afloat),
      cmocka_unit_test(test_spill),
  };
  const int failed = cmocka_run_group_tests(tests, NULL, NULL);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
  return failed;
}
