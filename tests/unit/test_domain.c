/* test_domain.c - domains: exact sums, errors that all ranks share, gathering, partners that are
 * lost, memory that is refused.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "domain/domain_internal.h"
#include "domain_threads.h"

#include <float.h>

/* ---- exact sums ------------------------------------------------------------------------------ */

static double sum_of(int count, const double *terms) {
  mpsi_exact sum = {{0}};
  for (int k = 0; k < count; k++) mpsi_exact_add(&sum, terms[k]);
  return mpsi_exact_value(&sum);
}

TEST(test_exact_sums) {
  static const struct {
    double term[4], sum;
  } cases[] = {
      {{0.0, -0.0, 0.0, 0.0}, 0.0},
      {{1e300, 1.0, -1e300, 0.0}, 1.0},
      {{0x1p53, 1.0, 0.0, 0.0}, 0x1p53},                 /* half: to even */
      {{0x1p53, 1.0, 0x1p-1074, 0.0}, 0x1p53 + 2.0},     /* above half */
      {{0x1p53 + 2.0, 1.0, 0.0, 0.0}, 0x1p53 + 4.0},     /* half: to even */
      {{-0x1p53, -1.0, -0x1p-1074, 0.0}, -0x1p53 - 2.0}, /* the same below zero */
      {{0x1p-1074, 0x1p-1074, 0.0, 0.0}, 0x1p-1073},     /* not normalised */
      {{0x1p-1022, -0x1p-1074, 0.0, 0.0}, 0x1.ffffffffffffep-1023},
      {{DBL_MAX, DBL_MAX, -DBL_MAX, 0.0}, DBL_MAX},
      {{DBL_MAX, DBL_MAX, 0.0, 0.0}, INFINITY},
      {{-DBL_MAX, -DBL_MAX, 0.0, 0.0}, -INFINITY},
      {{INFINITY, 1.0, 0.0, 0.0}, INFINITY},
      {{-INFINITY, 1.0, 0.0, 0.0}, -INFINITY},
      {{0.1, 0.2, 0.3, -0.6}, 0.0}, /* see below */
  };
  const size_t count = sizeof cases / sizeof *cases;
  for (size_t k = 0; k + 1 < count; k++) {
    const double sum = sum_of(4, cases[k].term);
    if (memcmp(&sum, &cases[k].sum, sizeof sum) != 0)
      fail_msg("case %zu: %a, expected %a", k, sum, cases[k].sum);
  }
  /* against long double, which holds these four terms' sum exactly */
  const long double exact =
      (long double)0.1 + (long double)0.2 + (long double)0.3 - (long double)0.6;
  NEAR(sum_of(4, cases[count - 1].term), (double)exact, 0.0);
  const double infinities[2] = {INFINITY, -INFINITY}, none[1] = {NAN};
  assert_true(isnan(sum_of(2, infinities)));
  assert_true(isnan(sum_of(1, none)));
}

TEST(test_exact_sums_have_no_order) {
  enum { TERMS = 5000 };
  static double term[TERMS];
  uint64_t h = 1;
  for (int k = 0; k < TERMS; k++) {
    h = h * 6364136223846793005u + 1442695040888963407u;
    term[k] = ldexp((double)(int64_t)h, (int)(h >> 33 & 127) - 64 - 63);
  }
  mpsi_exact forth = {{0}}, back = {{0}}, part[3] = {{{0}}, {{0}}, {{0}}};
  for (int k = 0; k < TERMS; k++) {
    mpsi_exact_add(&forth, term[k]);
    mpsi_exact_add(&back, term[TERMS - 1 - k]);
    mpsi_exact_add(&part[h % 3], term[k]);
    h = h * 6364136223846793005u + 1442695040888963407u;
    if (k % 100 == 0) mpsi_exact_carry(&part[h % 3]);
  }
  for (int p = 1; p < 3; p++) {
    mpsi_exact_carry(&part[p]);
    for (int k = 0; k < MPSI_EXACT_LIMBS; k++) part[0].limb[k] += part[p].limb[k];
  }
  const double a = mpsi_exact_value(&forth), b = mpsi_exact_value(&back),
               c = mpsi_exact_value(&part[0]);
  assert_memory_equal(&a, &b, sizeof a);
  assert_memory_equal(&a, &c, sizeof a);
  for (int k = 0; k < TERMS; k++) mpsi_exact_add(&forth, -term[k]);
  NEAR(mpsi_exact_value(&forth), 0.0, 0.0);
}

/* ---- ranks ----------------------------------------------------------------------------------- */

/* What a rank has found: looked at when all threads have ended. */
typedef struct found {
  mps_status status[8];
  double value[8];
  char message[512];
  int64_t count;
  bool good;
} found;

typedef struct scene {
  found rank[TEAM_MOST];
  int what;
  int64_t refuse; /* allocation that rank 1 is refused, from 1; 0 none */
  test_allocator allocator[TEAM_MOST];
} scene;

static mps_context *rank_context(scene *s, int32_t rank) {
  s->allocator[rank].refuse_at = rank == 1 ? s->refuse : 0;
  return test_allocator_context(&s->allocator[rank]);
}

/* The domain of a rank, whose context it makes; the status of its creation is the first. */
static mps_domain *join_domain(scene *s, team *t, int32_t rank, mps_context **own) {
  const mps_domain_def def = team_domain_def(t, rank);
  mps_domain *domain = NULL;
  *own = rank_context(s, rank);
  s->rank[rank].status[0] = mps_domain_create(*own, &def, &domain);
  return domain;
}

static void run_sums(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  mpsi_exact sum = {{0}};
  mpsi_exact_add(&sum, ldexp(1.0, 60 * rank));
  mpsi_exact_add(&sum, -1e-3);
  f->status[1] = mpsi_domain_sum_exact(domain, "test", 1, &sum);
  f->value[0] = mpsi_exact_value(&sum);
  double most[2] = {rank, -rank};
  f->status[2] = mps_domain_max(domain, 2, most);
  f->value[1] = most[0];
  f->value[2] = most[1];
  f->status[3] = mps_domain_agree(domain, MPS_OK);
  f->good = mps_domain_rank(domain) == rank && mps_domain_size(domain) == t->size;
}

TEST(test_reductions) {
  for (int32_t size = 1; size <= 7; size += 3) {
    scene s = {.what = 0};
    team_compute(size, run_sums, &s);
    mpsi_exact sum = {{0}};
    for (int32_t r = 0; r < size; r++) {
      mpsi_exact_add(&sum, ldexp(1.0, 60 * r));
      mpsi_exact_add(&sum, -1e-3);
    }
    for (int32_t r = 0; r < size; r++) {
      for (int k = 0; k < 4; k++) assert_int_equal(s.rank[r].status[k], MPS_OK);
      NEAR(s.rank[r].value[0], mpsi_exact_value(&sum), 0.0);
      NEAR(s.rank[r].value[1], size - 1, 0.0);
      NEAR(s.rank[r].value[2], 0.0, 0.0);
      assert_true(s.rank[r].good);
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}

/* Rank 2 fails by argument, rank 3 by memory: all get the higher status with its record. */
static void run_errors(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  mps_status status = MPS_OK;
  if (rank == 2) status = mpsi_fail(own, "mps_two", MPS_ERROR_ARGUMENT, "two is %d", 2);
  if (rank == 3) {
    status = mpsi_fail(own, "mps_three", MPS_ERROR_MEMORY, "three is %d", 3);
    mpsi_fail_where(own, 17, 33);
    mpsi_fail_object(own, "body 3");
  }
  f->status[1] = mpsi_domain_agree(domain, "outer", mpsi_domain_agree(domain, "test", status));
  const mps_error *error = mps_context_error(own);
  f->good = error->step == 17 && error->particle == 33 && strcmp(error->object, "body 3") == 0 &&
            strcmp(error->function, "mps_three") == 0;
  snprintf(f->message, sizeof f->message, "%s", error->message);
  f->status[2] = mpsi_domain_agree_same(domain, "test", MPS_OK, "dt", rank == 1 ? NAN : 1e-3);
  f->status[3] = mpsi_domain_agree_same(domain, "test", MPS_OK, "dt", NAN);
  f->status[4] = mps_domain_agree(domain, rank == 0 ? MPS_ERROR_IO : MPS_OK); /* no record */
}

TEST(test_errors_are_shared) {
  scene s = {.what = 0};
  team_compute(4, run_errors, &s);
  for (int32_t r = 0; r < 4; r++) {
    assert_int_equal(s.rank[r].status[0], MPS_OK);
    assert_int_equal(s.rank[r].status[1], MPS_ERROR_MEMORY);
    assert_true(s.rank[r].good);
    assert_string_equal(s.rank[r].message, "rank 3: three is 3");
    assert_int_equal(s.rank[r].status[2], MPS_ERROR_ARGUMENT);
    assert_int_equal(s.rank[r].status[3], MPS_OK);
    assert_int_equal(s.rank[r].status[4], MPS_ERROR_IO);
    assert_int_equal(s.allocator[r].live, 0);
  }
}

/* ---- gathering ------------------------------------------------------------------------------- */

/* Every rank makes 4 x 3 particles and keeps those whose id is its own modulo size, and id 0. */
static mps_status make_share(mps_context *own, int32_t rank, int32_t size, mps_particles **out) {
  DEF(particles, def, .spacing = 0.5);
  mps_status status = mps_particles_create(own, &def, out);
  if (status == MPS_OK) status = mps_particles_fill_box(*out, AT(0.0, 0.0), AT(2.0, 1.5), NULL);
  if (status == MPS_OK) status = mps_particles_set(*out, "density", 0, 1000.0 + rank);
  int64_t gone[12], count = 0;
  for (int64_t id = 1; id < 12; id++)
    if (id % size != rank) gone[count++] = id;
  if (status == MPS_OK) status = mps_particles_remove(*out, gone, count);
  return status;
}

static void run_gather(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  scoped_particles *share = NULL, *whole = NULL;
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  if (f->status[0] == MPS_OK)
    f->status[1] = mps_domain_agree(domain, make_share(own, rank, t->size, &share));
  if (f->status[0] == MPS_OK && f->status[1] == MPS_OK) {
    if (s->what == 1 && rank == 1)
      f->status[3] = mps_particles_set(share, "pressure", 0, 1.0); /* others lack it */
    f->status[2] = mps_domain_gather_fields(domain, share, 0, NULL, &whole);
    f->count = mps_particles_count(whole);
    f->good = true;
    int32_t before = 0;
    for (int64_t k = 0; k < f->count; k++) {
      mps_view id, density, position;
      f->status[4] = mps_particles_view(whole, "id", &id);
      f->status[5] = mps_particles_view(whole, "density", &density);
      f->status[6] = mps_particles_view(whole, "position", &position);
      const int64_t i = *mps_view_i64(&id, k, 0);
      const int32_t from = (int32_t)(*mps_view_f64(&density, k, 0) - 1000.0);
      f->good = f->good && (i == 0 ? from == t->size - 1 : from == i % t->size) && from >= before &&
                *mps_view_f64(&position, k, 0) == 0.25 + 0.5 * (double)(i % 4) &&
                mps_particles_index(whole, i) == k;
      before = from;
    }
    const uint64_t epoch = mps_particles_epoch(whole);
    if (f->status[2] == MPS_OK)
      f->status[7] = mps_domain_gather_fields(domain, share, 0, NULL, &whole);
    f->good = f->good && epoch == mps_particles_epoch(whole); /* views stay good */
  }
  snprintf(f->message, sizeof f->message, "%s", mps_context_error(own)->message);
}

/* On 1, 3 and 5 ranks: all well, and the twelve particles on rank 0. */
static void assert_gathered(team_fn work) {
  for (int32_t size = 1; size <= 5; size += 2) {
    scene s = {.what = 0};
    team_compute(size, work, &s);
    for (int32_t r = 0; r < size; r++) {
      for (int k = 0; k < 8; k++) assert_int_equal(s.rank[r].status[k], MPS_OK);
      assert_int_equal(s.rank[r].count, r == 0 ? 12 : 0);
      assert_true(s.rank[r].good);
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}

TEST(test_gather) {
  assert_gathered(run_gather);
  scene s = {.what = 1};
  team_compute(2, run_gather, &s);
  for (int32_t r = 0; r < 2; r++) {
    assert_int_equal(s.rank[r].status[2], MPS_ERROR_FIELD);
    assert_non_null(strstr(s.rank[r].message, "the set has 3 fields"));
  }
}

/* Named fields alone, and values of a list of particles on all ranks. */
static void run_fields(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  static const char *const wanted[] = {"density"}, *const wrong[] = {"density", "density_of"};
  const int64_t ids[4] = {7, 0, 3, 7}, missing[2] = {3, 99}, other[1] = {rank};
  double density[4] = {0.0}, place[8] = {0.0}, id[4] = {0.0};
  scoped_particles *share = NULL, *whole = NULL;
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  f->status[1] = mps_domain_agree(domain, make_share(own, rank, t->size, &share));
  f->status[2] = mps_domain_agree(domain, mps_particles_set(share, "pressure", 0, 1.0));
  f->status[3] = mps_domain_gather_fields(domain, share, 1, wanted, &whole);
  f->status[4] = mps_domain_get_field(domain, share, "density", ids, 4, density);
  f->status[5] = mps_domain_get_field(domain, share, "position", ids, 4, place);
  f->status[6] = mps_domain_get_field(domain, share, "id", ids, 4, id);
  f->count = mps_particles_count(whole);
  f->good = mps_particles_field_count(whole) == (rank == 0 ? 3 : 0);
  for (int k = 0; k < 4; k++) {
    const int32_t from = (int32_t)(ids[k] == 0 ? t->size - 1 : ids[k] % t->size);
    f->good = f->good && density[k] == 1000.0 + from && id[k] == (double)ids[k] &&
              place[2 * k] == 0.25 + 0.5 * (double)(ids[k] % 4) &&
              place[2 * k + 1] == 0.25 + 0.5 * (double)(ids[k] / 4);
  }
  f->good = f->good &&
            mps_domain_get_field(domain, share, "id", missing, 2, id) == MPS_ERROR_ARGUMENT &&
            mps_domain_get_field(domain, share, "none", ids, 4, id) == MPS_ERROR_FIELD &&
            mps_domain_gather_fields(domain, share, 2, wrong, &whole) == MPS_ERROR_FIELD &&
            mps_domain_gather_fields(domain, share, rank == 0, wanted, &whole) ==
                (t->size > 1 ? MPS_ERROR_FIELD : MPS_OK);
  if (t->size > 1)
    f->good =
        f->good && mps_domain_get_field(domain, share, "id", other, 1, id) == MPS_ERROR_ARGUMENT;
  f->status[7] = mps_domain_get_field(domain, share, "id", NULL, 0, NULL);
}

TEST(test_fields) { assert_gathered(run_fields); }

/* One rank is refused one allocation after the other: all ranks report it, none hangs. */
TEST(test_refused_memory) {
  for (int64_t refuse = 3;; refuse++) { /* 1: the context, 2: the domain, which none knows yet */
    scene s = {.refuse = refuse};
    team t;
    team_begin(&t, 3);
    team_run(&t, run_gather, &s);
    team_end(&t);
    assert_false(t.lost);
    const mps_status worst = s.rank[1].status[1]   ? s.rank[1].status[1]
                             : s.rank[1].status[2] ? s.rank[1].status[2]
                                                   : s.rank[1].status[7];
    for (int32_t r = 0; r < 3; r++) {
      assert_int_equal(s.allocator[r].live, 0);
      for (int k = 1; k < 8; k++)
        if (k == 1 || k == 2 || k == 7) assert_int_equal(s.rank[r].status[k], s.rank[1].status[k]);
      if (worst != MPS_OK) assert_non_null(strstr(s.rank[r].message, "rank 1: "));
    }
    if (worst == MPS_OK) break;
    assert_int_equal(worst, MPS_ERROR_MEMORY);
    assert_true(refuse < 200);
  }
}

/* Ranks in different calls: each gets an error that names both, nothing waits, and they continue.
 */
static void run_calls(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  scoped_particles *share = NULL, *whole = NULL;
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  double value = rank;
  f->status[1] = rank == 1 ? mps_domain_max(domain, 1, &value) : mps_domain_agree(domain, MPS_OK);
  snprintf(f->message, sizeof f->message, "%s", mps_context_error(own)->message);
  f->good =
      f->status[1] == MPS_OK || strcmp(mps_context_error(own)->function,
                                       rank == 1 ? "mps_domain_max" : "mps_domain_agree") == 0;
  f->status[2] = make_share(own, rank, t->size, &share);
  f->status[3] = rank == 0 ? mps_domain_gather_fields(domain, share, 0, NULL, &whole)
                           : mps_domain_get_field(domain, share, "id", NULL, 0, NULL);
  f->status[4] = mps_domain_max(domain, 1, &value); /* they are together again */
  f->value[0] = value;
  if (rank == 2) mps_domain_destroy(&domain);
  f->status[5] = rank == 2 ? MPS_ERROR_STATE : mps_domain_agree(domain, MPS_OK);
  if (rank != 2)
    f->good = f->good && strstr(mps_context_error(own)->message, "rank 2 has destroyed its domain");
  f->status[6] = rank == 2 ? MPS_ERROR_STATE : mps_domain_max(domain, 1, &value);
}

TEST(test_different_calls) {
  static const mps_status expected[7] = {MPS_OK, MPS_ERROR_STATE, MPS_OK,         MPS_ERROR_STATE,
                                         MPS_OK, MPS_ERROR_STATE, MPS_ERROR_STATE};
  for (int32_t size = 3; size <= 7; size += 2) {
    scene s = {.what = 0};
    team t;
    team_begin(&t, size);
    team_run(&t, run_calls, &s);
    assert_false(t.lost);
    assert_false(t.mixed);
    team_end(&t);
    for (int32_t r = 0; r < size; r++) {
      for (int k = 0; k < 7; k++)
        if (s.rank[r].status[k] != expected[k])
          fail_msg("rank %d, call %d: %d %s", (int)r, k, (int)s.rank[r].status[k],
                   s.rank[r].message);
      assert_true(s.rank[r].good);
      assert_string_equal(s.rank[r].message, s.rank[0].message);
      assert_non_null(strstr(s.rank[r].message,
                             "rank 0 has called mps_domain_agree and rank 1 mps_domain_max"));
      NEAR(s.rank[r].value[0], size - 1, 0.0);
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}

/* A rank that falls silent: the others give up after the limit, with an error. */
static void run_lost(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  scoped_context *own = NULL;
  scoped_domain *domain = join_domain(s, t, rank, &own);
  for (int k = 1; domain && k < 4; k++) f->status[k] = mps_domain_agree(domain, MPS_OK);
  snprintf(f->message, sizeof f->message, "%s", mps_context_error(own)->message);
}

TEST(test_lost_partner) {
  for (int64_t deaf = 1; deaf <= 6; deaf++) {
    scene s = {.what = 0};
    team t;
    team_begin(&t, 3);
    t.member[2].deaf_at = deaf;
    team_run(&t, run_lost, &s);
    team_end(&t);
    for (int32_t r = 0; r < 3; r++) {
      const mps_status last = s.rank[r].status[0] ? s.rank[r].status[0] : s.rank[r].status[3];
      assert_int_equal(last, MPS_ERROR_IO);
      assert_non_null(strstr(s.rank[r].message, "lost one another"));
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}

/* ---- arguments ------------------------------------------------------------------------------- */

TEST(test_arguments) {
  scoped_domain *domain = NULL;
  team t;
  team_begin(&t, 1);
  mps_domain_def def = team_domain_def(&t, 0);
  assert_int_equal(mps_domain_create(NULL, &def, &domain), MPS_ERROR_ARGUMENT);
  REFUSES(mps_domain_create(context, NULL, &domain), "NULL");
  REFUSES(mps_domain_create(context, &def, NULL), "out");
  OK(mps_domain_create(context, &def, &domain));
  double value[1] = {NAN};
  REFUSES(mps_domain_max(domain, 1, value), "NaN");
  REFUSES(mps_domain_max(domain, 1, NULL), "NULL");
  mps_particles *whole = NULL;
  REFUSES(mps_domain_gather_fields(domain, NULL, 0, NULL, &whole), "particles is NULL");
  assert_int_equal(mps_domain_agree(NULL, MPS_OK), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_domain_rank(NULL), -1);
  assert_int_equal(mps_domain_size(NULL), 0);
  mps_domain_destroy(&domain);
  team_end(&t);
}
