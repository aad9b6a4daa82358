/* kernels.c - the time step's inner loops: pair forces seed A (A1)-(A14), Rayleigh damping (A24)
 * and the three integrators (2)-(8). This file is compiled once for each instruction set, with
 * MPSI_LEVEL set; fused multiply-add is off (build flags), so every level gives the same bits.
 *
 * Two passes, since a pair's pressure force needs both pressures. The first leaves kc e of each
 * pair in its slot; the second then never looks at neighbours' positions, so a block may move its
 * particles while others still work.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#define CONCAT_(a, b) a##b
#define CONCAT(a, b) CONCAT_(a, b)
#define SIMD _Pragma("omp simd")

enum { MEAN_ANGLE, MEAN_MATRIX };
enum { EULER, LEAPFROG, VERLET };

/* ---- pairs ----------------------------------------------------------------------------------- */

/* Where the two ends of a chunk of pairs are read. */
typedef struct ends {
  const double *dxi, *dyi, *ci, *si, *mi;
  const double *dxj, *dyj, *cj, *sj, *mj;
} ends;

/* What a pair contributes: force on i (minus on j), torque and divergence of both. */
typedef struct pair_terms {
  double *fx, *fy, *torque, *div;
} pair_terms;

/* Pair terms of a chunk. PER = 0: one offset for the chunk; 1: one a pair. */
MPSI_INLINE void pair_chunk(const int removal, const int PER, int32_t n, ends e, const double *r0x,
                            const double *r0y, const double *kf, const double *kc, pair_terms out,
                            double *restrict ex, double *restrict ey) {
  double *restrict fx = out.fx, *restrict fy = out.fy;
  double *restrict torque = out.torque, *restrict div = out.div;
  SIMD for (int32_t t = 0; t < n; t++) {
    const int32_t k = PER * t;
    double a, b;                  /* mean rotation minus one: its cosine and sine parts */
    if (removal == MEAN_MATRIX) { /* (12) */
      a = 0.5 * (e.ci[t] + e.cj[t]);
      b = 0.5 * (e.si[t] + e.sj[t]);
    } else { /* (11), by the addition theorem on half angles */
      a = e.ci[t] + e.cj[t] + (e.ci[t] * e.cj[t] - e.si[t] * e.sj[t]);
      b = e.si[t] * (1.0 + e.cj[t]) + (1.0 + e.ci[t]) * e.sj[t];
    }
    const double ddx = e.dxj[t] - e.dxi[t], ddy = e.dyj[t] - e.dyi[t];
    const double ux = ddx - (a * r0x[k] - b * r0y[k]); /* u = r - R r0, r = r0 + dd */
    const double uy = ddy - (b * r0x[k] + a * r0y[k]);
    const double rx = r0x[k] + ddx, ry = r0y[k] + ddy;
    const double kinv = kc[k] / sqrt(rx * rx + ry * ry);
    const double kex = kinv * rx, key = kinv * ry;
    const double stiff = kf[k] * (e.mi[t] + e.mj[t]);
    const double px = stiff * ux, py = stiff * uy; /* normal and shear together: un + us = u */
    fx[t] = px;
    fy[t] = py;
    torque[t] = rx * py - ry * px; /* r x un = 0, so r x us = r x u: (A13) */
    div[t] = kex * ux + key * uy;
    ex[t] = kex;
    ey[t] = key;
  }
}

/* target += sign * term over a chunk. */
MPSI_INLINE void add(double *restrict target, const double *restrict term, double sign, int32_t n) {
  SIMD for (int32_t t = 0; t < n; t++) target[t] += sign * term[t];
}

MPSI_INLINE void pass1_run(const int removal, const mpsi_state *s, const mpsi_run *run,
                           int32_t begin, pair_terms sums, pair_terms terms, double *ex,
                           double *ey) {
  for (int32_t t0 = 0; t0 < run->count; t0 += MPSI_DYN_CHUNK) {
    const int32_t left = run->count - t0, n = left < MPSI_DYN_CHUNK ? left : MPSI_DYN_CHUNK;
    const int64_t i = run->i0 + t0, j = run->j0 + t0;
    const ends e = {s->dx + i, s->dy + i, s->c + i, s->s + i, s->mu + i,
                    s->dx + j, s->dy + j, s->c + j, s->s + j, s->mu + j};
    pair_chunk(removal, 0, n, e, &run->r0x, &run->r0y, &run->kf, &run->kc, terms, ex + t0, ey + t0);
    if (run->own_i) {
      add(sums.fx + (i - begin), terms.fx, 1.0, n);
      add(sums.fy + (i - begin), terms.fy, 1.0, n);
      add(sums.torque + (i - begin), terms.torque, 1.0, n);
      add(sums.div + (i - begin), terms.div, 1.0, n);
    }
    if (run->own_j) {
      add(sums.fx + (j - begin), terms.fx, -1.0, n);
      add(sums.fy + (j - begin), terms.fy, -1.0, n);
      add(sums.torque + (j - begin), terms.torque, 1.0, n);
      add(sums.div + (j - begin), terms.div, 1.0, n);
    }
  }
}

/* Copies the ends of n scattered pairs together, so that the same vector loop serves them. */
MPSI_INLINE void gather(double *restrict to, const double *restrict from,
                        const int32_t *restrict index, int32_t n) {
  for (int32_t t = 0; t < n; t++) to[t] = from[index[t]];
}

MPSI_INLINE void pass1_scattered(const int removal, const mpsi_state *s, const mpsi_scattered *list,
                                 int64_t k, int32_t n, int32_t begin, pair_terms sums,
                                 pair_terms terms, double *room, double *ex, double *ey) {
  const double *from[5] = {s->dx, s->dy, s->c, s->s, s->mu};
  for (int f = 0; f < 5; f++) {
    gather(room + f * MPSI_DYN_CHUNK, from[f], list->i + k, n);
    gather(room + (5 + f) * MPSI_DYN_CHUNK, from[f], list->j + k, n);
  }
#define ROOM(f) (room + (f)*MPSI_DYN_CHUNK)
  const ends e = {ROOM(0), ROOM(1), ROOM(2), ROOM(3), ROOM(4),
                  ROOM(5), ROOM(6), ROOM(7), ROOM(8), ROOM(9)};
#undef ROOM
  pair_chunk(removal, 1, n, e, list->r0x + k, list->r0y + k, list->kf + k, list->kc + k, terms, ex,
             ey);
  for (int32_t t = 0; t < n; t++) {
    if (list->ti[k + t] >= 0) {
      const int32_t i = list->ti[k + t] - begin;
      sums.fx[i] += terms.fx[t];
      sums.fy[i] += terms.fy[t];
      sums.torque[i] += terms.torque[t];
      sums.div[i] += terms.div[t];
    }
    if (list->tj[k + t] >= 0) {
      const int32_t j = list->tj[k + t] - begin;
      sums.fx[j] -= terms.fx[t];
      sums.fy[j] -= terms.fy[t];
      sums.torque[j] += terms.torque[t];
      sums.div[j] += terms.div[t];
    }
  }
}

MPSI_INLINE void pass1(const int removal, const mpsi_state *s, const mpsi_mesh *mesh, int64_t b,
                       double *scratch) {
  const mpsi_block *block = &mesh->block[b];
  const int32_t begin = block->begin, n = block->end - begin;
  const pair_terms sums = {scratch, scratch + MPSI_DYN_BLOCK, scratch + 2 * MPSI_DYN_BLOCK,
                           scratch + 3 * MPSI_DYN_BLOCK};
  double *room = scratch + 4 * MPSI_DYN_BLOCK;
  const pair_terms terms = {room, room + MPSI_DYN_CHUNK, room + 2 * MPSI_DYN_CHUNK,
                            room + 3 * MPSI_DYN_CHUNK};
  room += 4 * MPSI_DYN_CHUNK;
  for (int64_t k = 0; k < 4 * MPSI_DYN_BLOCK; k++) scratch[k] = 0.0;

  int64_t slot = block->slot;
  for (int64_t r = block->run_begin; r < block->run_end; slot += mesh->run[r++].count)
    pass1_run(removal, s, &mesh->run[r], begin, sums, terms, s->ex + slot, s->ey + slot);
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k += MPSI_DYN_CHUNK) {
    const int64_t left = block->scattered_end - k;
    const int32_t m = left < MPSI_DYN_CHUNK ? (int32_t)left : MPSI_DYN_CHUNK;
    pass1_scattered(removal, s, &mesh->scattered, k, m, begin, sums, terms, room, s->ex + slot,
                    s->ey + slot);
    slot += m;
  }

  double *restrict gx = s->gx + begin, *restrict gy = s->gy + begin, *restrict gth = s->gth + begin;
  double *restrict p = s->p + begin;
  const double *restrict lambda = s->lambda + begin;
  SIMD for (int32_t t = 0; t < n; t++) {
    gx[t] = sums.fx[t];
    gy[t] = sums.fy[t];
    gth[t] = sums.torque[t];
    p[t] = -lambda[t] * sums.div[t]; /* (A11) */
  }
}

/* ---- rotation -------------------------------------------------------------------------------- */

/* cos(x) - 1 and sin(x): reduction to [-pi/4, pi/4] in three parts of pi/2, then the power series.
 * Exact to 1 ulp or so for |x| < 1e5; beyond that a body has long diverged. */
MPSI_INLINE void cosm1_sin(double x, double *cosm1, double *sine) {
  const double magic = 0x1.8p52; /* adding it rounds to an integer */
  const double k = (x * 0x1.45f306dc9c883p-1 + magic) - magic;
  const double r = ((x - k * 0x1.921fb544p0) - k * 0x1.0b4611a6p-34) - k * 0x1.3198a2e037073p-69;
  const double z = r * r;
  const double sn =
      r +
      r * z *
          (-1.0 / 6 +
           z * (1.0 / 120 +
                z * (-1.0 / 5040 + z * (1.0 / 362880 + z * (-1.0 / 39916800 +
                                                            z * (1.0 / 6227020800.0 +
                                                                 z * (-1.0 / 1307674368000.0)))))));
  const double cm =
      -0.5 * z +
      z * z *
          (1.0 / 24 +
           z * (-1.0 / 720 + z * (1.0 / 40320 + z * (-1.0 / 3628800 +
                                                     z * (1.0 / 479001600.0 +
                                                          z * (-1.0 / 87178291200.0 +
                                                               z * (1.0 / 20922789888000.0)))))));
  /* quadrant k mod 4, as doubles: 0, 1, 2, 3 */
  const double k4 = 0.25 * k, down = (k4 + magic) - magic; /* nearest; halves go to even */
  const double quarter = 4.0 * (k4 - down);                /* -2, -1, 0, 1 or 2 */
  const double odd = quarter * quarter == 1.0 ? 1.0 : 0.0;
  const double half = quarter * quarter == 4.0 ? -1.0 : 1.0;
  *sine = odd != 0.0 ? quarter * (1.0 + cm) : half * sn;
  *cosm1 = odd != 0.0 ? -quarter * sn - 1.0 : (half > 0.0 ? cm : -2.0 - cm);
}

MPSI_INLINE void trig(const int removal, const mpsi_state *s, int64_t begin, int64_t end) {
  const double *restrict th = s->th;
  double *restrict c = s->c, *restrict sn = s->s;
  const double part = removal == MEAN_MATRIX ? 1.0 : 0.5;
  SIMD for (int64_t t = begin; t < end; t++) {
    double cosm1, sine;
    cosm1_sin(part * th[t], &cosm1, &sine);
    c[t] = cosm1;
    sn[t] = sine;
  }
}

/* ---- second pass ----------------------------------------------------------------------------- */

/* Subtracts the pressure forces (p_i + p_j) kc e of a block from its sums (A10). */
MPSI_INLINE void pressure_forces(const mpsi_state *s, const mpsi_mesh *mesh,
                                 const mpsi_block *block, double *restrict fx, double *restrict fy,
                                 double *restrict bx, double *restrict by) {
  const double *p = s->p;
  const int32_t begin = block->begin;
  int64_t slot = block->slot;
  for (int64_t r = block->run_begin; r < block->run_end; r++) {
    const mpsi_run *run = &mesh->run[r];
    for (int32_t t0 = 0; t0 < run->count; t0 += MPSI_DYN_CHUNK) {
      const int32_t left = run->count - t0, n = left < MPSI_DYN_CHUNK ? left : MPSI_DYN_CHUNK;
      const double *restrict pi = p + run->i0 + t0, *restrict pj = p + run->j0 + t0;
      const double *restrict ex = s->ex + slot + t0, *restrict ey = s->ey + slot + t0;
      SIMD for (int32_t t = 0; t < n; t++) {
        const double sum = pi[t] + pj[t];
        bx[t] = sum * ex[t];
        by[t] = sum * ey[t];
      }
      if (run->own_i) {
        add(fx + (run->i0 + t0 - begin), bx, -1.0, n);
        add(fy + (run->i0 + t0 - begin), by, -1.0, n);
      }
      if (run->own_j) {
        add(fx + (run->j0 + t0 - begin), bx, 1.0, n);
        add(fy + (run->j0 + t0 - begin), by, 1.0, n);
      }
    }
    slot += run->count;
  }
  const mpsi_scattered *list = &mesh->scattered;
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++, slot++) {
    const double sum = p[list->i[k]] + p[list->j[k]];
    const double x = sum * s->ex[slot], y = sum * s->ey[slot];
    if (list->ti[k] >= 0) fx[list->ti[k] - begin] -= x, fy[list->ti[k] - begin] -= y;
    if (list->tj[k] >= 0) fx[list->tj[k] - begin] += x, fy[list->tj[k] - begin] += y;
  }
}

/* One degree of freedom of a block: damping (A24), then the integrator. `g` holds the block's
 * restoring accelerations, and receives the total ones. */
MPSI_INLINE void advance(const int integrator, const int damped, const mpsi_step *step, int32_t n,
                         double *restrict g, double *restrict d, double *restrict o,
                         double *restrict v, double *restrict h, const double *restrict alpha,
                         const double *restrict beta) {
  const double dt = step->dt, rdt = 1.0 / dt;
  if (damped && step->first) SIMD for (int32_t t = 0; t < n; t++) h[t] = g[t];
  SIMD for (int32_t t = 0; t < n; t++) {
    double a = g[t];
    if (damped) {
      const double speed = integrator == VERLET ? (d[t] - o[t]) * rdt : v[t];
      const double b = beta[t] * rdt;
      a = a + b * (a - h[t]) - alpha[t] * speed;
      h[t] = g[t];
      g[t] = a;
    }
    if (integrator == VERLET) {
      const double now = d[t];
      d[t] = now + ((now - o[t]) + dt * dt * a); /* (8); differences first keep small motion */
      o[t] = now;
    } else if (integrator == LEAPFROG) {
      const double speed = v[t] + dt * a; /* (4) */
      v[t] = speed;
      d[t] = d[t] + dt * speed; /* (5) */
    } else {
      d[t] = d[t] + dt * v[t]; /* (2) with r_{k-1} on the right */
      v[t] = v[t] + dt * a;    /* (3) */
    }
  }
}

MPSI_INLINE int pass2(const int removal, const int integrator, const int damped,
                      const mpsi_state *s, const mpsi_mesh *mesh, int64_t b, const mpsi_step *step,
                      double *scratch) {
  const mpsi_block *block = &mesh->block[b];
  const int32_t begin = block->begin, n = block->end - begin;
  double *restrict fx = scratch, *restrict fy = scratch + MPSI_DYN_BLOCK;
  double *restrict ft = scratch + 2 * MPSI_DYN_BLOCK;
  const double *restrict gx = s->gx + begin, *restrict gy = s->gy + begin,
                         *restrict gth = s->gth + begin;
  SIMD for (int32_t t = 0; t < n; t++) fx[t] = gx[t], fy[t] = gy[t];
  pressure_forces(s, mesh, block, fx, fy, scratch + 4 * MPSI_DYN_BLOCK,
                  scratch + 4 * MPSI_DYN_BLOCK + MPSI_DYN_CHUNK);
  const double *restrict ix = s->ix + begin, *restrict iy = s->iy + begin,
                         *restrict ith = s->ith + begin;
  SIMD for (int32_t t = 0; t < n; t++) {
    fx[t] *= ix[t];
    fy[t] *= iy[t];
    ft[t] = gth[t] * ith[t];
  }
  const double *alpha = s->alpha + begin, *beta = s->beta + begin;
  advance(integrator, damped, step, n, fx, s->dx + begin, s->ox + begin, s->vx + begin,
          s->hx + begin, alpha, beta);
  advance(integrator, damped, step, n, fy, s->dy + begin, s->oy + begin, s->vy + begin,
          s->hy + begin, alpha, beta);
  advance(integrator, damped, step, n, ft, s->th + begin, s->oth + begin, s->vth + begin,
          s->hth + begin, alpha, beta);
  trig(removal, s, begin, block->end);

  double bad = 0.0;
  const double limit2 = step->limit2;
#pragma omp simd reduction(+ : bad)
  for (int32_t t = 0; t < n; t++) bad += fx[t] * fx[t] + fy[t] * fy[t] <= limit2 ? 0.0 : 1.0;
  if (step->output || bad != 0.0) {
    double *restrict ax = s->ax + begin, *restrict ay = s->ay + begin;
    SIMD for (int32_t t = 0; t < n; t++) ax[t] = fx[t], ay[t] = fy[t];
  }
  return bad != 0.0;
}

/* ---- variants -------------------------------------------------------------------------------- */

#define PASS1(removal)                                                                             \
  static void pass1_##removal(const mpsi_state *s, const mpsi_mesh *mesh, int64_t b,               \
                              double *scratch) {                                                   \
    pass1(removal, s, mesh, b, scratch);                                                           \
  }                                                                                                \
  static void trig_##removal(const mpsi_state *s, int64_t begin, int64_t end) {                    \
    trig(removal, s, begin, end);                                                                  \
  }
#define PASS2(removal, integrator, damped)                                                         \
  static int pass2_##removal##_##integrator##_##damped(const mpsi_state *s, const mpsi_mesh *mesh, \
                                                       int64_t b, const mpsi_step *step,           \
                                                       double *scratch) {                          \
    return pass2(removal, integrator, damped, s, mesh, b, step, scratch);                          \
  }
#define PASS2_ALL(removal)                                                                         \
  PASS2(removal, EULER, 0)                                                                         \
  PASS2(removal, EULER, 1)                                                                         \
  PASS2(removal, LEAPFROG, 0)                                                                      \
  PASS2(removal, LEAPFROG, 1)                                                                      \
  PASS2(removal, VERLET, 0)                                                                        \
  PASS2(removal, VERLET, 1)
#define PASS2_TABLE(removal)                                                                       \
  {                                                                                                \
    {pass2_##removal##_EULER_0, pass2_##removal##_EULER_1},                                        \
        {pass2_##removal##_LEAPFROG_0, pass2_##removal##_LEAPFROG_1}, {                            \
      pass2_##removal##_VERLET_0, pass2_##removal##_VERLET_1                                       \
    }                                                                                              \
  }

PASS1(MEAN_ANGLE)
PASS1(MEAN_MATRIX)
PASS2_ALL(MEAN_ANGLE)
PASS2_ALL(MEAN_MATRIX)

const mpsi_kernels CONCAT(mpsi_kernels_v, MPSI_LEVEL) = {
    .pass1 = {pass1_MEAN_ANGLE, pass1_MEAN_MATRIX},
    .pass2 = {PASS2_TABLE(MEAN_ANGLE), PASS2_TABLE(MEAN_MATRIX)},
    .trig = {trig_MEAN_ANGLE, trig_MEAN_MATRIX},
};
