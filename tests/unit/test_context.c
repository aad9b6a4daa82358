/* test_context.c - status table, definition structs, error record, executors, hooks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/context/retain.h"
#include "test_common.h"
#include "test_allocator.h"

#include "core/context/guard.h"
#include "core/context/levels.h"

TEST(status_texts_are_distinct) {
  assert_string_equal(mps_status_text(MPS_OK), "success");
  for (int a = 0; a <= MPS_ERROR_INTERNAL; a++)
    for (int b = 0; b < a; b++)
      assert_string_not_equal(mps_status_text((mps_status)a), mps_status_text((mps_status)b));
  assert_string_equal(mps_status_text((mps_status)99), "unknown status code");
}

TEST(a_larger_definition_of_a_newer_program_is_accepted_when_its_tail_is_zero) {
  struct {
    mps_context_def def;
    uint64_t newer_member;
  } newer;
  mps_context *context = NULL;
  char text[256];
  assert_int_equal(mps_def_init(MPS_DEF_CONTEXT, &newer.def, sizeof newer), MPS_OK);
  assert_int_equal(newer.def.struct_size, sizeof newer);
  assert_int_equal(newer.newer_member, 0);
  assert_int_equal(mps_context_create(&newer.def, &context, text, sizeof text), MPS_OK);
  mps_context_destroy(&context);
  newer.newer_member = 1;
  assert_int_equal(mps_context_create(&newer.def, &context, text, sizeof text),
                   MPS_ERROR_UNSUPPORTED);
  assert_null(context);
}

static mps_status refuse_node(void *user, const double *x, int32_t *inside) {
  return mps_context_set_error(user, MPS_ERROR_IO, "my_reader", "the tape has ended");
}

TEST_SERIAL(a_callback_says_why_it_has_failed) {
  DEF(particles, def, .spacing = 0.5);
  const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {1.0, 1.0, 1.0};
  MAKE(particles, set, create, context, &def);
  FAILS(mps_particles_fill_where(set, lo, hi, refuse_node, context, NULL), MPS_ERROR_IO,
        "my_reader: the tape has ended");
  REFUSES(mps_context_set_error(context, MPS_OK, "f", "nothing"), "status is MPS_OK");
  REFUSES(mps_context_set_error(context, MPS_ERROR_IO, NULL, NULL), "message is NULL");
  assert_int_equal(mps_context_set_error(NULL, MPS_ERROR_IO, "f", "x"), MPS_ERROR_IO);
  assert_string_equal(mps_last_error()->message, "x");
}

TEST(the_instruction_level_is_one_that_the_machine_has) {
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

TEST(errors_are_recorded_and_cleared) {
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_kernel *kernel = (mps_kernel *)&kernel;
  REFUSES(mps_kernel_create(context, MPS_KERNEL_MPS, -2.0, &kernel), "-2 m");
  assert_null(kernel);
  assert_string_equal(mps_context_error(context)->function, "mps_kernel_create");
  assert_int_equal(mps_context_error(context)->step, -1);
  REFUSES(mps_kernel_create(context, MPS_KERNEL_MPS, NAN, &kernel), "nan");
  mps_context_clear_error(context);
  assert_int_equal(mps_context_error(context)->status, MPS_OK);
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

TEST_SERIAL(an_error_names_its_object) {
  const mps_error *error = mps_context_error(context);
  (void)mpsi_fail(context, "mps_body_create_disc", MPS_ERROR_ARGUMENT, "x");
  assert_string_equal(error->object, "body");
  mpsi_fail_object(context, "body %d", 3);
  assert_string_equal(error->object, "body 3");
  (void)mpsi_fail(context, "mps_mpm_step", MPS_ERROR_ARGUMENT, "x");
  assert_string_equal(error->object, "mpm");
  mps_context_clear_error(context);
  assert_string_equal(error->object, "");
}

static void count_log(void *user, int32_t level, const char *message) { (*(int *)user)++; }
static void count_progress(void *user, const mps_context_progress *progress) { (*(int *)user)++; }
static int32_t say_stop(void *user) {
  (*(int *)user)++;
  return 1;
}

TEST_SERIAL(hooks_can_be_replaced) {
  int first = 0, second = 0;
  mps_context_set_log(context, count_log, &first, NULL);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "a");
  mps_context_set_log(context, count_log, &second, NULL);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "b");
  mps_context_set_log(context, NULL, NULL, NULL);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "c");
  assert_int_equal(first, 1);
  assert_int_equal(second, 1);
  mps_context_set_progress(context, count_progress, &first, NULL);
  mpsi_progress(context, "task", 1, 0.0, 1.0);
  assert_int_equal(first, 2);
  assert_false(mpsi_cancelled(context));
  mps_context_set_cancel(context, say_stop, &second, NULL);
  assert_true(mpsi_cancelled(context));
  assert_int_equal(second, 2);
  mps_context_set_log(NULL, NULL, NULL, NULL);
}

TEST_SERIAL(a_callback_is_guarded_and_its_status_explained) {
  const mps_error *error = mps_context_error(context);
  mpsi_guard guard = {0};
  assert_int_equal(mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_OK);
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  FAILS(mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_ERROR_STATE,
        "from the callback of mps_mpm_run");
  assert_int_equal(mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_OK), MPS_OK);
  assert_int_equal(mpsi_guard_check(&guard, context, "mps_mpm_step"), MPS_OK);

  /* A status of the callback's own: a former failure is not its reason. */
  (void)mpsi_fail(context, "mps_before", MPS_ERROR_IO, "the disk is full");
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  FAILS(mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_ERROR_IO), MPS_ERROR_IO,
        "the callback of mps_mpm_run returned status 5");
  assert_null(strstr(error->message, "disk"));
  assert_string_equal(error->function, "mps_mpm_run");
  /* One that it was given inside. */
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  (void)mpsi_fail(context, "mps_recorder_write", MPS_ERROR_IO, "the disk is full");
  FAILS(mpsi_guard_leave(&guard, context, "mps_mpm_run", MPS_ERROR_IO), MPS_ERROR_IO,
        "mps_recorder_write: the disk is full");
  /* No status at all. */
  mpsi_guard_enter(&guard, context, "the callback of mps_mpm_run");
  REFUSES(mpsi_guard_leave(&guard, context, "mps_mpm_run", (mps_status)-7), "status -7");
}

/* Executors that number their workers from 1, or leave the last unit out. */
static void count_from_one(void *user, int64_t count, mps_context_task_fn task, void *data) {
  for (int64_t k = 0; k < count; k++) task(data, k, 1 + (int32_t)(k % 2));
}
static void forget_one(void *user, int64_t count, mps_context_task_fn task, void *data) {
  for (int64_t k = 0; k + 1 < count; k++) task(data, k, 0);
}
static void go_wrong_later(void *user, int64_t count, mps_context_task_fn task, void *data) {
  const int32_t worker = (*(int *)user)++ > 0 ? 99 : 0; /* good at its trial */
  for (int64_t k = 0; k < count; k++) task(data, k, k == 1 ? worker : 0);
}
static void note_worker(void *data, int64_t index, int32_t worker) {
  if (worker < 0 || worker > 1) *(int *)data = 1;
}

TEST(a_bad_executor_is_noticed) {
  char text[256];
  scoped_context *context = NULL;
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_CALLER, .threads = 2,
      .parallel_for = count_from_one);
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_non_null(strstr(text, "parallel_for did not run each index"));
  def.parallel_for = forget_one;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_ERROR_ARGUMENT);
  assert_null(context);
  int calls = 0, seen = 0;
  def.parallel_for = go_wrong_later;
  def.parallel_user = &calls;
  assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
  FAILS(mps_context_parallel_for(context, 3, note_worker, &seen), MPS_ERROR_STATE,
        "gave a worker outside 0 to 1");
  assert_int_equal(seen, 0); /* the unit did not run */
}

/* Each text is kept once, up to a bound, without a log hook too; contexts have lists of their own.
 */
TEST_SERIAL(warnings_are_a_list) {
  scoped_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_context_warning w;
  assert_int_equal(mps_context_warning_count(context), 0);
  REFUSES(mps_context_get_warning(context, 0, &w), "index is 0, and the context has 0 warnings");
  for (int k = 0; k < 3; k++) mpsi_log(context, MPS_CONTEXT_LOG_WARNING, "dt is %g s", 0.5);
  mpsi_log(context, MPS_CONTEXT_LOG_INFO, "no warning");
  mpsi_log(context, MPS_CONTEXT_LOG_WARNING, "%600d", 7);
  assert_int_equal(mps_context_warning_count(context), 2);
  assert_int_equal(mps_context_warning_count(other), 0);
  OK(mps_context_get_warning(context, 0, &w));
  assert_int_equal(w.times, 3);
  assert_string_equal(w.text, "dt is 0.5 s");
  OK(mps_context_get_warning(context, 1, &w));
  assert_int_equal(strlen(w.text), sizeof w.text - 1);
  REFUSES(mps_context_get_warning(context, 2, &w), "has 2 warnings");
  REFUSES(mps_context_get_warning(context, -1, &w), "index is -1");
  for (int k = 0; k < 100; k++) mpsi_log(context, MPS_CONTEXT_LOG_WARNING, "number %d", k);
  assert_int_equal(mps_context_warning_count(context), 32);
  mps_context_clear_warnings(context);
  assert_int_equal(mps_context_warning_count(context), 0);
  mps_context_clear_warnings(NULL);
  assert_int_equal(mps_context_warning_count(NULL), 0);
}

TEST(enumerators_have_names) {
  assert_string_equal(mps_boundary_kind_name(MPS_BOUNDARY_FREE_FIELD), "MPS_BOUNDARY_FREE_FIELD");
  assert_null(mps_boundary_kind_name(8));
  assert_string_equal(mps_enumerator_name("mps_side", MPS_SIDE_ANY), "MPS_SIDE_ANY");
  assert_string_equal(mps_enumerator_name("mps_side", MPS_SIDE_Z_UPPER), "MPS_SIDE_Z_UPPER");
  /* values on the next line of a header, and of X macros */
  assert_string_equal(mps_enumerator_name("mps_contact_inside", MPS_CONTACT_INSIDE_REMOVE),
                      "MPS_CONTACT_INSIDE_REMOVE");
  assert_string_equal(mps_enumerator_name("mps_table_interpolation", 0),
                      "MPS_TABLE_INTERPOLATION_NEAREST");
  assert_string_equal(mps_enumerator_name("mps_feature", MPS_FEATURE_PETSC), "MPS_FEATURE_PETSC");
  assert_string_equal(mps_enumerator_name("mps_def_kind", MPS_DEF_CONTEXT), "MPS_DEF_CONTEXT");
  assert_string_equal(mps_enumerator_name("mps_status", MPS_ERROR_IO), "MPS_ERROR_IO");
  assert_null(mps_enumerator_name("mps_nothing", 0));
  assert_null(mps_enumerator_name(NULL, 0));
}

TEST(the_library_tells_what_it_is) {
  int major, minor, patch;
  assert_int_equal(sscanf(mps_version(), "%d.%d.%d", &major, &minor, &patch), 3);
  assert_int_equal(mps_version_number(), 10000 * major + 100 * minor + patch);
  assert_int_equal(mps_library_has(0), 0);
  assert_int_equal(mps_library_has(MPS_FEATURE_PETSC + 1), 0);
  assert_int_equal(mps_library_has(MPS_FEATURE_HDF5), TEST_HDF5);
  assert_int_equal(mps_library_has(MPS_FEATURE_CHOLMOD), TEST_CHOLMOD);
  assert_int_equal(mps_library_has(MPS_FEATURE_ARPACK), TEST_ARPACK);
  assert_int_equal(mps_library_has(MPS_FEATURE_EMBREE), TEST_EMBREE);
  assert_int_equal(mps_library_has(MPS_FEATURE_PETSC), 0);
  scoped_context *context = NULL;
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_OPENMP);
  assert_int_equal(mps_context_create(&def, &context, NULL, 0) == MPS_OK,
                   mps_library_has(MPS_FEATURE_OPENMP));
  assert_int_equal(mpsi_level(1), 1);
}

TEST(every_executor_runs_every_unit_once) {
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
    scoped_context *context = NULL;
    char text[256];
    assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
    int64_t values[1000] = {0};
    OK(mps_context_parallel_for(context, 1000, add_index, values));
    for (int i = 0; i < 1000; i++) assert_int_equal(values[i], i + 1);
    REFUSES(mps_context_parallel_for(context, -1, add_index, values), "count is -1");
  }
  assert_int_equal(calls, 2); /* once at its trial */
}

TEST(the_callers_allocator_is_used_and_everything_returned) {
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

TEST_SERIAL(lattice_density_is_the_sheet_value) {
  MAKE(kernel, kernel, create, context, MPS_KERNEL_MPS, 1.5 * 0.7);
  NEAR(mpsi_kernel_density(kernel, 0.7), 4 * 0.5 + 4 * (1.5 / sqrt(2.0) - 1.0), 1e-14); /* 2.2426 */
  NEAR(mps_kernel_weight(kernel, 0.7), 0.5, 1e-15);
  assert_true(mps_kernel_weight(kernel, 0.0) == 0.0);
  assert_true(mps_kernel_weight(kernel, 1.05) == 0.0);
}
