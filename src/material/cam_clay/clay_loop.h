/* clay_loop.h - Cam-Clay on a block, in vectors: trial, Newton's method of cam_clay.c for the
 * particles that yield, which are packed for it, and the results. The equations are those of
 * cam_clay.c with y = ln(p/p0) for ln p, so that a step needs no logarithm and only exponentials
 * of numbers up to 1, by their series. A particle with an open gap, less pressure than
 * `least_pressure`, a long step, one for which Newton's method needs more, or one that yields where
 * M follows the Lode angle takes the step of cam_clay.c; which of the two depends on the particle
 * alone. Both agree to rounding. Included by laws.c alone, which compiles it for each instruction
 * set. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "material/tensor.h"

#define CLAY_CHUNK 32
#define CLAY_LANES 8      /* doubles of the longest vector: a divisor of CLAY_CHUNK */
#define CLAY_LONGEST 1e-2 /* strain of an undivided step, as in cam_clay.c */
#define CLAY_LARGEST 1.0  /* argument of the exponentials */
#define CLAY_ROUNDS 12    /* of Newton's method */

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

/* The particles that yield: of their trials, and what is solved, in units of their pc0. */
typedef struct clay_packed {
  double pc0[CLAY_CHUNK], q[CLAY_CHUNK], m2[CLAY_CHUNK], shear[CLAY_CHUNK];
  double v0[CLAY_CHUNK], ratio[CLAY_CHUNK];
  double p0[CLAY_CHUNK], dv[CLAY_CHUNK], vm[CLAY_CHUNK], q2[CLAY_CHUNK], rate[CLAY_CHUNK];
  double y[CLAY_CHUNK], g[CLAY_CHUNK];
  double p[CLAY_CHUNK], pc[CLAY_CHUNK], D[CLAY_CHUNK];
  double state[CLAY_CHUNK];  /* 0: Newton's method works on it, 1: solved, 2: not */
  double strain[CLAY_CHUNK]; /* growth of the plastic strain */
  int64_t at[CLAY_CHUNK];
} clay_packed;

/* Vectors of particles, as long as the processor's: gcc leaves the round of Newton's method below
 * as a loop with branches. */
#if MPSI_LEVEL == 4
#define CLAY_WIDE 8
#elif MPSI_LEVEL == 3
#define CLAY_WIDE 4
#else
#define CLAY_WIDE 2
#endif
typedef double clay_wide __attribute__((vector_size(8 * CLAY_WIDE)));
typedef double clay_wide_any __attribute__((vector_size(8 * CLAY_WIDE), aligned(8), may_alias));
typedef int64_t clay_mask __attribute__((vector_size(8 * CLAY_WIDE))); /* of comparisons: 0 or -1 */

MPSI_INLINE clay_wide clay_get(const double *from) { return *(const clay_wide_any *)from; }
MPSI_INLINE void clay_put(double *to, clay_wide a) { *(clay_wide_any *)to = a; }
MPSI_INLINE clay_wide clay_select(clay_mask which, clay_wide a, clay_wide b) {
  return (clay_wide)((which & (clay_mask)a) | (~which & (clay_mask)b));
}
MPSI_INLINE clay_wide clay_sizes(clay_wide a) { return clay_select(a < 0.0, -a, a); }

/* exp(x), |x| <= CLAY_LARGEST: the series of exp(x/8) - 1, whose square, that of its square and so
 * on follow from (1 + a)^2 - 1 = a (2 + a). */
#define CLAY_EXP(type, name)                                                                       \
  MPSI_INLINE type name(type argument) {                                                           \
    const type x = 0.125 * argument, x2 = x * x, x4 = x2 * x2;                                     \
    const type b = 1.0 / 2.0 + x * (1.0 / 6.0), c = 1.0 / 24.0 + x * (1.0 / 120.0);                \
    const type d = 1.0 / 720.0 + x * (1.0 / 5040.0);                                               \
    const type e = 1.0 / 40320.0 + x * (1.0 / 362880.0) + x2 * (1.0 / 3628800.0);                  \
    const type once = x + (x2 * b + x4 * (c + x2 * d + x4 * e));                                   \
    const type twice = once * (2.0 + once), four = twice * (2.0 + twice);                          \
    return 1.0 + four * (2.0 + four);                                                              \
  }
CLAY_EXP(double, clay_exp)
CLAY_EXP(clay_wide, clay_exp_wide)

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

/* How many particles the vectors work on: those after the last are copies of it. */
MPSI_INLINE int64_t clay_padded(int64_t n) {
  return (n + CLAY_LANES - 1) / CLAY_LANES * CLAY_LANES;
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
    const double kind = over > 0.0 ? (lode ? CLAY_ALONE : CLAY_YIELDS) : CLAY_ELASTIC;
    t->dev[0][k] = s.xx, t->dev[1][k] = s.yy, t->dev[2][k] = s.zz, t->dev[3][k] = s.xy;
    if (geometry == MPSI_SPACE) t->dev[4][k] = s.zx, t->dev[5][k] = s.yz;
    t->q[k] = q, t->m2[k] = slope, t->shear[k] = shear, t->y[k] = y, t->p0[k] = p0;
    t->v0[k] = v0, t->ratio[k] = ratio, t->p[k] = p, t->scale[k] = 1.0;
    t->kind[k] = plain ? kind : CLAY_ALONE;
  }
  /* Vectors compare the lanes after the last too, where a host may trap what memory has there. */
  for (int64_t k = count; k < clay_padded(count); k++) t->kind[k] = CLAY_ELASTIC;
}

MPSI_INLINE int64_t clay_pack(const mps_material_block *block, int64_t begin, int64_t count,
                              const clay_trial *t, clay_packed *c) {
  const double *pcs = block->history[MPSI_CLAY_PC] + begin;
  int64_t n = 0;
  for (int64_t k = 0; k < count; k++) {
    c->at[n] = k; /* kept where n grows */
    n += t->kind[k] == CLAY_YIELDS;
  }
  const int64_t padded = clay_padded(n);
  for (int64_t j = n; j < padded; j++) c->at[j] = c->at[n - 1];
  for (int64_t j = 0; j < padded; j++) {
    const int64_t k = c->at[j];
    c->pc0[j] = pcs[k], c->m2[j] = t->m2[k], c->q[j] = t->q[k], c->shear[j] = t->shear[k];
    c->p0[j] = t->p0[k], c->y[j] = t->y[k], c->v0[j] = t->v0[k], c->ratio[j] = t->ratio[k];
  }
  _Pragma("omp simd") for (int64_t j = 0; j < padded; j++) {
    const double per_pc = 1.0 / c->pc0[j], per_m2 = 1.0 / c->m2[j], q = c->q[j] * per_pc;
    const double v0 = c->v0[j], v1 = v0 * c->ratio[j];
    c->p0[j] *= per_pc;
    c->dv[j] = v0 - v1, c->vm[j] = 0.5 * (v0 + v1);
    c->q2[j] = q * q * per_m2;
    c->rate[j] = 6.0 * c->shear[j] * per_pc * per_m2;
    c->g[j] = 0.0, c->state[j] = 0.0;
  }
  return n;
}

/* One round of Newton's method for the particles from k on; those that it moves are marked. */
MPSI_INLINE clay_mask clay_move(double kappa, double per_plastic, int64_t k, clay_packed *c) {
  const double fall = kappa * per_plastic;
  const clay_wide y = clay_get(c->y + k), g = clay_get(c->g + k), vm = clay_get(c->vm + k);
  const clay_wide dv = clay_get(c->dv + k), rate = clay_get(c->rate + k);
  const clay_wide state = clay_get(c->state + k);
  const clay_wide elastic = kappa * y, plastic = (dv - elastic) * per_plastic;
  const clay_wide p = clay_get(c->p0 + k) * clay_exp_wide(y), pc = clay_exp_wide(plastic);
  const clay_wide D = 1.0 + rate * g, per_D = 1.0 / D, twice = 2.0 * p - pc;
  const clay_wide cut = clay_get(c->q2 + k) * per_D * per_D;
  const clay_wide r1 = (dv - elastic) - vm * g * twice, r2 = cut + p * (p - pc);
  const clay_mask done = (clay_sizes(r1) <= 1e-14 * vm) & (clay_sizes(r2) <= 1e-13 * (1.0 + p * p));
  const clay_wide yy = -kappa - vm * g * (2.0 * p + fall * pc), yg = -vm * twice;
  const clay_wide gy = p * twice + fall * p * pc, gg = -2.0 * cut * rate * per_D;
  const clay_wide det = yy * gg - yg * gy, per_det = 1.0 / det;
  const clay_mask near = (clay_sizes(y) <= CLAY_LARGEST) & (clay_sizes(plastic) <= CLAY_LARGEST);
  const clay_mask lost = ~((clay_sizes(det) > 1e-300) & near);
  const clay_wide step = (yg * r2 - gg * r1) * per_det, next = g + (gy * r1 - yy * r2) * per_det;
  const clay_wide zero = {0.0}, up = clay_select(step > -1.0, step, zero - 1.0);
  const clay_mask works = state == 0.0, moves = works & ~(done | lost);
  const clay_wide now = clay_select(lost, zero + 2.0, clay_select(done, zero + 1.0, zero));
  clay_put(c->p + k, clay_select(works, p, clay_get(c->p + k)));
  clay_put(c->pc + k, clay_select(works, pc, clay_get(c->pc + k)));
  clay_put(c->D + k, clay_select(works, D, clay_get(c->D + k)));
  clay_put(c->y + k, clay_select(moves, y + clay_select(up < 1.0, up, zero + 1.0), y));
  clay_put(c->g + k, clay_select(moves, clay_select(next > 0.0, next, zero), g));
  clay_put(c->state + k, clay_select(works, now, state));
  return moves;
}

/* One round of Newton's method; whether particles are left. */
MPSI_INLINE bool clay_round(const mpsi_law *law, int64_t n, clay_packed *c) {
  const double kappa = law->swelling, per_plastic = 1.0 / (law->compression - kappa);
  clay_mask left = {0};
  int64_t any = 0;
  for (int64_t k = 0; k < n; k += CLAY_WIDE) left |= clay_move(kappa, per_plastic, k, c);
  for (int i = 0; i < CLAY_WIDE; i++) any |= left[i];
  return any != 0;
}

/* The results of the packed particles, in their places. */
MPSI_INLINE void clay_unpack(const mpsi_law *law, const mps_material_block *block, int64_t begin,
                             int64_t n, clay_packed *c, clay_trial *t) {
  const double least = 2.0 * law->least_pressure;
  const int64_t padded = clay_padded(n);
  _Pragma("omp simd") for (int64_t j = 0; j < padded; j++) {
    const double pc = c->pc[j] * c->pc0[j], scale = 1.0 / c->D[j];
    c->strain[j] = 2.0 * c->g[j] * (c->q[j] / c->pc0[j]) * scale / c->m2[j];
    c->p[j] *= c->pc0[j];
    c->D[j] = scale;
    c->pc[j] = pc > least ? pc : least;
  }
  for (int64_t j = 0; j < n; j++) {
    const int64_t k = c->at[j];
    if (c->state[j] != 1.0) {
      t->kind[k] = CLAY_ALONE;
      continue;
    }
    t->p[k] = c->p[j];
    t->scale[k] = c->D[j];
    block->history[MPSI_CLAY_STRAIN][begin + k] += c->strain[j];
    block->history[MPSI_CLAY_PC][begin + k] = c->pc[j];
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
  int64_t *flags = block->flags + begin;
  int64_t alone = 0;
  for (int64_t k = 0; k < count; k++) alone += t->kind[k] == CLAY_ALONE;
  for (int64_t k = 0; k < count && alone > 0; k++)
    if (t->kind[k] == CLAY_ALONE) clay_step_alone(geometry, law, block, begin + k);
  for (int c = 0; c < (geometry == MPSI_SPACE ? 6 : 4); c++) {
    double *stress = block->stress[c] + begin;
    const double part = c < 3 ? 1.0 : 0.0;
    _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
      const double now = t->scale[k] * t->dev[c][k] - part * t->p[k];
      stress[k] = t->kind[k] == CLAY_ALONE ? stress[k] : now;
    }
  }
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    const int here = t->kind[k] != CLAY_ALONE, yields = t->kind[k] == CLAY_YIELDS;
    voids[k] = here ? t->v0[k] * t->ratio[k] - 1.0 : voids[k];
    volume[k] = here ? volume[k] * t->ratio[k] : volume[k];
    flags[k] = here ? (yields ? MPS_MATERIAL_FLAG_PLASTIC : 0) : flags[k];
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
    bool works = n > 0;
    for (int round = 0; round < CLAY_ROUNDS && works; round++) works = clay_round(law, n, &c);
    clay_unpack(law, block, begin, n, &c, &t);
    clay_finish(geometry, law, block, begin, count, &t);
  }
  return MPS_OK;
}
