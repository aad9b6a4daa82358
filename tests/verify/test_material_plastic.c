/* test_material_plastic.c - von Mises and Drucker-Prager against closed forms: yield, hardening,
 * limit loads of element tests, dilation, apex and tension cut-off.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#define E 1e7
#define NU 0.3
#define C 1e4 /* cohesion, Pa */
static const double shear = E / (2.0 * (1.0 + NU)), bulk = E / (3.0 * (1.0 - 2.0 * NU));

/* ---- von Mises ------------------------------------------------------------------------------- */

static mps_material *von_mises(double yield, double hardening) {
  DEF(material_von_mises, def, .young = E, .poisson = NU, .yield_stress = yield,
      .hardening = hardening);
  MAKE_KEPT(material, material, create_von_mises, context, &def);
  return material;
}

TEST(von_mises_yields_and_hardens_in_tension) {
  const double yield = 2e4, hardening = 3e6, tangent = E * hardening / (E + hardening);
  scoped_material *material = von_mises(yield, hardening);
  mps_material_point point = point_under(material, 0.0);
  for (int step = 1; step <= 60; step++) { /* strain 1e-4 a step, yield at 20 */
    (void)drive_laterally(material, &point, 1e-4, 1.0, 0.0, false);
    const double strain = 1e-4 * step, over = fmax(0.0, strain - yield / E);
    const double stress = E * (strain - over) + tangent * over;
    NEAR(point.stress[2], stress, 1e-9 * yield);
    NEAR(point.history[0], over - tangent * over / E, 1e-12);
    if (step != 20) assert_int_equal(point.flags, step > 20 ? MPS_MATERIAL_FLAG_PLASTIC : 0);
  }
}

TEST(von_mises_returns_to_the_surface) {
  const double yield = 2e4;
  uint64_t seed = 3;
  for (int hard = 0; hard < 2; hard++) {
    scoped_material *material = von_mises(yield, hard * 5e5);
    for (int trial = 0; trial < 1000; trial++) {
      mps_material_point point = point_under(material, 0.0);
      double gradient[9];
      for (int c = 0; c < 9; c++) gradient[c] = 0.05 * noise(&seed);
      OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 5));
      const double now = yield + hard * 5e5 * point.history[0];
      NEAR(ROOT3 * root_j2(point.stress), now, 1e-12 * now);
      const double trace = gradient[0] + gradient[4] + gradient[8]; /* no plastic volume */
      NEAR(mean_stress(point.stress), bulk * trace, 1e-9 * E * 0.05);
    }
  }
}

/* Nakamura (54): with sigma_Y = sqrt(3) c the limit in plane strain is that of the cohesion c. */
TEST(von_mises_has_the_cohesion_in_plane_strain) {
  scoped_material *material = von_mises(ROOT3 * C, 0.0);
  NEAR(limit_stress(material, -3e4, -0.05, true, NULL), -3e4 - 2.0 * C, 1e-7 * C);
}

/* ---- Drucker-Prager -------------------------------------------------------------------------- */

static mps_material *drucker_prager(int32_t cone, double phi, double psi, double cohesion,
                                    double tension) {
  DEF(material_drucker_prager, def, .young = E, .poisson = NU, .cone = cone,
      .friction = phi * PI / 180.0, .dilation = psi * PI / 180.0, .cohesion = cohesion,
      .tension = tension);
  MAKE_KEPT(material, material, create_drucker_prager, context, &def);
  return material;
}

/* Axial stress at the limit of Mohr-Coulomb for a lateral stress, both negative in compression:
 * pushed together (sense -1) or pulled (sense 1). */
static double coulomb_limit(double phi, double cohesion, double lateral, int sense) {
  const double n = tan((45.0 + 0.5 * phi) * PI / 180.0), n2 = n * n;
  if (sense < 0) return lateral * n2 - 2.0 * cohesion * n;
  return lateral / n2 + 2.0 * cohesion / n;
}

/* In every match, the limit load and the dilation of the element test it is made for. */
TEST(cones_meet_mohr_coulomb_where_they_should) {
  static const double phis[] = {0.0, 20.0, 38.0}, fractions[] = {0.0, 0.4, 1.0};
  for (int f = 0; f < 3; f++)
    for (int d = 0; d < 3; d++) {
      const double phi = phis[f], psi = phi * fractions[d], s = sin(psi * PI / 180.0);
      const double lateral = -1e5, down = coulomb_limit(phi, C, lateral, -1);
      const double up = coulomb_limit(phi, C, lateral, 1);
      double ratio = 0.0;
      mps_material *material =
          drucker_prager(MPS_MATERIAL_CONE_CIRCUMSCRIBED, phi, psi, C, INFINITY);
      NEAR(limit_stress(material, lateral, -0.4, false, &ratio), down, 1e-7 * -down);
      NEAR(1.0 + 2.0 * ratio, -2.0 * s / (1.0 - s), 1e-6); /* volume/axial strain */
      mps_material_destroy(&material);
      material = drucker_prager(MPS_MATERIAL_CONE_EXTENSION, phi, psi, C, INFINITY);
      NEAR(limit_stress(material, lateral, 0.4, false, &ratio), up, 1e-7 * -lateral);
      NEAR(1.0 + 2.0 * ratio, 2.0 * s / (1.0 + s), 1e-6);
      mps_material_destroy(&material);
      material = drucker_prager(MPS_MATERIAL_CONE_PLANE_STRAIN, phi, psi, C, INFINITY);
      NEAR(limit_stress(material, lateral, -1.0, true, &ratio), down, 1e-7 * -down);
      NEAR((1.0 + ratio) / (ratio - 1.0), s, 1e-6); /* sin(psi) = de_v / dgamma */
      mps_material_destroy(&material);
    }
}

/* sqrt(J2) at the limit for mean stress p and the angle of Lode theta (rad, -30 compression to 30
 * degrees extension: the middle stress moves up), reached without change of volume. */
static double limit_radius(const mps_material *material, double p, double theta) {
  mps_material_point point = point_under(material, p);
  const double gradient[9] = {sin(theta + 2.0 * PI / 3.0), 0, 0, 0, sin(theta), 0, 0, 0,
                              sin(theta - 2.0 * PI / 3.0)};
  OK(mps_material_point_drive(context, material, &point, gradient, 0.1, 3));
  NEAR(mean_stress(point.stress), p, 1e-10 * fabs(p));
  return root_j2(point.stress);
}

/* The inscribed cone has lines in common with the pyramid and never leaves it; plane strain and
 * associated is the same cone, Nakamura (56). */
TEST(the_inscribed_cone_touches_the_pyramid_from_inside) {
  const double p = -8e4, phi = 30.0 * PI / 180.0;
  scoped_material *inside = drucker_prager(MPS_MATERIAL_CONE_INSCRIBED, 30.0, 0.0, C, INFINITY);
  const double t = tan(phi), radius = (3.0 * C - 3.0 * p * t) / sqrt(9.0 + 12.0 * t * t);
  double closest = INFINITY;
  for (int k = -3000; k <= 3000; k++) {
    const double theta = k / 3000.0 * PI / 6.0;
    closest =
        fmin(closest, (C * cos(phi) - p * sin(phi)) / (cos(theta) + sin(theta) * sin(phi) / ROOT3));
    if (k % 500 == 0) NEAR(limit_radius(inside, p, theta), radius, 1e-11 * radius);
  }
  NEAR(closest, radius, 1e-7 * radius);
}

/* On the surface after every return, whatever the trial; the multiplier's volume is that of (55).
 */
TEST(drucker_prager_returns_to_the_surface) {
  const double sine = sin(30.0 * PI / 180.0), root = sqrt(9.0 + 3.0 * sine * sine);
  const double alpha = sine / root, kappa = 3.0 * C * cos(30.0 * PI / 180.0) / root;
  const double tension = 0.4 * kappa / (3.0 * alpha);
  uint64_t seed = 17;
  for (int cut = 0; cut < 2; cut++) {
    mps_material *material =
        drucker_prager(MPS_MATERIAL_CONE_INSCRIBED, 30.0, 30.0, C, cut ? tension : INFINITY);
    const double limit = cut ? tension : kappa / (3.0 * alpha);
    int cone = 0, circle = 0, plane = 0, elastic = 0;
    for (int trial = 0; trial < 4000; trial++) {
      mps_material_point point = point_under(material, 1e4 * noise(&seed) - 1e4);
      const mps_material_point before = point;
      double gradient[9], strain = 0.0;
      const double swell = 4e-3 * noise(&seed), size = 6e-3 * pow(noise(&seed), 4);
      for (int c = 0; c < 9; c++) gradient[c] = size * noise(&seed) + (c % 4 == 0 ? swell : 0.0);
      for (int c = 0; c < 9; c += 4) strain += gradient[c];
      OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
      const double p = mean_stress(point.stress), q = root_j2(point.stress);
      const double f = q + 3.0 * alpha * p - kappa;
      const double drop =
          mean_stress(before.stress) + bulk * strain - p; /* K times plastic volume */
      assert_true(f <= 1e-12 * E * 1e-2 && p <= limit * (1.0 + 1e-12));
      if (point.flags & MPS_MATERIAL_FLAG_APEX) {
        NEAR(p, limit, 1e-12 * limit);
        /* all plastic volume is the gap's, the elastic is the grains' own */
        NEAR(point.history[1], drop / bulk, 1e-14);
        NEAR(point.volume_ratio, exp(strain - drop / bulk), 1e-6);
        f > -1e-9 * C ? circle++ : plane++;
      } else {
        NEAR(point.volume_ratio, exp(strain), 1e-6);
        if (point.flags) { /* associated: volume = 3 alpha lambda, shear strain = lambda/sqrt(3) */
          NEAR(f, 0.0, 1e-12 * E * 1e-2);
          NEAR(drop / bulk, 3.0 * alpha * ROOT3 * point.history[0], 1e-15);
          cone++;
        } else {
          NEAR(drop, 0.0, 1e-9);
          elastic++;
        }
      }
    }
    assert_true(cone > 300 && circle > 300 && elastic > 100 && (cut ? plane > 100 : plane == 0));
    mps_material_destroy(&material);
  }
}

/* At the tension limit a small shear stays, a large one is cut to the cone's radius there. */
TEST(the_tension_cut_off_keeps_small_shear) {
  const double tension = 2e3;
  scoped_material *material = drucker_prager(MPS_MATERIAL_CONE_PLANE_STRAIN, 30.0, 0.0, C, tension);
  const double radius = C * cos(PI / 6.0) - sin(PI / 6.0) * tension; /* q = kappa - 3 alpha p */
  for (int large = 0; large < 2; large++) {
    const double gamma = large ? 5e-2 : 1e-4;
    const double gradient[9] = {1e-3, gamma, 0, gamma, 1e-3, 0, 0, 0, 1e-3};
    mps_material_point point = point_under(material, 0.0);
    OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
    NEAR(point.stress[3], large ? radius : 2.0 * shear * gamma, 1e-9);
    for (int c = 0; c < 3; c++) NEAR(point.stress[c], tension, 1e-10);
    NEAR(point.history[0] > 0.0, large, 0.0);
    assert_int_equal(point.flags, MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX);
  }
  mps_material_destroy(&material);
  material = drucker_prager(MPS_MATERIAL_CONE_INSCRIBED, 0.0, 0.0, C,
                            tension); /* no friction: c to the cut */
  NEAR(limit_radius(material, -1e4, 0.1), C, 1e-11 * C);
  NEAR(limit_radius(material, 1e3, 0.1), C, 1e-11 * C);
}
