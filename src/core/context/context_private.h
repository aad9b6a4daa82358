/* context_private.h - the members of a context, for the files of its errors, memory and threads
 * only. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"
#include "pool.h"

#define MPSI_MAX_THREADS 1024
#define MPSI_MOST_WARNINGS 32 /* that a context keeps */

struct mps_context {
  mps_context_def def;
  mps_error error;
  atomic_int executor_fault; /* the caller's executor gave a bad worker or index once */
  int64_t failures;          /* number of times `error` was written */
  int64_t warnings;
  mps_context_warning warning[MPSI_MOST_WARNINGS]; /* the first ones, each text once */
  int32_t threads;
  int32_t level;         /* of the instruction set of inner loops (levels.h) */
  atomic_int references; /* the caller's, and one for each existing object */
  mpsi_pool pool;        /* of MPS_CONTEXT_EXECUTOR_THREADS; its members lie behind the context */
};

/* library.c: the record of the last failure of this thread, of all contexts and of calls without
 * one. */
extern _Thread_local mps_error mpsi_thread_error;

/* memory.c: memory of the system where the caller gives no hooks. */
void mpsi_use_system_memory(mps_context_def *def);

/* Number of workers of the definition (0 resolved to the processors available). */
int32_t mpsi_executor_threads(const mps_context_def *def);

/* Tests the caller's executor: whether each unit runs once, with a valid worker number. */
bool mpsi_executor_probe(mps_context *context);
