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
  mps_material_mohr_coulomb_def pyramid = mps_material_mohr_coulomb_defaults();
  mps_material *material = NULL;
  USING(material_drucker_prager,
        law < 4 ? mps_material_create_drucker_prager(context, &given, &material)
                : mps_material_create_mohr_coulomb(context, &pyramid, &material),
        .young = pyramid.young = E, .cone = law, .friction = pyramid.friction = 38.0 * PI / 180.0,
        .dilation = pyramid.dilation = psi * PI / 180.0, .cohesion = pyramid.cohesion = cohesion,
        .tension = pyramid.tension = tension);
  return material;
}

static void step(const mps_material *material, mps_material_point *point, double x, double y,
                 double z, double turn) {
  const double gradient[9] = {x, turn, 0, turn, y, 0, 0, 0, z};
  OK(mps_material_point_drive(context, material, point, gradient, 1.0, 1));
}

/* Volume strain `strain` in one step, the same along all axes. */
static void swell(const mps_material *material, mps_material_point *point, double strain) {
  step(material, point, strain / 3.0, strain / 3.0, strain / 3.0, 0.0);
}

static void assert_no_stress(const mps_material_point *point) {
  for (int c = 0; c < 6; c++) NEAR(point->stress[c], 0.0, 1e-9);
}

/* Opens by a tenth of its volume with much shear, closes by another path; then it is elastic. */
TEST(sand_closes_its_gap_before_it_resists) {
  for (int law = 0; law < LAWS; law++)
    for (int psi = 0; psi <= 38; psi += 38) {
      scoped_material *material = soil(law, psi, 0.0, INFINITY);
      mps_material_point point = point_under(material, 0.0);
      double gap = 1e-3; /* volume strain */
      swell(material, &point, gap);
      while (gap < 0.1) {
        step(material, &point, 2e-3, -3e-3, 2e-3, 1e-3);
        gap += 1e-3;
        assert_no_stress(&point);
        NEAR(point.history[1], gap, 1e-12);
        NEAR(point.volume_ratio, 1.0, 1e-12);
        assert_int_equal(point.flags, MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX);
      }
      while (gap > 1.5e-3) { /* sheared as it closes: it neither resists nor dilates */
        step(material, &point, -2e-3, 3e-3, -2e-3, 4e-3);
        gap -= 1e-3;
        assert_no_stress(&point);
        NEAR(point.history[1], gap, 1e-12);
        NEAR(point.volume_ratio, 1.0, 1e-12);
      }
      swell(material, &point, -gap - 3e-4);
      for (int c = 0; c < 3; c++) NEAR(point.stress[c], -3e-4 * bulk, 1e-6);
      NEAR(point.history[1], 0.0, 0.0);
      NEAR(point.volume_ratio, exp(-3e-4), 1e-11);
      step(material, &point, 0.0, 0.0, 0.0, 1e-6); /* and has its shear stiffness again */
      NEAR(point.stress[3], 2e-6 * shear, 1e-9);
      assert_int_equal(point.flags, 0);
    }
}

/* Trembling for long, from nothing to far beyond the limit: the volume stays that of the stress.
 * The product of 1 + strain falls below 1e-2, and a law that forgets the gap is under pressure at
 * once. */
TEST(trembling_does_not_wear_the_volume_away) {
  for (int law = 0; law < LAWS; law++) {
    scoped_material *material = soil(law, 0.0, 0.0, INFINITY);
    mps_material_point point = point_under(material, 0.0);
    uint64_t seed = 3;
    double sum = 0.0, product = 1.0;
    for (int turn = 0; turn < 100000; turn++) {
      const double strain = 0.02 * noise(&seed) - 0.002 * sum;
      swell(material, &point, strain);
      sum += strain, product *= 1.0 + strain;
      NEAR(mean_stress(point.stress), bulk * fmin(sum, 0.0), 1e-6 * bulk);
      NEAR(point.history[1], fmax(sum, 0.0), 1e-6);
      NEAR(log(point.volume_ratio), fmin(sum, 0.0), 1e-3);
    }
    assert_true(product < 1e-2);
  }
}

/* What holds the grains together pulls as they part, not as they close again. */
TEST(cohesion_pulls_only_on_opening) {
  const double limit = 2e3;
  for (int law = 0; law < LAWS; law++) {
    scoped_material *material = soil(law, 0.0, C, limit);
    mps_material_point point = point_under(material, 0.0);
    swell(material, &point, limit / bulk + 0.02);
    NEAR(mean_stress(point.stress), limit, 1e-8);
    NEAR(point.history[1], 0.02, 1e-12);
    NEAR(point.volume_ratio, exp(limit / bulk), 1e-11);
    swell(material, &point, -0.5 * limit / bulk); /* elastic */
    NEAR(mean_stress(point.stress), 0.5 * limit, 1e-8);
    NEAR(point.history[1], 0.02, 1e-12);
    swell(material, &point, -0.5 * limit / bulk - 0.01);
    NEAR(mean_stress(point.stress), 0.0, 1e-8);
    NEAR(point.history[1], 0.01, 1e-12);
    swell(material, &point, 0.5 * limit / bulk); /* the other way: elastic up to the limit */
    NEAR(mean_stress(point.stress), 0.5 * limit, 1e-8);
    NEAR(point.history[1], 0.01, 1e-12);
  }
}

/* Shear of cohesive soil whose grains have a gap: the mean stress stays, the deviator goes to the
 * pyramid at that mean stress, s1 - s3 = 2 c cos(phi) - (s1 + s3) sin(phi), and nothing dilates. */
TEST(shear_beside_a_gap_has_the_strength_of_its_mean_stress) {
  const double phi = 38.0 * PI / 180.0, apex = C / tan(phi);
  scoped_material *material = soil(LAWS - 1, 10.0, C, INFINITY);
  mps_material_point point = point_under(material, 0.0);
  swell(material, &point, apex / bulk + 0.02);
  swell(material, &point, -0.5 * apex / bulk); /* elastic */
  step(material, &point, 3e-3, -2e-3, -1e-3, 0.0);
  const double *s = point.stress;
  assert_true(s[0] > s[2] && s[2] > s[1]);
  NEAR(mean_stress(s), 0.5 * apex, 1e-8);
  NEAR(s[0] - s[1], 2.0 * C * cos(phi) - (s[0] + s[1]) * sin(phi), 1e-8);
  NEAR((s[2] - s[1]) / (s[0] - s[1]), 0.2, 1e-12); /* as in the strain */
  NEAR(point.history[1], 0.02, 1e-12);
}

static double elastic_energy(const double *s) {
  const double p = mean_stress(s), q = root_j2(s);
  return 0.5 * p * p / bulk + 0.5 * q * q / shear;
}

/* The stress after each step times its strain is at least what the elastic energy gains (which is
 * convex): random paths, through tension and compression. */
TEST(no_path_gives_energy) {
  static const double cases[][2] = {{0.0, INFINITY}, {C, INFINITY}, {C, 2e3}, {0.0, 0.0}};
  uint64_t seed = 11;
  for (int law = 0; law < LAWS; law++)
    for (int n = 0; n < 4; n++) {
      scoped_material *material = soil(law, 10.0, cases[n][0], cases[n][1]);
      mps_material_point point = point_under(material, 0.0);
      int opened = 0, closed = 0;
      for (int k = 0; k < 20000; k++) {
        double d[4], before = elastic_energy(point.stress), gap = point.history[1];
        const double swings = 4e-3 * sin(0.05 * k);
        for (int c = 0; c < 4; c++) d[c] = 2e-3 * noise(&seed) + (c < 3 ? swings : 0.0);
        step(material, &point, d[0], d[1], d[2], d[3]);
        const double *s = point.stress;
        const double work = s[0] * d[0] + s[1] * d[1] + s[2] * d[2] + 2.0 * s[3] * d[3];
        assert_true(work - (elastic_energy(s) - before) >= -1e-9 * E * 1e-3);
        opened += point.history[1] > gap, closed += point.history[1] < gap;
      }
      assert_true(opened > 1000 && closed > 1000);
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
TEST(a_thrown_column_lands_as_high_as_it_was) {
  for (int law = 0; law < LAWS; law += 4) {
    scoped_mpm_scene s = mpm_scene_begin(context, 0.025, 0.0, 0.0, E);
    mps_material_destroy(&s.material);
    s.material = soil(law, 0.0, 0.0, INFINITY);
    mpm_scene_box(&s, 0.0, 0.0, 0.1, 1.0);
    const double v0[] = {0.0, 2.0}, rate[] = {0.0, 0.0, 0.0, 1.0};
    mpm_scene_affine(&s, v0, rate);
    DEF(mpm, def, .cell = 0.05, .gravity[1] = -9.81);
    def.lower[0] = def.lower[1] = 0.0, def.upper[0] = 0.1; /* rollers */
    mpm_scene_solve(&s, &def);
    const double before = height_of(&s);
    OK(mps_mpm_run(s.mpm, 0.3, 1000000, NULL, NULL));
    const mps_view gap = mpm_scene_view(&s, "opening");
    double most = 0.0;
    for (int64_t k = 0; k < gap.shape[0]; k++) most = fmax(most, *mps_view_f64(&gap, k, 0));
    assert_true(height_of(&s) > before + 0.2 && most > 0.2);
    OK(mps_mpm_run(s.mpm, 2.0, 1000000, NULL, NULL));
    print_message("law %d: highest particle at %.4f m, then %.4f m\n", law, before, height_of(&s));
    NEAR(height_of(&s), before, 0.03);
  }
}

/* At the apex the deviator is 0 and so is the room for it, to rounding: no quotient of the two. */
TEST(opens_further_at_the_apex) {
  for (int degrees = 1; degrees <= 60; degrees++) {
    DEF(material_mohr_coulomb, def, .young = E, .friction = degrees * PI / 180.0, .cohesion = 1.0);
    MAKE(material, material, create_mohr_coulomb, context, &def);
    mps_material_point point = point_under(material, 0.0);
    const double apex = 1.0 / tan(def.friction);
    for (int k = 1; k <= 3; k++) {
      swell(material, &point, 1e-3);
      for (int c = 0; c < 3; c++) NEAR(point.stress[c], apex, 1e-9 * apex);
      NEAR(point.history[1], 1e-3 * k - apex / bulk, 1e-12);
    }
  }
}
