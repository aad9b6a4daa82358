/* test_context.c - status table, definition structs, error record, executors, hooks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"
#include "test_allocator.h"

#include "core/context/guard.h"
#include "core/context/levels.h"

#include <mps/kernel.h>
#include <mps/particles.h>

static void status_texts_are_distinct(void **state) {
  (void)state;
  assert_string_equal(mps_status_text(MPS_OK), "success");
  for (int a = 0; a <= MPS_ERROR_INTERNAL; a++)
    for (int b = 0; b < a; b++)
      assert_string_not_equal(mps_status_text((mps_status)a), mps_status_text((mps_status)b));
  assert_string_equal(mps_status_text((mps_status)99), "unknown status code");
}

static void a_larger_definition_of_a_newer_program_is_accepted_when_its_tail_is_zero(void **state) {
  (void)state;
  struct {
    mps_context_def def;
    uint64_t newer_member;
  } newer;
  mps_context *context = NULL;
  char text[256];
  assert_int_equal(mps_context_def_init(&newer.def, sizeof newer), MPS_OK);
  assert_int_equal(newer.def.struct_size, sizeof newer);
  assert_int_equal(newer.newer_member, 0);
  assert_int_equal(mps_context_create(&newer.def, &context, text, sizeof text), MPS_OK);
  mps_context_destroy(&context);
  newer.newer_member = 1;
  assert_int_equal(mps_context_create(&newer.def, &context, text, sizeof text),
                   MPS_ERROR_UNSUPPORTED);
  assert_null(context);
}

static void bad_definitions_are_refused_with_the_reason(void **state) {
  (void)state;
  mps_context *context = NULL;
  char text[256];
  mps_context_def def = mps_context_defaults();
  def.threads = -3;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "threads is -3"));
  def = mps_context_defaults();
  def.executor = 7;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "executor is 7"));
  def = mps_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_CALLER;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  def = mps_context_defaults();
  def.struct_size = 0;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_context_create(NULL, NULL, NULL, 0), MPS_ERROR_ARGUMENT);
}

static mps_status refuse_node(void *user, const double *x, int32_t *inside) {
  (void)x, (void)inside;
  return mps_context_set_error(user, MPS_ERROR_IO, "my_reader", "the tape has ended");
}

static void a_callback_says_why_it_has_failed(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_particles_def def = mps_particles_defaults();
  mps_particles *set = NULL;
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.0, 1.0, 1.0};
  def.spacing = 0.5;
  mps_assert_ok(context, mps_particles_create(context, &def, &set));
  mps_assert_fails(context, mps_particles_fill_where(set, lo, hi, refuse_node, context, NULL),
                   MPS_ERROR_IO, "my_reader: the tape has ended");
  mps_assert_fails(context, mps_context_set_error(context, MPS_OK, "f", "nothing"),
                   MPS_ERROR_ARGUMENT, "status is 0");
  mps_assert_fails(context, mps_context_set_error(context, MPS_ERROR_IO, NULL, NULL),
                   MPS_ERROR_ARGUMENT, "message NULL");
  assert_int_equal(mps_context_set_error(NULL, MPS_ERROR_IO, "f", "x"), MPS_ERROR_ARGUMENT);
  mps_particles_destroy(&set);
  mps_context_destroy(&context);
}

static void the_instruction_level_is_one_that_the_machine_has(void **state) {
  (void)state;
  char text[256];
  mps_context_def def = mps_context_defaults();
  assert_int_equal(def.instruction_level, 0);
  mps_context *context = NULL;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
  const int32_t best = mpsi_context_level(context);
  mps_context_destroy(&context);
  static const int32_t levels[] = {MPSI_ALL_LEVELS(MPSI_LEVEL_VALUE, , )};
  bool found = false;
  for (size_t k = 0; k < sizeof levels / sizeof *levels; k++) {
    found = found || levels[k] == best;
    def.instruction_level = levels[k];
    const mps_status expected = levels[k] <= best ? MPS_OK : MPS_ERROR_UNSUPPORTED;
    assert_int_equal(mps_context_create(&def, &context, text, sizeof text), expected);
    if (context) assert_int_equal(mpsi_context_level(context), levels[k]);
    mps_context_destroy(&context);
  }
  assert_true(found);
  def.instruction_level = 99;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "instruction_level is 99, allowed are 0"));
}

static void errors_are_recorded_and_cleared(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_kernel *kernel = (mps_kernel *)&kernel;
  mps_assert_fails(context, mps_kernel_create(context, MPS_KERNEL_MPS, -2.0, &kernel),
                   MPS_ERROR_ARGUMENT, "-2 m");
  assert_null(kernel);
  assert_string_equal(mps_context_error(context)->function, "mps_kernel_create");
  assert_int_equal(mps_context_error(context)->step, -1);
  mps_assert_fails(context, mps_kernel_create(context, MPS_KERNEL_MPS, NAN, &kernel),
                   MPS_ERROR_ARGUMENT, "nan");
  mps_context_clear_error(context);
  assert_int_equal(mps_context_error(context)->status, MPS_OK);
  mps_context_destroy(&context);
  mps_context_destroy(&context);
}

static void add_index(void *data, int64_t index, int32_t worker) {
  if (worker < 0) abort();
  ((int64_t *)data)[index] += index + 1;
}

/* A caller's executor that runs backwards, on the calling thread. */
static void backwards(void *user, int64_t count, mps_context_task_fn task, void *data) {
  ++*(int *)user;
  for (int64_t i = count - 1; i >= 0; i--) task(data, i, 0);
}

static void an_error_names_its_object(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_error *error = mps_context_error(context);
  (void)mpsi_fail(context, "mps_body_create_disc", MPS_ERROR_ARGUMENT, "x");
  assert_string_equal(error->object, "body");
  mpsi_fail_object(context, "body %d", 3);
  assert_string_equal(error->object, "body 3");
  (void)mpsi_fail(context, "mps_mpm_step", MPS_ERROR_ARGUMENT, "x");
  assert_string_equal(error->object, "mpm");
  mps_context_clear_error(context);
  assert_string_equal(error->object, "");
  mps_context_destroy(&context);
}

static void count_log(void *user, int32_t level, const char *message) {
  (void)level;
  (void)message;
  (*(int *)user)++;
}
static void count_progress(void *user, const mps_context_progress *progress) {
  (void)progress;
  (*(int *)user)++;
}
static int32_t say_stop(void *user) {
  (*(int *)user)++;
  return 1;
}

static void hooks_can_be_replaced(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  int first = 0, second = 0;
  mps_context_set_log(context, count_log, &first);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "a");
  mps_context_set_log(context, count_log, &second);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "b");
  mps_context_set_log(context, NULL, NULL);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "c");
  assert_int_equal(first, 1);
  assert_int_equal(second, 1);
  mps_context_set_progress(context, count_progress, &first);
  mpsi_progress(context, "task", 1, 0.0, 1.0);
  assert_int_equal(first, 2);
  assert_false(mpsi_cancelled(context));
  mps_context_set_cancel(context, say_stop, &second);
  assert_true(mpsi_cancelled(context));
  assert_int_equal(second, 2);
  mps_context_set_log(NULL, NULL, NULL);
  mps_context_destroy(&context);
}

static void a_callback_is_guarded_and_its_status_explained(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_error *error = mps_context_error(context);
  mpsi_guard guard = {0};
  assert_int_equal(mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_OK);
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  mps_assert_fails(context, mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_ERROR_STATE,
                   "from the callback of mps_mpm_run");
  assert_int_equal(mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_OK), MPS_OK);
  assert_int_equal(mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_OK);

  /* A status of the callback's own: a former failure is not its reason. */
  (void)mpsi_fail(context, "mps_before", MPS_ERROR_IO, "the disk is full");
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  mps_assert_fails(context, mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_ERROR_IO),
                   MPS_ERROR_IO, "the callback of mps_mpm_run returned status 5");
  assert_null(strstr(error->message, "disk"));
  assert_string_equal(error->function, "mps_mpm_run");
  /* One that it was given inside. */
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  (void)mpsi_fail(context, "mps_recorder_write", MPS_ERROR_IO, "the disk is full");
  mps_assert_fails(context, mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_ERROR_IO),
                   MPS_ERROR_IO, "mps_recorder_write: the disk is full");
  /* No status at all. */
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  mps_assert_fails(context, mpsi_guard_leave(&guard, context, "mps_mpm_run", (mps_status)-7),
                   MPS_ERROR_ARGUMENT, "status -7");
  mps_context_destroy(&context);
}

/* Executors that number their workers from 1, or leave the last unit out. */
static void count_from_one(void *user, int64_t count, mps_context_task_fn task, void *data) {
  (void)user;
  for (int64_t k = 0; k < count; k++) task(data, k, 1 + (int32_t)(k % 2));
}
static void forget_one(void *user, int64_t count, mps_context_task_fn task, void *data) {
  (void)user;
  for (int64_t k = 0; k + 1 < count; k++) task(data, k, 0);
}
static void go_wrong_later(void *user, int64_t count, mps_context_task_fn task, void *data) {
  const int32_t worker = (*(int *)user)++ > 0 ? 99 : 0; /* good at its trial */
  for (int64_t k = 0; k < count; k++) task(data, k, k == 1 ? worker : 0);
}
static void note_worker(void *data, int64_t index, int32_t worker) {
  (void)index;
  if (worker < 0 || worker > 1) *(int *)data = 1;
}

static void a_bad_executor_is_noticed(void **state) {
  (void)state;
  char text[256];
  mps_context *context = NULL;
  mps_context_def def = mps_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_CALLER;
  def.threads = 2;
  def.parallel_for = count_from_one;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "parallel_for did not run each index"));
  def.parallel_for = forget_one;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_null(context);
  int calls = 0, seen = 0;
  def.parallel_for = go_wrong_later;
  def.parallel_user = &calls;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
  mps_assert_fails(context, mps_context_parallel_for(context, 3, note_worker, &seen),
                   MPS_ERROR_STATE, "gave a worker outside 0 to 1");
  assert_int_equal(seen, 0); /* the unit did not run */
  mps_context_destroy(&context);
}

static void the_library_tells_what_it_is(void **state) {
  (void)state;
  int major, minor, patch;
  assert_int_equal(sscanf(mps_version(), "%d.%d.%d", &major, &minor, &patch), 3);
  assert_int_equal(mps_version_number(), 10000 * major + 100 * minor + patch);
  int32_t count = 1;
  while (mps_library_feature_name(count)) {
    const int32_t has = mps_library_has(count);
    assert_true(has == 0 || has == 1);
    count++;
  }
  assert_int_equal(count, MPS_FEATURE_PETSC + 1);
  assert_int_equal(mps_library_has(0), 0);
  assert_int_equal(mps_library_has(count), 0);
  assert_int_equal(mps_library_has(MPS_FEATURE_HDF5), TEST_HDF5);
  assert_int_equal(mps_library_has(MPS_FEATURE_CHOLMOD), TEST_CHOLMOD);
  assert_int_equal(mps_library_has(MPS_FEATURE_ARPACK), TEST_ARPACK);
  assert_int_equal(mps_library_has(MPS_FEATURE_EMBREE), TEST_EMBREE);
  assert_int_equal(mps_library_has(MPS_FEATURE_PETSC), 0);
  assert_null(mps_library_feature_name(0));
  mps_context *context = NULL;
  mps_context_def def = mps_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_OPENMP;
  assert_int_equal(mps_context_create(&def, &context, NULL, 0) == MPS_OK,
                   mps_library_has(MPS_FEATURE_OPENMP));
  mps_context_destroy(&context);
  assert_int_equal(mps_library_has_level(1), 1);
  assert_int_equal(mps_library_has_level(0), 0);
  assert_int_equal(mps_library_has_level(2), 0);
  context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const int32_t used = mps_context_instruction_level(context);
  assert_int_equal(mps_library_has_level(used), 1);
  for (int32_t level = used + 1; level < 6; level++)
    assert_int_equal(mps_library_has_level(level), 0);
  mps_context_destroy(&context);
}

static void every_executor_runs_every_unit_once(void **state) {
  (void)state;
  int calls = 0;
  for (int kind = 0; kind < 3; kind++) {
    mps_context_def def = mps_context_defaults();
    if (kind == 1) def.threads = 3; /* the build's default executor */
    if (kind == 0) def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
    if (kind == 2) {
      def.executor = MPS_CONTEXT_EXECUTOR_CALLER;
      def.threads = 2;
      def.parallel_for = backwards;
      def.parallel_user = &calls;
    }
    mps_context *context = NULL;
    char text[256];
    assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
    int64_t values[1000] = {0};
    mps_assert_ok(context, mps_context_parallel_for(context, 1000, add_index, values));
    for (int i = 0; i < 1000; i++) assert_int_equal(values[i], i + 1);
    mps_assert_fails(context, mps_context_parallel_for(context, -1, add_index, values),
                     MPS_ERROR_ARGUMENT, "count is -1");
    mps_context_destroy(&context);
  }
  assert_int_equal(calls, 2); /* once at its trial */
}

static void the_callers_allocator_is_used_and_everything_returned(void **state) {
  (void)state;
  for (int64_t refuse = 0; refuse < 3; refuse++) {
    test_allocator counts = {.refuse_at = refuse};
    mps_context_def def = mps_context_defaults();
    test_allocator_use(&def, &counts);
    mps_context *context = NULL;
    mps_kernel *kernel = NULL;
    char text[256];
    const mps_status made = mps_context_create(&def, &context, text, sizeof text);
    assert_int_equal(made, refuse == 1 ? MPS_ERROR_MEMORY : MPS_OK);
    if (made == MPS_OK)
      assert_int_equal(mps_kernel_create(context, MPS_KERNEL_MPS, 1.5, &kernel),
                       refuse == 2 ? MPS_ERROR_MEMORY : MPS_OK);
    mps_context_destroy(&context); /* the kernel keeps the memory hooks alive */
    mps_kernel_destroy(&kernel);
    assert_int_equal(counts.live, 0);
  }
}

static void lattice_density_is_the_sheet_value(void **state) {
  (void)state;
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_kernel *kernel = NULL;
  double n0 = 0.0;
  mps_assert_ok(context, mps_kernel_create(context, MPS_KERNEL_MPS, 1.5 * 0.7, &kernel));
  mps_assert_ok(context, mps_kernel_density(context, kernel, 2, 0.7, &n0));
  mps_assert_near(n0, 4 * 0.5 + 4 * (1.5 / sqrt(2.0) - 1.0), 1e-14); /* 2.2426 */
  mps_assert_ok(context, mps_kernel_density(context, kernel, 3, 0.7, &n0));
  mps_assert_near(n0, 6 * 0.5 + 12 * (1.5 / sqrt(2.0) - 1.0), 1e-14);
  mps_assert_near(mps_kernel_weight(kernel, 0.7), 0.5, 1e-15);
  assert_true(mps_kernel_weight(kernel, 0.0) == 0.0);
  assert_true(mps_kernel_weight(kernel, 1.05) == 0.0);
  mps_assert_fails(context, mps_kernel_density(context, kernel, 4, 0.7, &n0), MPS_ERROR_ARGUMENT,
                   "dim is 4");
  mps_kernel_destroy(&kernel);
  mps_context_destroy(&context);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(status_texts_are_distinct),
      cmocka_unit_test(a_larger_definition_of_a_newer_program_is_accepted_when_its_tail_is_zero),
      cmocka_unit_test(bad_definitions_are_refused_with_the_reason),
      cmocka_unit_test(a_callback_says_why_it_has_failed),
      cmocka_unit_test(the_instruction_level_is_one_that_the_machine_has),
      cmocka_unit_test(errors_are_recorded_and_cleared),
      cmocka_unit_test(an_error_names_its_object),
      cmocka_unit_test(hooks_can_be_replaced),
      cmocka_unit_test(a_callback_is_guarded_and_its_status_explained),
      cmocka_unit_test(a_bad_executor_is_noticed),
      cmocka_unit_test(the_library_tells_what_it_is),
      cmocka_unit_test(every_executor_runs_every_unit_once),
      cmocka_unit_test(the_callers_allocator_is_used_and_everything_returned),
      cmocka_unit_test(lattice_density_is_the_sheet_value),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
