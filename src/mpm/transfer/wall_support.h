/* wall_support.h - particles whose support nothing but one wall of the domain cuts, across one
 * axis: sides that are no mirrors (mirror.h). Their fit, Nakamura (5), (6), falls apart into one
 * along each axis: along the others the stencil is full, and across the wall, with the moments M0,
 * M1, M2 of w over its active nodes, phi = w (M2 - M1 s)/D,  dphi/ds = w (M0 s - M1)/D,  D = M0 M2
 * - M1^2. The shape function is phi times the w of the other axes, and its derivative along the
 * wall's axis likewise; derivatives along the others are w s/m2 there times w/M0 here. So the loops
 * for full supports serve, with other weights, where cut_scatter.c would take a fit of all nodes.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_WALL_H
#define MPSI_MPM_WALL_H

#include "mpm/base/loops.h"

/* What stands for w and w s across the wall. */
typedef enum mpsi_wall_part {
  MPSI_WALL_VALUE, /* phi, phi s: mass and momentum */
  MPSI_WALL_SLOPE, /* phi, m2 dphi/ds: value, and derivative across the wall */
  MPSI_WALL_ALONG  /* w/M0, 0: derivatives along it */
} mpsi_wall_part;

/* A segment at a wall: weights as of mpsi_places, from 0 on. */
typedef struct mpsi_wall {
  int axis;
  mpsi_places places;
  mpsi_rows rows;
  double mass[MPSI_SEGMENT]; /* M0 */
} mpsi_wall;

/* The axis of the wall, where the stencil from tile node `first`, whose nodes have the states
 * `state` together, is cut by nothing but one; else -1. Momentum by weights goes with
 * cut_scatter.c. */
MPSI_INLINE int mpsi_wall_axis(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                               int spline, uint32_t state, int32_t first) {
  int place[3], axis = -1;
  if (state != MPSI_OUTSIDE || grid->by_weight) return -1;
  mpsi_unravel(first, MPSI_TILE_SIDE, place);
  for (int c = 0; c < dim; c++) {
    const int64_t node = (int64_t)cells->at[c] * MPSI_SIDE + place[c];
    if (node >= grid->use_low[c] && node + spline <= grid->use_high[c]) continue;
    if (axis >= 0) return -1;
    axis = c;
  }
  return axis;
}

/* Whether this particle's node i across the wall is in the domain. */
MPSI_INLINE bool mpsi_wall_active(const mpsi_grid *grid, const mpsi_cell_block *cells, int c,
                                  int place, int i) {
  const int64_t node = (int64_t)cells->at[c] * MPSI_SIDE + place + i;
  return node >= grid->use_low[c] && node <= grid->use_high[c];
}

/* The weights of particle k of the chunk across the wall; returns M0. */
MPSI_INLINE double mpsi_wall_weights(const mpsi_grid *grid, const mpsi_cell_block *cells,
                                     int spline, int axis, int32_t first, double t,
                                     mpsi_wall_part part, double *value, double *slope) {
  int place[3];
  double M0 = 0.0, M1 = 0.0, M2 = 0.0, w[4];
  mpsi_unravel(first, MPSI_TILE_SIDE, place);
  mpsi_weights(spline, t, w);
  for (int i = 0; i <= spline; i++) {
    const double s = (double)i - t;
    if (!mpsi_wall_active(grid, cells, axis, place[axis], i)) w[i] = 0.0;
    M0 += w[i], M1 += w[i] * s, M2 += w[i] * s * s;
  }
  const double inverse = 1.0 / (M0 * M2 - M1 * M1);
  for (int i = 0; i < 4; i++) {
    const double s = (double)i - t, phi = w[i] * (M2 - M1 * s) * inverse;
    value[i] = part == MPSI_WALL_ALONG ? w[i] / M0 : phi;
    slope[i] = part == MPSI_WALL_ALONG ? 0.0
               : part == MPSI_WALL_VALUE
                   ? phi * s
                   : w[i] * (M0 * s - M1) * inverse / mpsi_inverse_moment(spline);
  }
  return M0;
}

/* Particles [begin, end) of a chunk, all of one stencil that the wall across `axis` cuts. */
MPSI_INLINE void mpsi_wall_places(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                  int spline, const mpsi_places *from, int begin, int end, int axis,
                                  mpsi_wall_part part, mpsi_wall *out) {
  out->axis = axis;
  for (int k = begin; k < end; k++) {
    double value[3][4], slope[3][4];
    for (int c = 0; c < dim; c++) {
      if (c == axis) {
        out->mass[k - begin] = mpsi_wall_weights(&mpm->grid, cells, spline, c, from->first[k],
                                                 from->t[c][k], part, value[c], slope[c]);
        continue;
      }
      mpsi_weights(spline, from->t[c][k], value[c]);
      for (int i = 0; i < 4; i++) slope[c][i] = value[c][i] * ((double)i - from->t[c][k]);
    }
    out->places.first[k - begin] = from->first[k];
    memcpy(out->rows.w[k - begin], value[0], sizeof value[0]);
    memcpy(out->rows.ws[k - begin], slope[0], sizeof slope[0]);
    for (int c = 0; c < dim; c++) out->places.t[c][k - begin] = from->t[c][k];
    for (int c = 0; c < dim; c++)
      for (int i = 0; i <= spline; i++) {
        out->places.w[c][i][k - begin] = value[c][i];
        out->places.ws[c][i][k - begin] = slope[c][i];
      }
  }
  mpsi_pad_places(dim, spline, 7, end - begin, &out->places);
}

#endif
