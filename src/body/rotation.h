/* rotation.h - rotations in space: matrices (9 values, rows) and rotation vectors (axis times
 * angle, rad). SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

static inline double mpsi_dot3(const double *a, const double *b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void mpsi_cross3(const double *a, const double *b, double *out) {
  const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
  out[0] = x, out[1] = y;
}

/* out = R x, out = R^T x; out is not x. */
static inline void mpsi_rotate(const double *R, const double *x, double *out) {
  for (int r = 0; r < 3; r++) out[r] = mpsi_dot3(R + 3 * r, x);
}
static inline void mpsi_rotate_back(const double *R, const double *x, double *out) {
  for (int c = 0; c < 3; c++) out[c] = R[c] * x[0] + R[3 + c] * x[1] + R[6 + c] * x[2];
}

/* R = exp of the rotation vector v. */
void mpsi_rotation_exp(const double *v, double *R);
/* The shortest rotation vector of R. */
void mpsi_rotation_log(const double *R, double *v);
/* Spin in space (rad/s) of exp(v(t)), v changing at `rate`: the exponential's Jacobian. */
void mpsi_rotation_spin(const double *v, const double *rate, double *spin);
/* Rotates R by the rotation vector v in space: R <- exp(v) R. */
void mpsi_rotation_turn(const double *v, double *R);
/* Rotates R by `angle` (rad) about the body's own axis `axis`: R <- R exp(angle e). */
void mpsi_rotation_turn_own(int axis, double angle, double *R);
/* Removes the round-off of many products from R: its rows become orthonormal again. */
void mpsi_rotation_clean(double *R);
