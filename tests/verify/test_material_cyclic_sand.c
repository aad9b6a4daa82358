/* test_material_cyclic_sand.c - cyclic sand at a point: its contraction against the recursions of
 * Byrne (1991) and of Martin, Finn and Seed (1975), drained, in one dimension and at constant
 * volume; half cycles in any direction, with any step, in turning axes and under small ripples;
 * grains without contact; refusals. SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#define YOUNG 60e6
#define POISSON 0.3
#define G (YOUNG / (2.0 * (1.0 + POISSON)))
#define K (YOUNG / (3.0 * (1.0 - 2.0 * POISSON)))
#define NORMALS (MPS_MATERIAL_POINT_XX | MPS_MATERIAL_POINT_YY | MPS_MATERIAL_POINT_ZZ)

enum { CONTRACTION = 2, HALVES = 4 };

static mps_material_cyclic_sand_def sand(void) {
  DEF(material_cyclic_sand, def, .young = YOUNG, .poisson = POISSON, .friction = 0.6,
      .threshold = 0.0);
  return def;
}

static mps_material *make(const mps_material_cyclic_sand_def *def) {
  MAKE_KEPT(material, m, create_cyclic_sand, context, def);
  return m;
}

/* gamma_xy by `change`; the stresses in `controlled` stay. */
static void shear(const mps_material *m, mps_material_point *x, double change, uint32_t controlled,
                  int64_t steps) {
  const double gradient[9] = {0, 0.5 * change, 0, 0.5 * change, 0, 0, 0, 0, 0};
  double target[6];
  for (int c = 0; c < 6; c++) target[c] = x->stress[c];
  OK(mps_material_point_control(context, m, x, gradient, controlled, target, 1.0, steps, NULL));
}

/* To +g, then loops; ends after `halves` half cycles at an end of the range. */
static void cycles(const mps_material *m, mps_material_point *x, double g, int halves,
                   uint32_t controlled, int64_t steps) {
  shear(m, x, g, controlled, steps / 2);
  for (int n = 1; n < halves; n++) shear(m, x, n % 2 ? -2.0 * g : 2.0 * g, controlled, steps);
}

/* The recursions, written for percent as they were published: strain per cycle, half of it for half
 * a cycle; the first half cycle goes from the middle to one side, with half the range. */
static double recursion(const double *c, double g, int halves) {
  double e = 0.0;
  for (int n = 0; n < halves; n++) {
    const double a = 100.0 * (n == 0 ? 0.5 * g : g);
    const double cycle = c[2] > 0.0 ? c[0] * (a - c[1] * e) + c[2] * e * e / (a + c[3] * e)
                                    : a * c[0] * exp(-c[1] * e / a);
    e += 0.5 * fmax(cycle, 0.0);
  }
  return 0.01 * e;
}

/* ---- drained --------------------------------------------------------------------------------- */

/* Under equal stresses that stay, all change of volume is contraction. */
TEST(drained_cycles_sum_to_the_recursion) {
  static const double martin[4] = {0.80, 0.79, 0.45, 0.73}, gammas[3] = {1e-3, 2e-3, 3e-3};
  const double dense = 7600.0 * pow(45.0, -2.5), blows = 8.7 * pow(12.0, -1.25);
  for (int form = 0; form < 3; form++) {
    mps_material_cyclic_sand_def def = sand();
    const double byrne = form == 1 ? dense : blows;
    const double other[4] = {byrne, 0.4 / byrne, 0.0, 0.0};
    const double *c = form == 0 ? martin : other;
    if (form == 0) def.c1 = c[0], def.c2 = c[1], def.c3 = c[2], def.c4 = c[3];
    if (form == 1) def.relative_density = 0.45;
    if (form == 2) def.blow_count = 12.0;
    scoped_material *m = make(&def);
    for (int g = 0; g < 3; g++)
      for (int halves = 1; halves <= 61; halves += halves == 1 ? 2 : halves == 3 ? 18 : 40) {
        mps_material_point x = point_under(m, -300e3);
        cycles(m, &x, gammas[g], halves, NORMALS, 40);
        const double wanted = recursion(c, gammas[g], halves);
        NEAR(x.history[CONTRACTION] / wanted, 1.0, 1e-9);
        NEAR(log(x.volume_ratio) / -wanted, 1.0, 1e-3);
        assert_int_equal((int)x.history[HALVES], halves - 1); /* the last has not turned */
        print_message("form %d, gamma %g %%, %g cycles: %.4f %%\n", form, 100.0 * gammas[g],
                      0.5 * halves, 100.0 * x.history[CONTRACTION]);
      }
  }
}

/* At K0 = nu/(1 - nu) the vertical strain under a constant vertical stress is the contraction, and
 * the horizontal stress stays too. */
TEST(one_dimensional_settlement_is_the_contraction) {
  const double k0 = POISSON / (1.0 - POISSON);
  mps_material_cyclic_sand_def def = sand();
  def.relative_density = 0.5;
  scoped_material *m = make(&def);
  mps_material_point x = point_under(m, 0.0);
  x.stress[0] = x.stress[2] = -k0 * 200e3, x.stress[1] = -200e3;
  cycles(m, &x, 1e-3, 21, MPS_MATERIAL_POINT_YY, 400);
  const double wanted = recursion(
      (double[4]){7600.0 * pow(50.0, -2.5), 0.4 / (7600.0 * pow(50.0, -2.5)), 0.0, 0.0}, 1e-3, 21);
  NEAR(x.history[CONTRACTION] / wanted, 1.0, 2e-3); /* the vertical strain shears too */
  NEAR(log(x.volume_ratio) / -x.history[CONTRACTION], 1.0, 1e-3);
  NEAR(x.stress[0] / (-k0 * 200e3), 1.0, 1e-3);
}

/* ---- at constant volume ---------------------------------------------------------------------- */

/* The vertical effective stress falls by the modulus of one-dimensional rebound times the
 * contraction, ratios of stresses stay, and it ends at 0. */
TEST(at_constant_volume_stresses_fall) {
  const double k0 = POISSON / (1.0 - POISSON), first = 100e3, rebound = K + 4.0 / 3.0 * G;
  mps_material_cyclic_sand_def def = sand();
  def.relative_density = 0.54, def.friction = 1.2; /* far from yield */
  const double c1 = 7600.0 * pow(54.0, -2.5), c[4] = {c1, 0.4 / c1, 0.0, 0.0};
  scoped_material *m = make(&def);
  mps_material_point x = point_under(m, 0.0);
  x.stress[0] = x.stress[2] = -k0 * first, x.stress[1] = -first;
  int halves = 0;
  shear(m, &x, 6e-4, 0, 50);
  for (halves = 1; x.stress[1] < -1.0 && halves < 400; halves++) {
    const double wanted = first - rebound * recursion(c, 6e-4, halves);
    NEAR(-x.stress[1] / fmax(wanted, 1e-9), 1.0, 1e-6);
    NEAR(x.stress[0] / x.stress[1], k0, 1e-9);
    if (wanted < 0.3 * first) break;
    shear(m, &x, halves % 2 ? -12e-4 : 12e-4, 0, 100);
  }
  print_message("70 %% of the vertical stress gone after %g cycles\n", 0.5 * halves);
  assert_in_range(halves, 3, 100);
  for (int n = 0; n < 400; n++, halves++) shear(m, &x, halves % 2 ? -12e-4 : 12e-4, 0, 20);
  NEAR(mean_stress(x.stress) / first, 0.0, 1e-3);
  assert_true(mean_stress(x.stress) <= 1e-6);
  const double before = x.history[CONTRACTION]; /* grains without contact */
  cycles(m, &x, 6e-4, 4, 0, 20);
  NEAR(x.history[CONTRACTION], before, 1e-3 * before);
}

/* ---- counting -------------------------------------------------------------------------------- */

/* Small ripples on a swing turn nothing; a threshold leaves small amplitudes without effect. */
TEST(ripples_and_small_swings_do_not_count) {
  mps_material_cyclic_sand_def def = sand();
  def.relative_density = 0.5, def.threshold = 1e-4;
  scoped_material *m = make(&def);
  mps_material_point plain = point_under(m, -300e3), rippled = plain, small = plain;
  shear(m, &plain, 2.1e-3, NORMALS, 10);
  shear(m, &plain, -4.1e-3, NORMALS, 10);
  for (int n = 0; n < 20; n++) {
    shear(m, &rippled, 2e-4, NORMALS, 4);
    shear(m, &rippled, -1e-4, NORMALS, 4);
  }
  shear(m, &rippled, -4e-3, NORMALS, 10);
  NEAR(rippled.history[CONTRACTION] / plain.history[CONTRACTION], 1.0, 1e-9);
  assert_int_equal((int)rippled.history[HALVES], 1);
  cycles(m, &small, 0.99e-4, 100, NORMALS, 10);
  assert_true(small.history[CONTRACTION] == 0.0 && small.history[HALVES] == 0.0);
  small = point_under(m, -300e3);
  cycles(m, &small, 1.5e-4, 11, NORMALS, 10); /* half of all */
  const double c1 = 7600.0 * pow(50.0, -2.5);
  double e = 0.0; /* half of it at one and a half thresholds; the first swing has a smaller one */
  for (int n = 1; n < 11; n++) e += 0.25 * c1 * 1.5e-4 * exp(-0.4 / c1 * e / 1.5e-4);
  NEAR(small.history[CONTRACTION] / e, 1.0, 1e-9);
}

/* Triaxial cycles of the same gamma = 2 sqrt(J2), a swing that two steps make, and one in axes that
 * have turned by a right angle. */
TEST(any_direction_and_any_step) {
  mps_material_cyclic_sand_def def = sand();
  def.relative_density = 0.5;
  scoped_material *m = make(&def);
  mps_material_point simple = point_under(m, -300e3), triaxial = simple, coarse = simple,
                     turned = simple;
  const double axial = 2e-3 / ROOT3;
  static const double sign[4] = {1.0, -2.0, 2.0, -2.0};
  cycles(m, &simple, 2e-3, 4, 0, 200);
  cycles(m, &coarse, 2e-3, 4, 0, 2);
  for (int n = 0; n < 4; n++) {
    const double e = sign[n] * axial, stretch[9] = {-0.5 * e, 0, 0, 0, -0.5 * e, 0, 0, 0, e};
    OK(mps_material_point_drive(context, m, &triaxial, stretch, 1.0, 100));
  }
  const double quarter[9] = {0, 0.5 * PI, 0, -0.5 * PI, 0, 0, 0, 0, 0};
  shear(m, &turned, 2e-3, 0, 100);
  const double kept = turned.history[CONTRACTION];
  OK(mps_material_point_drive(context, m, &turned, quarter, 1.0, 2000));
  NEAR(turned.history[CONTRACTION], kept, 1e-12);
  for (int n = 1; n < 4; n++) shear(m, &turned, n % 2 ? 4e-3 : -4e-3, 0, 200);
  const double wanted = simple.history[CONTRACTION];
  NEAR(triaxial.history[CONTRACTION] / wanted, 1.0, 1e-9);
  NEAR(coarse.history[CONTRACTION] / wanted, 1.0, 1e-9);
  NEAR(turned.history[CONTRACTION] / wanted, 1.0, 1e-5);
}
