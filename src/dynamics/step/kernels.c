/* kernels.c - the time step's inner loops: pair forces Yoshida (A1)-(A14), Rayleigh damping (A24)
 * and the three integrators (2)-(8). This file is compiled once for each instruction set, with
 * MPSI_LEVEL set; fused multiply-add is off (build flags), so every level gives the same bits.
 *
 * Two passes, since a pair's pressure force needs both pressures. The first leaves kc e of each
 * pair in its slot; the second does not read neighbours' positions, so a block may move its
 * particles while others are still computed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"

#define CONCAT_(a, b) a##b
#define CONCAT(a, b) CONCAT_(a, b)
#define SIMD _Pragma("omp simd")

enum { MEAN_MATRIX, MEAN_ANGLE };
enum { VERLET, LEAPFROG, EULER };
enum { UNDAMPED, BY_PARTICLES, BY_PAIRS };
enum {
  PRESSURES = MPSI_DYN_PRESSURES,
  FORCES = MPSI_DYN_FORCES,
  DAMPED_FORCES = MPSI_DYN_DAMPED_FORCES
};

/* ---- pairs ----------------------------------------------------------------------------------- */

/* Where the two ends of a chunk of pairs are read: displacement, rotation, mu, beta. */
typedef struct ends {
  const double *dxi, *dyi, *ci, *si, *mi, *bi;
  const double *dxj, *dyj, *cj, *sj, *mj, *bj;
} ends;

/* Constants of a chunk of pairs: reference vector (m) from i to j, coefficients of the shear and
 * normal forces and of the divergence. */
typedef struct pair_constants {
  const double *r0x, *r0y, *kf, *kc;
} pair_constants;

/* Terms of a pair: force on i (minus on j), torque and divergence of both; with damping by pairs
 * also force and torque times the pair's beta. */
typedef struct pair_terms {
  double *fx, *fy, *torque, *div;
  double *sx, *sy, *st;
} pair_terms;

/* The first pass over one block. */
typedef struct first_pass {
  const mpsi_dynamics_state *s;
  int32_t begin;    /* number of the block's first particle, which has the sums [0] */
  pair_terms sums;  /* over the pairs of each particle of the block */
  pair_terms terms; /* of each pair of a chunk */
  double *ends;     /* 12 rows of MPSI_DYN_CHUNK: copies of the ends of scattered pairs */
} first_pass;

/* Seven rows of a length from `rows`. */
MPSI_INLINE pair_terms seven_rows(double *rows, int64_t length) {
  return (pair_terms){rows,
                      rows + length,
                      rows + 2 * length,
                      rows + 3 * length,
                      rows + 4 * length,
                      rows + 5 * length,
                      rows + 6 * length};
}

/* Terms of n pairs, and kc e of each in s->ex, s->ey from `slot` on. PER = 0: all have the same
 * constants; 1: each its own. */
MPSI_INLINE void pair_chunk(const int removal, const int want, const int PER, int32_t n, ends e,
                            pair_constants pair, const first_pass *pass, int64_t slot) {
  const pair_terms out = pass->terms;
  const double *r0x = pair.r0x, *r0y = pair.r0y, *kf = pair.kf, *kc = pair.kc;
  double *restrict ex = pass->s->ex + slot, *restrict ey = pass->s->ey + slot;
  double *restrict fx = out.fx, *restrict fy = out.fy;
  double *restrict torque = out.torque, *restrict div = out.div;
  double *restrict sx = out.sx, *restrict sy = out.sy, *restrict st = out.st;
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
    const double stiff = kf[k] * mpsi_dynamics_pair_shear(e.mi[t], e.mj[t]);
    const double px = stiff * ux, py = stiff * uy; /* normal and shear together: un + us = u */
    div[t] = kex * ux + key * uy;
    if (want >= FORCES) {
      fx[t] = px;
      fy[t] = py;
      torque[t] = rx * py - ry * px; /* r x un = 0, so r x us = r x u: (A13) */
      ex[t] = kex;
      ey[t] = key;
    }
    if (want == DAMPED_FORCES) {
      const double beta = 0.5 * (e.bi[t] + e.bj[t]);
      sx[t] = beta * px;
      sy[t] = beta * py;
      st[t] = beta * torque[t];
    }
  }
}

/* target += sign * term over a chunk. */
MPSI_INLINE void add(double *restrict target, const double *restrict term, double sign, int32_t n) {
  SIMD for (int32_t t = 0; t < n; t++) target[t] += sign * term[t];
}

/* Adds the terms of a chunk to one side's sums, which begin at `at`. */
MPSI_INLINE void add_terms(const int want, pair_terms sums, pair_terms terms, int64_t at,
                           double sign, int32_t n) {
  add(sums.div + at, terms.div, 1.0, n);
  if (want == PRESSURES) return;
  add(sums.fx + at, terms.fx, sign, n);
  add(sums.fy + at, terms.fy, sign, n);
  add(sums.torque + at, terms.torque, 1.0, n);
  if (want == FORCES) return;
  add(sums.sx + at, terms.sx, sign, n);
  add(sums.sy + at, terms.sy, sign, n);
  add(sums.st + at, terms.st, 1.0, n);
}

/* The pairs (i0 + t, j0 + t) of a run, which have the same constants; their slots begin at `slot`.
 */
MPSI_INLINE void pass1_run(const int removal, const int want, const first_pass *pass,
                           const mpsi_dynamics_pair_run *run, int64_t slot) {
  const mpsi_dynamics_state *s = pass->s;
  const pair_constants pair = {&run->r0x, &run->r0y, &run->kf, &run->kc};
  for (int32_t t0 = 0; t0 < run->count; t0 += MPSI_DYN_CHUNK) {
    const int32_t left = run->count - t0, n = left < MPSI_DYN_CHUNK ? left : MPSI_DYN_CHUNK;
    const int64_t i = run->i0 + t0, j = run->j0 + t0;
    const ends e = {s->dx + i, s->dy + i, s->c + i, s->s + i, s->mu + i, s->beta + i,
                    s->dx + j, s->dy + j, s->c + j, s->s + j, s->mu + j, s->beta + j};
    pair_chunk(removal, want, 0, n, e, pair, pass, slot + t0);
    /* j > i, so that a particle is j of an earlier pair than that of which it is i: in this order
     * its sums do not depend on the ends of chunks, nor on those of a run that is whole on another
     * rank. */
    if (run->own_j) add_terms(want, pass->sums, pass->terms, j - pass->begin, -1.0, n);
    if (run->own_i) add_terms(want, pass->sums, pass->terms, i - pass->begin, 1.0, n);
  }
}

/* Copies the ends of n scattered pairs together, so that the same vector loop serves them. */
MPSI_INLINE void gather(double *restrict to, const double *restrict from,
                        const int32_t *restrict index, int32_t n) {
  for (int32_t t = 0; t < n; t++) to[t] = from[index[t]];
}

/* n scattered pairs from the k-th of the list on; their slots begin at `slot`. */
MPSI_INLINE void pass1_scattered(const int removal, const int want, const first_pass *pass,
                                 const mpsi_dynamics_scattered *list, int64_t k, int32_t n,
                                 int64_t slot) {
  const mpsi_dynamics_state *s = pass->s;
  const pair_terms sums = pass->sums, terms = pass->terms;
  const double *from[6] = {s->dx, s->dy, s->c, s->s, s->mu, s->beta};
  for (int f = 0; f < 4 + want; f++) {
    gather(pass->ends + f * MPSI_DYN_CHUNK, from[f], list->i + k, n);
    gather(pass->ends + (6 + f) * MPSI_DYN_CHUNK, from[f], list->j + k, n);
  }
#define ROW(f) (pass->ends + (f)*MPSI_DYN_CHUNK)
  const ends e = {ROW(0), ROW(1), ROW(2), ROW(3), ROW(4),  ROW(5),
                  ROW(6), ROW(7), ROW(8), ROW(9), ROW(10), ROW(11)};
#undef ROW
  const pair_constants pair = {list->r0x + k, list->r0y + k, list->kf + k, list->kc + k};
  pair_chunk(removal, want, 1, n, e, pair, pass, slot);
  /* pair by pair: the order does not depend on the ends of chunks */
  for (int32_t t = 0; t < n; t++) {
    const int32_t target[2] = {list->ti[k + t], list->tj[k + t]};
    for (int side = 0; side < 2; side++) {
      const double sign = side == 0 ? 1.0 : -1.0;
      const int32_t at = target[side] - pass->begin;
      if (target[side] < 0) continue;
      sums.div[at] += terms.div[t];
      if (want == PRESSURES) continue;
      sums.fx[at] += sign * terms.fx[t];
      sums.fy[at] += sign * terms.fy[t];
      sums.torque[at] += terms.torque[t];
      if (want == FORCES) continue;
      sums.sx[at] += sign * terms.sx[t];
      sums.sy[at] += sign * terms.sy[t];
      sums.st[at] += terms.st[t];
    }
  }
}

MPSI_INLINE void pass1(const int removal, const int want, const mpsi_dynamics_state *s,
                       const mpsi_dynamics_mesh *mesh, int64_t b, double *scratch) {
  const mpsi_dynamics_block *block = &mesh->block[b];
  const int32_t begin = block->begin, n = block->end - begin;
  const int64_t rows = want == DAMPED_FORCES ? 7 : 4;
  const pair_terms sums = seven_rows(scratch, MPSI_DYN_BLOCK);
  const first_pass pass = {s, begin, sums, seven_rows(scratch + 7 * MPSI_DYN_BLOCK, MPSI_DYN_CHUNK),
                           scratch + 7 * (MPSI_DYN_BLOCK + MPSI_DYN_CHUNK)};
  for (int64_t row = 0; row < rows; row++) /* of another rank's block few particles are here */
    for (int32_t t = 0; t < n; t++) scratch[row * MPSI_DYN_BLOCK + t] = 0.0;

  int64_t slot = block->slot;
  for (int64_t r = block->run_begin; r < block->run_end; slot += mesh->run[r++].count)
    pass1_run(removal, want, &pass, &mesh->run[r], slot);
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k += MPSI_DYN_CHUNK) {
    const int64_t left = block->scattered_end - k;
    const int32_t m = left < MPSI_DYN_CHUNK ? (int32_t)left : MPSI_DYN_CHUNK;
    pass1_scattered(removal, want, &pass, &mesh->scattered, k, m, slot);
    slot += m;
  }

  double *restrict gx = s->gx + begin, *restrict gy = s->gy + begin, *restrict gth = s->gth + begin;
  double *restrict p = s->p + begin;
  const double *restrict lambda = s->lambda + begin;
  SIMD for (int32_t t = 0; t < n; t++) p[t] = -lambda[t] * sums.div[t]; /* (A11) */
  if (want == PRESSURES) return;
  SIMD for (int32_t t = 0; t < n; t++) {
    gx[t] = sums.fx[t];
    gy[t] = sums.fy[t];
    gth[t] = sums.torque[t];
  }
  if (want == FORCES) return;
  double *restrict sx = s->sx + begin, *restrict sy = s->sy + begin, *restrict sth = s->sth + begin;
  SIMD for (int32_t t = 0; t < n; t++) {
    sx[t] = sums.sx[t];
    sy[t] = sums.sy[t];
    sth[t] = sums.st[t];
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

MPSI_INLINE void trig(const int removal, const mpsi_dynamics_state *s, int64_t begin, int64_t end) {
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

/* Rows of a block in the second pass: forces, and the same times beta (damping by pairs). */
typedef struct forces {
  double *fx, *fy, *ft, *sx, *sy, *st;
} forces;

/* The second pass over one block. */
typedef struct second_pass {
  const mpsi_dynamics_state *s;
  int32_t begin; /* number of the block's first particle, which has the forces [0] */
  forces f;
  double *pair; /* 4 rows of MPSI_DYN_CHUNK: pressure forces of a chunk, and the same times beta */
} second_pass;

/* Subtracts the pressure forces (p_i + p_j) kc e of a run from its ends (A10); with damping by
 * pairs also (beta_i p_i + beta_j p_j) kc e. */
MPSI_INLINE void pressure_run(const int by_pairs, const second_pass *pass,
                              const mpsi_dynamics_pair_run *run, int64_t slot) {
  const mpsi_dynamics_state *s = pass->s;
  const forces f = pass->f;
  double *restrict bx = pass->pair, *restrict by = pass->pair + MPSI_DYN_CHUNK;
  double *restrict cx = pass->pair + 2 * MPSI_DYN_CHUNK, *restrict cy = cx + MPSI_DYN_CHUNK;
  for (int32_t t0 = 0; t0 < run->count; t0 += MPSI_DYN_CHUNK) {
    const int32_t left = run->count - t0, n = left < MPSI_DYN_CHUNK ? left : MPSI_DYN_CHUNK;
    const int64_t i = run->i0 + t0, j = run->j0 + t0;
    const double *restrict pi = s->p + i, *restrict pj = s->p + j;
    const double *restrict bi = s->beta + i, *restrict bj = s->beta + j;
    const double *restrict ex = s->ex + slot + t0, *restrict ey = s->ey + slot + t0;
    SIMD for (int32_t t = 0; t < n; t++) {
      const double sum = pi[t] + pj[t];
      bx[t] = sum * ex[t];
      by[t] = sum * ey[t];
      if (by_pairs) {
        const double damp = bi[t] * pi[t] + bj[t] * pj[t];
        cx[t] = damp * ex[t];
        cy[t] = damp * ey[t];
      }
    }
    const int own[2] = {run->own_i, run->own_j};
    for (int side = 0; side < 2; side++) {
      const int64_t at = (side == 0 ? i : j) - pass->begin;
      const double sign = side == 0 ? -1.0 : 1.0;
      if (!own[side]) continue;
      add(f.fx + at, bx, sign, n);
      add(f.fy + at, by, sign, n);
      if (!by_pairs) continue;
      add(f.sx + at, cx, sign, n);
      add(f.sy + at, cy, sign, n);
    }
  }
}

MPSI_INLINE void pressure_scattered(const int by_pairs, const second_pass *pass,
                                    const mpsi_dynamics_scattered *list, int64_t k, int64_t slot) {
  const mpsi_dynamics_state *s = pass->s;
  const forces f = pass->f;
  const int32_t i = list->i[k], j = list->j[k];
  const double sum = s->p[i] + s->p[j], damp = s->beta[i] * s->p[i] + s->beta[j] * s->p[j];
  const int32_t target[2] = {list->ti[k], list->tj[k]};
  for (int side = 0; side < 2; side++) {
    const int32_t at = target[side] - pass->begin;
    const double sign = side == 0 ? -1.0 : 1.0;
    if (target[side] < 0) continue;
    f.fx[at] += sign * (sum * s->ex[slot]);
    f.fy[at] += sign * (sum * s->ey[slot]);
    if (!by_pairs) continue;
    f.sx[at] += sign * (damp * s->ex[slot]);
    f.sy[at] += sign * (damp * s->ey[slot]);
  }
}

MPSI_INLINE void pressure_forces(const int by_pairs, const second_pass *pass,
                                 const mpsi_dynamics_mesh *mesh, const mpsi_dynamics_block *block) {
  int64_t slot = block->slot;
  for (int64_t r = block->run_begin; r < block->run_end; slot += mesh->run[r++].count)
    pressure_run(by_pairs, pass, &mesh->run[r], slot);
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++)
    pressure_scattered(by_pairs, pass, &mesh->scattered, k, slot++);
}

/* One degree of freedom of the particles of a block. */
typedef struct freedom {
  double *d, *o, *v, *h;      /* columns of mpsi_dynamics_state: dx, ox, vx, hx and so on */
  double *g;                  /* restoring accelerations; `advance` leaves the total ones */
  double *sk;                 /* the same times beta, of which the damping is the rate (A24) */
  const double *alpha, *beta; /* Rayleigh coefficients */
  double *drag;               /* receives the accelerations by damping; NULL: not stored */
} freedom;

/* Damping, then the integrator, for n particles. */
MPSI_INLINE void advance(const int integrator, const int damping, const mpsi_dynamics_step *step,
                         int32_t n, freedom f) {
  const double dt = step->dt, kick = step->kick, rdt = 1.0 / dt, rate = step->rate;
  double *restrict d = f.d, *restrict o = f.o, *restrict v = f.v, *restrict h = f.h;
  double *restrict g = f.g, *restrict sk = f.sk, *restrict drag = f.drag;
  const double *restrict alpha = f.alpha, *restrict beta = f.beta;
  if (damping == BY_PARTICLES) SIMD for (int32_t t = 0; t < n; t++) sk[t] = beta[t] * g[t];
  if (damping && step->first) SIMD for (int32_t t = 0; t < n; t++) h[t] = sk[t];
  if (damping && drag) SIMD for (int32_t t = 0; t < n; t++) {
      const double speed = integrator == VERLET ? (d[t] - o[t]) * rdt : v[t];
      drag[t] = (sk[t] - h[t]) * rate - alpha[t] * speed;
    }
  SIMD for (int32_t t = 0; t < n; t++) {
    double a = g[t];
    if (damping) {
      const double speed = integrator == VERLET ? (d[t] - o[t]) * rdt : v[t];
      a = a + (sk[t] - h[t]) * rate - alpha[t] * speed;
      h[t] = sk[t];
      g[t] = a;
    }
    if (integrator == VERLET) {
      const double now = d[t];
      d[t] = now + ((now - o[t]) + dt * kick * a); /* (8); differences first keep small motion */
      o[t] = now;
    } else if (integrator == LEAPFROG) {
      const double speed = v[t] + kick * a; /* (4) */
      v[t] = speed;
      d[t] = d[t] + dt * speed; /* (5) */
    } else {
      d[t] = d[t] + dt * v[t]; /* (2) with r_{k-1} on the right */
      v[t] = v[t] + dt * a;    /* (3) */
    }
  }
}

/* Restoring accelerations of a block: forces of the first pass, pressure forces, inverse masses. */
MPSI_INLINE void restoring(const int by_pairs, const second_pass *pass,
                           const mpsi_dynamics_mesh *mesh, const mpsi_dynamics_block *block) {
  const mpsi_dynamics_state *s = pass->s;
  const forces f = pass->f;
  const int32_t begin = block->begin, n = block->end - begin;
  const double *restrict gx = s->gx + begin, *restrict gy = s->gy + begin;
  const double *restrict gth = s->gth + begin;
  const double *restrict ix = s->ix + begin, *restrict iy = s->iy + begin;
  const double *restrict ith = s->ith + begin;
  double *restrict fx = f.fx, *restrict fy = f.fy, *restrict ft = f.ft;
  double *restrict sx = f.sx, *restrict sy = f.sy, *restrict st = f.st;
  const double *restrict px = s->sx + begin, *restrict py = s->sy + begin;
  const double *restrict pth = s->sth + begin;
  SIMD for (int32_t t = 0; t < n; t++) fx[t] = gx[t], fy[t] = gy[t];
  if (by_pairs) SIMD for (int32_t t = 0; t < n; t++) sx[t] = px[t], sy[t] = py[t];
  pressure_forces(by_pairs, pass, mesh, block);
  SIMD for (int32_t t = 0; t < n; t++) {
    fx[t] *= ix[t];
    fy[t] *= iy[t];
    ft[t] = gth[t] * ith[t];
  }
  if (by_pairs) SIMD for (int32_t t = 0; t < n; t++) {
      sx[t] *= ix[t];
      sy[t] *= iy[t];
      st[t] = pth[t] * ith[t];
    }
}

MPSI_INLINE int pass2(const int removal, const int integrator, const int damping,
                      const mpsi_dynamics_state *s, const mpsi_dynamics_mesh *mesh, int64_t b,
                      const mpsi_dynamics_step *step, double *scratch) {
  const mpsi_dynamics_block *block = &mesh->block[b];
  const int32_t begin = block->begin, n = block->end - begin;
  const forces f = {scratch,
                    scratch + MPSI_DYN_BLOCK,
                    scratch + 2 * MPSI_DYN_BLOCK,
                    scratch + 3 * MPSI_DYN_BLOCK,
                    scratch + 4 * MPSI_DYN_BLOCK,
                    scratch + 5 * MPSI_DYN_BLOCK};
  const second_pass pass = {s, begin, f, scratch + 7 * MPSI_DYN_BLOCK};
  restoring(damping == BY_PAIRS, &pass, mesh, block);
  const double *alpha = s->alpha + begin, *beta = s->beta + begin;
  double *drag[3] = {NULL, NULL, NULL};
  for (int c = 0; damping && step->drag && c < 3; c++)
    drag[c] = step->drag + c * step->stride + begin;
  const freedom x = {s->dx + begin, s->ox + begin, s->vx + begin, s->hx + begin, f.fx,
                     f.sx,          alpha,         beta,          drag[0]};
  const freedom y = {s->dy + begin, s->oy + begin, s->vy + begin, s->hy + begin, f.fy,
                     f.sy,          alpha,         beta,          drag[1]};
  const freedom th = {s->th + begin, s->oth + begin, s->vth + begin, s->hth + begin, f.ft,
                      f.st,          alpha,          beta,           drag[2]};
  advance(integrator, damping, step, n, x);
  advance(integrator, damping, step, n, y);
  advance(integrator, damping, step, n, th);
  trig(removal, s, begin, block->end);

  const double *restrict fx = f.fx, *restrict fy = f.fy;
  const double limit2 = step->limit2;
  double bad = 0.0;
#pragma omp simd reduction(+ : bad)
  for (int32_t t = 0; t < n; t++) bad += fx[t] * fx[t] + fy[t] * fy[t] <= limit2 ? 0.0 : 1.0;
  if (step->output || bad != 0.0) {
    double *restrict ax = s->ax + begin, *restrict ay = s->ay + begin;
    SIMD for (int32_t t = 0; t < n; t++) ax[t] = fx[t], ay[t] = fy[t];
  }
  return bad != 0.0;
}

/* ---- variants -------------------------------------------------------------------------------- */

#define PASS1(removal, want)                                                                       \
  static void pass1_##removal##_##want(                                                            \
      const mpsi_dynamics_state *s, const mpsi_dynamics_mesh *mesh, int64_t b, double *scratch) {  \
    pass1(removal, want, s, mesh, b, scratch);                                                     \
  }
#define TRIG(removal)                                                                              \
  static void trig_##removal(const mpsi_dynamics_state *s, int64_t begin, int64_t end) {           \
    trig(removal, s, begin, end);                                                                  \
  }
#define PASS2(removal, integrator, damping)                                                        \
  static int pass2_##removal##_##integrator##_##damping(                                           \
      const mpsi_dynamics_state *s, const mpsi_dynamics_mesh *mesh, int64_t b,                     \
      const mpsi_dynamics_step *step, double *scratch) {                                           \
    return pass2(removal, integrator, damping, s, mesh, b, step, scratch);                         \
  }
#define INTEGRATORS(X, removal, damping)                                                           \
  X(removal, VERLET, damping) X(removal, LEAPFROG, damping) X(removal, EULER, damping)
#define NAME(removal, integrator, damping) pass2_##removal##_##integrator##_##damping,
#define PASS2_TABLE(removal)                                                                       \
  {                                                                                                \
    {INTEGRATORS(NAME, removal, UNDAMPED)}, {INTEGRATORS(NAME, removal, BY_PARTICLES)}, {          \
      INTEGRATORS(NAME, removal, BY_PAIRS)                                                         \
    }                                                                                              \
  }
#define ALL(removal)                                                                               \
  PASS1(removal, PRESSURES)                                                                        \
  PASS1(removal, FORCES)                                                                           \
  PASS1(removal, DAMPED_FORCES)                                                                    \
  TRIG(removal)                                                                                    \
  INTEGRATORS(PASS2, removal, UNDAMPED)                                                            \
  INTEGRATORS(PASS2, removal, BY_PARTICLES)                                                        \
  INTEGRATORS(PASS2, removal, BY_PAIRS)

ALL(MEAN_MATRIX)
ALL(MEAN_ANGLE)

const mpsi_dynamics_kernels CONCAT(mpsi_dynamics_kernels_v, MPSI_LEVEL) = {
    .pass1 = {{pass1_MEAN_MATRIX_PRESSURES, pass1_MEAN_MATRIX_FORCES,
               pass1_MEAN_MATRIX_DAMPED_FORCES},
              {pass1_MEAN_ANGLE_PRESSURES, pass1_MEAN_ANGLE_FORCES,
               pass1_MEAN_ANGLE_DAMPED_FORCES}},
    .pass2 = {PASS2_TABLE(MEAN_MATRIX), PASS2_TABLE(MEAN_ANGLE)},
    .trig = {trig_MEAN_MATRIX, trig_MEAN_ANGLE},
};
