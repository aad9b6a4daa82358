/* test_by_field.c - laws with factors of each particle: the same bits as laws of those constants,
 * in a block and in WLS-MPM; the profile by depth; what is refused.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material/material_internal.h"
#include "mpm_scene.h"

#include "material_paths.h"

enum { N = 40, COLUMNS = 20 };

static mps_material *make(int law, double stiff, double strength) {
  mps_material *m = NULL;
  mps_material_drucker_prager_def d = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def c = mps_material_mohr_coulomb_defaults();
  DEF(material_von_mises, v, .young = d.young = c.young = 1e6 * stiff,
      .yield_stress = 1e3 * strength, .hardening = 1e5 * stiff);
  d.friction = c.friction = 0.5, d.dilation = c.dilation = 0.1;
  d.cohesion = c.cohesion = 200.0 * strength, d.tension = c.tension = 100.0 * strength;
  if (law == 0) OK(mps_material_create_linear_elastic(context, v.young, 0.3, &m));
  if (law == 1) OK(mps_material_create_von_mises(context, &v, &m));
  if (law == 2) OK(mps_material_create_drucker_prager(context, &d, &m));
  DEF(material_cyclic_sand, y, .young = c.young, .friction = c.friction, .dilation = c.dilation,
      .cohesion = c.cohesion, .relative_density = 0.3);
  if (law == 5) OK(mps_material_create_cyclic_sand(context, &y, &m));
  if (law == 3 || law == 4) {
    if (law == 4) c.residual_cohesion = 0.5 * c.cohesion, c.slip = c.band = 0.5;
    OK(mps_material_create_mohr_coulomb(context, &c, &m));
  }
  return m;
}

static double stiff_of(int k) { return k == 0 ? 1.0 : 0.5 + 0.1 * k; }
static double strength_of(int k) { return k == 0 ? 1.0 : 2.0 - 0.04 * k; }

/* Every particle against a block of its own with a law of its constants. */
TEST(factors_are_those_of_the_constants) {
  for (int law = 0; law < 6; law++) {
    scoped_material *base = make(law, 1.0, 1.0), *m = NULL;
    OK(mps_material_create_by_field(context, base, &m));
    const int columns = mps_material_history_count(base);
    assert_int_equal(mps_material_history_count(m), columns + 2);
    assert_string_equal(mpsi_material_history_field(m, columns), "stiffness_factor");
    assert_string_equal(mpsi_material_history_field(m, columns + 1), "strength_factor");
    assert_string_equal(mps_material_name(m), mps_material_name(base));
    static double L[9][N], s[6][N], h[COLUMNS][N], V[N];
    static int64_t flags[N];
    uint64_t seed = 5;
    double *history[COLUMNS];
    for (int k = 0; k < N; k++) {
      for (int c = 0; c < 9; c++) L[c][k] = 4e-3 * noise(&seed);
      for (int c = 0; c < 6; c++) s[c][k] = c < 3 ? -500.0 : 0.0;
      for (int c = 0; c < columns; c++) h[c][k] = 0.0;
      h[columns][k] = k == 0 ? 0.0 : stiff_of(k); /* 0: 1 */
      h[columns + 1][k] = k == 0 ? 0.0 : strength_of(k);
      V[k] = 1.0;
    }
    mps_material_block b = mps_material_block_defaults();
    for (int c = 0; c < 9; c++) b.gradient[c] = L[c];
    for (int c = 0; c < 6; c++) b.stress[c] = s[c];
    for (int c = 0; c < COLUMNS; c++) history[c] = h[c];
    b.dim = 3, b.count = N, b.dt = 1.0, b.history = history, b.history_count = columns + 2;
    b.volume_ratio = V, b.flags = flags;
    OK(mps_material_update(context, m, &b));
    OK(mps_material_update(context, m, &b));
    int plastic = 0;
    for (int k = 0; k < N; k++) {
      scoped_material *own = make(law, stiff_of(k), strength_of(k));
      mps_material_point x = point_under(own, -500.0);
      double gradient[9];
      for (int c = 0; c < 9; c++) gradient[c] = L[c][k];
      OK(mps_material_point_drive(context, own, &x, gradient, 2.0, 2));
      for (int c = 0; c < 6; c++) NEAR(s[c][k], x.stress[c], 1e-9 * 1e3);
      for (int c = 0; c < columns; c++) NEAR(h[c][k], x.history[c], 1e-14);
      NEAR(V[k], x.volume_ratio, 1e-14);
      assert_int_equal(flags[k], x.flags);
      plastic += flags[k] != 0;
    }
    assert_true(law == 0 || plastic > 5);
  }
}

TEST(bad_laws_are_refused) {
  mps_material *base = make(1, 1.0, 1.0), *m = NULL, *other = NULL;
  REFUSES(mps_material_create_by_field(context, NULL, &m), "law is NULL");
  REFUSES(mps_material_create_by_field(context, base, NULL), "out is NULL");
  OK(mps_material_create_neo_hookean(context, 1e6, 0.3, &other));
  FAILS(mps_material_create_by_field(context, other, &m), MPS_ERROR_UNSUPPORTED,
        "law: it is neo_hookean, must be linear_elastic, von_mises");
  mps_material_destroy(&other);
  OK(mps_material_create_by_field(context, base, &other));
  FAILS(mps_material_create_by_field(context, other, &m), MPS_ERROR_UNSUPPORTED,
        "von_mises by field already");
  mps_material_destroy(&other);
  mps_material_destroy(&base);
}

/* Particles have the same columns of history, in the same fields, as with the law alone. */
TEST(histories_lie_in_the_same_fields) {
  scoped_material *law = NULL, *m = NULL;
  DEF(material_small_strain, def, .shear_modulus = 4e6, .reference_strain = 1e-4);
  OK(mps_material_create_small_strain(context, &def, &law));
  OK(mps_material_create_by_field(context, law, &m));
  const int32_t columns = mps_material_history_count(law);
  for (int32_t c = 0; c < columns; c++) {
    assert_string_equal(mps_material_history_name(m, c), mps_material_history_name(law, c));
    assert_string_equal(mpsi_material_history_field(m, c), mpsi_material_history_field(law, c));
  }
  assert_string_equal(mpsi_material_history_field(law, 0), "plastic_strain"); /* of the table */
  assert_string_equal(mpsi_material_history_field(law, 1), "small_strain.dissipated");
  assert_string_equal(mpsi_material_history_field(m, columns + 1), "strength_factor");
}

/* su grows with depth by a profile; the step's limit is that of the stiffest particle. */
TEST(a_profile_by_depth) {
  scoped_mpm_scene s = mpm_scene_begin(context, 0.05, 0.0, 0.0, 1e6);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 1.0);
  const double depth[3] = {0.0, 0.5, 1.0}, value[3] = {1.0, 2.0, 5.0}, bad[2] = {1.0, 0.5};
  const double negative[1] = {-1.0};
  REFUSES(mps_particles_set_profile(s.particles, NULL, 3, depth, value, NULL), "field is NULL");
  REFUSES(mps_particles_set_profile(s.particles, "stiffness_factor", 0, depth, value, NULL),
          "count is 0");
  REFUSES(mps_particles_set_profile(s.particles, "stiffness_factor", 2, bad, value, NULL),
          "depth[1] is 0.5 m");
  REFUSES(mps_particles_set_profile(s.particles, "stiffness_factor", 1, depth, negative, NULL),
          "-1");
  FAILS(mps_particles_set_profile(s.particles, "velocity", 1, depth, value, NULL), MPS_ERROR_FIELD,
        "components");
  FAILS(mps_particles_set_profile(s.particles, "id", 1, depth, value, NULL), MPS_ERROR_FIELD,
        "int64");
  mps_view view;
  assert_int_equal(mps_particles_view(s.particles, "stiffness_factor", &view), MPS_ERROR_FIELD);
  DEF(geostatic, low, .surface = 0.5);
  REFUSES(mps_particles_set_profile(s.particles, "user.own", 3, depth, value, &low),
          "above the surface");
  OK(mps_particles_set_profile(s.particles, "stiffness_factor", 3, depth, value, NULL));
  REFUSES(mps_particles_set_profile(s.particles, "stiffness_factor", 1, depth, negative, NULL),
          "-1"); /* the former values stay */
  mps_view x = mpm_scene_view(&s, "position");
  view = mpm_scene_view(&s, "stiffness_factor");
  double largest = 0.0;
  for (int64_t k = 0; k < view.shape[0]; k++) {
    const double d = 1.0 - *mps_view_f64(&x, k, 1);
    NEAR(*mps_view_f64(&view, k, 0), d < 0.5 ? 1.0 + 2.0 * d : 2.0 + 6.0 * (d - 0.5), 1e-12);
    largest = fmax(largest, *mps_view_f64(&view, k, 0));
  }
  MAKE_KEPT(material, m, create_by_field, context, s.material);
  mps_material_destroy(&s.material);
  s.material = m;
  USING(mpm, mpm_scene_solve(&s, &given), .cell = 0.1);
  const double wave = largest * mps_material_wave_modulus(m);
  NEAR(mps_mpm_limit(s.mpm), 0.1 / sqrt(wave / 1000.0), 1e-9);
  FAILS(mps_particles_set_material(s.particles, m, 1000.0, NULL, 0), MPS_ERROR_UNSUPPORTED,
        "factors of each particle");
}
