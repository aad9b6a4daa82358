/* test_domain_dynamics.c - explicit dynamics on several ranks: every particle, reaction and total
 * has the bits of the run without a domain, on whatever number of ranks and threads; and an error
 * of one rank is an error of all.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "dynamics_scene.h"
#include "ranks_team.h"

TEST(test_layers) { compare_teams(compute, LAYERS, WHOLE_RUN, false); }
TEST(test_scattered) { compare_teams(compute, SCATTERED, WHOLE_RUN, true); }
TEST(test_periodic) { compare_teams(compute, PERIODIC, WHOLE_RUN, true); }
TEST(test_strip) { compare_teams(compute, STRIP, WHOLE_RUN, true); }

/* A body that falls apart shows the same on all ranks, and wherever in a call that is found. */
TEST(test_unstable) {
  result one = {0}, steps = {0};
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  compare_teams(compute, UNSTABLE, WHOLE_RUN, false);
  OK(compute(own, NULL, UNSTABLE, WHOLE_RUN, &one));
  OK(compute(own, NULL, UNSTABLE, SHORT_RUN, &steps));
  assert_memory_equal(field_of(&one, "displacement"), field_of(&steps, "displacement"),
                      (size_t)one.count * sizeof(double));
  drop(&one);
  drop(&steps);
}

/* ---- cut in two ------------------------------------------------------------------------------ */

#define CHECKPOINT "test_domain_dynamics.h5"

typedef struct cut_run {
  int what, halves;
  result rank[TEAM_MOST];
} cut_run;

static void run_half(void *user, team *t, int32_t rank) {
  cut_run *c = user;
  result *r = &c->rank[rank];
  scoped_domain *domain = NULL;
  scoped_context *own = team_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK)
    r->status = compute_halves(own, domain, c->what, c->halves, CHECKPOINT, r);
  snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
}

static void run_halves(cut_run *c, int32_t size) {
  team_compute(size, run_half, c);
  for (int32_t r = 0; r < size; r++)
    if (c->rank[r].status != MPS_OK) fail_msg("rank %d: %s", (int)r, c->rank[r].message);
}

static void drop_halves(cut_run *c, int32_t size) {
  for (int32_t r = 0; r < size; r++) drop(&c->rank[r]);
}

/* Written on 4 ranks, a run continues with the bits of one that was not cut: on 3, and on one
 * without a domain; written without a domain, on 3. */
static void compare_cut(int what) {
  if (!mps_library_has(MPS_FEATURE_HDF5)) skip();
  result alone = {0}, on = {0};
  scoped_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  OK(compute_halves(own, NULL, what, FIRST_HALF | SECOND_HALF, NULL, &alone));
  int64_t *seen = calloc((size_t)alone.count, sizeof *seen);
  cut_run first = {.what = what, .halves = FIRST_HALF};
  run_halves(&first, 4);
  drop_halves(&first, 4);
  OK(compute_halves(own, NULL, what, SECOND_HALF, CHECKPOINT, &on));
  compare(&alone, &on, seen);
  drop(&on);
  for (int round = 0; round < 2; round++) {
    cut_run second = {.what = what, .halves = SECOND_HALF};
    run_halves(&second, 3);
    for (int32_t r = 0; r < 3; r++) compare(&alone, &second.rank[r], seen);
    drop_halves(&second, 3);
    OK(compute_halves(own, NULL, what, FIRST_HALF, CHECKPOINT, &on));
    drop(&on);
  }
  free(seen);
  drop(&alone);
  remove(CHECKPOINT);
}

TEST(test_cut_layers) { compare_cut(LAYERS); }
TEST(test_cut_scattered) { compare_cut(SCATTERED); }

/* ---- what goes wrong on one rank ------------------------------------------------------------- */

TEST(test_refused_memory) { refuse_memory(compute, STRIP, SHORT_RUN, 1); }

/* One after the other, what ranks do not agree upon, or what fails on one of them: signals
 * of a load and a boundary that differ from some time on, an edit that is open on rank 1. */
#define DYNAMICS_TROUBLES(ROW)                                                                     \
  ROW(OTHER_SET, MPS_ERROR_ARGUMENT, "a hash of the set's particles")                              \
  ROW(OTHER_DT, MPS_ERROR_ARGUMENT, "dt is ")                                                      \
  ROW(OTHER_COUNT, MPS_ERROR_ARGUMENT, "count is ")                                                \
  ROW(DIVERGES, MPS_ERROR_DIVERGED, "diverged at step")                                            \
  ROW(CANCELLED, MPS_ERROR_CANCELLED, "stopped by the cancel hook")                                \
  ROW(SIGNAL_FAILS, MPS_ERROR_NUMERIC, "rank 2: ")                                                 \
  ROW(SIGNAL_DIFFERS, MPS_ERROR_ARGUMENT, "the present factor on a load is ")                      \
  ROW(DRIVEN_DIFFERS, MPS_ERROR_ARGUMENT, "the displacement of a boundary is ")                    \
  ROW(CALLBACK_FAILS, MPS_ERROR_IO, "rank 2: ")                                                    \
  ROW(UNKNOWN_ID, MPS_ERROR_ARGUMENT, "of 2 ids 1 are of particles of the set on any rank")        \
  ROW(REMOVAL, MPS_ERROR_UNSUPPORTED, "the particles lie on 3 ranks")                              \
  ROW(EDIT_SNAPSHOT, MPS_ERROR_STATE, "rank 1: field 'velocity' is being edited")                  \
  ROW(EDIT_SAVE, MPS_ERROR_STATE, "rank 1: field 'velocity' is being edited")                      \
  ROW(OTHER_LOAD, MPS_ERROR_ARGUMENT, "another value on others")                                   \
  ROW(OTHER_SIGNAL, MPS_ERROR_ARGUMENT, "another value on others")                                 \
  ROW(NO_LOAD, MPS_ERROR_ARGUMENT, "rank 1: def is NULL")                                          \
  ROW(OTHER_IDS, MPS_ERROR_ARGUMENT, "another value on others")                                    \
  ROW(OTHER_REMOVED, MPS_ERROR_ARGUMENT, "number is ")                                             \
  ROW(NO_SUCH_BOUNDARY, MPS_ERROR_ARGUMENT, "number is 7: there is no boundary")
enum { DYNAMICS_TROUBLES(CASE_NAME) TROUBLES };
static const trouble_case trouble[TROUBLES] = {DYNAMICS_TROUBLES(CASE_ROW)};

typedef struct upset {
  int32_t rank;
  int64_t asked;
} upset;

static mps_status failing(void *user, double t, double motion[3]) {
  const upset *u = user;
  motion[0] = motion[1] = motion[2] = 0.0;
  return u->rank == 2 && t > 0.01 ? MPS_ERROR_NUMERIC : MPS_OK;
}

/* A motion that is another one on rank 2 from 0.01 s on. */
static mps_status differing(void *user, double t, double motion[3]) {
  const upset *u = user;
  motion[0] = u->rank == 2 && t > 0.01 ? 1e-9 : 0.0;
  motion[1] = motion[2] = 0.0;
  return MPS_OK;
}

static mps_status refuse_callback(void *user, mps_dynamics *dynamics) {
  const upset *u = user;
  return u->rank == 2 && mps_dynamics_steps(dynamics) > 0 ? MPS_ERROR_IO : MPS_OK;
}

static int32_t cancel(void *user) { return ((upset *)user)->rank == 1; }

/* Loads and boundaries that are not the same on all ranks. */
static mps_status define_otherwise(mps_context *own, mps_dynamics *dynamics, int what,
                                   int32_t rank) {
  DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1);
  const double times[3] = {0.0, 0.1, 0.2}, values[3] = {0.0, 1.0, rank == 1 ? 0.51 : 0.5};
  const int64_t ids[2] = {17, rank == 1 ? 19 : 18};
  scoped_signal *signal = NULL;
  mps_status status =
      mps_signal_create_table(own, MPS_SIGNAL_QUANTITY_VALUE, 3, times, values, &signal);
  load.acceleration[0] = what == OTHER_LOAD ? 1.0 + rank : 1.0;
  if (what == OTHER_SIGNAL) load.signal[0] = signal;
  DEF(dynamics_boundary, boundary, .ids = ids, .id_count = what == OTHER_IDS ? 2 : 1,
      .dofs = MPS_DOF_X);
  TRY(mps_dynamics_add_boundary(dynamics, &boundary, NULL));
  if (what == NO_SUCH_BOUNDARY) TRY(mps_dynamics_remove_boundary(dynamics, rank == 2 ? 7 : 0));
  TRY(mps_dynamics_add_load(dynamics, what == NO_LOAD && rank == 1 ? NULL : &load, NULL));
  TRY(mps_dynamics_add_load(dynamics, &load, NULL));
  TRY(mps_dynamics_remove_load(dynamics, rank == 1 ? 1 : 0));
  return status;
}

/* Functions of the caller for a load or a boundary, which a step finds to differ or to fail. */
static mps_status step_with_signal(mps_context *own, mps_dynamics *dynamics, int what, upset *u) {
  DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[0] = 1.0);
  DEF(dynamics_boundary, base, .kind = MPS_BOUNDARY_DRIVEN);
  const int64_t id = 17;
  scoped_signal *signal = NULL;
  mps_status status = mps_signal_create_user(
      own, what == DRIVEN_DIFFERS ? MPS_SIGNAL_QUANTITY_DISPLACEMENT : MPS_SIGNAL_QUANTITY_VALUE,
      what == SIGNAL_FAILS ? failing : differing, u, NULL, &signal);
  base.ids = &id, base.id_count = 1, base.dofs = MPS_DOF_X;
  *(what == DRIVEN_DIFFERS ? &base.signal[0] : &load.signal[0]) = signal;
  if (what == DRIVEN_DIFFERS) TRY(mps_dynamics_add_boundary(dynamics, &base, NULL));
  if (what != DRIVEN_DIFFERS) TRY(mps_dynamics_add_load(dynamics, &load, NULL));
  TRY(mps_dynamics_step(dynamics, 1000));
  if (mps_dynamics_time(dynamics) > 0.011 || mps_dynamics_steps(dynamics) == 0)
    status = MPS_ERROR_INTERNAL; /* the step before is the last one made */
  return status;
}

static mps_status keep_while_edited(mps_dynamics *dynamics, int what, int32_t rank) {
  mps_particles *set = mps_dynamics_particles(dynamics);
  mps_snapshot *snapshot = NULL;
  mps_edit edit;
  mps_status status = MPS_OK;
  if (rank == 1) status = mps_particles_edit(set, "velocity", &edit);
  if (status == MPS_OK)
    status = what == EDIT_SAVE ? mps_dynamics_save(dynamics, TEST_TMP "/edited.h5", NULL)
                               : mps_dynamics_snapshot(dynamics, &snapshot);
  if (rank == 1 && mps_particles_commit(set, &edit) != MPS_OK) status = MPS_ERROR_INTERNAL;
  return status;
}

static mps_status run_trouble(mps_context *own, mps_domain *domain, int what) {
  scoped_particles *set = NULL;
  scoped_dynamics *dynamics = NULL;
  upset u = {.rank = mps_domain_rank(domain)};
  DEF(dynamics, def, .domain = domain, .dt = what == OTHER_DT ? 1e-4 * (1.0 + u.rank) : NAN);
  mps_status status = make_set(own, NULL, STRIP, &set);
  if (what == OTHER_SET && u.rank == 1) TRY(mps_particles_set(set, "density", 0, 2000.0));
  status = mps_domain_agree(domain, status);
  const int64_t before = mps_particles_count(set);
  TRY(mps_dynamics_create(own, set, &def, &dynamics));
  if (status != MPS_OK && mps_particles_count(set) != before) status = MPS_ERROR_INTERNAL;
  if (status == MPS_OK && what == OTHER_COUNT) status = mps_dynamics_step(dynamics, 1 + u.rank);
  if (status == MPS_OK && what == DIVERGES) status = mps_dynamics_set_dt(dynamics, 0.05);
  if (status == MPS_OK && what == DIVERGES) status = mps_dynamics_step(dynamics, 10000);
  if (status == MPS_OK && what == CANCELLED) {
    mps_context_set_cancel(own, cancel, &u, NULL);
    status = mps_dynamics_step(dynamics, 10);
  }
  if (status == MPS_OK && what >= SIGNAL_FAILS && what <= DRIVEN_DIFFERS)
    status = step_with_signal(own, dynamics, what, &u);
  if (status == MPS_OK && what == CALLBACK_FAILS)
    status = mps_dynamics_run(dynamics, 1.0, 5, refuse_callback, &u);
  if (status == MPS_OK && what == UNKNOWN_ID) {
    const int64_t ids[2] = {17, 123456};
    int32_t number;
    DEF(dynamics_boundary, boundary, .ids = ids, .id_count = 2, .dofs = MPS_DOF_X);
    status = mps_dynamics_add_boundary(dynamics, &boundary, &number);
  }
  if (status == MPS_OK && what == REMOVAL) {
    mps_view id;
    TRY(mps_particles_view(set, "id", &id));
    const int64_t gone[1] = {*mps_view_i64(&id, 0, 0)};
    TRY(mps_particles_remove(set, gone, 1));
  }
  if (status == MPS_OK && (what == EDIT_SNAPSHOT || what == EDIT_SAVE))
    status = keep_while_edited(dynamics, what, u.rank);
  if (status == MPS_OK && what >= OTHER_LOAD)
    status = define_otherwise(own, dynamics, what, u.rank);
  return status;
}

static void run_trouble_rank(void *user, team *t, int32_t rank) {
  ranks *s = user;
  result *r = &s->rank[rank];
  scoped_domain *domain = NULL;
  scoped_context *own = test_allocator_context(&s->allocator[rank]);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK) r->status = run_trouble(own, domain, s->what);
  snprintf(r->message, sizeof r->message, "%s", mps_context_error(own)->message);
}

TEST(test_troubles) {
  for (int what = 0; what < TROUBLES; what++) {
    ranks s = {.what = what};
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
  ranks *s = user;
  result *r = &s->rank[rank];
  scoped_domain *domain = NULL;
  scoped_context *own = test_allocator_context(&s->allocator[rank]);
  const mps_domain_def def = team_domain_def(t, rank);
  r->status = mps_domain_create(own, &def, &domain);
  if (r->status == MPS_OK) r->status = compute(own, domain, s->what, s->length, r);
}

TEST(test_lost_partner) {
  for (int64_t deaf = 5; deaf < 80; deaf += 7) {
    ranks s = {.what = STRIP, .length = SHORT_RUN};
    team t;
    team_begin(&t, 3);
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
