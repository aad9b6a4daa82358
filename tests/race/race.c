/* race.c - a race in a parallel loop, on purpose: the thread sanitizer must see it, or its silence
 * about the other tests says nothing. Argument: the executor, "openmp", "threads" or "caller".
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pthread_executor.h"

#include <sched.h>

typedef struct meeting {
  _Atomic int32_t arrived;
  int64_t count; /* what both threads add to */
} meeting;

/* Each unit waits for the other, so that each has a thread of its own. Relaxed: the meeting must
 * not order what follows. */
static void add(void *data, int64_t i, int32_t worker) {
  meeting *m = data;
  (void)i, (void)worker;
  atomic_fetch_add_explicit(&m->arrived, 1, memory_order_relaxed);
  while (atomic_load_explicit(&m->arrived, memory_order_relaxed) < 2) sched_yield();
  m->count++;
}

int main(int argc, char **argv) {
  int32_t threads = 2;
  mps_context_def def = pthread_executor_def(&threads);
  mps_context *context = NULL;
  meeting m = {0};
  const int rounds = 20; /* on a busy machine the sanitizer misses one now and then */
  char text[256] = "";
  if (argc == 2 && strcmp(argv[1], "openmp") == 0) def.executor = MPS_CONTEXT_EXECUTOR_OPENMP;
  if (argc == 2 && strcmp(argv[1], "threads") == 0) def.executor = MPS_CONTEXT_EXECUTOR_THREADS;
  mps_status status = mps_context_create(&def, &context, text, sizeof text);
  for (int k = 0; k < rounds && status == MPS_OK; k++) {
    m.arrived = 0;
    status = mps_context_parallel_for(context, 2, add, &m);
  }
  if (status != MPS_OK) {
    printf("no loop ran: %s\n", text);
    return 1;
  }
  mps_context_destroy(&context);
  printf("%d\n", (int)m.count);
  return 0;
}
