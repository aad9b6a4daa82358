/* test_mpm.c - the WLS-MPM solver: arguments, errors, memory, ownership.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "mpm_scene.h"
#include "test_allocator.h"
#include "test_fixture.h"

#include <mps/experimental.h>

static mps_mpm_def small_def(void) {
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02;
  def.lower[0] = def.lower[1] = 0.0;
  return def;
}

static mpm_scene small_scene(mps_context *c) {
  mpm_scene s = mpm_scene_begin(c, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  mps_assert_ok(c, mps_particles_set(s.particles, "density", 0, 1000.0));
  return s;
}

static void refuses(mpm_scene *s, const mps_mpm_def *def, const char *text) {
  mps_mpm *mpm = (mps_mpm *)1;
  mps_assert_fails(context, mps_mpm_create(context, s->particles, s->material, def, &mpm),
                   MPS_ERROR_ARGUMENT, text);
  assert_null(mpm);
}

static void refuses_bad_definitions(void **state) {
  (void)state;
  mpm_scene s = small_scene(context);
  mps_mpm *mpm = NULL;
#define CASE(member, value, text)                                                                  \
  do {                                                                                             \
    mps_mpm_def def = small_def();                                                                 \
    def.member = value;                                                                            \
    refuses(&s, &def, text);                                                                       \
  } while (0)
  CASE(cell, 0.0, "cell is 0 m");
  CASE(cell, NAN, "cell is nan m");
  CASE(spline, 4, "spline is 4");
  CASE(geometry, 3, "geometry is 3");
  CASE(geometry, MPS_MPM_GEOMETRY_SPACE, "geometry is 2, and the set has 2 dimensions");
  CASE(step_from, 9, "step_from is 9");
  CASE(measure, 0.0, "measure is 0, must be a thickness");
  CASE(cell, 1e9, "cell is 1e+09 m with particles 0.01 m apart");
  CASE(cell, 1e-4, "must be 0.5 to 100 of their spacings");
  CASE(dt, 0.0, "dt is 0 s");
  CASE(courant, 1.5, "courant is 1.5");
  CASE(volumetric, 4, "volumetric is 4");
  CASE(budget, 2, "budget is 2");
  CASE(dt, -1.0, "dt is -1 s");
  CASE(gravity[1], INFINITY, "gravity[1] inf");
  CASE(lower[0], 0.013, "must lie on a node");
  CASE(lower[1], NAN, "lower[1] is nan");
  CASE(upper[0], 0.0, "at least one cell");
  CASE(upper[0], 0.08, "outside the domain [0, 0.08] m");
#undef CASE
  mps_mpm_def def = small_def();
  assert_int_equal(mps_mpm_create(NULL, s.particles, s.material, &def, &mpm), MPS_ERROR_ARGUMENT);
  mps_assert_fails(context, mps_mpm_create(context, NULL, s.material, &def, &mpm),
                   MPS_ERROR_ARGUMENT, "particles is NULL");
  mps_assert_fails(context, mps_mpm_create(context, s.particles, NULL, &def, &mpm),
                   MPS_ERROR_ARGUMENT, "material is NULL");
  mps_assert_fails(context, mps_mpm_create(context, s.particles, s.material, &def, NULL),
                   MPS_ERROR_ARGUMENT, "out is NULL");
  def.geometry = MPS_MPM_GEOMETRY_AXISYMMETRIC;
  def.lower[0] = -0.02;
  refuses(&s, &def, "radius begins at 0");
  mps_edit x = mpm_scene_edit(&s, "position");
  *mps_edit_f64(&x, 3, 1) = 1e12;
  mpm_scene_commit(&s, &x);
  def = mps_mpm_defaults();
  def.cell = 0.02;
  refuses(&s, &def, "more than 2^30 cells");
  x = mpm_scene_edit(&s, "position");
  *mps_edit_f64(&x, 3, 1) = 0.005;
  mpm_scene_commit(&s, &x);
  mps_assert_ok(context, mps_particles_set(s.particles, "density", 0, 0.0));
  def = small_def();
  refuses(&s, &def, "density 0 kg/m3");
  mpm_scene_end(&s);
}

static void refuses_bad_sets(void **state) {
  (void)state;
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mps_mpm_def def = small_def();
  mps_mpm *mpm = NULL;
  refuses(&s, &def, "the set has 0 particles");
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  mps_assert_fails(context, mps_mpm_create(context, s.particles, s.material, &def, &mpm),
                   MPS_ERROR_FIELD, "no field 'density'");
  mps_assert_ok(context, mps_particles_set(s.particles, "density", 0, 1000.0));
  mps_assert_ok(context, mps_particles_set(s.particles, "stress", 2, 1.0));
  mpsi_particles_column(s.particles, "stress", 3)[5] = NAN;
  refuses(&s, &def, "'stress' of particle 5 is nan");
  mpm_scene_end(&s);
}

static void owns_its_bodies(void **state) {
  (void)state;
  mpm_scene s = small_scene(context), other = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  mpm_scene_solve(&other, &def);
  mps_body *body = NULL;
  mps_body_def disc = mps_body_defaults();
  disc.position[0] = 0.3;
  mps_assert_ok(context, mps_body_create_disc(context, &disc, 0.02, &body));
  mps_assert_fails(context, mpm_scene_try_contact(s.mpm, NULL, 0.0), MPS_ERROR_ARGUMENT,
                   "body is NULL");
  mpm_scene_contact(&s, body, 0.0);
  mps_assert_fails(context, mpm_scene_try_contact(s.mpm, body, 0.0), MPS_ERROR_STATE,
                   "in contact with the body already");
  mps_assert_fails(context, mpm_scene_try_contact(other.mpm, body, 0.0), MPS_ERROR_STATE,
                   "another solver moves the body");
  mps_assert_fails(context, mps_body_advance(body, 0.1), MPS_ERROR_STATE, "a solver moves");
  mps_mpm_destroy(&s.mpm);
  mpm_scene_contact(&other, body, 0.0); /* free again */
  mps_body_destroy(&body);
  mps_assert_fails(context, mps_mpm_step(other.mpm, -1), MPS_ERROR_ARGUMENT, "count is -1");
  mps_assert_fails(context, mps_mpm_run(other.mpm, NAN, 1, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "t_end is nan");
  mps_assert_fails(context, mps_mpm_run(other.mpm, 1.0, 0, NULL, NULL), MPS_ERROR_ARGUMENT,
                   "every 0");
  mps_assert_fails(context, mps_mpm_get_totals(other.mpm, NULL), MPS_ERROR_ARGUMENT, "out is NULL");
  mpm_scene_end(&s);
  mpm_scene_end(&other);
  mps_mpm_destroy(NULL);
  assert_true(mps_mpm_dt(NULL) == 0.0 && mps_mpm_time(NULL) == 0.0 && mps_mpm_steps(NULL) == 0);
}

/* A run ends exactly at its end, calls back as requested, and dt is that of (49). */
static mps_status count_calls(void *user, mps_mpm *mpm) {
  (void)mpm;
  ++*(int *)user;
  return MPS_OK;
}

static void runs_to_the_end(void **state) {
  (void)state;
  mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  /* E = 1e5, nu = 0.3: K + 4G/3 = E (1 - nu)/((1 + nu)(1 - 2 nu)) */
  const double c = sqrt(1e5 * 0.7 / (1.3 * 0.4) / 1000.0);
  mps_assert_near(mps_mpm_limit(s.mpm), 0.02 / c, 1e-14);
  mps_assert_near(mps_mpm_dt(s.mpm), 0.01 / c, 1e-14);
  int calls = 0;
  const double t_end = 10.5 * mps_mpm_dt(s.mpm);
  mps_assert_ok(context, mps_mpm_run(s.mpm, t_end, 4, count_calls, &calls));
  mps_assert_near(mps_mpm_time(s.mpm), t_end, 0.0);
  assert_int_equal(mps_mpm_steps(s.mpm), 11);
  assert_int_equal(calls, 4); /* 0, 4, 8, 11 */
  mpm_scene_end(&s);
}

/* A law of the caller's that fails on request. */
static mps_status refusing(void *user, const mps_material_block *block) {
  const int32_t now = *(const int32_t *)user;
  if (now == 0) return MPS_OK;
  snprintf(block->message, (size_t)block->message_size, "at %g s", block->time);
  *block->refused = 0;
  return MPS_ERROR_NUMERIC;
}

static mps_material *refusing_material(mps_context *c, const int32_t *refuses_now) {
  static const char *const names[] = {"plastic_strain", "damage"};
  static const double initial[] = {0.5, 1.0};
  mps_material *out = NULL;
  mps_material_user_def law = mps_material_user_defaults();
  law.update = refusing, law.user = (void *)refuses_now;
  law.name = "touchy", law.wave_modulus = 1e5;
  law.history_count = 2, law.history = names, law.history_initial = initial;
  law.needs_deformation = 1;
  mps_assert_ok(c, mps_material_create_user(c, &law, &out));
  return out;
}

/* Another law for some: its fields are added, its history begins; an error names it. */
static void sets_materials(void **state) {
  (void)state;
  int32_t refuses_now = 0;
  mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  mps_material *law = refusing_material(context, &refuses_now);
  const int64_t ids[] = {7, 3}, bad[] = {7, 100};
  const int32_t fields = mps_particles_field_count(s.particles);
  mps_assert_fails(context, mps_mpm_set_material(s.mpm, NULL, 2, ids), MPS_ERROR_ARGUMENT,
                   "material is NULL");
  mps_assert_fails(context, mps_mpm_set_material(s.mpm, law, -1, ids), MPS_ERROR_ARGUMENT,
                   "count is -1");
  mps_assert_fails(context, mps_mpm_set_material(s.mpm, law, 1, NULL), MPS_ERROR_ARGUMENT,
                   "ids NULL");
  mps_assert_fails(context, mps_mpm_set_material(s.mpm, law, 2, bad), MPS_ERROR_ARGUMENT,
                   "ids[1] is 100: the set has no such particle");
  assert_int_equal(mps_particles_field_count(s.particles), fields);
  mps_assert_ok(context, mps_mpm_set_material(s.mpm, law, 2, ids));
  mps_view of = mpm_scene_view(&s, "material"), damage = mpm_scene_view(&s, "touchy.damage");
  mps_view F = mpm_scene_view(&s, "deformation_gradient"), J = mpm_scene_view(&s, "volume_ratio");
  for (int64_t id = 0; id < 100; id++) {
    const int64_t k = mps_particles_index(s.particles, id);
    const bool set = id == 7 || id == 3;
    assert_int_equal(*mps_view_i64(&of, k, 0), set);
    mps_assert_near(*mps_view_f64(&damage, k, 0), set ? 1.0 : 0.0, 0.0);
    mps_assert_near(*mps_view_f64(&F, k, 0), set ? 1.0 : 0.0, 0.0);
    mps_assert_near(*mps_view_f64(&F, k, 1), 0.0, 0.0);
    mps_assert_near(*mps_view_f64(&J, k, 0), set ? 1.0 : 0.0, 0.0);
  }
  mps_assert_ok(context, mps_mpm_step(s.mpm, 5));
  for (int k = 2; k < 300; k++) { /* two there are */
    mps_material *more = NULL;
    mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e5, 0.3, &more));
    mps_assert_ok(context, mps_mpm_set_material(s.mpm, more, 1, ids));
    mps_material_destroy(&more);
  }
  of = mpm_scene_view(&s, "material");
  assert_int_equal(*mps_view_i64(&of, mps_particles_index(s.particles, ids[0]), 0), 299);
  mps_assert_ok(context, mps_mpm_set_material(s.mpm, law, 1, ids));  /* known: no new one */
  mps_assert_ok(context, mps_mpm_set_material(s.mpm, law, 0, NULL)); /* all */
  of = mpm_scene_view(&s, "material");
  for (int64_t k = 0; k < 100; k++) assert_int_equal(*mps_view_i64(&of, k, 0), 1);
  refuses_now = 1;
  mps_assert_fails(context, mps_mpm_step(s.mpm, 1), MPS_ERROR_NUMERIC,
                   "the law 'touchy' has refused");
  refuses_now = 0; /* that step has not happened: the next one does */
  mps_assert_ok(context, mps_mpm_set_material(s.mpm, law, 1, ids));
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  mps_material_destroy(&law);
  mpm_scene_end(&s);
}

/* No law gives the stress of an inverted particle. */
static void inverted_deformations_are_refused(void **state) {
  (void)state;
  mps_material *law = NULL;
  for (int dim = 2; dim <= 3; dim++) {
    mps_particles_def def = mps_particles_defaults();
    const double lo[3] = {0.0, 0.0, 0.0}, hi[3] = {0.3, 0.3, 0.3};
    mps_mpm_def solver = mps_mpm_defaults();
    mps_particles *set = NULL;
    mps_mpm *mpm = NULL;
    def.dim = dim, def.spacing = 0.1;
    solver.cell = 0.2;
    if (dim == 3) solver.geometry = MPS_MPM_GEOMETRY_SPACE;
    mps_assert_ok(context, mps_material_create_neo_hookean(context, 1e6, 0.3, &law));
    mps_assert_ok(context, mps_particles_create(context, &def, &set));
    mps_assert_ok(context, mps_particles_fill_box(set, lo, hi, NULL));
    mps_assert_ok(context, mps_particles_set(set, "density", 0, 1000.0));
    mps_assert_ok(context, mps_mpm_create(context, set, law, &solver, &mpm));
    mps_assert_ok(context, mps_particles_set(set, "deformation_gradient", 0, -0.14));
    mps_assert_fails(context, mps_mpm_step(mpm, 1), MPS_ERROR_STATE,
                     "particle 0 has the determinant -0.14, must be above 0");
    assert_int_equal(mps_mpm_steps(mpm), 0);
    mps_assert_ok(context, mps_particles_set(set, "deformation_gradient", 0, 1.0));
    mps_assert_ok(context, mps_mpm_step(mpm, 1));
    mps_mpm_destroy(&mpm);
    mps_particles_destroy(&set);
    mps_material_destroy(&law);
  }
}

/* A lump that bursts out of the domain is reported with id and step, and the solver stops. */
static void tells_what_left(void **state) {
  (void)state;
  mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  def.upper[0] = 0.2;
  mps_assert_ok(context, mps_particles_set(s.particles, "stress", 0, -1e8)); /* of E = 1e5 Pa */
  mpm_scene_solve(&s, &def);
  mps_assert_fails(context, mps_mpm_step(s.mpm, 200), MPS_ERROR_DIVERGED, "check dt");
  assert_true(mps_context_error(context)->particle >= 0);
  assert_true(mps_context_error(context)->step > 0);
  mps_assert_fails(context, mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "");
  mpm_scene_end(&s);
}

/* Syrup: viscosity, not sound, limits the step, and then shear dies out. */
static void viscosity_limits_the_step(void **state) {
  (void)state;
  mps_particles_def set = mps_particles_defaults();
  set.spacing = 0.01;
  mps_particles *particles = NULL;
  mps_material *material = NULL;
  mps_mpm *mpm = NULL;
  mps_view x;
  mps_edit v;
  mps_totals before, after;
  const double lo[] = {0.0, 0.0}, hi[] = {0.2, 0.2}, viscosity = 2000.0;
  mps_material_newtonian_def law = mps_material_newtonian_defaults();
  law.bulk_modulus = 1e5, law.viscosity = viscosity;
  mps_assert_ok(context, mps_particles_create(context, &set, &particles));
  mps_assert_ok(context, mps_particles_fill_box(particles, lo, hi, NULL));
  mps_assert_ok(context, mps_particles_set(particles, "density", 0, 1000.0));
  mps_assert_ok(context, mps_particles_add_field(particles, "velocity", 0));
  mps_assert_ok(context, mps_particles_view(particles, "position", &x));
  mps_assert_ok(context, mps_particles_edit(particles, "velocity", &v));
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&v, k, 0) = sin(100.0 * *mps_view_f64(&x, k, 1));
  mps_assert_ok(context, mps_particles_commit(particles, &v));
  mps_assert_ok(context, mps_material_create_newtonian(context, &law, &material));
  mps_mpm_def def = small_def();
  mps_assert_ok(context, mps_mpm_create(context, particles, material, &def, &mpm));
  const double limit = 1000.0 * def.cell * def.cell / (4.0 * 2.0 * viscosity);
  assert_true(mps_mpm_limit(mpm) <= limit && mps_mpm_limit(mpm) > 0.9 * limit);
  mps_assert_ok(context, mps_mpm_get_totals(mpm, &before));
  for (int k = 0; k < 20; k++) {
    mps_assert_ok(context, mps_mpm_step(mpm, 10));
    mps_assert_ok(context, mps_mpm_get_totals(mpm, &after));
    assert_true(after.kinetic < before.kinetic);
    before = after;
  }
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&material);
  mps_particles_destroy(&particles);
}

/* A particle on a wall, near a corner, moves as the wall does. */
static void keep_on_the_wall(int32_t walls) {
  mps_particles_def set = mps_particles_defaults();
  set.spacing = 0.01;
  mps_particles *particles = NULL;
  mps_material *material = NULL;
  mps_mpm *mpm = NULL;
  mps_view v;
  mps_edit x;
  const double lo[] = {0.0, 0.0}, hi[] = {0.01, 0.01};
  mps_assert_ok(context, mps_particles_create(context, &set, &particles));
  mps_assert_ok(context, mps_particles_fill_box(particles, lo, hi, NULL));
  mps_assert_ok(context, mps_particles_set(particles, "density", 0, 1000.0));
  mps_assert_ok(context, mps_particles_set(particles, "velocity", 0, -1.0));
  mps_assert_ok(context, mps_particles_edit(particles, "position", &x));
  *mps_edit_f64(&x, 0, 0) = 0.0;
  mps_assert_ok(context, mps_particles_commit(particles, &x));
  mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e5, 0.3, &material));
  mps_mpm_def def = small_def();
  def.lower[0] = 0.0;
  def.walls = walls;
  mps_assert_ok(context, mps_mpm_create(context, particles, material, &def, &mpm));
  mps_assert_ok(context, mps_mpm_step(mpm, 1));
  mps_assert_ok(context, mps_particles_view(particles, "position", &x.view));
  mps_assert_ok(context, mps_particles_view(particles, "velocity", &v));
  mps_assert_near(*mps_view_f64(&v, 0, 0), 0.0, 1e-15);
  mps_assert_near(*mps_view_f64(&x.view, 0, 0), 0.0, 1e-15);
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&material);
  mps_particles_destroy(&particles);
}

static void keeps_on_the_wall(void **state) {
  (void)state;
  keep_on_the_wall(MPS_MPM_WALLS_MIRROR);
  keep_on_the_wall(MPS_MPM_WALLS_FIT);
}

static mps_status make(mps_context *c, int what) {
  mps_particles_def set = mps_particles_defaults();
  set.spacing = 0.01;
  mps_particles *particles = NULL;
  mps_material *material = NULL, *other = NULL;
  mps_mpm *mpm = NULL;
  mps_body *body = NULL;
  const int64_t fifth = 5;
  const double lo[] = {0.0, 0.0}, hi[] = {0.1, 0.1};
  mps_status status = mps_particles_create(c, &set, &particles);
  if (status == MPS_OK) status = mps_particles_fill_box(particles, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(particles, "density", 0, 1000.0);
  if (status == MPS_OK) {
    if (what == 0) {
      status = mps_material_create_linear_elastic(c, 1e5, 0.3, &material);
    } else if (what == 1) {
      status = mps_material_create_neo_hookean(c, 1e5, 0.3, &material);
    } else {
      mps_material_von_mises_def law = mps_material_von_mises_defaults();
      law.young = 1e5, law.yield_stress = 10.0;
      status = mps_material_create_von_mises(c, &law, &material);
    }
  }
  mps_mpm_def def = small_def();
  if (status == MPS_OK) status = mps_mpm_create(c, particles, material, &def, &mpm);
  if (status == MPS_OK && what == 2) status = mps_material_create_neo_hookean(c, 1e5, 0.3, &other);
  if (status == MPS_OK && other) status = mps_mpm_set_material(mpm, other, 1, &fifth);
  mps_body_def disc = mps_body_defaults();
  disc.position[0] = 0.12;
  if (status == MPS_OK) status = mps_body_create_disc(c, &disc, 0.02, &body);
  if (status == MPS_OK) status = mpm_scene_try_contact(mpm, body, 0.0);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 2);
  mps_body_destroy(&body);
  mps_mpm_destroy(&mpm);
  mps_particles_destroy(&particles);
  mps_material_destroy(&material);
  mps_material_destroy(&other);
  return status;
}

static void survives_lack_of_memory(void **state) {
  (void)state;
  for (int what = 0; what < 3; what++) test_allocator_sweep(make, what);
}

/* Steps that sort, are in contact with a body and have enough memory allocate nothing. */
static void steady_steps_allocate_nothing(void **state) {
  (void)state;
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  mpm_scene s = small_scene(own);
  const double v0[] = {1.0, 0.5}, L[] = {0.0, -8.0, 8.0, 0.0};
  mpm_scene_affine(&s, v0, L);
  mps_mpm_def def = mps_mpm_defaults(); /* no walls: they hold particles in contact */
  def.cell = 0.02;
  mpm_scene_solve(&s, &def);
  mps_body *body = NULL;
  mps_body_def plate = mps_body_defaults();
  const double normal[] = {0.0, 1.0};
  plate.position[1] = 0.002;
  mps_assert_ok(own, mps_body_create_half_plane(own, &plate, normal, &body));
  mpm_scene_contact(&s, body, 0.2);
  mps_assert_ok(own, mps_mpm_step(s.mpm, 100));
  const uint64_t epoch = mps_particles_epoch(s.particles);
  const int64_t calls = allocator.calls;
  mps_assert_ok(own, mps_mpm_step(s.mpm, 300));
  assert_int_equal(allocator.calls, calls);
  assert_true(mps_particles_epoch(s.particles) > epoch); /* it has sorted */
  mps_body_destroy(&body);
  mpm_scene_end(&s);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}

/* Variants for comparison are chosen before the first step. */
static void variants_are_chosen_first(void **state) {
  (void)state;
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  mps_mpm_def def = mps_mpm_defaults();
  def.cell = 0.02, def.lower[0] = 0.0;
  mpm_scene_solve(&s, &def);
  mps_assert_fails(context, mps_experimental_mpm_transfer(s.mpm, -1), MPS_ERROR_ARGUMENT,
                   "transfer is -1");
  mps_assert_fails(context, mps_experimental_mpm_strain(s.mpm, 2), MPS_ERROR_ARGUMENT,
                   "strain is 2");
  mps_assert_fails(context, mps_experimental_mpm_standard(s.mpm, 1.5), MPS_ERROR_ARGUMENT,
                   "flip is 1.5");
  mpm_scene_side(&s, MPS_MPM_SIDE_X_LOWER, MPS_BOUNDARY_ABSORBING, 0.0);
  mps_assert_fails(context, mps_experimental_mpm_standard(s.mpm, 1.0), MPS_ERROR_ARGUMENT,
                   "boundary 0 is absorbing");
  mps_assert_ok(context, mps_mpm_step(s.mpm, 1));
  mps_assert_fails(context, mps_experimental_mpm_standard(s.mpm, 1.0), MPS_ERROR_STATE,
                   "has taken 1 steps");
  mps_assert_fails(context, mps_experimental_mpm_transfer(s.mpm, 1), MPS_ERROR_STATE,
                   "before the first");
  mps_assert_fails(context, mps_experimental_mpm_strain(s.mpm, 1), MPS_ERROR_STATE,
                   "before the first");
  mpm_scene_end(&s);
}

/* A part of the limit that is too small for a number, or lost in the rounding of the time: a run
 * would not end. */
static void a_step_advances_the_time(void **state) {
  (void)state;
  const double courants[] = {4.9e-324, 1e-20};
  for (int k = 0; k < 2; k++) {
    mpm_scene s = {.mpm = NULL};
    const double lo[2] = {0.0, 0.0}, hi[2] = {0.4, 0.4};
    mps_particles_def set = mps_particles_defaults();
    mps_mpm_def def = mps_mpm_defaults();
    set.spacing = 0.1, def.cell = 0.2, def.courant = courants[k];
    mps_assert_ok(context, mps_particles_create(context, &set, &s.particles));
    mps_assert_ok(context, mps_particles_fill_box(s.particles, lo, hi, NULL));
    mps_assert_ok(context, mps_particles_set(s.particles, "density", 0, 1000.0));
    mps_assert_ok(context, mps_material_create_linear_elastic(context, 1e6, 0.3, &s.material));
    mps_assert_ok(context, mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
    if (k == 1) { /* at 1 s */
      mps_assert_ok(context, mps_mpm_set_dt(s.mpm, 1e-3));
      mps_assert_ok(context, mps_mpm_step(s.mpm, 1000));
      mps_assert_ok(context, mps_mpm_set_dt(s.mpm, NAN));
    }
    const int64_t steps = mps_mpm_steps(s.mpm);
    mps_assert_fails(context, mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "does not advance the time");
    mps_assert_fails(context, mps_mpm_run(s.mpm, 2.0, 1, NULL, NULL), MPS_ERROR_STATE,
                     "does not advance the time");
    assert_int_equal(mps_mpm_steps(s.mpm), steps);
    mpm_scene_end(&s);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_step_advances_the_time),
                                     cmocka_unit_test(inverted_deformations_are_refused),
                                     cmocka_unit_test(refuses_bad_definitions),
                                     cmocka_unit_test(refuses_bad_sets),
                                     cmocka_unit_test(owns_its_bodies),
                                     cmocka_unit_test(sets_materials),
                                     cmocka_unit_test(runs_to_the_end),
                                     cmocka_unit_test(tells_what_left),
                                     cmocka_unit_test(keeps_on_the_wall),
                                     cmocka_unit_test(viscosity_limits_the_step),
                                     cmocka_unit_test(survives_lack_of_memory),
                                     cmocka_unit_test(steady_steps_allocate_nothing),
                                     cmocka_unit_test(variants_are_chosen_first)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
