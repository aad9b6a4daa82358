/* test_allocator.h - a context whose allocator counts what lives and can refuse one call, and a
 * sweep that refuses each call in turn.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_ALLOCATOR_H
#define MPS_TEST_ALLOCATOR_H

#include "test_common.h"

typedef struct test_allocator {
  int64_t live;      /* allocations not yet released */
  int64_t calls;     /* allocations requested */
  int64_t refuse_at; /* the call that gets NULL, from 1; 0 none */
} test_allocator;

static inline void *test_allocator_get(void *user, size_t size, size_t alignment) {
  test_allocator *allocator = user;
  if (++allocator->calls == allocator->refuse_at) return NULL;
  allocator->live++;
  return aligned_alloc(alignment, size);
}

static inline void test_allocator_return(void *user, void *memory) {
  ((test_allocator *)user)->live--;
  free(memory);
}

/* Makes the contexts of `def` use `allocator`, which must outlive them. */
static inline void test_allocator_use(mps_context_def *def, test_allocator *allocator) {
  def->alloc = test_allocator_get;
  def->free = test_allocator_return;
  def->memory_user = allocator;
}

/* A serial context on `allocator`, which must outlive it; NULL when its own memory is refused. */
static inline mps_context *test_allocator_context(test_allocator *allocator) {
  mps_context_def def = test_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  test_allocator_use(&def, allocator);
  mps_context *own = NULL;
  const mps_status status = mps_context_create(&def, &own, NULL, 0);
  return status == MPS_OK ? own : NULL;
}

/* Makes an object, and destroys it; `what` says which. */
typedef mps_status (*test_make_fn)(mps_context *own, int what);

/* Refuses one allocation after the other until `make` succeeds. Each time it must report
 * MPS_ERROR_MEMORY and leave nothing behind. The first allocation is the context's. */
static inline void test_allocator_sweep(test_make_fn make, int what) {
  mps_status status = MPS_ERROR_MEMORY;
  for (int64_t refuse = 2; status != MPS_OK; refuse += test_refusals_apart()) {
    test_allocator allocator = {.refuse_at = refuse};
    mps_context *own = test_allocator_context(&allocator);
    assert_non_null(own);
    status = make(own, what);
    if (status != MPS_OK) {
      assert_int_equal(status, MPS_ERROR_MEMORY);
      assert_int_equal(mps_context_error(own)->status, MPS_ERROR_MEMORY);
      assert_int_equal(allocator.calls, refuse); /* it does not continue after a failure */
    }
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
    assert_true(refuse < 1000);
  }
}

#endif
