/* fluid_radiation.h - added mass and damping of a box that moves in the surface of water of finite
 * depth, by linear potential flow with matched eigenfunctions (Black, Mei and Bray 1971). Beside
 * the box, x > b,
 *
 *   phi = sum A_n cos(k_n y) e^(-k_n (x - b)),  w^2 = -g k_n tan(k_n d), k_0 imaginary: a wave that
 *
 * leaves, and below it, 0 < y < s, |x| < b, phi = phi_p + sum B_m X_m(x) cos(m pi y/s) with phi_p
 * of the motion of the box's bottom: (y^2 - x^2)/(2 s) for heave, (x y^2 - x^3/3)/(2 s) for roll,
 * and X_m even for heave, odd for sway and roll. At x = b both agree below the box, and the flow
 * through x = b is that of the slit and of the box's side.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_FLUID_RADIATION_H
#define MPS_FLUID_RADIATION_H

#include <complex.h>
#include <math.h>
#include <string.h>

enum { RADIATION_TERMS = 60, RADIATION_POINTS = 4000 };

typedef enum radiation_mode { RADIATION_SWAY, RADIATION_HEAVE, RADIATION_ROLL } radiation_mode;

/* Box of width 2 b, draught d - s, in water of depth d, density 1000 kg/m3; roll about the middle
 * of the level. */
typedef struct radiation_box {
  double b, d, s, omega;
} radiation_box;

typedef struct radiation {
  double mass, damping; /* kg and N s/m for a metre; roll: kg m2, N m s */
  double carried;       /* the damping that the energy of the waves far away makes */
} radiation;

/* k_n, and cos(k_n y), of the water beside the box. */
static inline double complex radiation_number(const radiation_box *box, int n) {
  const double pi = acos(-1.0), g = 9.81, d = box->d, w2 = box->omega * box->omega;
  double low = n ? (n - 0.5) * pi / d * (1.0 + 1e-12) : 0.0;
  double high = n ? n * pi / d : w2 / g + box->omega / sqrt(g * d);
  for (int k = 0; k < 100; k++) {
    const double at = 0.5 * (low + high);
    const double side = n ? at * tan(at * d) + w2 / g : at * tanh(at * d) - w2 / g;
    if (side < 0.0)
      low = at;
    else
      high = at;
  }
  return n ? low : I * low;
}

static inline void radiation_eliminate(int n, double complex A[][2 * RADIATION_TERMS],
                                       double complex *right) {
  for (int p = 0; p < n; p++) {
    int best = p;
    for (int i = p + 1; i < n; i++)
      if (cabs(A[i][p]) > cabs(A[best][p])) best = i;
    for (int j = p; j < n; j++) {
      const double complex other = A[p][j];
      A[p][j] = A[best][j], A[best][j] = other;
    }
    const double complex other = right[p];
    right[p] = right[best], right[best] = other;
    for (int i = p + 1; i < n; i++) {
      const double complex factor = A[i][p] / A[p][p];
      for (int j = p; j < n; j++) A[i][j] -= factor * A[p][j];
      right[i] -= factor * right[p];
    }
  }
  for (int p = n - 1; p >= 0; p--) {
    for (int j = p + 1; j < n; j++) right[p] -= A[p][j] * right[j];
    right[p] /= A[p][p];
  }
}

/* phi_p and its derivative along x, of a motion of the bottom by 1 (heave) or x (roll). */
static inline double radiation_bottom(radiation_mode mode, const radiation_box *box, double x,
                                      double y, double *slope) {
  const double s = box->s;
  *slope = 0.0;
  if (mode == RADIATION_SWAY) return 0.0;
  *slope = mode == RADIATION_HEAVE ? -x / s : (y * y - x * x) / (2.0 * s);
  return mode == RADIATION_HEAVE ? (y * y - x * x) / (2.0 * s)
                                 : (x * y * y - x * x * x / 3.0) / (2.0 * s);
}

/* X_m at x, 1 at x = b. */
static inline double radiation_along(radiation_mode mode, const radiation_box *box, int m,
                                     double x) {
  const double l = m * acos(-1.0) / box->s;
  if (m == 0) return mode == RADIATION_HEAVE ? 1.0 : x / box->b;
  return mode == RADIATION_HEAVE ? cosh(l * x) / cosh(l * box->b) : sinh(l * x) / sinh(l * box->b);
}

static inline double radiation_slope(radiation_mode mode, const radiation_box *box, int m) {
  const double l = m * acos(-1.0) / box->s;
  if (m == 0) return mode == RADIATION_HEAVE ? 0.0 : 1.0 / box->b;
  return mode == RADIATION_HEAVE ? l * tanh(l * box->b) : l / tanh(l * box->b);
}

static inline radiation radiation_of(const radiation_box *box, radiation_mode mode) {
  enum { N = RADIATION_TERMS };
  static double complex A[2 * N][2 * N], right[2 * N], k[N];
  const double pi = acos(-1.0), b = box->b, d = box->d, s = box->s;
  memset(A, 0, sizeof A), memset(right, 0, sizeof right);
  for (int n = 0; n < N; n++) k[n] = radiation_number(box, n);
  for (int n = 0; n < N; n++) {
    A[N + n][n] = -k[n] * (0.5 * d + csin(2.0 * k[n] * d) / (4.0 * k[n]));
    for (int m = 0; m < N; m++) { /* of cos(k y) cos(m pi y/s) over the slit */
      const double l = m * pi / s;
      const double complex over =
          cabs(k[n] - l) < 1e-9 * l
              ? 0.5 * s
              : (m % 2 ? -1.0 : 1.0) * k[n] * csin(k[n] * s) / (k[n] * k[n] - l * l);
      A[m][n] = over, A[N + n][N + m] = -over * radiation_slope(mode, box, m);
    }
    A[n][N + n] = n ? -0.5 * s : -s;
  }
  const double h = d / RADIATION_POINTS;
  for (int p = 0; p < RADIATION_POINTS; p++) {
    const double y = (p + 0.5) * h;
    double slope, at = radiation_bottom(mode, box, b, y, &slope);
    if (y > s) slope = mode == RADIATION_SWAY ? 1.0 : mode == RADIATION_ROLL ? d - y : 0.0;
    for (int n = 0; n < N; n++) {
      right[N + n] += h * slope * ccos(k[n] * y);
      if (y < s) right[n] += h * at * cos(n * pi * y / s);
    }
  }
  radiation_eliminate(2 * N, A, right);
  double complex sum = 0.0; /* of phi times the box's velocity along its normal, over half of it */
  for (int p = 0; p < RADIATION_POINTS; p++) {
    const double y = s + (p + 0.5) * (d - s) / RADIATION_POINTS;
    const double x = (p + 0.5) * b / RADIATION_POINTS;
    double slope;
    double complex beside = 0.0, below = radiation_bottom(mode, box, x, s, &slope);
    for (int n = 0; n < N; n++) {
      beside += right[n] * ccos(k[n] * y);
      below += right[N + n] * radiation_along(mode, box, n, x) * (n % 2 ? -1.0 : 1.0);
    }
    if (mode != RADIATION_HEAVE)
      sum += beside * (mode == RADIATION_SWAY ? 1.0 : d - y) * (d - s) / RADIATION_POINTS;
    if (mode != RADIATION_SWAY)
      sum -= below * (mode == RADIATION_HEAVE ? 1.0 : x) * b / RADIATION_POINTS;
  }
  const double complex force = 2000.0 * I * box->omega * sum; /* -(i w mass + damping) */
  const double q = cimag(k[0]), rise = box->omega / 9.81 * cabs(right[0]) * cosh(q * d);
  const double group = 0.5 * box->omega / q * (1.0 + 2.0 * q * d / sinh(2.0 * q * d));
  return (radiation){-cimag(force) / box->omega, -creal(force), 2.0 * 9810.0 * rise * rise * group};
}

#endif
