/* contract_loop.h - the volume strain of cyclic shear, after the step of Mohr and Coulomb. Sand
 * that is sheared by the amplitude g (engineering strain) in half a cycle contracts by
 *
 *   F(g, e) = 1/2 C1 g exp(-C2 e/g)                             Byrne (1991)
 *   F(g, e) = 1/2 (C1 (g - C2 e) + C3 e^2/(g + C4 e))           Martin, Finn and Seed (1975)
 *
 * e being the contraction before that half cycle. F grows with g, so that it is added as g grows
 * beyond its largest value since the last reversal: at the end of a half cycle the sum is F,
 * whatever the steps, and no step has a jump.
 *
 * Up to a threshold of the amplitude nothing contracts; from there to its double F grows linearly
 * to all of it, so that no stress jumps.
 *
 * Half cycles of a general path of strain: `since` is the deviatoric strain since the last
 * reversal, `far` the farthest that it has been, by gamma = 2 sqrt(J2). The amplitude is half of
 * the largest gamma. Where the strain has come back from `far` by a tenth of that, and by twice the
 * threshold, `far` is a reversal, from which strains are counted from now on.
 *
 * The contraction takes elastic strain from the grains: p falls by K de, and the deviator by the
 * fraction K de/(p + c cot(phi)), so that the mobilised share of the strength stays. Without
 * cohesion all components fall in proportion; at constant volume under K0 = nu/(1 - nu) the
 * vertical stress then falls by (K + 4G/3) de, the rebound modulus of one-dimensional unloading.
 * Grains without contact do not contract: p does not fall below 0. Included by laws.c alone.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "material/tensor.h"

#define MPSI_TURN_BACK 0.1 /* of the largest strain: on the way back a reversal */

/* Engineering shear strain of a deviator. */
MPSI_INLINE double contract_gamma(mpsi_sym e) {
  return 2.0 * sqrt(0.5 * (e.xx * e.xx + e.yy * e.yy + e.zz * e.zz) +
                    (e.xy * e.xy + e.yz * e.yz + e.zx * e.zx));
}

/* F: the contraction of half a cycle of this amplitude. */
static double contract_half_cycle(const mpsi_law *law, double gamma, double before) {
  const double *c = law->contract, over = gamma - law->threshold;
  if (!(over > 0.0)) return 0.0;
  const double half = over < law->threshold ? 0.5 * over / law->threshold : 0.5;
  if (gamma > law->strain_limit) gamma = law->strain_limit;
  if (c[2] == 0.0) return half * c[0] * gamma * exp(-c[1] * before / gamma);
  const double both =
      c[0] * (gamma - c[1] * before) + c[2] * before * before / (gamma + c[3] * before);
  return both > 0.0 ? half * both : 0.0;
}

/* A deviator from its five columns, rotated with the particle. */
MPSI_INLINE mpsi_sym contract_load(const int geometry, double *const *h, int64_t k, mpsi_spin w) {
  mpsi_sym e = {.xx = h[0][k], .yy = h[1][k], .xy = h[2][k]};
  if (geometry == MPSI_SPACE) e.zx = h[3][k], e.yz = h[4][k];
  e.zz = -(e.xx + e.yy);
  return mpsi_turn(geometry, e, w);
}

MPSI_INLINE void contract_store(const int geometry, double *const *h, int64_t k, mpsi_sym e) {
  h[0][k] = e.xx, h[1][k] = e.yy, h[2][k] = e.xy;
  if (geometry == MPSI_SPACE) h[3][k] = e.zx, h[4][k] = e.yz;
}

MPSI_INLINE mpsi_sym contract_sum(mpsi_sym a, double factor, mpsi_sym b) {
  return (mpsi_sym){.xx = a.xx + factor * b.xx,
                    .yy = a.yy + factor * b.yy,
                    .zz = a.zz + factor * b.zz,
                    .xy = a.xy + factor * b.xy,
                    .yz = a.yz + factor * b.yz,
                    .zx = a.zx + factor * b.zx};
}

/* Follows the strain of particle k by its increment d; returns the contraction due in this step. */
MPSI_INLINE double contract_due(const int geometry, const mpsi_law *law,
                                const mps_material_block *block, int64_t k, mpsi_sym d,
                                mpsi_spin w) {
  double *const *h = block->history;
  const mpsi_sym unit = {.xx = 1.0, .yy = 1.0, .zz = 1.0};
  mpsi_sym since = contract_load(geometry, h + MPSI_CYCLIC_SINCE, k, w);
  mpsi_sym far = contract_load(geometry, h + MPSI_CYCLIC_FAR, k, w);
  since = contract_sum(since, 1.0, contract_sum(d, -(d.xx + d.yy + d.zz) * (1.0 / 3.0), unit));
  const double gamma = contract_gamma(since);
  double largest = contract_gamma(far), due = 0.0;
  if (gamma < largest) {
    const mpsi_sym way = contract_sum(since, -1.0, far);
    const double back = contract_gamma(way);
    if (back > MPSI_TURN_BACK * largest && back > 2.0 * law->threshold) {
      h[MPSI_CYCLIC_HALVES][k] += 0.5 * largest > law->threshold ? 1.0 : 0.0;
      h[MPSI_CYCLIC_BEFORE][k] = h[MPSI_CYCLIC_CONTRACTION][k];
      since = way, far = (mpsi_sym){.xx = 0.0}, largest = 0.0;
    }
  }
  const double now = contract_gamma(since);
  if (now > largest) {
    const double before = h[MPSI_CYCLIC_BEFORE][k];
    due = contract_half_cycle(law, 0.5 * now, before) -
          contract_half_cycle(law, 0.5 * largest, before);
    far = since;
  }
  contract_store(geometry, h + MPSI_CYCLIC_SINCE, k, since);
  contract_store(geometry, h + MPSI_CYCLIC_FAR, k, far);
  return due;
}

MPSI_INLINE void contract_loop(const int geometry, const mpsi_law *law,
                               const mps_material_block *block) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *contraction = block->history[MPSI_CYCLIC_CONTRACTION];
  for (int64_t k = 0; k < block->count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, k, block->dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, k, block->dt);
    double due = contract_due(geometry, law, block, k, d, w);
    const mpsi_sym s = mpsi_stress(geometry, &columns, k);
    const double p = -(s.xx + s.yy + s.zz) * (1.0 / 3.0);
    if (!(due > 0.0) || !(p > 0.0)) continue;
    if (due > p * law->per_bulk) due = p * law->per_bulk;
    contraction[k] += due;
    const double drop = fmin(law->bulk * due, p), lost = drop / (p + law->apex);
    const double mean = drop - p + p * (1.0 - lost);
    const mpsi_sym unit = {.xx = 1.0, .yy = 1.0, .zz = 1.0};
    mpsi_put_stress(geometry, &columns, k, contract_sum(contract_sum(s, -lost, s), mean, unit));
    block->flags[k] |= MPS_MATERIAL_FLAG_PLASTIC;
  }
}
