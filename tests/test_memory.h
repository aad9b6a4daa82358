/* test_memory.h - an allocator that counts, and can refuse one call: what a sweep over allocation
 * failures needs.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MEMORY_H
#define MPS_TEST_MEMORY_H

#include <mps/context.h>

#include <stdlib.h>

typedef struct test_memory {
  int64_t live;      /* blocks not yet returned */
  int64_t calls;     /* allocations asked for */
  int64_t refuse_at; /* the number, from 1, of the call to refuse; 0: none */
} test_memory;

static inline void *test_memory_alloc(void *user, size_t size, size_t alignment) {
  test_memory *memory = user;
  if (++memory->calls == memory->refuse_at) return NULL;
  memory->live++;
  return aligned_alloc(alignment, size);
}

static inline void test_memory_free(void *user, void *block) {
  ((test_memory *)user)->live--;
  free(block);
}

/* Makes the contexts of `def` use `memory`, which must outlive them. */
static inline void test_memory_use(mps_context_def *def, test_memory *memory) {
  def->alloc = test_memory_alloc;
  def->free = test_memory_free;
  def->memory_user = memory;
}

#endif
