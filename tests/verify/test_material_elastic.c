/* test_material_elastic.c - linear elastic, neo-Hookean and fluid laws against closed forms.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#include "material/material_internal.h"

#define E 2.5e6
#define NU 0.3
static const double shear = E / (2.0 * (1.0 + NU)), bulk = E / (3.0 * (1.0 - 2.0 * NU));
static const double lame = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU));

static mps_material *linear_elastic(void) {
  MAKE_KEPT(material, material, create_linear_elastic, context, E, NU);
  return material;
}

TEST(linear_elastic_obeys_hooke) {
  scoped_material *material = linear_elastic();
  mps_material_point point = point_under(material, 0.0);
  const double stretch[9] = {2e-3, 0, 0, 0, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, material, &point, stretch, 2.0, 7));
  NEAR(point.stress[0], (bulk + 4.0 / 3.0 * shear) * 4e-3, 1e-9);
  NEAR(point.stress[1], lame * 4e-3, 1e-9);
  NEAR(point.stress[2], lame * 4e-3, 1e-9);
  NEAR(point.volume_ratio, pow(1.0 + 4e-3 / 7, 7), 1e-14);
  NEAR(point.time, 2.0, 0.0);
  assert_int_equal(point.flags, 0);
  NEAR(mps_material_wave_modulus(material), bulk + 4.0 / 3.0 * shear, 1e-8);
  for (int c = 0; c < 3; c++) { /* one step of each shear: xy zx yz */
    const int row[3] = {0, 2, 1}, column[3] = {1, 0, 2};
    double gradient[9] = {0};
    gradient[3 * row[c] + column[c]] = 1e-3;
    point = point_under(material, 0.0);
    OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
    for (int k = 0; k < 6; k++) NEAR(point.stress[k], k == 3 + c ? shear * 1e-3 : 0.0, 1e-11);
  }
  double ratio = 0.0; /* uniaxial stress: E and nu */
  NEAR(limit_stress(material, 0.0, 1e-3, false, &ratio), E * 1e-3, 1e-7);
  NEAR(ratio, -NU, 1e-10);
}

/* Simple shear with the Jaumann rate: sigma_xy = G sin(gamma), sigma_xx = G (1 - cos(gamma)). */
TEST(linear_elastic_shear_follows_jaumann) {
  scoped_material *material = linear_elastic();
  const double gradient[9] = {0, 1.0, 0, 0, 0, 0, 0, 0, 0}, gamma = 2.5;
  double error[2] = {0};
  for (int i = 0; i < 2; i++) {
    mps_material_point point = point_under(material, 0.0);
    OK(mps_material_point_drive(context, material, &point, gradient, gamma, 1000 << i));
    const double xx = shear * (1.0 - cos(gamma)), exact[6] = {xx, -xx, 0, shear * sin(gamma), 0, 0};
    for (int c = 0; c < 6; c++) error[i] = fmax(error[i], fabs(point.stress[c] - exact[c]) / shear);
  }
  assert_true(error[0] < 1.5 * gamma / 1000.0 && error[0] > 1e-5);
  NEAR(error[0] / error[1], 2.0, 0.01); /* first order, as the paper's update */
}

/* Rotation by the angle |w| about the axis w, applied to a stress. */
static void turned(const double *w, const double *s, double *out) {
  const double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]), c = cos(angle);
  const double n[3] = {w[0] / angle, w[1] / angle, w[2] / angle}, sine = sin(angle);
  const double cross[3][3] = {{0, -n[2], n[1]}, {n[2], 0, -n[0]}, {-n[1], n[0], 0}};
  const double a[3][3] = {{s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}};
  static const int row[6] = {0, 1, 2, 0, 2, 1}, column[6] = {0, 1, 2, 1, 0, 2};
  double r[3][3];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      r[i][j] = (i == j ? c : 0.0) + sine * cross[i][j] + (1.0 - c) * n[i] * n[j];
  for (int k = 0; k < 6; k++) {
    out[k] = 0.0;
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++) out[k] += r[row[k]][i] * a[i][j] * r[column[k]][j];
  }
}

/* A step of spin w turns by 2 atan(w/2): a proper rotation however large the step, and n steps of
 * 2 tan(pi/n) make a full turn. */
TEST(rigid_rotation_keeps_the_stress) {
  scoped_material *material = linear_elastic();
  const double initial[6] = {3.0, -2.0, 0.5, 1.25, -0.75, 2.0};
  for (int64_t n = 5; n <= 5000; n *= 10)
    for (int axis = 0; axis < 4; axis++) {
      double w[3] = {axis == 0, axis == 1, axis == 2};
      if (axis == 3) w[0] = 2.0 / 7.0, w[1] = -3.0 / 7.0, w[2] = 6.0 / 7.0;
      const double rate = 2.0 * tan(PI / (double)n); /* rad a step */
      const double gradient[9] = {
          0, -rate * w[2], rate * w[1], rate * w[2], 0, -rate * w[0], -rate * w[1], rate * w[0], 0};
      mps_material_point point = point_under(material, 0.0);
      memcpy(point.stress, initial, sizeof initial);
      OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
      double expected[6];
      const double turn[3] = {w[0] * 2.0 * PI / (double)n, w[1] * 2.0 * PI / (double)n,
                              w[2] * 2.0 * PI / (double)n};
      turned(turn, initial, expected);
      for (int c = 0; c < 6; c++) NEAR(point.stress[c], expected[c], 1e-14);
      OK(mps_material_point_drive(context, material, &point, gradient, (double)n - 1.0, n - 1));
      for (int c = 0; c < 6; c++) NEAR(point.stress[c], initial[c], 5e-12); /* |s| = 5 */
      NEAR(root_j2(point.stress), root_j2(initial), 5e-12);
    }
}

/* ---- neo-Hookean ----------------------------------------------------------------------------- */

/* W = G/2 (tr B - 3) - G ln J + lambda/4 (J^2 - 1) - lambda/2 ln J, per unit of initial volume. */
static double energy(const double *f) {
  double trace = 0.0;
  for (int c = 0; c < 9; c++) trace += f[c] * f[c];
  const double j = f[0] * (f[4] * f[8] - f[5] * f[7]) + f[1] * (f[5] * f[6] - f[3] * f[8]) +
                   f[2] * (f[3] * f[7] - f[4] * f[6]);
  return 0.5 * shear * (trace - 3.0) - shear * log(j) + 0.25 * lame * (j * j - 1.0) -
         0.5 * lame * log(j);
}

static mps_material *neo_hookean(void) {
  MAKE_KEPT(material, material, create_neo_hookean, context, E, NU);
  return material;
}

TEST(neo_hookean_has_its_closed_forms) {
  scoped_material *material = neo_hookean();
  assert_true(mpsi_material_needs_deformation(material));
  for (double a = 0.5; a < 2.1; a += 0.25) { /* F = a 1, in one step from F = 1 */
    const double swell[9] = {a - 1.0, 0, 0, 0, a - 1.0, 0, 0, 0, a - 1.0}, j = a * a * a;
    mps_material_point point = point_under(material, 77.0); /* the stress comes from F alone */
    OK(mps_material_point_drive(context, material, &point, swell, 1.0, 1));
    const double p = shear / j * (a * a - 1.0) + 0.5 * lame * (j - 1.0 / j);
    for (int c = 0; c < 6; c++) NEAR(point.stress[c], c < 3 ? p : 0.0, 1e-14 * (fabs(p) + E));
    NEAR(point.volume_ratio, j, 1e-14 * j);
  }
  const double slide[9] = {0, 1.5, 0, 0, 0, 0, 0, 0, 0}; /* simple shear: exact in any steps */
  mps_material_point point = point_under(material, 0.0);
  OK(mps_material_point_drive(context, material, &point, slide, 1.0, 100));
  const double exact[6] = {shear * 2.25, 0, 0, shear * 1.5, 0, 0};
  for (int c = 0; c < 6; c++) NEAR(point.stress[c], exact[c], 1e-12 * E);
  /* free uniaxial stretch: the lateral stress vanishes where the closed form says */
  point = point_under(material, 0.0);
  for (int step = 0; step < 100; step++)
    (void)drive_laterally(material, &point, 0.005, 1.0, 0.0, false);
  const double along = point.deformation[8], across = point.deformation[0],
               j = along * across * across;
  NEAR(shear / j * (across * across - 1.0) + 0.5 * lame * (j - 1.0 / j), 0.0, 1e-8 * E);
  NEAR(point.stress[2], shear / j * (along * along - across * across), 1e-8 * E);
}

/* The power of the stress is the rate of the energy: dW = J sigma:L dt, by an eighth-order
 * difference along random L from random F. */
TEST(neo_hookean_stress_is_the_derivative_of_its_energy) {
  static const double weight[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  static const int place[9] = {0, 3, 4, 3, 1, 5, 4, 5, 2};
  scoped_material *material = neo_hookean();
  uint64_t seed = 5;
  for (int trial = 0; trial < 20; trial++) {
    double gradient[9], rate = 0.0, power = 0.0;
    for (int c = 0; c < 9; c++) gradient[c] = 0.3 * noise(&seed);
    mps_material_point point = point_under(material, 0.0);
    OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 3));
    for (int c = 0; c < 9; c++) {
      gradient[c] = noise(&seed);
      power += point.volume_ratio * point.stress[place[c]] * gradient[c];
    }
    for (int k = -4; k <= 4; k++) {
      double f[9];
      for (int c = 0; c < 9; c++) {
        f[c] = point.deformation[c];
        for (int m = 0; m < 3; m++)
          f[c] += 0.01 * k * gradient[c / 3 * 3 + m] * point.deformation[3 * m + c % 3];
      }
      if (k != 0) rate += (k > 0 ? 1 : -1) * weight[abs(k) - 1] * energy(f) / 0.01;
    }
    NEAR(power, rate, 1e-8 * E);
  }
}

/* The bound on the wave modulus holds for every direction, and is attained by some. */
TEST(neo_hookean_wave_modulus_bounds_every_direction) {
  scoped_material *material = neo_hookean();
  uint64_t seed = 11;
  assert_true(mpsi_material_stiffens(material));
  for (int trial = 0; trial < 20; trial++) {
    mps_material_point point = point_under(material, 0.0);
    double gradient[9], modulus = 0.0, largest = 0.0;
    for (int c = 0; c < 9; c++) gradient[c] = 0.4 * noise(&seed) * (trial > 0);
    OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
    mps_material_block block = {.dim = 3, .count = 1, .volume_ratio = &point.volume_ratio};
    for (int c = 0; c < 9; c++) block.deformation[c] = &point.deformation[c];
    mpsi_material_wave_moduli(material, &block, &modulus);
    for (int k = 0; k < 4000; k++) {
      double n[3] = {noise(&seed), noise(&seed), noise(&seed)}, s[2] = {0};
      const double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]), h = 1e-5;
      for (int sign = 0; sign < 2; sign++) { /* d sigma_nn for a gradient n n */
        mps_material_point moved = point;
        for (int c = 0; c < 9; c++)
          gradient[c] = (sign ? h : -h) * n[c / 3] * n[c % 3] / (length * length);
        OK(mps_material_point_drive(context, material, &moved, gradient, 1.0, 1));
        for (int i = 0; i < 3; i++)
          s[sign] += moved.stress[i] * n[i] * n[i] +
                     2.0 * moved.stress[3 + i] * n[i == 2] * n[i == 0 ? 1 : 2];
        s[sign] /= length * length;
      }
      largest = fmax(largest, (s[1] - s[0]) / (2.0 * h));
    }
    assert_true(largest <= modulus * (1.0 + 1e-8));
    if (trial == 0) NEAR(largest, modulus, 1e-7 * modulus);
    assert_true(largest >= 0.8 * modulus);
  }
}

/* ---- fluid ----------------------------------------------------------------------------------- */

static mps_material *fluid(int32_t state_equation, double viscosity, int32_t no_tension) {
  DEF(material_newtonian, def, .bulk_modulus = 2e6, .state = state_equation, .viscosity = viscosity,
      .no_tension = no_tension);
  MAKE_KEPT(material, material, create_newtonian, context, &def);
  return material;
}

TEST(fluid_pressure_follows_its_state_equation) {
  for (int tait = 0; tait < 2; tait++) {
    mps_material *material =
        fluid(tait ? MPS_MATERIAL_STATE_EQUATION_TAIT : MPS_MATERIAL_STATE_EQUATION_LINEAR, 0.0, 0);
    for (double j = 0.9; j < 1.06; j += 0.05) {
      mps_material_point point = point_under(material, 0.0);
      const double squeeze[9] = {j - 1.0, 0, 0, 0, 0, 0, 0, 0, 0};
      OK(mps_material_point_drive(context, material, &point, squeeze, 1.0, 1));
      const double p = tait ? 2e6 / 7.0 * (pow(j, -7.0) - 1.0) : 2e6 * (1.0 / j - 1.0);
      for (int c = 0; c < 6; c++) NEAR(point.stress[c], c < 3 ? -p : 0.0, 1e-9);
      NEAR(point.volume_ratio, j, 1e-15);
      double modulus = 0.0; /* -J dp/dJ */
      const mps_material_block block = {.dim = 3, .count = 1, .volume_ratio = &point.volume_ratio};
      mpsi_material_wave_moduli(material, &block, &modulus);
      NEAR(modulus, tait ? 2e6 * pow(j, -7.0) : 2e6 / j, 1e-8);
    }
    NEAR(mps_material_wave_modulus(material), 2e6, 0.0);
    mps_material_destroy(&material);
  }
}

TEST(fluid_shear_stress_is_viscosity_times_rate) {
  scoped_material *material = fluid(MPS_MATERIAL_STATE_EQUATION_LINEAR, 0.25, 0);
  mps_material_point point = point_under(material, 0.0);
  const double rate[9] = {1.0, 4.0, 0, 2.0, -2.0, 0, 0, 1.0, 1.0}; /* tr = 0 */
  OK(mps_material_point_drive(context, material, &point, rate, 1e-3, 4));
  const double exact[6] = {0.5, -1.0, 0.5, 0.25 * 6.0, 0.0, 0.25};
  for (int c = 0; c < 6; c++) NEAR(point.stress[c], exact[c], 1e-9);
  NEAR(mpsi_material_viscosity(material), 0.25, 0.0);
}

TEST(fluid_without_tension_opens_and_closes) {
  scoped_material *material = fluid(MPS_MATERIAL_STATE_EQUATION_TAIT, 0.0, 1);
  mps_material_point point = point_under(material, 0.0);
  const double open[9] = {0.5, 0, 0, 0, 0, 0, 0, 0, 0.2},
               close[9] = {-0.01, 0, 0, 0, 0, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, material, &point, open, 1.0, 50));
  for (int c = 0; c < 6; c++) NEAR(point.stress[c], 0.0, 0.0);
  NEAR(point.volume_ratio, 1.0, 0.0);
  assert_int_equal(point.flags, MPS_MATERIAL_FLAG_APEX);
  OK(mps_material_point_drive(context, material, &point, close, 1.0, 1));
  NEAR(point.stress[0], -2e6 / 7.0 * (pow(0.99, -7.0) - 1.0), 1e-9);
  assert_int_equal(point.flags, 0);
}
