/* memory.c - memory through the hooks of the context.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include <stdlib.h>
#include <string.h>

static void *system_alloc(void *user, size_t size, size_t alignment) {
  return aligned_alloc(alignment, size); /* size is a multiple of alignment: see mpsi_alloc */
}

static void system_free(void *user, void *memory) { free(memory); }

void mpsi_use_system_memory(mps_context_def *def) {
  def->alloc = system_alloc;
  def->free = system_free;
}

void *mpsi_alloc(mps_context *context, int64_t count, size_t size) {
  size_t bytes;
  if (count < 0 || __builtin_mul_overflow((size_t)count, size, &bytes) ||
      bytes > (size_t)PTRDIFF_MAX - MPSI_ALIGNMENT)
    return NULL;
  bytes = (bytes + MPSI_ALIGNMENT - 1) / MPSI_ALIGNMENT * MPSI_ALIGNMENT;
  if (bytes == 0) bytes = MPSI_ALIGNMENT;
  void *memory = context->def.alloc(context->def.memory_user, bytes, MPSI_ALIGNMENT);
  if (memory) memset(memory, 0, bytes);
  return memory;
}

void mpsi_free(mps_context *context, void *memory) {
  if (memory) context->def.free(context->def.memory_user, memory);
}

void mpsi_free_all(mps_context *context, void *const *memory, size_t count) {
  for (size_t k = 0; k < count; k++) mpsi_free(context, memory[k]);
}

bool mpsi_grow(mps_context *context, void **array, int64_t old_count, int64_t new_count,
               size_t size) {
  void *grown = mpsi_alloc(context, new_count, size);
  if (!grown) return false;
  if (old_count > 0) memcpy(grown, *array, (size_t)old_count * size);
  mpsi_free(context, *array);
  *array = grown;
  return true;
}
