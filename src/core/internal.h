/* internal.h - the core's interface for all source files of the library: errors, memory, definition
 * structs, reference counts, parallel loops. Internal names begin with mpsi_.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#ifndef MPSI_LEVEL /* inner loops read no definitions: a new one does not compile them again */
#include "core/definition/definition.h"
#endif

#include "core/definition/ends.h"

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

/* Records an error on the context (NULL: on the thread alone, as mps_last_error reads it) and
 * returns `status` (`function` NULL: nothing is recorded), so that `return mpsi_fail(ctx,
 * "mps_x_create", MPS_ERROR_ARGUMENT, "...", ...)` reads as one. The message names the offending
 * value and what is allowed. */
mps_status mpsi_fail(mps_context *context, const char *function, mps_status status,
                     const char *format, ...) MPSI_PRINTF(4, 5);
/* Adds the step and the particle id to the record just written. */
void mpsi_fail_where(mps_context *context, int64_t step, int64_t particle);
/* Names the object concerned in the record just written: "body 2", "field 'density'". Without it
 * the object is the kind that the function's name begins with. */
void mpsi_fail_object(mps_context *context, const char *format, ...) MPSI_PRINTF(2, 3);
/* MPS_ERROR_ARGUMENT for an object that is NULL, and with it the context. */
mps_status mpsi_null(const char *function, const char *argument);
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

/* Returns from the function around it with the status of `call` where that is an error. */
#define MPSI_TRY(call)                                                                             \
  do {                                                                                             \
    const mps_status mpsi_tried = (call);                                                          \
    if (mpsi_tried != MPS_OK) return mpsi_tried;                                                   \
  } while (0)
/* What a message says of a choice: the name of its enumerator ("MPS_BOUNDARY_HELD" of
 * "mps_boundary_kind" and 0); the number of a value that has none. */
typedef struct mpsi_name {
  char text[64];
} mpsi_name;
mpsi_name mpsi_name_of(const char *enumeration, int32_t value);
/* The enumeration that an enumerator belongs to; NULL for another name. */
const char *mpsi_enumeration_of(const char *name);

/* Length of the identifier [A-Za-z_][A-Za-z0-9_]* that `name` begins with; 0: none, or one of
 * `capacity` characters or more. The rest is not checked. */
size_t mpsi_identifier(const char *name, size_t capacity);

/* ---- memory: zero filled, aligned to MPSI_ALIGNMENT ----------------------------------------- */

/* NULL when count * size overflows or memory is refused; a count of 0 gives one cache line, never
 * NULL. */
void *mpsi_alloc(mps_context *context, int64_t count, size_t size);
void mpsi_free(mps_context *context, void *memory); /* accepts NULL */
void mpsi_free_all(mps_context *context, void *const *memory, size_t count);
/* The same for each of several pointers. */
#define MPSI_FREE(context, ...)                                                                    \
  mpsi_free_all(context, (void *const[]){__VA_ARGS__},                                             \
                sizeof((void *const[]){__VA_ARGS__}) / sizeof(void *))
/* Grows *array from `old_count` to `new_count` items, keeping and zero filling; false and
 * unchanged when out of memory. */
bool mpsi_grow(mps_context *context, void **array, int64_t old_count, int64_t new_count,
               size_t size);

/* ---- life of contexts: objects keep their context alive ------------------------------------- */

mps_context *mpsi_context_retain(mps_context *context);
void mpsi_context_release(mps_context *context);

/* ---- callbacks that are stored --- */

/* Ends `user` of a callback; `release` may be NULL. */
static inline void mpsi_release(mps_release_fn release, void *user) {
  if (release) release(user);
}

/* ---- hooks ---------------------------------------------------------------------------------- */

void mpsi_progress(mps_context *context, const char *task, int64_t step, double time,
                   double time_end);
bool mpsi_cancelled(mps_context *context);

/* ---- growing structs: definitions (in) are described in definition.h --------------------------
 */

/* Reads the caller's definition `def` over the defaults into *known, a `type`, and checks each
 * member and rule of its tables. NULL is an error. */
#define MPSI_DEF_READ(context, function, type, def, known)                                         \
  MPSI_DEF_READ_IN(context, function, type, def, 0, known)
/* The same by a solver or set that is a `scene` (mpsi_scene), on which rules may depend. */
#define MPSI_DEF_READ_IN(context, function, type, def, scene, known)                               \
  mpsi_def_read(context, function, &mpsi_definition_of_##type, def, true, scene,                   \
                1 ? (known) : (type *)0)
/* The same where NULL stands for the defaults. */
#define MPSI_DEF_READ_OR_DEFAULTS(context, function, type, def, known)                             \
  MPSI_DEF_READ_OR_DEFAULTS_IN(context, function, type, def, 0, known)
#define MPSI_DEF_READ_OR_DEFAULTS_IN(context, function, type, def, scene, known)                   \
  mpsi_def_read(context, function, &mpsi_definition_of_##type, def, false, scene,                  \
                1 ? (known) : (type *)0)

struct mpsi_definition;
mps_status mpsi_def_read(mps_context *context, const char *function,
                         const struct mpsi_definition *definition, const void *def, bool needed,
                         uint32_t scene, void *known);

/* Results (out): the body of every mps_x_get_y_sized. Writes the first `size` bytes of the result
 * `known` to the caller's struct `out`; members that only the caller knows become NaN, or -1 where
 * they are integers: all bits set.
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
