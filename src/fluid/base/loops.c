/* loops.c - see loops.h. Sums are made in lanes, whose number is the instruction set's: last bits
 * differ between instruction sets, not between numbers of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loops.h"

#include "fluid/pressure/coarse.h"

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define LEAST 0.0025 /* l0^2: squares of distances are not taken as less */

static int64_t search(const mps_fluid *f, int64_t i, double radius, int64_t begin, int64_t end,
                      int64_t found, int32_t *index, double *r2) {
  enum { PART = 64 };
  const double x = f->x[0][i], y = f->x[1][i], re2 = radius * radius;
  double square[PART];
  for (int64_t first = begin; first < end; first += PART) {
    const int32_t count = (int32_t)(end - first < PART ? end - first : PART);
    const double *sx = f->slot_x[0] + first, *sy = f->slot_x[1] + first;
    const int32_t *slot = f->slot + first;
    /* whole vectors: the sorted cloud is padded (near.c) */
#pragma omp simd
    for (int32_t k = 0; k < mpsi_fluid_padded(count); k++)
      square[k] = (sx[k] - x) * (sx[k] - x) + (sy[k] - y) * (sy[k] - y);
    for (int32_t k = 0; k < count; k++) {
      index[found] = slot[k];
      r2[found] = square[k];
      found += square[k] < re2 && slot[k] != i;
    }
  }
  return found;
}

static int32_t weigh(const mps_fluid *f, const mpsi_fluid_weight *weight, int64_t i, int64_t count,
                     int32_t *index, double *r2, float *w) {
  const double inverse = weight->inverse, scale = weight->scale, re = weight->re;
  const double least = LEAST * f->l0 * f->l0;
  const int32_t all = mpsi_fluid_padded((int32_t)count), particles = (int32_t)f->count;
  int32_t images = 0;
  for (int32_t k = (int32_t)count; k < all; k++) index[k] = (int32_t)i, r2[k] = re * re;
  double closest[MPSI_FLUID_WIDE]; /* clang has no reduction to a minimum */
  for (int c = 0; c < MPSI_FLUID_WIDE; c++) closest[c] = re * re;
  for (int32_t k = 0; k < all; k += MPSI_FLUID_WIDE)
#pragma omp simd
    for (int c = 0; c < MPSI_FLUID_WIDE; c++)
      closest[c] = r2[k + c] < closest[c] ? r2[k + c] : closest[c];
#pragma omp simd reduction(+ : images)
  for (int32_t k = 0; k < all; k++) images += index[k] >= particles;
#pragma omp simd
  for (int32_t k = 0; k < all; k++) {
    const double d2 = r2[k] > least ? r2[k] : least, a = 1.0 - sqrt(d2) * inverse;
    w[k] = (float)(scale * (a * a * a * a * (5.0 - 4.0 * a)));
  }
  for (int32_t k = (int32_t)count; k < all; k++) w[k] = 0.0f;
  double closest2 = closest[0];
  for (int c = 1; c < MPSI_FLUID_WIDE; c++) closest2 = fmin(closest2, closest[c]);
  const double close = MPSI_FLUID_CLOSE * f->l0;
  return (images > 0 ? MPSI_FLUID_NEAR_IMAGES : 0) |
         (closest2 < close * close ? MPSI_FLUID_NEAR_CLOSE : 0);
}

static void add_up(const mps_fluid *f, int64_t i, mpsi_fluid_sums *out) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i), all = mpsi_fluid_padded(f->near[i]);
  const float *weight = f->w + mpsi_fluid_pairs(f, i);
  const double *x = f->x[0], *y = f->x[1], *u = f->u[0], *v = f->u[1];
  const double least = LEAST * f->l0 * f->l0, x0 = x[i], y0 = y[i], u0 = u[i], v0 = v[i];
  double n = 0.0, mx = 0.0, my = 0.0, square = 0.0, xx = 0.0, xy = 0.0, yy = 0.0, su = 0.0,
         sv = 0.0, ux = 0.0, uy = 0.0, vx = 0.0, vy = 0.0, fx = 0.0, fy = 0.0;
#pragma omp simd reduction(+ : n, mx, my, square, xx, xy, yy, su, sv, ux, uy, vx, vy, fx, fy)
  for (int32_t k = 0; k < all; k++) {
    const int32_t j = index[k];
    const double w = weight[k], dx = x[j] - x0, dy = y[j] - y0, du = u[j] - u0, dv = v[j] - v0;
    const double d2 = dx * dx + dy * dy, r2 = d2 > least ? d2 : least;
    const double inverse = 1.0 / r2, by_r = w * sqrt(inverse);
    const double wx = w * inverse * dx, wy = w * inverse * dy;
    n += w, mx += w * dx, my += w * dy, square += w * r2;
    xx += wx * dx, xy += wx * dy, yy += wy * dy;
    su += w * du, sv += w * dv;
    ux += du * wx, uy += du * wy, vx += dv * wx, vy += dv * wy;
    fx += by_r * dx, fy += by_r * dy;
  }
  *out = (mpsi_fluid_sums){.n = n,
                           .m = {mx, my},
                           .r2 = square,
                           .M = {xx, xy, yy},
                           .du = {su, sv},
                           .G = {ux, uy, vx, vy},
                           .shift = {fx, fy}};
}

static double times(const mps_fluid *f, int64_t begin, int64_t end, const double *v, double *out) {
  double dot = 0.0;
  for (int64_t i = begin; i < end; i++) {
    const int32_t *index = f->index + mpsi_fluid_pairs(f, i), all = mpsi_fluid_padded(f->near[i]);
    const float *w = f->w + mpsi_fluid_pairs(f, i);
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (int32_t k = 0; k < all; k++) sum += w[k] * v[index[k]];
    out[i] = f->state[i] == MPSI_FLUID_APART ? 0.0 : f->system.diagonal[i] * v[i] - sum;
    dot += v[i] * out[i];
  }
  return dot;
}

static void slope(const mps_fluid *f, int64_t i, double *out) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i), all = mpsi_fluid_padded(f->near[i]);
  const float *weight = f->w + mpsi_fluid_pairs(f, i);
  const double *x = f->x[0], *y = f->x[1], *q = f->q;
  const double least = LEAST * f->l0 * f->l0, x0 = x[i], y0 = y[i], q0 = q[i];
  double sx = 0.0, sy = 0.0;
#pragma omp simd reduction(+ : sx, sy)
  for (int32_t k = 0; k < all; k++) {
    const int32_t j = index[k];
    const double dx = x[j] - x0, dy = y[j] - y0, r2 = dx * dx + dy * dy;
    const double s = weight[k] * (q[j] - q0) / (r2 > least ? r2 : least);
    sx += s * dx, sy += s * dy;
  }
  out[0] = sx, out[1] = sy;
}

static void smooth(const mps_fluid *f, int64_t i, double *out) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i), all = mpsi_fluid_padded(f->near[i]);
  const float *weight = f->w + mpsi_fluid_pairs(f, i), *rate = f->flux[0], *xx = f->flux[1],
              *xy = f->flux[2], *yx = f->flux[3], *yy = f->flux[4];
  const double *x = f->x[0], *y = f->x[1], *u = f->u[0], *v = f->u[1];
  const double x0 = x[i], y0 = y[i], u0 = u[i], v0 = v[i];
  const float rate0 = rate[i], xx0 = xx[i], xy0 = xy[i], yx0 = yx[i], yy0 = yy[i];
  double su = 0.0, sv = 0.0;
#pragma omp simd reduction(+ : su, sv)
  for (int32_t k = 0; k < all; k++) {
    const int32_t j = index[k];
    const double hx = 0.5 * (x[j] - x0), hy = 0.5 * (y[j] - y0);
    const double part = 0.5 * weight[k] * (rate[j] + rate0);
    su += part * (u[j] - u0 - ((xx[j] + xx0) * hx + (xy[j] + xy0) * hy));
    sv += part * (v[j] - v0 - ((yx[j] + yx0) * hx + (yy[j] + yy0) * hy));
  }
  out[0] = su, out[1] = sv;
}

/* Where v[i - 1] is needed it is the last of a row's entries (near.c finds neighbours in the order
 * of the cells that particles are sorted by), so that a row depends little on the previous one. */
static void forward(const mps_fluid *f, int64_t first, int64_t end, int64_t offset, double *v) {
  const mpsi_fluid_system *s = &f->system;
  const int32_t *stop = s->lower_end;
  const uint16_t *column = s->lower_col + offset;
  const double *of = v + first;
  int32_t e = 0;
  const float *lower = s->lower + offset;
  for (int64_t i = first; i < end; i++) {
    const int32_t last = stop[i];
    double a = v[i], b = 0.0, c = 0.0, d = 0.0; /* chains of additions */
    if ((last - e) & 1) b = (double)lower[e] * of[column[e]], e++;
    if ((last - e) & 2) {
      c = (double)lower[e] * of[column[e]], d = (double)lower[e + 1] * of[column[e + 1]];
      e += 2;
    }
    for (; e < last; e += 4) {
      a -= (double)lower[e] * of[column[e]];
      b += (double)lower[e + 1] * of[column[e + 1]];
      c += (double)lower[e + 2] * of[column[e + 2]];
      d += (double)lower[e + 3] * of[column[e + 3]];
    }
    v[i] = a - ((b + c) + d);
  }
}

static double descend(const mps_fluid *f, int64_t first, int64_t end, int64_t offset, double alpha,
                      double beta) {
  const mpsi_fluid_system *y = &f->system;
  double rz = 0.0, *x = y->x, *r = y->r, *z = y->z, *p = y->p, *s = f->u_new[0];
  const double *q = y->q;
  const float *inverse = y->inverse;
#pragma omp simd reduction(+ : rz)
  for (int64_t i = first; i < end; i++) {
    p[i] = z[i] + beta * p[i];
    s[i] = q[i] + beta * s[i];
    x[i] += alpha * p[i];
    r[i] -= alpha * s[i];
    z[i] = inverse[i] * r[i];
    rz += r[i] * z[i];
  }
  const int32_t *stop = y->lower_end;
  const uint16_t *column = y->lower_col + offset;
  const float *lower = y->lower + offset;
  double *of = z + first;
  for (int64_t i = end - 1; i >= first; i--) {
    const double here = z[i];
    for (int32_t e = i > first ? stop[i - 1] : 0; e < stop[i]; e++)
      of[column[e]] -= (double)lower[e] * here;
  }
  return rz;
}

/* Entries of row i outside of the block, times z. */
static double outside_block(const mps_fluid *f, int64_t first, int64_t end, int64_t i) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double sum = 0.0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int32_t j = index[k] < f->count ? index[k] : f->parent[index[k] - f->count];
    if ((j < first || j >= end) && f->state[j] != MPSI_FLUID_APART) sum -= w[k] * f->system.z[j];
  }
  return sum;
}

static double rise(const mps_fluid *f, int64_t first, int64_t end, int64_t offset) {
  const mpsi_fluid_system *y = &f->system;
  const double *z = y->z, *r = y->r, *middle = f->u_new[1];
  const float *inverse = y->inverse;
  double zq = 0.0, *q = y->q;
#pragma omp simd
  for (int64_t i = first; i < end; i++) q[i] = r[i] + middle[i] * z[i];
  for (int64_t i = first; i < end; i++)
    if (f->company[i] & MPSI_FLUID_NEAR_OTHERS) q[i] += outside_block(f, first, end, i);
  const mpsi_fluid_coarse *coarse = f->coarse;
  if (coarse->used) mpsi_fluid_coarse_subtract(coarse, first / coarse->block, q);
  forward(f, first, end, offset, q);
#pragma omp simd reduction(+ : zq)
  for (int64_t i = first; i < end; i++) {
    q[i] += z[i] / (double)inverse[i];
    zq += q[i] * inverse[i] * r[i];
  }
  return zq;
}

static double norm(const mps_fluid *f, int64_t first, int64_t end, int64_t offset,
                   const double *v) {
  const mpsi_fluid_system *s = &f->system;
  const uint16_t *column = s->lower_col + offset;
  const float *lower = s->lower + offset;
  double square = 0.0;
  int32_t e = 0;
  for (int64_t i = first; i < end; i++) {
    double sum = v[i];
    for (; e < s->lower_end[i]; e++) sum += (double)lower[e] * v[first + column[e]];
    square += sum * sum;
  }
  return square;
}

static bool mixed(const mps_fluid *f, int64_t i, const int32_t *of) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i), all = mpsi_fluid_padded(f->near[i]),
                here = of[i];
  int32_t differs = 0;
#pragma omp simd reduction(| : differs)
  for (int32_t k = 0; k < all; k++) differs |= of[index[k]] ^ here;
  return differs != 0;
}

const mpsi_fluid_loops JOIN(mpsi_fluid_loops_v, MPSI_LEVEL) = {
    search, weigh, add_up, times, forward, descend, rise, norm, mixed, slope, smooth};
