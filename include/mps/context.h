/* mps/context.h - the context: error record, memory, threads, log, progress, cancel.
 *
 * Every object is created from a context and reports its errors there. There is no process-wide
 * state: distinct contexts are independent and may be used from distinct threads at once. One
 * context, and the objects made from it, are used by one thread at a time.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_CONTEXT_H
#define LIBMPS_CONTEXT_H

#include "base.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_context mps_context;

/** The last error of a context or thread. Texts are always terminated. */
typedef struct mps_error {
  mps_status status;
  int32_t reserved;
  int64_t step;      /* time step at which it happened, -1 outside a run */
  int64_t particle;  /* id of the particle concerned, -1 if none */
  char message[512]; /* the offending value and what is allowed */
  char function[64]; /* public function that failed */
  char object[64];   /* what the error is about: its kind ("mpm"), and where there are several its
                        number or name ("body 2", "field 'density'") */
} mps_error;

/** Ends the life of the `user` of a callback that the library has stored. Called once, when nothing
 *  calls the callback any more: the last object that has it is gone, or another callback has taken
 * its place; by the thread that does so. Not called where the function that was to store the
 * callback fails: `user` is the caller's then. It must not call the library. NULL, the default
 * wherever a callback is stored: `user` must outlive the objects that have it. */
typedef void (*mps_release_fn)(void *user);

/** Allocates `size` bytes aligned to `alignment` (a power of two, at least 64), or NULL. */
typedef void *(*mps_context_alloc_fn)(void *user, size_t size, size_t alignment);
/** Releases what mps_context_alloc_fn returned; never called with NULL. */
typedef void (*mps_context_free_fn)(void *user, void *memory);

/** One unit of work. `worker` is in [0, workers) and unique among the units running at once. */
typedef void (*mps_context_task_fn)(void *task, int64_t index, int32_t worker);
/** A caller's own executor: runs task(task_data, i, worker) once for each i in [0, count), in any
 *  order and concurrently, and returns when all are done. It is tested when the context is created.
 *  A unit with a worker or index out of range is left out, and the call, or the next step of a
 *  solver, returns MPS_ERROR_STATE. */
typedef void (*mps_context_parallel_for_fn)(void *user, int64_t count, mps_context_task_fn task,
                                            void *task_data);

/* With OPENMP, for programs that use OpenMP themselves, how the threads wait is the program's
 * choice (OMP_WAIT_POLICY): by default they spin, which costs much where other programs compute.
 * The threads of THREADS start with the first loop and sleep when they have waited for some
 * microseconds; all signals are blocked in them; they run where the thread that starts them may:
 * OMP_PROC_BIND in the environment binds that to one processor, which they then share. */
typedef enum mps_context_executor {
  MPS_CONTEXT_EXECUTOR_THREADS = 0, /* `threads` of the context's own, with the calling thread */
  MPS_CONTEXT_EXECUTOR_SERIAL = 1,  /* the calling thread only */
  MPS_CONTEXT_EXECUTOR_OPENMP = 2,  /* `threads` OpenMP threads */
  MPS_CONTEXT_EXECUTOR_CALLER = 3   /* parallel_for below */
} mps_context_executor;

typedef enum mps_context_log {
  MPS_CONTEXT_LOG_WARNING = 0,
  MPS_CONTEXT_LOG_INFO = 1,
  MPS_CONTEXT_LOG_DEBUG = 2
} mps_context_log;

/** Receives a warning or a note: `level` is an mps_context_log_level, `message` one line without an
 *  end of line, valid during the call. Called by the thread that calls the library. */
typedef void (*mps_context_log_fn)(void *user, int32_t level, const char *message);

/** Progress of the running call, as the progress hook receives it. */
typedef struct mps_context_progress {
  uint32_t struct_size; /* bytes that the library has filled: members behind are not there */
  const char *task;     /* short name of what is running */
  int64_t step;
  double time, time_end; /* s */
  double fraction;       /* 0..1 */
} mps_context_progress;
typedef void (*mps_context_progress_fn)(void *user, const mps_context_progress *progress);
/** Return non-zero to stop the running call with MPS_ERROR_CANCELLED. */
typedef int32_t (*mps_context_cancel_fn)(void *user);

/** Definition of a context; always start from mps_context_defaults. */
typedef struct mps_context_def {
  uint32_t struct_size;
  int32_t executor; /* mps_context_executor; default THREADS */
  int32_t threads;  /* 1..1024; 0 (default): all processors the process may use */
  /** x86-64 level of the inner loops of all that is made from the context: 1 (the plain build, on
   *  other processors the only one), 3 (AVX2) or 4 (AVX-512); 0 (default): the highest that
   *  processor and build have. Results are the same bit for bit for every level, but for WLS-MPM,
   *  whose loops use fused multiply-adds where a level has them: there last bits differ. */
  int32_t instruction_level;
  mps_context_parallel_for_fn
      parallel_for; /* for MPS_CONTEXT_EXECUTOR_CALLER, with `threads` workers */
  void *parallel_user;
  mps_release_fn parallel_release;
  mps_context_alloc_fn alloc; /* both or neither of alloc and free */
  mps_context_free_fn free;
  void *memory_user;
  mps_release_fn memory_release; /* after the last memory has been given to `free` */
  mps_context_log_fn log;        /* default NULL: the library never prints */
  void *log_user;
  mps_release_fn log_release;
  mps_context_progress_fn progress;
  void *progress_user;
  mps_release_fn progress_release;
  mps_context_cancel_fn cancel;
  void *cancel_user;
  mps_release_fn cancel_release;
} mps_context_def;

static inline mps_context_def mps_context_defaults(void) {
  mps_context_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_CONTEXT, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a context. `def` NULL: the defaults. `error_text` (may be NULL, of `error_size` bytes)
 *  receives the reason of a failure, which mps_last_error has too. MPS_ERROR_ARGUMENT: a
 *  member of `def` out of range, or an executor that does not run each index once;
 *  MPS_ERROR_MEMORY; MPS_ERROR_UNSUPPORTED: OpenMP, or an instruction level, that this build or
 *  processor lacks. */
MPS_API MPS_NODISCARD mps_status mps_context_create(const mps_context_def *def, mps_context **out,
                                                    char *error_text, size_t error_size);

/** Destroys and nulls; accepts NULL. Objects made from the context stay usable: its memory is freed
 *  with the last of them. */
MPS_API void mps_context_destroy(mps_context **context);

/** The record of the last failed call, with status MPS_OK before the first; never NULL. A call that
 *  succeeds leaves it. Owned by the context, overwritten by the next
 *  failure. `context` NULL: that of mps_last_error. Members of later releases: by
 *  mps_context_get_error. */
MPS_API const mps_error *mps_context_error(const mps_context *context);
/** Writes the first `size` bytes of the record to `out`; members that the library does not have are
 *  NaN or -1, as in all results. MPS_ERROR_ARGUMENT: a size out of range. */
MPS_API mps_status mps_context_get_error_sized(const mps_context *context, mps_error *out,
                                               size_t size);
static inline mps_status mps_context_get_error(const mps_context *context, mps_error *out) {
  return mps_context_get_error_sized(context, out, sizeof *out);
}
/** The record of the last failed call of this thread, of any context, or without one: a NULL
 * object, a failed mps_context_create. Never NULL; valid until the thread ends. Thread safe. */
static inline const mps_error *mps_last_error(void) { return mps_context_error(NULL); }
/** Empties the record: status MPS_OK, no message. `context` NULL: that of mps_last_error. */
MPS_API void mps_context_clear_error(mps_context *context);
/** Makes the record of a failure of the caller's own, such as one in a callback, whose status the
 *  library then returns with this message in its own. `function` (NULL: "caller") names the
 *  function that has failed, `message` (cut to the record's length) the reason. Returns `status`;
 *  MPS_ERROR_ARGUMENT, recorded as such, where it is no error of the library or message is NULL.
 *  `context` NULL: the record of mps_last_error alone. Allowed within callbacks. */
MPS_API mps_status mps_context_set_error(mps_context *context, mps_status status,
                                         const char *function, const char *message);

/* Warnings are kept whether or not there is a log hook: a program may show them after a run. */

/** A warning of the context. */
typedef struct mps_context_warning {
  int64_t times;  /* given so far, with the same text */
  char text[512]; /* terminated, cut to this length */
} mps_context_warning;
/** Number of different warnings that the context has kept, the first 32; 0 for NULL. */
MPS_API int64_t mps_context_warning_count(const mps_context *context);
/** Warning `index` (0 to the count - 1, in the order in which each was first given).
 *  MPS_ERROR_ARGUMENT: `index` out of range, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_context_get_warning_sized(const mps_context *context,
                                                               int64_t index,
                                                               mps_context_warning *out,
                                                               size_t size);
static inline mps_status mps_context_get_warning(const mps_context *context, int64_t index,
                                                 mps_context_warning *out) {
  return mps_context_get_warning_sized(context, index, out, sizeof *out);
}
/** Forgets the warnings, such as before the next run; accepts NULL. */
MPS_API void mps_context_clear_warnings(mps_context *context);

/** Replaces the log hook, its `user` and `release`, and releases the former ones; NULL: none. Not
 *  while a function of the context or of its objects runs in another thread, nor in the hook. */
MPS_API void mps_context_set_log(mps_context *context, mps_context_log_fn log, void *user,
                                 mps_release_fn release);
/** Replaces the progress hook, as mps_context_set_log. */
MPS_API void mps_context_set_progress(mps_context *context, mps_context_progress_fn progress,
                                      void *user, mps_release_fn release);
/** Replaces the cancel hook, as mps_context_set_log. */
MPS_API void mps_context_set_cancel(mps_context *context, mps_context_cancel_fn cancel, void *user,
                                    mps_release_fn release);

/** Number of workers of the executor. */
MPS_API int32_t mps_context_threads(const mps_context *context);

/** Runs task(data, i, worker) for i in [0, count) on the context's executor and waits. The task
 *  must not use this context or its objects except to read them. MPS_ERROR_ARGUMENT: `task` NULL,
 *  `count` below 0; MPS_ERROR_STATE: the caller's executor has left a unit out. */
MPS_API MPS_NODISCARD mps_status mps_context_parallel_for(mps_context *context, int64_t count,
                                                          mps_context_task_fn task, void *data);

MPS_EXTERN_C_END
#endif
