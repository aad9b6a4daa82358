/* test_dynamics_arguments.c - the explicit MPS solver refuses bad input by name, value and allowed
 * range, and nothing changes.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "core/particles/particles_internal.h"
#include "test_fixture.h"

static mps_particles *block(double width, double height) {
  return soil_particles(context, 1.0, width, height, 1, &soil_plain);
}

/* ---- definitions ----------------------------------------------------------------------------- */

static void definitions_carry_their_size_and_defaults(void **state) {
  (void)state;
  const mps_dynamics_def d = mps_dynamics_defaults();
  assert_int_equal(d.struct_size, sizeof d);
  assert_int_equal(d.integrator, MPS_DYNAMICS_INTEGRATOR_VERLET);
  assert_int_equal(d.rotation, MPS_DYNAMICS_ROTATION_MEAN_MATRIX);
  assert_int_equal(d.damping, MPS_DYNAMICS_DAMPING_PAIR);
  const double values[] = {d.courant, d.radius_ratio, d.f1, d.f2, d.divergence, d.measure};
  const double expected[] = {0.9, 1.5, 1.0, 14.0, 1e15, 1.0};
  assert_true(isnan(d.dt) && isnan(d.period_x));
  for (int k = 0; k < 6; k++) mps_assert_near(values[k], expected[k], 0.0);
  const mps_dynamics_boundary_def v = mps_dynamics_boundary_defaults();
  assert_int_equal(v.struct_size, sizeof v);
  assert_int_equal(v.normal, 1);
  assert_int_equal(v.kind, MPS_BOUNDARY_HELD);
  for (int c = 0; c < 3; c++) {
    mps_assert_near(v.factor[c], 1.0, 0.0);
    assert_true(isnan(v.lower[c]) && isnan(v.upper[c]));
  }
  assert_true(isnan(v.density) && isnan(v.shear_velocity) && isnan(v.pressure_velocity));
  const mps_dynamics_load_def l = mps_dynamics_load_defaults();
  assert_int_equal(l.struct_size, sizeof l);
  assert_true(isnan(l.area) && l.factor[1] == 1.0 && l.traction[0] == 0.0);
  assert_true(!v.signal[0] && !v.signal[1]);
  const mps_dynamics_predict_def p = mps_dynamics_predict_defaults();
  assert_int_equal(p.struct_size, sizeof p);
  mps_assert_near(p.radius_ratio, 1.5, 0.0);
  assert_int_equal(mps_dynamics_def_init(NULL, sizeof d), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_def_init((mps_dynamics_def *)&d, 8), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_boundary_def_init(NULL, sizeof v), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_load_def_init(NULL, sizeof l), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_predict_def_init(NULL, sizeof p), MPS_ERROR_ARGUMENT);
}

static void definitions_of_another_size(void **state) {
  (void)state;
  mps_particles *set = block(3, 3);
  mps_dynamics *dynamics = (mps_dynamics *)set; /* must become NULL */
  struct {
    mps_dynamics_def known;
    double tail;
  } newer = {.tail = 0.0};
  assert_int_equal(mps_dynamics_def_init(&newer.known, sizeof newer), MPS_OK);
  assert_int_equal(newer.known.struct_size, sizeof newer);
  newer.tail = 1.0;
  mps_assert_fails(context, mps_dynamics_create(context, set, &newer.known, &dynamics),
                   MPS_ERROR_UNSUPPORTED, "does not know");
  assert_null(dynamics);
  newer.tail = 0.0;
  mps_assert_ok(context, mps_dynamics_create(context, set, &newer.known, &dynamics));
  mps_dynamics_destroy(&dynamics);
  newer.known.struct_size = 8;
  mps_assert_fails(context, mps_dynamics_create(context, set, &newer.known, &dynamics),
                   MPS_ERROR_ARGUMENT, "struct_size is 8");
  mps_particles_destroy(&set);
}

/* ---- creation -------------------------------------------------------------------------------- */

/* Sets one member of a good definition and expects its refusal. */
static void refuse(mps_particles *set, size_t offset, bool real, double value, const char *text) {
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics *dynamics = NULL;
  const int32_t whole = (int32_t)(real ? 0.0 : value);
  if (real)
    memcpy((char *)&def + offset, &value, sizeof value);
  else
    memcpy((char *)&def + offset, &whole, sizeof whole);
  mps_assert_fails(context, mps_dynamics_create(context, set, &def, &dynamics), MPS_ERROR_ARGUMENT,
                   text);
  assert_string_equal(mps_context_error(context)->function, "mps_dynamics_create");
  assert_null(dynamics);
}

static void bad_definitions_are_refused(void **state) {
  (void)state;
  mps_particles *set = block(3, 3);
  const uint64_t epoch = mps_particles_epoch(set);
  const int32_t fields = mps_particles_field_count(set);
#define WHOLE(member, value, text)                                                                 \
  refuse(set, offsetof(mps_dynamics_def, member), false, value, text)
#define REAL(member, value, text) refuse(set, offsetof(mps_dynamics_def, member), true, value, text)
  WHOLE(integrator, -1, "integrator is -1, allowed are 0");
  WHOLE(integrator, 3, "integrator is 3, allowed are 0");
  WHOLE(rotation, 10, "rotation is 10, allowed are 0");
  WHOLE(damping, 2, "damping is 2, allowed are 0");
  WHOLE(watch_damping, 2, "watch_damping is 2, allowed are 0");
  WHOLE(reserved, 1, "reserved is 1, allowed are 0");
  REAL(dt, -1e-3, "dt is -0.001, must be at least 1e-12 and at most 1e+09 s, or NaN");
  REAL(dt, 0.0, "dt is 0");
  REAL(dt, 1e-308, "dt is 1e-308");
  REAL(dt, INFINITY, "dt is inf");
  REAL(courant, 0.0, "courant is 0, must be above 0 and at most 1");
  REAL(courant, 1.01, "courant is 1.01");
  REAL(courant, NAN, "courant is nan");
  REAL(radius_ratio, 1.0, "radius_ratio is 1, must be above 1 and at most 4");
  REAL(radius_ratio, 4.1, "radius_ratio is 4.1");
  REAL(radius_ratio, NAN, "radius_ratio is nan");
  REAL(f1, 0.0, "f1 is 0, must be at least 1e-20 and at most 1e+09 Hz");
  REAL(f2, -2.0, "f2 is -2");
  REAL(f2, INFINITY, "f2 is inf");
  REAL(period_x, -1.0, "period_x is -1");
  REAL(period_x, 0.0, "period_x is 0");
  REAL(measure, 0.0, "measure is 0, must be at least 1e-09 and at most 1e+09 m");
  REAL(measure, NAN, "measure is nan");
  REAL(period_x, 2.0, "period_x is 2 m, must be above re = 1.5 m and the body's width 2 m");
  REAL(divergence, 0.0, "divergence is 0, must be above 0 and at most 1e+300 m/s2");
  REAL(divergence, INFINITY, "divergence is inf");
#undef WHOLE
#undef REAL
  assert_int_equal(mps_particles_epoch(set), epoch);
  assert_int_equal(mps_particles_field_count(set), fields);
  mps_dynamics *dynamics = NULL;
  assert_int_equal(mps_dynamics_create(NULL, set, NULL, &dynamics), MPS_ERROR_ARGUMENT);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "out is NULL");
  mps_assert_fails(context, mps_dynamics_create(context, NULL, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "particles is NULL");
  mps_context *other = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_assert_fails(other, mps_dynamics_create(other, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "another context");
  mps_context_destroy(&other);
  mps_particles_destroy(&set);
}

/* Writes one coordinate of a particle, found by its id: the set may have been sorted. */
static void move(mps_particles *set, int64_t id, int component, double x) {
  mps_edit edit;
  mps_assert_ok(context, mps_particles_edit(set, "position", &edit));
  *mps_edit_f64(&edit, mps_particles_index(set, id), component) = x;
  mps_assert_ok(context, mps_particles_commit(set, &edit));
}

/* Writes the mark of the free-field column to which a particle belongs. */
static void mark(mps_particles *set, int64_t id, int64_t column) {
  mps_edit edit;
  mps_assert_ok(context, mps_particles_edit(set, "free_field", &edit));
  *mps_edit_i64(&edit, mps_particles_index(set, id), 0) = column;
  mps_assert_ok(context, mps_particles_commit(set, &edit));
}

/* Puts a value into a field of particle 4 and expects a refusal that leaves no trace. */
static void refuse_value(const char *field, int component, double value, const char *text) {
  mps_particles *set = block(3, 3);
  mps_dynamics *dynamics = NULL;
  mps_assert_ok(context, mps_particles_add_field(set, field, 0));
  double *column = mpsi_particles_column(set, field, component); /* past the set's own check */
  const double former = column[4];
  const uint64_t epoch = mps_particles_epoch(set);
  column[4] = value;
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   text);
  assert_null(dynamics);
  assert_int_equal(mps_particles_epoch(set), epoch);
  column[4] = former; /* mended: as if nothing had been */
  mps_assert_ok(context, mps_dynamics_create(context, set, NULL, &dynamics));
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

static void bad_fields_are_refused_and_can_be_mended(void **state) {
  (void)state;
  const double bad[] = {0.0, -1.0, NAN, INFINITY, 1e-308, 1e20};
  for (int k = 0; k < 6; k++) {
    refuse_value("density", 0, bad[k], "density of particle 4 is");
    refuse_value("shear_velocity", 0, bad[k], "shear_velocity of particle 4 is");
    refuse_value("pressure_velocity", 0, bad[k], "pressure_velocity of particle 4 is");
  }
  refuse_value("pressure_velocity", 0, 141.0, "is 141 m/s, must be at least sqrt(2) times");
  refuse_value("damping", 0, -0.1, "damping of particle 4 is -0.1, must be in 0..1000");
  refuse_value("damping", 0, NAN, "damping of particle 4 is nan");
  refuse_value("position", 0, NAN, "position of particle 4 is nan, must be finite");
  refuse_value("position", 1, 1e12, "to 1e+12 m in y, allowed are 1e+09 spacings");
  refuse_value("displacement", 1, INFINITY, "displacement of particle 4 is inf");
  refuse_value("velocity", 0, NAN, "velocity of particle 4 is nan");
  refuse_value("rotation", 0, NAN, "rotation of particle 4 is nan");
  refuse_value("spin", 0, NAN, "spin of particle 4 is nan");
}

static void particles_at_one_point_are_refused(void **state) {
  (void)state;
  mps_particles *set = block(3, 3);
  mps_dynamics *dynamics = NULL;
  move(set, 4, 0, 0.5);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "two particles lie at the same point (0.5, 1.5)");
  move(set, 4, 0, 1.5);
  mps_assert_ok(context, mps_dynamics_create(context, set, NULL, &dynamics));
  assert_int_equal(mps_dynamics_pairs(dynamics), 6 + 6 + 8);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

static void a_set_needs_material_a_plane_and_particles(void **state) {
  (void)state;
  mps_particles_def def = mps_particles_defaults();
  mps_particles *set = NULL;
  mps_dynamics *dynamics = NULL;
  def.spacing = 1.0;
  mps_assert_ok(context, mps_particles_create(context, &def, &set));
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "has 0 particles, allowed are 1 to");
  const double x[2] = {0.0, 0.0};
  mps_assert_ok(context, mps_particles_append(set, 1, x));
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_FIELD,
                   "no field 'density'");
  mps_particles_destroy(&set);
  def.dim = 3;
  mps_assert_ok(context, mps_particles_create(context, &def, &set));
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics),
                   MPS_ERROR_UNSUPPORTED, "dim 3");
  mps_particles_destroy(&set);
}

static void marks_of_columns_must_make_sense(void **state) {
  (void)state;
  mps_particles *set = block(3, 3);
  mps_dynamics *dynamics = NULL;
  mps_assert_ok(context, mps_particles_add_field(set, "free_field", 0));
  mark(set, 2, 3);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "free_field of particle 2 is 3, allowed are 0, 1 (left), 2 (right)");
  mark(set, 2, -1);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "free_field of particle 2 is -1");
  for (int64_t k = 0; k < 9; k++) mark(set, k, 1);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "all 9 particles belong to free-field columns");
  for (int64_t k = 0; k < 9; k++) mark(set, k, k % 3 == 2 ? 2 : 0);
  move(set, 5, 1, 1.6);
  mps_assert_fails(context, mps_dynamics_create(context, set, NULL, &dynamics), MPS_ERROR_ARGUMENT,
                   "the right free-field column is not a straight stack");
  move(set, 5, 1, 1.5);
  mps_dynamics_def def = mps_dynamics_defaults();
  def.period_x = 10.0;
  mps_assert_fails(context, mps_dynamics_create(context, set, &def, &dynamics), MPS_ERROR_ARGUMENT,
                   "period_x is 10 m, must be NaN with free-field columns");
  mps_assert_ok(context, mps_dynamics_create(context, set, NULL, &dynamics));
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
}

/* ---- calls ----------------------------------------------------------------------------------- */

static void calls_without_a_solver_are_refused(void **state) {
  (void)state;
  mps_dynamics *none = NULL;
  assert_int_equal(soil_add_held(none, 1, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(soil_add_driven(none, 0, NULL, 1.0, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(soil_add_viscous(none, NULL, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_add_free_field(NULL, MPS_DYNAMICS_SIDE_LEFT, 2),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_step(none, 1), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_run(none, 1.0, 1, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_restart(none, 0.0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_set_dt(none, 1.0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_refresh(none), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_snapshot(none, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_rollback(none, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_save(none, "x", NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_restore(none, "x", NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_get_totals(none, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_get_totals(none, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_find_limit(none, 0.0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_set_boundary(none, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_remove_boundary(none, 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_get_reaction(none, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_add_load(none, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_set_load(none, 0, NULL), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_remove_load(none, 0), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_dynamics_get_def(none, NULL), MPS_ERROR_ARGUMENT);
  assert_null(mps_dynamics_particles(none));
  assert_null(mps_dynamics_context(none));
  mps_assert_near(mps_dynamics_limit(none), 0.0, 0.0);
  assert_int_equal(mps_dynamics_predict(NULL, NULL, NULL), MPS_ERROR_ARGUMENT);
  assert_true(mps_dynamics_time(none) == 0.0 && mps_dynamics_dt(none) == 0.0);
  assert_int_equal(mps_dynamics_steps(none), 0);
  assert_int_equal(mps_dynamics_pairs(none), 0);
  mps_dynamics_destroy(&none);
  mps_dynamics_destroy(NULL);
}

static void bad_calls_are_refused(void **state) {
  (void)state;
  mps_particles *set = block(3, 3);
  mps_dynamics *d = soil_solver(context, set);
  mps_dynamics_linear_limit limit = {.dt = -7.0};
  mps_assert_fails(context, mps_dynamics_step(d, -1), MPS_ERROR_ARGUMENT, "count is -1");
  mps_assert_fails(context, mps_dynamics_run(d, NAN, 1, NULL, NULL), MPS_ERROR_ARGUMENT, "nan");
  mps_assert_fails(context, mps_dynamics_run(d, 1.0, 0, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "every is 0");
  mps_assert_fails(context, mps_dynamics_run(d, 1e300, 1, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "1e+300");
  mps_assert_fails(context, mps_dynamics_restart(d, NAN), MPS_ERROR_ARGUMENT, "time is nan");
  const double bad[] = {0.0, -1.0, NAN, INFINITY};
  for (int k = 0; k < 4; k++)
    mps_assert_fails(context, mps_dynamics_set_dt(d, bad[k]), MPS_ERROR_ARGUMENT,
                     "must be in 1e-12..1e+09");
  mps_assert_fails(context, mps_dynamics_get_totals(d, NULL), MPS_ERROR_ARGUMENT, "out is NULL");
  mps_assert_fails(context, mps_dynamics_get_totals(d, NULL), MPS_ERROR_ARGUMENT, "out is NULL");
  mps_assert_fails(context, mps_dynamics_find_limit(d, 0.0, NULL), MPS_ERROR_ARGUMENT, "out");
  mps_assert_fails(context, mps_dynamics_find_limit(d, -1.0, &limit), MPS_ERROR_ARGUMENT,
                   "duration is -1 s, must be finite and >= 0");
  mps_assert_fails(context, mps_dynamics_find_limit(d, NAN, &limit), MPS_ERROR_ARGUMENT, "nan");
  mps_assert_near(limit.dt, -7.0, 0.0);
  mps_assert_near(mps_dynamics_dt(d), 1e-3, 0.0);
  assert_int_equal(mps_dynamics_steps(d), 0);
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(definitions_carry_their_size_and_defaults),
      cmocka_unit_test(definitions_of_another_size),
      cmocka_unit_test(bad_definitions_are_refused),
      cmocka_unit_test(bad_fields_are_refused_and_can_be_mended),
      cmocka_unit_test(particles_at_one_point_are_refused),
      cmocka_unit_test(a_set_needs_material_a_plane_and_particles),
      cmocka_unit_test(marks_of_columns_must_make_sense),
      cmocka_unit_test(calls_without_a_solver_are_refused),
      cmocka_unit_test(bad_calls_are_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
