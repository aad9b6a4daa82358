/* layers.h - one step of the small-strain law on a block: von Mises layers side by side (Iwan
 * 1967), all with the strain of the particle. Each layer keeps its deviator, which turns with the
 * particle; the stress changes by the sum of the changes of the layers, so that a first stress
 * stays and the backbone begins there. Unloading follows Masing's rules because the layers do, one
 * by one.
 *
 * A layer bears five numbers a particle, its deviator's xx, yy, xy, zx, yz; zz is -(xx + yy). In 2D
 * zx and yz stay 0. Included by laws.c alone, which compiles it for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "material/tensor.h"

#define AHEAD 4        /* layers from the fetch of deviators to their step */
#define LAYER_CHUNK 64 /* particles whose sums are in memory at a time */

/* Sums over the layers, of the particles of a chunk. */
typedef struct layer_sums {
  double change[5][LAYER_CHUNK]; /* of the deviators, Pa */
  double lost[LAYER_CHUNK];      /* J/m3 */
  double over[LAYER_CHUNK];      /* of the last layer: 1 elastic, below: it yields */
} layer_sums;

/* What all layers of a particle share: twice the deviatoric strain increment, and the rotation of a
 * deviator as a linear map of its five parts. In space `turn` is that map, row by row; in 2D the
 * rotation by the angle a of the plane has turn[0] = sin(2a), turn[1] = 1 - cos(2a). */
typedef struct layer_frame {
  double strain[5][LAYER_CHUNK];
  double turn[25][LAYER_CHUNK];
} layer_frame;

/* Row of the map, of the part (i, j) of Q s Q^T: a is row i of Q, b is row j; zz = -(xx + yy). */
MPSI_INLINE void layer_row(const double *a, const double *b, layer_frame *frame, int row,
                           int64_t k) {
  const double zz = a[2] * b[2];
  frame->turn[row][k] = a[0] * b[0] - zz;
  frame->turn[row + 1][k] = a[1] * b[1] - zz;
  frame->turn[row + 2][k] = a[0] * b[1] + a[1] * b[0];
  frame->turn[row + 3][k] = a[2] * b[0] + a[0] * b[2];
  frame->turn[row + 4][k] = a[1] * b[2] + a[2] * b[1];
}

MPSI_INLINE void layer_prepare(const int geometry, const mps_material_block *block, int64_t begin,
                               int64_t count, layer_frame *frame) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  const double dt = block->dt;
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, begin + k, dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, begin + k, dt);
    const double mean = (d.xx + d.yy + d.zz) * (1.0 / 3.0);
    frame->strain[0][k] = 2.0 * (d.xx - mean), frame->strain[1][k] = 2.0 * (d.yy - mean);
    frame->strain[2][k] = 2.0 * d.xy;
    if (geometry == MPSI_SPACE) {
      frame->strain[3][k] = 2.0 * d.zx, frame->strain[4][k] = 2.0 * d.yz;
      const mpsi_rotation q = mpsi_rotation_of(w);
      const double x[3] = {q.xx, q.xy, q.xz}, y[3] = {q.yx, q.yy, q.yz}, z[3] = {q.zx, q.zy, q.zz};
      layer_row(x, x, frame, 0, k);
      layer_row(y, y, frame, 5, k);
      layer_row(x, y, frame, 10, k);
      layer_row(z, x, frame, 15, k);
      layer_row(y, z, frame, 20, k);
    } else { /* as mpsi_turn */
      const double q = 0.25 * w.xy * w.xy, r = 1.0 / (1.0 + q);
      const double sine = r * w.xy, cosine = r * (1.0 - q);
      frame->turn[0][k] = 2.0 * sine * cosine, frame->turn[1][k] = 2.0 * sine * sine;
    }
  }
}

/* Part `row`/5 of a turned deviator, in space. */
MPSI_INLINE double layer_turn(const layer_frame *frame, int row, int64_t k, mpsi_sym s) {
  return (frame->turn[row][k] * s.xx + frame->turn[row + 1][k] * s.yy) +
         (frame->turn[row + 2][k] * s.xy + frame->turn[row + 3][k] * s.zx) +
         frame->turn[row + 4][k] * s.yz;
}

/* 1/sqrt(x), x >= 0 and normal, within two units of the last place; large at 0. By Newton's method
 * from the halved exponent: products alone, which in vectors cost a fifth of a square root and a
 * division, and have the same bits on each instruction set. */
MPSI_INLINE double layer_inverse_root(double x) {
  union {
    double value;
    uint64_t bits;
  } y = {.value = x};
  y.bits = 0x5fe6eb50c7b537a9u - (y.bits >> 1);
  const double half = 0.5 * x;
  double r = y.value;
  r = r * (1.5 - (half * r) * r), r = r * (1.5 - (half * r) * r);
  r = r * (1.5 - (half * r) * r), r = r * (1.5 - (half * r) * r);
  return r;
}

/* Asks for the deviators of layer i, which are read once a step from as many places in memory as
 * there are parts: without that a loop over a few particles waits for most of them. */
MPSI_INLINE void layer_fetch(const int geometry, const int i, const mps_material_block *block,
                             int64_t begin, int64_t count) {
  double *const *h = block->history + MPSI_SMALL_FIRST + MPSI_LAYER_PARTS * i;
  for (int c = 0; c < (geometry == MPSI_SPACE ? 5 : 3); c++)
    for (int64_t k = 0; k < count; k += 8) __builtin_prefetch(h[c] + begin + k, 1);
}

/* Layer i of particles [begin, begin + count): trial, return, and its part of the sums. */
MPSI_INLINE void layer_step(const int geometry, const mpsi_law *law, const int i,
                            const mps_material_block *block, int64_t begin, int64_t count,
                            const layer_frame *frame, layer_sums *sums) {
  double *const *h = block->history + MPSI_SMALL_FIRST + MPSI_LAYER_PARTS * i;
  double *xx = h[0] + begin, *yy = h[1] + begin, *xy = h[2] + begin;
  double *zx = h[3] + begin, *yz = h[4] + begin;
  const double shear = law->layer_shear[i], bears = law->layer_strength[i];
  const double per_g4 = 0.25 / shear, per_bears = 1.0 / bears;
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    mpsi_sym s = {.xx = xx[k], .yy = yy[k], .xy = xy[k]};
    if (geometry == MPSI_SPACE) {
      const mpsi_sym old = {.xx = s.xx, .yy = s.yy, .xy = s.xy, .zx = zx[k], .yz = yz[k]};
      s.xx = layer_turn(frame, 0, k, old), s.yy = layer_turn(frame, 5, k, old);
      s.xy = layer_turn(frame, 10, k, old), s.zx = layer_turn(frame, 15, k, old);
      s.yz = layer_turn(frame, 20, k, old);
    } else {
      const double half = 0.5 * (s.xx - s.yy), a = frame->turn[0][k], b = frame->turn[1][k];
      const double change = a * s.xy - b * half;
      s.xy -= a * half + b * s.xy, s.xx += change, s.yy -= change;
    }
    s.zz = -(s.xx + s.yy);
    mpsi_sym t = {.xx = s.xx + shear * frame->strain[0][k],
                  .yy = s.yy + shear * frame->strain[1][k],
                  .xy = s.xy + shear * frame->strain[2][k]};
    if (geometry == MPSI_SPACE)
      t.zx = s.zx + shear * frame->strain[3][k], t.yz = s.yz + shear * frame->strain[4][k];
    t.zz = -(t.xx + t.yy);
    const double j2 =
        0.5 * (t.xx * t.xx + t.yy * t.yy + t.zz * t.zz) + (t.xy * t.xy + t.yz * t.yz + t.zx * t.zx);
    const double root = layer_inverse_root(j2), least = bears * root;
    const double scale = least < 1.0 ? least : 1.0;
    /* plastic strain is s (q/k - 1)/(2 G); its work by the mean of both stresses, which a budget of
     * energy takes too, is never negative, as neither exceeds the strength */
    const double over = (j2 * root) * per_bears - 1.0, plastic = over > 0.0 ? over : 0.0;
    const double product =
        (t.xx * s.xx + t.yy * s.yy + t.zz * s.zz) + 2.0 * (t.xy * s.xy + t.yz * s.yz + t.zx * s.zx);
    const double both = scale * (2.0 * scale * j2 + product);
    xx[k] = scale * t.xx, yy[k] = scale * t.yy, xy[k] = scale * t.xy;
    sums->change[0][k] += scale * t.xx - s.xx;
    sums->change[1][k] += scale * t.yy - s.yy;
    sums->change[2][k] += scale * t.xy - s.xy;
    if (geometry == MPSI_SPACE) {
      zx[k] = scale * t.zx, yz[k] = scale * t.yz;
      sums->change[3][k] += scale * t.zx - s.zx;
      sums->change[4][k] += scale * t.yz - s.yz;
    }
    sums->lost[k] += plastic * per_g4 * (both > 0.0 ? both : 0.0);
    sums->over[k] = scale;
  }
}

/* The particles' own stress, volume and history from the sums. */
MPSI_INLINE void layer_finish(const int geometry, const mpsi_law *law,
                              const mps_material_block *block, int64_t begin, int64_t count,
                              const layer_sums *sums) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *plastic = block->history[MPSI_SMALL_STRAIN] + begin;
  double *lost = block->history[MPSI_SMALL_DISSIPATED] + begin;
  double *volume = block->volume_ratio + begin;
  int64_t *flags = block->flags + begin;
  const double dt = block->dt, per_g2 = 0.5 / law->shear, bulk = law->bulk;
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, begin + k, dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, begin + k, dt);
    const double growth = d.xx + d.yy + d.zz, mean = growth * (1.0 / 3.0);
    const double dxx = sums->change[0][k], dyy = sums->change[1][k], dxy = sums->change[2][k];
    const double dzx = sums->change[3][k], dyz = sums->change[4][k];
    mpsi_sym s = mpsi_turn(geometry, mpsi_stress(geometry, &columns, begin + k), w);
    s.xx += dxx + bulk * growth;
    s.yy += dyy + bulk * growth;
    s.zz += bulk * growth - (dxx + dyy);
    s.xy += dxy, s.zx += dzx, s.yz += dyz;
    mpsi_put_stress(geometry, &columns, begin + k, s);
    /* plastic strain of all layers together */
    const double a = d.xx - mean - per_g2 * dxx, b = d.yy - mean - per_g2 * dyy, c = -(a + b);
    const double e = d.xy - per_g2 * dxy, f = d.zx - per_g2 * dzx, g = d.yz - per_g2 * dyz;
    const double square = (a * a + b * b + c * c) + 2.0 * (e * e + f * f + g * g);
    const double size = sums->lost[k] > 0.0 ? square : 0.0; /* elastic: no rounding is kept */
    plastic[k] += sqrt(size * (2.0 / 3.0));
    lost[k] += sums->lost[k];
    volume[k] += volume[k] * growth;
    flags[k] = sums->over[k] < 1.0 ? MPS_MATERIAL_FLAG_PLASTIC : 0;
  }
}

MPSI_INLINE mps_status small_strain_loop(const int geometry, const mpsi_law *law,
                                         const mps_material_block *block) {
  for (int64_t begin = 0; begin < block->count; begin += LAYER_CHUNK) {
    const int64_t left = block->count - begin, count = left < LAYER_CHUNK ? left : LAYER_CHUNK;
    layer_frame frame;
    layer_sums sums;
    memset(&sums, 0, sizeof sums);
    for (int i = 0; i < AHEAD; i++) layer_fetch(geometry, i, block, begin, count);
    layer_prepare(geometry, block, begin, count, &frame);
    for (int i = 0; i < MPSI_LAYERS; i++) {
      if (i + AHEAD < MPSI_LAYERS) layer_fetch(geometry, i + AHEAD, block, begin, count);
      layer_step(geometry, law, i, block, begin, count, &frame, &sums);
    }
    layer_finish(geometry, law, block, begin, count, &sums);
  }
  return MPS_OK;
}
