/* measure.h - what the benchmarks share: a clock, and an end with the library's own message.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef BENCH_MEASURE_H
#define BENCH_MEASURE_H

#include <mps/context.h>

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static inline double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static inline void check(mps_context *context, mps_status status, const char *what) {
  if (status == MPS_OK) return;
  fprintf(stderr, "bench: %s: %s\n", what,
          context ? mps_context_error(context)->message : mps_status_text(status));
  exit(1);
}

#endif
