/* test_domain_pairs.c - every collective function beside every other one: one rank calls the first,
 * the others the second. All get the same error, none waits, nothing is done, and the ranks
 * continue
 * together. SPDX-License-Identifier: BSD-3-Clause */
#include "ranks_team.h"

#include "collective_calls.h"

/* The last pair that a rank has called, and its status. */
typedef struct pairs {
  struct {
    int pairs, bad;
    char why[512];
  } rank[TEAM_MOST];
} pairs;

static void run_pairs(void *user, team *t, int32_t rank) {
  pairs *p = user;
  subject s = {.own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1)};
  const mps_domain_def def = team_domain_def(t, rank);
  mps_status status = mps_domain_create(s.own, &def, &s.domain);
  TRY(make_solvers(&s));
  snprintf(p->rank[rank].why, sizeof p->rank[rank].why, "%s", mps_context_error(s.own)->message);
  for (int a = 0; a < CALLS && status == MPS_OK; a++)
    for (int b = 0; b < CALLS && status == MPS_OK; b++) {
      if (are_same(a, b)) continue;
      status = call_beside(&s, a, b, p->rank[rank].why);
      p->rank[rank].pairs++;
    }
  p->rank[rank].bad = status;
  forget(&s);
  mps_domain_destroy(&s.domain);
  mps_context_destroy(&s.own);
}

static void check_team(int32_t size) {
  pairs p = {0};
  team t;
  team_begin(&t, size);
  team_run(&t, run_pairs, &p);
  for (int32_t r = 0; r < size; r++) {
    if (p.rank[r].bad == MPS_OK && !t.lost && !t.mixed) continue;
    fail_msg("rank %d of %d, pair %d: %s; %d%s", (int)r, (int)size, p.rank[r].pairs, p.rank[r].why,
             p.rank[r].bad,
             t.mixed  ? "; ranks are in different callbacks"
             : t.lost ? "; ranks wait for one another"
                      : "");
  }
  assert_true(p.rank[0].pairs >= CALLS * (CALLS - 1) - 2);
  team_end(&t);
}

TEST(test_pairs) {
  check_team(2);
  if (!test_quick()) check_team(3);
}
