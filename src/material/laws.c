/* laws.c - the loops of the constitutive laws over a block: trial stress Nakamura (45)-(47), return
 * maps of von Mises (53) and Drucker-Prager (55), neo-Hookean solid, Newtonian fluid, and what a
 * user's law or Mohr-Coulomb needs around it. This file is compiled once for each instruction set,
 * with MPSI_LEVEL set; fused multiply-add is off (build flags), so every level gives the same bits.
 *
 * A particle that yields and one that does not take the same instructions: results are selected, so
 * that plasticity costs a square root and a division and never a branch. Divisions by constants are
 * products with their reciprocals: in a vector a division is as dear as ten products.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cam_clay/clay_loop.h"
#include "core/base/symmetric.h"
#include "sand/contract_loop.h"
#include "small_strain/layers.h"
#include "tensor.h"

#define CONCAT_(a, b) a##b
#define CONCAT(a, b) CONCAT_(a, b)
#define SIMD _Pragma("omp simd")

#define THIRD (1.0 / 3.0)
#define NOTHING 1e-300 /* Pa: keeps 0/0 away */
#define PER_ROOT3 0.57735026918962576
#define CHUNK 64 /* particles whose openings are in memory at a time */

/* ---- return maps ------------------------------------------------------------------------------
 * In the plane of mean stress p and q = sqrt(J2): the deviator keeps its direction. All selections
 * are minima and maxima, which a compiler cannot turn back into branches; a NaN passes through. */

typedef struct meridian {
  double p, q;
  double plastic; /* increment of plastic strain */
  double opened;  /* volume strain of the gap between grains; closing is negative */
  int64_t flags;
} meridian;

MPSI_INLINE double at_least(double x, double low) { return x < low ? low : x; }
MPSI_INLINE double at_most(double x, double high) { return x > high ? high : x; }

MPSI_INLINE meridian return_von_mises(const mpsi_law *law, double p, double q, double hardened) {
  const double f = q - (law->yield + law->hardening * hardened) * PER_ROOT3;
  const double share = law->shear / (law->shear + law->hardening / 3.0);
  const double drop = at_least(f, 0.0) * share;
  return (meridian){.p = p,
                    .q = q - drop,
                    .plastic = drop * (PER_ROOT3 / law->shear),
                    .flags = f > 0.0 ? MPS_MATERIAL_FLAG_PLASTIC : 0};
}

/* The cone q + 3 alpha p = kappa up to the limit of tension p = tension, where its radius is
 * q_tension: 0 at the apex. A trial that the cone's return (which is itself, if elastic) leaves
 * beyond the limit goes to the limit: with its own q if that is smaller than the radius there, else
 * to the circle where cone and limit intersect. On the cone before the limit q is never below
 * q_tension, so that one expression covers all cases.
 *
 * The volume increase at the limit is a gap between grains, the volume strain `gap`. Compression
 * closes it before the mean stress falls below 0; meanwhile the grains do not dilate.
 *
 * Dilation that would take p below `least` (mpsi_least_mean) ends there, on the cone. */
MPSI_INLINE meridian return_drucker_prager(const bool ends, const mpsi_law *law, double p, double q,
                                           double gap, double least) {
  const double closed = p + law->bulk * gap;
  const double f = q + 3.0 * law->alpha * closed - law->kappa;
  const double multiplier = at_least(f, 0.0) * law->cone;
  const double p_full = closed - 3.0 * law->bulk * law->alpha_flow * multiplier;
  const double p_cone = ends ? at_least(p_full, at_most(least, closed)) : p_full;
  const double q_cone = ends && p_cone > p_full ? law->kappa - 3.0 * law->alpha * p_cone
                                                : q - law->shear * multiplier;
  const double p_open = at_most(at_least(p, 0.0), law->tension);
  const double radius = at_least(law->kappa - 3.0 * law->alpha * p_open, law->q_tension);
  const bool open = gap > 0.0 && closed > 0.0, tears = p_cone > law->tension;
  const double p_new = open ? p_open : at_most(p_cone, law->tension);
  const double q_new = at_most(q, open ? radius : at_least(q_cone, law->q_tension));
  const int64_t yields = f > 0.0 ? MPS_MATERIAL_FLAG_PLASTIC : 0;
  return (meridian){.p = p_new,
                    .q = q_new,
                    .plastic = (q - q_new) * (PER_ROOT3 / law->shear),
                    .opened = open || tears ? (p - p_new) * law->per_bulk : -gap,
                    .flags = tears || gap > 0.0 ? MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX
                                                : yields};
}

/* ---- laws of the Jaumann rate ---------------------------------------------------------------- */

/* How a volume grows by the volume strain of a step. */
typedef enum growth_kind { BY_SUM, BY_FRACTION, BY_EXPONENTIAL } growth_kind;

/* A volume after the volume strain `growth`. Single grains beside a wall may vibrate by a hundredth
 * for as long as a pile is driven. The stress keeps the sum of such strains; (1 + x)(1 - x) loses x
 * squared in each cycle. So frictional laws take exp(growth), to the third order, and to rounding
 * where the volume decides that dilation ends. */
MPSI_INLINE double grown(const growth_kind kind, double volume, double growth) {
  if (kind == BY_EXPONENTIAL) return volume * exp(growth);
  const double half = 0.5 * at_least(at_most(growth, 1.0), -1.0);
  return kind == BY_FRACTION ? volume * ((1.0 + half) / (1.0 - half)) : volume + volume * growth;
}

/* Mean stress (Pa) below which dilation does not take a volume in a step with the strain d, which
 * closes the gap; -INFINITY: dilation does not end. */
MPSI_INLINE double least_mean(const mpsi_law *law, double volume, mpsi_sym d, double gap) {
  return mpsi_least_mean(law, grown(BY_EXPONENTIAL, volume, (d.xx + d.yy + d.zz) - -gap));
}

/* Treatment of the trial stress in the loop of the Jaumann rate. */
enum { ELASTIC, MISES, CONE, ENDING_CONE, PYRAMID };

MPSI_INLINE void rate_loop(const int geometry, const int yields, const mpsi_law *constants,
                           const mps_material_block *block) {
  const mpsi_law law = *constants; /* a copy: nothing that the loop writes can alias it */
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *volume = block->volume_ratio, *strain = yields == ELASTIC ? NULL : block->history[0],
         *gap = yields >= CONE ? block->history[1] : NULL;
  int64_t *flags = block->flags;
  const double dt = block->dt;
  SIMD for (int64_t k = 0; k < block->count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, k, dt);
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, k, dt);
    mpsi_sym s = mpsi_turn(geometry, mpsi_stress(geometry, &columns, k), w);
    s = mpsi_hooke(&law, s, d);
    int64_t flag = 0;
    double opened = 0.0;
    if (yields != ELASTIC) {
      const double least = yields == ENDING_CONE ? least_mean(&law, volume[k], d, gap[k]) : 0.0;
      const double p = (s.xx + s.yy + s.zz) * THIRD, dx = s.xx - p, dy = s.yy - p, dz = s.zz - p;
      const double q =
          sqrt(0.5 * (dx * dx + dy * dy + dz * dz) + (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx));
      if (yields == PYRAMID) { /* beyond the inscribed cone or one around the cut-off:
                                              a candidate. No stress exceeds p + 2 q/sqrt(3). */
        const double over =
            at_least(q + 3.0 * law.alpha * p - law.kappa, p + (2.0 * PER_ROOT3) * q - law.cut);
        flag = ((over > 0.0) | (gap[k] > 0.0)) ? MPS_MATERIAL_FLAG_PLASTIC : 0;
      } else {
        const meridian m = yields == MISES ? return_von_mises(&law, p, q, strain[k])
                                           : return_drucker_prager(yields == ENDING_CONE, &law, p,
                                                                   q, gap[k], least);
        const double scale = m.q / (q + NOTHING); /* 1 if elastic */
        flag = m.flags;
        s.xx = m.p + scale * dx;
        s.yy = m.p + scale * dy;
        s.zz = m.p + scale * dz;
        s.xy *= scale;
        s.yz *= scale;
        s.zx *= scale;
        strain[k] += m.plastic;
        if (yields == CONE || yields == ENDING_CONE) {
          opened = m.opened;
          gap[k] = at_least(gap[k] + opened, 0.0);
        }
      }
    }
    mpsi_put_stress(geometry, &columns, k, s);
    flags[k] = flag;
    if (yields != PYRAMID) {
      const double growth = (d.xx + d.yy + d.zz) - opened;
      volume[k] = grown(yields == ENDING_CONE ? BY_EXPONENTIAL
                        : yields == CONE      ? BY_FRACTION
                                              : BY_SUM,
                        volume[k], growth);
    }
  }
}

/* V/V0 of particles [begin, end) of a block; `opened`, of these, is the strain of gaps, NULL for
 * laws without. */
MPSI_INLINE void volume_loop(const int geometry, const growth_kind kind,
                             const mps_material_block *block, int64_t begin, int64_t end,
                             const double *opened) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *volume = block->volume_ratio;
  const double dt = block->dt;
  SIMD for (int64_t k = begin; k < end; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, k, dt);
    const double growth = (d.xx + d.yy + d.zz) - (opened ? opened[k - begin] : 0.0);
    volume[k] = grown(kind, volume[k], growth);
  }
}

MPSI_INLINE mps_status linear_elastic_loop(const int geometry, const mpsi_law *law,
                                           const mps_material_block *block) {
  rate_loop(geometry, ELASTIC, law, block);
  return MPS_OK;
}

/* Largest less smallest principal strain rate of a particle, 1/s. */
static double rate_of(const int geometry, const mpsi_law_columns *columns, int64_t k) {
  const mpsi_sym d = mpsi_strain(geometry, columns, k, 1.0);
  if (geometry != MPSI_SPACE) {
    const double mean = 0.5 * (d.xx + d.yy), half = 0.5 * (d.xx - d.yy);
    const double radius = sqrt(half * half + d.xy * d.xy);
    return fmax(mean + radius, d.zz) - fmin(mean - radius, d.zz);
  }
  const double a[3][3] = {{d.xx, d.xy, d.zx}, {d.xy, d.yy, d.yz}, {d.zx, d.yz, d.zz}};
  double value[3];
  mpsi_symmetric_principal(a, value, NULL);
  return fmax(value[0], fmax(value[1], value[2])) - fmin(value[0], fmin(value[1], value[2]));
}

/* Von Mises with softening or rate dependence: the trial in vector form, then the returns one by
 * one, as each solves an equation. */
static void soften_mises_loop(const int geometry, const mpsi_law *law,
                              const mps_material_block *block) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *strain = block->history[0];
  rate_loop(geometry, ELASTIC, law, block);
  for (int64_t k = 0; k < block->count; k++) {
    mpsi_sym s = mpsi_stress(geometry, &columns, k);
    const double p = (s.xx + s.yy + s.zz) * THIRD, dx = s.xx - p, dy = s.yy - p, dz = s.zz - p;
    const double q =
        sqrt(1.5 * (dx * dx + dy * dy + dz * dz) + 3.0 * (s.xy * s.xy + s.yz * s.yz + s.zx * s.zx));
    const double rate = law->rate_factor > 0.0 ? rate_of(geometry, &columns, k) : 0.0;
    const double drop =
        mpsi_soften_mises(law, q, law->yield * mpsi_rate_factor(law, rate), &strain[k]);
    if (!(drop > 0.0)) continue;
    const double scale = (q - drop) / q;
    s.xx = p + scale * dx, s.yy = p + scale * dy, s.zz = p + scale * dz;
    s.xy *= scale, s.yz *= scale, s.zx *= scale;
    mpsi_put_stress(geometry, &columns, k, s);
    block->flags[k] = MPS_MATERIAL_FLAG_PLASTIC;
  }
}

MPSI_INLINE mps_status von_mises_loop(const int geometry, const mpsi_law *law,
                                      const mps_material_block *block) {
  if (law->softens)
    soften_mises_loop(geometry, law, block);
  else
    rate_loop(geometry, MISES, law, block);
  return MPS_OK;
}

MPSI_INLINE mps_status drucker_prager_loop(const int geometry, const mpsi_law *law,
                                           const mps_material_block *block) {
  if (law->loosest > 0.0)
    rate_loop(geometry, ENDING_CONE, law, block);
  else
    rate_loop(geometry, CONE, law, block);
  return MPS_OK;
}

/* The trial in vector form; then the few that may yield, one by one, in principal stresses. */
MPSI_INLINE mps_status mohr_coulomb_loop(const int geometry, const mpsi_law *law,
                                         const mps_material_block *block) {
  rate_loop(geometry, PYRAMID, law, block);
  const int32_t dim = geometry == MPSI_SPACE ? 3 : 2, components = dim == 3 ? 6 : 4;
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *strain = block->history[0], *gap = block->history[1], opened[CHUNK];
  for (int64_t begin = 0, end; begin < block->count; begin = end) {
    end = begin + CHUNK < block->count ? begin + CHUNK : block->count;
    for (int64_t k = begin; k < end; k++) {
      opened[k - begin] = 0.0;
      if (block->flags[k] == 0) continue;
      double s[6], least = -INFINITY;
      for (int32_t c = 0; c < components; c++) s[c] = block->stress[c][k];
      if (law->loosest > 0.0)
        least = least_mean(law, block->volume_ratio[k],
                           mpsi_strain(geometry, &columns, k, block->dt), gap[k]);
      if (law->softens)
        block->flags[k] = mpsi_soften_mohr_coulomb(
            law, dim, law->rate_factor > 0.0 ? rate_of(geometry, &columns, k) : 0.0, least, s,
            &strain[k], &gap[k], &opened[k - begin]);
      else
        block->flags[k] =
            mpsi_mohr_coulomb_return(law, dim, least, s, &strain[k], &gap[k], &opened[k - begin]);
      if (block->flags[k] == 0) continue;
      for (int32_t c = 0; c < components; c++) block->stress[c][k] = s[c];
    }
    if (law->loosest > 0.0)
      volume_loop(geometry, BY_EXPONENTIAL, block, begin, end, opened);
    else
      volume_loop(geometry, BY_FRACTION, block, begin, end, opened);
  }
  return MPS_OK;
}

MPSI_INLINE mps_status cyclic_sand_loop(const int geometry, const mpsi_law *law,
                                        const mps_material_block *block) {
  const mps_status status = mohr_coulomb_loop(geometry, law, block);
  contract_loop(geometry, law, block);
  return status;
}

/* ---- laws of the deformation gradient -------------------------------------------------------- */

/* F = (1 + dt L) F, Nakamura (44), and V/V0 = det F. In 2D xz, yz, zx, zy are zero. */
MPSI_INLINE void deform_loop(const int geometry, const mps_material_block *block) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *f[9], *volume = block->volume_ratio;
  for (int c = 0; c < 9; c++) f[c] = block->deformation[c];
  const double dt = block->dt;
  SIMD for (int64_t k = 0; k < block->count; k++) {
    double g[9] = {0}, old[9] = {0}, now[9] = {0};
    for (int c = 0; c < 9; c++) {
      const bool planar = c == 0 || c == 1 || c == 3 || c == 4 || c == 8;
      if (geometry != MPSI_SPACE && !planar) continue;
      old[c] = f[c][k];
      if (geometry != MPSI_PLANE || c != 8) g[c] = dt * columns.l[c][k];
    }
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        now[3 * i + j] = old[3 * i + j] + (g[3 * i] * old[j] + g[3 * i + 1] * old[3 + j] +
                                           g[3 * i + 2] * old[6 + j]);
    for (int c = 0; c < 9; c++) {
      const bool planar = c == 0 || c == 1 || c == 3 || c == 4 || c == 8;
      if (geometry == MPSI_SPACE || planar) f[c][k] = now[c];
    }
    volume[k] = now[0] * (now[4] * now[8] - now[5] * now[7]) +
                now[1] * (now[5] * now[6] - now[3] * now[8]) +
                now[2] * (now[3] * now[7] - now[4] * now[6]);
  }
}

/* sigma = G/J (B - 1) + lambda/2 (J - 1/J) 1 with B = F F^T. */
MPSI_INLINE mps_status neo_hookean_loop(const int geometry, const mpsi_law *law,
                                        const mps_material_block *block) {
  deform_loop(geometry, block);
  const mpsi_law_columns columns = mpsi_columns_of(block);
  const double *f[9], *volume = block->volume_ratio;
  for (int c = 0; c < 9; c++) f[c] = block->deformation[c];
  const double shear = law->shear, half_lambda = 0.5 * law->lambda;
  int64_t *flags = block->flags;
  SIMD for (int64_t k = 0; k < block->count; k++) {
    const double r = 1.0 / volume[k], g = shear * r, mean = half_lambda * (volume[k] - r);
    const double xx = f[0][k], xy = f[1][k], yx = f[3][k], yy = f[4][k], zz = f[8][k];
    double xz = 0.0, yz = 0.0, zx = 0.0, zy = 0.0;
    if (geometry == MPSI_SPACE) {
      xz = f[2][k];
      yz = f[5][k];
      zx = f[6][k];
      zy = f[7][k];
    }
    const mpsi_sym s = {.xx = g * (xx * xx + xy * xy + xz * xz - 1.0) + mean,
                        .yy = g * (yx * yx + yy * yy + yz * yz - 1.0) + mean,
                        .zz = g * (zx * zx + zy * zy + zz * zz - 1.0) + mean,
                        .xy = g * (xx * yx + xy * yy + xz * yz),
                        .yz = g * (yx * zx + yy * zy + yz * zz),
                        .zx = g * (zx * xx + zy * xy + zz * xz)};
    mpsi_put_stress(geometry, &columns, k, s);
    flags[k] = 0;
  }
  return MPS_OK;
}

/* ---- fluid ----------------------------------------------------------------------------------- */

/* sigma = -p 1 + 2 eta dev(d); p = K (r - 1), or K/7 (r^7 - 1), r = V0/V. */
MPSI_INLINE void fluid_loop(const int geometry, const bool tait, const mpsi_law *law,
                            const mps_material_block *block) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  double *volume = block->volume_ratio;
  int64_t *flags = block->flags;
  const double dt = block->dt, bulk = law->bulk, drag = 2.0 * law->viscosity / dt;
  const double stiff = bulk / 7.0;
  const double limit = law->no_tension ? 1.0 : INFINITY; /* of V/V0 */
  SIMD for (int64_t k = 0; k < block->count; k++) {
    const mpsi_sym d = mpsi_strain(geometry, &columns, k, dt);
    const double trace = d.xx + d.yy + d.zz, mean = trace * THIRD;
    const double trial = volume[k] + volume[k] * trace;
    const bool torn = trial > limit;
    const double v = torn ? limit : trial, r = 1.0 / v, r2 = r * r;
    const double p = tait ? stiff * (r2 * r2 * r2 * r - 1.0) : bulk * (r - 1.0);
    const mpsi_sym s = {.xx = drag * (d.xx - mean) - p,
                        .yy = drag * (d.yy - mean) - p,
                        .zz = drag * (d.zz - mean) - p,
                        .xy = drag * d.xy,
                        .yz = drag * d.yz,
                        .zx = drag * d.zx};
    volume[k] = v;
    mpsi_put_stress(geometry, &columns, k, s);
    flags[k] = torn ? MPS_MATERIAL_FLAG_APEX : 0;
  }
}

MPSI_INLINE mps_status newtonian_loop(const int geometry, const mpsi_law *law,
                                      const mps_material_block *block) {
  if (law->tait)
    fluid_loop(geometry, true, law, block);
  else
    fluid_loop(geometry, false, law, block);
  return MPS_OK;
}

/* ---- a user's law ---------------------------------------------------------------------------- */

MPSI_INLINE void turn_loop(const int geometry, const mps_material_block *block) {
  const mpsi_law_columns columns = mpsi_columns_of(block);
  const double dt = block->dt;
  SIMD for (int64_t k = 0; k < block->count; k++) {
    const mpsi_spin w = mpsi_spin_of(geometry, &columns, k, dt);
    mpsi_put_stress(geometry, &columns, k,
                    mpsi_turn(geometry, mpsi_stress(geometry, &columns, k), w));
  }
}

MPSI_INLINE mps_status user_loop(const int geometry, const mpsi_law *law,
                                 const mps_material_block *block) {
  if (block->count == 0) return MPS_OK;
  for (int64_t k = 0; k < block->count; k++) block->flags[k] = 0;
  if (law->needs_deformation)
    deform_loop(geometry, block);
  else
    volume_loop(geometry, BY_SUM, block, 0, block->count, NULL);
  if (law->turns_stress) turn_loop(geometry, block);
  MPSI_TRY(law->update(law->user, block));
  return mpsi_check_results(block, law->history_count);
}

/* ---- one function for each law and geometry -------------------------------------------------- */

#define DEFINE(KIND, LOOP, GEOMETRY)                                                               \
  static mps_status KIND##_##GEOMETRY(const mpsi_law *law, const mps_material_block *block) {      \
    return LOOP(MPSI_##GEOMETRY, law, block);                                                      \
  }
#define DEFINE_ALL(kind, loop, name, columns, kept, traits, define, moduli)                        \
  DEFINE(kind, loop, PLANE) DEFINE(kind, loop, AXIAL) DEFINE(kind, loop, SPACE)
MPSI_LAW_KINDS(DEFINE_ALL)

#define ENTRY(kind, loop, name, columns, kept, traits, define, moduli)                             \
  {[MPSI_PLANE] = kind##_PLANE, [MPSI_AXIAL] = kind##_AXIAL, [MPSI_SPACE] = kind##_SPACE},
const mpsi_law_table CONCAT(mpsi_laws_v, MPSI_LEVEL) = {{MPSI_LAW_KINDS(ENTRY)}};
