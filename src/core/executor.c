/* executor.c - parallel loops: serial, OpenMP, or the caller's own parallel_for.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "context_private.h"

#ifdef MPSI_OPENMP
#include <omp.h>
#endif

int32_t mpsi_executor_threads(const mps_context_def *def) {
  if (def->executor == MPS_EXECUTOR_SERIAL) return 1;
  if (def->threads > 0) return def->threads;
#ifdef MPSI_OPENMP
  const int processors = omp_get_num_procs();
  return processors < 1 ? 1 : processors > MPSI_MAX_THREADS ? MPSI_MAX_THREADS : processors;
#else
  return 1;
#endif
}

#ifdef MPSI_OPENMP
static void openmp_for(int32_t threads, int64_t count, mps_task_fn task, void *data) {
  /* The number of threads is a clause, never omp_set_num_threads: the host program's setting is
   * not ours to change. Units are claimed one by one; what a unit computes does not depend on
   * which worker runs it. */
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (int64_t i = 0; i < count; i++) task(data, i, omp_get_thread_num());
}
#endif

void mpsi_parallel_for(mps_context *context, int64_t count, mps_task_fn task, void *data) {
  const mps_context_def *def = &context->def;
  if (count > 1 && context->threads > 1) {
    if (def->executor == MPS_EXECUTOR_CALLER) {
      def->parallel_for(def->parallel_user, count, task, data);
      return;
    }
#ifdef MPSI_OPENMP
    openmp_for(context->threads, count, task, data);
    return;
#endif
  }
  for (int64_t i = 0; i < count; i++) task(data, i, 0);
}
