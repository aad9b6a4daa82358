/* test_last_error.c - errors without an object: the last record of a thread, by which a NULL object
 * or a context that could not be made has a text; records and results of other sizes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include <pthread.h>

static void expect(mps_status status, const char *function, const char *message) {
  assert_int_equal(status, MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_last_error()->status, MPS_ERROR_ARGUMENT);
  assert_string_equal(mps_last_error()->function, function);
  assert_string_equal(mps_last_error()->message, message);
  mps_context_clear_error(NULL);
  assert_string_equal(mps_last_error()->message, "");
}

TEST(an_object_that_is_null_is_named) {
  const double at[3] = {0.0, 0.0, 0.0};
  mps_signal *signal = NULL;
  mps_totals totals;
  expect(mps_mpm_step(NULL, 1), "mps_solver_step", "solver is NULL");
  expect(mps_mpm_run(NULL, 1.0, 1, NULL, NULL), "mps_solver_run", "solver is NULL");
  expect(mps_fluid_step(NULL, 1), "mps_solver_step", "solver is NULL");
  expect(mps_dynamics_step(NULL, 1), "mps_solver_step", "solver is NULL");
  expect(mps_elastic_step(NULL, 1), "mps_solver_step", "solver is NULL");
  expect(mps_particles_fill_box(NULL, at, at, NULL), "mps_particles_fill_box", "particles is NULL");
  expect(mps_signal_create_ricker(NULL, 1.0, 1.0, 1.0, &signal), "mps_signal_create_ricker",
         "context is NULL");
  expect(mps_mpm_get_totals(NULL, &totals), "mps_solver_get_totals", "solver is NULL");
  expect(mps_fluid_get_totals(NULL, &totals), "mps_solver_get_totals", "solver is NULL");
  expect(mps_def_init(MPS_DEF_MPM, NULL, 8), "mps_def_init", "def is NULL");
}

TEST(a_context_that_cannot_be_made_says_why_without_a_buffer) {
  mps_context_def def = mps_context_defaults();
  mps_context *made = NULL;
  char text[256];
  expect(mps_context_create(&def, NULL, NULL, 0), "mps_context_create", "out is NULL");
  def.threads = -1;
  assert_int_equal(mps_context_create(&def, &made, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "mps_context_create: threads is -1, must be in 0 to 1024"));
  assert_string_equal(text + strlen("mps_context_create: "), mps_last_error()->message);
  assert_string_equal(mps_context_error(NULL)->message, mps_last_error()->message);
}

/* A thread that has failed nowhere has an empty record, and leaves that of others. */
static void *fail_elsewhere(void *found) {
  if (mps_last_error()->status == MPS_OK && mps_last_error()->message[0] == '\0' &&
      mps_last_error()->step == -1 && mps_mpm_step(NULL, 1) == MPS_ERROR_ARGUMENT &&
      strcmp(mps_last_error()->message, "solver is NULL") == 0)
    *(int *)found = 1;
  return NULL;
}

TEST(threads_have_records_of_their_own) {
  int found = 0;
  pthread_t thread;
  mps_kernel *kernel = NULL;
  REFUSES(mps_kernel_create(context, 77, 2.0, &kernel), "77");
  assert_string_equal(mps_last_error()->message, mps_context_error(context)->message);
  assert_string_equal(mps_last_error()->function, "mps_kernel_create");
  assert_int_equal(pthread_create(&thread, NULL, fail_elsewhere, &found), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
  assert_int_equal(found, 1);
  assert_non_null(strstr(mps_last_error()->message, "77"));
}

/* What a later header adds behind the struct is NaN and -1 for the library of now, in every result.
 */
TEST(members_that_the_library_lacks_are_no_numbers) {
  struct {
    mps_error record;
    double real;
    int64_t count;
  } error = {.real = 5.0, .count = 5};
  struct {
    mps_moduli moduli;
    double real;
    int64_t count;
  } moduli = {.real = 5.0, .count = 5};
  mps_kernel *kernel = NULL;
  REFUSES(mps_kernel_create(context, 77, 2.0, &kernel), "77");
  assert_int_equal(mps_context_get_error_sized(context, &error.record, sizeof error), MPS_OK);
  assert_string_equal(error.record.message, mps_context_error(context)->message);
  assert_true(isnan(error.real) && error.count == -1);
  OK(mps_moduli_from_elastic_sized(context, 1e6, 0.25, 1800.0, &moduli.moduli, sizeof moduli));
  assert_true(isnan(moduli.real) && moduli.count == -1);
  mps_error mine;
  assert_int_equal(mps_context_get_error(context, &mine), MPS_OK);
  assert_string_equal(mine.message, mps_context_error(context)->message);
  expect(mps_context_get_error(context, NULL), "mps_context_get_error", "out is NULL");
}
