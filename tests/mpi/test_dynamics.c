/* test_dynamics.c - explicit dynamics on the ranks that mpirun starts: each rank computes the body
 * alone, then all of them together, and compares its share bit for bit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics_scene.h"
#include "world.h"

static void compare_scene(void **state) {
  compare_shares(own, domain, compute, *(const int *)*state, WHOLE_RUN);
}

/* A second domain in the same process; an error of the last rank is an error of all. */
static void test_errors(void **state) {
  (void)state;
  mps_domain *second = NULL;
  OK(mps_petsc_domain_create_world(own, &second));
  const int32_t rank = mps_domain_rank(second), ranks = mps_domain_size(second);
  DEF(particles, def, .spacing = rank == ranks - 1 ? -1.0 : 1.0);
  mps_particles *set = NULL, *whole = NULL;
  const mps_status status = mps_domain_agree(second, mps_particles_create(own, &def, &set));
  assert_int_equal(status, MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(own)->message, "spacing is -1"));
  mps_particles_destroy(&set);
  def.spacing = 1.0;
  OK(mps_particles_create(own, &def, &set));
  const double lo[2] = {0.0, 0.0}, hi[2] = {300.0, 200.0};
  OK(mps_particles_fill_box(set, lo, hi, NULL));
  OK(mps_domain_gather_fields(second, set, 0, NULL, &whole));
  assert_int_equal(mps_particles_count(whole), rank == 0 ? 60000 : 0);
  mps_particles_destroy(&whole);
  mps_particles_destroy(&set);
  mps_domain_destroy(&second);
  assert_int_equal(mps_petsc_domain_create_world(NULL, &second), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_petsc_domain_create_world(own, NULL), MPS_ERROR_ARGUMENT);
}

/* Ranks at two instruction levels would differ in their last bits: no domain. */
static void test_levels(void **state) {
  (void)state;
  const int32_t rank = mps_domain_rank(domain), ranks = mps_domain_size(domain);
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL,
      .instruction_level = rank == ranks - 1 ? 1 : 3);
  scoped_context *context = NULL;
  mps_domain *mixed = NULL;
  double none = mps_context_create(&def, &context, NULL, 0) != MPS_OK;
  OK(mps_domain_max(domain, 1, &none));
  if (none == 0.0) { /* else this machine has one level */
    const mps_status status = mps_petsc_domain_create_world(context, &mixed);
    assert_int_equal(status, ranks > 1 ? MPS_ERROR_ARGUMENT : MPS_OK);
    if (ranks > 1)
      assert_non_null(strstr(mps_context_error(context)->message, "instruction_level"));
    mps_domain_destroy(&mixed);
  }
}

/* Another number of steps or end of the run on the last rank, allowed or not: an error of all, and
 * the motion as it was. */
static void test_other_arguments(void **state) {
  (void)state;
  const bool last = mps_domain_rank(domain) == mps_domain_size(domain) - 1;
  const bool many = mps_domain_size(domain) > 1;
  DEF(particles, def, .spacing = 1.0);
  scoped_particles *set = NULL;
  mps_dynamics_def solver = mps_dynamics_defaults();
  scoped_dynamics *dynamics = NULL;
  const double lo[2] = {0.0, 0.0}, hi[2] = {80.0, 40.0};
  OK(mps_particles_create(own, &def, &set));
  OK(mps_particles_fill_box(set, lo, hi, NULL));
  OK(mps_particles_set(set, "density", 0, 1900.0));
  OK(mps_particles_set(set, "shear_velocity", 0, 200.0));
  OK(mps_particles_set(set, "pressure_velocity", 0, 400.0));
  solver.domain = domain;
  OK(mps_dynamics_create(own, set, &solver, &dynamics));
  assert_int_equal(mps_dynamics_step(dynamics, last ? -1 : 2), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(mps_context_error(own)->message, "count is -1"));
  if (many) assert_int_equal(mps_dynamics_step(dynamics, last ? 3 : 2), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_run(dynamics, last ? NAN : 0.1, 1, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_run(dynamics, 0.1, last ? 0 : 1, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_steps(dynamics), 0);
  OK(mps_dynamics_step(dynamics, 2));
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
      cmocka_unit_test(test_levels),
      cmocka_unit_test(test_other_arguments),
  };
  return end_world(cmocka_run_group_tests(tests, NULL, NULL));
}
