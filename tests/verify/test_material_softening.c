/* test_material_softening.c - softening and rate dependence of von Mises, Tresca and Mohr-Coulomb
 * at a point against their curves in closed form: at any step, as the return takes the strength at
 * the end of it. What is refused. SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#define YOUNG 2.6e6 /* G = 1 MPa */
#define SU 10e3

static mps_material_von_mises_def mises(void) {
  DEF(material_von_mises, d, .young = YOUNG, .yield_stress = ROOT3 * SU, .residual = 0.3,
      .slip = 0.02, .band = 0.1);
  return d;
}

static mps_material_mohr_coulomb_def coulomb(double phi, double c) {
  DEF(material_mohr_coulomb, d, .young = YOUNG, .friction = phi, .cohesion = c, .slip = 0.02,
      .band = 0.1);
  return d;
}

static mps_material *make_mises(const mps_material_von_mises_def *d) {
  MAKE_KEPT(material, m, create_von_mises, context, d);
  return m;
}

static mps_material *make_coulomb(const mps_material_mohr_coulomb_def *d) {
  MAKE_KEPT(material, m, create_mohr_coulomb, context, d);
  return m;
}

/* su of von Mises at the engineering shear strain gamma: gamma = su/G + plastic. */
static double exponential(double gamma, double residual) {
  double su = SU;
  for (int i = 0; i < 200; i++) {
    const double plastic = gamma - su / 1e6;
    su = SU * (residual + (1.0 - residual) * exp(-plastic * 0.1 / 0.02));
  }
  return su;
}

/* Pure shear exx = -eyy has no rotation: su is half of the difference of the stresses. */
static double sheared(const mps_material *m, double gamma, int64_t steps, double p) {
  mps_material_point x = point_under(m, -p);
  const double L[9] = {0.5 * gamma, 0, 0, 0, -0.5 * gamma, 0, 0, 0, 0};
  OK(mps_material_point_drive(context, m, &x, L, 1.0, steps));
  return 0.5 * (x.stress[0] - x.stress[1]);
}

TEST(von_mises_follows_its_curve) {
  const mps_material_von_mises_def d = mises();
  scoped_material *m = make_mises(&d);
  static const int64_t steps[3] = {1, 7, 300};
  for (int k = 0; k < 3; k++)
    for (double gamma = 0.02; gamma < 1.0; gamma *= 2.0)
      NEAR(sheared(m, gamma, steps[k], 20e3) / exponential(gamma, 0.3), 1.0, 1e-10);
  NEAR(sheared(m, 0.005, 1, 20e3), 5e3, 1e-6); /* elastic */
}

/* The 3D loop and the two of the plane agree. */
TEST(plane_strain_is_space) {
  const mps_material_von_mises_def d = mises();
  scoped_material *m = make_mises(&d);
  double L[9] = {0.1, 0.3, 0, 0.2, -0.2, 0, 0, 0, 0}, s[2][6] = {{0.0}}, V = 1.0, strain[2] = {0.0};
  int64_t flags = 0;
  for (int g = 0; g < 2; g++) {
    mps_material_block b = mps_material_block_defaults();
    double *history[1] = {&strain[g]};
    b.dim = g ? 3 : 2, b.count = 1, b.dt = 0.1;
    for (int c = 0; c < 9; c++)
      if (g || c == 0 || c == 1 || c == 3 || c == 4) b.gradient[c] = &L[c];
    for (int c = 0; c < 2 * b.dim; c++) b.stress[c] = &s[g][c];
    b.history = history, b.history_count = 1, b.volume_ratio = &V, b.flags = &flags;
    for (int i = 0; i < 5; i++) OK(mps_material_update(context, m, &b));
    assert_true(flags == MPS_MATERIAL_FLAG_PLASTIC);
  }
  for (int c = 0; c < 4; c++) NEAR(s[0][c] / SU, s[1][c] / SU, 1e-9);
  NEAR(strain[0], strain[1], 1e-12);
}

/* Tresca: the largest shear stress is su; the plastic strain of plane shear is gamma/sqrt(3). */
TEST(tresca_follows_its_curve) {
  mps_material_mohr_coulomb_def d = coulomb(0.0, SU);
  d.residual_cohesion = 0.3 * SU;
  scoped_material *m = make_coulomb(&d);
  for (double gamma = 0.02; gamma < 1.0; gamma *= 2.0) {
    NEAR(sheared(m, gamma, 1, 20e3) / exponential(gamma, 0.3), 1.0, 1e-9);
    NEAR(sheared(m, gamma, 20, 20e3) / exponential(gamma, 0.3), 1.0, 1e-9);
  }
  mps_material_destroy(&m);
  d.softening = MPS_MATERIAL_SOFTENING_LINEAR; /* over at gamma_p = 0.2 */
  m = make_coulomb(&d);
  const double half = (SU - 35e3 * 0.1) / (1.0 - 35e3 / 1e6); /* su = SU - 35e3 (gamma - su/G) */
  NEAR(sheared(m, 0.1, 10, 20e3) / half, 1.0, 1e-9);
  NEAR(sheared(m, 0.3, 10, 20e3), 0.3 * SU, 1e-6);
}

/* Triaxial compression at the lateral stress s: Kp s + 2 c sqrt(Kp) of the first angle at the peak,
 * of the last one at large strain; then nothing dilates. */
TEST(mohr_coulomb_goes_from_peak_to_residual) {
  const double peak = PI / 5.0, last = PI / 7.0, s = 50e3;
  mps_material_mohr_coulomb_def d = coulomb(peak, 5e3);
  d.young = 50e6;
  d.dilation = PI / 15.0;
  d.residual_friction = last;
  d.residual_cohesion = 0.0;
  scoped_material *m = make_coulomb(&d);
  mps_material_point x = point_under(m, -s);
  const double kp = (1.0 + sin(peak)) / (1.0 - sin(peak)),
               kr = (1.0 + sin(last)) / (1.0 - sin(last));
  double largest = 0.0, dilation = 0.0, late = 0.0;
  for (int i = 0; i < 3000; i++) {
    const double lateral = drive_laterally(m, &x, -1e-3, 1.0, -s, false);
    largest = fmax(largest, -x.stress[2]);
    if (i == 5) dilation = (2.0 * lateral - 1e-3) / 1e-3;
    late = (2.0 * lateral - 1e-3) / 1e-3;
  }
  NEAR(largest / (kp * s + 2.0 * 5e3 * sqrt(kp)), 1.0, 0.01);
  NEAR(-x.stress[2] / (kr * s), 1.0, 1e-4);
  assert_true(dilation > 0.2);
  NEAR(late, 0.0, 1e-3);
}

/* 1 + mu log10(rate/reference); the rate is the difference of the principal strain rates. */
TEST(strength_grows_with_the_rate) {
  static const double rates[4] = {1e-7, 3e-6, 3e-4, 30.0}, factors[4] = {1.0, 1.0, 1.2, 1.7};
  mps_material_von_mises_def d = mises();
  d.residual = 1.0;
  d.rate_factor = 0.1;
  mps_material *m[2] = {make_mises(&d), NULL};
  mps_material_mohr_coulomb_def e = coulomb(0.0, SU);
  e.rate_factor = 0.1;
  m[1] = make_coulomb(&e);
  for (int law = 0; law < 2; law++)
    for (int k = 0; k < 4; k++) {
      mps_material_point x = point_under(m[law], 0.0);
      const double r = rates[k], L[9] = {0.5 * r, 0, 0, 0, -0.5 * r, 0, 0, 0, 0};
      OK(mps_material_point_drive(context, m[law], &x, L, 0.1 / r, 10));
      NEAR(0.5 * (x.stress[0] - x.stress[1]) / SU, factors[k], 1e-9);
    }
  for (int law = 0; law < 2; law++) mps_material_destroy(&m[law]);
}

/* What the tables of the definitions do not say. */
TEST(bad_softening_is_refused) {
  mps_material *m = NULL;
  mps_material_von_mises_def d[3] = {mises(), mises(), mises()};
  d[0].slip = NAN, d[1].band = NAN, d[2].slip = 1e-4;
  REFUSES(mps_material_create_von_mises(context, &d[0], &m), "slip is ");
  REFUSES(mps_material_create_von_mises(context, &d[1], &m), "band is ");
  REFUSES(mps_material_create_von_mises(context, &d[2], &m), "slip is 0.0001 m, must be above");
  mps_material_mohr_coulomb_def pyramid = coulomb(0.5, 1e3);
  pyramid.residual_cohesion = pyramid.residual_friction = 0.0;
  REFUSES(mps_material_create_mohr_coulomb(context, &pyramid, &m), "residual_");
  pyramid = coulomb(0.5, 1e3);
  pyramid.residual_cohesion = 500.0, pyramid.slip = NAN;
  REFUSES(mps_material_create_mohr_coulomb(context, &pyramid, &m), "slip is ");
}
