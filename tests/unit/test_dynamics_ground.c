/* test_dynamics_ground.c - what the body of the explicit MPS solver is made of: a material in place
 * of fields, weight functions, fields edited between steps, particles removed; and a creation that
 * fails late leaves the set as it was.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "unchanged.h"
#include "dynamics/base/dynamics_solver.h"
#include "soil_column.h"
#include "test_fixture.h"

#define DT 1e-3 /* s, a fifth of the limit */

static const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};

static mps_particles *block(mps_context *own, double width, double height) {
  return soil_particles(own, 1.0, width, height, 1, &soil);
}

static mps_dynamics *solver_of(mps_particles *set, mps_material *material, mps_kernel *kernel) {
  DEF(dynamics, def, .dt = DT, .material = material, .kernel = kernel);
  MAKE_KEPT(dynamics, dynamics, create, context, set, &def);
  return dynamics;
}

static double value_of(mps_particles *set, const char *name, int64_t id, int64_t component) {
  mps_view v = view_field(set, name);
  return *mps_view_f64(&v, mps_particles_index(set, id), component);
}

/* Writes one value of a field and commits. */
static mps_status write_one(mps_particles *set, const char *name, int64_t id, double value) {
  mps_edit v;
  OK(mps_particles_edit(set, name, &v));
  *mps_edit_f64(&v, mps_particles_index(set, id), 0) = value;
  return mps_particles_commit(set, &v);
}

/* A push that is not the same for any two particles. */
static void push(mps_particles *set, double speed) {
  OK(mps_particles_add_field(set, "velocity", 0));
  EDIT(v, set, "velocity")
    for (int64_t k = 0; k < v.view.shape[0]; k++) {
      mps_view id = view_field(set, "id");
      const double i = (double)*mps_view_i64(&id, k, 0);
      *mps_edit_f64(&v, k, 0) = speed * sin(0.7 * i);
      *mps_edit_f64(&v, k, 1) = speed * cos(1.3 * i);
    }
}

static void assert_same_motion(mps_particles *a, mps_particles *b, double tolerance) {
  static const char *const names[] = {"displacement", "velocity", "rotation", "spin"};
  assert_int_equal(mps_particles_count(a), mps_particles_count(b));
  mps_view id = view_field(a, "id");
  for (int64_t k = 0; k < mps_particles_count(a); k++)
    for (int f = 0; f < 4; f++)
      for (int c = 0; c < (f < 2 ? 2 : 1); c++)
        NEAR(value_of(a, names[f], *mps_view_i64(&id, k, 0), c),
             value_of(b, names[f], *mps_view_i64(&id, k, 0), c), tolerance);
}

/* ---- material -------------------------------------------------------------------------------- */

TEST(a_material_is_what_its_fields_would_be) {
  mps_material *clay = NULL, *rock = NULL;
  mps_moduli m[2];
  OK(mps_material_create_linear_elastic(context, 4e7, 0.3, &clay));
  OK(mps_material_create_linear_elastic(context, 9e7, 0.2, &rock));
  OK(mps_material_get_moduli(clay, 1500.0, &m[0]));
  OK(mps_material_get_moduli(rock, 1500.0, &m[1]));
  scoped_particles *by_law = block(context, 6, 6), *by_field = block(context, 6, 6);
  const int64_t ids[3] = {30, 4, 17};
  SET_FIELDS(by_field, {"shear_velocity", m[0].shear_velocity},
             {"pressure_velocity", m[0].pressure_velocity});
  for (int k = 0; k < 3; k++) {
    OK(write_one(by_field, "pressure_velocity", ids[k], m[1].pressure_velocity));
    OK(write_one(by_field, "shear_velocity", ids[k], m[1].shear_velocity));
  }
  push(by_law, 1e-3);
  push(by_field, 1e-3);
  scoped_dynamics *a = solver_of(by_law, clay, NULL), *b = solver_of(by_field, NULL, NULL);
  mps_material_destroy(&clay); /* the solver has its share */
  OK(mps_dynamics_set_material(a, rock, ids, 3));
  mps_dynamics_def def;
  OK(mps_dynamics_get_def(a, &def));
  assert_string_equal(mps_material_name(def.material), "linear_elastic");
  OK(mps_dynamics_step(a, 40));
  OK(mps_dynamics_step(b, 40));
  assert_same_motion(by_law, by_field, 1e-15); /* Vs by one square root more: round-off */
  assert_true(fabs(value_of(by_law, "displacement", 17, 0)) > 1e-6);
  mps_material_destroy(&rock);
}

TEST(materials_that_do_not_fit_are_refused) {
  DEF(material_drucker_prager, sand_def, .young = 1e7, .friction = 0.5);
  scoped_material *sand = NULL, *thin = NULL, *light = NULL;
  OK(mps_material_create_drucker_prager(context, &sand_def, &sand));
  OK(mps_material_create_linear_elastic(context, 1e7, -0.1, &thin));
  OK(mps_material_create_linear_elastic(context, 1e-6, 0.3, &light));
  scoped_particles *set = block(context, 4, 4);
  DEF(dynamics, def, .dt = DT, .material = sand);
  scoped_dynamics *d = NULL;
  const int32_t fields = mps_particles_field_count(set);
  FAILS(mps_dynamics_create(context, set, &def, &d), MPS_ERROR_UNSUPPORTED,
        "the law is drucker_prager");
  def.material = thin;
  REFUSES(mps_dynamics_create(context, set, &def, &d),
          "Poisson's ratio of the material is -0.1, must be at least 0");
  assert_int_equal(mps_particles_field_count(set), fields);
  NEAR(value_of(set, "shear_velocity", 0, 0), 100.0, 0.0);
  d = solver_of(set, NULL, NULL);
  const int64_t ids[2] = {3, 99};
  REFUSES(mps_dynamics_set_material(d, NULL, NULL, 0), "material is NULL");
  REFUSES(mps_dynamics_set_material(d, light, ids, 2), "ids[1] is 99");
  REFUSES(mps_dynamics_set_material(d, light, NULL, 3), "count is 3");
  FAILS(mps_dynamics_set_material(d, sand, NULL, 0), MPS_ERROR_UNSUPPORTED, "drucker_prager");
  mps_material_destroy(&light);
  OK(mps_material_create_linear_elastic(context, 1e-6, 0.49, &light));
  OK(mps_particles_set(set, "density", 0, 1e9));
  REFUSES(mps_dynamics_set_material(d, light, NULL, 0), "wave velocities of");
  NEAR(value_of(set, "shear_velocity", 3, 0), 100.0, 0.0);
  assert_int_equal(mps_dynamics_set_material(NULL, light, NULL, 0), MPS_ERROR_ARGUMENT);
}

/* Particles that the call does not concern may have values that the solver refuses: then the call
 * has written none. */
TEST(a_refused_material_writes_no_velocities) {
  scoped_particles *set = block(context, 4, 4);
  MAKE(material, stiff, create_linear_elastic, context, 8e7, 0.25);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  const double shear = value_of(set, "shear_velocity", 3, 0);
  const double pressure = value_of(set, "pressure_velocity", 3, 0);
  const int64_t ids[1] = {3};
  OK(write_one(set, "pressure_velocity", 7, 1.1 * shear));
  REFUSES(mps_dynamics_set_material(d, stiff, ids, 1), "pressure_velocity of particle 7");
  NEAR(value_of(set, "shear_velocity", 3, 0), shear, 0.0);
  NEAR(value_of(set, "pressure_velocity", 3, 0), pressure, 0.0);
  OK(write_one(set, "pressure_velocity", 7, pressure));
  OK(mps_dynamics_set_material(d, stiff, ids, 1));
  assert_true(value_of(set, "shear_velocity", 3, 0) != shear);
}

/* Totals of a state that the caller has written are those of the beginning of its motion. */
TEST(totals_are_of_the_written_rotations) {
  for (int rotation = 0; rotation < 2; rotation++) {
    scoped_particles *set = block(context, 5, 5);
    DEF(dynamics, def, .dt = DT, .rotation = rotation);
    mps_totals written, begun;
    MAKE(dynamics, d, create, context, set, &def);
    OK(mps_particles_set(set, "rotation", 0, 0.3));
    OK(mps_dynamics_get_totals(d, &written));
    OK(mps_dynamics_restart(d, 0.0));
    OK(mps_dynamics_get_totals(d, &begun));
    assert_true(begun.strain > 0.0);
    NEAR(written.strain, begun.strain, 1e-12 * begun.strain);
  }
}

/* What leads from one material to another is no work of the scheme: the budget stays closed. */
TEST(a_material_changes_in_motion) {
  scoped_particles *set = block(context, 6, 6);
  MAKE(material, stiff, create_linear_elastic, context, 8e7, 0.25);
  push(set, 1e-4);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  OK(mps_dynamics_step(d, 30));
  mps_totals before, after;
  OK(mps_dynamics_get_totals(d, &before));
  OK(mps_particles_set_material(set, stiff, 1500.0, NULL, 0));
  OK(mps_dynamics_step(d, 30));
  OK(mps_dynamics_get_totals(d, &after));
  NEAR(after.scheme, before.scheme, 1e-6 * after.kinetic); /* rotations of 1e-5 */
  NEAR(after.linear[0], before.linear[0], 1e-12);
  mps_dynamics_linear_limit limit;
  OK(mps_dynamics_find_limit(d, 0.0, &limit));
  NEAR(limit.omega, sqrt(24.0 * 8e7 / 2.5 / 1500.0), 0.1 * limit.omega); /* spin mode */
}

/* ---- weight functions ------------------------------------------------------------------------ */

TEST(the_default_weight_is_that_of_a_handle) {
  scoped_particles *a = block(context, 5, 7), *b = block(context, 5, 7);
  MAKE_KEPT(kernel, w, create, context, MPS_KERNEL_MPS, 1.5);
  push(a, 1e-3);
  push(b, 1e-3);
  scoped_dynamics *plain = solver_of(a, NULL, NULL), *with = solver_of(b, NULL, w);
  mps_kernel_destroy(&w); /* shared */
  OK(mps_dynamics_step(plain, 25));
  OK(mps_dynamics_step(with, 25));
  assert_same_motion(a, b, 0.0);
  mps_dynamics_def def;
  OK(mps_dynamics_get_def(with, &def));
  NEAR(mps_kernel_radius(def.kernel), 1.5, 0.0);
  NEAR(def.radius_ratio, 1.5, 0.0);
}

static const struct {
  int32_t kind;
  double radius;
} weights[] = {{MPS_KERNEL_MPS, 2.5},     {MPS_KERNEL_SPLINE2, 1.5}, {MPS_KERNEL_SPLINE2, 2.1},
               {MPS_KERNEL_SPLINE3, 1.7}, {MPS_KERNEL_SPLINE3, 2.0}, {MPS_KERNEL_SPLINE3, 3.3}};
#define WEIGHTS (int)(sizeof weights / sizeof *weights)

/* In uniform strain the inside has its exact pressure -lambda tr(eps) and no force, whatever the
 * weight. */
TEST(uniform_strain_is_exact_inside_for_every_weight) {
  for (int k = 0; k < WEIGHTS; k++) {
    MAKE(kernel, w, create, context, weights[k].kind, weights[k].radius);
    scoped_particles *set = block(context, 15, 15);
    scoped_dynamics *d = solver_of(set, NULL, w);
    mps_view x = view_field(set, "reference");
    EDIT(u, set, "displacement")
      for (int64_t i = 0; i < u.view.shape[0]; i++) {
        *mps_edit_f64(&u, i, 0) = 1e-6 * *mps_view_f64(&x, i, 0);
        *mps_edit_f64(&u, i, 1) = 3e-6 * *mps_view_f64(&x, i, 1);
      }
    OK(mps_dynamics_refresh(d));
    const int64_t middle = 7 * 15 + 7;
    const double lambda = 1500.0 * (200.0 * 200.0 - 2.0 * 100.0 * 100.0);
    NEAR(value_of(set, "pressure", middle, 0), -lambda * 4e-6, 1e-4 * lambda * 4e-6);
    for (int c = 0; c < 2; c++) NEAR(value_of(set, "acceleration", middle, c), 0.0, 1e-6);
    assert_true(fabs(value_of(set, "acceleration", 7 * 15, 0)) > 1e-3); /* the edge has a force */
  }
}

/* mps_dynamics_limit is a bound from below, at most a quarter below where all ground is alike. */
TEST(the_quick_limit_holds_for_every_weight) {
  static const double size[3][2] = {{12, 3}, {9, 8}, {20, 2}};
  for (int k = 0; k < WEIGHTS; k++)
    for (int s = 0; s < 6; s++) {
      MAKE(kernel, w, create, context, weights[k].kind, weights[k].radius);
      scoped_particles *set = block(context, size[s % 3][0], size[s % 3][1]);
      if (s >= 3) OK(mps_particles_set(set, "pressure_velocity", 0, 900.0));
      scoped_dynamics *d = solver_of(set, NULL, w);
      const double quick = mps_dynamics_limit(d);
      mps_dynamics_linear_limit limit;
      OK(mps_dynamics_find_limit(d, 0.0, &limit));
      if (!(quick <= limit.dt && quick >= 0.6 * limit.dt))
        fail_msg("weight %d, shape %d: quick limit %g s, limit %g s", k, s, quick, limit.dt);
    }
}

TEST(weights_that_reach_too_far_are_refused) {
  static const double radius[2] = {0.9, 4.1};
  scoped_particles *set = block(context, 4, 4);
  for (int k = 0; k < 2; k++) {
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    OK(mps_kernel_create(context, MPS_KERNEL_MPS, radius[k], &def.kernel));
    REFUSES(mps_dynamics_create(context, set, &def, &d), "radius of influence is");
    mps_kernel_destroy(&def.kernel);
  }
}

/* ---- edits ----------------------------------------------------------------------------------- */

/* Ground edited before the first step is that of a solver made with it. */
TEST(edited_ground_is_taken_up) {
  scoped_particles *a = block(context, 5, 5), *b = block(context, 5, 5);
  push(a, 1e-3);
  push(b, 1e-3);
  scoped_dynamics *edited = solver_of(a, NULL, NULL);
  const double limit = mps_dynamics_limit(edited);
  OK(write_one(a, "shear_velocity", 7, 150.0)); /* too much for Vp */
  REFUSES(mps_dynamics_step(edited, 1), "pressure_velocity of particle 7 is 200 m/s");
  assert_int_equal(mps_context_error(context)->particle, 7);
  assert_int_equal(mps_dynamics_steps(edited), 0);
  OK(write_one(a, "pressure_velocity", 7, 300.0));
  OK(write_one(a, "density", 8, 900.0));
  OK(write_one(a, "damping", 9, 0.1));
  assert_true(mps_dynamics_limit(edited) < 0.9 * limit);
  OK(write_one(b, "shear_velocity", 7, 150.0));
  OK(write_one(b, "pressure_velocity", 7, 300.0));
  OK(write_one(b, "density", 8, 900.0));
  OK(write_one(b, "damping", 9, 0.1));
  scoped_dynamics *made = solver_of(b, NULL, NULL);
  OK(mps_dynamics_step(edited, 20));
  OK(mps_dynamics_step(made, 20));
  assert_same_motion(a, b, 0.0);
}

/* Stiffness-proportional damping is the rate of a force: a jump of the ground is no rate. */
TEST(a_jump_of_the_ground_is_not_damped) {
  scoped_particles *set = block(context, 4, 4);
  SET_FIELDS(set, {"damping", 0.05}, {"displacement", 0.0});
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  OK(write_one(set, "displacement", 5, 1e-5));
  OK(mps_dynamics_step(d, 1));
  OK(mps_particles_set(set, "density", 0, 750.0)); /* half the mass */
  const double former = value_of(set, "acceleration", 5, 0);
  OK(mps_dynamics_step(d, 1));
  const double now = value_of(set, "acceleration", 5, 0);
  /* G = rho Vs^2 is half too: the same acceleration but for mass-proportional damping and the 1e-4
   * of its period that has passed; with the jump counted it would be five times as much */
  NEAR(now, former, 0.25 * fabs(former));
}

TEST(an_edited_motion_needs_a_restart) {
  scoped_particles *set = block(context, 4, 4), *twin = block(context, 4, 4);
  scoped_dynamics *d = solver_of(set, NULL, NULL), *fresh = NULL;
  scoped_snapshot *kept = NULL;
  OK(mps_dynamics_step(d, 3));
  OK(mps_dynamics_snapshot(d, &kept));
  OK(write_one(set, "velocity", 5, 0.25));
  FAILS(mps_dynamics_step(d, 1), MPS_ERROR_STATE,
        "field 'velocity' has been written: mps_dynamics_restart begins");
  FAILS(mps_dynamics_snapshot(d, &kept), MPS_ERROR_STATE, "'velocity'");
  OK(mps_dynamics_rollback(d, kept));
  NEAR(value_of(set, "velocity", 5, 0), 0.0, 0.0);
  OK(mps_dynamics_step(d, 1));
  OK(write_one(set, "velocity", 5, 0.25));
  OK(mps_dynamics_restart(d, 0.0));
  OK(mps_particles_set(twin, "velocity", 0, 0.0));
  OK(write_one(twin, "velocity", 5, 0.25));
  fresh = solver_of(twin, NULL, NULL);
  OK(mps_dynamics_step(d, 10));
  OK(mps_dynamics_step(fresh, 10));
  assert_same_motion(set, twin, 0.0);
}

TEST(what_the_solver_relies_on_stays) {
  scoped_particles *set = block(context, 4, 4);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  scoped_snapshot *kept = NULL;
  OK(mps_dynamics_snapshot(d, &kept));
  const double x = value_of(set, "position", 5, 0);
  EDIT(v, set, "position") {
    *mps_edit_f64(&v, mps_particles_index(set, 5), 0) = x + 0.1;
    FAILS(mps_particles_commit(set, &v), MPS_ERROR_STATE, "write the former ones back");
    *mps_edit_f64(&v, mps_particles_index(set, 5), 0) = x;
  }
  OK(mps_dynamics_step(d, 1));
  OK(write_one(set, "reference", 5, 0.0));
  FAILS(mps_dynamics_step(d, 1), MPS_ERROR_STATE,
        "field 'reference' has been written, which the solver relies on");
  FAILS(mps_dynamics_run(d, 1.0, 1, NULL, NULL), MPS_ERROR_STATE, "reference");
  OK(mps_dynamics_rollback(d, kept));
  OK(mps_dynamics_step(d, 1));
}

/* ---- creation that fails late ---------------------------------------------------------------- */

/* Particles that need sorting, a free-field column, damping and a material. */
static mps_particles *hard_set(mps_context *own) {
  mps_particles *set = block(own, 3, 6);
  const double x[2] = {3.5, 0.5};
  OK(mps_particles_append(set, 1, x));
  SET_FIELDS(set, {"density", 1500.0}, {"damping", 0.05}, {"shear_velocity", 100.0},
             {"pressure_velocity", 200.0});
  OK(mps_dynamics_add_free_field(set, MPS_SIDE_X_LOWER, 3));
  return set;
}

TEST(a_failed_creation_changes_nothing) {
  for (int late = 0; late < 2; late++) {
    scoped_particles *set = hard_set(context);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    OK(mps_material_create_linear_elastic(context, 1e7, 0.3, &def.material));
    EDIT(x, set, "position") {
      const int64_t last = mps_particles_count(set) - 1; /* of the column */
      if (late)
        *mps_edit_f64(&x, last, 1) += 0.5;
      else
        for (int c = 0; c < 2; c++) *mps_edit_f64(&x, 0, c) = *mps_view_f64(&x.view, 1, c);
    }
    const uint64_t before = seen_set(set);
    REFUSES(mps_dynamics_create(context, set, &def, &d),
            late ? "not a straight stack" : "particles 0 and 1 lie at the same point");
    assert_null(d);
    assert_true(seen_set(set) == before);
    const double more[2] = {9.5, 9.5};
    OK(mps_particles_append(set, 1, more)); /* no solver holds it */
    mps_material_destroy(&def.material);
  }
}

/* ---- particles that go ----------------------------------------------------------------------- */

/* Gravity, a traction on the top row, the base held, one side on dashpots. */
static void load_block(mps_dynamics *d, bool top) {
  mps_particles *set = mps_dynamics_particles(d);
  int32_t number;
  int64_t count;
  mps_dynamics_load_def weight = mps_dynamics_load_defaults(), push_down = weight;
  weight.kind = MPS_DYNAMICS_LOAD_BODY, weight.all = 1;
  weight.acceleration[1] = -0.0981; /* small rotations: the budget closes */
  push_down.traction[1] = -2e2;
  for (int c = 0; c < 2; c++) push_down.lower[c] = -1e9, push_down.upper[c] = 1e9;
  push_down.lower[1] = 7.0;
  OK(mps_dynamics_add_load(d, &weight, &number));
  if (top) OK(mps_dynamics_add_load(d, &push_down, &number));
  soil_hold(set, d, MPS_DOF_X | MPS_DOF_Y, -1.0, -1.0, 99.0, 0.99);
  int64_t *ids = soil_select(set, -1.0, -1.0, 0.99, 99.0, &count);
  OK(soil_add_viscous(d, NULL, count, ids));
  free(ids);
}

/* Copies displacements, velocities and so on by position. */
static void copy_motion(mps_particles *from, mps_particles *to) {
  static const char *const names[] = {"displacement", "velocity", "rotation", "spin"};
  for (int f = 0; f < 4; f++) {
    OK(mps_particles_add_field(to, names[f], 0));
    mps_view a = view_field(from, names[f]);
    mps_view ref = view_field(from, "reference");
    mps_view at = view_field(to, "reference");
    EDIT(b, to, names[f])
      for (int64_t j = 0; j < b.view.shape[0]; j++)
        for (int64_t i = 0; i < a.shape[0]; i++)
          if (*mps_view_f64(&ref, i, 0) == *mps_view_f64(&at, j, 0) &&
              *mps_view_f64(&ref, i, 1) == *mps_view_f64(&at, j, 1))
            for (int64_t c = 0; c < b.view.shape[1]; c++)
              *mps_edit_f64(&b, j, c) = *mps_view_f64(&a, i, c);
  }
}

/* The top row of a loaded block is dug away while it moves: from then on it moves as a new solver
 * on the particles that are left, started from the same displacements and velocities. */
TEST(an_excavation_is_a_new_solver_on_what_is_left) {
  scoped_particles *set = block(context, 9, 8), *rest = block(context, 9, 7);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  load_block(d, true);
  OK(mps_dynamics_step(d, 50));
  int64_t count, body = mps_particles_count(set);
  int64_t *ids = soil_select(set, -1.0, 6.9, 99.0, 99.0, &count);
  assert_int_equal(count, 9);
  mps_totals before, after;
  OK(mps_dynamics_get_totals(d, &before));
  OK(mps_particles_remove(set, ids, count));
  assert_int_equal(mps_particles_count(set), body - 9);
  scoped_dynamics *fresh = solver_of(rest, NULL, NULL);
  load_block(fresh, false); /* the traction was removed with its row */
  copy_motion(set, rest);
  OK(mps_dynamics_restart(fresh, mps_dynamics_time(d)));
  assert_int_equal(d->pairs, fresh->pairs);
  for (int part = 0; part < 2; part++) { /* refresh has a snapshot of its own */
    OK(mps_dynamics_step(d, 40));
    OK(mps_dynamics_step(fresh, 40));
    OK(mps_dynamics_refresh(d));
  }
  mps_view id = view_field(set, "id");
  mps_view at = view_field(set, "position");
  double most = 0.0;
  for (int64_t k = 0; k < at.shape[0]; k++) {
    const int64_t row = (int64_t)(value_of(set, "reference", *mps_view_i64(&id, k, 0), 1));
    const int64_t column = (int64_t)(value_of(set, "reference", *mps_view_i64(&id, k, 0), 0));
    for (int c = 0; c < 2; c++) {
      const double u = value_of(set, "displacement", *mps_view_i64(&id, k, 0), c);
      NEAR(u, value_of(rest, "displacement", row * 9 + column, c), 1e-14);
      most = fmax(most, fabs(u));
    }
  }
  assert_true(most > 1e-5);
  mps_reaction r[2];
  for (int32_t b = 0; b < 2; b++) {
    OK(mps_dynamics_get_reaction(d, b, &r[0]));
    OK(mps_dynamics_get_reaction(fresh, b, &r[1]));
    NEAR(r[0].force[1], r[1].force[1], 1e-8 * fabs(r[1].force[1]));
    assert_int_equal(r[0].count, b == 0 ? 9 : 7);
  }
  OK(mps_dynamics_get_totals(d, &after));
  NEAR(after.mass, 63.0 * 1500.0, 1e-6);
  NEAR(after.scheme, before.scheme, 1e-5 * after.kinetic); /* rotations of 1e-5 */
  free(ids);
}

/* All that a run shows: fields, totals, reactions. */
typedef struct outcome {
  uint64_t fields, ids;
  mps_totals totals;
  mps_reaction held, viscous;
} outcome;

static outcome outcome_of(mps_dynamics *d, int64_t steps) {
  outcome o;
  memset(&o, 0, sizeof o);
  OK(mps_dynamics_step(d, steps));
  o.fields = seen_values(mps_dynamics_particles(d));
  o.ids = digest_fields(mps_dynamics_particles(d), (const char *const[]){"id", NULL});
  OK(mps_dynamics_get_totals(d, &o.totals));
  OK(mps_dynamics_get_reaction(d, 0, &o.held));
  OK(mps_dynamics_get_reaction(d, 1, &o.viscous));
  return o;
}

static void assert_same_outcome(outcome a, outcome b) {
  assert_true(a.fields == b.fields && a.ids == b.ids);
  assert_memory_equal(&a.totals, &b.totals, sizeof a.totals);
  assert_memory_equal(&a.held, &b.held, sizeof a.held);
  assert_memory_equal(&a.viscous, &b.viscous, sizeof a.viscous);
}

/* Back and forth across two removals, of particles that are held, loaded and beside dashpots: every
 * way on is the first one, bit for bit. */
TEST(a_rollback_brings_back_what_was_dug_away) {
  scoped_particles *set = block(context, 9, 8);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  scoped_snapshot *whole = NULL, *dug = NULL, *deep = NULL;
  int64_t count, corner;
  load_block(d, true);
  int64_t *ids = soil_select(set, -1.0, 6.9, 99.0, 99.0, &count);
  int64_t *low = soil_select(set, -1.0, -1.0, 1.9, 2.1, &corner);
  OK(mps_dynamics_step(d, 50));
  OK(mps_dynamics_snapshot(d, &whole));
  const outcome first = outcome_of(d, 30);
  OK(mps_dynamics_rollback(d, whole));
  OK(mps_particles_remove(set, ids, count));
  const double dt = mps_dynamics_dt(d);
  OK(mps_dynamics_snapshot(d, &dug));
  const outcome second = outcome_of(d, 30);
  OK(mps_particles_remove(set, low, corner));
  OK(mps_dynamics_snapshot(d, &deep));
  const outcome third = outcome_of(d, 30);
  for (int pass = 0; pass < 2; pass++) {
    OK(mps_dynamics_rollback(d, whole));
    assert_int_equal(mps_particles_count(set), 72);
    assert_same_outcome(outcome_of(d, 30), first);
    OK(mps_dynamics_rollback(d, deep));
    assert_same_outcome(outcome_of(d, 30), third);
    OK(mps_dynamics_rollback(d, dug));
    assert_true(mps_dynamics_dt(d) == dt);
    assert_same_outcome(outcome_of(d, 30), second);
    OK(mps_dynamics_refresh(d));
  }
  DEF(dynamics_boundary, other, .dofs = MPS_DOF_X | MPS_DOF_Y, .ids = low, .id_count = 1);
  OK(mps_dynamics_set_boundary(d, 0, &other));
  FAILS(mps_dynamics_rollback(d, whole), MPS_ERROR_STATE,
        "boundary0/particles is 9, in this solver 1 of those");
  assert_int_equal(mps_particles_count(set), 72 - count);
  free(ids);
  free(low);
}

TEST(removals_that_cannot_be_are_refused) {
  scoped_particles *set = hard_set(context);
  scoped_dynamics *d = solver_of(set, NULL, NULL);
  const int64_t n = mps_particles_count(set), of_column[1] = {n - 1};
  const double x[2] = {9.5, 9.5};
  int64_t all[64];
  for (int64_t k = 0; k < 19; k++) all[k] = k;
  OK(mps_dynamics_step(d, 5));
  const uint64_t before = seen_set(set);
  REFUSES(mps_particles_remove(set, of_column, 1), "belongs to a free-field column");
  REFUSES(mps_particles_remove(set, all, 19), "all 19 particles of the body are to be removed");
  FAILS(mps_particles_append(set, 1, x), MPS_ERROR_STATE, "takes no more particles");
  assert_true(seen_set(set) == before);
  OK(mps_particles_remove(set, all, 1)); /* beside the column */
  OK(mps_dynamics_step(d, 5));
}
