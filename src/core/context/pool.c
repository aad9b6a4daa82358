/* pool.c - persistent threads, which run units of work together with the caller's thread.
 *
 * For machines with other load, too: a loop does not wait for threads that have not entered it. The
 * caller runs units like the others, closes the loop when none are left, and waits only for threads
 * inside a unit. A waiting thread spins for some microseconds, the usual wait on an idle machine,
 * then spins with yields, and finally blocks on a condition variable. Waking takes tens of
 * microseconds; a thread that is late for that reason makes the others wait, which would then block
 * in turn, loop after loop: hence the long spin.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pool.h"

#include "core/internal.h"

#include <sched.h>
#include <signal.h>
#include <unistd.h>

void mpsi_pause(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

#define LOOKS 400  /* of a waiting thread: 5 to 20 microseconds */
#define OFFERS 400 /* yields, before it blocks: some 200 microseconds */

/* Pause between two polls; false: time to block. */
static bool wait_more(int look) {
  if (look < LOOKS)
    mpsi_pause();
  else
    sched_yield();
  return look < LOOKS + OFFERS;
}

/* ---- workers --------------------------------------------------------------------------------- */

static void run_units(mpsi_pool *p, mps_context_task_fn task, void *data, int64_t count,
                      int32_t worker) {
  for (;;) {
    const int64_t unit = atomic_fetch_add_explicit(&p->next, 1, memory_order_relaxed);
    if (unit >= count) return;
    task(data, unit, worker);
  }
}

static void *live(void *argument) {
  const mpsi_pool_thread *self = argument;
  mpsi_pool *p = self->pool;
  uint32_t seen = 0; /* of the loops */
  for (;;) {
    for (int look = 0; wait_more(look); look++)
      if (atomic_load_explicit(&p->number, memory_order_relaxed) != seen) break;
    pthread_mutex_lock(&p->lock);
    while (!p->quit && !(p->open && p->number != seen)) {
      seen = p->number; /* the loop has been closed meanwhile */
      p->asleep++;
      pthread_cond_wait(&p->work, &p->lock);
      p->asleep--;
    }
    const bool quit = p->quit;
    const mps_context_task_fn task = p->task;
    void *const data = p->data;
    const int64_t count = p->count;
    seen = p->number;
    if (!quit) p->inside++;
    pthread_mutex_unlock(&p->lock);
    if (quit) return NULL;
    run_units(p, task, data, count, self->worker);
    pthread_mutex_lock(&p->lock);
    if (--p->inside == 0 && !p->open) pthread_cond_signal(&p->done);
    pthread_mutex_unlock(&p->lock);
  }
}

/* The host program's handlers of signals run in its own threads. Where a thread cannot be created,
 * the others do its work. */
static void start(mpsi_pool *p) {
  sigset_t all, old;
  sigfillset(&all);
  if (pthread_sigmask(SIG_SETMASK, &all, &old) != 0) return;
  p->process = (long)getpid();
  while (p->started < p->size) {
    mpsi_pool_thread *member = &p->member[p->started];
    *member = (mpsi_pool_thread){.pool = p, .worker = p->started + 1};
    if (pthread_create(&member->thread, NULL, live, member) != 0) break;
    p->started++;
  }
  pthread_sigmask(SIG_SETMASK, &old, NULL);
  p->size = p->started;
}

/* ---- the caller's thread --------------------------------------------------------------------- */

static void open_loop(mpsi_pool *p, int64_t count, mps_context_task_fn task, void *data) {
  pthread_mutex_lock(&p->lock);
  p->task = task, p->data = data, p->count = count;
  atomic_store_explicit(&p->next, 0, memory_order_relaxed);
  p->number++;
  p->open = true;
  if (p->asleep > 0 && p->asleep < count - 1)
    pthread_cond_broadcast(&p->work);
  else
    for (int64_t k = 0; k < count - 1 && k < p->asleep; k++) pthread_cond_signal(&p->work);
  pthread_mutex_unlock(&p->lock);
}

static void close_loop(mpsi_pool *p) {
  pthread_mutex_lock(&p->lock);
  p->open = false;
  pthread_mutex_unlock(&p->lock);
  for (int look = 0; wait_more(look); look++)
    if (atomic_load_explicit(&p->inside, memory_order_relaxed) == 0) break;
  pthread_mutex_lock(&p->lock);
  while (p->inside > 0) pthread_cond_wait(&p->done, &p->lock);
  pthread_mutex_unlock(&p->lock);
}

void mpsi_pool_for(mpsi_pool *p, int64_t count, mps_context_task_fn task, void *data) {
  const bool first = p->started == 0 && !p->busy;
  if (first) start(p);
  if (p->size == 0 || p->busy || p->process != (long)getpid()) { /* busy: a loop within a unit */
    for (int64_t i = 0; i < count; i++) task(data, i, 0);
    return;
  }
  p->busy = true;
  open_loop(p, count, task, data);
  run_units(p, task, data, count, 0);
  close_loop(p);
  p->busy = false;
}

/* ---- life ------------------------------------------------------------------------------------ */

size_t mpsi_pool_bytes(int32_t workers) { return (size_t)workers * sizeof(mpsi_pool_thread); }

bool mpsi_pool_begin(mpsi_pool *p, int32_t workers, void *member) {
  p->member = member;
  p->size = workers - 1;
  if (pthread_mutex_init(&p->lock, NULL) != 0) return false;
  if (pthread_cond_init(&p->work, NULL) == 0) {
    if (pthread_cond_init(&p->done, NULL) == 0) return true;
    pthread_cond_destroy(&p->work);
  }
  pthread_mutex_destroy(&p->lock);
  p->member = NULL;
  return false;
}

void mpsi_pool_end(mpsi_pool *p) {
  if (!p->member || (p->started > 0 && p->process != (long)getpid())) return;
  pthread_mutex_lock(&p->lock);
  p->quit = true;
  pthread_cond_broadcast(&p->work);
  pthread_mutex_unlock(&p->lock);
  for (int32_t k = 0; k < p->started; k++) pthread_join(p->member[k].thread, NULL);
  pthread_cond_destroy(&p->done);
  pthread_cond_destroy(&p->work);
  pthread_mutex_destroy(&p->lock);
}
