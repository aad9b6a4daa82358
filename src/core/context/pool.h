/* pool.h - persistent threads: the executor MPS_CONTEXT_EXECUTOR_THREADS.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/context.h>

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

struct mpsi_pool;

typedef struct mpsi_pool_thread {
  struct mpsi_pool *pool;
  int32_t worker; /* from 1: the caller's thread is worker 0 */
  pthread_t thread;
} mpsi_pool_thread;

typedef struct mpsi_pool {
  pthread_mutex_t lock; /* of all members without another guard */
  pthread_cond_t work, done;
  mpsi_pool_thread *member; /* room for size of them */
  int32_t size, started;
  long process; /* process of the threads: a fork has none */
  /* the loop in work */
  mps_context_task_fn task;
  void *data;
  int64_t count;
  _Atomic int64_t next;    /* next unclaimed unit */
  _Atomic uint32_t number; /* of the loop: changes when one begins */
  _Atomic int32_t inside;  /* threads inside the loop */
  bool open, busy, quit;   /* open: threads may still enter; busy: a loop is running */
  int32_t asleep;
} mpsi_pool;

/* Bytes of the members of a pool for so many workers, the caller's thread being one. */
size_t mpsi_pool_bytes(int32_t workers);
/* `member` has room for mpsi_pool_bytes. The threads start with the first loop. False where a lock
 * cannot be created. */
bool mpsi_pool_begin(mpsi_pool *pool, int32_t workers, void *member);
void mpsi_pool_end(mpsi_pool *pool);
/* Runs task(data, i, worker) for i in [0, count). */
void mpsi_pool_for(mpsi_pool *pool, int64_t count, mps_context_task_fn task, void *data);
