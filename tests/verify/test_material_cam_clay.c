/* test_material_cam_clay.c - modified Cam-Clay at a point against an independent integration of its
 * rate equations (Jaumann rate, eighth order, to 1e-11), which agrees with the closed forms to six
 * digits, and against the closed forms themselves: within 0.1 % in 1000 steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "clay_points.h"

#define STEPS 1000
#define BAR 1e-3

static mps_material_point after(const clay *c, const double gradient[9], int64_t steps) {
  scoped_material *m = make_clay(c);
  mps_material_point x = point_under(m, -c->p0);
  OK(mps_material_point_drive(context, m, &x, gradient, 1.0, steps));
  return x;
}

static void near(const char *what, double value, double expected) {
  if (!(fabs(value / expected - 1.0) <= BAR))
    print_error("%s: %.9g instead of %.9g\n", what, value, expected);
  NEAR(value / expected, 1.0, BAR);
}

TEST(isotropic_compression) {
  static const double strain[2] = {0.02, 0.1};
  static const double p[2][2] = {{126.089e3, 304.682e3}, {216.477e3, 840.490e3}};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 2; i++) {
      const double L = -strain[i] / 3.0;
      const mps_material_point x = after(&clays[k], (double[9]){L, 0, 0, 0, L, 0, 0, 0, L}, STEPS);
      near("p", clay_p(&x), p[k][i]);
      NEAR(x.volume_ratio, exp(-strain[i]), 1e-9);
      NEAR(1.0 + x.history[CLAY_VOID], (1.0 + clays[k].e0) * x.volume_ratio, 1e-12);
      assert_true(fabs(x.history[CLAY_PC] / clay_p(&x) - 1.0) < 1e-9);
    }
}

TEST(oedometer) {
  static const double strain[2] = {0.02, 0.1};
  static const double expected[2][2][3] = {
      {{139.726e3, 105.260e3, 128.770e3}, {337.773e3, 252.643e3, 311.489e3}},
      {{254.037e3, 153.958e3, 224.450e3}, {984.964e3, 630.047e3, 865.245e3}}};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 2; i++) {
      const mps_material_point x =
          after(&clays[k], (double[9]){0, 0, 0, 0, 0, 0, 0, 0, -strain[i]}, STEPS);
      near("vertical stress", -x.stress[2], expected[k][i][0]);
      near("horizontal stress", -x.stress[0], expected[k][i][1]);
      near("pc", x.history[CLAY_PC], expected[k][i][2]);
    }
}

TEST(normal_k0_is_that_of_long_compression) {
  static const double k0[2] = {0.74797, 0.63966};
  for (int k = 0; k < 2; k++) {
    scoped_material *m = make_clay(&clays[k]);
    NEAR(mps_material_normal_k0(m), k0[k], 1e-5);
    mps_material_point x = point_under(m, -clays[k].p0);
    const double squeeze[9] = {0, 0, 0, 0, 0, 0, 0, 0, -0.35};
    OK(mps_material_point_drive(context, m, &x, squeeze, 1.0, 20000));
    NEAR(x.stress[0] / x.stress[2], k0[k], 2e-3);
  }
  assert_true(isnan(mps_material_normal_k0(NULL)));
}

static const double cu_strain[5] = {0.005, 0.01, 0.02, 0.05, 0.2};
static const double cu[2][5][3] = {{{88.486e3, 33.421e3, 103.400e3},
                                    {77.742e3, 43.969e3, 107.123e3},
                                    {67.056e3, 50.247e3, 111.541e3},
                                    {59.198e3, 53.069e3, 115.406e3},
                                    {58.021e3, 53.379e3, 116.041e3}},
                                   {{50e3, 50.625e3, 200e3},
                                    {50e3, 101.250e3, 200e3},
                                    {72.574e3, 107.042e3, 182.212e3},
                                    {86.756e3, 104.555e3, 174.260e3},
                                    {87.055e3, 104.466e3, 174.110e3}}};

static mps_material_point undrained(const clay *c, double strain, int64_t steps) {
  return after(c, (double[9]){0.5 * strain, 0, 0, 0, 0.5 * strain, 0, 0, 0, -strain}, steps);
}

TEST(undrained_triaxial_compression) {
  static const double u[2] = {49.693e3, 13.107e3};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 5; i++) {
      const mps_material_point x = undrained(&clays[k], cu_strain[i], STEPS);
      near("p", clay_p(&x), cu[k][i][0]);
      near("q", clay_q(&x), cu[k][i][1]);
      near("pc", x.history[CLAY_PC], cu[k][i][2]);
      if (i == 2) /* a small difference of large pressures */
        NEAR(clays[k].p0 + clay_q(&x) / 3.0 - clay_p(&x), u[k], BAR * clays[k].p0);
    }
}

/* p = p0 (R M^2/(M^2 + eta^2))^Lambda after the first yield, at whatever step; su at the end. */
TEST(undrained_path_in_closed_form) {
  static const double su[2] = {26.689e3, 52.233e3};
  for (int k = 0; k < 2; k++) {
    const clay *c = &clays[k];
    const double power = 1.0 - c->kappa / c->lambda;
    for (int i = 2; i < 5; i++) {
      const mps_material_point x = undrained(c, cu_strain[i], 20);
      const double eta = clay_q(&x) / clay_p(&x), m2 = c->M * c->M;
      near("p", clay_p(&x), c->p0 * pow(c->R * m2 / (m2 + eta * eta), power));
    }
    const mps_material_point x = undrained(c, 0.6, STEPS);
    near("su", 0.5 * clay_q(&x), 0.5 * c->M * c->p0 * pow(0.5 * c->R, power));
    near("su", 0.5 * clay_q(&x), su[k]);
  }
}

TEST(step_error_is_of_first_order) {
  for (int k = 0; k < 2; k++) {
    double error[3];
    int64_t steps = 10;
    for (int i = 0; i < 3; i++, steps *= 10) {
      const mps_material_point x = undrained(&clays[k], 0.02, steps);
      error[i] = fabs(clay_p(&x) / cu[k][2][0] - 1.0);
    }
    assert_true(error[0] < 0.025 && error[1] < 0.0025 && error[2] < 0.00025);
  }
}

TEST(simple_shear) {
  static const double gamma[3] = {0.02, 0.1, 1.0};
  static const double expected[2][3][3] = {{{26.354e3, -75.167e3, -75.576e3},
                                            {30.708e3, -58.253e3, -59.214e3},
                                            {30.814e3, -57.520e3, -58.521e3}},
                                           {{60.639e3, -52.975e3, -54.175e3},
                                            {60.329e3, -86.327e3, -87.573e3},
                                            {60.310e3, -86.436e3, -87.674e3}}};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 3; i++) {
      const mps_material_point x =
          after(&clays[k], (double[9]){0, gamma[i], 0, 0, 0, 0, 0, 0, 0}, STEPS);
      near("shear stress", x.stress[3], expected[k][i][0]);
      near("xx", x.stress[0], expected[k][i][1]);
      near("yy", x.stress[1], expected[k][i][2]);
    }
}

/* Drained: lateral stress stays, the axial strain grows. */
static mps_material_point drained(const clay *c, double strain, int64_t steps) {
  scoped_material *m = make_clay(c);
  mps_material_point x = point_under(m, -c->p0);
  const double gradient[9] = {0, 0, 0, 0, 0, 0, 0, 0, -strain}, target[6] = {-c->p0, -c->p0};
  OK(mps_material_point_control(context, m, &x, gradient,
                                MPS_MATERIAL_POINT_XX | MPS_MATERIAL_POINT_YY, target, 1.0, steps,
                                NULL));
  return x;
}

TEST(drained_triaxial_compression) {
  static const double strain[2] = {0.02, 0.1};
  static const double q[2][2] = {{39.892e3, 90.0e3}, {116.582e3, 104.381e3}};
  static const double volume[2][2] = {{0.020033, 0.053939}, {0.005296, -0.000314}};
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < 2; i++) {
      const mps_material_point x = drained(&clays[k], strain[i], STEPS);
      near("q", clay_q(&x), q[k][i]);
      NEAR(-log(x.volume_ratio), volume[k][i], 3e-5);
      NEAR(clay_q(&x) / (3.0 * (clay_p(&x) - clays[k].p0)), 1.0, 1e-6);
    }
}

TEST(drained_critical_state) {
  static const double expected[2][3] = {{144.231e3, 132.692e3, 2.21332},
                                        {83.333e3, 100e3, 1.80437}};
  for (int k = 0; k < 2; k++) {
    const clay *c = &clays[k];
    const mps_material_point x = drained(c, 2.0, 4000);
    near("p", clay_p(&x), 3.0 * c->p0 / (3.0 - c->M));
    near("p", clay_p(&x), expected[k][0]);
    near("q", clay_q(&x), expected[k][1]);
    near("v", 1.0 + x.history[CLAY_VOID], expected[k][2]);
  }
}

/* Plane strain without drainage: su is 2/sqrt(3) of the triaxial one. */
TEST(plane_strain_strength) {
  static const double su[2] = {30.818e3, 60.313e3};
  for (int k = 0; k < 2; k++) {
    const mps_material_point x =
        after(&clays[k], (double[9]){0.5, 0, 0, 0, -0.5, 0, 0, 0, 0}, 4000);
    near("su", 0.5 * (x.stress[0] - x.stress[1]), su[k]);
  }
}

/* With the Lode option the critical q/p in extension is (3 - sin phi)/(3 + sin phi) of that in
 * compression, which stays M: Mohr and Coulomb's angle in both. */
TEST(lode_option) {
  for (int k = 0; k < 2; k++) {
    mps_material_cam_clay_def def = clay_def(&clays[k]);
    def.lode = 1;
    MAKE(material, m, create_cam_clay, context, &def);
    double slope[2];
    for (int extension = 0; extension < 2; extension++) {
      mps_material_point x = point_under(m, -clays[k].p0);
      const double e = extension ? -0.6 : 0.6;
      const double gradient[9] = {0.5 * e, 0, 0, 0, 0.5 * e, 0, 0, 0, -e};
      OK(mps_material_point_drive(context, m, &x, gradient, 1.0, 2000));
      slope[extension] = clay_q(&x) / clay_p(&x);
    }
    const double M = clays[k].M, sine = 3.0 * M / (6.0 + M);
    near("compression", slope[0], M);
    near("extension", slope[1], 6.0 * sine / (3.0 + sine));
  }
}

/* With a constant G the elastic part of an undrained path is q = 3 G eps. */
TEST(constant_shear_modulus) {
  mps_material_cam_clay_def def = clay_def(&clays[1]);
  def.shear_modulus = 2e6;
  MAKE(material, m, create_cam_clay, context, &def);
  mps_material_point x = point_under(m, -clays[1].p0);
  const double gradient[9] = {0.0025, 0, 0, 0, 0.0025, 0, 0, 0, -0.005};
  OK(mps_material_point_drive(context, m, &x, gradient, 1.0, 50));
  NEAR(clay_q(&x), 3.0 * 2e6 * 0.005, 1e-6);
  NEAR(clay_p(&x), 50e3, 1e-6);
}
