/* test_material_gap.c - sand and cohesive soil that are drawn apart and pressed together again: the
 * gap closes before they resist, whatever the path; no energy comes from nowhere.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"

#include "material_paths.h"

#define E 1e7
#define NU 0.3
#define C 1e4 /* cohesion, Pa */
static const double shear = E / (2.0 * (1.0 + NU)), bulk = E / (3.0 * (1.0 - 2.0 * NU));

enum { LAWS = 5 }; /* four cones, and Mohr-Coulomb */

static mps_material *soil(int law, double psi, double cohesion, double tension) {
  mps_material_drucker_prager_def cone = mps_material_drucker_prager_defaults();
  mps_material_mohr_coulomb_def pyramid = mps_material_mohr_coulomb_defaults();
  mps_material *material = NULL;
  cone.young = pyramid.young = E;
  cone.cone = law;
  cone.friction = pyramid.friction = 38.0 * PI / 180.0;
  cone.dilation = pyramid.dilation = psi * PI / 180.0;
  cone.cohesion = pyramid.cohesion = cohesion;
  cone.tension = pyramid.tension = tension;
  mps_assert_ok(context, law < 4 ? mps_material_create_drucker_prager(context, &cone, &material)
                                 : mps_material_create_mohr_coulomb(context, &pyramid, &material));
  return material;
}

static void step(const mps_material *material, mps_material_point *point, double x, double y,
                 double z, double turn) {
  const double gradient[9] = {x, turn, 0, turn, y, 0, 0, 0, z};
  mps_assert_ok(context, mps_material_point_drive(context, material, point, gradient, 1.0, 1));
}

/* Volume strain `strain` in one step, the same along all axes. */
static void swell(const mps_material *material, mps_material_point *point, double strain) {
  step(material, point, strain / 3.0, strain / 3.0, strain / 3.0, 0.0);
}

static void assert_no_stress(const mps_material_point *point) {
  for (int c = 0; c < 6; c++) mps_assert_near(point->stress[c], 0.0, 1e-9);
}

/* Opens by a tenth of its volume with much shear, closes by another path; then it is elastic. */
static void sand_closes_its_gap_before_it_resists(void **state) {
  (void)state;
  for (int law = 0; law < LAWS; law++)
    for (int psi = 0; psi <= 38; psi += 38) {
      mps_material *material = soil(law, psi, 0.0, INFINITY);
      mps_material_point point = point_under(material, 0.0);
      double gap = 1e-3; /* volume strain */
      swell(material, &point, gap);
      while (gap < 0.1) {
        step(material, &point, 2e-3, -3e-3, 2e-3, 1e-3);
        gap += 1e-3;
        assert_no_stress(&point);
        mps_assert_near(point.history[1], gap, 1e-12);
        mps_assert_near(point.volume_ratio, 1.0, 1e-12);
        assert_int_equal(point.flags, MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX);
      }
      while (gap > 1.5e-3) { /* sheared as it closes: it neither resists nor dilates */
        step(material, &point, -2e-3, 3e-3, -2e-3, 4e-3);
        gap -= 1e-3;
        assert_no_stress(&point);
        mps_assert_near(point.history[1], gap, 1e-12);
        mps_assert_near(point.volume_ratio, 1.0, 1e-12);
      }
      swell(material, &point, -gap - 3e-4);
      for (int c = 0; c < 3; c++) mps_assert_near(point.stress[c], -3e-4 * bulk, 1e-6);
      mps_assert_near(point.history[1], 0.0, 0.0);
      mps_assert_near(point.volume_ratio, exp(-3e-4), 1e-11);
      step(material, &point, 0.0, 0.0, 0.0, 1e-6); /* and has its shear stiffness again */
      mps_assert_near(point.stress[3], 2e-6 * shear, 1e-9);
      assert_int_equal(point.flags, 0);
      mps_material_destroy(&material);
    }
}

/* Trembling for long, from nothing to far beyond the limit: the volume stays that of the stress.
 * The product of 1 + strain falls below 1e-2, and a law that forgets the gap is under pressure at
 * once. */
static void trembling_does_not_wear_the_volume_away(void **state) {
  (void)state;
  for (int law = 0; law < LAWS; law++) {
    mps_material *material = soil(law, 0.0, 0.0, INFINITY);
    mps_material_point point = point_under(material, 0.0);
    uint64_t seed = 3;
    double sum = 0.0, product = 1.0;
    for (int turn = 0; turn < 100000; turn++) {
      const double strain = 0.02 * random_number(&seed) - 0.002 * sum;
      swell(material, &point, strain);
      sum += strain, product *= 1.0 + strain;
      mps_assert_near(mean_stress(point.stress), bulk * fmin(sum, 0.0), 1e-6 * bulk);
      mps_assert_near(point.history[1], fmax(sum, 0.0), 1e-6);
      mps_assert_near(log(point.volume_ratio), fmin(sum, 0.0), 1e-3);
    }
    assert_true(product < 1e-2);
    mps_material_destroy(&material);
  }
}

/* What holds the grains together pulls as they part, not as they close again. */
static void cohesion_pulls_only_on_opening(void **state) {
  (void)state;
  const double limit = 2e3;
  for (int law = 0; law < LAWS; law++) {
    mps_material *material = soil(law, 0.0, C, limit);
    mps_material_point point = point_under(material, 0.0);
    swell(material, &point, limit / bulk + 0.02);
    mps_assert_near(mean_stress(point.stress), limit, 1e-8);
    mps_assert_near(point.history[1], 0.02, 1e-12);
    mps_assert_near(point.volume_ratio, exp(limit / bulk), 1e-11);
    swell(material, &point, -0.5 * limit / bulk); /* elastic */
    mps_assert_near(mean_stress(point.stress), 0.5 * limit, 1e-8);
    mps_assert_near(point.history[1], 0.02, 1e-12);
    swell(material, &point, -0.5 * limit / bulk - 0.01);
    mps_assert_near(mean_stress(point.stress), 0.0, 1e-8);
    mps_assert_near(point.history[1], 0.01, 1e-12);
    swell(material, &point, 0.5 * limit / bulk); /* the other way: elastic up to the limit */
    mps_assert_near(mean_stress(point.stress), 0.5 * limit, 1e-8);
    mps_assert_near(point.history[1], 0.01, 1e-12);
    mps_material_destroy(&material);
  }
}

/* Shear of cohesive soil whose grains have a gap: the mean stress stays, the deviator goes to the
 * pyramid at that mean stress, s1 - s3 = 2 c cos(phi) - (s1 + s3) sin(phi), and nothing dilates. */
static void shear_beside_a_gap_has_the_strength_of_its_mean_stress(void **state) {
  (void)state;
  const double phi = 38.0 * PI / 180.0, apex = C / tan(phi);
  mps_material *material = soil(LAWS - 1, 10.0, C, INFINITY);
  mps_material_point point = point_under(material, 0.0);
  swell(material, &point, apex / bulk + 0.02);
  swell(material, &point, -0.5 * apex / bulk); /* elastic */
  step(material, &point, 3e-3, -2e-3, -1e-3, 0.0);
  const double *s = point.stress;
  assert_true(s[0] > s[2] && s[2] > s[1]);
  mps_assert_near(mean_stress(s), 0.5 * apex, 1e-8);
  mps_assert_near(s[0] - s[1], 2.0 * C * cos(phi) - (s[0] + s[1]) * sin(phi), 1e-8);
  mps_assert_near((s[2] - s[1]) / (s[0] - s[1]), 0.2, 1e-12); /* as in the strain */
  mps_assert_near(point.history[1], 0.02, 1e-12);
  mps_material_destroy(&material);
}

static double elastic_energy(const double *s) {
  const double p = mean_stress(s), q = root_j2(s);
  return 0.5 * p * p / bulk + 0.5 * q * q / shear;
}

/* The stress after each step times its strain is at least what the elastic energy gains (which is
 * convex): random paths, through tension and compression. */
static void no_path_gives_energy(void **state) {
  (void)state;
  static const double cases[][2] = {{0.0, INFINITY}, {C, INFINITY}, {C, 2e3}, {0.0, 0.0}};
  uint64_t seed = 11;
  for (int law = 0; law < LAWS; law++)
    for (int n = 0; n < 4; n++) {
      mps_material *material = soil(law, 10.0, cases[n][0], cases[n][1]);
      mps_material_point point = point_under(material, 0.0);
      int opened = 0, closed = 0;
      for (int k = 0; k < 20000; k++) {
        double d[4], before = elastic_energy(point.stress), gap = point.history[1];
        const double swings = 4e-3 * sin(0.05 * k);
        for (int c = 0; c < 4; c++) d[c] = 2e-3 * random_number(&seed) + (c < 3 ? swings : 0.0);
        step(material, &point, d[0], d[1], d[2], d[3]);
        const double *s = point.stress;
        const double work = s[0] * d[0] + s[1] * d[1] + s[2] * d[2] + 2.0 * s[3] * d[3];
        assert_true(work - (elastic_energy(s) - before) >= -1e-9 * E * 1e-3);
        opened += point.history[1] > gap, closed += point.history[1] < gap;
      }
      assert_true(opened > 1000 && closed > 1000);
      mps_material_destroy(&material);
    }
}

/* ---- a column that is thrown ----------------------------------------------------------------- */

/* Height of the highest particle. */
static double height_of(mpm_scene *s) {
  const mps_view x = mpm_scene_view(s, "position");
  double top = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) top = fmax(top, *mps_view_f64(&x, k, 1));
  return top;
}

/* A column of sand between smooth walls is thrown up, its head faster than its foot, falls and
 * comes to rest: it is as high as before. */
static void a_thrown_column_lands_as_high_as_it_was(void **state) {
  (void)state;
  for (int law = 0; law < LAWS; law += 4) {
    mpm_scene s = mpm_scene_begin(context, 0.025, 0.0, 0.0, E);
    mps_material_destroy(&s.material);
    s.material = soil(law, 0.0, 0.0, INFINITY);
    mpm_scene_box(&s, 0.0, 0.0, 0.1, 1.0);
    const double v0[] = {0.0, 2.0}, rate[] = {0.0, 0.0, 0.0, 1.0};
    mpm_scene_affine(&s, v0, rate);
    mps_mpm_def def = mps_mpm_defaults();
    def.cell = 0.05;
    def.gravity[1] = -9.81;
    def.lower[0] = def.lower[1] = 0.0, def.upper[0] = 0.1; /* rollers */
    mpm_scene_solve(&s, &def);
    const double before = height_of(&s);
    mps_assert_ok(context, mps_mpm_run(s.mpm, 0.3, 1000000, NULL, NULL));
    const mps_view gap = mpm_scene_view(&s, "opening");
    double most = 0.0;
    for (int64_t k = 0; k < gap.shape[0]; k++) most = fmax(most, *mps_view_f64(&gap, k, 0));
    assert_true(height_of(&s) > before + 0.2 && most > 0.2);
    mps_assert_ok(context, mps_mpm_run(s.mpm, 2.0, 1000000, NULL, NULL));
    print_message("law %d: highest particle at %.4f m, then %.4f m\n", law, before, height_of(&s));
    mps_assert_near(height_of(&s), before, 0.03);
    mpm_scene_end(&s);
  }
}

/* At the apex the deviator is 0 and so is the room for it, to rounding: no quotient of the two. */
static void opens_further_at_the_apex(void **state) {
  (void)state;
  for (int degrees = 1; degrees <= 60; degrees++) {
    mps_material_mohr_coulomb_def def = mps_material_mohr_coulomb_defaults();
    mps_material *material = NULL;
    def.young = E;
    def.friction = degrees * PI / 180.0;
    def.cohesion = 1.0;
    mps_assert_ok(context, mps_material_create_mohr_coulomb(context, &def, &material));
    mps_material_point point = point_under(material, 0.0);
    const double apex = 1.0 / tan(def.friction);
    for (int k = 1; k <= 3; k++) {
      swell(material, &point, 1e-3);
      for (int c = 0; c < 3; c++) mps_assert_near(point.stress[c], apex, 1e-9 * apex);
      mps_assert_near(point.history[1], 1e-3 * k - apex / bulk, 1e-12);
    }
    mps_material_destroy(&material);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(sand_closes_its_gap_before_it_resists),
      cmocka_unit_test(trembling_does_not_wear_the_volume_away),
      cmocka_unit_test(cohesion_pulls_only_on_opening),
      cmocka_unit_test(shear_beside_a_gap_has_the_strength_of_its_mean_stress),
      cmocka_unit_test(opens_further_at_the_apex),
      cmocka_unit_test(no_path_gives_energy),
      cmocka_unit_test(a_thrown_column_lands_as_high_as_it_was),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
