/* mohr_coulomb.c - return map of Mohr-Coulomb in principal stresses: main plane, the two edges and
 * the apex, with a flow potential of the same shape for the angle of dilation; and the cut-off of
 * tension, that no principal stress exceeds T, with its own normal flow. Around it the gap between
 * separated grains.
 *
 * The yield functions are linear and the flow directions are constant, so each return is one step:
 * solved exactly, without iteration.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/symmetric.h"
#include "material_private.h"

/* Principal stresses in any order, and the transformation back. */
typedef struct principal {
  double value[3];
  double axis[3][3]; /* 3D: axis[i][a] is component i of the direction of value[a] */
} principal;

/* ---- principal stresses ---------------------------------------------------------------------- */

/* In 2D zz is principal: value[0] and value[1] lie in the plane, on either side of the mean. */
static principal split_plane(const double *s) {
  const double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]);
  const double radius = sqrt(half * half + s[3] * s[3]);
  return (principal){.value = {mean + radius, mean - radius, s[2]}};
}

/* Sets new principal values, with the same directions in the plane. */
static void join_plane(const principal *trial, const double *value, double *s) {
  const double radius = 0.5 * (trial->value[0] - trial->value[1]);
  const double scale = radius > 0.0 ? 0.5 * (value[0] - value[1]) / radius : 0.0;
  const double mean = 0.5 * (value[0] + value[1]), half = 0.5 * (s[0] - s[1]) * scale;
  s[0] = mean + half;
  s[1] = mean - half;
  s[2] = value[2];
  s[3] *= scale;
}

static principal split_space(const double *s) {
  const double a[3][3] = {{s[0], s[3], s[4]}, {s[3], s[1], s[5]}, {s[4], s[5], s[2]}};
  principal p;
  mpsi_symmetric_principal(a, p.value, p.axis);
  return p;
}

static void join_space(const principal *trial, const double *value, double *s) {
  const int *row = mpsi_symmetric_row, *column = mpsi_symmetric_column;
  for (int c = 0; c < 6; c++) {
    s[c] = 0.0;
    for (int a = 0; a < 3; a++)
      s[c] += value[a] * trial->axis[row[c]][a] * trial->axis[column[c]][a];
  }
}

/* ---- return map in ordered principal stresses s[0] >= s[1] >= s[2] --------------------------- */

/* Stress lost per unit of flow on the plane f(largest, smallest): by the stress of that role. */
typedef struct drop {
  double largest, middle, smallest;
} drop;

static drop flow_drop(const mpsi_law *law) {
  const double g = law->shear, psi = law->sin_psi, volume = 2.0 * law->bulk * psi;
  return (drop){.largest = volume + 2.0 * g * (1.0 + psi / 3.0),
                .middle = volume - 4.0 / 3.0 * g * psi,
                .smallest = volume - 2.0 * g * (1.0 - psi / 3.0)};
}

/* Yield function of the plane of s1 and s3. */
static double yield(const mpsi_law *law, double s1, double s3) {
  return (s1 - s3) + (s1 + s3) * law->sin_phi - 2.0 * law->c_cos_phi;
}

/* Decrease of f(s1, s3) for changes of -d1 and -d3. */
static double yield_loss(const mpsi_law *law, double d1, double d3) {
  return (d1 - d3) + (d1 + d3) * law->sin_phi;
}

/* An edge, the intersection of two planes; `i`, `j` the two equal stresses and `k` the third. By
 * symmetry the equal ones may be replaced by their mean, with the mean of the two flows. */
static void return_to_edge(const mpsi_law *law, double pair_drop, double third_drop, bool right,
                           double *s, int i, int j, int k) {
  const double pair = 0.5 * (s[i] + s[j]);
  const double f = right ? yield(law, s[k], pair) : yield(law, pair, s[k]);
  const double loss =
      right ? yield_loss(law, third_drop, pair_drop) : yield_loss(law, pair_drop, third_drop);
  const double flow = f / loss;
  s[i] = s[j] = pair - flow * pair_drop;
  s[k] -= flow * third_drop;
}

/* To the pyramid: its plane, one of its edges, or its apex. */
static int64_t return_to_pyramid(const mpsi_law *law, double *s) {
  const double f = yield(law, s[0], s[2]);
  if (!(f > 0.0)) return 0;
  const drop d = flow_drop(law);
  const double flow = f / yield_loss(law, d.largest, d.smallest);
  const double plane[3] = {s[0] - flow * d.largest, s[1] - flow * d.middle,
                           s[2] - flow * d.smallest};
  if (plane[0] >= plane[1] && plane[1] >= plane[2]) {
    for (int i = 0; i < 3; i++) s[i] = plane[i];
    return MPS_MATERIAL_FLAG_PLASTIC;
  }
  /* The edge that the plane's return has passed. Right: the two smaller stresses, compression. */
  if (plane[1] < plane[2])
    return_to_edge(law, 0.5 * (d.middle + d.smallest), d.largest, true, s, 1, 2, 0);
  else
    return_to_edge(law, 0.5 * (d.largest + d.middle), d.smallest, false, s, 0, 1, 2);
  if (s[0] >= s[1] && s[1] >= s[2]) return MPS_MATERIAL_FLAG_PLASTIC;
  s[0] = s[1] = s[2] = law->apex;
  return MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX;
}

/* To the cut-off alone: s1 = T, or s1 = s2 = T, or all three. A unit of its flow along a stress
 * decreases that one by `along` and the other two by `across`. */
static void return_to_cut(const mpsi_law *law, double *s) {
  const double T = law->cut, across = law->lambda, along = across + 2.0 * law->shear;
  const double middle = s[1] - across / along * (s[0] - T);
  if (middle <= T) {
    const double smallest = s[2] - across / along * (s[0] - T);
    s[0] = T, s[1] = middle, s[2] = smallest;
    return;
  }
  const double smallest = s[2] - across / (along + across) * (s[0] + s[1] - 2.0 * T);
  s[0] = s[1] = T;
  s[2] = smallest <= T ? smallest : T;
}

/* To the intersection of the pyramid's plane and the cut-off, s1 = T and s3 = low, or to its ends
 * on the edges s2 = s3 and s1 = s2. */
static void return_to_brim(const mpsi_law *law, double *s) {
  const double T = law->cut, across = law->lambda, along = across + 2.0 * law->shear;
  const double low =
      (T * (1.0 + law->sin_phi) - 2.0 * law->c_cos_phi) / (1.0 - law->sin_phi); /* < T */
  const drop d = flow_drop(law);
  const double det = d.largest * across - d.smallest * along; /* > 0, as psi < 90 degrees */
  const double flow = (across * (s[0] - T) - along * (s[2] - low)) / det;
  const double open = (d.largest * (s[2] - low) - d.smallest * (s[0] - T)) / det;
  const double middle = s[1] - flow * d.middle - open * across;
  s[0] = T;
  s[1] = middle > T ? T : middle < low ? low : middle;
  s[2] = low;
}

/* A return to one of the two surfaces that satisfies the other one is the solution; else both are
 * active. With normal flow that is the closest point. */
static int64_t return_principal(const mpsi_law *law, double *s) {
  double pyramid[3] = {s[0], s[1], s[2]};
  const int64_t flags = return_to_pyramid(law, pyramid);
  if (!(pyramid[0] > law->cut)) {
    for (int i = 0; i < 3; i++) s[i] = pyramid[i];
    return flags;
  }
  double cut[3] = {s[0], s[1], s[2]};
  return_to_cut(law, cut);
  if (s[0] > law->cut && yield(law, cut[0], cut[2]) <= 0.0)
    for (int i = 0; i < 3; i++) s[i] = cut[i];
  else
    return_to_brim(law, s);
  return MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX;
}

/* Increment of plastic strain: the deviator lost is 2 G de. */
static double plastic_increment(const mpsi_law *law, const double *before, const double *after) {
  const double x = before[0] - after[0], y = before[1] - after[1], z = before[2] - after[2];
  const double square = (x - y) * (x - y) + (y - z) * (y - z) + (z - x) * (z - x);
  return sqrt(square * (2.0 / 9.0)) / (2.0 * law->shear); /* sqrt(2/3 dev:dev) */
}

static void order(const double *value, int *rank) {
  for (int i = 0; i < 3; i++) rank[i] = i;
  for (int pass = 0; pass < 3; pass++) { /* 0-1, 1-2, 0-1 */
    const int i = pass == 1 ? 1 : 0;
    if (value[rank[i]] < value[rank[i + 1]]) {
      const int kept = rank[i];
      rank[i] = rank[i + 1];
      rank[i + 1] = kept;
    }
  }
}

/* ---- gaps ------------------------------------------------------------------------------------ */

/* Largest fraction of the deviator of s that the pyramid and the cut-off allow at the mean stress
 * p: 0 to 1. At the apex the room is 0 to rounding, of either sign, and the deviator may be 0. */
static double share_at(const mpsi_law *law, const double *s, double mean, double p) {
  const double d1 = s[0] - mean, d3 = s[2] - mean;
  const double need = (d1 - d3) + (d1 + d3) * law->sin_phi;
  const double left = fmax(0.0, 2.0 * (law->c_cos_phi - p * law->sin_phi));
  double share = need > left ? left / need : 1.0;
  if (share * d1 > law->cut - p) share = (law->cut - p) / d1;
  return share;
}

/* With a gap between the grains the mean stress is that of elastic unloading, at least 0, and the
 * deviator is scaled to the yield surface there: no dilation. */
static void hold_open(const mpsi_law *law, double mean, double *s) {
  const double p = fmax(0.0, fmin(mean, fmin(law->apex, law->cut)));
  const double share = share_at(law, s, mean, p);
  for (int i = 0; i < 3; i++) s[i] = p + share * (s[i] - mean);
}

static double mean_of(const double *s) { return (s[0] + s[1] + s[2]) / 3.0; }

/* The return with an end of dilation: where the flow by psi takes the mean stress below `least`, it
 * goes by the angle between 0 and psi that takes it there. The mean stress falls with the angle. */
static int64_t return_to_end(const mpsi_law *law, double least, double *s) {
  const double close = 1e-15 * law->bulk, trial[3] = {s[0], s[1], s[2]};
  int64_t flags = return_principal(law, s);
  if (!(law->loosest > 0.0) || flags == 0 || flags & MPS_MATERIAL_FLAG_APEX) return flags;
  double high = law->sin_psi, f_high = mean_of(s) - least, low = 0.0, f_low = 0.0;
  if (f_high >= -close) return flags;
  mpsi_law part = *law;
  for (int i = 0; i < 100; i++) { /* no dilation first, then Illinois */
    const double x = i == 0 ? 0.0 : low - f_low * (high - low) / (f_high - f_low);
    part.sin_psi = x;
    for (int c = 0; c < 3; c++) s[c] = trial[c];
    flags = return_principal(&part, s);
    const double f = mean_of(s) - least;
    if (fabs(f) <= close || (i == 0 && f < 0.0)) break;
    if (f > 0.0) {
      low = x, f_low = f;
      if (i > 0) f_high *= 0.5;
    } else {
      high = x, f_high = f;
      f_low *= 0.5;
    }
  }
  return flags;
}

/* The return with the gap: compression closes it before the mean stress falls below 0; the volume
 * strain of a return to the apex, or to the cut-off along all axes, opens it. A crack along one or
 * two axes has no gap. *opened: volume strain that is not that of the grains. */
static int64_t return_with_gap(const mpsi_law *law, double least, double *s, double *gap,
                               double *opened) {
  const double mean = mean_of(s), closed = mean + law->bulk * *gap;
  const bool open = *gap > 0.0 && closed > 0.0;
  int64_t flags = MPS_MATERIAL_FLAG_PLASTIC | MPS_MATERIAL_FLAG_APEX;
  if (open) {
    hold_open(law, mean, s);
  } else {
    for (int i = 0; i < 3; i++) s[i] += law->bulk * *gap;
    const int64_t yields = return_to_end(law, least, s);
    *opened = -*gap;
    if (!(yields & MPS_MATERIAL_FLAG_APEX)) {
      if (*gap == 0.0) return yields;
      *gap = 0.0;
      return flags;
    }
  }
  *opened = (mean - mean_of(s)) * law->per_bulk;
  *gap = open || s[0] == s[2] ? fmax(0.0, *gap + *opened) : 0.0;
  return flags;
}

int64_t mpsi_mohr_coulomb_return(const mpsi_law *law, int32_t dim, double least, double *stress,
                                 double *plastic_strain, double *gap, double *opened) {
  const principal trial = dim == 3 ? split_space(stress) : split_plane(stress);
  int rank[3];
  double s[3], before[3], value[3];
  order(trial.value, rank);
  for (int i = 0; i < 3; i++) before[i] = s[i] = trial.value[rank[i]];
  const int64_t flags = return_with_gap(law, least, s, gap, opened);
  if (flags == 0) return 0;
  for (int i = 0; i < 3; i++) value[rank[i]] = s[i];
  *plastic_strain += plastic_increment(law, before, s);
  if (dim == 3)
    join_space(&trial, value, stress);
  else
    join_plane(&trial, value, stress);
  return flags;
}
