/* test_dynamics_ground.c - what the body of the explicit MPS solver is made of: a material in place
 * of fields, weight functions, fields edited between steps, particles removed; and a creation that
 * fails late leaves the set as it was.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_allocator.h"
#include "test_fixture.h"

#include <mps/experimental.h>

#define DT 1e-3 /* s, a fifth of the limit */

static const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};

static mps_particles *block(mps_context *own, double width, double height) {
  return soil_particles(own, 1.0, width, height, 1, &soil);
}

static mps_dynamics *solver_of(mps_particles *set, mps_material *material, mps_kernel *kernel) {
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics *dynamics = NULL;
  def.dt = DT;
  def.material = material;
  def.kernel = kernel;
  mps_assert_ok(context, mps_dynamics_create(context, set, &def, &dynamics));
  return dynamics;
}

static double value_of(mps_particles *set, const char *name, int64_t id, int64_t component) {
  mps_view v;
  mps_assert_ok(context, mps_particles_view(set, name, &v));
  return *mps_view_f64(&v, mps_particles_index(set, id), component);
}

/* Writes one value of a field and commits. */
static mps_status write_one(mps_particles *set, const char *name, int64_t id, double value) {
  mps_edit v;
  mps_assert_ok(context, mps_particles_edit(set, name, &v));
  *mps_edit_f64(&v, mps_particles_index(set, id), 0) = value;
  return mps_particles_commit(set, &v);
}

/* A push that is not the same for any two particles. */
static void push(mps_particles *set, double speed) {
  mps_edit v;
  mps_assert_ok(context, mps_particles_add_field(set, "velocity", 0));
  mps_assert_ok(context, mps_particles_edit(set, "velocity", &v));
  for (int64_t k = 0; k < v.view.shape[0]; k++) {
    mps_view id;
    mps_assert_ok(context, mps_particles_view(set, "id", &id));
    const double i = (double)*mps_view_i64(&id, k, 0);
    *mps_edit_f64(&v, k, 0) = speed * sin(0.7 * i);
    *mps_edit_f64(&v, k, 1) = speed * cos(1.3 * i);
  }
  mps_assert_ok(context, mps_particles_commit(set, &v));
}

static void assert_same_motion(mps_particles *a, mps_particles *b, double tolerance) {
  static const char *const names[] = {"displacement", "velocity", "rotation", "spin"};
  assert_int_equal(mps_particles_count(a), mps_particles_count(b));
  mps_view id;
  mps_assert_ok(context, mps_particles_view(a, "id", &id));
  for (int64_t k = 0; k < mps_particles_count(a); k++)
    for (int f = 0; f < 4; f++)
      for (int c = 0; c < (f < 2 ? 2 : 1); c++)
        mps_assert_near(value_of(a, names[f], *mps_view_i64(&id, k, 0), c),
                        value_of(b, names[f], *mps_view_i64(&id, k, 0), c), tolerance);
}

/* ---- material -------------------------------------------------------------------------------- */

static void a_material_is_what_its_fields_would_be(void **state) {
  (void)state;
  mps_material *clay = NULL, *rock = NULL;
  mps_moduli m[2];
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 4e7, 0.3, &clay));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 9e7, 0.2, &rock));
  mps_assert_ok(context, mps_material_get_moduli(clay, 1500.0, &m[0]));
  mps_assert_ok(context, mps_material_get_moduli(rock, 1500.0, &m[1]));
  mps_particles *by_law = block(context, 6, 6), *by_field = block(context, 6, 6);
  const int64_t ids[3] = {30, 4, 17};
  mps_assert_ok(context, mps_particles_set(by_field, "shear_velocity", 0, m[0].shear_velocity));
  mps_assert_ok(context,
                mps_particles_set(by_field, "pressure_velocity", 0, m[0].pressure_velocity));
  for (int k = 0; k < 3; k++) {
    mps_assert_ok(context,
                  write_one(by_field, "pressure_velocity", ids[k], m[1].pressure_velocity));
    mps_assert_ok(context, write_one(by_field, "shear_velocity", ids[k], m[1].shear_velocity));
  }
  push(by_law, 1e-3);
  push(by_field, 1e-3);
  mps_dynamics *a = solver_of(by_law, clay, NULL), *b = solver_of(by_field, NULL, NULL);
  mps_material_destroy(&clay); /* the solver has its share */
  mps_assert_ok(context, mps_dynamics_set_material(a, rock, 3, ids));
  mps_dynamics_def def;
  mps_assert_ok(context, mps_dynamics_get_def(a, &def));
  assert_string_equal(mps_material_name(def.material), "linear_elastic");
  mps_assert_ok(context, mps_dynamics_step(a, 40));
  mps_assert_ok(context, mps_dynamics_step(b, 40));
  assert_same_motion(by_law, by_field, 1e-15); /* Vs by one square root more: round-off */
  assert_true(fabs(value_of(by_law, "displacement", 17, 0)) > 1e-6);
  mps_dynamics_destroy(&a);
  mps_dynamics_destroy(&b);
  mps_material_destroy(&rock);
  mps_particles_destroy(&by_law);
  mps_particles_destroy(&by_field);
}

static void materials_that_do_not_fit_are_refused(void **state) {
  (void)state;
  mps_material_drucker_prager_def sand_def = mps_material_drucker_prager_defaults();
  mps_material *sand = NULL, *thin = NULL, *light = NULL;
  sand_def.young = 1e7, sand_def.friction = 0.5;
  mps_assert_ok(context, mps_material_create_drucker_prager(context, &sand_def, &sand));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, -0.1, &thin));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e-6, 0.3, &light));
  mps_particles *set = block(context, 4, 4);
  mps_dynamics_def def = mps_dynamics_defaults();
  mps_dynamics *d = NULL;
  const int32_t fields = mps_particles_field_count(set);
  def.dt = DT;
  def.material = sand;
  mps_assert_fails(context, mps_dynamics_create(context, set, &def, &d), MPS_ERROR_UNSUPPORTED,
                   "the law is drucker_prager");
  def.material = thin;
  mps_assert_fails(context, mps_dynamics_create(context, set, &def, &d), MPS_ERROR_ARGUMENT,
                   "Poisson's ratio of the material is -0.1, must be at least 0");
  assert_int_equal(mps_particles_field_count(set), fields);
  mps_assert_near(value_of(set, "shear_velocity", 0, 0), 100.0, 0.0);
  d = solver_of(set, NULL, NULL);
  const int64_t ids[2] = {3, 99};
  mps_assert_fails(context, mps_dynamics_set_material(d, NULL, 0, NULL), MPS_ERROR_ARGUMENT,
                   "material is NULL");
  mps_assert_fails(context, mps_dynamics_set_material(d, light, 2, ids), MPS_ERROR_ARGUMENT,
                   "ids[1] is 99");
  mps_assert_fails(context, mps_dynamics_set_material(d, light, 3, NULL), MPS_ERROR_ARGUMENT,
                   "count is 3");
  mps_assert_fails(context, mps_dynamics_set_material(d, sand, 0, NULL), MPS_ERROR_UNSUPPORTED,
                   "drucker_prager");
  mps_material_destroy(&light);
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e-6, 0.49, &light));
  mps_assert_ok(context, mps_particles_set(set, "density", 0, 1e9));
  mps_assert_fails(context, mps_dynamics_set_material(d, light, 0, NULL), MPS_ERROR_ARGUMENT,
                   "wave velocities of");
  mps_assert_near(value_of(set, "shear_velocity", 3, 0), 100.0, 0.0);
  assert_int_equal(mps_dynamics_set_material(NULL, light, 0, NULL), MPS_ERROR_ARGUMENT);
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
  mps_material_destroy(&sand);
  mps_material_destroy(&thin);
  mps_material_destroy(&light);
}

/* Particles that the call does not concern may have values that the solver refuses: then the call
 * has written none. */
static void a_refused_material_writes_no_velocities(void **state) {
  (void)state;
  mps_material *stiff = NULL;
  mps_particles *set = block(context, 4, 4);
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 8e7, 0.25, &stiff));
  mps_dynamics *d = solver_of(set, NULL, NULL);
  const double shear = value_of(set, "shear_velocity", 3, 0);
  const double pressure = value_of(set, "pressure_velocity", 3, 0);
  const int64_t ids[1] = {3};
  mps_assert_ok(context, write_one(set, "pressure_velocity", 7, 1.1 * shear));
  mps_assert_fails(context, mps_dynamics_set_material(d, stiff, 1, ids), MPS_ERROR_ARGUMENT,
                   "pressure_velocity of particle 7");
  mps_assert_near(value_of(set, "shear_velocity", 3, 0), shear, 0.0);
  mps_assert_near(value_of(set, "pressure_velocity", 3, 0), pressure, 0.0);
  mps_assert_ok(context, write_one(set, "pressure_velocity", 7, pressure));
  mps_assert_ok(context, mps_dynamics_set_material(d, stiff, 1, ids));
  assert_true(value_of(set, "shear_velocity", 3, 0) != shear);
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
  mps_material_destroy(&stiff);
}

/* Totals of a state that the caller has written are those of the beginning of its motion. */
static void totals_are_of_the_written_rotations(void **state) {
  (void)state;
  for (int rotation = 0; rotation < 2; rotation++) {
    mps_particles *set = block(context, 5, 5);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    mps_totals written, begun;
    def.dt = DT;
    def.rotation = rotation;
    mps_assert_ok(context, mps_dynamics_create(context, set, &def, &d));
    mps_assert_ok(context, mps_particles_set(set, "rotation", 0, 0.3));
    mps_assert_ok(context, mps_dynamics_get_totals(d, &written));
    mps_assert_ok(context, mps_dynamics_restart(d, 0.0));
    mps_assert_ok(context, mps_dynamics_get_totals(d, &begun));
    assert_true(begun.strain > 0.0);
    mps_assert_near(written.strain, begun.strain, 1e-12 * begun.strain);
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
  }
}

/* What leads from one material to another is no work of the scheme: the budget stays closed. */
static void a_material_changes_in_motion(void **state) {
  (void)state;
  mps_material *stiff = NULL;
  mps_particles *set = block(context, 6, 6);
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 8e7, 0.25, &stiff));
  push(set, 1e-4);
  mps_dynamics *d = solver_of(set, NULL, NULL);
  mps_assert_ok(context, mps_dynamics_step(d, 30));
  mps_totals before, after;
  mps_assert_ok(context, mps_dynamics_get_totals(d, &before));
  mps_assert_ok(context, mps_particles_set_material(set, stiff, 1500.0, 0, NULL));
  mps_assert_ok(context, mps_dynamics_step(d, 30));
  mps_assert_ok(context, mps_dynamics_get_totals(d, &after));
  mps_assert_near(after.scheme, before.scheme, 1e-6 * after.kinetic); /* rotations of 1e-5 */
  mps_assert_near(after.linear[0], before.linear[0], 1e-12);
  mps_dynamics_linear_limit limit;
  mps_assert_ok(context, mps_dynamics_find_limit(d, 0.0, &limit));
  mps_assert_near(limit.omega, sqrt(24.0 * 8e7 / 2.5 / 1500.0), 0.1 * limit.omega); /* spin mode */
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
  mps_material_destroy(&stiff);
}

/* ---- weight functions ------------------------------------------------------------------------ */

static void the_default_weight_is_that_of_a_handle(void **state) {
  (void)state;
  mps_kernel *w = NULL;
  mps_particles *a = block(context, 5, 7), *b = block(context, 5, 7);
  mps_assert_ok(context, mps_kernel_create(context, MPS_KERNEL_MPS, 1.5, &w));
  push(a, 1e-3);
  push(b, 1e-3);
  mps_dynamics *plain = solver_of(a, NULL, NULL), *with = solver_of(b, NULL, w);
  mps_kernel_destroy(&w); /* shared */
  mps_assert_ok(context, mps_dynamics_step(plain, 25));
  mps_assert_ok(context, mps_dynamics_step(with, 25));
  assert_same_motion(a, b, 0.0);
  mps_dynamics_def def;
  mps_assert_ok(context, mps_dynamics_get_def(with, &def));
  mps_assert_near(mps_kernel_radius(def.kernel), 1.5, 0.0);
  mps_assert_near(def.radius_ratio, 1.5, 0.0);
  mps_dynamics_destroy(&plain);
  mps_dynamics_destroy(&with);
  mps_particles_destroy(&a);
  mps_particles_destroy(&b);
}

static const struct {
  int32_t kind;
  double radius;
} weights[] = {{MPS_KERNEL_MPS, 2.5},     {MPS_KERNEL_SPLINE2, 1.5}, {MPS_KERNEL_SPLINE2, 2.1},
               {MPS_KERNEL_SPLINE3, 1.7}, {MPS_KERNEL_SPLINE3, 2.0}, {MPS_KERNEL_SPLINE3, 3.3}};
#define WEIGHTS (int)(sizeof weights / sizeof *weights)

/* In uniform strain the inside has its exact pressure -lambda tr(eps) and no force, whatever the
 * weight. */
static void uniform_strain_is_exact_inside_for_every_weight(void **state) {
  (void)state;
  for (int k = 0; k < WEIGHTS; k++) {
    mps_kernel *w = NULL;
    mps_assert_ok(context, mps_kernel_create(context, weights[k].kind, weights[k].radius, &w));
    mps_particles *set = block(context, 15, 15);
    mps_dynamics *d = solver_of(set, NULL, w);
    mps_view x;
    mps_edit u;
    mps_assert_ok(context, mps_particles_view(set, "reference", &x));
    mps_assert_ok(context, mps_particles_edit(set, "displacement", &u));
    for (int64_t i = 0; i < u.view.shape[0]; i++) {
      *mps_edit_f64(&u, i, 0) = 1e-6 * *mps_view_f64(&x, i, 0);
      *mps_edit_f64(&u, i, 1) = 3e-6 * *mps_view_f64(&x, i, 1);
    }
    mps_assert_ok(context, mps_particles_commit(set, &u));
    mps_assert_ok(context, mps_dynamics_refresh(d));
    const int64_t middle = 7 * 15 + 7;
    const double lambda = 1500.0 * (200.0 * 200.0 - 2.0 * 100.0 * 100.0);
    mps_assert_near(value_of(set, "pressure", middle, 0), -lambda * 4e-6, 1e-4 * lambda * 4e-6);
    for (int c = 0; c < 2; c++)
      mps_assert_near(value_of(set, "acceleration", middle, c), 0.0, 1e-6);
    assert_true(fabs(value_of(set, "acceleration", 7 * 15, 0)) > 1e-3); /* the edge has a force */
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
    mps_kernel_destroy(&w);
  }
}

/* mps_dynamics_limit is a bound from below, at most a quarter below where all ground is alike. */
static void the_quick_limit_holds_for_every_weight(void **state) {
  (void)state;
  static const double size[3][2] = {{12, 3}, {9, 8}, {20, 2}};
  for (int k = 0; k < WEIGHTS; k++)
    for (int s = 0; s < 6; s++) {
      mps_kernel *w = NULL;
      mps_assert_ok(context, mps_kernel_create(context, weights[k].kind, weights[k].radius, &w));
      mps_particles *set = block(context, size[s % 3][0], size[s % 3][1]);
      if (s >= 3) mps_assert_ok(context, mps_particles_set(set, "pressure_velocity", 0, 900.0));
      mps_dynamics *d = solver_of(set, NULL, w);
      const double quick = mps_dynamics_limit(d);
      mps_dynamics_linear_limit limit;
      mps_assert_ok(context, mps_dynamics_find_limit(d, 0.0, &limit));
      if (!(quick <= limit.dt && quick >= 0.6 * limit.dt))
        fail_msg("weight %d, shape %d: quick limit %g s, limit %g s", k, s, quick, limit.dt);
      mps_dynamics_destroy(&d);
      mps_particles_destroy(&set);
      mps_kernel_destroy(&w);
    }
}

static void weights_that_reach_too_far_are_refused(void **state) {
  (void)state;
  static const double radius[2] = {0.9, 4.1};
  mps_particles *set = block(context, 4, 4);
  for (int k = 0; k < 2; k++) {
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    mps_assert_ok(context, mps_kernel_create(context, MPS_KERNEL_MPS, radius[k], &def.kernel));
    mps_assert_fails(context, mps_dynamics_create(context, set, &def, &d), MPS_ERROR_ARGUMENT,
                     "radius of influence is");
    mps_kernel_destroy(&def.kernel);
  }
  mps_particles_destroy(&set);
}

/* ---- edits ----------------------------------------------------------------------------------- */

/* Ground edited before the first step is that of a solver made with it. */
static void edited_ground_is_taken_up(void **state) {
  (void)state;
  mps_particles *a = block(context, 5, 5), *b = block(context, 5, 5);
  push(a, 1e-3);
  push(b, 1e-3);
  mps_dynamics *edited = solver_of(a, NULL, NULL);
  const double limit = mps_dynamics_limit(edited);
  mps_assert_ok(context, write_one(a, "shear_velocity", 7, 150.0)); /* too much for Vp */
  mps_assert_fails(context, mps_dynamics_step(edited, 1), MPS_ERROR_ARGUMENT,
                   "pressure_velocity of particle 7 is 200 m/s");
  assert_int_equal(mps_context_error(context)->particle, 7);
  assert_int_equal(mps_dynamics_steps(edited), 0);
  mps_assert_ok(context, write_one(a, "pressure_velocity", 7, 300.0));
  mps_assert_ok(context, write_one(a, "density", 8, 900.0));
  mps_assert_ok(context, write_one(a, "damping", 9, 0.1));
  assert_true(mps_dynamics_limit(edited) < 0.9 * limit);
  mps_assert_ok(context, write_one(b, "shear_velocity", 7, 150.0));
  mps_assert_ok(context, write_one(b, "pressure_velocity", 7, 300.0));
  mps_assert_ok(context, write_one(b, "density", 8, 900.0));
  mps_assert_ok(context, write_one(b, "damping", 9, 0.1));
  mps_dynamics *made = solver_of(b, NULL, NULL);
  mps_assert_ok(context, mps_dynamics_step(edited, 20));
  mps_assert_ok(context, mps_dynamics_step(made, 20));
  assert_same_motion(a, b, 0.0);
  mps_dynamics_destroy(&edited);
  mps_dynamics_destroy(&made);
  mps_particles_destroy(&a);
  mps_particles_destroy(&b);
}

/* Stiffness-proportional damping is the rate of a force: a jump of the ground is no rate. */
static void a_jump_of_the_ground_is_not_damped(void **state) {
  (void)state;
  mps_particles *set = block(context, 4, 4);
  mps_assert_ok(context, mps_particles_set(set, "damping", 0, 0.05));
  mps_assert_ok(context, mps_particles_set(set, "displacement", 0, 0.0));
  mps_dynamics *d = solver_of(set, NULL, NULL);
  mps_assert_ok(context, write_one(set, "displacement", 5, 1e-5));
  mps_assert_ok(context, mps_dynamics_step(d, 1));
  mps_assert_ok(context, mps_particles_set(set, "density", 0, 750.0)); /* half the mass */
  const double former = value_of(set, "acceleration", 5, 0);
  mps_assert_ok(context, mps_dynamics_step(d, 1));
  const double now = value_of(set, "acceleration", 5, 0);
  /* G = rho Vs^2 is half too: the same acceleration but for mass-proportional damping and the 1e-4
   * of its period that has passed; with the jump counted it would be five times as much */
  mps_assert_near(now, former, 0.25 * fabs(former));
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
}

static void an_edited_motion_needs_a_restart(void **state) {
  (void)state;
  mps_particles *set = block(context, 4, 4), *twin = block(context, 4, 4);
  mps_dynamics *d = solver_of(set, NULL, NULL), *fresh = NULL;
  mps_snapshot *kept = NULL;
  mps_assert_ok(context, mps_dynamics_step(d, 3));
  mps_assert_ok(context, mps_dynamics_snapshot(d, &kept));
  mps_assert_ok(context, write_one(set, "velocity", 5, 0.25));
  mps_assert_fails(context, mps_dynamics_step(d, 1), MPS_ERROR_STATE,
                   "field 'velocity' has been written: mps_dynamics_restart begins");
  mps_assert_fails(context, mps_dynamics_snapshot(d, &kept), MPS_ERROR_STATE, "'velocity'");
  mps_assert_ok(context, mps_dynamics_rollback(d, kept));
  mps_assert_near(value_of(set, "velocity", 5, 0), 0.0, 0.0);
  mps_assert_ok(context, mps_dynamics_step(d, 1));
  mps_assert_ok(context, write_one(set, "velocity", 5, 0.25));
  mps_assert_ok(context, mps_dynamics_restart(d, 0.0));
  mps_assert_ok(context, mps_particles_set(twin, "velocity", 0, 0.0));
  mps_assert_ok(context, write_one(twin, "velocity", 5, 0.25));
  fresh = solver_of(twin, NULL, NULL);
  mps_assert_ok(context, mps_dynamics_step(d, 10));
  mps_assert_ok(context, mps_dynamics_step(fresh, 10));
  assert_same_motion(set, twin, 0.0);
  mps_dynamics_destroy(&d);
  mps_dynamics_destroy(&fresh);
  mps_snapshot_destroy(&kept);
  mps_particles_destroy(&set);
  mps_particles_destroy(&twin);
}

static void what_the_solver_relies_on_stays(void **state) {
  (void)state;
  mps_particles *set = block(context, 4, 4);
  mps_dynamics *d = solver_of(set, NULL, NULL);
  mps_snapshot *kept = NULL;
  mps_edit v;
  mps_assert_ok(context, mps_dynamics_snapshot(d, &kept));
  const double x = value_of(set, "position", 5, 0);
  mps_assert_ok(context, mps_particles_edit(set, "position", &v));
  *mps_edit_f64(&v, mps_particles_index(set, 5), 0) = x + 0.1;
  mps_assert_fails(context, mps_particles_commit(set, &v), MPS_ERROR_STATE,
                   "write the former ones back");
  *mps_edit_f64(&v, mps_particles_index(set, 5), 0) = x;
  mps_assert_ok(context, mps_particles_commit(set, &v));
  mps_assert_ok(context, mps_dynamics_step(d, 1));
  mps_assert_ok(context, write_one(set, "reference", 5, 0.0));
  mps_assert_fails(context, mps_dynamics_step(d, 1), MPS_ERROR_STATE,
                   "field 'reference' has been written, which the solver relies on");
  mps_assert_fails(context, mps_dynamics_run(d, 1.0, 1, NULL, NULL), MPS_ERROR_STATE, "reference");
  mps_assert_ok(context, mps_dynamics_rollback(d, kept));
  mps_assert_ok(context, mps_dynamics_step(d, 1));
  mps_dynamics_destroy(&d);
  mps_snapshot_destroy(&kept);
  mps_particles_destroy(&set);
}

/* ---- creation that fails late ---------------------------------------------------------------- */

/* All of a set: what a failed creation must leave as it was. */
typedef struct picture {
  int64_t count;
  int32_t fields;
  uint64_t epoch, hash;
} picture;

static picture picture_of(mps_context *own, mps_particles *set) {
  picture p = {.count = mps_particles_count(set),
               .fields = mps_particles_field_count(set),
               .epoch = mps_particles_epoch(set),
               .hash = 0xcbf29ce484222325u};
  for (int32_t f = 0; f < p.fields; f++) {
    mps_particles_field_info info;
    mps_view v;
    mps_assert_ok(own, mps_particles_get_field_info(set, f, &info));
    mps_assert_ok(own, mps_particles_view(set, info.name, &v));
    for (int64_t c = 0; c < v.shape[1]; c++)
      for (int64_t k = 0; k < v.shape[0]; k++) {
        uint64_t bits;
        memcpy(&bits, (const char *)v.data + 8 * (c * v.stride[1] + k), sizeof bits);
        p.hash = (p.hash ^ bits) * 0x100000001b3u;
      }
  }
  return p;
}

static void assert_same_picture(picture a, picture b) {
  assert_int_equal(a.count, b.count);
  assert_int_equal(a.fields, b.fields);
  assert_true(a.epoch == b.epoch && a.hash == b.hash);
}

/* Particles that need sorting, a free-field column, damping and a material. */
static mps_particles *hard_set(mps_context *own) {
  mps_particles *set = block(own, 3, 6);
  const double x[2] = {3.5, 0.5};
  mps_assert_ok(own, mps_particles_append(set, 1, x));
  mps_assert_ok(own, mps_particles_set(set, "density", 0, 1500.0));
  mps_assert_ok(own, mps_particles_set(set, "damping", 0, 0.05));
  mps_assert_ok(own, mps_particles_set(set, "shear_velocity", 0, 100.0));
  mps_assert_ok(own, mps_particles_set(set, "pressure_velocity", 0, 200.0));
  mps_assert_ok(own, mps_dynamics_add_free_field(set, MPS_DYNAMICS_SIDE_LEFT, 3));
  return set;
}

static void a_failed_creation_changes_nothing(void **state) {
  (void)state;
  for (int late = 0; late < 2; late++) {
    mps_particles *set = hard_set(context);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    mps_edit x;
    mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e7, 0.3, &def.material));
    mps_assert_ok(context, mps_particles_edit(set, "position", &x));
    const int64_t last = mps_particles_count(set) - 1; /* of the column */
    if (late)
      *mps_edit_f64(&x, last, 1) += 0.5;
    else
      for (int c = 0; c < 2; c++) *mps_edit_f64(&x, 0, c) = *mps_view_f64(&x.view, 1, c);
    mps_assert_ok(context, mps_particles_commit(set, &x));
    const picture before = picture_of(context, set);
    mps_assert_fails(context, mps_dynamics_create(context, set, &def, &d), MPS_ERROR_ARGUMENT,
                     late ? "not a straight stack" : "two particles lie at the same point");
    assert_null(d);
    assert_same_picture(picture_of(context, set), before);
    const double more[2] = {9.5, 9.5};
    mps_assert_ok(context, mps_particles_append(set, 1, more)); /* no solver holds it */
    mps_material_destroy(&def.material);
    mps_particles_destroy(&set);
  }
}

static void creation_without_memory_changes_nothing(void **state) {
  (void)state;
  bool made = false;
  int64_t refused = 0;
  for (int64_t at = 1; !made; at++) {
    test_allocator allocator = {0};
    mps_context *own = test_allocator_context(&allocator);
    mps_particles *set = hard_set(own);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    def.dt = DT;
    def.watch_damping = 1;
    mps_assert_ok(own, mps_material_create_linear_elastic(own, 1e7, 0.3, &def.material));
    const picture before = picture_of(own, set);
    allocator.refuse_at = allocator.calls + at;
    made = mps_dynamics_create(own, set, &def, &d) == MPS_OK;
    if (!made) {
      assert_int_equal(mps_context_error(own)->status, MPS_ERROR_MEMORY);
      assert_same_picture(picture_of(own, set), before);
      refused++;
    }
    mps_dynamics_destroy(&d);
    mps_material_destroy(&def.material);
    mps_particles_destroy(&set);
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
  }
  assert_true(refused > 20);
}

/* ---- particles that go ----------------------------------------------------------------------- */

/* Gravity, a traction on the top row, the base held, one side on dashpots. */
static void load_block(mps_dynamics *d, bool top) {
  mps_particles *set = mps_dynamics_particles(d);
  int32_t number;
  int64_t count;
  mps_dynamics_load_def weight = mps_dynamics_load_defaults(), push_down = weight;
  weight.kind = MPS_DYNAMICS_LOAD_BODY;
  weight.acceleration[1] = -0.0981; /* small rotations: the budget closes */
  push_down.traction[1] = -2e2;
  for (int c = 0; c < 2; c++) push_down.lower[c] = -1e9, push_down.upper[c] = 1e9;
  push_down.lower[1] = 7.0;
  mps_assert_ok(context, mps_dynamics_add_load(d, &weight, &number));
  if (top) mps_assert_ok(context, mps_dynamics_add_load(d, &push_down, &number));
  soil_hold(context, set, d, MPS_DOF_X | MPS_DOF_Y, -1.0, -1.0, 99.0, 0.99);
  int64_t *ids = soil_select(context, set, -1.0, -1.0, 0.99, 99.0, &count);
  mps_assert_ok(context, soil_add_viscous(d, NULL, count, ids));
  free(ids);
}

/* Copies displacements, velocities and so on by position. */
static void copy_motion(mps_particles *from, mps_particles *to) {
  static const char *const names[] = {"displacement", "velocity", "rotation", "spin"};
  for (int f = 0; f < 4; f++) {
    mps_view a, ref, at;
    mps_edit b;
    mps_assert_ok(context, mps_particles_add_field(to, names[f], 0));
    mps_assert_ok(context, mps_particles_view(from, names[f], &a));
    mps_assert_ok(context, mps_particles_view(from, "reference", &ref));
    mps_assert_ok(context, mps_particles_view(to, "reference", &at));
    mps_assert_ok(context, mps_particles_edit(to, names[f], &b));
    for (int64_t j = 0; j < b.view.shape[0]; j++)
      for (int64_t i = 0; i < a.shape[0]; i++)
        if (*mps_view_f64(&ref, i, 0) == *mps_view_f64(&at, j, 0) &&
            *mps_view_f64(&ref, i, 1) == *mps_view_f64(&at, j, 1))
          for (int64_t c = 0; c < b.view.shape[1]; c++)
            *mps_edit_f64(&b, j, c) = *mps_view_f64(&a, i, c);
    mps_assert_ok(context, mps_particles_commit(to, &b));
  }
}

/* The top row of a loaded block is dug away while it moves: from then on it moves as a new solver
 * on the particles that are left, started from the same displacements and velocities. */
static void an_excavation_is_a_new_solver_on_what_is_left(void **state) {
  (void)state;
  mps_particles *set = block(context, 9, 8), *rest = block(context, 9, 7);
  mps_dynamics *d = solver_of(set, NULL, NULL);
  load_block(d, true);
  mps_assert_ok(context, mps_dynamics_step(d, 50));
  int64_t count, body = mps_particles_count(set);
  int64_t *ids = soil_select(context, set, -1.0, 6.9, 99.0, 99.0, &count);
  assert_int_equal(count, 9);
  mps_totals before, after;
  mps_assert_ok(context, mps_dynamics_get_totals(d, &before));
  mps_assert_ok(context, mps_particles_remove(set, count, ids));
  assert_int_equal(mps_particles_count(set), body - 9);
  mps_dynamics *fresh = solver_of(rest, NULL, NULL);
  load_block(fresh, false); /* the traction was removed with its row */
  copy_motion(set, rest);
  mps_assert_ok(context, mps_dynamics_restart(fresh, mps_dynamics_time(d)));
  assert_int_equal(mps_dynamics_pairs(d), mps_dynamics_pairs(fresh));
  for (int part = 0; part < 2; part++) { /* refresh has a snapshot of its own */
    mps_assert_ok(context, mps_dynamics_step(d, 40));
    mps_assert_ok(context, mps_dynamics_step(fresh, 40));
    mps_assert_ok(context, mps_dynamics_refresh(d));
  }
  mps_view id, at;
  mps_assert_ok(context, mps_particles_view(set, "id", &id));
  mps_assert_ok(context, mps_particles_view(set, "position", &at));
  double most = 0.0;
  for (int64_t k = 0; k < at.shape[0]; k++) {
    const int64_t row = (int64_t)(value_of(set, "reference", *mps_view_i64(&id, k, 0), 1));
    const int64_t column = (int64_t)(value_of(set, "reference", *mps_view_i64(&id, k, 0), 0));
    for (int c = 0; c < 2; c++) {
      const double u = value_of(set, "displacement", *mps_view_i64(&id, k, 0), c);
      mps_assert_near(u, value_of(rest, "displacement", row * 9 + column, c), 1e-14);
      most = fmax(most, fabs(u));
    }
  }
  assert_true(most > 1e-5);
  mps_reaction r[2];
  for (int32_t b = 0; b < 2; b++) {
    mps_assert_ok(context, mps_dynamics_get_reaction(d, b, &r[0]));
    mps_assert_ok(context, mps_dynamics_get_reaction(fresh, b, &r[1]));
    mps_assert_near(r[0].force[1], r[1].force[1], 1e-8 * fabs(r[1].force[1]));
    assert_int_equal(r[0].count, b == 0 ? 9 : 7);
  }
  mps_assert_ok(context, mps_dynamics_get_totals(d, &after));
  mps_assert_near(after.mass, 63.0 * 1500.0, 1e-6);
  mps_assert_near(after.scheme, before.scheme, 1e-5 * after.kinetic); /* rotations of 1e-5 */
  free(ids);
  mps_dynamics_destroy(&d);
  mps_dynamics_destroy(&fresh);
  mps_particles_destroy(&set);
  mps_particles_destroy(&rest);
}

/* All that a run shows: fields, totals, reactions. */
typedef struct outcome {
  picture fields;
  mps_totals totals;
  mps_reaction held, viscous;
} outcome;

static outcome outcome_of(mps_dynamics *d, int64_t steps) {
  outcome o;
  memset(&o, 0, sizeof o);
  mps_assert_ok(context, mps_dynamics_step(d, steps));
  o.fields = picture_of(context, mps_dynamics_particles(d));
  mps_assert_ok(context, mps_dynamics_get_totals(d, &o.totals));
  mps_assert_ok(context, mps_dynamics_get_reaction(d, 0, &o.held));
  mps_assert_ok(context, mps_dynamics_get_reaction(d, 1, &o.viscous));
  return o;
}

static void assert_same_outcome(outcome a, outcome b) {
  a.fields.epoch = b.fields.epoch; /* going back makes views stale */
  assert_same_picture(a.fields, b.fields);
  assert_memory_equal(&a.totals, &b.totals, sizeof a.totals);
  assert_memory_equal(&a.held, &b.held, sizeof a.held);
  assert_memory_equal(&a.viscous, &b.viscous, sizeof a.viscous);
}

/* Back and forth across two removals, of particles that are held, loaded and beside dashpots: every
 * way on is the first one, bit for bit. */
static void a_rollback_brings_back_what_was_dug_away(void **state) {
  (void)state;
  mps_particles *set = block(context, 9, 8);
  mps_dynamics *d = solver_of(set, NULL, NULL);
  mps_snapshot *whole = NULL, *dug = NULL, *deep = NULL;
  int64_t count, corner;
  load_block(d, true);
  int64_t *ids = soil_select(context, set, -1.0, 6.9, 99.0, 99.0, &count);
  int64_t *low = soil_select(context, set, -1.0, -1.0, 1.9, 2.1, &corner);
  mps_assert_ok(context, mps_dynamics_step(d, 50));
  mps_assert_ok(context, mps_dynamics_snapshot(d, &whole));
  const outcome first = outcome_of(d, 30);
  mps_assert_ok(context, mps_dynamics_rollback(d, whole));
  mps_assert_ok(context, mps_particles_remove(set, count, ids));
  const double dt = mps_dynamics_dt(d);
  mps_assert_ok(context, mps_dynamics_snapshot(d, &dug));
  const outcome second = outcome_of(d, 30);
  mps_assert_ok(context, mps_particles_remove(set, corner, low));
  mps_assert_ok(context, mps_dynamics_snapshot(d, &deep));
  const outcome third = outcome_of(d, 30);
  for (int pass = 0; pass < 2; pass++) {
    mps_assert_ok(context, mps_dynamics_rollback(d, whole));
    assert_int_equal(mps_particles_count(set), 72);
    assert_same_outcome(outcome_of(d, 30), first);
    mps_assert_ok(context, mps_dynamics_rollback(d, deep));
    assert_same_outcome(outcome_of(d, 30), third);
    mps_assert_ok(context, mps_dynamics_rollback(d, dug));
    assert_true(mps_dynamics_dt(d) == dt);
    assert_same_outcome(outcome_of(d, 30), second);
    mps_assert_ok(context, mps_dynamics_refresh(d));
  }
  mps_dynamics_boundary_def other = mps_dynamics_boundary_defaults();
  other.dofs = MPS_DOF_X | MPS_DOF_Y;
  other.ids = low, other.id_count = 1;
  mps_assert_ok(context, mps_dynamics_set_boundary(d, 0, &other));
  mps_assert_fails(context, mps_dynamics_rollback(d, whole), MPS_ERROR_STATE,
                   "boundary0/particles is 9, in this solver 1 of those");
  assert_int_equal(mps_particles_count(set), 72 - count);
  free(ids);
  free(low);
  mps_snapshot_destroy(&whole);
  mps_snapshot_destroy(&dug);
  mps_snapshot_destroy(&deep);
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
}

static void removals_that_cannot_be_are_refused(void **state) {
  (void)state;
  mps_particles *set = hard_set(context);
  mps_dynamics *d = solver_of(set, NULL, NULL);
  const int64_t n = mps_particles_count(set), of_column[1] = {n - 1};
  const double x[2] = {9.5, 9.5};
  int64_t all[64];
  for (int64_t k = 0; k < 19; k++) all[k] = k;
  mps_assert_ok(context, mps_dynamics_step(d, 5));
  const picture before = picture_of(context, set);
  mps_assert_fails(context, mps_particles_remove(set, 1, of_column), MPS_ERROR_ARGUMENT,
                   "belongs to a free-field column");
  mps_assert_fails(context, mps_particles_remove(set, 19, all), MPS_ERROR_ARGUMENT,
                   "all 19 particles of the body are to be removed");
  mps_assert_fails(context, mps_particles_append(set, 1, x), MPS_ERROR_STATE,
                   "takes no more particles");
  assert_same_picture(picture_of(context, set), before);
  mps_assert_ok(context, mps_particles_remove(set, 1, all)); /* beside the column */
  mps_assert_ok(context, mps_dynamics_step(d, 5));
  mps_dynamics_destroy(&d);
  mps_particles_destroy(&set);
}

static void a_removal_without_memory_changes_nothing(void **state) {
  (void)state;
  bool gone = false;
  int64_t refused = 0;
  for (int64_t at = 1; !gone; at++) {
    test_allocator allocator = {0};
    mps_context *own = test_allocator_context(&allocator);
    mps_particles *set = hard_set(own);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    def.dt = DT;
    mps_assert_ok(own, mps_dynamics_create(own, set, &def, &d));
    mps_assert_ok(own, soil_add_held(d, MPS_DOF_X | MPS_DOF_Y, 2, (const int64_t[2]){0, 1}));
    mps_assert_ok(own, mps_dynamics_step(d, 2));
    const picture before = picture_of(own, set);
    allocator.refuse_at = allocator.calls + at;
    gone = mps_particles_remove(set, 2, (const int64_t[2]){1, 8}) == MPS_OK;
    if (!gone) assert_same_picture(picture_of(own, set), before);
    refused += !gone;
    allocator.refuse_at = 0;
    mps_assert_ok(own, mps_dynamics_step(d, 2));
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
  }
  assert_true(refused > 10);
}

static void a_way_back_without_memory_changes_nothing(void **state) {
  (void)state;
  bool back = false;
  int64_t refused = 0;
  for (int64_t at = 1; !back; at++) {
    test_allocator allocator = {0};
    mps_context *own = test_allocator_context(&allocator);
    mps_particles *set = hard_set(own);
    mps_dynamics_def def = mps_dynamics_defaults();
    mps_dynamics *d = NULL;
    mps_snapshot *then = NULL;
    def.dt = DT;
    mps_assert_ok(own, mps_dynamics_create(own, set, &def, &d));
    mps_assert_ok(own, soil_add_held(d, MPS_DOF_X | MPS_DOF_Y, 2, (const int64_t[2]){0, 1}));
    mps_assert_ok(own, mps_dynamics_step(d, 2));
    mps_assert_ok(own, mps_dynamics_snapshot(d, &then));
    mps_assert_ok(own, mps_particles_remove(set, 2, (const int64_t[2]){1, 8}));
    mps_assert_ok(own, mps_dynamics_step(d, 2));
    const picture before = picture_of(own, set);
    allocator.refuse_at = allocator.calls + at;
    back = mps_dynamics_rollback(d, then) == MPS_OK;
    if (!back) assert_same_picture(picture_of(own, set), before);
    refused += !back;
    allocator.refuse_at = 0;
    mps_assert_ok(own, mps_dynamics_step(d, 2));
    mps_snapshot_destroy(&then);
    mps_dynamics_destroy(&d);
    mps_particles_destroy(&set);
    mps_context_destroy(&own);
    assert_int_equal(allocator.live, 0);
  }
  assert_true(refused > 10);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_material_is_what_its_fields_would_be),
      cmocka_unit_test(materials_that_do_not_fit_are_refused),
      cmocka_unit_test(a_refused_material_writes_no_velocities),
      cmocka_unit_test(totals_are_of_the_written_rotations),
      cmocka_unit_test(a_material_changes_in_motion),
      cmocka_unit_test(the_default_weight_is_that_of_a_handle),
      cmocka_unit_test(uniform_strain_is_exact_inside_for_every_weight),
      cmocka_unit_test(the_quick_limit_holds_for_every_weight),
      cmocka_unit_test(weights_that_reach_too_far_are_refused),
      cmocka_unit_test(edited_ground_is_taken_up),
      cmocka_unit_test(a_jump_of_the_ground_is_not_damped),
      cmocka_unit_test(an_edited_motion_needs_a_restart),
      cmocka_unit_test(what_the_solver_relies_on_stays),
      cmocka_unit_test(a_failed_creation_changes_nothing),
      cmocka_unit_test(creation_without_memory_changes_nothing),
      cmocka_unit_test(an_excavation_is_a_new_solver_on_what_is_left),
      cmocka_unit_test(a_rollback_brings_back_what_was_dug_away),
      cmocka_unit_test(a_way_back_without_memory_changes_nothing),
      cmocka_unit_test(removals_that_cannot_be_are_refused),
      cmocka_unit_test(a_removal_without_memory_changes_nothing),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
