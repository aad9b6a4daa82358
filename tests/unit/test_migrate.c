/* test_migrate.c - blocks along Hilbert's curve, its cut among ranks, and particles that move to
 * the ranks that own them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "domain/curve.h"
#include "domain/migrate.h"
#include "domain_threads.h"

/* ---- the curve ------------------------------------------------------------------------------- */

/* The first 2^(dim n) keys fill the cube of 2^n blocks a side at the origin, each block once, and
 * each beside the one before. */
static void check_curve(int32_t dim, int32_t side) {
  int64_t keys = 1;
  for (int32_t d = 0; d < dim; d++) keys *= side;
  unsigned char *seen = calloc((size_t)keys, 1);
  int32_t last[3] = {0, 0, 0};
  for (int64_t key = 0; key < keys; key++) {
    int32_t at[3] = {0, 0, 0};
    mpsi_curve_block(dim, key, at);
    assert_int_equal(mpsi_curve_key(dim, at), key);
    int64_t place = 0;
    int32_t away = 0;
    for (int32_t d = 0; d < dim; d++) {
      assert_in_range(at[d], 0, side - 1);
      place = place * side + at[d];
      away += abs(at[d] - last[d]);
      last[d] = at[d];
    }
    assert_int_equal(seen[place]++, 0);
    assert_int_equal(away, key > 0 ? 1 : 0);
  }
  free(seen);
}

TEST(test_curve_is_a_walk) {
  check_curve(2, 256);
  check_curve(3, 32);
}

/* The same at places drawn from the whole curve, its ends among them. */
TEST(test_curve_far_out) {
  uint64_t h = 1;
  for (int32_t dim = 2; dim <= 3; dim++)
    for (int k = 0; k < 2000; k++) {
      h = h * 6364136223846793005u + 1442695040888963407u;
      int64_t key = (int64_t)(h >> 4) % (MPSI_CURVE_END - 1);
      if (k == 0) key = 0;
      if (k == 1) key = MPSI_CURVE_END - 2;
      int32_t here[3] = {0}, next[3] = {0}, away = 0;
      mpsi_curve_block(dim, key, here);
      mpsi_curve_block(dim, key + 1, next);
      assert_int_equal(mpsi_curve_key(dim, here), key);
      assert_int_equal(mpsi_curve_key(dim, next), key + 1);
      for (int32_t d = 0; d < dim; d++) {
        away += abs(here[d] - next[d]);
        assert_in_range(here[d], 0, MPSI_CURVE_SIDE(dim) - 1);
      }
      assert_int_equal(away, 1);
    }
}

/* ---- ranks ----------------------------------------------------------------------------------- */

enum { MOST_BLOCKS = 600, MOST_ROWS = 400, COLUMNS = 3 };

typedef struct found {
  mps_status status[6];
  char message[512];
  int64_t first[TEAM_MOST + 1];
  int64_t count, id[MOST_ROWS];
  double value[MOST_ROWS], half[MOST_ROWS];
} found;

typedef struct scene {
  found rank[TEAM_MOST];
  int what;
  int64_t refuse; /* allocation that rank 1 is refused, from 1; 0 none */
  test_allocator allocator[TEAM_MOST];
  int64_t blocks, key[MOST_BLOCKS], weight[MOST_BLOCKS]; /* of all ranks, ascending */
} scene;

static mps_domain *rank_domain(scene *s, team *t, int32_t rank, mps_context **own) {
  mps_domain *domain = NULL;
  s->allocator[rank].refuse_at = rank == 1 ? s->refuse : 0;
  *own = test_allocator_context(&s->allocator[rank]);
  const mps_domain_def def = team_domain_def(t, rank);
  s->rank[rank].status[0] = mps_domain_create(*own, &def, &domain);
  return domain;
}

static void end_rank(found *f, mps_domain *domain, mps_context *own) {
  snprintf(f->message, sizeof f->message, "%s", mps_context_error(own)->message);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void run_team(scene *s, int32_t size, team_fn run) {
  static team t;
  team_begin(&t, size);
  team_run(&t, run, s);
  assert_false(t.lost);
  team_end(&t);
  for (int32_t r = 0; r < size; r++) assert_int_equal(s->allocator[r].live, 0);
}

/* ---- the cut --------------------------------------------------------------------------------- */

/* Blocks are dealt to the ranks; what 0: in turn; 1: rank 0 has none; 2: the weight of each is in
 * two parts, on two ranks; 3: wrong keys on rank 1; 4: a negative weight there. */
static void run_cut(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  mps_context *own;
  mps_domain *domain = rank_domain(s, t, rank, &own);
  int64_t count = 0, key[MOST_BLOCKS], weight[MOST_BLOCKS];
  for (int64_t b = 0; b < s->blocks; b++) {
    const bool here = s->what == 1 ? rank == 1 + b % (t->size - 1) : rank == b % t->size;
    const bool half = s->what == 2 && rank == (b + 1) % t->size;
    if (!here && !half) continue;
    key[count] = s->key[b];
    weight[count++] = s->what != 2 ? s->weight[b]
                      : half       ? s->weight[b] / 3
                                   : s->weight[b] - s->weight[b] / 3;
  }
  if (s->what == 3 && rank == 1) key[0] = MPSI_CURVE_END;
  if (s->what == 4 && rank == 1) weight[0] = -5;
  if (domain) f->status[1] = mpsi_curve_cut(domain, "test", count, key, weight, f->first);
  end_rank(f, domain, own);
}

/* A scene of so many blocks of a ball in 3D, with weights of 1 to `most`. */
static scene *make_blocks(int64_t blocks, int64_t most) {
  scene *s = calloc(1, sizeof *s);
  uint64_t h = 7;
  int64_t key = 12345;
  s->blocks = blocks;
  for (int64_t b = 0; b < blocks; b++) {
    h = h * 6364136223846793005u + 1442695040888963407u;
    key += 1 + (int64_t)(h >> 60) * (b % 37 == 0 ? 1000003 : 1);
    s->key[b] = key;
    s->weight[b] = 1 + (int64_t)(h >> 33) % most;
  }
  return s;
}

/* All ranks have the same cut, which is what one finds with all blocks at hand. */
static void check_cut(const scene *s, int32_t size) {
  const int64_t *first = s->rank[0].first;
  int64_t all = 0, heaviest = 0, before = 0, part[TEAM_MOST] = {0};
  for (int64_t b = 0; b < s->blocks; b++) {
    all += s->weight[b];
    if (s->weight[b] > heaviest) heaviest = s->weight[b];
  }
  assert_int_equal(first[0], 0);
  assert_int_equal(first[size], MPSI_CURVE_END);
  for (int32_t r = 0; r < size; r++) {
    assert_int_equal(s->rank[r].status[1], MPS_OK);
    assert_memory_equal(s->rank[r].first, first, ((size_t)size + 1) * sizeof *first);
    assert_true(first[r] <= first[r + 1]);
  }
  for (int64_t b = 0; b < s->blocks; b++) {
    const int32_t owner = mpsi_curve_owner(size, first, s->key[b]);
    assert_true(first[owner] <= s->key[b] && s->key[b] < first[owner + 1]);
    /* its middle lies in the owner's part, within the rounding of the parts */
    const double middle = (double)before + 0.5 * (double)s->weight[b], mean = (double)all / size;
    assert_true(middle >= mean * owner - 1.0 && middle <= mean * (owner + 1) + 1.0);
    before += s->weight[b];
    part[owner] += s->weight[b];
  }
  for (int32_t r = 0; r < size; r++) assert_true(part[r] <= all / size + heaviest + 1);
}

TEST(test_cut) {
  static const struct {
    int32_t ranks;
    int64_t blocks, most;
    int what;
  } cases[] = {
      {1, 5, 9, 0},    {2, 600, 100, 0}, {3, 600, 1, 0}, {7, 600, 1000, 1},
      {7, 600, 50, 2}, {16, 9, 40, 0},   {16, 1, 1, 0},  {5, 600, INT64_C(1) << 30, 2},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    scene *s = make_blocks(cases[k].blocks, cases[k].most);
    s->what = cases[k].what;
    run_team(s, cases[k].ranks, run_cut);
    check_cut(s, cases[k].ranks);
    free(s);
  }
}

/* Equal blocks in equal numbers: equal parts. */
TEST(test_cut_of_equal_blocks) {
  scene *s = make_blocks(12, 1);
  run_team(s, 4, run_cut);
  for (int32_t r = 0; r < 4; r++)
    for (int64_t b = 0; b < 12; b++)
      assert_int_equal(mpsi_curve_owner(4, s->rank[r].first, s->key[b]), b / 3);
  free(s);
}

/* No blocks at all, and blocks that weigh nothing: every key has an owner all the same. */
TEST(test_cut_of_nothing) {
  for (int64_t blocks = 0; blocks <= 10; blocks += 10) {
    scene *s = make_blocks(blocks, 1);
    for (int64_t b = 0; b < blocks; b++) s->weight[b] = 0;
    run_team(s, 3, run_cut);
    for (int32_t r = 0; r < 3; r++) {
      assert_int_equal(s->rank[r].status[1], MPS_OK);
      assert_int_equal(mpsi_curve_owner(3, s->rank[r].first, 0), 2);
      assert_int_equal(mpsi_curve_owner(3, s->rank[r].first, MPSI_CURVE_END - 1), 2);
    }
    free(s);
  }
}

TEST(test_cut_refuses) {
  static const char *const says[] = {"rank 1: key 0 of the curve is", "rank 1: weight 0 is -5"};
  for (int what = 3; what <= 4; what++) {
    scene *s = make_blocks(20, 5);
    s->what = what;
    run_team(s, 3, run_cut);
    for (int32_t r = 0; r < 3; r++) {
      assert_int_equal(s->rank[r].status[1], MPS_ERROR_ARGUMENT);
      assert_non_null(strstr(s->rank[r].message, says[what - 3]));
    }
    free(s);
  }
}

/* ---- migration ------------------------------------------------------------------------------- */

/* Where the particle `id` lives first, and where it goes. */
static int32_t home(int64_t id, int32_t size) { return (int32_t)(id * 7 / 3 % size); }
static int32_t goal(const scene *s, int64_t id, int32_t size) {
  return s->what == 1 ? size - 1 : (int32_t)(id * id % size); /* 1: all to the last rank */
}

enum { IDS = 300 };

/* what 0, 1: goals; 2: a rank that there is not; 3: another number of columns; 4: one is lost on
 * the way, another doubled. */
static void run_migrate(void *user, team *t, int32_t rank) {
  scene *s = user;
  found *f = &s->rank[rank];
  mps_context *own;
  mps_domain *domain = rank_domain(s, t, rank, &own);
  int64_t row[MOST_ROWS], leaves = 0, stays = 0, arriving = 0;
  int32_t to[MOST_ROWS];
  for (int64_t id = IDS - 1; id >= 0; id--) {
    if (home(id, t->size) != rank) continue;
    f->id[f->count] = id;
    f->value[f->count] = sqrt((double)id);
    f->half[f->count++] = 0.5 * (double)id;
  }
  mpsi_census before;
  mpsi_mailbox box = {.context = own};
  f->status[1] =
      domain ? mpsi_census_take(domain, "test", f->count, f->id, &before) : MPS_ERROR_MEMORY;
  for (int64_t k = 0; k < f->count; k++) {
    if (goal(s, f->id[k], t->size) == rank) continue;
    row[leaves] = k;
    to[leaves] = s->what == 2 && rank == 1 && leaves == 3 ? t->size : goal(s, f->id[k], t->size);
    leaves++;
  }
  void *const column[COLUMNS] = {f->id, f->value, f->half};
  const mpsi_leaving leaving = {.count = leaves,
                                .row = row,
                                .to = to,
                                .columns = s->what == 3 && rank == 1 ? 2 : COLUMNS,
                                .column = (const void *const *)column};
  if (domain && f->status[1] == MPS_OK)
    f->status[2] = mpsi_migrate(domain, "test", &leaving, &box, &arriving);
  if (domain && f->status[2] == MPS_OK) {
    for (int64_t k = 0, next = 0; k < f->count; k++) {
      if (next < leaves && row[next] == k) {
        next++;
        continue;
      }
      f->id[stays] = f->id[k], f->value[stays] = f->value[k], f->half[stays++] = f->half[k];
    }
    mpsi_migrate_unpack(&box, COLUMNS, column, stays);
    f->count = stays + arriving;
    if (s->what == 4 && rank == 1) f->id[0] = f->id[1];
    f->status[3] = mpsi_census_check(domain, "test", f->count, f->id, &before);
  }
  mpsi_domain_free_mail(&box);
  end_rank(f, domain, own);
}

TEST(test_migration) {
  for (int32_t size = 1; size <= 16; size += size < 4 ? 1 : 6)
    for (int what = 0; what <= 1; what++) {
      scene *s = calloc(1, sizeof *s);
      bool seen[IDS] = {false};
      s->what = what;
      run_team(s, size, run_migrate);
      for (int32_t r = 0; r < size; r++) {
        const found *f = &s->rank[r];
        for (int k = 0; k < 4; k++) assert_int_equal(f->status[k], MPS_OK);
        for (int64_t k = 0; k < f->count; k++) {
          assert_int_equal(goal(s, f->id[k], size), r);
          assert_false(seen[f->id[k]]);
          seen[f->id[k]] = true;
          NEAR(f->value[k], sqrt((double)f->id[k]), 0.0);
          NEAR(f->half[k], 0.5 * (double)f->id[k], 0.0);
        }
      }
      for (int64_t id = 0; id < IDS; id++) assert_true(seen[id]);
      free(s);
    }
}

TEST(test_migration_refuses) {
  static const char *const says[] = {"for rank 4, allowed are", "the number of columns",
                                     "one is there twice"};
  static const mps_status gives[] = {MPS_ERROR_ARGUMENT, MPS_ERROR_ARGUMENT, MPS_ERROR_INTERNAL};
  for (int what = 2; what <= 4; what++) {
    scene *s = calloc(1, sizeof *s);
    s->what = what;
    run_team(s, 4, run_migrate);
    for (int32_t r = 0; r < 4; r++) {
      assert_int_equal(s->rank[r].status[what == 4 ? 3 : 2], gives[what - 2]);
      assert_non_null(strstr(s->rank[r].message, says[what - 2]));
    }
    free(s);
  }
}

/* One rank is refused one allocation after the other: all report it, none hangs. */
static void sweep(team_fn run, int call) {
  for (int64_t refuse = 3;; refuse++) { /* 1: the context, 2: the domain, which none knows yet */
    scene *s = make_blocks(50, 9);
    s->refuse = refuse;
    run_team(s, 3, run);
    const mps_status status = s->rank[1].status[call];
    for (int32_t r = 0; r < 3; r++) {
      assert_int_equal(s->rank[r].status[call], status);
      if (status != MPS_OK) assert_non_null(strstr(s->rank[r].message, "rank 1: "));
    }
    free(s);
    if (status == MPS_OK) break;
    assert_int_equal(status, MPS_ERROR_MEMORY);
    assert_true(refuse < 50);
  }
}

TEST(test_refused_memory) {
  sweep(run_cut, 1);
  sweep(run_migrate, 2);
}
