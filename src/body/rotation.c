/* rotation.c - the exponential map of rotations, its inverse and its Jacobian.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "rotation.h"

/* sin(a)/a, (1 - cos a)/a^2 and (a - sin a)/a^3 from a^2: by series where the quotients lose
 * digits.
 */
static void coefficients(double square, double *s, double *c, double *d) {
  if (square < 1e-2) {
    const double q = square;
    *s = 1.0 - q / 6.0 * (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0))));
    *c = 0.5 * (1.0 - q / 12.0 * (1.0 - q / 30.0 * (1.0 - q / 56.0 * (1.0 - q / 90.0))));
    *d = (1.0 - q / 20.0 * (1.0 - q / 42.0 * (1.0 - q / 72.0 * (1.0 - q / 110.0)))) / 6.0;
    return;
  }
  const double a = sqrt(square), half = sin(0.5 * a);
  *s = sin(a) / a;
  *c = 2.0 * half * half / square;
  *d = (a - sin(a)) / (a * square);
}

void mpsi_rotation_exp(const double *v, double *R) {
  double s, c, d;
  coefficients(mpsi_dot3(v, v), &s, &c, &d);
  const double x = v[0], y = v[1], z = v[2];
  R[0] = 1.0 - c * (y * y + z * z), R[1] = c * x * y - s * z, R[2] = c * x * z + s * y;
  R[3] = c * x * y + s * z, R[4] = 1.0 - c * (x * x + z * z), R[5] = c * y * z - s * x;
  R[6] = c * x * z - s * y, R[7] = c * y * z + s * x, R[8] = 1.0 - c * (x * x + y * y);
}

/* By the unit quaternion (w, q), whose largest component is found first (Shepperd): accurate for
 * every angle, pi included. */
void mpsi_rotation_log(const double *R, double *v) {
  const double four[4] = {1.0 + R[0] + R[4] + R[8], 1.0 + R[0] - R[4] - R[8],
                          1.0 - R[0] + R[4] - R[8], 1.0 - R[0] - R[4] + R[8]};
  int most = 0;
  for (int k = 1; k < 4; k++)
    if (four[k] > four[most]) most = k;
  const double largest = 0.5 * sqrt(four[most]), by = 0.25 / largest;
  double w = largest, q[3];
  if (most == 0) {
    q[0] = by * (R[7] - R[5]), q[1] = by * (R[2] - R[6]), q[2] = by * (R[3] - R[1]);
  } else {
    const int i = most - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    q[i] = largest;
    q[j] = by * (R[3 * j + i] + R[3 * i + j]);
    q[k] = by * (R[3 * k + i] + R[3 * i + k]);
    w = by * (R[3 * k + j] - R[3 * j + k]);
  }
  const double sign = w < 0.0 ? -1.0 : 1.0, length = sqrt(mpsi_dot3(q, q));
  const double angle = 2.0 * atan2(length, fabs(w));
  const double scale = length > 0.0 ? sign * angle / length : 2.0;
  for (int c = 0; c < 3; c++) v[c] = scale * q[c];
}

void mpsi_rotation_spin(const double *v, const double *rate, double *spin) {
  double s, c, d, once[3], twice[3];
  coefficients(mpsi_dot3(v, v), &s, &c, &d);
  mpsi_cross3(v, rate, once);
  mpsi_cross3(v, once, twice);
  for (int k = 0; k < 3; k++) spin[k] = rate[k] + c * once[k] + d * twice[k];
}

void mpsi_rotation_turn(const double *v, double *R) {
  double by[9], out[9];
  mpsi_rotation_exp(v, by);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      out[3 * r + c] = by[3 * r] * R[c] + by[3 * r + 1] * R[3 + c] + by[3 * r + 2] * R[6 + c];
  for (int k = 0; k < 9; k++) R[k] = out[k];
}

void mpsi_rotation_turn_own(int axis, double angle, double *R) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const double cosine = cos(angle), sine = sin(angle);
  for (int r = 0; r < 3; r++) {
    const double a = R[3 * r + j], b = R[3 * r + k];
    R[3 * r + j] = cosine * a + sine * b;
    R[3 * r + k] = cosine * b - sine * a;
  }
}

void mpsi_rotation_clean(double *R) {
  const double ab =
      mpsi_dot3(R, R + 3); /* Gram-Schmidt, the error divided between the first two rows */
  for (int c = 0; c < 3; c++) {
    const double a = R[c], b = R[3 + c];
    R[c] = a - 0.5 * ab * b, R[3 + c] = b - 0.5 * ab * a;
  }
  for (int r = 0; r < 2; r++) {
    const double by = 1.0 / sqrt(mpsi_dot3(R + 3 * r, R + 3 * r));
    for (int c = 0; c < 3; c++) R[3 * r + c] *= by;
  }
  mpsi_cross3(R, R + 3, R + 6);
}
