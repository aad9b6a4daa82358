/* context.c - the context object: creation and destruction, and the hooks for log, progress and
 * cancel.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include "levels.h"

#include <mps/context.h>

#include <stdio.h>
#include <string.h>

static const mps_context_def context_defaults = {
    .struct_size = sizeof(mps_context_def),
    .executor = MPS_CONTEXT_EXECUTOR_THREADS,
};

mps_status mps_context_def_init(mps_context_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_context_def, def, size, &context_defaults);
}

/* ---- life ------------------------------------------------------------------------------------ */

static mps_status refuse(char *text, size_t size, mps_status status, const char *message) {
  if (text && size) snprintf(text, size, "mps_context_create: %s", message);
  return status;
}

#define LEVEL_NAME(level, a, b) ", " #level
#define LEVELS MPSI_ALL_LEVELS(LEVEL_NAME, , )

static bool known_level(int32_t level) {
  static const int32_t known[] = {0, MPSI_ALL_LEVELS(MPSI_LEVEL_VALUE, , )};
  for (size_t k = 0; k < sizeof known / sizeof *known; k++)
    if (level == known[k]) return true;
  return false;
}

static mps_status check_def(const mps_context_def *def, char *text, size_t size) {
  char why[160];
  if (def->executor < MPS_CONTEXT_EXECUTOR_THREADS || def->executor > MPS_CONTEXT_EXECUTOR_CALLER) {
    snprintf(why, sizeof why,
             "executor is %d, allowed are 0 (threads), 1 (serial), 2 (OpenMP), 3 (caller)",
             def->executor);
    return refuse(text, size, MPS_ERROR_ARGUMENT, why);
  }
#ifndef MPSI_OPENMP
  if (def->executor == MPS_CONTEXT_EXECUTOR_OPENMP)
    return refuse(
        text, size, MPS_ERROR_UNSUPPORTED,
        "this libmps was built without OpenMP: use MPS_CONTEXT_EXECUTOR_THREADS, or the caller's");
#endif
  if (def->threads < 0 || def->threads > MPSI_MAX_THREADS) {
    snprintf(why, sizeof why, "threads is %d, allowed are 0 (all processors) to %d", def->threads,
             MPSI_MAX_THREADS);
    return refuse(text, size, MPS_ERROR_ARGUMENT, why);
  }
  const int32_t level = def->instruction_level;
  if (!known_level(level)) {
    snprintf(why, sizeof why,
             "instruction_level is %d, allowed are 0 (the highest there is)" LEVELS, level);
    return refuse(text, size, MPS_ERROR_ARGUMENT, why);
  }
  if (mpsi_level(level) == 0) {
    snprintf(why, sizeof why,
             "instruction_level is %d, but this processor or build has none above %d", level,
             mpsi_level(0));
    return refuse(text, size, MPS_ERROR_UNSUPPORTED, why);
  }
  if (def->executor == MPS_CONTEXT_EXECUTOR_CALLER && (!def->parallel_for || def->threads < 1))
    return refuse(text, size, MPS_ERROR_ARGUMENT,
                  "the caller's executor needs parallel_for and threads >= 1");
  if (!def->alloc != !def->free)
    return refuse(text, size, MPS_ERROR_ARGUMENT, "alloc and free must be given together");
  return MPS_OK;
}

static mps_status refuse_struct(char *text, size_t size, mps_status status, uint32_t struct_size) {
  char why[160];
  if (status == MPS_ERROR_UNSUPPORTED)
    snprintf(why, sizeof why,
             "def, of %u bytes, has a non-zero member that this library (version %s) does not know",
             struct_size, mps_version());
  else
    snprintf(why, sizeof why,
             "def.struct_size is %u bytes, allowed are %zu to %d: start from "
             "mps_context_defaults()",
             struct_size, MPSI_RELEASED(mps_context_def), MPSI_STRUCT_MOST);
  return refuse(text, size, status, why);
}

mps_status mps_context_create(const mps_context_def *user_def, mps_context **out, char *error_text,
                              size_t error_size) {
  if (error_text && error_size) error_text[0] = '\0';
  if (!out) return refuse(error_text, error_size, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_context_def def = context_defaults;
  mps_status status = MPS_OK;
  if (user_def) status = MPSI_DEF_READ(NULL, __func__, mps_context_def, user_def, &def);
  if (status != MPS_OK) return refuse_struct(error_text, error_size, status, user_def->struct_size);
  if ((status = check_def(&def, error_text, error_size)) != MPS_OK) return status;
  if (!def.alloc) mpsi_use_system_memory(&def);
  const int32_t threads = mpsi_executor_threads(&def);
  size_t bytes = sizeof(mps_context) + mpsi_pool_bytes(threads);
  bytes = (bytes + MPSI_ALIGNMENT - 1) / MPSI_ALIGNMENT * MPSI_ALIGNMENT;
  mps_context *context = def.alloc(def.memory_user, bytes, MPSI_ALIGNMENT);
  if (!context) return refuse(error_text, error_size, MPS_ERROR_MEMORY, "out of memory");
  memset(context, 0, bytes);
  context->def = def;
  context->threads = threads;
  if (def.executor == MPS_CONTEXT_EXECUTOR_THREADS &&
      !mpsi_pool_begin(&context->pool, threads, context + 1)) {
    def.free(def.memory_user, context);
    return refuse(error_text, error_size, MPS_ERROR_MEMORY, "the system refuses a lock");
  }
  context->level = mpsi_level(def.instruction_level);
  context->error.step = context->error.particle = -1;
  atomic_init(&context->references, 1);
  atomic_init(&context->executor_fault, 0);
  if (!mpsi_executor_probe(context)) {
    mpsi_context_release(context);
    return refuse(
        error_text, error_size, MPS_ERROR_ARGUMENT,
        "parallel_for did not run each index from 0 to count - 1 once, with workers from 0 "
        "to threads - 1");
  }
  *out = context;
  return MPS_OK;
}

mps_context *mpsi_context_retain(mps_context *context) {
  atomic_fetch_add(&context->references, 1);
  return context;
}

void mpsi_context_release(mps_context *context) {
  if (atomic_fetch_sub(&context->references, 1) != 1) return;
  mpsi_pool_end(&context->pool);
  context->def.free(context->def.memory_user, context);
}

void mps_context_destroy(mps_context **context) {
  if (!context || !*context) return;
  mpsi_context_release(*context);
  *context = NULL;
}

/* ---- hooks ----------------------------------------------------------------------------------- */

void mps_context_set_log(mps_context *context, mps_context_log_fn log, void *user) {
  if (!context) return;
  context->def.log = log;
  context->def.log_user = user;
}

void mps_context_set_progress(mps_context *context, mps_context_progress_fn progress, void *user) {
  if (!context) return;
  context->def.progress = progress;
  context->def.progress_user = user;
}

void mps_context_set_cancel(mps_context *context, mps_context_cancel_fn cancel, void *user) {
  if (!context) return;
  context->def.cancel = cancel;
  context->def.cancel_user = user;
}

void mpsi_progress(mps_context *context, const char *task, int64_t step, double time,
                   double time_end) {
  if (!context->def.progress) return;
  const double fraction = time_end > 0.0 ? time / time_end : 1.0;
  const mps_context_progress progress = {.task = task,
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

int32_t mps_context_instruction_level(const mps_context *context) {
  return context ? context->level : 0;
}

int32_t mps_context_threads(const mps_context *context) { return context ? context->threads : 0; }

mps_status mps_context_parallel_for(mps_context *context, int64_t count, mps_context_task_fn task,
                                    void *data) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (count < 0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (!task) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "task is NULL");
  mpsi_parallel_for(context, count, task, data);
  return mpsi_executor_check(context, __func__);
}
