/* test_hdf5_solvers.c - all solvers as one (mps/solver.h): the same code steps, runs, saves,
 * restores and rolls back each of them. SPDX-License-Identifier: BSD-3-Clause */
#include "digest.h"
#include "solver_scenes.h"

static const char path[] = TEST_TMP "/solvers.h5";

static uint64_t digest_of(const scene *s) {
  static const char *const fields[] = {"position", "velocity", NULL};
  uint64_t hash = digest_fields(s->set, fields);
  const double time = mps_solver_time(s->solver);
  return digest_add(hash, &time);
}

static int32_t patience;
static int32_t asked(void *user) { return ++*(int32_t *)user > patience; }

static struct {
  int32_t calls;
  double fraction, end;
} progress;
static void on_progress(void *user, const mps_context_progress *now) {
  (void)user;
  assert_true(now->fraction >= progress.fraction);
  progress.calls++, progress.fraction = now->fraction, progress.end = now->time_end;
}

static mps_context *hooked(int32_t *asks) {
  mps_context_def def = test_context_defaults();
  mps_context *made = NULL;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.cancel = asked, def.cancel_user = asks;
  def.progress = on_progress;
  patience = INT32_MAX, *asks = 0;
  OK(mps_context_create(&def, &made, NULL, 0));
  return made;
}

TEST(the_same_steps_lead_to_the_same_bits) {
  int32_t asks;
  scoped_context *c = hooked(&asks);
  for (int k = 0; k < KINDS; k++) {
    scene s = kinds[k].make(c), other = kinds[k].make(c);
    mps_snapshot *snapshot = NULL;
    OK(mps_solver_step(s.solver, 3));
    assert_int_equal(mps_solver_steps(s.solver), 3);
    OK(mps_solver_snapshot(s.solver, &snapshot));
    OK(mps_solver_save(s.solver, path, NULL));
    const uint64_t at = digest_of(&s);
    OK(mps_solver_step(s.solver, 5));
    const uint64_t after = digest_of(&s);
    assert_true(after != at);
    OK(mps_solver_rollback(s.solver, snapshot));
    assert_int_equal(mps_solver_steps(s.solver), 3);
    assert_true(digest_of(&s) == at);
    OK(mps_solver_step(s.solver, 5));
    assert_true(digest_of(&s) == after);
    OK(mps_solver_restore(other.solver, path, NULL));
    assert_int_equal(mps_solver_steps(other.solver), 3);
    OK(mps_solver_step(other.solver, 5));
    assert_true(digest_of(&other) == after);
    FAILS_ON(c, mps_solver_rollback(other.solver, snapshot), MPS_ERROR_ARGUMENT, "");
    mps_snapshot_destroy(&snapshot);
    drop(&s), drop(&other);
  }
}

typedef struct seen {
  mps_context *context;
  mps_solver *solver;
  mps_snapshot *snapshot;
  int32_t calls;
} seen;

/* Between two steps: only what reads is allowed. */
static mps_status look(void *user, mps_solver *solver) {
  seen *s = user;
  assert_ptr_equal(solver, s->solver);
  FAILS_ON(s->context, mps_solver_step(solver, 1), MPS_ERROR_STATE, "callback");
  FAILS_ON(s->context, mps_solver_set_dt(solver, 1e-9), MPS_ERROR_STATE, "callback");
  FAILS_ON(s->context, mps_solver_remove_load(solver, 0), MPS_ERROR_STATE, "callback");
  mps_solver *same = solver;
  mps_solver_destroy(&same);
  assert_ptr_equal(same, solver);
  if (s->snapshot)
    FAILS_ON(s->context, mps_solver_rollback(solver, s->snapshot), MPS_ERROR_STATE, "callback");
  OK(mps_solver_snapshot(solver, &s->snapshot));
  s->calls++;
  return MPS_OK;
}

TEST(a_run_ends_where_it_should_and_calls_back) {
  int32_t asks;
  scoped_context *c = hooked(&asks);
  for (int k = 0; k < KINDS; k++) {
    SCOPED(drop) scene s = kinds[k].make(c);
    seen view = {.context = c, .solver = s.solver};
    const double dt = mps_solver_dt(s.solver), t_end = 7.3 * dt;
    assert_true(dt > 0.0 && dt <= mps_solver_limit(s.solver));
    asks = 0, progress.calls = 0, progress.fraction = 0.0;
    OK(mps_solver_run(s.solver, t_end, 3, look, &view));
    const int64_t steps = mps_solver_steps(s.solver);
    assert_true(mps_solver_time(s.solver) == t_end);
    assert_true(steps >= 8 && steps <= 9);
    assert_int_equal(view.calls, 2 + (steps - 1) / 3);
    assert_true(asks == steps || strcmp(kinds[k].name, "elastic") == 0); /* it asks within */
    assert_true(progress.calls == steps && progress.fraction == 1.0 && progress.end == t_end);
    OK(mps_solver_run(s.solver, t_end, 1, look, &view)); /* no step */
    assert_int_equal(mps_solver_steps(s.solver), steps);
    mps_snapshot_destroy(&view.snapshot);
  }
}

TEST(the_cancel_hook_is_asked_before_each_step) {
  int32_t asks;
  scoped_context *c = hooked(&asks);
  for (int k = 0; k < KINDS; k++) {
    const bool batches = strcmp(kinds[k].name, "dynamics") == 0; /* it asks after much work */
    SCOPED(drop) scene s = kinds[k].make(c);
    asks = 0, patience = 0;
    const uint64_t at = digest_of(&s);
    FAILS_ON(c, mps_solver_step(s.solver, 2), MPS_ERROR_CANCELLED, "cancel hook at step 0");
    assert_true(digest_of(&s) == at);
    assert_int_equal(mps_context_error(c)->step, 0);
    asks = 0, patience = 2;
    const mps_status status = mps_solver_step(s.solver, 50);
    assert_int_equal(status, batches ? MPS_OK : MPS_ERROR_CANCELLED);
    assert_int_equal(mps_solver_steps(s.solver), batches ? 50 : 2);
    patience = INT32_MAX;
    OK(mps_solver_step(s.solver, 1));
  }
}

TEST(what_is_refused_names_the_function_of_the_kind) {
  int32_t asks;
  scoped_context *c = hooked(&asks);
  for (int k = 0; k < KINDS; k++) {
    SCOPED(drop) scene s = kinds[k].make(c);
    char name[64];
    mps_reaction reaction;
    mps_totals totals;
    const uint64_t at = digest_of(&s);
    FAILS_ON(c, mps_solver_step(s.solver, -1), MPS_ERROR_ARGUMENT, "count is -1");
    snprintf(name, sizeof name, "mps_%s_step", kinds[k].name);
    assert_string_equal(mps_context_error(c)->function, name);
    FAILS_ON(c, mps_solver_run(s.solver, NAN, 1, NULL, NULL), MPS_ERROR_ARGUMENT, "t_end");
    FAILS_ON(c, mps_solver_run(s.solver, -1.0, 1, NULL, NULL), MPS_ERROR_ARGUMENT, "t_end");
    FAILS_ON(c, mps_solver_run(s.solver, 1.0, 0, NULL, NULL), MPS_ERROR_ARGUMENT, "every is 0");
    FAILS_ON(c, mps_solver_set_dt(s.solver, -1.0), MPS_ERROR_ARGUMENT, "dt");
    FAILS_ON(c, mps_solver_get_reaction(s.solver, 99, &reaction), MPS_ERROR_ARGUMENT, "99");
    FAILS_ON(c, mps_solver_remove_boundary(s.solver, 99), MPS_ERROR_ARGUMENT, "99");
    FAILS_ON(c, mps_solver_remove_load(s.solver, 99), MPS_ERROR_ARGUMENT, "99");
    FAILS_ON(c, mps_solver_get_totals(s.solver, NULL), MPS_ERROR_ARGUMENT, "NULL");
    FAILS_ON(c, mps_solver_snapshot(s.solver, NULL), MPS_ERROR_ARGUMENT, "NULL");
    FAILS_ON(c, mps_solver_rollback(s.solver, NULL), MPS_ERROR_ARGUMENT, "NULL");
    FAILS_ON(c, mps_solver_save(s.solver, NULL, NULL), MPS_ERROR_ARGUMENT, "NULL");
    FAILS_ON(c, mps_solver_restore(s.solver, TEST_TMP "/none.h5", NULL), MPS_ERROR_IO, "");
    assert_true(digest_of(&s) == at);
    OK(mps_solver_get_totals(s.solver, &totals));
    assert_true(totals.mass > 0.0);
    assert_ptr_equal(mps_solver_particles(s.solver), s.set);
    assert_ptr_equal(mps_solver_context(s.solver), c);
  }
}

TEST(none_is_a_solver_of_no_state) {
  mps_solver *none = NULL;
  mps_snapshot *snapshot = NULL;
  mps_reaction reaction;
  mps_totals totals;
  assert_int_equal(mps_solver_step(none, 1), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_run(none, 1.0, 1, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_set_dt(none, 1.0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_get_totals(none, &totals), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_get_reaction(none, 0, &reaction), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_add(none, MPS_DEF_DYNAMICS_LOAD, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_set(none, MPS_DEF_DYNAMICS_LOAD, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_get_def(none, MPS_DEF_DYNAMICS, &totals, sizeof totals),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_remove_boundary(none, 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_remove_load(none, 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_snapshot(none, &snapshot), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_rollback(none, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_save(none, path, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_solver_restore(none, path, NULL), MPS_ERROR_ARGUMENT);
  assert_true(mps_solver_time(none) == 0.0 && mps_solver_dt(none) == 0.0);
  assert_true(mps_solver_limit(none) == 0.0 && mps_solver_steps(none) == 0);
  assert_null(mps_solver_particles(none));
  assert_null(mps_solver_context(none));
  assert_null(mps_mpm_solver(NULL));
  assert_null(mps_dynamics_solver(NULL));
  assert_null(mps_elastic_solver(NULL));
  assert_null(mps_fluid_solver(NULL));
  mps_solver_destroy(&none);
  mps_solver_destroy(NULL);
}
