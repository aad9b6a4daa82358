/* test_material_tension.c - the cut-offs of tension of Mohr-Coulomb and Drucker-Prager against the
 * closest point in the norm of elastic energy, found by trying every set of active surfaces.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "material_paths.h"

#define E 1e7
#define NU 0.25
#define C 1e4
#define TINY (1e-11 * 1e5) /* Pa, of the stresses that occur */
static const double shear = E / (2.0 * (1.0 + NU)), bulk = E / (3.0 * (1.0 - 2.0 * NU));

/* ---- planes in principal stress space -------------------------------------------------------- */

#define PLANES 9

/* normal.s <= limit, with the flow it causes. */
typedef struct plane {
  double normal[3], flow[3], limit;
} plane;

/* The six planes of the pyramid in every order of the stresses, and the three cut-offs. */
static void all_planes(double phi, double psi, double tension, plane *planes) {
  const double s_phi = sin(phi * PI / 180.0), s_psi = sin(psi * PI / 180.0);
  memset(planes, 0, PLANES * sizeof *planes);
  int n = 0;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      if (i == j) continue;
      planes[n].normal[i] = 1.0 + s_phi, planes[n].normal[j] = s_phi - 1.0;
      planes[n].flow[i] = 1.0 + s_psi, planes[n].flow[j] = s_psi - 1.0;
      planes[n++].limit = 2.0 * C * cos(phi * PI / 180.0);
    }
  for (int i = 0; i < 3; i++) {
    planes[n].normal[i] = planes[n].flow[i] = 1.0;
    planes[n++].limit = tension;
  }
}

static double excess(const plane *p, const double *s) {
  return p->normal[0] * s[0] + p->normal[1] * s[1] + p->normal[2] * s[2] - p->limit;
}

/* C:flow */
static void relaxation(const plane *p, double *out) {
  const double mean = bulk - 2.0 / 3.0 * shear, sum = p->flow[0] + p->flow[1] + p->flow[2];
  for (int c = 0; c < 3; c++) out[c] = mean * sum + 2.0 * shear * p->flow[c];
}

/* Solves the n x n system by elimination; false if singular. */
static bool solve(int n, double a[3][4]) {
  for (int k = 0; k < n; k++) {
    int top = k;
    for (int i = k; i < n; i++)
      if (fabs(a[i][k]) > fabs(a[top][k])) top = i;
    if (fabs(a[top][k]) < 1e-9 * shear) return false;
    for (int j = 0; j <= 3; j++) {
      const double kept = a[k][j];
      a[k][j] = a[top][j], a[top][j] = kept;
    }
    for (int i = 0; i < n; i++) {
      const double share = a[i][k] / a[k][k];
      for (int j = k; j <= 3 && i != k; j++) a[i][j] -= share * a[k][j];
    }
  }
  for (int k = 0; k < n; k++) a[k][3] /= a[k][k];
  return true;
}

/* The stress with the planes of `set` active; false unless all multipliers are >= 0 and no plane is
 * violated. */
static bool try_planes(const plane *planes, int n, const int *set, const double *trial, double *s) {
  double a[3][4] = {{0}}, lost[3][3];
  for (int j = 0; j < n; j++) relaxation(&planes[set[j]], lost[j]);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++)
      for (int c = 0; c < 3; c++) a[i][j] += planes[set[i]].normal[c] * lost[j][c];
    a[i][3] = excess(&planes[set[i]], trial);
  }
  if (!solve(n, a)) return false;
  for (int c = 0; c < 3; c++) s[c] = trial[c];
  for (int j = 0; j < n; j++) {
    if (a[j][3] < -1e-12) return false;
    for (int c = 0; c < 3; c++) s[c] -= a[j][3] * lost[j][c];
  }
  for (int k = 0; k < PLANES; k++)
    if (excess(&planes[k], s) > TINY) return false;
  return true;
}

/* The return with non-negative multipliers: for normal flow, the closest point. */
static bool search(const plane *planes, const double *trial, double *s) {
  int set[3] = {0};
  if (try_planes(planes, 0, set, trial, s)) return true;
  for (set[0] = 0; set[0] < PLANES; set[0]++)
    if (try_planes(planes, 1, set, trial, s)) return true;
  for (set[0] = 0; set[0] < PLANES; set[0]++)
    for (set[1] = 0; set[1] < set[0]; set[1]++)
      if (try_planes(planes, 2, set, trial, s)) return true;
  for (set[0] = 0; set[0] < PLANES; set[0]++)
    for (set[1] = 0; set[1] < set[0]; set[1]++)
      for (set[2] = 0; set[2] < set[1]; set[2]++)
        if (try_planes(planes, 3, set, trial, s)) return true;
  return false;
}

/* ---- Mohr-Coulomb ---------------------------------------------------------------------------- */

static mps_material *mohr_coulomb(double phi, double psi, double tension) {
  DEF(material_mohr_coulomb, def, .young = E, .poisson = NU, .cohesion = C, .tension = tension,
      .friction = phi * PI / 180.0, .dilation = psi * PI / 180.0);
  MAKE_KEPT(material, material, create_mohr_coulomb, context, &def);
  return material;
}

/* A random diagonal strain from no stress; `trial` receives the elastic stress. */
static mps_material_point pull(const mps_material *material, uint64_t *seed, double *trial) {
  mps_material_point point = point_under(material, 0.0);
  double gradient[9] = {0}, trace = 0.0;
  for (int c = 0; c < 3; c++) {
    gradient[4 * c] = 6e-3 * (noise(seed) + 0.05);
    trace += gradient[4 * c];
  }
  for (int c = 0; c < 3; c++)
    trial[c] = (bulk - 2.0 / 3.0 * shear) * trace + 2.0 * shear * gradient[4 * c];
  OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
  return point;
}

/* Which planes the stress lies on, as a number: the pyramid's (0, 1, 2) and four times the
 * cut-off's (0 to 3). */
static int place(const plane *planes, const double *s) {
  int pyramid = 0, cut = 0;
  for (int k = 0; k < PLANES; k++)
    if (fabs(excess(&planes[k], s)) < 1e3 * TINY) k < 6 ? pyramid++ : cut++;
  return pyramid + 4 * cut;
}

/* Every face, edge and corner of the cut pyramid: 1 face, 2 edge of the pyramid; 4, 8, 12 face,
 * edge, apex of the cut-off; 5 where the faces intersect; 6 on s2 = s3, 10 on s1 = s2. */
TEST(mohr_coulomb_goes_to_the_closest_point) {
  static const double cases[][3] = {
      {30, 30, 0.4}, {30, 30, 0.0}, {0, 0, 0.5}, {35, 10, 0.6}, {40, 0, 0.0}}; /* phi, psi, T/c */
  static const int kinds[] = {1, 2, 4, 5, 6, 8, 10, 12};
  uint64_t seed = 5;
  for (int n = 0; n < 5; n++) {
    plane planes[PLANES];
    int seen[13] = {0};
    scoped_material *material = mohr_coulomb(cases[n][0], cases[n][1], cases[n][2] * C);
    all_planes(cases[n][0], cases[n][1], cases[n][2] * C, planes);
    for (int k = 0; k < 6000; k++) {
      double trial[3], s[3];
      const mps_material_point point = pull(material, &seed, trial);
      assert_true(search(planes, trial, s));
      for (int c = 0; c < 3; c++) NEAR(point.stress[c], s[c], 10.0 * TINY);
      const int where = place(planes, s);
      assert_true(where <= 12);
      seen[where]++;
      const bool cut = where >= 4;
      assert_int_equal(point.flags, where == 0 ? 0
                                    : cut      ? MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX
                                               : MPS_MATERIAL_FLAG_PLASTIC);
      if (cut) /* the elastic part of the strain is the grains' own */
        NEAR(point.volume_ratio, exp(mean_stress(s) / bulk), 1e-7);
    }
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) assert_true(seen[kinds[k]] > 20);
  }
}

/* The axes are kept in general, and 2D is 3D (property/material has the cut-off too): here shear in
 * a material without tension opens it along one axis only. */
TEST(a_crack_keeps_what_is_along_it) {
  scoped_material *material = mohr_coulomb(35.0, 0.0, 0.0);
  mps_material_point point = point_under(material, 0.0);
  const double c = cos(0.4), s = sin(0.4), open = 2e-4, close = -1e-4;
  const double gradient[9] = {open * c * c + close * s * s,
                              (open - close) * c * s,
                              0,
                              (open - close) * c * s,
                              open * s * s + close * c * c,
                              0,
                              0,
                              0,
                              0};
  OK(mps_material_point_drive(context, material, &point, gradient, 1.0, 1));
  /* open along one axis: plane stress between the others, zz held */
  const double along = E / (1.0 - NU * NU) * close, across = NU * along;
  NEAR(point.stress[0], along * s * s, 1e-9);
  NEAR(point.stress[1], along * c * c, 1e-9);
  NEAR(point.stress[3], -along * c * s, 1e-9);
  NEAR(point.stress[2], across, 1e-9);
}

/* ---- Drucker-Prager -------------------------------------------------------------------------- */

/* Closest point of the cut cone in the plane of p and q, with the energy p^2/(2K) + q^2/(2G): on
 * the cone's line, on the limit, or their corner. */
static void closest_on_meridian(double alpha, double kappa, double T, double *p, double *q) {
  const double corner = kappa - 3.0 * alpha * T, f = *q + 3.0 * alpha * *p - kappa;
  double best = INFINITY, at[3][2] = {{T, fmin(*q, corner)}, {T, corner}, {*p, *q}};
  if (f <= 0.0 && *p <= T) return;
  const double step = f / (shear + 9.0 * bulk * alpha * alpha);
  at[2][0] = *p - 3.0 * bulk * alpha * step;
  at[2][1] = *q - shear * step;
  const double from[2] = {*p, *q};
  for (int k = 0; k < 3; k++) {
    const bool inside = at[k][0] <= T + TINY && at[k][1] >= -TINY &&
                        at[k][1] + 3.0 * alpha * at[k][0] <= kappa + TINY;
    const double x = at[k][0] - from[0], y = at[k][1] - from[1];
    const double energy = x * x / bulk + y * y / shear;
    if (!inside || energy > best) continue;
    best = energy;
    *p = at[k][0], *q = at[k][1];
  }
}

TEST(drucker_prager_goes_to_the_closest_point) {
  const double phi = 30.0 * PI / 180.0, root = sqrt(9.0 + 3.0 * sin(phi) * sin(phi));
  const double alpha = sin(phi) / root, kappa = 3.0 * C * cos(phi) / root;
  uint64_t seed = 7;
  for (int n = 0; n < 3; n++) {
    const double T = 0.3 * n * kappa / (3.0 * alpha);
    DEF(material_drucker_prager, def, .young = E, .poisson = NU, .cohesion = C, .tension = T,
        .friction = def.dilation = phi, .cone = MPS_MATERIAL_CONE_INSCRIBED);
    MAKE(material, material, create_drucker_prager, context, &def);
    int cut = 0, corner = 0, cone = 0;
    for (int k = 0; k < 8000; k++) {
      double trial[3];
      const mps_material_point point = pull(material, &seed, trial);
      const double t[6] = {trial[0], trial[1], trial[2], 0, 0, 0};
      double p = mean_stress(t), q = root_j2(t);
      closest_on_meridian(alpha, kappa, T, &p, &q);
      NEAR(mean_stress(point.stress), p, 10.0 * TINY);
      NEAR(root_j2(point.stress), q, 10.0 * TINY);
      const bool on_cone = fabs(q + 3.0 * alpha * p - kappa)<TINY, at_limit = p> T - TINY;
      corner += on_cone && at_limit, cone += on_cone && !at_limit, cut += at_limit && !on_cone;
    }
    assert_true(corner > 100 && cone > 100 && cut > 10);
  }
}
