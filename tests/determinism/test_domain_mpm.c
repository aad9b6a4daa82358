/* test_domain_mpm.c - WLS-MPM on several ranks: every particle has the bits of the run without a
 * domain, on whatever number of ranks and threads; and an error of one rank is an error of all.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"

#include "domain_threads.h"
#include "mpm_ranks.h"

typedef struct ranks {
  int what;
  int32_t threads;
  int64_t steps, refuse; /* refuse: allocation that rank 1 is refused, from 1; 0 none */
  result rank[TEAM_MOST];
  test_allocator allocator[TEAM_MOST];
} ranks;

static void run_rank(void *user, team *t, int32_t rank) {
  ranks *s = user;
  result *r = &s->rank[rank];
  mps_context_def def = test_context_defaults();
  mps_context *own = NULL;
  mps_domain *domain = NULL;
  def.executor = s->threads > 1 ? MPS_EXECUTOR_THREADS : MPS_EXECUTOR_SERIAL;
  def.threads = s->threads;
  s->allocator[rank].refuse_at = rank == 1 ? s->refuse : 0;
  if (s->threads == 1) test_allocator_use(&def, &s->allocator[rank]);
  r->status = mps_context_create(&def, &own, NULL, 0);
  const mps_domain_def domain_def = team_domain_def(t, rank);
  if (r->status == MPS_OK) r->status = mps_domain_create(own, &domain_def, &domain);
  if (r->status == MPS_OK) r->status = compute(own, domain, s->what, s->steps, r);
  if (own) snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void run_team(ranks *s, int32_t size, double limit) {
  team t;
  team_begin(&t, size);
  t.limit = limit;
  team_run(&t, run_rank, s);
  team_end(&t);
}

static void compare_scene(int what, int64_t steps) {
  static const struct {
    int32_t ranks, threads;
  } teams[] = {{2, 1}, {3, 2}, {1, 1}, {4, 1}, {7, 3}, {15, 1}};
  result alone = {.count = 0};
  mps_context *serial = test_context(MPS_EXECUTOR_SERIAL, 1);
  mps_assert_ok(serial, compute(serial, NULL, what, steps, &alone));
  mps_context_destroy(&serial);
  for (size_t k = 0; k < sizeof teams / sizeof *teams; k++) {
    ranks s = {.what = what, .threads = teams[k].threads, .steps = steps};
    int64_t *seen = calloc((size_t)alone.count, sizeof *seen);
    run_team(&s, teams[k].ranks, 60.0);
    for (int32_t r = 0; r < teams[k].ranks; r++) {
      if (s.rank[r].status != MPS_OK) fail_msg("rank %d: %s", (int)r, s.rank[r].message);
      compare(&alone, &s.rank[r], seen);
      drop(&s.rank[r]);
      assert_int_equal(s.allocator[r].live, 0);
    }
    for (int64_t i = 0; i < alone.count; i++) assert_int_equal(seen[i], 1);
    free(seen);
  }
  drop(&alone);
}

static void test_slide(void **state) { (void)state, compare_scene(SLIDE, 200); }

static void test_spread(void **state) { (void)state, compare_scene(SPREAD, 120); }
static void test_ring(void **state) { (void)state, compare_scene(RING, 80); }
static void test_room(void **state) { (void)state, compare_scene(ROOM, 60); }

/* ---- what goes wrong on one rank --------------------------------------------------------------
 */

/* Rank 1 is refused one allocation after the other: all ranks report it, and none hangs. */
static void test_refused_memory(void **state) {
  (void)state;
  mps_status worst = MPS_ERROR_MEMORY;
  for (int64_t refuse = 3; worst != MPS_OK; refuse += refuse < 60 ? 1 : 7) {
    ranks s = {.what = SPREAD, .threads = 1, .steps = 30, .refuse = refuse};
    run_team(&s, 3, 10.0);
    worst = s.rank[1].status;
    for (int32_t r = 0; r < 3; r++) {
      if (s.rank[r].status != worst || (worst && !strstr(s.rank[r].message, "rank 1: ")))
        fail_msg("allocation %d, rank %d: %d %s", (int)refuse, (int)r, (int)s.rank[r].status,
                 s.rank[r].message);
      assert_int_equal(s.allocator[r].live, 0);
      drop(&s.rank[r]);
    }
    assert_true(worst == MPS_OK || worst == MPS_ERROR_MEMORY);
    assert_true(refuse < 5000);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_slide), cmocka_unit_test(test_spread),
                                     cmocka_unit_test(test_ring), cmocka_unit_test(test_room),
                                     cmocka_unit_test(test_refused_memory)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
