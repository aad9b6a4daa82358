/* executor.c - parallel loops: serial, own threads, OpenMP, or the caller's parallel_for.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#include <time.h>
#include <unistd.h>

#ifdef MPSI_OPENMP
#include <omp.h>
#endif

static int32_t processors(void) {
#ifdef MPSI_OPENMP
  const long count = omp_get_num_procs(); /* processors that the process may use */
#else
  const long count = sysconf(_SC_NPROCESSORS_ONLN);
#endif
  return count < 1 ? 1 : count > MPSI_MAX_THREADS ? MPSI_MAX_THREADS : (int32_t)count;
}

int32_t mpsi_executor_threads(const mps_context_def *def) {
  if (def->executor == MPS_CONTEXT_EXECUTOR_SERIAL) return 1;
  return def->threads > 0 ? def->threads : processors();
}

#ifdef MPSI_OPENMP
static void openmp_for(int32_t threads, int64_t count, mps_context_task_fn task, void *data) {
  /* The number of threads is a clause, never omp_set_num_threads: the host program's setting is not
   * changed. Units are claimed one by one; the result of a unit does not depend on the worker that
   * runs it. */
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (int64_t i = 0; i < count; i++) task(data, i, omp_get_thread_num());
}
#endif

static void serial_for(int64_t count, mps_context_task_fn task, void *data) {
  for (int64_t i = 0; i < count; i++) task(data, i, 0);
}

/* The caller's executor is checked: a worker's number selects scratch memory. */
typedef struct guarded {
  mps_context_task_fn task;
  void *data;
  int64_t count;
  int32_t workers;
  atomic_int *fault;
} guarded;

static void guarded_task(void *data, int64_t index, int32_t worker) {
  const guarded *g = data;
  if (worker >= 0 && worker < g->workers && index >= 0 && index < g->count)
    g->task(g->data, index, worker);
  else
    atomic_store(g->fault, 1);
}

static void caller_for(mps_context *context, int64_t count, mps_context_task_fn task, void *data) {
  guarded g = {task, data, count, context->threads, &context->executor_fault};
  context->def.parallel_for(context->def.parallel_user, count, guarded_task, &g);
}

static void count_run(void *data, int64_t index, int32_t worker) {
  atomic_fetch_add(&((atomic_int *)data)[index], 1);
}

bool mpsi_executor_probe(mps_context *context) {
  if (context->def.executor != MPS_CONTEXT_EXECUTOR_CALLER) return true;
  enum { UNITS = 64 };
  atomic_int runs[UNITS];
  for (int k = 0; k < UNITS; k++) atomic_init(&runs[k], 0);
  caller_for(context, UNITS, count_run, runs);
  bool good = atomic_load(&context->executor_fault) == 0;
  for (int k = 0; k < UNITS; k++) good = good && atomic_load(&runs[k]) == 1;
  return good;
}

mps_status mpsi_executor_check(mps_context *context, const char *function) {
  if (atomic_load(&context->executor_fault) == 0) return MPS_OK;
  return mpsi_fail(
      context, function, MPS_ERROR_STATE,
      "the caller's parallel_for gave a worker outside 0 to %d or an index outside its "
      "range: that unit of work was left out, and the result must not be used",
      context->threads - 1);
}

void mpsi_parallel_for(mps_context *context, int64_t count, mps_context_task_fn task, void *data) {
  const mps_context_def *def = &context->def;
  if (count <= 1 || context->threads <= 1)
    serial_for(count, task, data);
  else if (def->executor == MPS_CONTEXT_EXECUTOR_CALLER)
    caller_for(context, count, task, data);
  else if (def->executor == MPS_CONTEXT_EXECUTOR_THREADS)
    mpsi_pool_for(&context->pool, count, task, data);
#ifdef MPSI_OPENMP
  else
    openmp_for(context->threads, count, task, data);
#endif
}

/* ---- waiting --------------------------------------------------------------------------------- */

#define LOOKS 200      /* before a thread sleeps: some microseconds */
#define SLEEP_NS 20000 /* plus the system's overhead */

bool mpsi_executor_is_own(const mps_context *context) {
  return context->def.executor != MPS_CONTEXT_EXECUTOR_CALLER;
}

bool mpsi_wait_a_little(int32_t look, bool may_sleep) {
  if (look >= LOOKS && !may_sleep) return false;
  if (look < LOOKS)
    mpsi_pause();
  else
    nanosleep(&(struct timespec){.tv_nsec = SLEEP_NS}, NULL);
  return true;
}
