/* test_refused_state.c - no wrong state without a word: speeds whose energy is no number end a step
 * with an error, in every solver; a reading writes no field; what is refused for its arguments has
 * changed nothing; a rollback brings back all that a boundary shows.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"
#include "unchanged.h"

#define OK(call) mps_assert_ok(context, call)

static mps_particles *block(double velocity) {
  mps_particles_def def = mps_particles_defaults();
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.4, 0.4};
  mps_particles *set = NULL;
  def.spacing = 0.1;
  OK(mps_particles_create(context, &def, &set));
  OK(mps_particles_fill_box(set, lo, hi, NULL));
  OK(mps_particles_set(set, "density", 0, 1000.0));
  OK(mps_particles_set(set, "velocity", 0, velocity));
  return set;
}

static mps_dynamics *dynamics_on(mps_particles *set, int32_t integrator, double divergence) {
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics *made = NULL;
  def.integrator = integrator;
  def.divergence = divergence;
  OK(mps_particles_set(set, "shear_velocity", 0, 20.0));
  OK(mps_particles_set(set, "pressure_velocity", 0, 40.0));
  OK(mps_dynamics_create(context, set, &def, &made));
  return made;
}

/* ---- speeds ---------------------------------------------------------------------------------- */

/* Forces (N) that no solver refuses, after a step of which the energies are not numbers. */
static const double strong[3] = {1e125, 1e140, -1e149};

static void explicit_dynamics_ends_with_divergence(void **state) {
  (void)state;
  static const int32_t integrators[] = {MPS_DYNAMICS_INTEGRATOR_VERLET,
                                        MPS_DYNAMICS_INTEGRATOR_LEAPFROG,
                                        MPS_DYNAMICS_INTEGRATOR_EULER};
  for (int k = 0; k < 9; k++) {
    mps_particles *set = block(0.0);
    const int64_t id = 5;
    mps_dynamics_load_def load = mps_dynamics_load_defaults();
    mps_dynamics *dynamics = dynamics_on(set, integrators[k % 3], 1e300);
    load.ids = &id, load.id_count = 1, load.traction[0] = strong[k / 3];
    OK(mps_dynamics_add_load(dynamics, &load, NULL));
    OK(mps_dynamics_set_dt(dynamics, 1e-4));
    const mps_status status = mps_dynamics_step(dynamics, 1);
    assert_int_equal(status, MPS_ERROR_DIVERGED);
    if (k < 6) assert_non_null(strstr(mps_context_error(context)->message, "moves with"));
    assert_true(mps_context_error(context)->particle >= 0);
    mps_dynamics_destroy(&dynamics);
    mps_particles_destroy(&set);
  }
}

static void mpm_ends_with_divergence(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    mps_mpm_def def = mps_mpm_defaults();
    mps_mpm_load_def load = mps_mpm_load_defaults();
    mps_material *law = NULL;
    mps_mpm *mpm = NULL;
    mps_particles *set = block(0.0);
    const int64_t id = 5;
    def.cell = 0.2;
    load.ids = &id, load.id_count = 1, load.traction[0] = strong[k];
    OK(mps_material_create_linear_elastic(context, 1e6, 0.3, &law));
    OK(mps_mpm_create(context, set, law, &def, &mpm));
    OK(mps_mpm_set_dt(mpm, 1e-4));
    OK(mps_mpm_add_load(mpm, &load, NULL));
    assert_int_equal(mps_mpm_step(mpm, 1), MPS_ERROR_DIVERGED);
    const double area = 1e300; /* with it the force is none */
    load.area = &area;
    mps_assert_fails(context, mps_mpm_add_load(mpm, &load, NULL), MPS_ERROR_ARGUMENT, "area[0]");
    mps_mpm_destroy(&mpm);
    mps_material_destroy(&law);
    mps_particles_destroy(&set);
  }
}

/* Without gravity a long step is allowed. */
static void fluid_ends_with_divergence(void **state) {
  (void)state;
  mps_fluid_def def = mps_fluid_defaults();
  mps_fluid *fluid = NULL;
  mps_particles *set = block(0.0);
  mps_totals totals;
  def.gravity[1] = 0.0;
  def.dt = 1e6;
  OK(mps_particles_set(set, "external_force", 0, 1e100));
  OK(mps_fluid_create(context, set, &def, &fluid));
  assert_int_equal(mps_fluid_step(fluid, 1), MPS_ERROR_DIVERGED);
  OK(mps_fluid_get_totals(fluid, &totals));
  assert_true(totals.kinetic == 0.0); /* the step has not happened */
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&set);
}

static void elasticity_ends_with_an_error(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    mps_elastic_def def = mps_elastic_defaults();
    mps_elastic_motion_def motion = mps_elastic_motion_defaults();
    mps_elastic_load_def load = mps_elastic_load_defaults();
    const int64_t id = 10;
    double force[3] = {0.0, 0.0, 0.0};
    mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
    mps_particles *set = block(0.0);
    mps_elastic *e = NULL;
    motion.dt = 1e-3;
    foot.lower[0] = foot.lower[1] = -1.0, foot.upper[0] = 9.0, foot.upper[1] = 0.1;
    OK(mps_particles_set(set, "young", 0, 1e6));
    OK(mps_particles_set(set, "poisson", 0, 0.3));
    OK(mps_elastic_create(context, set, &def, &e));
    OK(mps_elastic_add_boundary(e, &foot, NULL));
    OK(mps_elastic_start(e, &motion));
    force[0] = strong[k];
    load.kind = MPS_ELASTIC_LOAD_FORCE, load.ids = &id, load.id_count = 1;
    load.values = force;
    OK(mps_elastic_add_load(e, &load, NULL));
    mps_assert_fails(context, mps_elastic_step(e, 1), MPS_ERROR_NUMERIC, "velocity");
    assert_int_equal(mps_elastic_steps(e), 0);
    force[0] = k == 0 ? 1e200 : -1e280;
    OK(mps_elastic_set_load(e, 0, &load));
    mps_assert_fails(context, mps_elastic_solve(e), MPS_ERROR_NUMERIC, "load");
    mps_elastic_destroy(&e);
    mps_particles_destroy(&set);
  }
}

/* ---- readings -------------------------------------------------------------------------------- */

static uint64_t pressures(mps_particles *set) {
  static const char *const names[] = {"pressure", NULL};
  return digest_fields(context, set, names);
}

static void totals_of_dynamics_write_no_pressure(void **state) {
  (void)state;
  mps_particles *set = block(0.1);
  mps_totals totals;
  mps_edit v;
  OK(mps_particles_edit(set, "velocity", &v));
  *mps_edit_f64(&v, 5, 1) = 0.3;
  OK(mps_particles_commit(set, &v));
  mps_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_VERLET, 1e15);
  OK(mps_dynamics_set_dt(dynamics, 1e-4));
  OK(mps_dynamics_step(dynamics, 5));
  const uint64_t before = pressures(set);
  OK(mps_dynamics_get_totals(dynamics, &totals));
  assert_true(totals.strain > 0.0);
  assert_true(pressures(set) == before);
  OK(mps_dynamics_refresh(dynamics)); /* this is what brings them to the present */
  assert_true(pressures(set) != before);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

/* Euler has no limit of its own: dt must be given. */
static void a_step_without_dt_moves_nothing(void **state) {
  (void)state;
  mps_particles *set = block(0.1);
  mps_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_EULER, 1e15);
  const uint64_t before = seen_set(context, set);
  assert_int_equal(mps_dynamics_step(dynamics, 1), MPS_ERROR_ARGUMENT);
  assert_true(seen_set(context, set) == before);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

/* ---- a side that is set free ----------------------------------------------------------------- */

static void a_rollback_brings_back_what_a_free_side_shows(void **state) {
  (void)state;
  mps_mpm_def def = mps_mpm_defaults();
  mps_mpm_boundary_def side = mps_mpm_boundary_defaults();
  mps_material *law = NULL;
  mps_mpm *mpm = NULL;
  mps_snapshot *snapshot = NULL;
  mps_reaction before, after, back;
  mps_particles *set = block(0.0);
  def.cell = 0.2;
  def.gravity[1] = -9.81;
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 0.8;
  OK(mps_material_create_linear_elastic(context, 1e6, 0.3, &law));
  OK(mps_mpm_create(context, set, law, &def, &mpm));
  OK(mps_mpm_step(mpm, 20));
  side.kind = MPS_BOUNDARY_FREE;
  OK(mps_mpm_set_boundary(mpm, MPS_MPM_SIDE_Y_LOWER, &side));
  OK(mps_mpm_get_reaction(mpm, MPS_MPM_SIDE_Y_LOWER, &before));
  assert_true(before.force[1] > 0.0 && before.count > 0);
  OK(mps_mpm_snapshot(mpm, &snapshot));
  OK(mps_mpm_step(mpm, 2));
  OK(mps_mpm_get_reaction(mpm, MPS_MPM_SIDE_Y_LOWER, &after));
  assert_true(after.force[1] == 0.0 && after.count == 0); /* it holds nothing now */
  OK(mps_mpm_rollback(mpm, snapshot));
  OK(mps_mpm_get_reaction(mpm, MPS_MPM_SIDE_Y_LOWER, &back));
  assert_memory_equal(&back, &before, sizeof back);
  mps_snapshot_destroy(&snapshot);
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&law);
  mps_particles_destroy(&set);
}

/* Fields that a step writes are the caller's until there is one. */
static void a_refused_run_writes_no_reaction(void **state) {
  (void)state;
  mps_particles *set = block(0.0);
  mps_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_VERLET, 1e15);
  mps_view reaction;
  OK(mps_dynamics_set_dt(dynamics, 1e-4));
  OK(mps_particles_add_field(set, "reaction", 0));
  OK(mps_dynamics_step(dynamics, 1));
  OK(mps_particles_set(set, "reaction", 0, 7.0));
  mps_assert_fails(context, mps_dynamics_step(dynamics, -1), MPS_ERROR_ARGUMENT, "count is -1");
  mps_assert_fails(context, mps_dynamics_run(dynamics, -1.0, 1, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "t_end is -1");
  OK(mps_particles_view(set, "reaction", &reaction));
  mps_assert_near(*mps_view_f64(&reaction, 3, 0), 7.0, 0.0);
  OK(mps_dynamics_step(dynamics, 1));
  OK(mps_particles_view(set, "reaction", &reaction));
  mps_assert_near(*mps_view_f64(&reaction, 3, 0), 0.0, 0.0);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_refused_run_writes_no_reaction),
      cmocka_unit_test(explicit_dynamics_ends_with_divergence),
      cmocka_unit_test(mpm_ends_with_divergence),
      cmocka_unit_test(fluid_ends_with_divergence),
      cmocka_unit_test(elasticity_ends_with_an_error),
      cmocka_unit_test(totals_of_dynamics_write_no_pressure),
      cmocka_unit_test(a_step_without_dt_moves_nothing),
      cmocka_unit_test(a_rollback_brings_back_what_a_free_side_shows),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
