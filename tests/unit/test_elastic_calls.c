/* test_elastic_calls.c - implicit elasticity among its surroundings: contexts, hooks that call
 * back, cancelling, threads of BLAS. SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

#include <pthread.h>

/* ---- threads of BLAS: these stand in for OpenBLAS's own -------------------------------------- */

static int blas_threads = 7, blas_least = 7;

int openblas_get_num_threads(void);
void openblas_set_num_threads(int threads);
int openblas_get_num_threads(void) { return blas_threads; }
void openblas_set_num_threads(int threads) {
  blas_threads = threads;
  blas_least = threads < blas_least ? threads : blas_least;
}

/* ---- a body ---------------------------------------------------------------------------------- */

static test_body square(mps_context *context, int cells) {
  test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 0.5 * cells, 0.5 * cells, 0);
  test_body_finish(&b, 2.0, 0.3, NULL);
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  int64_t count, *ids = test_select(&b, 1, -1, 0.3, &count);
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, count, ids, NULL));
  free(ids);
  const double gravity[2] = {0.2, -1.0};
  OK(test_body_force(b.elastic, gravity));
  return b;
}

/* What the cancel hook does: counts, cancels from call `at` on, or computes modes. */
typedef struct hook {
  int calls, at;
  mps_elastic *modes;
  mps_status status;
} hook;

static int32_t cancel(void *user) {
  hook *h = user;
  double omega;
  if (h->modes) {
    mps_elastic *e = h->modes;
    h->modes = NULL;
    h->status = mps_elastic_modes(e, 1, &omega, NULL);
  }
  return ++h->calls >= h->at;
}

static mps_context *hooked(hook *h) {
  DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL, .cancel = cancel, .cancel_user = h);
  mps_context *context = NULL;
  assert_int_equal(mps_context_create(&def, &context, NULL, 0), MPS_OK);
  return context;
}

/* ---- tests ----------------------------------------------------------------------------------- */

TEST(a_set_of_another_context_is_refused) {
  scoped_context *one = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1), *other = test_context(0, 1);
  scoped_test_body b = square(one, 3);
  mps_elastic *e = NULL;
  FAILS_ON(other, mps_elastic_create(other, b.particles, NULL, &e), MPS_ERROR_ARGUMENT,
           "another context");
  assert_null(e);
  assert_ptr_equal(mps_elastic_context(b.elastic), one);
  assert_null(mps_elastic_context(NULL));
}

TEST_SERIAL(blas_has_the_threads_of_the_context_while_it_works) {
  scoped_test_body b = square(context, 12);
  blas_threads = blas_least = 7;
  OK(mps_elastic_solve(b.elastic));
  assert_int_equal(blas_least, 1);
  assert_int_equal(blas_threads, 7); /* as the process had it */
}

/* Wherever the hook says stop, the call ends and the fields are as before. */
TEST(a_cancelled_solution_changes_nothing) {
  hook h = {.at = INT32_MAX};
  scoped_context *context = hooked(&h);
  scoped_test_body b = square(context, 12);
  for (h.at = 1; h.at <= 3; h.at++) {
    h.calls = 0;
    FAILS(mps_elastic_solve(b.elastic), MPS_ERROR_CANCELLED, "cancelled");
    for (int64_t i = 0; i < b.n; i++) assert_true(test_value(&b, "displacement", i, 1) == 0.0);
  }
  h.at = INT32_MAX;
  OK(mps_elastic_solve(b.elastic));
  assert_true(test_value(&b, "displacement", b.n - 1, 1) < 0.0);
}

/* It deadlocked: the hook computes modes while modes are computed. */
TEST(modes_within_modes_are_an_error) {
  hook h = {.at = INT32_MAX};
  scoped_context *context = hooked(&h);
  scoped_test_body b = square(context, 6), other = square(context, 5);
  double omega[2];
  OK(mps_elastic_modes(b.elastic, 1, omega, NULL));
  OK(mps_elastic_modes(other.elastic, 1, omega, NULL)); /* both factors made */
  h.modes = other.elastic;
  OK(mps_elastic_modes(b.elastic, 2, omega, NULL));
  assert_int_equal(h.status, MPS_ERROR_STATE);
  assert_true(omega[0] > 0.0 && omega[1] > omega[0]);
}

static void *find_modes(void *data) {
  test_body *b = data;
  double omega[3];
  for (int k = 0; k < 5; k++)
    if (mps_elastic_modes(b->elastic, 3, omega, NULL) != MPS_OK) return data;
  return NULL;
}

TEST(modes_of_two_threads_wait_for_one_another) {
  mps_context *context[2];
  test_body b[2];
  pthread_t thread[2];
  for (int k = 0; k < 2; k++) {
    context[k] = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    b[k] = square(context[k], 8);
  }
  for (int k = 0; k < 2; k++)
    assert_int_equal(pthread_create(&thread[k], NULL, find_modes, &b[k]), 0);
  for (int k = 0; k < 2; k++) {
    void *failed = NULL;
    assert_int_equal(pthread_join(thread[k], &failed), 0);
    assert_null(failed);
  }
  assert_int_equal(blas_threads, 7);
  for (int k = 0; k < 2; k++) {
    test_body_end(&b[k]);
    mps_context_destroy(&context[k]);
  }
}
