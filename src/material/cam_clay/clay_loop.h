/* clay_loop.h - Cam-Clay on a block, in vectors: trial, Newton's method of cam_clay.c for the
 * particles that yield, which are packed for it, and the results. The equations are those of
 * cam_clay.c with y = ln(p/p0) for ln p, so that a small step needs no logarithm and only
 * exponentials of small numbers, by their series. A particle with an open gap, less pressure than
 * `least_pressure`, a long step, or one for which Newton's method needs more takes the step of
 * cam_clay.c; which of the two depends on the particle alone. Both agree to rounding.
 * Included by laws.c alone, which compiles it for each instruction set. SPDX-License-Identifier:
 * BSD-3-Clause */
#ifndef MPSI_CLAY_LOOP_H
#define MPSI_CLAY_LOOP_H

#include "material/tensor.h"

#define CLAY_CHUNK 64
#define CLAY_LONGEST 1e-2  /* strain of an undivided step, as in cam_clay.c */
#define CLAY_LARGEST 0.125 /* argument of the series */
#define CLAY_ROUNDS 8      /* of Newton's method */

/* What a particle is; doubles, as the vectors' other values. */
#define CLAY_ELASTIC 0.0
#define CLAY_YIELDS 1.0
#define CLAY_ALONE 2.0 /* the step of cam_clay.c */

typedef struct clay_trial {
  double dev[6][CLAY_CHUNK]; /* deviator of the trial, Pa */
  double q[CLAY_CHUNK], m2[CLAY_CHUNK], shear[CLAY_CHUNK], y[CLAY_CHUNK], p0[CLAY_CHUNK];
  double v0[CLAY_CHUNK], ratio[CLAY_CHUNK]; /* v before; V1/V0 */
  double p[CLAY_CHUNK], scale[CLAY_CHUNK];  /* of the result */
  double kind[CLAY_CHUNK];
} clay_trial;

/* The particles that yield, in units of their pc0. */
typedef struct clay_packed {
  double p0[CLAY_CHUNK], dv[CLAY_CHUNK], vm[CLAY_CHUNK], q2[CLAY_CHUNK], rate[CLAY_CHUNK];
  double y[CLAY_CHUNK], g[CLAY_CHUNK];
  double p[CLAY_CHUNK], pc[CLAY_CHUNK], D[CLAY_CHUNK];
  double state[CLAY_CHUNK]; /* 0: Newton's method works on it, 1: solved, 2: not */
  int64_t at[CLAY_CHUNK];
} clay_packed;

/* exp(x), |x| <= CLAY_LARGEST: 1e-17. */
MPSI_INLINE double clay_exp(double x) {
  const double x2 = x * x, x4 = x2 * x2;
  const double a = 1.0 + x, b = 1.0 / 2.0 + x * (1.0 / 6.0);
  const double c = 1.0 / 24.0 + x * (1.0 / 120.0), d = 1.0 / 720.0 + x * (1.0 / 5040.0);
  const double e = 1.0 / 40320.0 + x * (1.0 / 362880.0) + x2 * (1.0 / 3628800.0);
  return a + x2 * b + x4 * (c + x2 * d + x4 * e);
}

MPSI_INLINE double clay_size(double x) { return x < 0.0 ? -x : x; }

/* M^2 in the direction of the deviator, as in cam_clay.c. */
MPSI_INLINE double clay_slope(const mpsi_law *law, mpsi_sym s, double q) {
  const double m2 = law->slope * law->slope, a4 = law->lode;
  const double j3 = s.xx * (s.yy * s.zz - s.yz * s.yz) - s.xy * (s.xy * s.zz - s.yz * s.zx) +
                    s.zx * (s.xy * s.yz - s.yy * s.zx);
  const double sine = 13.5 * j3 / (q * q * q + 1e-300);
  const double low = sine < -1.0 ? -1.0 : sine, within = low > 1.0 ? 1.0 : low;
  const double turned = m2 * sqrt(2.0 * a4 / (1.0 + a4 + (1.0 - a4) * within));
  return q > 0.0 ? turned : m2;
}

/* The elastic step of particles [begin, begin + count), and whether it yields. */
MPSI_INLINE void clay_try(const int geometry, const bool lode, const mpsi_law *constants,
                          const mps_material_block *block, int64_t begin, int64_t count,
                          clay_trial *t) {
  const mpsi_law law = *constants;
  const mpsi_law_columns columns = mpsi_columns_of(block);
  const double *pcs = block->history[MPSI_CLAY_PC] + begin;
  const double *voids = block->history[MPSI_CLAY_VOID] + begin;
  const double *gaps = block->history[MPSI_CLAY_GAP] + begin;
  const double dt = block->dt, per_swelling = 1.0 / law.swelling, third = 1.0 / 3.0;
  const double m2 = law.slope * law.slope, least = law.least_pressure;
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, begin + k, dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, begin + k, dt);
    mpsi_sym s = mpsi_turn(geometry, mpsi_stress(geometry, &columns, begin + k), w);
    const double old = (s.xx + s.yy + s.zz) * third, growth = d.xx + d.yy + d.zz;
    const double mean = growth * third, half = 0.5 * growth, p0 = 0.0 - old;
    const double v0 = 1.0 + voids[k], bulk = v0 * p0 * per_swelling;
    const double shear = law.shear_ratio > 0.0 ? law.shear_ratio * bulk : law.shear;
    const double g2 = 2.0 * shear;
    s.xx += g2 * (d.xx - mean) - old, s.yy += g2 * (d.yy - mean) - old;
    s.zz += g2 * (d.zz - mean) - old, s.xy += g2 * d.xy;
    s.zx += g2 * d.zx, s.yz += g2 * d.yz;
    const double q = sqrt(1.5 * (s.xx * s.xx + s.yy * s.yy + s.zz * s.zz) +
                          3.0 * (s.xy * s.xy + s.zx * s.zx + s.yz * s.yz));
    const double slope = lode ? clay_slope(&law, s, q) : m2;
    const double ratio = (1.0 + half) / (1.0 - half), y = v0 * (1.0 - ratio) * per_swelling;
    const double p = p0 * clay_exp(y), pc = pcs[k];
    const double square =
        (d.xx * d.xx + d.yy * d.yy + d.zz * d.zz) + 2.0 * (d.xy * d.xy + d.zx * d.zx + d.yz * d.yz);
    const int bears = (gaps[k] == 0.0) & (p0 >= least) & (p >= least) & (pc >= 2.0 * least);
    const int near = clay_size(y) <= CLAY_LARGEST, brief = square <= CLAY_LONGEST * CLAY_LONGEST;
    const int plain = bears & near & brief;
    const double over = q * q + slope * (p * (p - pc));
    const double kind = over > 0.0 ? CLAY_YIELDS : CLAY_ELASTIC;
    t->dev[0][k] = s.xx, t->dev[1][k] = s.yy, t->dev[2][k] = s.zz, t->dev[3][k] = s.xy;
    if (geometry == MPSI_SPACE) t->dev[4][k] = s.zx, t->dev[5][k] = s.yz;
    t->q[k] = q, t->m2[k] = slope, t->shear[k] = shear, t->y[k] = y, t->p0[k] = p0;
    t->v0[k] = v0, t->ratio[k] = ratio, t->p[k] = p, t->scale[k] = 1.0;
    t->kind[k] = plain ? kind : CLAY_ALONE;
  }
}

MPSI_INLINE int64_t clay_pack(const mps_material_block *block, int64_t begin, int64_t count,
                              const clay_trial *t, clay_packed *c) {
  int64_t n = 0;
  for (int64_t k = 0; k < count; k++) {
    if (t->kind[k] != CLAY_YIELDS) continue;
    const double per_pc = 1.0 / block->history[MPSI_CLAY_PC][begin + k], per_m2 = 1.0 / t->m2[k];
    const double v1 = t->v0[k] * t->ratio[k], q = t->q[k] * per_pc;
    c->p0[n] = t->p0[k] * per_pc;
    c->dv[n] = t->v0[k] - v1, c->vm[n] = 0.5 * (t->v0[k] + v1);
    c->q2[n] = q * q * per_m2;
    c->rate[n] = 6.0 * t->shear[k] * per_pc * per_m2;
    c->y[n] = t->y[k], c->g[n] = 0.0, c->state[n] = 0.0;
    c->at[n++] = k;
  }
  return n;
}

/* One round of Newton's method; returns how many particles are left. */
MPSI_INLINE double clay_round(const mpsi_law *law, int64_t n, clay_packed *c) {
  const double kappa = law->swelling, per_plastic = 1.0 / (law->compression - kappa);
  const double fall = kappa * per_plastic;
  double left = 0.0;
  _Pragma("omp simd reduction(+ : left)") for (int64_t k = 0; k < n; k++) {
    const double y = c->y[k], g = c->g[k], vm = c->vm[k], rate = c->rate[k];
    const double elastic = kappa * y, plastic = (c->dv[k] - elastic) * per_plastic;
    const double p = c->p0[k] * clay_exp(y), pc = clay_exp(plastic), D = 1.0 + rate * g;
    const double per_D = 1.0 / D, cut = c->q2[k] * per_D * per_D, twice = 2.0 * p - pc;
    const double r1 = (c->dv[k] - elastic) - vm * g * twice, r2 = cut + p * (p - pc);
    const int volume = clay_size(r1) <= 1e-14 * vm, yields = clay_size(r2) <= 1e-13 * (1.0 + p * p);
    const int done = volume & yields;
    const double yy = -kappa - vm * g * (2.0 * p + fall * pc), yg = -vm * twice;
    const double gy = p * twice + fall * p * pc, gg = -2.0 * cut * rate * per_D;
    const double det = yy * gg - yg * gy;
    const int regular = clay_size(det) > 1e-300, near = clay_size(y) <= CLAY_LARGEST;
    const int within = clay_size(plastic) <= CLAY_LARGEST, lost = !(regular & near & within);
    const double per_det = 1.0 / det;
    const double next = g + (gy * r1 - yy * r2) * per_det;
    const double state = done ? 1.0 : 0.0, now = lost ? 2.0 : state;
    const int works = c->state[k] == 0.0, moves = works & (now == 0.0);
    c->p[k] = works ? p : c->p[k], c->pc[k] = works ? pc : c->pc[k];
    c->D[k] = works ? D : c->D[k];
    c->y[k] = moves ? y + (yg * r2 - gg * r1) * per_det : y;
    c->g[k] = moves ? (next > 0.0 ? next : 0.0) : g;
    c->state[k] = works ? now : c->state[k];
    left += moves ? 1.0 : 0.0;
  }
  return left;
}

/* The results of the packed particles, in their places. */
MPSI_INLINE void clay_unpack(const mpsi_law *law, const mps_material_block *block, int64_t begin,
                             int64_t n, const clay_packed *c, clay_trial *t) {
  for (int64_t j = 0; j < n; j++) {
    const int64_t k = c->at[j];
    if (c->state[j] != 1.0) {
      t->kind[k] = CLAY_ALONE;
      continue;
    }
    double *pc = &block->history[MPSI_CLAY_PC][begin + k];
    const double next = c->pc[j] * *pc, least = 2.0 * law->least_pressure;
    t->p[k] = c->p[j] * *pc;
    t->scale[k] = 1.0 / c->D[j];
    block->history[MPSI_CLAY_STRAIN][begin + k] +=
        2.0 * c->g[j] * (t->q[k] / *pc) * t->scale[k] / t->m2[k];
    *pc = next > least ? next : least;
  }
}

/* The step of cam_clay.c for one particle. */
MPSI_INLINE void clay_step_alone(const int geometry, const mpsi_law *law,
                                 const mps_material_block *block, int64_t k) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *const *h = block->history;
  const mpsi_sym d = mpsi_strain(geometry, &columns, k, block->dt);
  const mpsi_spin w = mpsi_spin_of(geometry, &columns, k, block->dt);
  const mpsi_sym t = mpsi_turn(geometry, mpsi_stress(geometry, &columns, k), w);
  const double strain[6] = {d.xx, d.yy, d.zz, d.xy, d.zx, d.yz};
  double s[6] = {t.xx, t.yy, t.zz, t.xy, t.zx, t.yz};
  mpsi_clay clay = {.strain = h[MPSI_CLAY_STRAIN][k],
                    .pc = h[MPSI_CLAY_PC][k],
                    .void_ratio = h[MPSI_CLAY_VOID][k],
                    .gap = h[MPSI_CLAY_GAP][k],
                    .volume = block->volume_ratio[k]};
  block->flags[k] = mpsi_cam_clay_step(law, geometry == MPSI_SPACE ? 3 : 2, strain, s, &clay);
  h[MPSI_CLAY_STRAIN][k] = clay.strain;
  h[MPSI_CLAY_PC][k] = clay.pc;
  h[MPSI_CLAY_VOID][k] = clay.void_ratio;
  h[MPSI_CLAY_GAP][k] = clay.gap;
  block->volume_ratio[k] = clay.volume;
  mpsi_put_stress(
      geometry, &columns, k,
      (mpsi_sym){.xx = s[0], .yy = s[1], .zz = s[2], .xy = s[3], .zx = s[4], .yz = s[5]});
}

/* Writes the particles of the vectors; the others are stepped one by one. */
MPSI_INLINE void clay_finish(const int geometry, const mpsi_law *law,
                             const mps_material_block *block, int64_t begin, int64_t count,
                             const clay_trial *t) {
  double *voids = block->history[MPSI_CLAY_VOID] + begin, *volume = block->volume_ratio + begin;
  for (int64_t k = 0; k < count; k++) {
    if (t->kind[k] == CLAY_ALONE) {
      clay_step_alone(geometry, law, block, begin + k);
      continue;
    }
    for (int c = 0; c < (geometry == MPSI_SPACE ? 6 : 4); c++)
      block->stress[c][begin + k] = t->scale[k] * t->dev[c][k] - (c < 3 ? t->p[k] : 0.0);
    voids[k] = t->v0[k] * t->ratio[k] - 1.0;
    volume[k] *= t->ratio[k];
    block->flags[begin + k] = t->kind[k] == CLAY_YIELDS ? MPS_MATERIAL_FLAG_PLASTIC : 0;
  }
}

MPSI_INLINE mps_status cam_clay_loop(const int geometry, const mpsi_law *law,
                                     const mps_material_block *block) {
  for (int64_t begin = 0; begin < block->count; begin += CLAY_CHUNK) {
    const int64_t left = block->count - begin, count = left < CLAY_CHUNK ? left : CLAY_CHUNK;
    clay_trial t;
    clay_packed c;
    if (law->lode == 1.0)
      clay_try(geometry, false, law, block, begin, count, &t);
    else
      clay_try(geometry, true, law, block, begin, count, &t);
    const int64_t n = clay_pack(block, begin, count, &t, &c);
    double works = (double)n;
    for (int round = 0; round < CLAY_ROUNDS && works > 0.0; round++) works = clay_round(law, n, &c);
    clay_unpack(law, block, begin, n, &c, &t);
    clay_finish(geometry, law, block, begin, count, &t);
  }
  return MPS_OK;
}

#endif
