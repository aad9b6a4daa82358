/* test_dynamics.c - explicit dynamics on the ranks that mpirun starts: each rank computes the body
 * alone, then all of them together, and compares its share bit for bit. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "dynamics_scene.h"
#include "world.h"

static void compare_scene(void **state) {
  compare_shares(own, domain, compute, *(const int *)*state, WHOLE_RUN);
}

/* A second domain in the same process; an error of the last rank is an error of all. */
static void test_errors(void **state) {
  (void)state;
  mps_domain *second = NULL;
  mps_assert_ok(own, mps_petsc_domain_create_world(own, &second));
  const int32_t rank = mps_domain_rank(second), ranks = mps_domain_size(second);
  mps_particles_def def = mps_particles_defaults();
  mps_particles *set = NULL, *whole = NULL;
  def.spacing = rank == ranks - 1 ? -1.0 : 1.0;
  const mps_status status = mps_domain_agree(second, mps_particles_create(own, &def, &set));
  assert_int_equal(status, MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(own)->message, "spacing is -1"));
  mps_particles_destroy(&set);
  def.spacing = 1.0;
  mps_assert_ok(own, mps_particles_create(own, &def, &set));
  const double lo[2] = {0.0, 0.0}, hi[2] = {300.0, 200.0};
  mps_assert_ok(own, mps_particles_fill_box(set, lo, hi, NULL));
  mps_assert_ok(own, mps_domain_gather(second, set, &whole));
  assert_int_equal(mps_particles_count(whole), rank == 0 ? 60000 : 0);
  mps_particles_destroy(&whole);
  mps_particles_destroy(&set);
  mps_domain_destroy(&second);
  assert_int_equal(mps_petsc_domain_create_world(NULL, &second), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_petsc_domain_create_world(own, NULL), MPS_ERROR_ARGUMENT);
}

int main(void) {
  static int scene[SCENES] = {LAYERS, SCATTERED, PERIODIC, STRIP};
  if (!begin_world()) return 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(compare_scene, &scene[0]),
      cmocka_unit_test_prestate(compare_scene, &scene[1]),
      cmocka_unit_test_prestate(compare_scene, &scene[2]),
      cmocka_unit_test_prestate(compare_scene, &scene[3]),
      cmocka_unit_test(test_errors),
  };
  return end_world(cmocka_run_group_tests(tests, NULL, NULL));
}
