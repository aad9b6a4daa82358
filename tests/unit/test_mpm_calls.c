/* test_mpm_calls.c - what a caller of the WLS-MPM solver relies on: an error leaves the set as it
 * was, callbacks may only query, runs go forwards and end where requested, forces are of the
 * measure.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "core/particles/particles_internal.h"
#include "test_fixture.h"

static mps_mpm_def small_def(void) {
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0);
  return def;
}

static mpm_scene small_scene(void) {
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  return s;
}

/* ---- creation is whole or nothing ------------------------------------------------------------ */

/* A dt above the limit is found last of all: fields, values, order and epoch are as before, and
 * another geometry finds its own volumes. */
TEST(refused_creation_changes_nothing) {
  scoped_mpm_scene s = small_scene();
  OK(mps_particles_add_field(s.particles, "volume", 0));
  OK(mps_particles_add_field(s.particles, "volume_ratio", 0));
  scoped_mpm *mpm = NULL;
  MAKE(material, rubber, create_neo_hookean, context, 1e5, 0.3);
  const uint64_t epoch = mps_particles_epoch(s.particles);
  const int32_t fields = mps_particles_field_count(s.particles);
  mps_mpm_def def = small_def();
  def.dt = 1.0;
  REFUSES(mps_mpm_create(context, s.particles, rubber, &def, &mpm), "above the Courant limit");
  assert_null(mpm);
  assert_int_equal(mps_particles_field_count(s.particles), fields);
  assert_int_equal(mps_particles_epoch(s.particles), epoch);
  const mps_view volume = mpm_scene_view(&s, "volume"), J = mpm_scene_view(&s, "volume_ratio");
  const mps_view id = mpm_scene_view(&s, "id");
  for (int64_t k = 0; k < volume.shape[0]; k++) {
    assert_true(*mps_view_f64(&volume, k, 0) == 0.0 && *mps_view_f64(&J, k, 0) == 0.0);
    assert_int_equal(*mps_view_i64(&id, k, 0), k);
  }
  def = small_def();
  def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  OK(mps_mpm_create(context, s.particles, rubber, &def, &mpm));
  mps_totals t;
  OK(mps_mpm_get_totals(mpm, &t));
  const double cylinder = 3.14159265358979323846 * 0.1 * 0.1 * 0.1;
  NEAR(t.volume, cylinder, 1e-12 * cylinder);
}

/* Density, modulus and cells that no soil has. */
TEST(insane_numbers_are_refused) {
  scoped_mpm_scene s = small_scene();
  mps_mpm *mpm = NULL;
  const mps_mpm_def def = small_def();
  REFUSES(mps_particles_set(s.particles, "density", 0, 1e20), "1e+20 kg/m3");
  REFUSES(mps_particles_set(s.particles, "velocity", 0, 1e308), "1e+308 m/s");
  mpsi_particles_column(s.particles, "density", 0)[3] = 1e20; /* past the set's own check */
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &mpm),
          "particle 3 has density 1e+20 kg/m3");
}

/* ---- callbacks ------------------------------------------------------------------------------- */

typedef struct probe {
  mps_mpm *mpm;
  mps_snapshot *start;
  mps_status seen[8];
  int count;
  bool alive;
} probe;

static mps_status tries_everything(void *user, mps_mpm *mpm) {
  probe *p = user;
  mps_mpm *same = mpm;
  p->count = 0;
  p->seen[p->count++] = mps_mpm_step(mpm, 1);
  p->seen[p->count++] = mps_mpm_run(mpm, 1.0, 1, NULL, NULL);
  p->seen[p->count++] = mps_mpm_set_dt(mpm, NAN);
  p->seen[p->count++] = mps_mpm_set_side(mpm, 0, MPS_BOUNDARY_HELD, 0.0);
  p->seen[p->count++] = mps_mpm_remove_boundary(mpm, 0);
  p->seen[p->count++] = mps_mpm_remove_load(mpm, 0);
  p->seen[p->count++] = mps_mpm_rollback(mpm, p->start);
  p->seen[p->count++] = mps_mpm_restore(mpm, "no_such_file.h5", NULL);
  mps_mpm_destroy(&same);
  p->alive = same == mpm && mps_context_error(context)->status == MPS_ERROR_STATE;
  return MPS_OK;
}

static mps_status gives_up(void *user, mps_mpm *mpm) {
  return mps_mpm_steps(mpm) == 3 ? MPS_ERROR_IO : MPS_OK;
}

TEST(callbacks_may_only_ask) {
  scoped_mpm_scene s = small_scene();
  const mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  probe p = {.mpm = s.mpm};
  OK(mps_mpm_snapshot(s.mpm, &p.start));
  OK(mps_mpm_run(s.mpm, 5.5 * mps_mpm_dt(s.mpm), 1, tries_everything, &p));
  mps_snapshot_destroy(&p.start);
  assert_int_equal(p.count, 8);
  for (int k = 0; k < p.count; k++) assert_int_equal(p.seen[k], MPS_ERROR_STATE);
  assert_true(p.alive);
  assert_int_equal(mps_mpm_steps(s.mpm), 6);
  OK(mps_mpm_set_dt(s.mpm, NAN)); /* allowed again */
}

TEST(callbacks_that_stop_are_named) {
  scoped_mpm_scene s = small_scene();
  const mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  FAILS(mps_mpm_run(s.mpm, 1.0, 1, gives_up, NULL), MPS_ERROR_IO,
        "the callback of mps_mpm_run returned status 5");
  OK(mps_mpm_step(s.mpm, 1)); /* the solver is whole */
}

/* ---- time ------------------------------------------------------------------------------------ */

TEST(runs_go_forwards) {
  scoped_mpm_scene s = small_scene();
  const mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  REFUSES(mps_mpm_run(s.mpm, -1.0, 1, NULL, NULL), "not before the solver's time");
  OK(mps_mpm_run(s.mpm, 0.0, 1, NULL, NULL)); /* no step */
  assert_int_equal(mps_mpm_steps(s.mpm), 0);
  const double dt = 0.3 * mps_mpm_limit(s.mpm);
  OK(mps_mpm_set_dt(s.mpm, dt));
  REFUSES(mps_mpm_set_dt(s.mpm, 0.0), "dt is 0 s");
  REFUSES(mps_mpm_set_dt(s.mpm, 1.0), "Courant limit");
  OK(mps_mpm_run(s.mpm, 7.5 * dt, 1, NULL, NULL));
  assert_true(mps_mpm_time(s.mpm) == 7.5 * dt);
  assert_int_equal(mps_mpm_steps(s.mpm), 8);
  mps_mpm_def now;
  OK(mps_mpm_get_def(s.mpm, &now));
  assert_true(now.dt == dt && now.cell == 0.02 && now.measure == 1.0);
  assert_ptr_equal(mps_mpm_particles(s.mpm), s.particles);
  assert_ptr_equal(mps_mpm_context(s.mpm), context);
}

static int32_t stop_at_once(void *user) {
  ++*(int *)user;
  return 1;
}

TEST(steps_can_be_cancelled) {
  int asked = 0;
  mps_context *own = NULL, *shared = context;
  DEF(context, hooks, .executor = MPS_CONTEXT_EXECUTOR_SERIAL, .cancel = stop_at_once,
      .cancel_user = &asked);
  assert_int_equal(mps_context_create(&hooks, &own, NULL, 0), MPS_OK);
  context = own;
  mpm_scene s = small_scene();
  const mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  FAILS_ON(own, mps_mpm_step(s.mpm, 100), MPS_ERROR_CANCELLED, "cancel hook at step 0");
  FAILS_ON(own, mps_mpm_step(s.mpm, 1), MPS_ERROR_CANCELLED, "cancel hook at step 0");
  assert_int_equal(mps_mpm_steps(s.mpm), 0);
  assert_int_equal(asked, 2); /* before each step */
  mpm_scene_end(&s);
  mps_context_destroy(&own);
  context = shared;
}

/* A body that flies as a whole: with STEP_FROM_WAVE its speed does not shorten the step. */
TEST(step_from_the_wave_alone) {
  const double c = sqrt(1e5 * 0.7 / (1.3 * 0.4) / 1000.0);
  for (int32_t from = 0; from < 2; from++) {
    scoped_mpm_scene s = small_scene();
    OK(mps_particles_set(s.particles, "velocity", 0, 30.0));
    mps_mpm_def def = small_def();
    def.step_from = from;
    def.lower[0] = def.lower[1] = -INFINITY;
    mpm_scene_solve(&s, &def);
    NEAR(mps_mpm_limit(s.mpm), 0.02 / (from ? c : c + 30.0), 1e-12);
    OK(mps_mpm_step(s.mpm, 2));
    if (from) NEAR(mps_mpm_limit(s.mpm), 0.02 / c, 1e-12);
  }
}

/* ---- the measure ----------------------------------------------------------------------------- */

/* Twice the thickness: the same motion, bit for bit but for rounding, and twice the forces. */
TEST(forces_are_of_the_measure) {
  double x[2], force[2], touch[2];
  for (int k = 0; k < 2; k++) {
    scoped_mpm_scene s = small_scene();
    mps_mpm_def def = small_def();
    def.measure = k ? 2.0 : NAN;
    def.gravity[1] = -9.81;
    mpm_scene_solve(&s, &def);
    mps_body_def body = mps_body_defaults();
    body.position[1] = 0.1 + 0.049; /* presses 1 mm */
    MAKE(body, plate, create_box, context, &body, 0.4, 0.1);
    DEF(contact, push, .inside = MPS_CONTACT_INSIDE_PUSH);
    OK(mps_mpm_add_contact(s.mpm, plate, &push, NULL));
    OK(mps_mpm_step(s.mpm, 20));
    mps_reaction r;
    OK(mps_mpm_get_reaction(s.mpm, MPS_SIDE_Y_LOWER, &r));
    force[k] = r.impulse[1];
    OK(mps_body_get_reaction(plate, -1, &r));
    touch[k] = r.impulse[1];
    const mps_view at = mpm_scene_view(&s, "position");
    x[k] = *mps_view_f64(&at, mps_particles_index(s.particles, 55), 1);
  }
  NEAR(x[1], x[0], 1e-15);
  NEAR(force[1], 2.0 * force[0], 1e-10 * fabs(force[0]));
  assert_true(touch[0] > 0.0);
  NEAR(touch[1], 2.0 * touch[0], 1e-10 * touch[0]);
}
