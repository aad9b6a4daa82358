/* test_mpm.c - the WLS-MPM solver: arguments, errors, memory, ownership.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "mpm_scene.h"
#include "test_allocator.h"
#include "test_fixture.h"

static mps_mpm_def small_def(void) {
  DEF(mpm, def, .cell = 0.02, .lower[0] = def.lower[1] = 0.0);
  return def;
}

static mpm_scene small_scene(mps_context *c) {
  mpm_scene s = mpm_scene_begin(c, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  return s;
}

static void refuses(mpm_scene *s, const mps_mpm_def *def, const char *text) {
  mps_mpm *mpm = (mps_mpm *)1;
  REFUSES(mps_mpm_create(context, s->particles, s->material, def, &mpm), text);
  assert_null(mpm);
}

TEST(refuses_bad_definitions) {
  scoped_mpm_scene s = small_scene(context);
  mps_mpm *mpm = NULL;
#define CASE(member, value, text)                                                                  \
  do {                                                                                             \
    mps_mpm_def def = small_def();                                                                 \
    def.member = value;                                                                            \
    refuses(&s, &def, text);                                                                       \
  } while (0)
  CASE(geometry, MPS_MPM_GEOMETRY_SPACE, "geometry is MPS_MPM_GEOMETRY_SPACE, and the set has 2 dimensions");
  CASE(cell, 1e9, "cell is 1e+09 m with particles 0.01 m apart");
  CASE(cell, 1e-4, "must be 0.5 to 100 of their spacings");
  CASE(lower[0], 0.013, "must lie on a node");
  CASE(upper[0], 1e-9, "at least one cell");
  CASE(upper[0], 0.08, "outside the domain [0, 0.08] m");
#undef CASE
  mps_mpm_def def = small_def();
  assert_int_equal(mps_mpm_create(NULL, s.particles, s.material, &def, &mpm), MPS_ERROR_ARGUMENT);
  REFUSES(mps_mpm_create(context, NULL, s.material, &def, &mpm), "particles is NULL");
  REFUSES(mps_mpm_create(context, s.particles, NULL, &def, &mpm), "material is NULL");
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, NULL), "out is NULL");
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
  OK(mps_particles_set(s.particles, "density", 0, 0.0));
  def = small_def();
  refuses(&s, &def, "density 0 kg/m3");
}

TEST(refuses_bad_sets) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mps_mpm_def def = small_def();
  mps_mpm *mpm = NULL;
  refuses(&s, &def, "the set has 0 particles");
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  FAILS(mps_mpm_create(context, s.particles, s.material, &def, &mpm), MPS_ERROR_FIELD,
        "no field 'density'");
  OK(mps_particles_set(s.particles, "density", 0, 1000.0));
  OK(mps_particles_set(s.particles, "stress", 2, 1.0));
  mpsi_particles_column(s.particles, "stress", 3)[5] = NAN;
  refuses(&s, &def, "'stress' of particle 5 is nan");
}

TEST(owns_its_bodies) {
  mpm_scene s = small_scene(context), other = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  mpm_scene_solve(&other, &def);
  scoped_body *body = NULL;
  USING(body, mps_body_create_disc(context, &given, 0.02, &body), .position[0] = 0.3);
  REFUSES(mpm_scene_try_contact(s.mpm, NULL, 0.0), "body is NULL");
  mpm_scene_contact(&s, body, 0.0);
  FAILS(mpm_scene_try_contact(s.mpm, body, 0.0), MPS_ERROR_STATE,
        "in contact with the body already");
  FAILS(mpm_scene_try_contact(other.mpm, body, 0.0), MPS_ERROR_STATE,
        "another solver moves the body");
  FAILS(mps_body_advance(body, 0.1), MPS_ERROR_STATE, "a solver moves");
  mps_mpm_destroy(&s.mpm);
  mpm_scene_contact(&other, body, 0.0); /* free again */
  REFUSES(mps_mpm_step(other.mpm, -1), "count is -1");
  REFUSES(mps_mpm_run(other.mpm, NAN, 1, NULL, NULL), "t_end is nan");
  REFUSES(mps_mpm_run(other.mpm, 1.0, 0, NULL, NULL), "every is 0");
  REFUSES(mps_mpm_get_totals(other.mpm, NULL), "out is NULL");
  mpm_scene_end(&s);
  mpm_scene_end(&other);
  mps_mpm_destroy(NULL);
  assert_true(mps_mpm_dt(NULL) == 0.0 && mps_mpm_time(NULL) == 0.0 && mps_mpm_steps(NULL) == 0);
}

/* A run ends exactly at its end, calls back as requested, and dt is that of (49). */
static mps_status count_calls(void *user, mps_mpm *mpm) {
  ++*(int *)user;
  return MPS_OK;
}

TEST(runs_to_the_end) {
  scoped_mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  /* E = 1e5, nu = 0.3: K + 4G/3 = E (1 - nu)/((1 + nu)(1 - 2 nu)) */
  const double c = sqrt(1e5 * 0.7 / (1.3 * 0.4) / 1000.0);
  NEAR(mps_mpm_limit(s.mpm), 0.02 / c, 1e-14);
  NEAR(mps_mpm_dt(s.mpm), 0.01 / c, 1e-14);
  int calls = 0;
  const double t_end = 10.5 * mps_mpm_dt(s.mpm);
  OK(mps_mpm_run(s.mpm, t_end, 4, count_calls, &calls));
  NEAR(mps_mpm_time(s.mpm), t_end, 0.0);
  assert_int_equal(mps_mpm_steps(s.mpm), 11);
  assert_int_equal(calls, 4); /* 0, 4, 8, 11 */
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
  DEF(material_user, law, .update = refusing, .user = (void *)refuses_now, .name = "touchy",
      .wave_modulus = 1e5, .history_count = 2, .history = names, .history_initial = initial,
      .needs_deformation = 1);
  MAKE_KEPT(material, out, create_user, c, &law);
  return out;
}

/* Another law for some: its fields are added, its history begins; an error names it. */
TEST(sets_materials) {
  int32_t refuses_now = 0;
  scoped_mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  mpm_scene_solve(&s, &def);
  scoped_material *law = refusing_material(context, &refuses_now);
  const int64_t ids[] = {7, 3}, bad[] = {7, 100};
  const int32_t fields = mps_particles_field_count(s.particles);
  REFUSES(mps_mpm_set_material(s.mpm, NULL, ids, 2), "material is NULL");
  REFUSES(mps_mpm_set_material(s.mpm, law, ids, -1), "count is -1");
  REFUSES(mps_mpm_set_material(s.mpm, law, NULL, 1), "ids NULL");
  REFUSES(mps_mpm_set_material(s.mpm, law, bad, 2), "ids[1] is 100: the set has no such particle");
  assert_int_equal(mps_particles_field_count(s.particles), fields);
  OK(mps_mpm_set_material(s.mpm, law, ids, 2));
  mps_view of = mpm_scene_view(&s, "material"), damage = mpm_scene_view(&s, "touchy.damage");
  mps_view F = mpm_scene_view(&s, "deformation_gradient"), J = mpm_scene_view(&s, "volume_ratio");
  for (int64_t id = 0; id < 100; id++) {
    const int64_t k = mps_particles_index(s.particles, id);
    const bool set = id == 7 || id == 3;
    assert_int_equal(*mps_view_i64(&of, k, 0), set);
    NEAR(*mps_view_f64(&damage, k, 0), set ? 1.0 : 0.0, 0.0);
    NEAR(*mps_view_f64(&F, k, 0), set ? 1.0 : 0.0, 0.0);
    NEAR(*mps_view_f64(&F, k, 1), 0.0, 0.0);
    NEAR(*mps_view_f64(&J, k, 0), set ? 1.0 : 0.0, 0.0);
  }
  OK(mps_mpm_step(s.mpm, 5));
  for (int k = 2; k < 300; k++) { /* two there are */
    MAKE(material, more, create_linear_elastic, context, 1e5, 0.3);
    OK(mps_mpm_set_material(s.mpm, more, ids, 1));
  }
  of = mpm_scene_view(&s, "material");
  assert_int_equal(*mps_view_i64(&of, mps_particles_index(s.particles, ids[0]), 0), 299);
  OK(mps_mpm_set_material(s.mpm, law, ids, 1));  /* known: no new one */
  OK(mps_mpm_set_material(s.mpm, law, NULL, 0)); /* all */
  of = mpm_scene_view(&s, "material");
  for (int64_t k = 0; k < 100; k++) assert_int_equal(*mps_view_i64(&of, k, 0), 1);
  refuses_now = 1;
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_NUMERIC, "the law 'touchy' has refused");
  refuses_now = 0; /* that step has not happened: the next one does */
  OK(mps_mpm_set_material(s.mpm, law, ids, 1));
  OK(mps_mpm_step(s.mpm, 1));
}

/* No law gives the stress of an inverted particle. */
TEST(inverted_deformations_are_refused) {
  mps_material *law = NULL;
  for (int dim = 2; dim <= 3; dim++) {
    DEF(particles, def, .dim = dim, .spacing = 0.1);
    DEF(mpm, solver, .cell = 0.2);
    if (dim == 3) solver.geometry = MPS_MPM_GEOMETRY_SPACE;
    OK(mps_material_create_neo_hookean(context, 1e6, 0.3, &law));
    MAKE(particles, set, create, context, &def);
    OK(mps_particles_fill_box(set, AT(0.0, 0.0, 0.0), AT(0.3, 0.3, 0.3), NULL));
    OK(mps_particles_set(set, "density", 0, 1000.0));
    MAKE(mpm, mpm, create, context, set, law, &solver);
    OK(mps_particles_set(set, "deformation_gradient", 0, -0.14));
    FAILS(mps_mpm_step(mpm, 1), MPS_ERROR_STATE,
          "particle 0 has the determinant -0.14, must be above 0");
    assert_int_equal(mps_mpm_steps(mpm), 0);
    OK(mps_particles_set(set, "deformation_gradient", 0, 1.0));
    OK(mps_mpm_step(mpm, 1));
    mps_material_destroy(&law);
  }
}

/* A lump that bursts out of the domain is reported with id and step, and the solver stops. */
TEST(tells_what_left) {
  scoped_mpm_scene s = small_scene(context);
  mps_mpm_def def = small_def();
  def.upper[0] = 0.2;
  OK(mps_particles_set(s.particles, "stress", 0, -1e8)); /* of E = 1e5 Pa */
  mpm_scene_solve(&s, &def);
  FAILS(mps_mpm_step(s.mpm, 200), MPS_ERROR_DIVERGED, "check dt");
  assert_true(mps_context_error(context)->particle >= 0);
  assert_true(mps_context_error(context)->step > 0);
  FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "");
}

/* Syrup: viscosity, not sound, limits the step, and then shear dies out. */
TEST(viscosity_limits_the_step) {
  mps_totals before, after;
  const double lo[] = {0.0, 0.0}, hi[] = {0.2, 0.2}, viscosity = 2000.0;
  DEF(material_newtonian, law, .bulk_modulus = 1e5, .viscosity = viscosity);
  scoped_particles *particles = box_of(context, 0.01, lo, hi);
  OK(mps_particles_set(particles, "density", 0, 1000.0));
  OK(mps_particles_add_field(particles, "velocity", 0));
  mps_view x = view_field(particles, "position");
  EDIT(v, particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 0) = sin(100.0 * *mps_view_f64(&x, k, 1));
  MAKE(material, material, create_newtonian, context, &law);
  mps_mpm_def def = small_def();
  MAKE(mpm, mpm, create, context, particles, material, &def);
  const double limit = 1000.0 * def.cell * def.cell / (4.0 * 2.0 * viscosity);
  assert_true(mps_mpm_limit(mpm) <= limit && mps_mpm_limit(mpm) > 0.9 * limit);
  OK(mps_mpm_get_totals(mpm, &before));
  for (int k = 0; k < 20; k++) {
    OK(mps_mpm_step(mpm, 10));
    OK(mps_mpm_get_totals(mpm, &after));
    assert_true(after.kinetic < before.kinetic);
    before = after;
  }
}

/* A particle on a wall, near a corner, moves as the wall does. */
static void keep_on_the_wall(int32_t walls) {
  mps_edit x;
  const double lo[] = {0.0, 0.0}, hi[] = {0.01, 0.01};
  scoped_particles *particles = box_of(context, 0.01, lo, hi);
  SET_FIELDS(particles, {"density", 1000.0}, {"velocity", -1.0});
  OK(mps_particles_edit(particles, "position", &x));
  *mps_edit_f64(&x, 0, 0) = 0.0;
  OK(mps_particles_commit(particles, &x));
  MAKE(material, material, create_linear_elastic, context, 1e5, 0.3);
  mps_mpm_def def = small_def();
  def.lower[0] = 0.0;
  def.edge = walls;
  MAKE(mpm, mpm, create, context, particles, material, &def);
  OK(mps_mpm_step(mpm, 1));
  OK(mps_particles_view(particles, "position", &x.view));
  mps_view v = view_field(particles, "velocity");
  NEAR(*mps_view_f64(&v, 0, 0), 0.0, 1e-15);
  NEAR(*mps_view_f64(&x.view, 0, 0), 0.0, 1e-15);
}

TEST(keeps_on_the_wall) {
  keep_on_the_wall(MPS_MPM_EDGE_MIRROR);
  keep_on_the_wall(MPS_MPM_EDGE_FIT);
}

static mps_status make(mps_context *c, int what) {
  DEF(particles, set, .spacing = 0.01);
  scoped_particles *particles = NULL;
  scoped_material *material = NULL, *other = NULL;
  scoped_mpm *mpm = NULL;
  scoped_body *body = NULL;
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
      DEF(material_von_mises, law, .young = 1e5, .yield_stress = 10.0);
      status = mps_material_create_von_mises(c, &law, &material);
    }
  }
  mps_mpm_def def = small_def();
  if (status == MPS_OK) status = mps_mpm_create(c, particles, material, &def, &mpm);
  if (status == MPS_OK && what == 2) status = mps_material_create_neo_hookean(c, 1e5, 0.3, &other);
  if (status == MPS_OK && other) status = mps_mpm_set_material(mpm, other, &fifth, 1);
  DEF(body, disc, .position[0] = 0.12);
  if (status == MPS_OK) status = mps_body_create_disc(c, &disc, 0.02, &body);
  if (status == MPS_OK) status = mpm_scene_try_contact(mpm, body, 0.0);
  if (status == MPS_OK) status = mps_mpm_step(mpm, 2);
  return status;
}

TEST(survives_lack_of_memory) {
  for (int what = 0; what < 3; what++) test_allocator_sweep(make, what);
}

/* Steps that sort, are in contact with a body and have enough memory allocate nothing. */
TEST(steady_steps_allocate_nothing) {
  test_allocator allocator = {0};
  mps_context *own = test_allocator_context(&allocator);
  mpm_scene s = small_scene(own);
  const double v0[] = {1.0, 0.5}, L[] = {0.0, -8.0, 8.0, 0.0};
  mpm_scene_affine(&s, v0, L);
  mps_mpm_def def = mps_mpm_defaults(); /* no walls: they hold particles in contact */
  def.cell = 0.02;
  mpm_scene_solve(&s, &def);
  mps_body *body = NULL;
  const double normal[] = {0.0, 1.0};
  USING(body, mps_body_create_half_plane(own, &given, normal, &body), .position[1] = 0.002);
  mpm_scene_contact(&s, body, 0.2);
  OK(mps_mpm_step(s.mpm, 100));
  const uint64_t epoch = mps_particles_epoch(s.particles);
  const int64_t calls = allocator.calls;
  OK(mps_mpm_step(s.mpm, 300));
  assert_int_equal(allocator.calls, calls);
  assert_true(mps_particles_epoch(s.particles) > epoch); /* it has sorted */
  mps_body_destroy(&body);
  mpm_scene_end(&s);
  mps_context_destroy(&own);
  assert_int_equal(allocator.live, 0);
}

/* Variants for comparison are chosen before the first step. */
TEST(variants_are_chosen_first) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.1, 0.1);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.02, .lower[0] = 0.0);
  REFUSES(mps_experimental_mpm_transfer(s.mpm, -1), "transfer is -1");
  REFUSES(mps_experimental_mpm_strain(s.mpm, 2), "strain is 2");
  REFUSES(mps_experimental_mpm_standard(s.mpm, 1.5), "flip is 1.5");
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_ABSORBING, 0.0);
  REFUSES(mps_experimental_mpm_standard(s.mpm, 1.0), "MPS_SIDE_X_LOWER is of kind MPS_BOUNDARY_ABSORBING");
  OK(mps_mpm_step(s.mpm, 1));
  FAILS(mps_experimental_mpm_standard(s.mpm, 1.0), MPS_ERROR_STATE, "has taken 1 steps");
  FAILS(mps_experimental_mpm_transfer(s.mpm, 1), MPS_ERROR_STATE, "before the first");
  FAILS(mps_experimental_mpm_strain(s.mpm, 1), MPS_ERROR_STATE, "before the first");
}

/* A part of the limit that is too small for a number, or lost in the rounding of the time: a run
 * would not end. */
TEST(a_step_advances_the_time) {
  const double courants[] = {4.9e-324, 1e-20};
  for (int k = 0; k < 2; k++) {
    scoped_mpm_scene s = {.mpm = NULL};
    mps_particles_def set = mps_particles_defaults();
    mps_mpm_def def = mps_mpm_defaults();
    set.spacing = 0.1, def.cell = 0.2, def.courant = courants[k];
    OK(mps_particles_create(context, &set, &s.particles));
    OK(mps_particles_fill_box(s.particles, AT(0.0, 0.0), AT(0.4, 0.4), NULL));
    OK(mps_particles_set(s.particles, "density", 0, 1000.0));
    OK(mps_material_create_linear_elastic(context, 1e6, 0.3, &s.material));
    OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
    if (k == 1) { /* at 1 s */
      OK(mps_mpm_set_dt(s.mpm, 1e-3));
      OK(mps_mpm_step(s.mpm, 1000));
      OK(mps_mpm_set_dt(s.mpm, NAN));
    }
    const int64_t steps = mps_mpm_steps(s.mpm);
    FAILS(mps_mpm_step(s.mpm, 1), MPS_ERROR_STATE, "does not advance the time");
    REFUSES(mps_mpm_run(s.mpm, 2.0, 1, NULL, NULL), "steps of dt = ");
    assert_int_equal(mps_mpm_steps(s.mpm), steps);
  }
}
