/* test_dynamics_arguments.c - the explicit MPS solver refuses bad input by name, value and allowed
 * range, and nothing changes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics/base/dynamics_solver.h"
#include "soil_column.h"
#include "core/particles/particles_internal.h"
#include "test_fixture.h"
#include "test_journal.h"

static mps_particles *block(double width, double height) {
  return soil_particles(context, 1.0, width, height, 1, &soil_plain);
}

/* ---- creation -------------------------------------------------------------------------------- */

TEST(bad_definitions_are_refused) {
  scoped_particles *set = block(3, 3);
  const uint64_t epoch = mps_particles_epoch(set);
  const int32_t fields = mps_particles_field_count(set);
  DEF(dynamics, def, .period_x = 2.0);
  mps_dynamics *dynamics = NULL;
  REFUSES(mps_dynamics_create(context, set, &def, &dynamics),
          "period_x is 2 m, must be above re = 1.5 m and the body's width 2 m");
  assert_null(dynamics);
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(mps_particles_field_count(set), fields);
  assert_int_equal(mps_dynamics_create(NULL, set, NULL, &dynamics), MPS_ERROR_ARGUMENT);
  REFUSES(mps_dynamics_create(context, set, NULL, NULL), "out is NULL");
  REFUSES(mps_dynamics_create(context, NULL, NULL, &dynamics), "particles is NULL");
  scoped_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  FAILS_ON(other, mps_dynamics_create(other, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
           "another context");
}

/* A period that leaves a gap of re or more beside the body is warned of: nothing is periodic. */
TEST(a_period_that_joins_nothing_is_warned_of) {
  static const double periods[] = {4.0, 5.0, 5.4, 5.6, 8.0, 4000.0};
  for (int k = 0; k < (int)(sizeof periods / sizeof *periods); k++)
    for (double spacing = 0.5; spacing <= 2.0; spacing *= 2.0) {
      journal log = {0};
      scoped_context *own = journal_context(&log, NULL);
      scoped_particles *set =
          soil_particles(own, spacing, 5.0 * spacing, 3.0 * spacing, 1, &soil_plain);
      DEF(dynamics, def, .period_x = periods[k] * spacing);
      mps_dynamics *dynamics = NULL;
      const mps_status status = mps_dynamics_create(own, set, &def, &dynamics);
      assert_int_equal(status, k == 0 ? MPS_ERROR_ARGUMENT : MPS_OK); /* 0: the width itself */
      assert_int_equal(log.count, periods[k] > 5.5);
      char text[64];
      snprintf(text, sizeof text, "ground without end has a period_x of %g m", 5.0 * spacing);
      if (log.count > 0) assert_non_null(strstr(log.last, text));
      mps_dynamics_destroy(&dynamics);
    }
}

/* Writes one coordinate of a particle, found by its id: the set may have been sorted. */
static void move(mps_particles *set, int64_t id, int component, double x) {
  EDIT(edit, set, "position") *mps_edit_f64(&edit, mps_particles_index(set, id), component) = x;
}

/* Writes the mark of the free-field column to which a particle belongs. */
static void mark(mps_particles *set, int64_t id, int64_t column) {
  EDIT(edit, set, "free_field") *mps_edit_i64(&edit, mps_particles_index(set, id), 0) = column;
}

/* Puts a value into a field of particle 4 and expects a refusal that leaves no trace. */
static void refuse_value(const char *field, int component, double value, const char *text) {
  scoped_particles *set = block(3, 3);
  scoped_dynamics *dynamics = NULL;
  OK(mps_particles_add_field(set, field, 0));
  double *column = mpsi_particles_column(set, field, component); /* past the set's own check */
  const double former = column[4];
  const uint64_t epoch = mps_particles_epoch(set);
  column[4] = value;
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics), text);
  assert_null(dynamics);
  assert_int_equal(mps_particles_epoch(set), epoch);
  column[4] = former; /* mended: as if nothing had been */
  OK(mps_dynamics_create(context, set, NULL, &dynamics));
}

TEST(bad_fields_are_refused_and_can_be_mended) {
  const double bad[] = {0.0, -1.0, NAN, INFINITY, 1e-308, 1e20};
  for (int k = 0; k < 6; k++) {
    refuse_value("density", 0, bad[k], "density of particle 4 is");
    refuse_value("shear_velocity", 0, bad[k], "shear_velocity of particle 4 is");
    refuse_value("pressure_velocity", 0, bad[k], "pressure_velocity of particle 4 is");
  }
  refuse_value("pressure_velocity", 0, 141.0, "is 141 m/s, must be at least sqrt(2) times");
  refuse_value("damping", 0, -0.1, "damping of particle 4 is -0.1, must be in 0 to 1000");
  refuse_value("damping", 0, NAN, "damping of particle 4 is nan");
  refuse_value("position", 0, NAN, "position of particle 4 is nan, must be finite");
  refuse_value("position", 1, 1e12, "to 1e+12 m in y, allowed are 1e+09 spacings");
  refuse_value("displacement", 1, INFINITY, "displacement of particle 4 is inf");
  refuse_value("velocity", 0, NAN, "velocity of particle 4 is nan");
  refuse_value("rotation", 0, NAN, "rotation of particle 4 is nan");
  refuse_value("spin", 0, NAN, "spin of particle 4 is nan");
}

TEST(particles_at_one_point_are_refused) {
  scoped_particles *set = block(3, 3);
  scoped_dynamics *dynamics = NULL;
  move(set, 4, 0, 0.5);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics),
          "particles 3 and 4 lie at the same point (0.5, 1.5)");
  move(set, 4, 0, 1.5);
  OK(mps_dynamics_create(context, set, NULL, &dynamics));
  assert_int_equal(dynamics->pairs, 6 + 6 + 8);
}

TEST(a_set_needs_material_a_plane_and_particles) {
  DEF(particles, def, .spacing = 1.0);
  mps_dynamics *dynamics = NULL;
  MAKE(particles, set, create, context, &def);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics), "has 0 particles, allowed are 1 to");
  const double x[2] = {0.0, 0.0};
  OK(mps_particles_append(set, 1, x));
  FAILS(mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_FIELD, "no field 'density'");
  mps_particles_destroy(&set);
  def.dim = 3;
  OK(mps_particles_create(context, &def, &set));
  FAILS(mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_UNSUPPORTED, "dim 3");
}

TEST(marks_of_columns_must_make_sense) {
  scoped_particles *set = block(3, 3);
  scoped_dynamics *dynamics = NULL;
  OK(mps_particles_add_field(set, "free_field", 0));
  mark(set, 2, 3);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics),
          "free_field of particle 2 is 3, allowed are 0, 1 (left), 2 (right)");
  mark(set, 2, -1);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics), "free_field of particle 2 is -1");
  for (int64_t k = 0; k < 9; k++) mark(set, k, 1);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics),
          "all 9 particles belong to free-field columns");
  for (int64_t k = 0; k < 9; k++) mark(set, k, k % 3 == 2 ? 2 : 0);
  move(set, 5, 1, 1.6);
  REFUSES(mps_dynamics_create(context, set, NULL, &dynamics),
          "the right free-field column is not a straight stack");
  move(set, 5, 1, 1.5);
  DEF(dynamics, def, .period_x = 10.0);
  REFUSES(mps_dynamics_create(context, set, &def, &dynamics),
          "period_x is 10 m, must be NaN with free-field columns");
  OK(mps_dynamics_create(context, set, NULL, &dynamics));
}

/* ---- calls ----------------------------------------------------------------------------------- */

/* Those that are not of all solvers, which unit/hdf5_solvers tries. */
TEST(calls_without_a_solver_are_refused) {
  assert_int_equal(mps_dynamics_add_free_field(NULL, MPS_SIDE_X_LOWER, 2), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_restart(NULL, 0.0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_refresh(NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_find_limit(NULL, 0.0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_predict(NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
}

TEST(bad_calls_are_refused) {
  scoped_particles *set = block(3, 3);
  scoped_dynamics *d = soil_solver(context, set);
  mps_dynamics_linear_limit limit = {.dt = -7.0};
  REFUSES(mps_dynamics_step(d, -1), "count is -1");
  REFUSES(mps_dynamics_run(d, NAN, 1, NULL, NULL), "nan");
  REFUSES(mps_dynamics_run(d, 1.0, 0, NULL, NULL), "every is 0");
  REFUSES(mps_dynamics_run(d, 1e300, 1, NULL, NULL), "1e+300");
  REFUSES(mps_dynamics_restart(d, NAN), "time is nan");
  const double bad[] = {0.0, -1.0, NAN, INFINITY};
  for (int k = 0; k < 4; k++) REFUSES(mps_dynamics_set_dt(d, bad[k]), "must be in 1e-12 to 1e+09");
  REFUSES(mps_dynamics_get_totals(d, NULL), "out is NULL");
  REFUSES(mps_dynamics_find_limit(d, 0.0, NULL), "out");
  REFUSES(mps_dynamics_find_limit(d, -1.0, &limit), "duration is -1 s, must be finite and >= 0");
  REFUSES(mps_dynamics_find_limit(d, NAN, &limit), "nan");
  NEAR(limit.dt, -7.0, 0.0);
  NEAR(mps_dynamics_dt(d), 1e-3, 0.0);
  assert_int_equal(mps_dynamics_steps(d), 0);
}
