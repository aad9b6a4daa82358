/* test_open_edits.c - values that the caller is editing are not read: every function that reads
 * values of a set or of the solver that holds it refuses while a field is open, and answers as
 * before once the edit is abandoned. SPDX-License-Identifier: BSD-3-Clause */
#include "io/checkpoint.h"
#include "test_fixture.h"

static const double lo[2] = {0.0, 0.0}, hi[2] = {2.0, 1.0};

static mps_particles *block(void) {
  mps_particles *set = box_of(context, 0.1, lo, hi);
  OK(mps_particles_set(set, "density", 0, 1000.0));
  return set;
}

/* The first particle far outside the range of every field. */
static mps_edit open_field(mps_particles *set, const char *name) {
  mps_edit edit;
  OK(mps_particles_edit(set, name, &edit));
  *mps_edit_f64(&edit, 0, 0) = INFINITY;
  return edit;
}

#define REFUSED(call) FAILS(call, MPS_ERROR_STATE, "is being edited")

TEST(of_the_set_alone) {
  scoped_particles *set = block();
  const double points[6] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0}, values[3] = {1.0, 2.0, 3.0};
  int64_t count = -7, ids[4];
  mps_edit edit = open_field(set, "position");
  REFUSED(mps_particles_select_box(set, lo, hi, 4, &count, ids));
  assert_int_equal(count, -7);
  assert_int_equal(mps_particles_nearest(set, lo), -1);
  REFUSED(mps_particles_set_table(set, "temperature", 3, points, 1, values, NULL, NULL));
  const mps_geostatic_layer layer = {.thickness = 10.0, .k0 = 0.5, .density = 1000.0};
  DEF(geostatic, rest, .layer_count = 1, .layers = &layer);
  REFUSED(mps_particles_set_geostatic(set, &rest));
  mps_checkpoint info = mps_checkpoint_defaults();
  const mps_status written = mpsi_checkpoint_write(set, "open_edits.h5", &info);
  if (written != MPS_ERROR_UNSUPPORTED) {
    REFUSED(mpsi_checkpoint_write(set, "open_edits.h5", &info));
    FILE *file = fopen("open_edits.h5", "rb");
    assert_null(file);
  }
  OK(mps_particles_abandon(set, &edit));
  OK(mps_particles_select_box(set, lo, hi, 4, &count, ids));
  assert_int_equal(count, 200);
  assert_int_equal(mps_particles_nearest(set, lo), 0);
}

TEST(of_wls_mpm) {
  scoped_particles *set = block();
  scoped_mpm *mpm = NULL;
  MAKE(material, law, create_linear_elastic, context, 1e6, 0.3);
  USING(mpm, mps_mpm_create(context, set, law, &given, &mpm), .cell = 0.2);
  mps_totals totals;
  mps_snapshot *kept = NULL;
  double value = -7.0;
  const double point[3] = {1.0, 0.5, 0.0};
  int64_t count;
  mps_edit edit = open_field(set, "velocity");
  REFUSED(mps_mpm_get_totals(mpm, &totals));
  REFUSED(mps_grid_evaluate(mps_mpm_grid(mpm), "velocity", 0, 1, point, &value, NULL));
  REFUSED(mps_grid_get_nodes(mps_mpm_grid(mpm), 0, &count, NULL, NULL, NULL, NULL));
  REFUSED(mps_mpm_snapshot(mpm, &kept));
  REFUSED(mps_mpm_step(mpm, 1));
  assert_true(value == -7.0);
  OK(mps_particles_abandon(set, &edit));
  OK(mps_mpm_get_totals(mpm, &totals));
  NEAR(totals.mass, 2000.0, 1e-9);
}

TEST(of_dynamics) {
  scoped_particles *set = block();
  mps_dynamics_def def = mps_dynamics_defaults();
  SET_FIELDS(set, {"shear_velocity", 100.0}, {"pressure_velocity", 200.0}, {"damping", 0.0});
  MAKE(dynamics, solver, create, context, set, &def);
  mps_totals totals;
  DEF(dynamics_boundary, base, .lower[0] = 0.0, .upper[0] = 2.0, .lower[1] = 0.0, .upper[1] = 0.1);
  mps_edit edit = open_field(set, "velocity");
  REFUSED(mps_dynamics_get_totals(solver, &totals));
  REFUSED(mps_dynamics_add_boundary(solver, &base, NULL));
  REFUSED(mps_dynamics_step(solver, 1));
  OK(mps_particles_abandon(set, &edit));
  OK(mps_dynamics_get_totals(solver, &totals));
  OK(mps_dynamics_add_boundary(solver, &base, NULL));
}

TEST(of_the_fluid) {
  scoped_particles *set = block();
  mps_fluid_def def = mps_fluid_defaults();
  MAKE(fluid, fluid, create, context, set, &def);
  DEF(fluid_boundary, bed, .kind = MPS_BOUNDARY_ROLLER, .normal[1] = 1.0);
  OK(mps_fluid_add_boundary(fluid, &bed, NULL));
  mps_totals totals;
  const double station = 1.0, at[3] = {1.0, 0.0, 0.0};
  double level = -7.0, pressure = -7.0;
  int64_t count;
  mps_edit edit = open_field(set, "velocity");
  REFUSED(mps_fluid_get_totals(fluid, &totals));
  REFUSED(mps_fluid_get_levels(fluid, 1, &station, &level));
  REFUSED(mps_fluid_get_pressure(fluid, 0, 1, at, &pressure));
  REFUSED(mps_fluid_get_boundary_points(fluid, 0, 0, &count, NULL, NULL));
  REFUSED(mps_fluid_step(fluid, 1));
  assert_true(level == -7.0 && pressure == -7.0);
  OK(mps_particles_abandon(set, &edit));
  OK(mps_fluid_get_totals(fluid, &totals));
  OK(mps_fluid_get_levels(fluid, 1, &station, &level));
  assert_true(isfinite(level));
}
