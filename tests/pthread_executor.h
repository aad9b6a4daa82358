/* pthread_executor.h - a caller's executor on POSIX threads. The thread sanitizer understands it
 * (it does not understand gcc's OpenMP), so tests of threads use it where they are to find races.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_PTHREAD_EXECUTOR_H
#define MPS_TEST_PTHREAD_EXECUTOR_H

#include "test_common.h"

#include <pthread.h>
#include <stdatomic.h>

#define PTHREAD_EXECUTOR_MAX 16

typedef struct pthread_executor_job {
  mps_context_task_fn task;
  void *data;
  int64_t count;
  _Atomic int64_t next;    /* the next unclaimed unit */
  _Atomic int32_t workers; /* numbers given out */
} pthread_executor_job;

/* Relaxed: the counters must not order one unit after another, which would hide their races. */
static void *pthread_executor_worker(void *argument) {
  pthread_executor_job *job = argument;
  const int32_t worker = atomic_fetch_add_explicit(&job->workers, 1, memory_order_relaxed);
  for (;;) {
    const int64_t i = atomic_fetch_add_explicit(&job->next, 1, memory_order_relaxed);
    if (i >= job->count) break;
    job->task(job->data, i, worker);
  }
  return NULL;
}

/* An mps_context_parallel_for_fn; `user` is the address of the number of threads (int32_t). */
static inline void pthread_executor(void *user, int64_t count, mps_context_task_fn task,
                                    void *data) {
  const int32_t threads = *(const int32_t *)user;
  pthread_executor_job job = {.task = task, .data = data, .count = count};
  pthread_t ids[PTHREAD_EXECUTOR_MAX];
  for (int32_t t = 1; t < threads; t++)
    if (pthread_create(&ids[t], NULL, pthread_executor_worker, &job) != 0) abort();
  pthread_executor_worker(&job);
  for (int32_t t = 1; t < threads; t++) pthread_join(ids[t], NULL);
}

/* A definition that uses it; *threads (1..16) must outlive the context. */
static inline mps_context_def pthread_executor_def(int32_t *threads) {
  mps_context_def def = test_context_defaults();
  def.executor = MPS_CONTEXT_EXECUTOR_CALLER;
  def.threads = *threads;
  def.parallel_for = pthread_executor;
  def.parallel_user = threads;
  return def;
}

#endif
