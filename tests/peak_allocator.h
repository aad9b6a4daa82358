/* peak_allocator.h - memory hooks that count the bytes in use and the most there ever were. One
 * thread at a time. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_PEAK_ALLOCATOR_H
#define MPS_TEST_PEAK_ALLOCATOR_H

#include <mps/context.h>

#include <stdlib.h>
#include <string.h>

typedef struct peak_allocator {
  int64_t now, most; /* bytes */
} peak_allocator;

#define PEAK_HEAD 64 /* bytes before each block, with its size: blocks stay aligned to 64 */

static inline void *peak_get(void *user, size_t size, size_t alignment) {
  peak_allocator *a = user;
  if (alignment > PEAK_HEAD) return NULL;
  char *memory = aligned_alloc(PEAK_HEAD, (size + 2 * PEAK_HEAD - 1) / PEAK_HEAD * PEAK_HEAD);
  if (!memory) return NULL;
  memcpy(memory, &size, sizeof size);
  a->now += (int64_t)size;
  if (a->now > a->most) a->most = a->now;
  return memory + PEAK_HEAD;
}

static inline void peak_return(void *user, void *memory) {
  peak_allocator *a = user;
  size_t size;
  if (!memory) return;
  memcpy(&size, (char *)memory - PEAK_HEAD, sizeof size);
  a->now -= (int64_t)size;
  free((char *)memory - PEAK_HEAD);
}

static inline void peak_use(mps_context_def *def, peak_allocator *a) {
  def->alloc = peak_get;
  def->free = peak_return;
  def->memory_user = a;
}

#endif
