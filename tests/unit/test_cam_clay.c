/* test_cam_clay.c - Cam-Clay as a material: checks of its definition, its first state in a set and
 * in a solver, ground at rest, the step's limit by the present stiffness, also of a user's law.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material/material_internal.h"
#include "mpm_scene.h"

#include "clay_points.h"

/* ---- definition ------------------------------------------------------------------------------ */

TEST(the_law_answers_questions) {
  scoped_material *m = make_clay(&clays[0]);
  assert_string_equal(mps_material_name(m), "cam_clay");
  assert_int_equal(mps_material_history_count(m), 4);
  assert_string_equal(mpsi_material_history_field(m, 1), "preconsolidation");
  assert_string_equal(mpsi_material_history_field(m, 2), "void_ratio");
  NEAR(mps_material_history_initial(m, 1), 100e3, 0.0);
  NEAR(mps_material_history_initial(m, 2), 1.4, 0.0);
  const double bulk = 2.4 * 100e3 / 0.044, wave = 3.0 * bulk * 0.75 / 1.25;
  NEAR(mps_material_wave_modulus(m), wave, 1e-6 * wave);
  mps_moduli moduli;
  OK(mps_material_get_moduli(m, 1800.0, &moduli));
  NEAR(moduli.poisson, 0.25, 1e-12);
}

/* ---- a column -------------------------------------------------------------------------------- */

#define GRAVITY 10.0
#define DENSITY 800.0 /* buoyant, kg/m3 */
#define SURCHARGE 20e3
#define HEIGHT 1.0

/* Ground of the stiff clay under a surcharge. */
static mpm_scene column(double surcharge) {
  mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e7);
  mps_material_destroy(&s.material);
  s.material = make_clay(&clays[1]);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, HEIGHT);
  OK(mps_particles_set(s.particles, "density", 0, DENSITY));
  const mps_geostatic_layer layer = {INFINITY, 0.5, NAN};
  USING(geostatic, mps_particles_set_geostatic(s.particles, &given), .layers = &layer,
        .layer_count = 1, .gravity = GRAVITY, .surcharge = surcharge);
  return s;
}

static mps_mpm_def column_def(void) {
  DEF(mpm, def, .cell = 0.1, .upper[0] = 0.2, .gravity[1] = -GRAVITY);
  return def;
}

/* K0 of loading along virgin compression, less the elastic unloading; pc of the largest stress. */
TEST(consolidation_sets_the_state_of_rest) {
  static const double ocrs[3] = {1.0, 2.0, 30.0};
  const clay *c = &clays[1];
  for (int k = 0; k < 3; k++) {
    scoped_mpm_scene s = column(SURCHARGE);
    DEF(consolidation, def, .ocr = ocrs[k], .pop = k == 1 ? 5e3 : 0.0);
    if (k == 1) def.critical_volume = 2.5;
    OK(mps_particles_set_consolidation(s.particles, s.material, &def));
    const double normal = 0.63966, eta = 3.0 * (1.0 - normal) / (1.0 + 2.0 * normal);
    const double sine = 3.0 * c->M / (6.0 + c->M), passive = (1.0 + sine) / (1.0 - sine);
    mps_view stress = mpm_scene_view(&s, "stress"), pc = mpm_scene_view(&s, "preconsolidation");
    mps_view e = mpm_scene_view(&s, "void_ratio");
    for (int64_t i = 0; i < stress.shape[0]; i++) {
      const double v = -*mps_view_f64(&stress, i, 1), most = ocrs[k] * v + def.pop, R = most / v;
      const double k0 = fmin(passive, normal * R - (R - 1.0) * 0.2 / 0.8);
      const double p1 = most * (1.0 + 2.0 * normal) / 3.0;
      NEAR(-*mps_view_f64(&stress, i, 0) / v, k0, 2e-5 * R);
      NEAR(-*mps_view_f64(&stress, i, 2) / v, k0, 2e-5 * R);
      NEAR(*mps_view_f64(&pc, i, 0) / (p1 * (1.0 + eta * eta / 1.44)), 1.0, 1e-4);
      const double p = v * (1.0 + 2.0 * k0) / 3.0, top = *mps_view_f64(&pc, i, 0);
      const double volume = 2.5 + 0.08 * log(2.0 * 1000.0 / top) - 0.02 * log(p / 1000.0);
      NEAR(1.0 + *mps_view_f64(&e, i, 0), k == 1 ? volume : 1.8, 1e-4);
    }
  }
}

TEST(bad_states_are_refused_by_name) {
  scoped_mpm_scene s = column(SURCHARGE);
  const mps_mpm_def def = column_def();
#define REST(member, value, status, text)                                                          \
  do {                                                                                             \
    mps_consolidation_def d = mps_consolidation_defaults();                                        \
    d.member = value;                                                                              \
    FAILS(mps_particles_set_consolidation(s.particles, s.material, &d), status, text);             \
  } while (0)
  REST(k0, 0.05, MPS_ERROR_ARGUMENT, "begins outside the yield surface");
  REST(critical_volume, 1.01, MPS_ERROR_ARGUMENT, "would have the void ratio");
  const mps_consolidation_def good = mps_consolidation_defaults();
  MAKE(material, other, create_linear_elastic, context, 1e6, 0.3);
  FAILS(mps_particles_set_consolidation(s.particles, other, &good), MPS_ERROR_UNSUPPORTED,
        "the law is linear_elastic, must be cam_clay");
  assert_int_equal(mps_particles_set_consolidation(NULL, other, &good), MPS_ERROR_ARGUMENT);
  mps_view view;
  assert_int_equal(mps_particles_view(s.particles, "preconsolidation", &view), MPS_ERROR_FIELD);

  /* The definition's pc is 200 kPa: one particle is beyond, one without stress. */
  mps_edit stress = mpm_scene_edit(&s, "stress");
  *mps_edit_f64(&stress, 7, 1) = -900e3;
  mpm_scene_commit(&s, &stress);
  scoped_mpm *mpm = NULL;
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &mpm),
          "particle 7 begins outside the yield surface");
  stress = mpm_scene_edit(&s, "stress");
  for (int c = 0; c < 3; c++) *mps_edit_f64(&stress, 7, c) = c == 0 ? 1e3 : 0.0;
  mpm_scene_commit(&s, &stress);
  REFUSES(mps_mpm_create(context, s.particles, s.material, &def, &mpm),
          "particle 7 has the mean effective pressure -333.333 Pa");
  REFUSES(mps_particles_set_consolidation(s.particles, s.material, &good),
          "particle 7 has the vertical stress 0 Pa, must be compression");
  assert_null(mpm);
  OK(mps_mpm_create(context, s.particles, other, &def, &mpm));
  OK(mps_mpm_set_material(mpm, s.material, NULL, 0));
  REFUSES(mps_mpm_step(mpm, 1), "particle 7 has the mean effective pressure");
  OK(mps_mpm_set_material(mpm, other, NULL, 0));
  OK(mps_mpm_step(mpm, 1));
  REFUSES(mps_mpm_set_material(mpm, s.material, NULL, 0),
          "particle 7 has the mean effective pressure");
}

/* The field's pc and e count, not the definition's; the limit is that of the stiffest particle. */
TEST(a_solver_starts_from_the_fields) {
  scoped_mpm_scene s = column(SURCHARGE);
  DEF(consolidation, rest, .ocr = 3.0);
  OK(mps_particles_set_consolidation(s.particles, s.material, &rest));
  mps_edit void_ratio = mpm_scene_edit(&s, "void_ratio");
  *mps_edit_f64(&void_ratio, 3, 0) = 1.1;
  mpm_scene_commit(&s, &void_ratio);
  double stiffest = 0.0;
  mps_view pc = mpm_scene_view(&s, "preconsolidation"), e = mpm_scene_view(&s, "void_ratio");
  for (int64_t k = 0; k < pc.shape[0]; k++) {
    const double bulk = (1.0 + *mps_view_f64(&e, k, 0)) * *mps_view_f64(&pc, k, 0) / 0.02;
    stiffest = fmax(stiffest, 3.0 * bulk * 0.8 / 1.2);
  }
  const mps_mpm_def def = column_def();
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  const double limit = 0.1 / sqrt(stiffest / DENSITY);
  NEAR(mps_mpm_limit(s.mpm) / limit, 1.0, 1e-9);
  e = mpm_scene_view(&s, "void_ratio");
  mps_view id = mpm_scene_view(&s, "id");
  for (int64_t k = 0; k < e.shape[0]; k++)
    NEAR(*mps_view_f64(&e, k, 0), *mps_view_i64(&id, k, 0) == 3 ? 1.1 : 0.8, 0.0);
}

/* The void ratio of a pressed block follows its volume, and the limit of the step its growing
 * stiffness. */
TEST(a_pressed_block_stiffens) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e7);
  mps_material_destroy(&s.material);
  s.material = make_clay(&clays[0]);
  mpm_scene_box(&s, 0.0, 0.0, 0.4, 0.4);
  OK(mps_particles_set(s.particles, "density", 0, 1600.0));
  OK(mps_particles_add_field(s.particles, "stress", 0));
  for (int c = 0; c < 3; c++) OK(mps_particles_set(s.particles, "stress", c, -100e3));
  DEF(mpm, def, .cell = 0.1, .upper[0] = 0.4);
  OK(mps_mpm_create(context, s.particles, s.material, &def, &s.mpm));
  const double first = mps_mpm_limit(s.mpm);
  mps_edit v = mpm_scene_edit(&s, "velocity"), L = mpm_scene_edit(&s, "velocity_gradient");
  mps_view x = mpm_scene_view(&s, "position");
  for (int64_t k = 0; k < x.shape[0]; k++) {
    *mps_edit_f64(&v, k, 1) = -2.0 * *mps_view_f64(&x, k, 1);
    *mps_edit_f64(&L, k, 3) = -2.0;
  }
  mpm_scene_commit(&s, &v);
  mpm_scene_commit(&s, &L);
  OK(mps_mpm_run(s.mpm, 1e-4, 100000, NULL, NULL));
  mps_view stress = mpm_scene_view(&s, "stress"), e = mpm_scene_view(&s, "void_ratio");
  mps_view V = mpm_scene_view(&s, "volume"), pc = mpm_scene_view(&s, "preconsolidation");
  double most = 0.0;
  for (int64_t k = 0; k < e.shape[0]; k++) {
    const double ratio = *mps_view_f64(&V, k, 0) / (0.05 * 0.05);
    NEAR((1.0 + *mps_view_f64(&e, k, 0)) / 2.4, ratio, 1e-12); /* grains stay */
    most = fmax(most, (1.0 + *mps_view_f64(&e, k, 0)) * *mps_view_f64(&pc, k, 0));
    assert_true(*mps_view_f64(&stress, k, 1) <= -99e3);
  }
  assert_true(most > 2.4 * 100e3);
  assert_true(mps_mpm_limit(s.mpm) < first);
}

/* ---- a user's moduli ------------------------------------------------------------------------- */

static mps_status user_law(void *user, const mps_material_block *b) {
  for (int64_t k = 0; k < b->count; k++) b->history[0][k] += b->dt;
  return MPS_OK;
}

/* Grows with the history; beyond `*user` not a number. */
static void user_moduli(void *user, const mps_material_block *b, double *moduli) {
  const double *last = user;
  for (int64_t k = 0; k < b->count; k++)
    moduli[k] = b->history[0][k] > *last ? -1.0 : 1e6 * (1.0 + 1e4 * b->history[0][k]);
}

TEST(a_users_law_states_its_present_modulus) {
  static const char *const names[] = {"age"};
  double last = 1.0;
  DEF(material_user, law, .update = user_law, .user = &last, .history_count = 1, .history = names,
      .wave_modulus = 1e6, .moduli = user_moduli);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  mps_material_destroy(&s.material);
  OK(mps_material_create_user(context, &law, &s.material));
  mpm_scene_box(&s, 0.0, 0.0, 0.4, 0.4);
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1, .dt = 1e-5);
  NEAR(mps_mpm_limit(s.mpm), 0.1 / sqrt(1e3), 1e-9);
  OK(mps_mpm_run(s.mpm, 1e-4, 10, NULL, NULL));
  NEAR(mps_mpm_limit(s.mpm), 0.1 / sqrt(2e3), 1e-9);
  last = 0.0; /* the next state has no modulus */
  assert_int_equal(mps_mpm_run(s.mpm, 1.1e-4, 10, NULL, NULL), MPS_ERROR_DIVERGED);
}

/* ---- lists ----------------------------------------------------------------------------------- */

TEST(listed_particles_alone_are_set) {
  scoped_mpm_scene s = column(SURCHARGE);
  const int64_t some[2] = {1, 3}, wrong[1] = {1000};
  DEF(consolidation, def, .count = 1, .ids = wrong);
  REFUSES(mps_particles_set_consolidation(s.particles, s.material, &def), "1000");
  def.count = 2, def.ids = some;
  OK(mps_particles_set_consolidation(s.particles, s.material, &def));
  mps_view pc = mpm_scene_view(&s, "preconsolidation");
  for (int64_t k = 0; k < pc.shape[0]; k++)
    assert_true((*mps_view_f64(&pc, k, 0) > 0.0) == (k == 1 || k == 3));
}
