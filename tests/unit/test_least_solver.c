/* test_least_solver.c - the least that a solver is, to copy (docs/architecture.md, "A new solver"):
 * particles that fall freely. It has a definition that may grow, holds its set, steps by all
 * threads, refuses edits under way and calls from callbacks, and goes back bit for bit. In the
 * library names are mps_x_..., the struct is private to its folder, and the definition is in a
 * public header. SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/table.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"

/* ---- the public header ----------------------------------------------------------------------- */

typedef struct fall fall;

typedef struct fall_def {
  uint32_t struct_size;
  int32_t reserved;
  double gravity; /* m/s2 along the last axis, finite; no default */
  double dt;      /* s, > 0; default 1e-3 */
} fall_def;

/* ---- the table of its members, in src/core/definition -----------------------------------------
 */

#define MPSI_RELEASED_fall_def 24 /* bytes; scripts/update-sizes writes that of a public struct */

/* clang-format off */
#define FALL(X, S) \
  X(S, INT,  reserved, 1, "",     RESERVED,          0,     OWN) \
  X(S, REAL, gravity,  1, "m/s2", FINITE,            UNSET, SAME) \
  X(S, REAL, dt,       1, "s",    ABOVE(0, DBL_MAX), 1e-3,  SAME)
MPSI_DEFINITION(fall_def, "fall", FALL)
/* clang-format on */

/* ---- the solver ------------------------------------------------------------------------------ */

struct fall {
  mps_context *owner;
  mps_particles *particles;
  fall_def def;
  mpsi_holder holder; /* of the set, which refers to this member: released before the solver is */
  mpsi_guard guard;
  mpsi_identity *identity; /* of its snapshots */
  double time;
  int64_t steps, count;
  double *x, *v; /* columns of the set, bound again where they may have moved */
};

static void bind(void *solver) {
  fall *f = solver;
  const int32_t last = mps_particles_dim(f->particles) - 1;
  f->count = mps_particles_count(f->particles);
  f->x = mpsi_particles_column(f->particles, "position", last);
  f->v = mpsi_particles_column(f->particles, "velocity", last);
}

/* Particles come with velocity 0 and leave without a trace: nothing is to be prepared. */
static mps_status insert(void *self, const char *function, int64_t first, int64_t count) {
  (void)self, (void)function, (void)first, (void)count;
  return MPS_OK;
}

static mps_status leave(void *self, const char *function, int64_t count, const int64_t *ids) {
  (void)self, (void)function, (void)count, (void)ids;
  return MPS_OK;
}

/* Checks everything before it changes anything; on an error the set is as before. */
static mps_status fall_create(mps_context *owner, mps_particles *particles, const fall_def *user,
                              fall **out) {
  fall_def def;
  if (!owner) return MPS_ERROR_ARGUMENT;
  if (!particles || !out)
    return mpsi_fail(owner, __func__, MPS_ERROR_ARGUMENT, "particles or out is NULL");
  *out = NULL;
  mps_status status = MPSI_DEF_READ(owner, __func__, fall_def, user, &def);
  if (status == MPS_OK) status = mpsi_particles_check_hold(particles, __func__, MPSI_USE_MOVE);
  if (status == MPS_OK) status = mpsi_particles_check_deal(particles, __func__, NULL);
  if (status != MPS_OK) return status;
  fall *f = mpsi_alloc(owner, 1, sizeof *f);
  if (!f) return mpsi_fail_memory(owner, __func__, sizeof *f);
  status = mpsi_as(owner, __func__, mps_particles_add_field(particles, "velocity", 0));
  if (status != MPS_OK) {
    mpsi_free(owner, f);
    return status;
  }
  f->owner = mpsi_context_retain(owner);
  f->particles = particles;
  f->def = def;
  bind(f);
  f->holder = (mpsi_holder){.name = "a solver of free fall",
                            .self = f,
                            .kind = MPSI_USE_MOVE,
                            .guard = &f->guard,
                            .insert = insert,
                            .remove = leave,
                            .renew = bind};
  (void)mpsi_particles_hold(particles, __func__, &f->holder); /* checked above */
  *out = f;
  return MPS_OK;
}

static void fall_destroy(fall **fallen) {
  if (!fallen || !*fallen) return;
  fall *f = *fallen;
  if (mpsi_guard_check(&f->guard, f->owner, __func__) != MPS_OK) return;
  mps_context *owner = f->owner;
  *fallen = NULL;
  mpsi_state_forget(&f->identity);
  mpsi_particles_release(f->particles, &f->holder);
  mpsi_free(owner, f);
  mpsi_context_release(owner);
}

/* Particles of a unit of work: their number depends on the set, not on threads. */
#define BLOCK 64

static void move_block(void *data, int64_t block, int32_t worker) {
  (void)worker;
  const fall *f = data;
  const double dt = f->def.dt, dv = f->def.gravity * dt;
  const int64_t end = (block + 1) * BLOCK < f->count ? (block + 1) * BLOCK : f->count;
  for (int64_t k = block * BLOCK; k < end; k++) {
    f->x[k] += dt * (f->v[k] + 0.5 * dv);
    f->v[k] += dv;
  }
}

static mps_status fall_step(fall *f, int64_t count) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_guard_check(&f->guard, f->owner, __func__);
  if (status == MPS_OK) status = mpsi_particles_ready(f->particles, __func__);
  if (status != MPS_OK) return status;
  if (count < 0)
    return mpsi_fail(f->owner, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  for (int64_t k = 0; k < count; k++) {
    mpsi_parallel_for(f->owner, (f->count + BLOCK - 1) / BLOCK, move_block, f);
    status = mpsi_executor_check(f->owner, __func__);
    if (status != MPS_OK) return status;
    f->time += f->def.dt;
    f->steps++;
  }
  return MPS_OK;
}

/* ---- its state ------------------------------------------------------------------------------- */

static void list_state(mpsi_state *s, void *solver) {
  fall *f = solver;
  mpsi_state_agree_number(s, "gravity", f->def.gravity);
  mpsi_state_f64(s, "time", &f->time, 1);
  mpsi_state_i64(s, "steps", &f->steps, 1);
}

static mpsi_state_of state_of(fall *f) {
  return (mpsi_state_of){.solver = f,
                         .name = "free fall",
                         .context = f->owner,
                         .particles = f->particles,
                         .identity = &f->identity,
                         .list = list_state,
                         .bind = bind,
                         .time = f->time,
                         .dt = f->def.dt,
                         .steps = f->steps};
}

static mps_status fall_snapshot(fall *f, mps_snapshot **snapshot) {
  const mpsi_state_of of = state_of(f);
  const mps_status status = mpsi_guard_check_between(&f->guard, f->owner, __func__);
  return status == MPS_OK ? mpsi_state_snapshot(&of, __func__, snapshot) : status;
}

static mps_status fall_rollback(fall *f, const mps_snapshot *snapshot) {
  const mpsi_state_of of = state_of(f);
  const mps_status status = mpsi_guard_check(&f->guard, f->owner, __func__);
  return status == MPS_OK ? mpsi_state_rollback(&of, __func__, snapshot) : status;
}

/* ---- tests ----------------------------------------------------------------------------------- */

#include "test_fixture.h"

static mps_particles *make_set(void) {
  mps_particles *set = NULL;
  const double lo[2] = {0.0, 0.0}, hi[2] = {3.0, 50.0};
  USING(particles, mps_particles_create(context, &given, &set), .spacing = 1.0);
  OK(mps_particles_fill_box(set, lo, hi, NULL));
  return set;
}

static fall *make(mps_particles *set) {
  fall_def def;
  fall *f = NULL;
  mpsi_definition_fill(&mpsi_definition_of_fall_def, &def, sizeof def);
  def.gravity = -9.81;
  OK(fall_create(context, set, &def, &f));
  return f;
}

static double lowest(mps_particles *set) {
  mps_view x;
  double low = INFINITY;
  OK(mps_particles_view(set, "position", &x));
  for (int64_t k = 0; k < x.shape[0]; k++) low = fmin(low, *mps_view_f64(&x, k, 1));
  return low;
}

TEST(it_falls_along_the_parabola) {
  scoped_particles *set = make_set();
  fall *f = make(set);
  const double start = lowest(set);
  OK(fall_step(f, 500));
  NEAR(f->time, 0.5, 1e-12);
  NEAR(lowest(set), start - 0.5 * 9.81 * 0.25, 1e-12);
  fall_destroy(&f);
  assert_null(f);
}

TEST(it_goes_back_bit_for_bit) {
  scoped_particles *set = make_set();
  fall *f = make(set), *other = NULL;
  scoped_snapshot *then = NULL;
  OK(fall_step(f, 7));
  OK(fall_snapshot(f, &then));
  OK(fall_step(f, 11));
  const double there = lowest(set), time = f->time;
  OK(fall_rollback(f, then));
  assert_int_equal(f->steps, 7);
  OK(fall_step(f, 11));
  assert_true(lowest(set) == there && f->time == time);
  fall_destroy(&f);
  other = make(set);
  REFUSES(fall_rollback(other, then), "snapshot");
  fall_destroy(&other);
}

TEST(what_is_wrong_is_refused) {
  scoped_particles *set = make_set();
  const int32_t fields = mps_particles_field_count(set);
  fall_def def;
  fall *f = NULL, *second = NULL;
  mps_edit edit;
  mpsi_definition_fill(&mpsi_definition_of_fall_def, &def, sizeof def);
  REFUSES(fall_create(context, set, &def, &f), "gravity is nan");
  assert_int_equal(mps_particles_field_count(set), fields);
  f = make(set);
  def.gravity = 1.0;
  FAILS(fall_create(context, set, &def, &second), MPS_ERROR_STATE, "a solver of free fall");
  REFUSES(fall_step(f, -1), "count is -1");
  OK(mps_particles_edit(set, "velocity", &edit));
  FAILS(fall_step(f, 1), MPS_ERROR_STATE, "velocity");
  OK(mps_particles_abandon(set, &edit));
  mpsi_guard_enter(&f->guard, context, "a callback");
  FAILS(fall_step(f, 1), MPS_ERROR_STATE, "a callback");
  mpsi_guard_end(&f->guard);
  assert_int_equal(f->steps, 0);
  fall_destroy(&f);
}

TEST(particles_come_and_go) {
  scoped_particles *set = make_set();
  fall *f = make(set);
  const double more[2] = {1.5, -1.0};
  const int64_t first = 0;
  OK(mps_particles_append(set, 1, more));
  OK(mps_particles_remove(set, &first, 1));
  assert_int_equal(f->count, 150);
  OK(fall_step(f, 1));
  NEAR(lowest(set), -1.0 - 0.5 * 9.81e-6, 1e-15);
  fall_destroy(&f);
}

/* Its state has no room for other particles: it goes back only to those that it has. */
TEST(other_particles_have_another_state) {
  scoped_particles *set = make_set();
  fall *f = make(set);
  scoped_snapshot *then = NULL;
  const double place[2] = {1.5, -1.0};
  const int64_t first = 0;
  OK(fall_snapshot(f, &then));
  OK(fall_step(f, 3));
  OK(mps_particles_remove(set, &first, 1));
  const double there = lowest(set);
  FAILS(fall_rollback(f, then), MPS_ERROR_STATE, "the state is of 150 particles, the set has 149");
  OK(mps_particles_append(set, 1, place));
  FAILS(fall_rollback(f, then), MPS_ERROR_STATE, "a particle of id 0, the set has none");
  assert_true(f->steps == 3 && lowest(set) == fmin(there, -1.0)); /* nothing has changed */
  fall_destroy(&f);
}
