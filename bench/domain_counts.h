/* domain_counts.h - what a program waits for and sends on MPI, counted by functions of MPI's names
 * that replace the ones called by libmps-petsc and PETSc (MPI's profiling interface).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef BENCH_DOMAIN_COUNTS_H
#define BENCH_DOMAIN_COUNTS_H

#include <stdint.h>

/* Of this rank since domain_counts_reset. */
typedef struct domain_counts {
  double reducing, waiting,
      posting; /* s: in reductions, for messages to come and go, to send them */
  int64_t reductions, messages, bytes; /* of messages that this rank sends */
} domain_counts;

extern domain_counts domain_count;

#endif
