/* tensor.h - stress, strain increment and spin of one particle, for the vector loops: every
 * function is inlined, without branches but on literal arguments. Nakamura (44)-(47).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "material_private.h"

/* A symmetric tensor, true components (not engineering shear). In 2D yz = zx = 0 fold away. */
typedef struct mpsi_sym {
  double xx, yy, zz, xy, yz, zx;
} mpsi_sym;

/* Spin increment, Nakamura (47): half of L - L^T times dt. */
typedef struct mpsi_spin {
  double xy, yz, zx;
} mpsi_spin;

/* Columns of a block, looked up once. */
typedef struct mpsi_law_columns {
  const double *l[9];
  double *s[6];
} mpsi_law_columns;

MPSI_INLINE mpsi_law_columns mpsi_columns_of(const mps_material_block *block) {
  mpsi_law_columns columns;
  for (int c = 0; c < 9; c++) columns.l[c] = block->gradient[c];
  for (int c = 0; c < 6; c++) columns.s[c] = block->stress[c];
  return columns;
}

/* Strain increment (46). */
MPSI_INLINE mpsi_sym mpsi_strain(const int geometry, const mpsi_law_columns *c, int64_t k,
                                 double dt) {
  mpsi_sym d = {
      .xx = dt * c->l[0][k], .yy = dt * c->l[4][k], .xy = 0.5 * dt * (c->l[1][k] + c->l[3][k])};
  if (geometry != MPSI_PLANE) d.zz = dt * c->l[8][k];
  if (geometry == MPSI_SPACE) {
    d.yz = 0.5 * dt * (c->l[5][k] + c->l[7][k]);
    d.zx = 0.5 * dt * (c->l[6][k] + c->l[2][k]);
  }
  return d;
}

MPSI_INLINE mpsi_spin mpsi_spin_of(const int geometry, const mpsi_law_columns *c, int64_t k,
                                   double dt) {
  mpsi_spin w = {.xy = 0.5 * dt * (c->l[1][k] - c->l[3][k])};
  if (geometry == MPSI_SPACE) {
    w.yz = 0.5 * dt * (c->l[5][k] - c->l[7][k]);
    w.zx = 0.5 * dt * (c->l[6][k] - c->l[2][k]);
  }
  return w;
}

MPSI_INLINE mpsi_sym mpsi_stress(const int geometry, const mpsi_law_columns *c, int64_t k) {
  mpsi_sym s = {.xx = c->s[0][k], .yy = c->s[1][k], .zz = c->s[2][k], .xy = c->s[3][k]};
  if (geometry == MPSI_SPACE) {
    s.yz = c->s[5][k];
    s.zx = c->s[4][k];
  }
  return s;
}

MPSI_INLINE void mpsi_put_stress(const int geometry, const mpsi_law_columns *c, int64_t k,
                                 mpsi_sym s) {
  c->s[0][k] = s.xx;
  c->s[1][k] = s.yy;
  c->s[2][k] = s.zz;
  c->s[3][k] = s.xy;
  if (geometry == MPSI_SPACE) {
    c->s[5][k] = s.yz;
    c->s[4][k] = s.zx;
  }
}

/* Q = (1 - w/2)^-1 (1 + w/2) in space, from Q - 1 = r (w + w.w/2), r = 1/(1 + |w|^2/4); w_xy =
 * w.xy, w_yz = w.yz, w_zx = w.zx. */
typedef struct mpsi_rotation {
  double xx, xy, xz, yx, yy, yz, zx, zy, zz;
} mpsi_rotation;

MPSI_INLINE mpsi_rotation mpsi_rotation_of(mpsi_spin w) {
  const double a = w.xy * w.xy, b = w.yz * w.yz, c = w.zx * w.zx;
  const double r = 1.0 / (1.0 + 0.25 * (a + b + c)), h = 0.5 * r;
  const double exy = h * w.yz * w.zx, eyz = h * w.zx * w.xy, ezx = h * w.xy * w.yz;
  return (mpsi_rotation){.xx = 1.0 - h * (a + c),
                         .yy = 1.0 - h * (a + b),
                         .zz = 1.0 - h * (b + c),
                         .xy = exy + r * w.xy,
                         .yx = exy - r * w.xy,
                         .yz = eyz + r * w.yz,
                         .zy = eyz - r * w.yz,
                         .zx = ezx + r * w.zx,
                         .xz = ezx - r * w.zx};
}

/* Rotates a stress by the spin increment: Q s Q^T with Q = (1 - w/2)^-1 (1 + w/2), a proper
 * rotation that agrees with (45) to first order. With the sum s + w.s - s.w the deviator of a body
 * that rotates once in n steps would grow by the factor exp(8 pi^2/n). */
MPSI_INLINE mpsi_sym mpsi_turn(const int geometry, mpsi_sym s, mpsi_spin w) {
  if (geometry != MPSI_SPACE) {
    const double q = 0.25 * w.xy * w.xy, r = 1.0 / (1.0 + q);
    const double sine = r * w.xy, cosine = r * (1.0 - q), half = 0.5 * (s.xx - s.yy);
    const double change = 2.0 * sine * (cosine * s.xy - sine * half);
    s.xy -= 2.0 * sine * (cosine * half + sine * s.xy);
    s.xx += change;
    s.yy -= change;
    return s;
  }
  const mpsi_rotation q = mpsi_rotation_of(w);
  const double axx = q.xx * s.xx + q.xy * s.xy + q.xz * s.zx; /* Q s */
  const double axy = q.xx * s.xy + q.xy * s.yy + q.xz * s.yz;
  const double axz = q.xx * s.zx + q.xy * s.yz + q.xz * s.zz;
  const double ayx = q.yx * s.xx + q.yy * s.xy + q.yz * s.zx;
  const double ayy = q.yx * s.xy + q.yy * s.yy + q.yz * s.yz;
  const double ayz = q.yx * s.zx + q.yy * s.yz + q.yz * s.zz;
  const double azx = q.zx * s.xx + q.zy * s.xy + q.zz * s.zx;
  const double azy = q.zx * s.xy + q.zy * s.yy + q.zz * s.yz;
  const double azz = q.zx * s.zx + q.zy * s.yz + q.zz * s.zz;
  return (mpsi_sym){.xx = axx * q.xx + axy * q.xy + axz * q.xz,
                    .yy = ayx * q.yx + ayy * q.yy + ayz * q.yz,
                    .zz = azx * q.zx + azy * q.zy + azz * q.zz,
                    .xy = axx * q.yx + axy * q.yy + axz * q.yz,
                    .yz = ayx * q.zx + ayy * q.zy + ayz * q.zz,
                    .zx = azx * q.xx + azy * q.xy + azz * q.xz};
}

/* s + C:d. */
MPSI_INLINE mpsi_sym mpsi_hooke(const mpsi_law *law, mpsi_sym s, mpsi_sym d) {
  const double mean = law->lambda * (d.xx + d.yy + d.zz), g2 = 2.0 * law->shear;
  return (mpsi_sym){.xx = s.xx + (mean + g2 * d.xx),
                    .yy = s.yy + (mean + g2 * d.yy),
                    .zz = s.zz + (mean + g2 * d.zz),
                    .xy = s.xy + g2 * d.xy,
                    .yz = s.yz + g2 * d.yz,
                    .zx = s.zx + g2 * d.zx};
}
