/* test_dynamics_life.c - the explicit MPS solver and the particle set that it uses; order of
 * destruction, refused allocations, steps that allocate nothing.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_allocator.h"
#include "test_fixture.h"

/* ---- life ------------------------------------------------------------------------------------ */

TEST(a_set_is_pinned_while_a_solver_lives) {
  scoped_particles *set = soil_particles(context, 1.0, 3.0, 3.0, 1, &soil_plain);
  mps_dynamics *d = soil_solver(context, set), *second = NULL;
  const double x[2] = {9.5, 0.5};
  const int32_t fields = mps_particles_field_count(set);
  FAILS(mps_particles_append(set, 1, x), MPS_ERROR_STATE, "held by");
  FAILS(mps_dynamics_create(context, set, NULL, &second), MPS_ERROR_STATE,
        "held by a solver of elastodynamics");
  FAILS(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 2), MPS_ERROR_STATE, "held by");
  assert_int_equal(mps_particles_field_count(set), fields);
  mps_dynamics_destroy(&d);
  assert_null(d);
  OK(mps_particles_append(set, 1, x));
}

TEST(added_and_moved_particles_get_new_references) {
  scoped_particles *set = soil_particles(context, 1.0, 3.0, 3.0, 1, &soil_plain);
  scoped_dynamics *d = soil_solver(context, set);
  mps_dynamics_destroy(&d);
  const double x[2] = {3.5, 0.5};
  OK(mps_particles_append(set, 1, x)); /* its reference is (0, 0) */
  SET_FIELDS(set, {"density", 1500.0}, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0});
  EDIT(at, set, "position")
    *mps_edit_f64(&at, mps_particles_index(set, 8), 1) = 3.0; /* moved by hand */
  d = soil_solver(context, set);
  NEAR(soil_value(set, "position", 9, 0), 3.5, 0.0);
  NEAR(soil_value(set, "position", 9, 1), 0.5, 0.0);
  NEAR(soil_value(set, "reference", 8, 1), 3.0, 0.0);
}

/* Parts given up in each of the 24 orders; the address sanitizer looks for leaks. */
TEST(parts_may_go_in_any_order) {
  for (int order = 0; order < 24; order++) {
    mps_context *own = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    mps_particles *set = soil_particles(own, 1.0, 3.0, 3.0, 1, &soil_plain);
    const int64_t id = 0;
    MAKE_KEPT(dynamics, d, create, own, set, NULL);
    MAKE_KEPT(signal, signal, create_ricker, own, 4.0, 0.25, 1.0);
    OK(soil_add_driven(d, 0, signal, 1.0, 1, &id));
    int left[4] = {0, 1, 2, 3};
    for (int k = 0, rest = order; k < 4; k++) {
      const int pick = rest % (4 - k);
      rest /= 4 - k;
      if (left[pick] == 0) mps_context_destroy(&own);
      if (left[pick] == 1) mps_particles_destroy(&set);
      if (left[pick] == 2) mps_dynamics_destroy(&d);
      if (left[pick] == 3) mps_signal_destroy(&signal);
      left[pick] = left[3 - k];
      if (d) assert_int_equal(mps_dynamics_step(d, 2), MPS_OK);
    }
  }
}

/* ---- memory ---------------------------------------------------------------------------------- */

/* Everything that allocates: set, columns, solver, boundaries, limits, energy, a run. */
static mps_status everything(mps_context *own, int integrator) {
  DEF(particles, set_def, .spacing = 1.0);
  scoped_particles *set = NULL;
  scoped_dynamics *d = NULL;
  scoped_signal *signal = NULL, *factor = NULL;
  const int64_t ids[3] = {0, 1, 2};
  mps_status status = mps_particles_create(own, &set_def, &set);
  if (status == MPS_OK) status = mps_particles_fill_box(set, AT(0.0, 0.0), AT(4.0, 4.0), NULL);
  if (status == MPS_OK) status = mps_particles_set(set, "density", 0, 1500.0);
  if (status == MPS_OK) status = mps_particles_set(set, "shear_velocity", 0, 100.0);
  if (status == MPS_OK) status = mps_particles_set(set, "pressure_velocity", 0, 200.0);
  if (status == MPS_OK) status = mps_particles_set(set, "damping", 0, 0.05);
  if (status == MPS_OK) {
    mps_edit h;
    status = mps_particles_edit(set, "damping", &h);
    if (status == MPS_OK) *mps_edit_f64(&h, 5, 0) = 0.2; /* uneven */
    if (status == MPS_OK) status = mps_particles_commit(set, &h);
  }
  if (status == MPS_OK) status = mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 2);
  DEF(dynamics, def, .integrator = integrator);
  if (status == MPS_OK) status = mps_dynamics_create(own, set, &def, &d);
  if (status == MPS_OK) status = mps_signal_create_ricker(own, 4.0, 0.25, 1.0, &signal);
  if (status == MPS_OK)
    status = mps_signal_create_sine(own, MPS_SIGNAL_QUANTITY_VALUE, 4.0, 1.0, 0.0, &factor);
  if (status == MPS_OK) status = soil_add_held(d, MPS_DOF_Y, 3, ids);
  if (status == MPS_OK) status = soil_add_driven(d, 0, signal, 1.0, 3, ids);
  DEF(dynamics_boundary, viscous, .signal[0] = viscous.signal[1] = signal);
  if (status == MPS_OK) status = soil_add_viscous(d, &viscous, 3, ids);
  mps_dynamics_linear_limit limit;
  if (status == MPS_OK) status = mps_dynamics_find_limit(d, 1.0, &limit);
  DEF(dynamics_load, load, .kind = MPS_DYNAMICS_LOAD_BODY, .all = 1, .acceleration[1] = -9.8,
      .signal[1] = factor);
  int32_t number;
  if (status == MPS_OK) status = mps_dynamics_add_load(d, &load, &number);
  if (status == MPS_OK) status = mps_dynamics_run(d, 0.01, 1, NULL, NULL);
  if (status == MPS_OK) status = mps_dynamics_set_dt(d, 1e-3);
  mps_totals energy;
  if (status == MPS_OK) status = mps_dynamics_get_totals(d, &energy);
  return status;
}

/* Refuses one allocation after the other. Arrays that belong together are requested together, so
 * unlike test_allocator_sweep this does not mind if some follow the refused one. */
TEST(a_refused_allocation_leaks_nothing) {
  for (int integrator = 0; integrator < 3; integrator++) {
    mps_status status = MPS_ERROR_MEMORY;
    int64_t refuse = 2;
    for (; status != MPS_OK; refuse++) {
      test_allocator allocator = {.refuse_at = refuse};
      mps_context *own = test_allocator_context(&allocator);
      assert_non_null(own);
      status = everything(own, integrator);
      if (status != MPS_OK) {
        assert_int_equal(status, MPS_ERROR_MEMORY);
        assert_int_equal(mps_context_error(own)->status, MPS_ERROR_MEMORY);
      }
      mps_context_destroy(&own);
      assert_int_equal(allocator.live, 0);
    }
    assert_true(refuse > 80); /* it covered them all */
  }
}

TEST(steps_allocate_nothing) {
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  mps_particles *set = soil_particles(own, 1.0, 10.0, 20.0, 1, &soil_plain);
  const int64_t ids[2] = {0, 199};
  MAKE_KEPT(dynamics, d, create, own, set, NULL);
  MAKE_KEPT(signal, signal, create_ricker, own, 4.0, 0.25, 1.0);
  OK(soil_add_driven(d, 0, signal, 1.0, 1, &ids[0]));
  OK(soil_add_viscous(d, NULL, 1, &ids[1]));
  OK(mps_dynamics_step(d, 1)); /* finds dt */
  const int64_t calls = allocator.calls;
  OK(mps_dynamics_step(d, 20));
  OK(mps_dynamics_run(d, mps_dynamics_time(d) + 0.1, 3, NULL, NULL));
  OK(mps_dynamics_restart(d, 0.0));
  OK(mps_dynamics_step(d, 20));
  assert_int_equal(allocator.calls, calls);
  mps_dynamics_destroy(&d);
  mps_signal_destroy(&signal);
  mps_particles_destroy(&set);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}
