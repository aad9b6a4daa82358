/* test_dynamics_run.c - running the explicit MPS solver: hooks, restart, rollback, change of the
 * time step, divergence, warnings. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "soil_column.h"
#include "test_fixture.h"

#define DT 2e-3 /* s, about half the limit */

static const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};

/* What the hooks of a context saw, and their results. */
typedef struct hooks {
  int warnings, progress, callbacks;
  int cancel_after; /* cancel at that call, 0 never */
  int cancels;
  double fraction, last_time;
  bool rising;
  char text[256];
  mps_status answer; /* of the callback */
} hooks;

static void on_log(void *user, int32_t level, const char *message) {
  hooks *h = user;
  h->warnings += level == MPS_CONTEXT_LOG_WARNING;
  snprintf(h->text, sizeof h->text, "%s", message);
}

static void on_progress(void *user, const mps_context_progress *progress) {
  hooks *h = user;
  h->rising = h->rising && progress->fraction >= h->fraction;
  h->fraction = progress->fraction;
  h->progress++;
}

static int32_t on_cancel(void *user) {
  hooks *h = user;
  return ++h->cancels == h->cancel_after;
}

static mps_context *hooked(hooks *h) {
  mps_context_def def = test_context_defaults();
  mps_context *own = NULL;
  *h = (hooks){.rising = true};
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.log = on_log;
  def.progress = on_progress;
  def.cancel = on_cancel;
  def.log_user = def.progress_user = def.cancel_user = h;
  OK(mps_context_create(&def, &own, NULL, 0));
  return own;
}

/* What a test has made; `own` NULL: it used the common context. */
static void drop(mps_dynamics **d, mps_particles **set, mps_context **own) {
  mps_dynamics_destroy(d);
  mps_particles_destroy(set);
  mps_context_destroy(own);
}

/* A block of 6 x 6 particles, D = 1 m, shaken by smooth initial velocities; damping ratios
 * about h. */
static mps_dynamics *shaken(mps_context *own, const mps_dynamics_def *def, double h,
                            mps_particles **set) {
  soil_layer damped = soil;
  damped.damping = h;
  *set = soil_particles(own, 1.0, 6.0, 6.0, 1, &damped);
  SET_FIELDS(*set, {"velocity", 0.0}, {"spin", 0.0});
  EDIT(v, *set, "velocity") {
    mps_view x = view_field(*set, "position");
    EDIT(w, *set, "spin")
      EDIT(ratio, *set, "damping")
        for (int64_t k = 0; k < v.view.shape[0]; k++) {
          *mps_edit_f64(&v, k, 0) = 1e-3 * sin(1.0 + *mps_view_f64(&x, k, 1));
          *mps_edit_f64(&v, k, 1) = 1e-3 * cos(2.0 * *mps_view_f64(&x, k, 0));
          *mps_edit_f64(&w, k, 0) = 1e-3 * sin(3.0 * *mps_view_f64(&x, k, 0));
          *mps_edit_f64(&ratio, k, 0) *= 1.0 + 0.5 * sin((double)k);
        }
  }
  MAKE_KEPT(dynamics, dynamics, create, own, *set, def);
  return dynamics;
}

static mps_dynamics_def def_of(int integrator, double dt) {
  DEF(dynamics, def, .integrator = integrator, .dt = dt);
  return def;
}

/* Copies a field of every particle, by id, into `out` (component 0). */
static void copy(mps_particles *set, const char *field, int component, double *out) {
  for (int64_t id = 0; id < mps_particles_count(set); id++)
    out[id] = soil_value(set, field, id, component);
}

static double largest_difference(const double *a, const double *b, int64_t n) {
  double most = 0.0;
  for (int64_t k = 0; k < n; k++) most = fmax(most, fabs(a[k] - b[k]));
  return most;
}

/* ---- the loop -------------------------------------------------------------------------------- */

static mps_status on_call(void *user, mps_dynamics *dynamics) {
  hooks *h = user;
  h->last_time = mps_dynamics_time(dynamics);
  return ++h->callbacks == 3 ? h->answer : MPS_OK;
}

TEST(a_run_calls_its_callback_at_start_every_and_end) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(own, &def, 0.0, &set);
  OK(mps_dynamics_run(d, 10.0 * DT, 3, on_call, &h));
  assert_int_equal(h.callbacks, 5); /* 0, 3, 6, 9, 10 */
  assert_int_equal(mps_dynamics_steps(d), 10);
  NEAR(h.last_time, 10.0 * DT, 1e-15);
  OK(mps_dynamics_run(d, 10.0 * DT, 3, on_call, &h)); /* already there */
  assert_int_equal(h.callbacks, 6);
  assert_int_equal(mps_dynamics_steps(d), 10);
  OK(mps_dynamics_run(d, 12.5 * DT, 100, NULL, NULL)); /* three shorter steps */
  assert_int_equal(mps_dynamics_steps(d), 13);
  assert_true(mps_dynamics_time(d) == 12.5 * DT);
  drop(&d, &set, &own);
}

TEST(progress_rises_to_one_in_a_hundred_reports) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(own, &def, 0.0, &set);
  OK(mps_dynamics_run(d, 1234.0 * DT, 1000, NULL, NULL));
  assert_true(h.rising);
  NEAR(h.fraction, 1.0, 1e-12);
  assert_true(h.progress >= 95 && h.progress <= 110);
  assert_true(h.cancels >= 95 && h.cancels <= 110);
  h = (hooks){.rising = true}; /* a second run starts again from 0 */
  OK(mps_dynamics_run(d, 1284.0 * DT, 1000, NULL, NULL));
  assert_int_equal(h.progress, 50);
  assert_true(h.rising);
  NEAR(h.fraction, 1.0, 1e-12);
  drop(&d, &set, &own);
}

TEST(the_cancel_hook_stops_a_run_which_can_go_on) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(own, &def, 0.0, &set);
  h.cancel_after = 7;
  FAILS_ON(own, mps_dynamics_run(d, 50.0 * DT, 1000, NULL, NULL), MPS_ERROR_CANCELLED,
           "at step 6, t = 0.012 s");
  assert_int_equal(mps_dynamics_steps(d), 6);
  double x[36], again[36];
  copy(set, "velocity", 0, x); /* published */
  OK(mps_dynamics_step(d, 0));
  copy(set, "velocity", 0, again);
  assert_memory_equal(x, again, sizeof x);
  OK(mps_dynamics_run(d, 50.0 * DT, 1000, NULL, NULL));
  assert_int_equal(mps_dynamics_steps(d), 50);
  drop(&d, &set, &own);
}

TEST(the_callback_stops_a_run_with_its_own_status) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(own, &def, 0.0, &set);
  h.answer = MPS_ERROR_IO;
  FAILS_ON(own, mps_dynamics_run(d, 50.0 * DT, 4, on_call, &h), MPS_ERROR_IO,
           "the callback of mps_dynamics_run returned status 5");
  assert_int_equal(mps_context_error(own)->step, 8);
  assert_int_equal(mps_dynamics_steps(d), 8);
  drop(&d, &set, &own);
}

/* Tries all that a callback must not do. */
static mps_status meddle(void *user, mps_dynamics *dynamics) {
  int *tries = user;
  const mps_context *own = mps_dynamics_context(dynamics);
  const mps_dynamics_boundary_def def = mps_dynamics_boundary_defaults();
  const mps_dynamics_load_def load = mps_dynamics_load_defaults();
  mps_dynamics *same = dynamics;
  scoped_snapshot *snapshot = NULL;
  int32_t number;
  mps_dynamics_destroy(&same);
  assert_ptr_equal(same, dynamics); /* does nothing */
  assert_int_equal(mps_context_error(own)->status, MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_step(dynamics, 1), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_run(dynamics, 9.0, 1, NULL, NULL), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_restart(dynamics, 0.0), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_set_dt(dynamics, 1e-3), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_refresh(dynamics), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_add_boundary(dynamics, &def, &number), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_set_boundary(dynamics, 0, &def), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_remove_boundary(dynamics, 0), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_add_load(dynamics, &load, &number), MPS_ERROR_STATE);
  assert_int_equal(mps_dynamics_snapshot(dynamics, &snapshot), MPS_OK); /* reading is free */
  assert_int_equal(mps_dynamics_rollback(dynamics, snapshot), MPS_ERROR_STATE);
  (*tries)++;
  return MPS_OK;
}

TEST(a_callback_may_only_read) {
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(context, &def, 0.0, &set);
  int tries = 0;
  OK(mps_dynamics_run(d, 10.5 * DT, 4, meddle, &tries));
  assert_int_equal(tries, 4); /* 0, 4, 8, 11 */
  assert_int_equal(mps_dynamics_steps(d), 11);
  assert_true(mps_dynamics_time(d) == 10.5 * DT);
  NEAR(mps_dynamics_dt(d), DT, 0.0);
  REFUSES(mps_dynamics_run(d, 10.0 * DT, 1, NULL, NULL), "not before the solver");
  OK(mps_dynamics_step(d, 1)); /* the guard is open again */
  drop(&d, &set, NULL);
}

TEST(step_asks_the_cancel_hook) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(own, &def, 0.0, &set);
  h.cancel_after = 1;
  FAILS_ON(own, mps_dynamics_step(d, 5), MPS_ERROR_CANCELLED, "cancel hook at step 0");
  assert_int_equal(mps_dynamics_steps(d), 0);
  OK(mps_dynamics_step(d, 5));
  drop(&d, &set, &own);
}

/* The accelerations after a look ahead are those that the next step starts from; all else stays. */
TEST(a_refresh_brings_accelerations_to_the_positions) {
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = NULL;
    const mps_dynamics_def def = def_of(integrator, 1e-3 / 3.0);
    scoped_dynamics *d = shaken(context, &def, 0.1, &set);
    double a[2][36], u[2][36];
    OK(mps_dynamics_step(d, 20));
    copy(set, "displacement", 0, u[0]);
    OK(mps_dynamics_refresh(d));
    copy(set, "acceleration", 0, a[0]);
    copy(set, "displacement", 0, u[1]);
    assert_memory_equal(u[0], u[1], sizeof u[0]);
    assert_int_equal(mps_dynamics_steps(d), 20);
    OK(mps_dynamics_step(d, 1));
    copy(set, "acceleration", 0, a[1]);
    assert_memory_equal(a[0], a[1], sizeof a[0]);
  }
}

/* ---- restart, rollback, dt ------------------------------------------------------------------- */

TEST(a_restart_repeats_the_run_at_another_time) {
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = NULL;
    const mps_dynamics_def def = def_of(integrator, DT);
    scoped_dynamics *d = shaken(context, &def, 0.1, &set);
    double start[5][36], first[36], second[36];
    const char *const fields[5] = {"displacement", "displacement", "rotation", "velocity",
                                   "velocity"};
    const int component[5] = {0, 1, 0, 0, 1};
    for (int f = 0; f < 5; f++) copy(set, fields[f], component[f], start[f]);
    double spin[36];
    copy(set, "spin", 0, spin);
    OK(mps_dynamics_step(d, 40));
    copy(set, "displacement", 1, first);
    for (int64_t id = 0; id < 36; id++) {
      mps_edit view;
      const int64_t k = mps_particles_index(set, id);
      for (int f = 0; f < 5; f++) {
        OK(mps_particles_edit(set, fields[f], &view));
        *mps_edit_f64(&view, k, component[f]) = start[f][id];
        OK(mps_particles_commit(set, &view));
      }
      OK(mps_particles_edit(set, "spin", &view));
      *mps_edit_f64(&view, k, 0) = spin[id];
      OK(mps_particles_commit(set, &view));
    }
    OK(mps_dynamics_restart(d, 7.0));
    assert_int_equal(mps_dynamics_steps(d), 0);
    NEAR(mps_dynamics_time(d), 7.0, 0.0);
    OK(mps_dynamics_step(d, 40));
    copy(set, "displacement", 1, second);
    assert_memory_equal(first, second, sizeof first);
    NEAR(mps_dynamics_time(d), 7.0 + 40.0 * DT, 1e-14);
  }
}

TEST(a_bad_state_cannot_be_restarted_from) {
  mps_particles *set;
  const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, DT);
  mps_dynamics *d = shaken(context, &def, 0.0, &set);
  OK(mps_dynamics_step(d, 4));
  mpsi_particles_column(set, "spin", 0)[mps_particles_index(set, 11)] = NAN;
  REFUSES(mps_dynamics_restart(d, 0.0), "particle 11");
  assert_int_equal(mps_dynamics_steps(d), 4);
  drop(&d, &set, NULL);
}

/* A driven, damped body goes back to a snapshot, also after other steps, a divergence and another
 * dt, and repeats what it did. */
TEST(a_rollback_repeats_a_run_bit_for_bit) {
  for (int integrator = 0; integrator < 3; integrator++)
    for (int64_t at = 0; at <= 40; at += 40) {
      const mps_dynamics_def def = def_of(integrator, 1e-3 / 3.0);
      const int64_t base[2] = {0, 35};
      scoped_particles *set = NULL;
      scoped_snapshot *snapshot = NULL;
      mps_reaction first, again;
      double one[36], two[36];
      MAKE(signal, sine, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 3.0, 0.01, 0.3);
      scoped_dynamics *d = shaken(context, &def, 0.1, &set);
      OK(soil_add_driven(d, 0, sine, 1.0, 1, &base[0]));
      OK(soil_add_viscous(d, NULL, 1, &base[1]));
      OK(mps_dynamics_step(d, at));
      OK(mps_dynamics_snapshot(d, &snapshot));
      const double time = mps_dynamics_time(d);
      OK(mps_dynamics_step(d, 60));
      copy(set, "displacement", 0, one);
      OK(mps_dynamics_get_reaction(d, 0, &first));
      OK(mps_dynamics_set_dt(d, 1.0));
      assert_int_equal(mps_dynamics_step(d, 2000), MPS_ERROR_DIVERGED);
      OK(mps_dynamics_rollback(d, snapshot));
      assert_true(mps_dynamics_time(d) == time && mps_dynamics_steps(d) == at);
      OK(mps_dynamics_step(d, 60));
      copy(set, "displacement", 0, two);
      OK(mps_dynamics_get_reaction(d, 0, &again));
      assert_memory_equal(one, two, sizeof one);
      assert_memory_equal(&first, &again, sizeof first);
      /* other boundaries than then are refused */
      OK(soil_add_held(d, MPS_DOF_X, 1, &base[1]));
      FAILS(mps_dynamics_rollback(d, snapshot), MPS_ERROR_STATE, "boundaries");
    }
}

/* A change of dt keeps velocity, time and what acts on the particles: the damping force is a rate
 * over the step that was, not the one to come. */
TEST(a_new_dt_keeps_velocity_time_and_forces) {
  for (int integrator = 0; integrator < 3; integrator++)
    for (int damping = 0; damping < 2; damping++) {
      double velocity[2][36], acceleration[2][36], largest = 0.0;
      for (int run = 0; run < 2; run++) {
        scoped_particles *set = NULL;
        mps_dynamics_def def = def_of(integrator, 5e-4);
        def.damping = damping;
        scoped_dynamics *d = shaken(context, &def, 0.3, &set);
        OK(mps_dynamics_step(d, 20));
        if (run == 1) OK(mps_dynamics_set_dt(d, 1e-4));
        NEAR(mps_dynamics_time(d), 0.01, 1e-15);
        assert_int_equal(mps_dynamics_steps(d), 20);
        OK(mps_dynamics_step(d, 0));
        copy(set, "velocity", 0, velocity[run]);
        OK(mps_dynamics_step(d, 1));
        copy(set, "acceleration", 0, acceleration[run]);
        NEAR(mps_dynamics_time(d), run == 0 ? 0.0105 : 0.0101, 1e-15);
      }
      for (int k = 0; k < 36; k++) largest = fmax(largest, fabs(acceleration[0][k]));
      assert_true(largest > 1e-4);
      assert_true(largest_difference(velocity[0], velocity[1], 36) < 1e-14);
      assert_true(largest_difference(acceleration[0], acceleration[1], 36) < 1e-9 * largest);
    }
}

TEST(a_dt_given_later_survives_new_boundaries) {
  mps_particles *set;
  mps_dynamics *d = shaken(context, NULL, 0.0, &set);
  const int64_t id = 3;
  OK(mps_dynamics_set_dt(d, DT));
  OK(soil_add_held(d, MPS_DOF_X, 1, &id));
  NEAR(mps_dynamics_dt(d), DT, 0.0);
  drop(&d, &set, NULL);
}

TEST(the_library_chooses_courant_times_the_limit) {
  const double courant[2] = {0.9, 0.25};
  for (int k = 0; k < 2; k++) {
    scoped_particles *set = NULL;
    DEF(dynamics, def, .courant = courant[k]);
    scoped_dynamics *d = shaken(context, &def, 0.05, &set);
    mps_dynamics_linear_limit limit;
    OK(mps_dynamics_step(d, 1));
    OK(mps_dynamics_find_limit(d, 0.0, &limit));
    NEAR(mps_dynamics_dt(d) / limit.dt, courant[k], 1e-15);
    NEAR(mps_dynamics_time(d), mps_dynamics_dt(d), 0.0);
  }
}

TEST(where_nothing_limits_dt_it_must_be_given) {
  const int64_t ids[36] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13, 14, 15, 16, 17,
                           18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34, 35};
  mps_particles *set;
  mps_dynamics *d = shaken(context, NULL, 0.0, &set);
  OK(soil_add_held(d, MPS_DOF_X | MPS_DOF_Y | MPS_DOF_ROTATION, 36, ids));
  REFUSES(mps_dynamics_step(d, 1), "give dt");
  assert_true(mps_dynamics_dt(d) == 0.0);
  OK(mps_dynamics_set_dt(d, 1.0));
  OK(mps_dynamics_step(d, 3));
  NEAR(soil_value(set, "displacement", 7, 0), 0.0, 0.0);
  drop(&d, &set, NULL);
  const mps_dynamics_def euler = def_of(MPS_DYNAMICS_INTEGRATOR_EULER, NAN);
  d = shaken(context, &euler, 0.0, &set);
  REFUSES(mps_dynamics_step(d, 1), "Euler without damping");
  drop(&d, &set, NULL);
}

/* ---- warnings and divergence ----------------------------------------------------------------- */

TEST(a_step_above_the_limit_is_refused_or_warned_of) {
  hooks h;
  mps_context *own = hooked(&h);
  mps_particles *set;
  mps_dynamics_linear_limit limit;
  mps_dynamics *d = shaken(own, NULL, 0.0, &set);
  OK(mps_dynamics_find_limit(d, 0.0, &limit));
  drop(&d, &set, NULL);
  const double factor[4] = {0.5, 0.999, 1.001, 1.5};
  for (int k = 0; k < 4; k++) {
    const mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, factor[k] * limit.dt);
    const int expected = factor[k] > 1.0 ? 1 : 0;
    h.warnings = 0;
    d = shaken(own, &def, 0.0, &set);
    if (expected)
      FAILS_ON(own, mps_dynamics_step(d, 2), MPS_ERROR_ARGUMENT,
               "must be at most the linear stability limit");
    else
      OK(mps_dynamics_step(d, 2));
    assert_int_equal(mps_dynamics_steps(d), expected ? 0 : 2);
    assert_int_equal(h.warnings, 0);
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
    h.warnings = 0;
    d = shaken(own, NULL, 0.0, &set);
    OK(mps_dynamics_set_dt(d, factor[k] * limit.dt));
    assert_int_equal(h.warnings, expected);
    if (expected) assert_non_null(strstr(h.text, "above the linear stability limit"));
    OK(mps_dynamics_step(d, 1));
    assert_int_equal(h.warnings, expected); /* once */
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
  }
  h.warnings = 0;
  const mps_dynamics_def euler = def_of(MPS_DYNAMICS_INTEGRATOR_EULER, 1e-6);
  d = shaken(own, &euler, 0.0, &set);
  OK(mps_dynamics_step(d, 1));
  assert_int_equal(h.warnings, 1);
  assert_non_null(strstr(h.text, "Euler without damping"));
  drop(&d, &set, &own);
}

/* Particles closer than the spacing are stiffer than any lattice. */
TEST(the_warning_is_right_off_a_lattice) {
  hooks h;
  mps_context *own = hooked(&h);
  DEF(particles, set_def, .spacing = 1.0);
  mps_dynamics_linear_limit limit;
  const double x[8] = {0.0, 0.0, 0.2, 0.0, 0.0, 0.2, 1.0, 1.0};
  MAKE_KEPT(particles, set, create, own, &set_def);
  OK(mps_particles_append(set, 4, x));
  SET_FIELDS(set, {"density", 1500.0}, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0});
  MAKE_KEPT(dynamics, d, create, own, set, NULL);
  OK(mps_dynamics_find_limit(d, 0.0, &limit));
  assert_true(limit.dt < 0.1 * DT);
  OK(mps_dynamics_set_dt(d, DT));
  OK(mps_dynamics_step(d, 1));
  assert_int_equal(h.warnings, 1);
  drop(&d, &set, &own);
}

/* Two particles of a lattice 0.01 D apart shorten the step of all; 0.7 D apart they do not much. */
TEST(a_close_pair_is_named) {
  for (int close = 0; close < 2; close++) {
    hooks h;
    mps_context *own = hooked(&h);
    const double x[2] = {2.5 + (close ? 0.01 : 0.5), close ? 2.5 : 3.0};
    mps_particles *set = box_of(own, 1.0, AT(0.0, 0.0), AT(6.0, 6.0));
    const double near[2] = {2.5, 2.5};
    const int64_t id = mps_particles_nearest(set, near);
    OK(mps_particles_append(set, 1, x));
    SET_FIELDS(set, {"density", 1500.0}, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0});
    MAKE_KEPT(dynamics, d, create, own, set, NULL);
    OK(mps_dynamics_step(d, 1));
    OK(mps_dynamics_step(d, 1));
    assert_int_equal(h.warnings, close); /* once */
    char text[80];
    snprintf(text, sizeof text, "particles %lld and 36 are 0.01 m apart", (long long)id);
    if (close && !strstr(h.text, text)) fail_msg("%s", h.text);
    drop(&d, &set, &own);
  }
}

TEST(divergence_names_step_time_and_particle) {
  for (int integrator = 0; integrator < 3; integrator++) {
    scoped_particles *set = NULL;
    mps_dynamics_def def = def_of(integrator, NAN);
    def.divergence = 1e6;
    scoped_dynamics *d = shaken(context, &def, 0.0, &set);
    OK(mps_dynamics_set_dt(d, 2e-2)); /* five times the limit */
    assert_int_equal(mps_dynamics_run(d, 20.0, 1000, NULL, NULL), MPS_ERROR_DIVERGED);
    const mps_error *error = mps_context_error(context);
    const int64_t steps = mps_dynamics_steps(d); /* the step that diverged is undone */
    char text[128];
    snprintf(text, sizeof text,
             "diverged at step %lld, t = %.6g s: |acceleration| of particle %lld at",
             (long long)steps + 1, (double)steps * 2e-2, (long long)error->particle);
    if (!strstr(error->message, text)) fail_msg("%s", error->message);
    assert_non_null(strstr(error->message, "beyond 1e+06; dt is 0.02 s, above the linear"));
    assert_string_equal(error->function, "mps_dynamics_run");
    assert_int_equal(error->step, steps + 1);
    assert_true(error->particle >= 0 && error->particle < 36);
    FAILS(mps_dynamics_step(d, 1), MPS_ERROR_DIVERGED, text); /* again */
    assert_int_equal(mps_dynamics_steps(d), steps);
    scoped_snapshot *snapshot = NULL;
    OK(mps_dynamics_snapshot(d, &snapshot));
    const char *const fields[] = {"displacement", "rotation", "velocity", "spin"};
    for (int f = 0; f < 4; f++) OK(mps_particles_set(set, fields[f], 0, 0.0));
    OK(mps_particles_set(set, "displacement", 1, 0.0));
    OK(mps_particles_set(set, "velocity", 1, 0.0));
    OK(mps_dynamics_restart(d, 0.0));
    OK(mps_dynamics_step(d, 10)); /* at rest nothing grows */
    NEAR(soil_value(set, "displacement", 5, 0), 0.0, 0.0);
  }
}

/* A part of the limit too small for a number. */
TEST(no_step_is_no_time_step) {
  mps_particles *set;
  mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, NAN);
  def.courant = 4.9e-324;
  mps_dynamics *d = shaken(context, &def, 0.0, &set);
  REFUSES(mps_dynamics_step(d, 1), "dynamics: courant = ");
  REFUSES(mps_dynamics_run(d, 1.0, 1, NULL, NULL), "give dt");
  OK(mps_dynamics_set_dt(d, 1e-12));
  REFUSES(mps_dynamics_run(d, 1e6, 1, NULL, NULL), "t_end is");
  drop(&d, &set, NULL);
}

TEST(an_infinite_acceleration_passes_no_limit) {
  mps_particles *set;
  mps_dynamics_def def = def_of(MPS_DYNAMICS_INTEGRATOR_VERLET, 1e-3);
  def.divergence = 1e300; /* its square is not finite */
  mps_dynamics *d = shaken(context, &def, 0.0, &set);
  double *x = mpsi_particles_column(set, "displacement", 0);
  x[14] = 1e200; /* a = 1e205 or so: its square is not finite either */
  OK(mps_dynamics_restart(d, 0.0));
  assert_int_equal(mps_dynamics_step(d, 1), MPS_ERROR_DIVERGED);
  drop(&d, &set, NULL);
}
