/* test_domain_dynamics.c - explicit dynamics on several ranks: every particle, reaction and total
 * has the bits of the run without a domain, on whatever number of ranks and threads; and an error
 * of one rank is an error of all.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include "domain_threads.h"

#include <mps/dynamics.h>

enum { LAYERS, SCATTERED, PERIODIC, STRIP, SCENES };

#define FIELDS 8
static const struct {
  const char *name;
  int columns;
} fields[FIELDS] = {{"position", 2},     {"displacement", 2}, {"velocity", 2}, {"rotation", 1},
                    {"acceleration", 2}, {"pressure", 1},     {"spin", 1},     {"reaction", 2}};

/* What a run ends with: of one rank, or without a domain. */
typedef struct result {
  mps_status status;
  char message[512];
  int64_t count, pairs, *id;
  double *value[FIELDS];
  mps_totals totals;
  mps_reaction reaction;
  double dt, limit, omega;
} result;

typedef struct scene {
  int what;
  int32_t threads;
  int64_t refuse; /* allocation that rank 1 is refused, from 1; 0 none */
  bool short_run;
  result rank[TEAM_MOST];
  test_allocator allocator[TEAM_MOST];
} scene;

#define TRY(call)                                                                                  \
  do {                                                                                             \
    if (status == MPS_OK) status = (call);                                                         \
  } while (0)

static double noise(uint64_t k) {
  k = (k + 1) * UINT64_C(0x9e3779b97f4a7c15);
  k = (k ^ (k >> 31)) * UINT64_C(0xbf58476d1ce4e5b9);
  return (double)(k >> 11) * 0x1p-53 - 0.5;
}

/* Wave velocities that grow with depth, more damping at the top; a start in motion. */
static mps_status give_ground(mps_particles *set, bool even) {
  mps_status status = MPS_OK;
  mps_view x, vs, vp, h, v;
  TRY(mps_particles_set(set, "density", 0, 1900.0));
  TRY(mps_particles_set(set, "shear_velocity", 0, 200.0));
  TRY(mps_particles_set(set, "pressure_velocity", 0, 400.0));
  TRY(mps_particles_set(set, "damping", 0, 0.02));
  TRY(mps_particles_set(set, "velocity", 0, 0.0));
  TRY(mps_particles_add_field(set, "reaction", 0));
  TRY(mps_particles_view(set, "position", &x));
  TRY(mps_particles_edit(set, "shear_velocity", &vs));
  TRY(mps_particles_edit(set, "pressure_velocity", &vp));
  TRY(mps_particles_edit(set, "damping", &h));
  TRY(mps_particles_edit(set, "velocity", &v));
  for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(set); k++) {
    const double depth = 30.0 - *mps_view_f64(&x, k, 1);
    *mps_view_f64(&vs, k, 0) = even ? 200.0 : 100.0 + 10.0 * floor(depth / 5.0);
    *mps_view_f64(&vp, k, 0) = 2.2 * *mps_view_f64(&vs, k, 0);
    *mps_view_f64(&h, k, 0) = even ? 0.02 : depth < 10.0 ? 0.05 : 0.02;
    *mps_view_f64(&v, k, 0) = 1e-2 * sin(0.3 * *mps_view_f64(&x, k, 0) + 0.1 * depth);
  }
  TRY(mps_particles_commit(set, &vs));
  TRY(mps_particles_commit(set, &vp));
  TRY(mps_particles_commit(set, &h));
  TRY(mps_particles_commit(set, &v));
  return status;
}

static mps_status make_set(mps_context *own, int what, mps_particles **out) {
  mps_particles_def def = mps_particles_defaults();
  def.spacing = 0.5;
  mps_status status = mps_particles_create(own, &def, out);
  const double lo[2] = {0.0, 0.0}, hi[2] = {what == STRIP ? 400.0 : 45.0, what == STRIP ? 2.5 : 30};
  TRY(mps_particles_fill_box(*out, lo, hi, NULL));
  if (what == SCATTERED && status == MPS_OK) {
    mps_view x;
    TRY(mps_particles_edit(*out, "position", &x));
    for (int64_t k = 0; status == MPS_OK && k < mps_particles_count(*out); k++)
      for (int c = 0; c < 2; c++) *mps_view_f64(&x, k, c) += 0.1 * noise((uint64_t)(2 * k + c));
    TRY(mps_particles_commit(*out, &x));
  }
  TRY(give_ground(*out, what == PERIODIC));
  if (what == LAYERS) {
    TRY(mps_dynamics_add_free_field(*out, MPS_DYNAMICS_SIDE_LEFT, 4));
    TRY(mps_dynamics_add_free_field(*out, MPS_DYNAMICS_SIDE_RIGHT, 4));
  }
  return status;
}

static mps_status ramp(void *user, double t, double motion[3]) {
  (void)user;
  motion[0] = 1e-3 * (t - sin(40.0 * t) / 40.0);
  motion[1] = 1e-3 * (1.0 - cos(40.0 * t));
  motion[2] = 1e-3 * 40.0 * sin(40.0 * t);
  return MPS_OK;
}

/* A base that drives or absorbs, a load on part of the surface, gravity. */
static mps_status add_conditions(mps_context *own, mps_domain *domain, mps_dynamics *dynamics,
                                 int what, int32_t *base) {
  mps_signal *signal = NULL;
  int32_t number;
  mps_status status = mps_signal_user(own, ramp, NULL, &signal);
  if (domain) status = mps_domain_agree(domain, status);
  mps_dynamics_boundary_def boundary = mps_dynamics_boundary_defaults();
  boundary.lower[0] = boundary.lower[1] = -INFINITY;
  boundary.upper[0] = INFINITY, boundary.upper[1] = 0.4;
  boundary.kind = what == LAYERS ? MPS_DYNAMICS_BOUNDARY_VISCOUS : MPS_DYNAMICS_BOUNDARY_DRIVEN;
  boundary.dofs = what == LAYERS ? 0 : MPS_DOF_Y | MPS_DOF_ROTATION;
  boundary.signal[0] = signal;
  TRY(mps_dynamics_add_boundary(dynamics, &boundary, base));
  mps_dynamics_boundary_def point = mps_dynamics_boundary_defaults();
  const int64_t ids[3] = {700, 20, 1403};
  point.ids = ids, point.id_count = 3, point.dofs = MPS_DOF_Y;
  TRY(mps_dynamics_add_boundary(dynamics, &point, &number));
  mps_dynamics_load_def load = mps_dynamics_load_defaults();
  load.lower[0] = 3.0, load.upper[0] = 30.0;
  load.lower[1] = what == STRIP ? 2.0 : 29.0, load.upper[1] = INFINITY;
  load.traction[1] = -1e4, load.traction[0] = 2e3;
  load.signal[0] = signal;
  TRY(mps_dynamics_add_load(dynamics, &load, &number));
  mps_dynamics_load_def gravity = mps_dynamics_load_defaults();
  gravity.kind = MPS_DYNAMICS_LOAD_BODY;
  gravity.acceleration[1] = -9.81;
  TRY(mps_dynamics_add_load(dynamics, &gravity, &number));
  mps_signal_destroy(&signal);
  return status;
}

static mps_status march(mps_dynamics *dynamics, bool short_run) {
  mps_status status = mps_dynamics_step(dynamics, 3);
  mps_snapshot *then = NULL;
  if (short_run) return status;
  TRY(mps_dynamics_snapshot(dynamics, &then));
  TRY(mps_dynamics_step(dynamics, 20));
  TRY(mps_dynamics_rollback(dynamics, then));
  TRY(mps_dynamics_run(dynamics, mps_dynamics_time(dynamics) + 0.03, 7, NULL, NULL));
  TRY(mps_dynamics_refresh(dynamics));
  mps_snapshot_destroy(&then);
  return status;
}

static mps_status keep(mps_particles *set, result *r) {
  mps_status status = MPS_OK;
  mps_view view;
  r->count = mps_particles_count(set);
  r->id = malloc((size_t)r->count * sizeof *r->id + 8);
  TRY(mps_particles_view(set, "id", &view));
  for (int64_t k = 0; status == MPS_OK && k < r->count; k++) r->id[k] = *mps_view_i64(&view, k, 0);
  for (int f = 0; f < FIELDS; f++) {
    r->value[f] = calloc((size_t)r->count * (size_t)fields[f].columns + 1, sizeof(double));
    TRY(mps_particles_view(set, fields[f].name, &view));
    for (int64_t k = 0; status == MPS_OK && k < r->count; k++)
      for (int c = 0; c < fields[f].columns; c++)
        r->value[f][k * fields[f].columns + c] = *mps_view_f64(&view, k, c);
  }
  return status;
}

static void drop(result *r) {
  free(r->id);
  for (int f = 0; f < FIELDS; f++) free(r->value[f]);
}

static mps_status compute(mps_context *own, mps_domain *domain, const scene *s, result *r) {
  mps_particles *set = NULL;
  mps_dynamics *dynamics = NULL;
  int32_t base = -1;
  mps_dynamics_def def = mps_dynamics_defaults();
  def.domain = domain;
  def.watch_damping = s->what == LAYERS;
  def.integrator =
      s->what == SCATTERED ? MPS_DYNAMICS_INTEGRATOR_LEAPFROG : MPS_DYNAMICS_INTEGRATOR_VERLET;
  if (s->what == PERIODIC) def.period_x = 45.0;
  if (s->what == STRIP) def.radius_ratio = 2.1;
  mps_status status = make_set(own, s->what, &set);
  if (domain) status = mps_domain_agree(domain, status);
  TRY(mps_dynamics_create(own, set, &def, &dynamics));
  if (status == MPS_OK) status = add_conditions(own, domain, dynamics, s->what, &base);
  TRY(march(dynamics, s->short_run));
  TRY(mps_dynamics_get_totals(dynamics, &r->totals));
  TRY(mps_dynamics_get_reaction(dynamics, base, &r->reaction));
  mps_dynamics_linear_limit limit = {0};
  TRY(mps_dynamics_find_limit(dynamics, 0.0, &limit));
  r->dt = mps_dynamics_dt(dynamics);
  r->limit = limit.dt, r->omega = limit.omega;
  r->pairs = mps_dynamics_pairs(dynamics);
  TRY(keep(set, r));
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
  return status;
}

static void run_rank(void *user, team *t, int32_t rank) {
  scene *s = user;
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
  if (r->status == MPS_OK) r->status = compute(own, domain, s, r);
  if (own) snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void run_team(scene *s, int32_t size, double limit) {
  team t;
  team_begin(&t, size);
  t.limit = limit;
  team_run(&t, run_rank, s);
  team_end(&t);
}

static void compare(const result *alone, const result *rank, int64_t *seen) {
  mps_assert_near(rank->dt, alone->dt, 0.0);
  mps_assert_near(rank->limit, alone->limit, 0.0);
  mps_assert_near(rank->omega, alone->omega, 0.0);
  assert_int_equal(rank->pairs, alone->pairs);
  int64_t *at = malloc((size_t)alone->count * sizeof *at);
  for (int64_t k = 0; k < alone->count; k++) at[alone->id[k]] = k;
  for (int64_t k = 0; k < rank->count; k++)
    for (int f = 0; f < FIELDS; f++) {
      const size_t bytes = (size_t)fields[f].columns * sizeof(double);
      seen[rank->id[k]] = 1;
      const double *a = alone->value[f] + at[rank->id[k]] * fields[f].columns;
      const double *b = rank->value[f] + k * fields[f].columns;
      if (memcmp(a, b, bytes) != 0)
        fail_msg("%s of particle %lld: %.17g, expected %.17g", fields[f].name,
                 (long long)rank->id[k], b[0], a[0]);
    }
  free(at);
  assert_memory_equal(&rank->totals, &alone->totals, sizeof alone->totals);
  assert_memory_equal(&rank->reaction, &alone->reaction, sizeof alone->reaction);
}

static void compare_scene(int what) {
  static const struct {
    int32_t ranks, threads;
  } teams[] = {{1, 1}, {2, 1}, {3, 2}, {4, 1}, {7, 3}, {15, 1}};
  scene alone = {.what = what, .threads = 1};
  mps_context *serial = test_context(MPS_EXECUTOR_SERIAL, 1);
  mps_assert_ok(serial, compute(serial, NULL, &alone, &alone.rank[0]));
  mps_context_destroy(&serial);
  for (size_t k = 0; k < sizeof teams / sizeof *teams; k++) {
    if (what != LAYERS && (teams[k].ranks == 1 || teams[k].ranks == 4)) continue;
    scene s = {.what = what, .threads = teams[k].threads};
    int64_t *seen = calloc((size_t)alone.rank[0].count, sizeof *seen), all = 0;
    run_team(&s, teams[k].ranks, 60.0);
    for (int32_t r = 0; r < teams[k].ranks; r++) {
      if (s.rank[r].status != MPS_OK) fail_msg("rank %d: %s", (int)r, s.rank[r].message);
      compare(&alone.rank[0], &s.rank[r], seen);
      drop(&s.rank[r]);
      assert_int_equal(s.allocator[r].live, 0);
    }
    for (int64_t i = 0; i < alone.rank[0].count; i++) all += seen[i];
    assert_int_equal(all, alone.rank[0].count); /* nobody is lost */
    free(seen);
  }
  drop(&alone.rank[0]);
}

static void test_layers(void **state) { (void)state, compare_scene(LAYERS); }
static void test_scattered(void **state) { (void)state, compare_scene(SCATTERED); }
static void test_periodic(void **state) { (void)state, compare_scene(PERIODIC); }
static void test_strip(void **state) { (void)state, compare_scene(STRIP); }

/* ---- what goes wrong on one rank --------------------------------------------------------------
 */

/* Rank 1 is refused one allocation after the other: all ranks report it, and none hangs. */
static void test_refused_memory(void **state) {
  (void)state;
  mps_status worst = MPS_ERROR_MEMORY;
  for (int64_t refuse = 3; worst != MPS_OK; refuse++) { /* then the domain is there */
    scene s = {.what = STRIP, .threads = 1, .short_run = true, .refuse = refuse};
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
    assert_true(refuse < 2000);
  }
}

/* One after the other, what ranks do not agree upon, or what fails on one of them. */
enum {
  OTHER_SET,
  OTHER_DT,
  OTHER_COUNT,
  DIVERGES,
  CANCELLED,
  SIGNAL_FAILS,
  CALLBACK_FAILS,
  UNKNOWN_ID,
  REMOVAL,
  TROUBLES
};
static const struct {
  mps_status status;
  const char *text;
} trouble[TROUBLES] = {
    [OTHER_SET] = {MPS_ERROR_ARGUMENT, "a hash of the set's particles"},
    [OTHER_DT] = {MPS_ERROR_ARGUMENT, "a hash of the solver's definition"},
    [OTHER_COUNT] = {MPS_ERROR_ARGUMENT, "count is "},
    [DIVERGES] = {MPS_ERROR_DIVERGED, "diverged at step"},
    [CANCELLED] = {MPS_ERROR_CANCELLED, "stopped by the cancel hook"},
    [SIGNAL_FAILS] = {MPS_ERROR_NUMERIC, "rank 2: "},
    [CALLBACK_FAILS] = {MPS_ERROR_IO, "rank 2: "},
    [UNKNOWN_ID] = {MPS_ERROR_ARGUMENT, "of 2 ids 1 are of particles of the set on any rank"},
    [REMOVAL] = {MPS_ERROR_UNSUPPORTED, "the particles lie on 3 ranks"},
};

typedef struct upset {
  int32_t rank;
  int64_t asked;
} upset;

static mps_status failing(void *user, double t, double motion[3]) {
  const upset *u = user;
  motion[0] = motion[1] = motion[2] = 0.0;
  return u->rank == 2 && t > 0.01 ? MPS_ERROR_NUMERIC : MPS_OK;
}

static mps_status refuse_callback(void *user, mps_dynamics *dynamics) {
  const upset *u = user;
  return u->rank == 2 && mps_dynamics_steps(dynamics) > 0 ? MPS_ERROR_IO : MPS_OK;
}

static int32_t cancel(void *user) { return ((upset *)user)->rank == 1; }

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what) {
  mps_particles *set = NULL;
  mps_dynamics *dynamics = NULL;
  mps_signal *signal = NULL;
  upset u = {.rank = mps_domain_rank(domain)};
  mps_dynamics_def def = mps_dynamics_defaults();
  def.domain = domain;
  def.dt = what == OTHER_DT ? 1e-4 * (1.0 + u.rank) : what == DIVERGES ? 0.05 : NAN;
  mps_status status = make_set(own, STRIP, &set);
  if (what == OTHER_SET && u.rank == 1) TRY(mps_particles_set(set, "density", 0, 2000.0));
  status = mps_domain_agree(domain, status);
  const int64_t before = mps_particles_count(set);
  TRY(mps_dynamics_create(own, set, &def, &dynamics));
  if (status != MPS_OK && mps_particles_count(set) != before) status = MPS_ERROR_INTERNAL;
  if (status == MPS_OK && what == OTHER_COUNT) status = mps_dynamics_step(dynamics, 1 + u.rank);
  if (status == MPS_OK && what == DIVERGES) status = mps_dynamics_step(dynamics, 10000);
  if (status == MPS_OK && what == CANCELLED) {
    mps_context_set_cancel(own, cancel, &u);
    status = mps_dynamics_step(dynamics, 10);
  }
  if (status == MPS_OK && what == SIGNAL_FAILS) {
    mps_dynamics_load_def load = mps_dynamics_load_defaults();
    int32_t number;
    load.kind = MPS_DYNAMICS_LOAD_BODY;
    load.acceleration[0] = 1.0;
    TRY(mps_signal_user(own, failing, &u, &signal));
    load.signal[0] = signal;
    TRY(mps_dynamics_add_load(dynamics, &load, &number));
    if (status == MPS_OK) status = mps_dynamics_step(dynamics, 1000);
    mps_signal_destroy(&signal);
  }
  if (status == MPS_OK && what == CALLBACK_FAILS)
    status = mps_dynamics_run(dynamics, 1.0, 5, refuse_callback, &u);
  if (status == MPS_OK && what == UNKNOWN_ID) {
    mps_dynamics_boundary_def boundary = mps_dynamics_boundary_defaults();
    const int64_t ids[2] = {17, 123456};
    int32_t number;
    boundary.ids = ids, boundary.id_count = 2, boundary.dofs = MPS_DOF_X;
    status = mps_dynamics_add_boundary(dynamics, &boundary, &number);
  }
  if (status == MPS_OK && what == REMOVAL) {
    mps_view id;
    TRY(mps_particles_view(set, "id", &id));
    const int64_t gone[1] = {*mps_view_i64(&id, 0, 0)};
    TRY(mps_particles_remove(set, 1, gone));
  }
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
  return status;
}

static void run_trouble_rank(void *user, team *t, int32_t rank) {
  scene *s = user;
  result *r = &s->rank[rank];
  mps_domain *domain = NULL;
  mps_context *own = test_allocator_context(&s->allocator[rank]);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK) r->status = run_trouble(own, domain, s->what);
  snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void test_troubles(void **state) {
  (void)state;
  for (int what = 0; what < TROUBLES; what++) {
    scene s = {.what = what};
    team t;
    team_begin(&t, 3);
    team_run(&t, run_trouble_rank, &s);
    team_end(&t);
    assert_false(t.lost);
    for (int32_t r = 0; r < 3; r++) {
      if (s.rank[r].status != trouble[what].status ||
          !strstr(s.rank[r].message, trouble[what].text) ||
          strcmp(s.rank[r].message, s.rank[0].message) != 0)
        if (what != REMOVAL || s.rank[r].status != trouble[what].status)
          fail_msg("trouble %d, rank %d: %d %s", what, (int)r, (int)s.rank[r].status,
                   s.rank[r].message);
      assert_int_equal(s.allocator[r].live, 0);
    }
  }
}

/* A rank that falls silent at some call of the transport: the others end with an error. */
static void run_lost_rank(void *user, team *t, int32_t rank) {
  scene *s = user;
  result *r = &s->rank[rank];
  mps_domain *domain = NULL;
  mps_context *own = test_allocator_context(&s->allocator[rank]);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK) r->status = compute(own, domain, s, r);
  mps_domain_destroy(&domain);
  mps_context_destroy(&own);
}

static void test_lost_partner(void **state) {
  (void)state;
  for (int64_t deaf = 5; deaf < 80; deaf += 7) {
    scene s = {.what = STRIP, .short_run = true};
    team t;
    team_begin(&t, 3);
    t.limit = 0.5;
    t.member[1].deaf_at = deaf;
    team_run(&t, run_lost_rank, &s);
    team_end(&t);
    for (int32_t r = 0; r < 3; r++) {
      assert_int_equal(s.rank[r].status, MPS_ERROR_IO);
      assert_int_equal(s.allocator[r].live, 0);
      drop(&s.rank[r]);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_layers),         cmocka_unit_test(test_scattered),
      cmocka_unit_test(test_periodic),       cmocka_unit_test(test_strip),
      cmocka_unit_test(test_refused_memory), cmocka_unit_test(test_troubles),
      cmocka_unit_test(test_lost_partner),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
