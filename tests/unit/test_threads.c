/* test_threads.c - what may be used from several threads: a context's executor, distinct contexts
 * at once, one kernel shared by all. Most of it is for the thread sanitizer to judge.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pthread_executor.h"
#include "test_common.h"

enum { UNITS = 500, THREADS = 4 };

typedef struct sharing {
  const mps_kernel *kernel;
  double weight[UNITS];
  int64_t by_worker[THREADS]; /* each worker counts its own: a race if two shared a number */
} sharing;

static void weigh(void *data, int64_t i, int32_t worker) {
  sharing *s = data;
  s->weight[i] = mps_kernel_weight(s->kernel, 1.5 * (double)(i + 1) / (UNITS + 1));
  s->by_worker[worker]++;
}

TEST(workers_share_a_kernel_and_have_numbers_of_their_own) {
  scoped_context *serial = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  MAKE(kernel, kernel, create, serial, MPS_KERNEL_MPS, 1.5);
  for (int32_t threads = 1; threads <= THREADS; threads++) {
    const mps_context_def def = pthread_executor_def(&threads);
    scoped_context *context = NULL;
    char text[256];
    assert_int_equal(mps_context_create(&def, &context, text, sizeof text), MPS_OK);
    assert_int_equal(mps_context_threads(context), threads);
    sharing s = {.kernel = kernel};
    OK(mps_context_parallel_for(context, UNITS, weigh, &s));
    int64_t units = 0;
    for (int t = 0; t < THREADS; t++) units += s.by_worker[t];
    assert_int_equal(units, UNITS);
    for (int i = 0; i < UNITS; i++)
      NEAR(s.weight[i], (double)(UNITS + 1) / (i + 1) - 1.0, 1e-12 * UNITS);
  }
}

/* Makes objects, provokes an error, and reads it back; never asserts: not the test's own thread. */
static void *use_a_context_of_its_own(void *argument) {
  bool *ok = argument;
  for (int round = 0; round < 50; round++) {
    DEF(context, def, .executor = MPS_CONTEXT_EXECUTOR_SERIAL);
    mps_context *context = NULL;
    mps_kernel *kernel = NULL;
    if (mps_context_create(&def, &context, NULL, 0) != MPS_OK) return NULL;
    const bool made = mps_kernel_create(context, MPS_KERNEL_MPS, 1.5, &kernel) == MPS_OK;
    const bool counted = made && mps_kernel_weight(kernel, 1.0) == 0.5;
    const bool clean = mps_context_error(context)->status == MPS_OK;
    mps_kernel *none = NULL;
    const bool refused = mps_kernel_create(context, 7, 1.5, &none) == MPS_ERROR_ARGUMENT &&
                         mps_context_error(context)->status == MPS_ERROR_ARGUMENT;
    mps_kernel_destroy(&kernel);
    mps_context_destroy(&context);
    if (!counted || !clean || !refused) return NULL;
  }
  *ok = true;
  return NULL;
}

TEST(distinct_contexts_are_independent) {
  pthread_t ids[THREADS];
  bool ok[THREADS] = {false};
  for (int t = 0; t < THREADS; t++)
    assert_int_equal(pthread_create(&ids[t], NULL, use_a_context_of_its_own, &ok[t]), 0);
  for (int t = 0; t < THREADS; t++) assert_int_equal(pthread_join(ids[t], NULL), 0);
  for (int t = 0; t < THREADS; t++) assert_true(ok[t]);
}
