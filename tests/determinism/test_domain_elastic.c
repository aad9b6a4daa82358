/* test_domain_elastic.c - implicit elasticity on several ranks, each with its part of the rows:
 * what all of them solve has the bits of one, and an error of one rank is an error of all, before
 * any waits for the others in the solver that they share. SPDX-License-Identifier: BSD-3-Clause */
#include "conjugate.h"
#include "ranks_team.h"

/* ---- conjugate gradients on ranks: each multiplies its rows, the vectors are everybody's ----- */

typedef struct shared {
  mps_domain *domain; /* NULL: alone */
  int64_t all, first, rows, *start;
  int32_t *column;
  double *value;
} shared;

static void forget(shared *s) {
  free(s->start);
  free(s->column);
  free(s->value);
  s->start = NULL, s->column = NULL, s->value = NULL;
}

static mps_status take(void *user, const mps_linear_matrix *m) {
  shared *s = user;
  const size_t entries = (size_t)m->start[m->rows];
  forget(s);
  s->all = m->all, s->first = m->first, s->rows = m->rows;
  s->start = memcpy(malloc((size_t)(m->rows + 1) * 8), m->start, (size_t)(m->rows + 1) * 8);
  s->column = memcpy(malloc(entries * 4 + 1), m->column, entries * 4);
  s->value = memcpy(malloc(entries * 8 + 1), m->value, entries * 8);
  /* as a solver does, it waits for the others */
  return s->domain ? mps_domain_agree(s->domain, MPS_OK) : MPS_OK;
}

static mps_status multiply(const void *matrix, const double *x, double *y) {
  const shared *s = matrix;
  for (int64_t i = 0; i < s->all; i++) y[i] = -INFINITY;
  for (int64_t i = 0; i < s->rows; i++) {
    double sum = 0.0;
    for (int64_t k = s->start[i]; k < s->start[i + 1]; k++) sum += s->value[k] * x[s->column[k]];
    y[s->first + i] = sum;
  }
  return s->domain ? mps_domain_max(s->domain, (int32_t)s->all, y) : MPS_OK;
}

/* The rows of all ranks from those of each. */
static mps_status gather(const shared *s, const double *own, double *all) {
  for (int64_t i = 0; i < s->all; i++)
    all[i] = i < s->first || i >= s->first + s->rows ? -INFINITY : own[i - s->first];
  return s->domain ? mps_domain_max(s->domain, (int32_t)s->all, all) : MPS_OK;
}

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        mps_linear_result *out) {
  const shared *s = user;
  double *right = calloc(2 * (size_t)s->all, sizeof *right), *solution = right + s->all;
  mps_status status = gather(s, b, right);
  TRY(test_conjugate(s->all, multiply, s, right, tolerance, solution, &out->iterations));
  memcpy(x, solution + s->first, (size_t)s->rows * sizeof *x);
  free(right);
  return status;
}

/* ---- a bar of two materials that stands on its end, under its weight and a pressure on one side:
 * at rest, then in motion. Ids ascend from layer to layer, the order that ranks have too, so that
 * sums over rows have the same bits with ranks and without. --------------------------------------
 */

/* What goes wrong on one of the ranks, and the time of the last whole step. */
#define ELASTIC_TROUBLES(ROW)                                                                      \
  ROW(OTHER_BODY, MPS_ERROR_ARGUMENT, "a hash of the set's particles", 0.0)                        \
  ROW(OTHER_TOLERANCE, MPS_ERROR_ARGUMENT, "tolerance is ", 0.0)                                   \
  ROW(OTHER_SUPPORT, MPS_ERROR_ARGUMENT, "another value on others", 0.0)                           \
  ROW(OTHER_LOAD, MPS_ERROR_ARGUMENT, "another value on others", 0.0)                              \
  ROW(OTHER_REMOVED, MPS_ERROR_ARGUMENT, "number is 1: there is no load", 0.0)                     \
  ROW(CANCELLED, MPS_ERROR_CANCELLED, "rank 1: cancelled", 0.0)                                    \
  ROW(SIGNAL_FAILS, MPS_ERROR_NUMERIC, "rank 1: ", 0.1)                                            \
  ROW(SIGNAL_DIFFERS, MPS_ERROR_ARGUMENT, "the motion of a boundary is ", 0.1)                     \
  ROW(FACTOR_DIFFERS, MPS_ERROR_ARGUMENT, "the present factor on a load is ", 0.1)                 \
  ROW(SOLVER_FAILS, MPS_ERROR_IO, "rank 1: the callback matrix", 0.0)                              \
  ROW(OTHER_KERNEL, MPS_ERROR_ARGUMENT, "the kind of the kernel is ", 0.0)                         \
  ROW(OTHER_SNAPSHOT, MPS_ERROR_ARGUMENT, "steps is ", 0.2)
enum {
  PLANE,
  SOLID,
  TINY, /* six particles: most ranks have none */
  LONG,
  ELASTIC_TROUBLES(CASE_NAME) TROUBLES
};

typedef struct upset {
  mps_domain *domain;
  int64_t asked;
} upset;

static int32_t cancel(void *user) {
  upset *u = user;
  return mps_domain_rank(u->domain) == 1 && ++u->asked == 2;
}

static mps_status failing(void *user, double t, double motion[3]) {
  const upset *u = user;
  motion[0] = motion[1] = motion[2] = 0.0;
  return mps_domain_rank(u->domain) == 1 && t > 0.15 ? MPS_ERROR_NUMERIC : MPS_OK;
}

static mps_status unable(void *user, const mps_linear_matrix *m) {
  const mps_status status = take(user, m);
  return mps_domain_rank(((shared *)user)->domain) == 1 ? MPS_ERROR_IO : status;
}

/* A motion that is another one on rank 1 from 0.15 s on. */
static mps_status differing(void *user, double t, double motion[3]) {
  const upset *u = user;
  motion[0] = mps_domain_rank(u->domain) == 1 && t > 0.15 ? 1e-9 : 0.0;
  motion[1] = motion[2] = 0.0;
  return MPS_OK;
}

static mps_status make_set(mps_context *own, int what, mps_particles **set) {
  const int up = what == SOLID || what == LONG ? 2 : 1;
  double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {0.75, 0.5, 0.5}, stiff[3] = {0.5, 0.5, 0.5};
  int64_t ids[512], count = 0;
  hi[up] = what == TINY ? 0.75 : what == LONG ? 24.0 : 3.0;
  stiff[up] = 1.75;
  if (what == TINY) hi[0] = 0.5;
  if (what == LONG) hi[0] = hi[1] = 1.0;
  DEF(particles, def, .dim = up + 1, .spacing = 0.25);
  mps_status status = mps_particles_create(own, &def, set);
  TRY(mps_particles_fill_box(*set, lo, hi, NULL));
  TRY(mps_particles_set(*set, "poisson", 0, 0.3));
  TRY(mps_particles_set(*set, "density", 0, 2.0));
  TRY(mps_particles_set(*set, "young", 0, 50.0));
  TRY(mps_particles_select_box(*set, lo, stiff, 512, &count, ids));
  mps_edit edit;
  TRY(mps_particles_edit(*set, "young", &edit));
  if (status != MPS_OK) return status;
  for (int64_t k = 0; what != TINY && k < count; k++)
    *mps_edit_f64(&edit, mps_particles_index(*set, ids[k]), 0) = 200.0;
  return mps_particles_commit(*set, &edit);
}

static mps_status support_and_load(mps_context *own, mps_elastic *elastic, upset *u, int what) {
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_elastic_load_def weight = mps_elastic_load_defaults(), push = weight;
  int64_t facets[512], count = 0, ids[512];
  const int up = what == SOLID || what == LONG ? 2 : 1;
  const double lo[3] = {-1.0, -1.0, -1.0}, hi[3] = {0.2, 9.0, 9.0};
  for (int c = 0; c < 3; c++) held.lower[c] = -10.0, held.upper[c] = c == up ? 0.2 : 10.0;
  weight.kind = MPS_ELASTIC_LOAD_VOLUME, weight.all = 1;
  weight.force[1] = -0.02;
  push.kind = MPS_ELASTIC_LOAD_PRESSURE;
  scoped_signal *signal = NULL;
  mps_status status = MPS_OK;
  if (what == SIGNAL_FAILS)
    status =
        mps_signal_create_user(own, MPS_SIGNAL_QUANTITY_DISPLACEMENT, failing, u, NULL, &signal);
  if (what == SIGNAL_DIFFERS || what == FACTOR_DIFFERS)
    status = mps_signal_create_user(
        own, what == FACTOR_DIFFERS ? MPS_SIGNAL_QUANTITY_VALUE : MPS_SIGNAL_QUANTITY_DISPLACEMENT,
        differing, u, NULL, &signal);
  if (signal) held.kind = MPS_BOUNDARY_DRIVEN;
  if (what != FACTOR_DIFFERS) held.signal[0] = signal;
  if (what == FACTOR_DIFFERS) weight.signal[1] = signal;
  const int32_t rank = u->domain ? mps_domain_rank(u->domain) : 0;
  if (what == OTHER_SUPPORT) held.factor[1] = 1.0 + rank;
  if (what == OTHER_LOAD) weight.force[1] = rank;
  if (u->domain) status = mps_domain_agree(u->domain, status);
  TRY(mps_elastic_add_boundary(elastic, &held, NULL));
  TRY(mps_elastic_add_load(elastic, &weight, NULL));
  if (what == OTHER_REMOVED) TRY(mps_elastic_remove_load(elastic, rank));
  /* The surface passes through the particles of one side: its pressure has moments. */
  TRY(mps_particles_select_box(mps_elastic_particles(elastic), lo, hi, 512, &count, ids));
  if (u->domain) status = mps_domain_agree(u->domain, status);
  TRY(mps_elastic_cut(elastic, MPS_SIDE_X_LOWER, ids, count));
  TRY(mps_elastic_select_facets(elastic, MPS_SIDE_X_UPPER, NULL, NULL, 512, &count, facets));
  push.ids = facets, push.id_count = count, push.force[0] = 0.3;
  if (u->domain) status = mps_domain_agree(u->domain, status);
  TRY(mps_elastic_add_load(elastic, &push, NULL));
  return status;
}

/* Queries of a solution or a motion. */
static mps_status ask(mps_elastic *elastic, double *out) {
  const int64_t facets = mps_elastic_facet_count(elastic);
  double *values = calloc((size_t)facets * 6, sizeof *values);
  const mps_elastic_facet_arrays arrays = {.displacement = values, .velocity = values + 3 * facets};
  mps_status status = values ? MPS_OK : MPS_ERROR_MEMORY;
  TRY(mps_elastic_update_stress(elastic));
  mps_totals totals = {0};
  TRY(mps_elastic_get_totals(elastic, &totals));
  out[0] = totals.strain, out[1] = totals.work_loads;
  TRY(mps_elastic_get_section(elastic, 1, 0.4, NULL, out + 2, out + 5));
  TRY(mps_elastic_get_facets(elastic, NULL, facets, &arrays));
  for (int64_t k = 0; status == MPS_OK && k < 6 * facets; k++) out[8 + k % 12] += values[k];
  free(values);
  return status;
}

/* To the first of two states, the odd rank to the second. */
static mps_status go_back(mps_elastic *elastic, bool odd) {
  mps_snapshot *state[2] = {NULL, NULL};
  mps_status status = MPS_OK;
  for (int k = 0; k < 2; k++) {
    TRY(mps_elastic_step(elastic, 1));
    TRY(mps_elastic_snapshot(elastic, &state[k]));
  }
  TRY(mps_elastic_rollback(elastic, state[odd]));
  for (int k = 0; k < 2; k++) mps_snapshot_destroy(&state[k]);
  return status;
}

static mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t length,
                          result *r) {
  SCOPED(forget) shared s = {.domain = domain};
  upset u = {.domain = domain};
  scoped_particles *set = NULL;
  scoped_elastic *elastic = NULL;
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  const int32_t rank = domain ? mps_domain_rank(domain) : 0;
  DEF(elastic, def, .domain = domain,
      .tolerance = what == OTHER_TOLERANCE && rank == 1 ? 1e-8 : 1e-11);
  DEF(linear_solver, solver, .user = &s, .matrix = what == SOLVER_FAILS ? unable : take,
      .solve = solve, .rank = rank, .ranks = domain ? mps_domain_size(domain) : 1);
  motion.dt = 0.1;
  mps_status status = make_set(own, what, &set);
  if (what == OTHER_KERNEL)
    TRY(mps_kernel_create(own, rank == 1 ? MPS_KERNEL_SPLINE3 : MPS_KERNEL_MPS,
                          1.5 * mps_particles_spacing(set), &def.kernel));
  if (what == OTHER_BODY && rank == 1) TRY(mps_particles_set(set, "young", 0, 51.0));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_elastic_create(own, set, &def, &elastic));
  TRY(mps_solver_set_linear_solver(mps_elastic_solver(elastic), MPS_LINEAR_EQUATION_STIFFNESS,
                                   &solver));
  TRY(support_and_load(own, elastic, &u, what));
  TRY(mps_elastic_solve(elastic));
  TRY(ask(elastic, r->other));
  if (what == CANCELLED) mps_context_set_cancel(own, cancel, &u, NULL);
  TRY(mps_elastic_start(elastic, &motion));
  if (what == OTHER_SNAPSHOT) TRY(go_back(elastic, rank == 1));
  TRY(mps_elastic_step(elastic, length));
  TRY(ask(elastic, r->other + 20));
  r->time = mps_elastic_time(elastic);
  if (status == MPS_OK) status = mps_elastic_get_totals(elastic, &r->totals);
  if (status == MPS_OK) status = mps_elastic_get_reaction(elastic, 0, &r->reaction[0]);
  TRY(keep(set, r));
  if (domain) status = mps_domain_agree(domain, status);
  mps_kernel_destroy(&def.kernel);
  return status;
}

TEST(test_bits) {
  compare_teams(compute, PLANE, 5, false);
  compare_teams(compute, SOLID, 3, true);
  compare_teams(compute, TINY, 2, true);
}

TEST(test_refused_memory) { refuse_memory(compute, PLANE, 2, 1); }

TEST(test_troubles) {
  static const struct {
    mps_status status;
    const char *text;
    double time;
  } expected[TROUBLES] = {ELASTIC_TROUBLES(CASE_ROW)};
  for (int what = OTHER_BODY; what < TROUBLES; what++) {
    ranks s = {.compute = compute, .what = what, .threads = 1, .length = 5};
    run_team(&s, 3);
    for (int32_t r = 0; r < 3; r++) {
      if (s.rank[r].status != expected[what].status ||
          !strstr(s.rank[r].message, expected[what].text))
        fail_msg("trouble %d, rank %d: %d %s", what, (int)r, (int)s.rank[r].status,
                 s.rank[r].message);
      NEAR(s.rank[r].time, s.rank[0].time, 0.0);
      if (what != CANCELLED) NEAR(s.rank[r].time, expected[what].time, 1e-12);
      drop(&s.rank[r]);
    }
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* Bytes that a context holds and has held at most, each block behind its size. */
typedef struct scales {
  int64_t now, most;
} scales;

enum { BEFORE = 64 }; /* the library's alignment, or more */

static void *weigh(void *user, size_t size, size_t alignment) {
  scales *s = user;
  char *block =
      alignment <= BEFORE ? aligned_alloc(BEFORE, (size + 2 * BEFORE - 1) / BEFORE * BEFORE) : NULL;
  if (!block) return NULL;
  memcpy(block, &size, sizeof size);
  s->now += (int64_t)size;
  s->most = s->now > s->most ? s->now : s->most;
  return block + BEFORE;
}

static void unweigh(void *user, void *memory) {
  char *block = (char *)memory - BEFORE;
  size_t size;
  memcpy(&size, block, sizeof size);
  ((scales *)user)->now -= (int64_t)size;
  free(block);
}

static mps_status look_away(void *user, const mps_linear_matrix *m) {
  (void)user, (void)m;
  return MPS_OK;
}

static mps_status give_up(void *user, const double *b, double tolerance, double *x,
                          mps_linear_result *out) {
  (void)user, (void)b, (void)tolerance, (void)x, (void)out;
  return MPS_ERROR_IO;
}

/* A long bar up to the solution, which is the caller's. */
static void load_scales(void *user, team *t, int32_t rank) {
  scales *s = (scales *)user + rank;
  mps_context_def def = test_context_defaults();
  const mps_domain_def domain_def = team_domain_def(t, rank);
  scoped_context *own = NULL;
  mps_particles *set = NULL;
  mps_elastic *elastic = NULL;
  upset u = {.domain = NULL};
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.alloc = weigh, def.free = unweigh, def.memory_user = s;
  mps_status status = mps_context_create(&def, &own, NULL, 0);
  TRY(mps_domain_create(own, &domain_def, &u.domain));
  TRY(make_set(own, LONG, &set));
  DEF(elastic, body, .domain = u.domain);
  TRY(mps_elastic_create(own, set, &body, &elastic));
  DEF(linear_solver, solver, .matrix = look_away, .solve = give_up, .rank = rank,
      .ranks = mps_domain_size(u.domain));
  TRY(mps_solver_set_linear_solver(mps_elastic_solver(elastic), MPS_LINEAR_EQUATION_STIFFNESS,
                                   &solver));
  TRY(support_and_load(own, elastic, &u, LONG));
  TRY(mps_elastic_solve(elastic));
  if (status != MPS_ERROR_IO) s->most = -1; /* not the way there */
  mps_elastic_destroy(&elastic);
  mps_particles_destroy(&set);
  mps_domain_destroy(&u.domain);
}

static int64_t heaviest(int32_t size) {
  scales s[8] = {{0}};
  int64_t most = 0;
  team_compute(size, load_scales, s);
  for (int32_t r = 0; r < size; r++) {
    assert_true(s[r].most > 0);
    assert_int_equal(s[r].now, 0);
    most = s[r].most > most ? s[r].most : most;
  }
  return most;
}

/* Rows, neighbours, joints and stresses are of a rank's own particles and a few layers around them.
 */
TEST(test_memory) {
  const int64_t one = heaviest(1), two = heaviest(2), eight = heaviest(8);
  print_message("bytes of the heaviest of 1, 2, 8 ranks: %lld, %lld, %lld\n", (long long)one,
                (long long)two, (long long)eight);
  assert_true((double)two < 0.67 * (double)one);
  assert_true((double)eight < 0.4 * (double)one);
}
