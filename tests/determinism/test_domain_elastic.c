/* test_domain_elastic.c - implicit elasticity on several ranks, each with its part of the rows:
 * what all of them solve has the bits of one, and an error of one rank is an error of all, before
 * any waits for the others in the solver that they share. SPDX-License-Identifier: BSD-3-Clause */
#include "conjugate.h"
#include "ranks_team.h"

#include <mps/elastic_solver.h>

/* ---- conjugate gradients on ranks: each multiplies its rows, the vectors are everybody's --------
 */

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

static mps_status take(void *user, const mps_elastic_matrix *m, size_t size) {
  shared *s = user;
  const size_t entries = (size_t)m->start[m->rows];
  (void)size;
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

static mps_status solve(void *user, const double *b, double tolerance, double *x,
                        int64_t *iterations) {
  return test_conjugate(((const shared *)user)->all, multiply, user, b, tolerance, x, iterations);
}

/* ---- a strip, held on the left, under its weight: at rest, then in motion -----------------------
 */

enum { HEALTHY, OTHER_BODY, OTHER_TOLERANCE, CANCELLED, SIGNAL_FAILS, SOLVER_FAILS, TROUBLES };

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

static mps_status unable(void *user, const mps_elastic_matrix *m, size_t size) {
  const mps_status status = take(user, m, size);
  return mps_domain_rank(((shared *)user)->domain) == 1 ? MPS_ERROR_IO : status;
}

static mps_status make_set(mps_context *own, mps_particles **set) {
  mps_particles_def def = mps_particles_defaults();
  const double lo[2] = {0.0, 0.0}, hi[2] = {3.0, 0.75};
  def.spacing = 0.25;
  mps_status status = mps_particles_create(own, &def, set);
  TRY(mps_particles_fill_box(*set, lo, hi, NULL));
  TRY(mps_particles_set(*set, "young", 0, 50.0));
  TRY(mps_particles_set(*set, "poisson", 0, 0.3));
  TRY(mps_particles_set(*set, "density", 0, 2.0));
  return status;
}

static mps_status support_and_load(mps_context *own, mps_elastic *elastic, upset *u, int what) {
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_elastic_load_def weight = mps_elastic_load_defaults();
  for (int c = 0; c < 3; c++) held.lower[c] = -10.0, held.upper[c] = c == 0 ? 0.2 : 10.0;
  weight.kind = MPS_ELASTIC_LOAD_BODY;
  weight.force[1] = -0.02;
  mps_signal *signal = NULL;
  mps_status status = MPS_OK;
  if (what == SIGNAL_FAILS) status = mps_signal_user(own, failing, u, &signal);
  held.signal[0] = signal;
  if (u->domain) status = mps_domain_agree(u->domain, status);
  TRY(mps_elastic_add_boundary(elastic, &held, NULL));
  TRY(mps_elastic_add_load(elastic, &weight, NULL));
  mps_signal_destroy(&signal);
  return status;
}

static mps_status compute(mps_context *own, mps_domain *domain, int what, int64_t length,
                          result *r) {
  shared s = {.domain = domain};
  upset u = {.domain = domain};
  mps_particles *set = NULL;
  mps_elastic *elastic = NULL;
  mps_elastic_def def = mps_elastic_defaults();
  mps_elastic_solver_def solver = mps_elastic_solver_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  const int32_t rank = domain ? mps_domain_rank(domain) : 0;
  def.domain = domain;
  def.tolerance = what == OTHER_TOLERANCE && rank == 1 ? 1e-8 : 1e-11;
  solver.user = &s;
  solver.matrix = what == SOLVER_FAILS ? unable : take;
  solver.solve = solve;
  solver.part = rank, solver.parts = domain ? mps_domain_size(domain) : 1;
  motion.dt = 0.1;
  mps_status status = make_set(own, &set);
  if (what == OTHER_BODY && rank == 1) TRY(mps_particles_set(set, "young", 0, 51.0));
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_elastic_create(own, set, &def, &elastic));
  TRY(mps_elastic_set_solver(elastic, &solver));
  TRY(support_and_load(own, elastic, &u, what));
  TRY(mps_elastic_solve(elastic));
  if (what == CANCELLED) mps_context_set_cancel(own, cancel, &u);
  TRY(mps_elastic_start(elastic, &motion));
  TRY(mps_elastic_step(elastic, length));
  r->time = mps_elastic_time(elastic);
  if (status == MPS_OK) status = mps_elastic_get_totals(elastic, &r->totals);
  if (status == MPS_OK) status = mps_elastic_get_reaction(elastic, 0, &r->reaction[0]);
  TRY(keep(set, r));
  if (domain) status = mps_domain_agree(domain, status);
  mps_elastic_destroy(&elastic);
  mps_particles_destroy(&set);
  forget(&s);
  return status;
}

static void test_bits(void **state) { (void)state, compare_teams(compute, HEALTHY, 5, false); }

static void test_refused_memory(void **state) {
  (void)state, refuse_memory(compute, HEALTHY, 2, 1);
}

static void test_troubles(void **state) {
  static const struct {
    mps_status status;
    const char *text;
    double time; /* of the last whole step */
  } expected[TROUBLES] = {
      [OTHER_BODY] = {MPS_ERROR_ARGUMENT, "a hash of the set's particles", 0.0},
      [OTHER_TOLERANCE] = {MPS_ERROR_ARGUMENT, "a hash of the solver's definition", 0.0},
      [CANCELLED] = {MPS_ERROR_CANCELLED, "rank 1: cancelled", 0.0},
      [SIGNAL_FAILS] = {MPS_ERROR_NUMERIC, "rank 1: ", 0.1},
      [SOLVER_FAILS] = {MPS_ERROR_IO, "rank 1: the callback matrix", 0.0},
  };
  (void)state;
  for (int what = HEALTHY + 1; what < TROUBLES; what++) {
    ranks s = {.compute = compute, .what = what, .threads = 1, .length = 5};
    run_team(&s, 3, 10.0);
    for (int32_t r = 0; r < 3; r++) {
      if (s.rank[r].status != expected[what].status ||
          !strstr(s.rank[r].message, expected[what].text))
        fail_msg("trouble %d, rank %d: %d %s", what, (int)r, (int)s.rank[r].status,
                 s.rank[r].message);
      mps_assert_near(s.rank[r].time, s.rank[0].time, 0.0);
      if (what != CANCELLED) mps_assert_near(s.rank[r].time, expected[what].time, 1e-12);
      drop(&s.rank[r]);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bits),
      cmocka_unit_test(test_refused_memory),
      cmocka_unit_test(test_troubles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
