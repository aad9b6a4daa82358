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

/* One after the other, what ranks do not agree upon, what fails on one of them, what is refused. */
enum {
  OTHER_SET,
  OTHER_DT,
  OTHER_COUNT,
  CANCELLED,
  CALLBACK_FAILS,
  UNKNOWN_ID,
  CONTACT,
  CELLS,
  TROUBLES
};
static const struct {
  mps_status status;
  const char *text;
} trouble[TROUBLES] = {
    [OTHER_SET] = {MPS_ERROR_ARGUMENT, "a hash of the set's particles"},
    [OTHER_DT] = {MPS_ERROR_ARGUMENT, "a hash of the solver's definition"},
    [OTHER_COUNT] = {MPS_ERROR_ARGUMENT, "count is "},
    [CANCELLED] = {MPS_ERROR_CANCELLED, "stopped by the cancel hook at step 1"},
    [CALLBACK_FAILS] = {MPS_ERROR_IO, "rank 2: "},
    [UNKNOWN_ID] = {MPS_ERROR_ARGUMENT, "of 2 ids 1 are of particles of the set on any rank"},
    [CONTACT] = {MPS_ERROR_UNSUPPORTED, "contact with bodies cannot be had on several ranks"},
    [CELLS] = {MPS_ERROR_UNSUPPORTED, "volumetric is 1"},
};

static mps_status refuse_callback(void *user, mps_mpm *mpm) {
  return *(const int32_t *)user == 2 && mps_mpm_steps(mpm) > 0 ? MPS_ERROR_IO : MPS_OK;
}

static int32_t cancel(void *user) { return *(const int32_t *)user == 1; }

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what, int32_t rank) {
  scene s = {.set = NULL};
  mps_body *body = NULL;
  mps_mpm_def def = scene_def(domain, SLIDE);
  if (what == OTHER_DT) def.dt = 1e-5 * (1.0 + rank);
  if (what == CELLS) def.volumetric = MPS_MPM_VOLUMETRIC_CELL;
  mps_status status = make_set(own, SLIDE, &s.set);
  if (what == OTHER_SET && rank == 1) TRY(mps_particles_set(s.set, "density", 0, 2000.0));
  TRY(mps_material_linear_elastic(own, 1e6, 0.3, &s.material[0]));
  const double up[3] = {0.0, 1.0, 0.0};
  const mps_body_def body_def = mps_body_defaults();
  TRY(mps_body_create_half_space(own, &body_def, up, &body));
  status = mps_domain_agree(domain, status);
  const int64_t before = mps_particles_count(s.set);
  TRY(mps_mpm_create(own, s.set, s.material[0], &def, &s.mpm));
  if (status != MPS_OK && mps_particles_count(s.set) != before) status = MPS_ERROR_INTERNAL;
  if (what == OTHER_COUNT) TRY(mps_mpm_step(s.mpm, 1 + rank));
  if (what == CANCELLED) {
    mps_context_set_cancel(own, cancel, &rank);
    TRY(mps_mpm_step(s.mpm, 10));
  }
  if (what == CALLBACK_FAILS) TRY(mps_mpm_run(s.mpm, 1.0, 5, refuse_callback, &rank));
  if (what == UNKNOWN_ID) {
    mps_mpm_boundary_def boundary = mps_mpm_boundary_defaults();
    const int64_t ids[2] = {17, 123456};
    int32_t number;
    boundary.ids = ids, boundary.id_count = 2;
    TRY(mps_mpm_add_boundary(s.mpm, &boundary, &number));
  }
  if (what == CONTACT) TRY(mps_mpm_add_contact(s.mpm, body, NULL, NULL));
  end_scene(&s);
  mps_body_destroy(&body);
  return status;
}

static void run_troubled(void *user, team *t, int32_t rank) {
  ranks *s = user;
  result *r = &s->rank[rank];
  mps_domain *domain = NULL;
  mps_context *own = team_context(MPS_EXECUTOR_SERIAL, 1);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK) r->status = run_trouble(own, domain, s->what, rank);
  snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void test_troubles(void **state) {
  (void)state;
  for (int what = 0; what < TROUBLES; what++) {
    ranks s = {.what = what};
    team t;
    team_begin(&t, 3);
    team_run(&t, run_troubled, &s);
    team_end(&t);
    for (int32_t r = 0; r < 3; r++)
      if (s.rank[r].status != trouble[what].status ||
          !strstr(s.rank[r].message, trouble[what].text))
        fail_msg("trouble %d, rank %d: %d %s", what, (int)r, (int)s.rank[r].status,
                 s.rank[r].message);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slide),          cmocka_unit_test(test_spread),
      cmocka_unit_test(test_ring),           cmocka_unit_test(test_room),
      cmocka_unit_test(test_refused_memory), cmocka_unit_test(test_troubles)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
