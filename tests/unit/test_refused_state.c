/* test_refused_state.c - no wrong state without a word: speeds whose energy is no number end a step
 * with an error, in every solver; a reading writes no field; what is refused for its arguments has
 * changed nothing; a rollback brings back all that a boundary shows.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"
#include "unchanged.h"

static mps_particles *block(double velocity) {
  mps_particles *set = box_of(context, 0.1, AT(0.0, 0.0), AT(0.4, 0.4));
  SET_FIELDS(set, {"density", 1000.0}, {"velocity", velocity});
  return set;
}

static mps_dynamics *dynamics_on(mps_particles *set, int32_t integrator, double divergence) {
  DEF(dynamics, def, .integrator = integrator, .divergence = divergence);
  SET_FIELDS(set, {"shear_velocity", 20.0}, {"pressure_velocity", 40.0});
  MAKE_KEPT(dynamics, made, create, context, set, &def);
  return made;
}

/* ---- speeds ---------------------------------------------------------------------------------- */

/* Forces (N) that no solver refuses, after a step of which the energies are not numbers. */
static const double strong[3] = {1e125, 1e140, -1e149};

TEST(explicit_dynamics_ends_with_divergence) {
  static const int32_t integrators[] = {MPS_DYNAMICS_INTEGRATOR_VERLET,
                                        MPS_DYNAMICS_INTEGRATOR_LEAPFROG,
                                        MPS_DYNAMICS_INTEGRATOR_EULER};
  for (int k = 0; k < 9; k++) {
    scoped_particles *set = block(0.0);
    const int64_t id = 5;
    scoped_dynamics *dynamics = dynamics_on(set, integrators[k % 3], 1e300);
    DEF(dynamics_load, load, .ids = &id, .id_count = 1, .traction[0] = strong[k / 3]);
    OK(mps_dynamics_add_load(dynamics, &load, NULL));
    OK(mps_dynamics_set_dt(dynamics, 1e-4));
    const mps_status status = mps_dynamics_step(dynamics, 1);
    assert_int_equal(status, MPS_ERROR_DIVERGED);
    if (k < 6) assert_non_null(strstr(mps_context_error(context)->message, "moves with"));
    assert_true(mps_context_error(context)->particle >= 0);
  }
}

TEST(mpm_ends_with_divergence) {
  for (int k = 0; k < 3; k++) {
    DEF(mpm, def, .cell = 0.2);
    scoped_particles *set = block(0.0);
    const int64_t id = 5;
    DEF(mpm_load, load, .ids = &id, .id_count = 1, .traction[0] = strong[k]);
    MAKE(material, law, create_linear_elastic, context, 1e6, 0.3);
    MAKE(mpm, mpm, create, context, set, law, &def);
    OK(mps_mpm_set_dt(mpm, 1e-4));
    OK(mps_mpm_add_load(mpm, &load, NULL));
    assert_int_equal(mps_mpm_step(mpm, 1), MPS_ERROR_DIVERGED);
    const double area = 1e300; /* with it the force is none */
    load.area = &area;
    REFUSES(mps_mpm_add_load(mpm, &load, NULL), "area[0]");
  }
}

/* Without gravity a long step is allowed. */
TEST(fluid_ends_with_divergence) {
  DEF(fluid, def, .gravity[1] = 0.0, .dt = 1e6);
  scoped_particles *set = block(0.0);
  mps_totals totals;
  OK(mps_particles_set(set, "external_force", 0, 1e100));
  MAKE(fluid, fluid, create, context, set, &def);
  assert_int_equal(mps_fluid_step(fluid, 1), MPS_ERROR_DIVERGED);
  OK(mps_fluid_get_totals(fluid, &totals));
  assert_true(totals.kinetic == 0.0); /* the step has not happened */
}

TEST(elasticity_ends_with_an_error) {
  for (int k = 0; k < 3; k++) {
    mps_elastic_def def = mps_elastic_defaults();
    const int64_t id = 10;
    double force[3] = {0.0, 0.0, 0.0};
    scoped_particles *set = block(0.0);
    DEF(elastic_boundary, foot, .lower[0] = foot.lower[1] = -1.0, .upper[0] = 9.0, .upper[1] = 0.1);
    SET_FIELDS(set, {"young", 1e6}, {"poisson", 0.3});
    MAKE(elastic, e, create, context, set, &def);
    OK(mps_elastic_add_boundary(e, &foot, NULL));
    USING(elastic_motion, mps_elastic_start(e, &given), .dt = 1e-3);
    force[0] = strong[k];
    DEF(elastic_load, load, .kind = MPS_ELASTIC_LOAD_FORCE, .ids = &id, .id_count = 1,
        .values = force);
    OK(mps_elastic_add_load(e, &load, NULL));
    FAILS(mps_elastic_step(e, 1), MPS_ERROR_DIVERGED, "velocity");
    assert_int_equal(mps_elastic_steps(e), 0);
    force[0] = k == 0 ? 1e200 : -1e280;
    OK(mps_elastic_set_load(e, 0, &load));
    FAILS(mps_elastic_solve(e), MPS_ERROR_NUMERIC, "load");
  }
}

/* ---- readings -------------------------------------------------------------------------------- */

static uint64_t pressures(mps_particles *set) {
  static const char *const names[] = {"pressure", NULL};
  return digest_fields(set, names);
}

TEST(totals_of_dynamics_write_no_pressure) {
  scoped_particles *set = block(0.1);
  mps_totals totals;
  EDIT(v, set, "velocity") *mps_edit_f64(&v, 5, 1) = 0.3;
  scoped_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_VERLET, 1e15);
  OK(mps_dynamics_set_dt(dynamics, 1e-4));
  OK(mps_dynamics_step(dynamics, 5));
  const uint64_t before = pressures(set);
  OK(mps_dynamics_get_totals(dynamics, &totals));
  assert_true(totals.strain > 0.0);
  assert_true(pressures(set) == before);
  OK(mps_dynamics_refresh(dynamics)); /* this is what brings them to the present */
  assert_true(pressures(set) != before);
}

/* Euler has no limit of its own: dt must be given. */
TEST(a_step_without_dt_moves_nothing) {
  scoped_particles *set = block(0.1);
  scoped_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_EULER, 1e15);
  const uint64_t before = seen_set(set);
  assert_int_equal(mps_dynamics_step(dynamics, 1), MPS_ERROR_ARGUMENT);
  assert_true(seen_set(set) == before);
}

/* ---- a side that is set free ----------------------------------------------------------------- */

TEST(a_rollback_brings_back_what_a_free_side_shows) {
  DEF(mpm, def, .cell = 0.2, .gravity[1] = -9.81);
  scoped_snapshot *snapshot = NULL;
  mps_reaction before, after, back;
  scoped_particles *set = block(0.0);
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = 0.8;
  MAKE(material, law, create_linear_elastic, context, 1e6, 0.3);
  MAKE(mpm, mpm, create, context, set, law, &def);
  OK(mps_mpm_step(mpm, 20));
  DEF(mpm_boundary, side, .kind = MPS_BOUNDARY_FREE);
  OK(mps_mpm_set_boundary(mpm, MPS_SIDE_Y_LOWER, &side));
  OK(mps_mpm_get_reaction(mpm, MPS_SIDE_Y_LOWER, &before));
  assert_true(before.force[1] > 0.0 && before.count > 0);
  OK(mps_mpm_snapshot(mpm, &snapshot));
  OK(mps_mpm_step(mpm, 2));
  OK(mps_mpm_get_reaction(mpm, MPS_SIDE_Y_LOWER, &after));
  assert_true(after.force[1] == 0.0 && after.count == 0); /* it holds nothing now */
  OK(mps_mpm_rollback(mpm, snapshot));
  OK(mps_mpm_get_reaction(mpm, MPS_SIDE_Y_LOWER, &back));
  assert_memory_equal(&back, &before, sizeof back);
}

/* Fields that a step writes are the caller's until there is one. */
TEST(a_refused_run_writes_no_reaction) {
  scoped_particles *set = block(0.0);
  scoped_dynamics *dynamics = dynamics_on(set, MPS_DYNAMICS_INTEGRATOR_VERLET, 1e15);
  mps_view reaction;
  OK(mps_dynamics_set_dt(dynamics, 1e-4));
  OK(mps_particles_add_field(set, "reaction", 0));
  OK(mps_dynamics_step(dynamics, 1));
  OK(mps_particles_set(set, "reaction", 0, 7.0));
  REFUSES(mps_dynamics_step(dynamics, -1), "count is -1");
  REFUSES(mps_dynamics_run(dynamics, -1.0, 1, NULL, NULL), "t_end is -1");
  OK(mps_particles_view(set, "reaction", &reaction));
  NEAR(*mps_view_f64(&reaction, 3, 0), 7.0, 0.0);
  OK(mps_dynamics_step(dynamics, 1));
  OK(mps_particles_view(set, "reaction", &reaction));
  NEAR(*mps_view_f64(&reaction, 3, 0), 0.0, 0.0);
}
