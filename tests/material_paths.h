/* material_paths.h - what the tests of constitutive laws share: invariants of a stress,
 * reproducible random numbers, and element tests that hold a lateral stress.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MATERIAL_PATHS_H
#define MPS_TEST_MATERIAL_PATHS_H

#include "kit/random.h"
#include "test_fixture.h"

#define ROOT3 1.7320508075688772

static inline double mean_stress(const double *s) { return (s[0] + s[1] + s[2]) / 3.0; }

/* sqrt(J2) of xx yy zz xy zx yz. */
static inline double root_j2(const double *s) {
  const double x = s[0] - s[1], y = s[1] - s[2], z = s[2] - s[0];
  return sqrt((x * x + y * y + z * z) / 6.0 + s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
}

static inline double determinant(const double *s) {
  return s[0] * (s[1] * s[2] - s[5] * s[5]) - s[3] * (s[3] * s[2] - s[5] * s[4]) +
         s[4] * (s[3] * s[5] - s[1] * s[4]);
}

/* Principal stresses, largest first, by the angle of Lode: independent of the library's way. */
static inline void principal_stresses(const double *s, double *value) {
  const double p = mean_stress(s), q = root_j2(s);
  const double dev[6] = {s[0] - p, s[1] - p, s[2] - p, s[3], s[4], s[5]};
  double cosine = q > 0.0 ? 1.5 * ROOT3 * determinant(dev) / (q * q * q) : 1.0;
  cosine = fmin(1.0, fmax(-1.0, cosine));
  for (int i = 0; i < 3; i++)
    value[i] = p + 2.0 / ROOT3 * q *
                       cos((acos(cosine) - 2.0 * PI *
                                               (i == 0   ? 0
                                                : i == 1 ? 1
                                                         : 2)) /
                           3.0);
  if (value[1] < value[2]) {
    const double kept = value[1];
    value[1] = value[2];
    value[2] = kept;
  }
}

/* Drives zz at `rate` for dt with the lateral velocity gradient that gives the stress `lateral`: in
 * xx and yy, or with `plane` in xx alone while yy stays put. Returns the lateral gradient. The
 * stress grows with it, so a bracket can be halved and cut by secants (Illinois). */
static inline double drive_laterally(const mps_material *material, mps_material_point *point,
                                     double rate, double dt, double lateral, bool plane) {
  double low = -8.0 * fabs(rate), high = -low, f_low = 0.0, f_high = 0.0, x = low;
  mps_material_point trial = *point;
  for (int i = 0; i < 300; i++) {
    x = i == 0 ? low : i == 1 ? high : low - f_low * (high - low) / (f_high - f_low);
    const double gradient[9] = {x, 0, 0, 0, plane ? 0.0 : x, 0, 0, 0, rate};
    trial = *point;
    OK(mps_material_point_drive(context, material, &trial, gradient, dt, 1));
    const double f = trial.stress[0] - lateral;
    if (i == 0)
      f_low = f;
    else if (i == 1)
      f_high = f;
    else if (f < 0.0) {
      low = x, f_low = f;
      f_high *= 0.5;
    } else {
      high = x, f_high = f;
      f_low *= 0.5;
    }
    if (f == 0.0 || (i > 1 && high - low <= 1e-15 * fabs(rate))) break;
  }
  *point = trial;
  return x;
}

/* A point under equal stress p in all directions. */
static inline mps_material_point point_under(const mps_material *material, double p) {
  mps_material_point point;
  OK(mps_material_point_init(context, material, &point));
  for (int c = 0; c < 3; c++) point.stress[c] = p;
  return point;
}

/* The axial stress after straining zz by `strain` under constant lateral stress `lateral`, and the
 * lateral strain for each axial one in the last step. */
static inline double limit_stress(const mps_material *material, double lateral, double strain,
                                  bool plane, double *ratio) {
  mps_material_point point = point_under(material, lateral);
  double x = 0.0;
  for (int step = 0; step < 200; step++)
    x = drive_laterally(material, &point, strain / 200.0, 1.0, lateral, plane);
  if (ratio) *ratio = x / (strain / 200.0);
  return point.stress[2];
}

#endif
