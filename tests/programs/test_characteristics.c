/* test_characteristics.c - bearing capacity by the method of characteristics against closed forms
 * (Prandtl, Reissner), published factors of weight, and what must hold for any ground.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_common.h"

#include "footing/characteristics.h"

#define DEGREE (PI / 180.0)

/* Undrained ground: 2 + pi, on smooth and rough base, and whatever its weight. */
TEST(prandtl_without_friction) {
  for (int rough = 0; rough < 2; rough++)
    for (int k = 0; k < 2; k++) {
      const strip_footing f = {
          .half_width = 0.7, .cohesion = 3.0, .weight = 10.0 * k, .rough = rough};
      NEAR(characteristics_capacity(&f, 12), 3.0 * (2.0 + PI), 1e-8);
    }
}

/* Ground without weight: N_q = exp(pi tan phi) tan^2(pi/4 + phi/2), N_c = (N_q - 1) cot phi. The
 * error falls with the square of the lines. */
TEST(prandtl_and_reissner_with_friction) {
  for (int phi = 10; phi <= 40; phi += 15)
    for (int rough = 0; rough < 2; rough++) {
      const double t = tan(phi * DEGREE), r = tan(PI / 4.0 + 0.5 * phi * DEGREE);
      const double Nq = exp(PI * t) * r * r, Nc = (Nq - 1.0) / t;
      strip_footing f = {
          .half_width = 0.5, .friction = phi * DEGREE, .cohesion = 2.0, .rough = rough};
      const double coarse = characteristics_capacity(&f, 15) / 2.0 - Nc;
      const double fine = characteristics_capacity(&f, 30) / 2.0 - Nc;
      assert_true(coarse / fine > 3.8 && coarse / fine < 4.2);
      NEAR((4.0 * fine - coarse) / 3.0, 0.0, 2e-5 * Nc);
      f.cohesion = 0.0, f.surcharge = 5.0;
      const double a = characteristics_capacity(&f, 15), b = characteristics_capacity(&f, 30);
      NEAR((4.0 * b - a) / 3.0, 5.0 * Nq, 1e-4 * Nq);
    }
}

/* Mean pressure over weight times half the width; a trifle of surcharge, which the edge needs. */
static double weight_factor(int phi, bool rough, int lines) {
  const strip_footing f = {.half_width = 0.5,
                           .friction = phi * DEGREE,
                           .weight = 1.0,
                           .surcharge = 1e-4,
                           .rough = rough};
  return 2.0 * characteristics_capacity(&f, lines);
}

/* N_gamma of Martin (2005): at 20 degrees 1.579 and 2.839, at 30 degrees 7.653 and 14.75. Here the
 * ground slides along part of the rough base. */
TEST(published_factors_of_weight) {
  NEAR(weight_factor(20, false, 20), 1.579, 0.005 * 1.579);
  NEAR(weight_factor(20, true, 20), 2.839, 0.005 * 2.839);
  NEAR(weight_factor(30, false, 20), 7.653, 0.005 * 7.653);
  NEAR(weight_factor(30, true, 20), 14.75, 0.0055 * 14.75);
  NEAR(weight_factor(30, false, 40), 7.653, 0.003 * 7.653);
}

/* Cohesion and weight together carry more than apart (Davis and Booker 1971), a rough base more
 * than a smooth one; and only ratios count. */
TEST(cohesion_with_weight) {
  strip_footing f = {
      .half_width = 0.5, .friction = 30.0 * DEGREE, .cohesion = 1e4, .weight = 9810.0};
  const double smooth = characteristics_capacity(&f, 20);
  assert_true(smooth > 30.14 * 1e4 + 7.653 * 0.5 * 9810.0);
  assert_true(smooth < 1.3 * (30.14 * 1e4 + 7.653 * 0.5 * 9810.0));
  f.half_width *= 3.0, f.weight *= 2.0 / 3.0, f.cohesion *= 2.0;
  NEAR(characteristics_capacity(&f, 20), 2.0 * smooth, 1e-6 * smooth);
  f.rough = true;
  const double rough = characteristics_capacity(&f, 20), finer = characteristics_capacity(&f, 30);
  assert_true(rough > 2.0 * smooth);
  NEAR(finer, rough, 2e-3 * rough);
}

/* Strength that grows a little with depth: the mechanisms of constant strength are optimal to the
 * first order, and their work in k z is k B under Hill's (smooth) and 2 k B under Prandtl's
 * (rough). Weight counts no more than without the growth, and a rough base bears more. */
TEST(cohesion_that_grows) {
  for (int rough = 0; rough < 2; rough++) {
    strip_footing f = {.half_width = 0.5, .cohesion = 1.0, .gradient = 0.001, .rough = rough};
    const double slope = (characteristics_capacity(&f, 40) - (2.0 + PI)) / 0.001;
    NEAR(slope, rough ? 2.0 : 1.0, rough ? 0.003 : 0.001);
    f.gradient = 4.0;
    const double coarse = characteristics_capacity(&f, 20), fine = characteristics_capacity(&f, 40);
    NEAR(fine, coarse, 2e-4 * fine);
    f.weight = 10.0;
    NEAR(characteristics_capacity(&f, 40), fine, 1e-6 * fine);
    f.half_width *= 2.0, f.gradient *= 0.5;
    NEAR(characteristics_capacity(&f, 40), fine, 1e-6 * fine);
  }
  strip_footing f = {.half_width = 0.5, .cohesion = 1.0, .gradient = 4.0};
  const double smooth = characteristics_capacity(&f, 20);
  f.rough = true;
  assert_true(characteristics_capacity(&f, 20) > 1.1 * smooth);
}
