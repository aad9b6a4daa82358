/* layers.h - one step of the small-strain law on a block: von Mises layers side by side (Iwan
 * 1967), all with the strain of the particle. Each layer keeps its deviator, which turns with the
 * particle; the stress changes by the sum of the changes of the layers, so that a first stress
 * stays and the backbone begins there. Unloading follows Masing's rules because the layers do, one
 * by one.
 *
 * A layer bears five numbers a particle, its deviator's xx, yy, xy, zx, yz; zz is -(xx + yy). In 2D
 * zx and yz stay 0. Included by laws.c alone, which compiles it for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_LAYERS_H
#define MPSI_LAYERS_H

#include "material/tensor.h"

#define LAYER_CHUNK 64 /* particles whose sums are in memory at a time */

/* Sums over the layers, of the particles of a chunk. */
typedef struct layer_sums {
  double change[5][LAYER_CHUNK]; /* of the deviators, Pa */
  double lost[LAYER_CHUNK];      /* J/m3 */
  double over[LAYER_CHUNK];      /* of the last layer: 1 elastic, below: it yields */
} layer_sums;

/* Strain increment less its mean. */
MPSI_INLINE mpsi_sym layer_strain(const int geometry, const mpsi_law_columns *columns, int64_t k,
                                  double dt) {
  mpsi_sym d = mpsi_strain(geometry, columns, k, dt);
  const double mean = (d.xx + d.yy + d.zz) * (1.0 / 3.0);
  d.xx -= mean, d.yy -= mean, d.zz -= mean;
  return d;
}

/* Layer i of particles [begin, begin + count): trial, return, and its part of the sums. */
MPSI_INLINE void layer_step(const int geometry, const mpsi_law *law, const int i,
                            const mps_material_block *block, int64_t begin, int64_t count,
                            layer_sums *sums) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *const *h = block->history + MPSI_SMALL_FIRST + MPSI_LAYER_PARTS * i;
  double *xx = h[0] + begin, *yy = h[1] + begin, *xy = h[2] + begin;
  double *zx = h[3] + begin, *yz = h[4] + begin;
  const double dt = block->dt, g2 = 2.0 * law->layer_shear[i], bears = law->layer_strength[i];
  const double per_g4 = 0.25 / law->layer_shear[i], per_bears = 1.0 / bears;
  _Pragma("omp simd") for (int64_t k = 0; k < count; k++) {
    const mpsi_sym d = layer_strain(geometry, &columns, begin + k, dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, begin + k, dt);
    mpsi_sym s = {.xx = xx[k], .yy = yy[k], .zz = -(xx[k] + yy[k]), .xy = xy[k]};
    if (geometry == MPSI_SPACE) s.zx = zx[k], s.yz = yz[k];
    s = mpsi_turn(geometry, s, w);
    mpsi_sym t = {.xx = s.xx + g2 * d.xx, .yy = s.yy + g2 * d.yy, .xy = s.xy + g2 * d.xy};
    if (geometry == MPSI_SPACE) t.zx = s.zx + g2 * d.zx, t.yz = s.yz + g2 * d.yz;
    t.zz = -(t.xx + t.yy);
    const double q = sqrt(0.5 * (t.xx * t.xx + t.yy * t.yy + t.zz * t.zz) +
                          (t.xy * t.xy + t.yz * t.yz + t.zx * t.zx));
    const double least = bears / (q + 1e-300), scale = least < 1.0 ? least : 1.0;
    /* plastic strain is s (q/k - 1)/(2 G); its work by the mean of both stresses, which a budget of
     * energy takes too, is never negative, as neither exceeds the strength */
    const double over = q * per_bears - 1.0, plastic = over > 0.0 ? over : 0.0;
    xx[k] = scale * t.xx, yy[k] = scale * t.yy, xy[k] = scale * t.xy;
    sums->change[0][k] += xx[k] - s.xx;
    sums->change[1][k] += yy[k] - s.yy;
    sums->change[2][k] += xy[k] - s.xy;
    if (geometry == MPSI_SPACE) {
      zx[k] = scale * t.zx, yz[k] = scale * t.yz;
      sums->change[3][k] += zx[k] - s.zx;
      sums->change[4][k] += yz[k] - s.yz;
    }
    const double both = xx[k] * (xx[k] + s.xx) + yy[k] * (yy[k] + s.yy) +
                        (xx[k] + yy[k]) * (xx[k] + yy[k] - s.zz) +
                        2.0 * (xy[k] * (xy[k] + s.xy) + scale * t.zx * (scale * t.zx + s.zx) +
                               scale * t.yz * (scale * t.yz + s.yz));
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
    layer_sums sums;
    memset(&sums, 0, sizeof sums);
    for (int i = 0; i < MPSI_LAYERS; i++) layer_step(geometry, law, i, block, begin, count, &sums);
    layer_finish(geometry, law, block, begin, count, &sums);
  }
  return MPS_OK;
}

#endif
