/* test_material_mohr_coulomb.c - Mohr-Coulomb: on the surface after every return, the closest point
 * for associated flow, limit loads and dilation of element tests, edges, apex, axes kept.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#define E 1e7
#define NU 0.25
#define C 1e4
static const double shear = E / (2.0 * (1.0 + NU)), bulk = E / (3.0 * (1.0 - 2.0 * NU));

static mps_material *mohr_coulomb(double phi, double psi, double cohesion) {
  DEF(material_mohr_coulomb, def, .young = E, .poisson = NU, .friction = phi * PI / 180.0,
      .dilation = psi * PI / 180.0, .cohesion = cohesion);
  MAKE_KEPT(material, material, create_mohr_coulomb, context, &def);
  return material;
}

/* (s1 - s3) + (s1 + s3) sin(phi) - 2 c cos(phi) of the extreme of three values in any order. */
static double yield_of(const double *s, double phi, double cohesion) {
  const double s1 = fmax(s[0], fmax(s[1], s[2])), s3 = fmin(s[0], fmin(s[1], s[2]));
  const double angle = phi * PI / 180.0;
  return (s1 - s3) + (s1 + s3) * sin(angle) - 2.0 * cohesion * cos(angle);
}

/* A diagonal strain from a stress state without shear: principal directions are x, y, z, so that
 * values can be compared one by one. Returns the trial stresses. */
static mps_material_point random_return(const mps_material *material, uint64_t *seed,
                                        double *trial) {
  mps_material_point point = point_under(material, 0.0);
  double gradient[9] = {0}, trace = 0.0;
  for (int c = 0; c < 3; c++) {
    gradient[4 * c] = 8e-3 * (noise(seed) - 0.1);
    trace += gradient[4 * c];
  }
  for (int c = 0; c < 3; c++)
    trial[c] = (bulk - 2.0 / 3.0 * shear) * trace + 2.0 * shear * gradient[4 * c];
  OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
  return point;
}

static double energy_product(const double *a, const double *b) { /* a : C^-1 : b */
  const double sum = (a[0] + a[1] + a[2]) * (b[0] + b[1] + b[2]);
  return ((1.0 + NU) * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) - NU * sum) / E;
}

/* How many stresses coincide: 1 on a plane, 2 on an edge, 3 at the apex. */
static int equal_count(const double *s) {
  int pairs = 0;
  for (int i = 0; i < 3; i++) pairs += fabs(s[i] - s[(i + 1) % 3]) < 1e-9 * C;
  return pairs == 0 ? 1 : pairs == 1 ? 2 : 3;
}

/* Associated flow maximises the dissipation: (trial - s):C^-1:(t - s) <= 0 for every admissible t.
 * All of planes, both edges and apex occur, with the order of the principal stresses kept. */
TEST(associated_returns_are_the_closest_points) {
  static const double phis[] = {0.0, 30.0};
  uint64_t seed = 23;
  for (int f = 0; f < 2; f++) {
    const double phi = phis[f];
    scoped_material *material = mohr_coulomb(phi, phi, C);
    int kinds[4] = {0}, right = 0;
    for (int n = 0; n < 3000; n++) {
      double trial[3], away[3], to[3];
      const mps_material_point point = random_return(material, &seed, trial);
      const double *s = point.stress;
      if (!point.flags) {
        assert_true(yield_of(trial, phi, C) <= 1e-9);
        for (int c = 0; c < 3; c++) NEAR(s[c], trial[c], 1e-10);
        continue;
      }
      NEAR(yield_of(s, phi, C), 0.0, 1e-12 * 2e5);
      for (int c = 0; c < 3; c++) {
        away[c] = trial[c] - s[c];
        const int d = (c + 1) % 3;
        if (trial[c] > trial[d]) assert_true(s[c] >= s[d]);
      }
      const int kind = equal_count(s);
      kinds[kind]++;
      if (kind == 2)
        right += 2.0 * mean_stress(s) < fmax(s[0], fmax(s[1], s[2])) + fmin(s[0], fmin(s[1], s[2]));
      assert_int_equal((point.flags & MPS_MATERIAL_FLAG_APEX) != 0, kind == 3);
      for (int k = 0; k < 200; k++) { /* admissible states: scaled back towards one inside */
        double other[3];
        for (int c = 0; c < 3; c++) other[c] = 1e5 * noise(&seed);
        const double over = yield_of(other, phi, C), inside = yield_of((double[3]){0}, phi, C);
        const double share = over > 0.0 ? inside / (inside - over) : 1.0;
        for (int c = 0; c < 3; c++) to[c] = share * other[c] - s[c];
        assert_true(energy_product(away, to) <= 1e-9 * C * C / E);
      }
    }
    assert_true(kinds[1] > 300 && right > 50 && kinds[2] - right > 50);
    assert_true(phi > 0.0 ? kinds[3] > 50 : kinds[3] == 0);
  }
}

/* With any dilation the stress lost is a non-negative sum of the flows of the planes that are
 * active: the plane's alone, two at an edge. */
TEST(other_returns_flow_along_the_potential) {
  const double phi = 35.0, psi = 12.0, s_psi = sin(psi * PI / 180.0);
  scoped_material *material = mohr_coulomb(phi, psi, C);
  uint64_t seed = 29;
  int kinds[4] = {0};
  for (int n = 0; n < 4000; n++) {
    double trial[3], lost[3];
    const mps_material_point point = random_return(material, &seed, trial);
    if (!point.flags) continue;
    const double *s = point.stress;
    NEAR(yield_of(s, phi, C), 0.0, 1e-12 * 2e5);
    const int kind = equal_count(s);
    kinds[kind]++;
    if (kind == 3) {
      for (int c = 0; c < 3; c++) NEAR(s[c], C / tan(phi * PI / 180.0), 1e-10 * C);
      continue;
    }
    for (int c = 0; c < 3; c++) lost[c] = trial[c] - s[c];
    double strain[3], total = 0.0, positive = 0.0; /* C^-1 : lost = plastic strain */
    for (int c = 0; c < 3; c++) {
      strain[c] = ((1.0 + NU) * lost[c] - NU * (lost[0] + lost[1] + lost[2])) / E;
      total += strain[c];
      positive += fmax(strain[c], 0.0);
    }
    /* each plane adds (1 + sin psi) to its largest and -(1 - sin psi) to its smallest */
    NEAR(total / positive, 2.0 * s_psi / (1.0 + s_psi), 1e-7);
    for (int c = 0; c < 3; c++) { /* the middle one takes no part on a plane */
      const bool middle = (trial[c] - trial[(c + 1) % 3]) * (trial[c] - trial[(c + 2) % 3]) < 0.0;
      if (kind == 1 && middle) NEAR(strain[c], 0.0, 1e-15);
    }
    double square = 0.0;
    for (int c = 0; c < 3; c++) square += (strain[c] - total / 3.0) * (strain[c] - total / 3.0);
    NEAR(point.history[0], sqrt(2.0 / 3.0 * square), 1e-14);
  }
  assert_true(kinds[1] > 300 && kinds[2] > 300 && kinds[3] > 50);
}

/* Limit loads and dilation in triaxial compression and extension and in plane strain. */
TEST(element_tests_reach_coulombs_limit) {
  static const double phis[] = {0.0, 25.0, 40.0};
  for (int f = 0; f < 3; f++)
    for (int d = 0; d < 2; d++) {
      const double phi = phis[f], psi = d * phis[f] / 2.0, s = sin(psi * PI / 180.0);
      const double n = tan((45.0 + 0.5 * phi) * PI / 180.0), lateral = -5e4;
      const double down = lateral * n * n - 2.0 * C * n, up = lateral / (n * n) + 2.0 * C / n;
      double ratio = 0.0;
      scoped_material *material = mohr_coulomb(phi, psi, C);
      NEAR(limit_stress(material, lateral, -0.1, false, &ratio), down, 1e-7 * -down);
      NEAR(1.0 + 2.0 * ratio, -2.0 * s / (1.0 - s), 1e-6);
      NEAR(limit_stress(material, lateral, 0.1, false, &ratio), up, 1e-7 * -lateral);
      NEAR(1.0 + 2.0 * ratio, 2.0 * s / (1.0 + s), 1e-6);
      NEAR(limit_stress(material, lateral, -0.1, true, &ratio), down, 1e-7 * -down);
      NEAR((1.0 + ratio) / (ratio - 1.0), s, 1e-6);
    }
}

/* General stresses: on the surface, and the principal axes are those of the trial. */
TEST(returns_keep_the_principal_axes) {
  static const int row[6] = {0, 1, 2, 0, 2, 1}, column[6] = {0, 1, 2, 1, 0, 2};
  scoped_material *material = mohr_coulomb(30.0, 5.0, C);
  MAKE(material, elastic, create_linear_elastic, context, E, NU);
  uint64_t seed = 31;
  int returned = 0;
  for (int n = 0; n < 3000; n++) {
    mps_material_point point = point_under(material, -1e4), trial = point;
    double gradient[9], a[3][3], b[3][3];
    for (int c = 0; c < 9; c++) gradient[c] = 5e-3 * noise(&seed);
    if (n % 3 == 0) gradient[2] = gradient[5] = gradient[6] = gradient[7] = 0.0; /* z principal */
    OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
    OK(mps_material_point_drive(context, elastic, &trial, gradient, 1.0, 1));
    double value[3];
    principal_stresses(point.stress, value);
    if (!point.flags) {
      for (int c = 0; c < 6; c++) NEAR(point.stress[c], trial.stress[c], 0.0);
      assert_true(yield_of(value, 30.0, C) <= 1e-4);
      continue;
    }
    returned++;
    NEAR(yield_of(value, 30.0, C), 0.0, 2e-8 * 2e5); /* the angle of Lode's accuracy */
    for (int c = 0; c < 6; c++) {
      a[row[c]][column[c]] = a[column[c]][row[c]] = trial.stress[c];
      b[row[c]][column[c]] = b[column[c]][row[c]] = point.stress[c];
    }
    for (int i = 0; i < 3; i++) /* same axes: they commute */
      for (int j = 0; j < 3; j++) {
        double ab = 0.0, ba = 0.0;
        for (int k = 0; k < 3; k++) ab += a[i][k] * b[k][j], ba += b[i][k] * a[k][j];
        NEAR(ab, ba, 1e-13 * 1e10);
      }
  }
  assert_true(returned > 1000);
}

TEST(sand_opens_without_drift_of_volume) {
  scoped_material *material = mohr_coulomb(33.0, 0.0, 0.0);
  mps_material_point point = point_under(material, 0.0);
  const double pull[9] = {0.3, 0.1, 0, 0, 0.25, 0, -0.2, 0, 0.4};
  OK(mps_material_point_drive(context, material, &point, pull, 1.0, 1000));
  for (int c = 0; c < 6; c++) NEAR(point.stress[c], 0.0, 0.0);
  NEAR(point.volume_ratio, 1.0, 0.0);
  assert_int_equal(point.flags, MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX);
}
