/* ranks_team.h - a scene computed by teams of ranks that are threads, compared with the run without
 * a domain, with one rank that is refused its memory, and in other troubles.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_RANKS_TEAM_H
#define MPS_TEST_RANKS_TEAM_H

#include "test_allocator.h"

#include "domain_threads.h"
#include "ranks_result.h"

typedef struct ranks {
  result_fn *compute;
  int what;
  int32_t threads;        /* of each rank */
  int64_t length, refuse; /* refuse: allocation that rank 1 is refused, from 1; 0 none */
  result rank[TEAM_MOST];
  test_allocator allocator[TEAM_MOST];
} ranks;

static inline void run_rank(void *user, team *t, int32_t rank) {
  ranks *s = user;
  result *r = &s->rank[rank];
  mps_context_def def = test_context_defaults();
  scoped_context *own = NULL;
  scoped_domain *domain = NULL;
  def.executor = s->threads > 1 ? MPS_CONTEXT_EXECUTOR_THREADS : MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = s->threads;
  s->allocator[rank].refuse_at = rank == 1 ? s->refuse : 0;
  if (s->threads == 1) test_allocator_use(&def, &s->allocator[rank]);
  r->status = mps_context_create(&def, &own, NULL, 0);
  const mps_domain_def domain_def = team_domain_def(t, rank);
  if (r->status == MPS_OK) r->status = mps_domain_create(own, &domain_def, &domain);
  if (r->status == MPS_OK) r->status = s->compute(own, domain, s->what, s->length, r);
  if (own) snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
}

static inline void run_team(ranks *s, int32_t size) { team_compute(size, run_rank, s); }

/* Every particle was on one of `size` ranks or, with `shared`, may have been on all of them, as the
 * columns of a free field are. */
static inline void check_seen(const result *alone, const int64_t *seen, int32_t size, bool shared) {
  for (int64_t i = 0; i < alone->count; i++)
    if (seen[i] != 1 && !(shared && seen[i] == size))
      fail_msg("particle %lld is on %lld ranks", (long long)alone->id[i], (long long)seen[i]);
}

/* Runs `s` on a team, whose ranks have the bits of the run without a domain. */
static inline void compare_team(ranks *s, int32_t size, const result *alone, bool shared) {
  int64_t *seen = calloc((size_t)alone->count + 1, sizeof *seen);
  run_team(s, size);
  for (int32_t r = 0; r < size; r++) {
    if (s->rank[r].status != MPS_OK) fail_msg("rank %d: %s", (int)r, s->rank[r].message);
    compare(alone, &s->rank[r], seen);
    drop(&s->rank[r]);
    assert_int_equal(s->allocator[r].live, 0);
  }
  check_seen(alone, seen, size, shared);
  free(seen);
}

/* A part of a run, as that before or after a checkpoint, on ranks of one thread. */
static inline void compare_part(result_fn *part, int32_t size, int what, int64_t length,
                                const result *alone, bool shared) {
  ranks s = {.compute = part, .what = what, .threads = 1, .length = length};
  compare_team(&s, size, alone, shared);
}

/* On teams of several sizes and numbers of threads; `few`: not on one and on four ranks; quick:
 * two. */
static inline void compare_teams(result_fn *run, int what, int64_t length, bool few) {
  static const struct {
    int32_t ranks, threads;
  } teams[] = {{2, 1}, {3, 2}, {7, 3}, {15, 1}, {1, 1}, {4, 1}};
  result alone = {.count = 0};
  mps_context *serial = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  OK(run(serial, NULL, what, length, &alone));
  mps_context_destroy(&serial);
  for (int k = 0; k < (test_quick() ? 2 : few ? 4 : 6); k++) {
    ranks s = {.compute = run, .what = what, .threads = teams[k].threads, .length = length};
    compare_team(&s, teams[k].ranks, &alone, true);
  }
  drop(&alone);
}

/* Rank 1 of three is refused one allocation after the other, `stride` apart after the first 60: all
 * ranks report it, and none hangs. The first two are those before there is a domain. */
static inline void refuse_memory(result_fn *run, int what, int64_t length, int64_t stride) {
  mps_status worst = MPS_ERROR_MEMORY;
  for (int64_t refuse = 3; worst != MPS_OK;
       refuse += refuse < 60 ? test_refusals_apart() : stride * (test_quick() ? 5 : 1)) {
    ranks s = {.compute = run, .what = what, .threads = 1, .length = length, .refuse = refuse};
    run_team(&s, 3);
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

/* What ranks do not agree upon, what fails on one of them, what is refused: `run` makes the
 * trouble. */
typedef mps_status trouble_fn(mps_context *context, mps_domain *domain, int what, int32_t rank);

typedef struct trouble_case {
  mps_status status;
  const char *text; /* in the message of every rank */
} trouble_case;

/* From one table of rows (name, status, text): the names, and the cases. */
#define CASE_NAME(name, ...) name,
#define CASE_ROW(name, ...) [name] = {__VA_ARGS__},

typedef struct troubled {
  trouble_fn *run;
  int what;
  mps_status status[3];
  char message[3][sizeof(((mps_error *)0)->message)];
} troubled;

static inline void run_troubled(void *user, team *t, int32_t rank) {
  troubled *s = user;
  scoped_domain *domain = NULL;
  scoped_context *own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_domain_def def = team_domain_def(t, rank);
  s->status[rank] = mps_domain_create(own, &def, &domain);
  if (s->status[rank] == MPS_OK) s->status[rank] = s->run(own, domain, s->what, rank);
  snprintf(s->message[rank], sizeof s->message[rank], "%s", mps_context_error(own)->message);
}

/* Each of them is the same error on all of three ranks. */
static inline void meet_troubles(trouble_fn *run, const trouble_case *list, int count) {
  int bad = 0;
  for (int what = 0; what < count; what++) {
    troubled s = {.run = run, .what = what};
    team_compute(3, run_troubled, &s);
    for (int32_t r = 0; r < 3; r++)
      if (s.status[r] != list[what].status || !strstr(s.message[r], list[what].text)) {
        print_error("trouble %d, rank %d: %d %s\n", what, (int)r, (int)s.status[r], s.message[r]);
        bad++;
      }
  }
  assert_int_equal(bad, 0);
}

#endif
