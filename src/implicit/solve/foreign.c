/* foreign.c - see foreign.h. OpenBLAS and OpenMP are called through weak references: in a process
 * with other libraries nothing is set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "foreign.h"

#include <pthread.h>

#if defined(__GNUC__)
int openblas_get_num_threads(void) __attribute__((weak));
void openblas_set_num_threads(int threads) __attribute__((weak));
int omp_get_max_active_levels(void) __attribute__((weak));
void omp_set_max_active_levels(int levels) __attribute__((weak));
#define HAVE_BLAS_THREADS (openblas_get_num_threads && openblas_set_num_threads)
#define HAVE_OPENMP_LEVELS (omp_get_max_active_levels && omp_set_max_active_levels)
#else
static int openblas_get_num_threads(void) { return 1; }
static void openblas_set_num_threads(int threads) { (void)threads; }
static int omp_get_max_active_levels(void) { return 1; }
static void omp_set_max_active_levels(int levels) { (void)levels; }
#define HAVE_BLAS_THREADS 0
#define HAVE_OPENMP_LEVELS 0
#endif

/* ---- threads --------------------------------------------------------------------------------- */

static pthread_mutex_t threads_lock = PTHREAD_MUTEX_INITIALIZER;
static int inside, blas_before;
/* The OpenMP limit is the calling thread's own. */
static _Thread_local int levels_before = -1;

void mpsi_foreign_enter(int32_t threads) {
  if (threads == 1 && HAVE_OPENMP_LEVELS) {
    levels_before = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  if (!HAVE_BLAS_THREADS) return;
  pthread_mutex_lock(&threads_lock);
  const int now = openblas_get_num_threads();
  if (inside++ == 0) blas_before = now;
  if (threads < now) openblas_set_num_threads(threads);
  pthread_mutex_unlock(&threads_lock);
}

void mpsi_foreign_leave(void) {
  if (levels_before >= 0 && HAVE_OPENMP_LEVELS) {
    omp_set_max_active_levels(levels_before);
    levels_before = -1;
  }
  if (!HAVE_BLAS_THREADS) return;
  pthread_mutex_lock(&threads_lock);
  if (--inside == 0) openblas_set_num_threads(blas_before);
  pthread_mutex_unlock(&threads_lock);
}

/* ---- ARPACK ---------------------------------------------------------------------------------- */

static pthread_mutex_t arpack_lock = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local bool in_arpack;

bool mpsi_foreign_lock_arpack(void) {
  if (in_arpack) return false;
  pthread_mutex_lock(&arpack_lock);
  in_arpack = true;
  return true;
}

void mpsi_foreign_unlock_arpack(void) {
  in_arpack = false;
  pthread_mutex_unlock(&arpack_lock);
}
