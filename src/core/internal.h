/* internal.h - the core's interface for all source files of the library: errors, memory, definition
 * structs, reference counts, parallel loops. Internal names begin with mpsi_.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_INTERNAL_H
#define MPSI_INTERNAL_H

#ifndef MPSI_LEVEL /* inner loops read no definitions: a new one does not compile them again */
#include "core/context/released_sizes.h"
#endif

#include <mps/context.h>

#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define MPSI_ALIGNMENT 64 /* bytes: a cache line, a 512-bit vector */

#if defined(__GNUC__) || defined(__clang__)
#define MPSI_PRINTF(fmt, args) __attribute__((format(printf, fmt, args)))
#define MPSI_INLINE static inline __attribute__((always_inline))
#else
#define MPSI_PRINTF(fmt, args)
#define MPSI_INLINE static inline
#endif

/* ---- errors -------------------------------------------------------------------------------- */

/* Records an error on the context (NULL allowed: nothing is recorded) and returns `status`, so
 * that `return mpsi_fail(ctx, "mps_x_create", MPS_ERROR_ARGUMENT, "...", ...)` reads as one. The
 * message names the offending value and what is allowed. */
mps_status mpsi_fail(mps_context *context, const char *function, mps_status status,
                     const char *format, ...) MPSI_PRINTF(4, 5);
/* Adds the step and the particle id to the record just written. */
void mpsi_fail_where(mps_context *context, int64_t step, int64_t particle);
/* Names the object concerned in the record just written: "body 2", "field 'density'". Without it
 * the object is the kind that the function's name begins with. */
void mpsi_fail_object(mps_context *context, const char *format, ...) MPSI_PRINTF(2, 3);
mps_status mpsi_fail_memory(mps_context *context, const char *function, size_t bytes);
/* `status` is that of a public function called by the library itself: on an error the record is
 * renamed to `function`, which the caller has called. Returns `status`. */
mps_status mpsi_as(mps_context *context, const char *function, mps_status status);
/* `status` is that of a check, shared by several functions, of the caller's `argument`
 * ("particles", "lo, hi"): an MPS_ERROR_ARGUMENT gets that name before its message. Returns
 * `status`. */
mps_status mpsi_fail_of(mps_context *context, mps_status status, const char *argument);
int64_t mpsi_failures(const mps_context *context); /* number of records so far */
void mpsi_log(mps_context *context, int32_t level, const char *format, ...) MPSI_PRINTF(3, 4);

#define MPSI_FARTHEST 1e15 /* coordinates, either sign */

/* Length of the identifier [A-Za-z_][A-Za-z0-9_]* that `name` begins with; 0: none, or one of
 * `room` characters or more. The rest is not checked. */
size_t mpsi_identifier(const char *name, size_t room);

/* ---- memory: zero filled, aligned to MPSI_ALIGNMENT ----------------------------------------- */

/* NULL when count * size overflows or memory is refused; a count of 0 gives one cache line, never
 * NULL. */
void *mpsi_alloc(mps_context *context, int64_t count, size_t size);
void mpsi_free(mps_context *context, void *memory); /* accepts NULL */
/* Grows *array from `old_count` to `new_count` items, keeping and zero filling; false and
 * unchanged when out of memory. */
bool mpsi_grow(mps_context *context, void **array, int64_t old_count, int64_t new_count,
               size_t size);

/* ---- life of contexts: objects keep their context alive ------------------------------------- */

mps_context *mpsi_context_retain(mps_context *context);
void mpsi_context_release(mps_context *context);

/* ---- hooks ---------------------------------------------------------------------------------- */

void mpsi_progress(mps_context *context, const char *task, int64_t step, double time,
                   double time_end);
bool mpsi_cancelled(mps_context *context);

/* ---- growing structs -------------------------------------------------------------------------
 * Definitions (in): the released size of each is in released_sizes.h, written by
 * scripts/update-sizes. */

/* Largest size (bytes) of a definition or a result. A larger one is an error before any byte of the
 * tail is read or written. */
#define MPSI_STRUCT_MOST 4096

/* Reads the caller's definition `def` (any size from the released one on) over *known, a `type`
 * that holds the defaults. A tail that this library does not know must be zero. */
#define MPSI_DEF_READ(context, function, type, def, known)                                         \
  mpsi_def_read(context, function, def, MPSI_RELEASED(type), 1 ? (known) : (type *)0, sizeof(type))
/* The body of every mps_x_def_init: copies *defaults to `def`, up to `size` bytes, zero fills the
 * rest and writes struct_size = size. */
#define MPSI_DEF_INIT(type, def, size, defaults)                                                   \
  mpsi_def_init(def, size, MPSI_RELEASED(type), 1 ? (defaults) : (const type *)0, sizeof(type))
/* Where pointers are shorter than in the table, so are the structs. */
#define MPSI_RELEASED(type)                                                                        \
  ((size_t)MPSI_RELEASED_##type < sizeof(type) ? (size_t)MPSI_RELEASED_##type : sizeof(type))

mps_status mpsi_def_read(mps_context *context, const char *function, const void *def,
                         size_t minimum, void *known, size_t known_size);
mps_status mpsi_def_init(void *def, size_t size, size_t minimum, const void *defaults,
                         size_t defaults_size);

/* Results (out): the body of every mps_x_get_y_sized. Writes the first `size` bytes of the result
 * `known` to the caller's struct `out`, and zeros behind the members of this library.
 * MPS_ERROR_ARGUMENT for NULL or a size of 0 or above MPSI_STRUCT_MOST; then nothing is written. */
mps_status mpsi_out_write(mps_context *context, const char *function, void *out, size_t size,
                          const void *known, size_t known_size);
/* The same check alone, for a function with long computations before. */
mps_status mpsi_out_check(mps_context *context, const char *function, const void *out, size_t size);
/* The same of a definition, the body of mps_x_get_def_sized: its `struct_size`, the first member,
 * is the size written, so that the caller may create another object from it. */
mps_status mpsi_def_write(mps_context *context, const char *function, void *out, size_t size,
                          const void *known, size_t known_size);

/* ---- threads and instruction level ----------------------------------------------------------- */

/* x86-64 level of the inner loops: 1 (plain), 3 or 4. Selects the loops of solvers and laws. */
int32_t mpsi_context_level(const mps_context *context);
/* MPS_ERROR_STATE once the caller's executor has given a worker or an index out of range. */
mps_status mpsi_executor_check(mps_context *context, const char *function);
/* As mps_context_parallel_for, without argument checks. Never fails. */
void mpsi_parallel_for(mps_context *context, int64_t count, mps_context_task_fn task, void *data);
/* Whether the threads are the library's or OpenMP's: a unit may then wait for others that run at
 * the same time. A caller's executor may run units one after the other. */
bool mpsi_executor_is_own(const mps_context *context);
/* For a unit without work at poll number `look` (from 0): waits, spinning at first and then
 * blocked. False where it may not block: then it must return. */
bool mpsi_wait_a_little(int32_t look, bool may_sleep);
/* For loops that poll memory written by another thread. */
void mpsi_pause(void);

#endif
