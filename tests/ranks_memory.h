/* ranks_memory.h - the most memory that a rank of a team ever has while it computes.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_RANKS_MEMORY_H
#define MPS_TEST_RANKS_MEMORY_H

#include "peak_allocator.h"
#include "ranks_team.h"

/* What is computed on each rank; `domain` NULL: by one alone. The allocator is the context's. */
typedef mps_status memory_fn(mps_context *own, mps_domain *domain, const peak_allocator *allocator,
                             void *user);

typedef struct memory_peaks {
  memory_fn *run;
  void *user;
  int64_t most[TEAM_MOST]; /* bytes */
  mps_status status[TEAM_MOST];
} memory_peaks;

static inline void memory_measure(void *user, team *t, int32_t rank) {
  memory_peaks *p = user;
  peak_allocator allocator = {0};
  mps_context *own = NULL;
  mps_domain *domain = NULL;
  mps_context_def def = test_context_defaults();
  const mps_domain_def domain_def = team_domain_def(t, rank);
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  peak_use(&def, &allocator);
  mps_status status = mps_context_create(&def, &own, NULL, 0);
  TRY(mps_domain_create(own, &domain_def, &domain));
  TRY(p->run(own, t->size > 1 ? domain : NULL, &allocator, p->user));
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
  p->status[rank] = status, p->most[rank] = allocator.most;
}

/* Bytes of the rank that has most, of `size` ranks. */
static inline int64_t memory_most(int32_t size, memory_fn *run, void *user) {
  memory_peaks p = {.run = run, .user = user};
  team t;
  int64_t most = 0;
  team_begin(&t, size);
  team_run(&t, memory_measure, &p);
  team_end(&t);
  for (int32_t r = 0; r < size; r++) {
    assert_int_equal(p.status[r], MPS_OK);
    most = p.most[r] > most ? p.most[r] : most;
  }
  return most;
}

#endif
