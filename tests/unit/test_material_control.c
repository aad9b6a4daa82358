/* test_material_control.c - a point under given stresses: linear elasticity in closed form, edges
 * of a pyramid, what is refused, and that a refusal leaves the point.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "clay_points.h"

#define ALL 63

static mps_material *hooke(double nu) {
  MAKE_KEPT(material, m, create_linear_elastic, context, 1e7, nu);
  return m;
}

/* Six stresses at once: the strains are Hooke's. */
TEST(all_stresses_of_an_elastic_point) {
  static const double nus[2] = {0.3, 0.4999};
  for (int k = 0; k < 2; k++) {
    const double nu = nus[k], target[6] = {-1e3, 2e3, 0.0, 500.0, -200.0, 100.0};
    scoped_material *m = hooke(nu);
    mps_material_point x = point_under(m, 0.0);
    const double still[9] = {0.0};
    double L[9];
    OK(mps_material_point_control(context, m, &x, still, ALL, target, 1.0, 1, L));
    for (int c = 0; c < 6; c++) NEAR(x.stress[c], target[c], 1e-5);
    for (int c = 0; c < 3; c++) {
      const double sum = target[0] + target[1] + target[2];
      NEAR(L[4 * c], ((1.0 + nu) * target[c] - nu * sum) / 1e7, 1e-11);
    }
    NEAR(L[1], 500.0 * (1.0 + nu) / 1e7, 1e-11); /* half of the engineering strain */
    NEAR(L[1], L[3], 0.0);
    NEAR(x.time, 1.0, 0.0);
  }
}

/* Uniaxial stress of von Mises: s = sigma_Y + the hardening line, lateral strain free. */
TEST(a_tension_test) {
  DEF(material_von_mises, def, .young = 2e11, .yield_stress = 2e8, .hardening = 1e10);
  MAKE(material, m, create_von_mises, context, &def);
  mps_material_point x = point_under(m, 0.0);
  const double pull[9] = {0.01}, target[6] = {0.0};
  OK(mps_material_point_control(context, m, &x, pull, MPS_MATERIAL_POINT_YY | MPS_MATERIAL_POINT_ZZ,
                                target, 1.0, 50, NULL));
  const double plastic = (0.01 - 2e8 / 2e11) / (1.0 + 1e10 / 2e11); /* of e = s/E + plastic */
  NEAR(x.stress[0] / (2e8 + 1e10 * plastic), 1.0, 1e-9);
  NEAR(x.history[0], plastic, 1e-9);
}

TEST(bad_arguments_are_refused) {
  scoped_material *m = hooke(0.3);
  mps_material_point x = point_under(m, -1e3);
  const mps_material_point first = x;
  const double still[9] = {0.0}, target[6] = {0.0}, bad[6] = {0.0, NAN};
  REFUSES(mps_material_point_control(context, NULL, &x, still, 1, target, 1.0, 1, NULL),
          "material is NULL");
  REFUSES(mps_material_point_control(context, m, NULL, still, 1, target, 1.0, 1, NULL),
          "point is NULL");
  REFUSES(mps_material_point_control(context, m, &x, NULL, 1, target, 1.0, 1, NULL),
          "gradient is NULL");
  REFUSES(mps_material_point_control(context, m, &x, still, 1, NULL, 1.0, 1, NULL),
          "target is NULL");
  REFUSES(mps_material_point_control(context, m, &x, still, 64, target, 1.0, 1, NULL),
          "controlled is 64");
  REFUSES(mps_material_point_control(context, m, &x, still, 2, bad, 1.0, 1, NULL),
          "target[1] is nan");
  REFUSES(mps_material_point_control(context, m, &x, still, 1, target, 0.0, 1, NULL),
          "duration is 0 s");
  REFUSES(mps_material_point_control(context, m, &x, still, 1, target, 1.0, 0, NULL), "steps is 0");
  x.stress[4] = INFINITY;
  REFUSES(mps_material_point_control(context, m, &x, still, 1, target, 1.0, 1, NULL),
          "stress[4] of the point is inf");
  x.stress[4] = 0.0;
  assert_int_equal(mps_material_point_control(NULL, m, &x, still, 1, target, 1.0, 1, NULL),
                   MPS_ERROR_ARGUMENT);
  mps_material_destroy(&m);

  DEF(material_mohr_coulomb, sand, .young = 1e7, .friction = PI / 6.0);
  OK(mps_material_create_mohr_coulomb(context, &sand, &m));
  const double beyond[6] = {-1e3, -1e3, -3.5e3}; /* Kp = 3 */
  FAILS(mps_material_point_control(context, m, &x, still, 7, beyond, 1.0, 50, NULL),
        MPS_ERROR_NUMERIC, "no strain gives the target stress");
  assert_memory_equal(&x, &first, sizeof x);
  const double within[6] = {-1e3, -1e3, -2.9e3};
  OK(mps_material_point_control(context, m, &x, still, 7, within, 1.0, 50, NULL));
  NEAR(x.stress[2], -2.9e3, 1e-4);
}
