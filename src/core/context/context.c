/* context.c - the context object: creation and destruction, and the hooks for log, progress and
 * cancel.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include "levels.h"

#include <mps/context.h>

#include <stdio.h>
#include <string.h>

/* ---- life ------------------------------------------------------------------------------------ */

#define LEVEL_NAME(level, a, b) ", " #level
#define LEVELS MPSI_ALL_LEVELS(LEVEL_NAME, , )

static bool known_level(int32_t level) {
  static const int32_t known[] = {0, MPSI_ALL_LEVELS(MPSI_LEVEL_VALUE, , )};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (level == known[k]) return true;
  return false;
}

static mps_status check_def(const mps_context_def *def, const char *function) {
#ifndef MPSI_OPENMP
  if (def->executor == MPS_CONTEXT_EXECUTOR_OPENMP)
    return mpsi_fail(NULL, function, MPS_ERROR_UNSUPPORTED,
                     "this libmps was built without OpenMP: use MPS_CONTEXT_EXECUTOR_THREADS, or "
                     "the caller's");
#endif
  const int32_t level = def->instruction_level;
  if (!known_level(level))
    return mpsi_fail(NULL, function, MPS_ERROR_ARGUMENT,
                     "instruction_level is %d, allowed are 0 (the highest there is)" LEVELS, level);
  if (mpsi_level(level) == 0)
    return mpsi_fail(NULL, function, MPS_ERROR_UNSUPPORTED,
                     "instruction_level is %d, but this processor or build has none above %d",
                     level, mpsi_level(0));
  return MPS_OK;
}

static mps_status create(const char *function, const mps_context_def *user_def, mps_context **out) {
  if (!out) return mpsi_null(function, "out");
  *out = NULL;
  mps_context_def def;
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS(NULL, function, mps_context_def, user_def, &def));
  MPSI_TRY(check_def(&def, function));
  if (!def.alloc) mpsi_use_system_memory(&def);
  const int32_t threads = mpsi_executor_threads(&def);
  size_t bytes = sizeof(mps_context) + mpsi_pool_bytes(threads);
  bytes = (bytes + MPSI_ALIGNMENT - 1) / MPSI_ALIGNMENT * MPSI_ALIGNMENT;
  mps_context *context = def.alloc(def.memory_user, bytes, MPSI_ALIGNMENT);
  if (!context) return mpsi_fail_memory(NULL, function, bytes);
  memset(context, 0, bytes);
  context->def = def;
  context->threads = threads;
  if (def.executor == MPS_CONTEXT_EXECUTOR_THREADS &&
      !mpsi_pool_begin(&context->pool, threads, context + 1)) {
    def.free(def.memory_user, context);
    return mpsi_fail(NULL, function, MPS_ERROR_MEMORY, "the system refuses a lock");
  }
  context->level = mpsi_level(def.instruction_level);
  context->error.step = context->error.particle = -1;
  atomic_init(&context->references, 1);
  atomic_init(&context->executor_fault, 0);
  if (!mpsi_executor_probe(context)) {
    mpsi_pool_end(&context->pool);
    def.free(def.memory_user, context);
    return mpsi_fail(NULL, function, MPS_ERROR_ARGUMENT,
                     "parallel_for did not run each index from 0 to count - 1 once, with workers "
                     "from 0 to threads - 1");
  }
  *out = context;
  return MPS_OK;
}

mps_status mps_context_create(const mps_context_def *def, mps_context **out, char *error_text,
                              size_t error_size) {
  const mps_status status = create(__func__, def, out);
  if (error_text && error_size) error_text[0] = '\0';
  if (status != MPS_OK && error_text && error_size)
    snprintf(error_text, error_size, "%s: %s", __func__, mpsi_thread_error.message);
  return status;
}

mps_context *mpsi_context_retain(mps_context *context) {
  atomic_fetch_add(&context->references, 1);
  return context;
}

void mpsi_context_release(mps_context *context) {
  if (atomic_fetch_sub(&context->references, 1) != 1) return;
  mpsi_pool_end(&context->pool);
  const mps_context_def def = context->def;
  mpsi_release(def.log_release, def.log_user);
  mpsi_release(def.progress_release, def.progress_user);
  mpsi_release(def.cancel_release, def.cancel_user);
  mpsi_release(def.parallel_release, def.parallel_user);
  def.free(def.memory_user, context);
  mpsi_release(def.memory_release, def.memory_user);
}

void mps_context_destroy(mps_context **context) {
  if (!context || !*context) return;
  mpsi_context_release(*context);
  *context = NULL;
}

mps_status mps_context_get_error_sized(const mps_context *context, mps_error *out, size_t size) {
  return mpsi_out_write(NULL, "mps_context_get_error", out, size, mps_context_error(context),
                        sizeof(mps_error));
}

/* ---- hooks ----------------------------------------------------------------------------------- */

void mps_context_set_log(mps_context *context, mps_context_log_fn log, void *user,
                         mps_release_fn release) {
  if (!context) return;
  const mps_context_def former = context->def;
  context->def.log = log;
  context->def.log_user = user;
  context->def.log_release = release;
  mpsi_release(former.log_release, former.log_user);
}

void mps_context_set_progress(mps_context *context, mps_context_progress_fn progress, void *user,
                              mps_release_fn release) {
  if (!context) return;
  const mps_context_def former = context->def;
  context->def.progress = progress;
  context->def.progress_user = user;
  context->def.progress_release = release;
  mpsi_release(former.progress_release, former.progress_user);
}

void mps_context_set_cancel(mps_context *context, mps_context_cancel_fn cancel, void *user,
                            mps_release_fn release) {
  if (!context) return;
  const mps_context_def former = context->def;
  context->def.cancel = cancel;
  context->def.cancel_user = user;
  context->def.cancel_release = release;
  mpsi_release(former.cancel_release, former.cancel_user);
}

void mpsi_progress(mps_context *context, const char *task, int64_t step, double time,
                   double time_end) {
  if (!context->def.progress) return;
  const double fraction = time_end > 0.0 ? time / time_end : 1.0;
  const mps_context_progress progress = {.struct_size = sizeof progress,
                                         .task = task,
                                         .step = step,
                                         .time = time,
                                         .time_end = time_end,
                                         .fraction = fraction < 0.0   ? 0.0
                                                     : fraction > 1.0 ? 1.0
                                                                      : fraction};
  context->def.progress(context->def.progress_user, &progress);
}

bool mpsi_cancelled(mps_context *context) {
  return context->def.cancel && context->def.cancel(context->def.cancel_user) != 0;
}

int32_t mpsi_context_level(const mps_context *context) { return context->level; }

int32_t mps_context_threads(const mps_context *context) { return context ? context->threads : 0; }

mps_status mps_context_parallel_for(mps_context *context, int64_t count, mps_context_task_fn task,
                                    void *data) {
  if (!context) return mpsi_null(__func__, "context");
  if (count < 0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (!task) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "task is NULL");
  mpsi_parallel_for(context, count, task, data);
  return mpsi_executor_check(context, __func__);
}
