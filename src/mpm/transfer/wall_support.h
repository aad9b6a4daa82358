/* wall_support.h - particles whose support is cut by one side of the domain alone, a side that is
 * not a mirror (mirror.h). Their least-squares fit, Nakamura (5), (6), is a product of fits along
 * the axes: along the wall the stencil is full; across it, with the moments M0, M1, M2 of w over
 * the active nodes,
 *
 *   phi = w (M2 - M1 s)/D,  dphi/ds = w (M0 s - M1)/D,  D = M0 M2 - M1^2.
 *
 * The shape function is this phi times the w of the other axes, and likewise its derivative across
 * the wall; its derivative along the wall is w s/m2 of that axis times w/M0 across. So the loops
 * for full supports are used with these weights, instead of a fit over all nodes as in
 * cut_scatter.c. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/loops.h"

/* What replaces the weights w and w s across the wall. */
typedef enum mpsi_wall_part {
  MPSI_WALL_VALUE, /* phi, phi s: for mass and momentum */
  MPSI_WALL_SLOPE, /* phi, m2 dphi/ds: for values and derivatives across the wall */
  MPSI_WALL_ALONG  /* w/M0, 0: for derivatives along the wall */
} mpsi_wall_part;

/* Weights, as in mpsi_places but from index 0 on, of a segment (particles of one stencil) at a
 * wall. */
typedef struct mpsi_wall {
  int axis;
  mpsi_places places;
  mpsi_rows rows;
  double mass[MPSI_SEGMENT]; /* M0 of each particle */
} mpsi_wall;

/* Axis across the one wall that cuts the stencil from tile node `first`; -1 if anything else cuts
 * it or if momentum is transferred by weights (cut_scatter.c). `state`: bits of all its nodes
 * together. */
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

/* Whether node i of the stencil, counted along axis c from the tile's node `place`, is in the
 * domain. */
MPSI_INLINE bool mpsi_wall_active(const mpsi_grid *grid, const mpsi_cell_block *cells, int c,
                                  int place, int i) {
  const int64_t node = (int64_t)cells->at[c] * MPSI_SIDE + place + i;
  return node >= grid->use_low[c] && node <= grid->use_high[c];
}

/* Weights across the wall of a particle t cells from the lowest node of its stencil, of the kind
 * `part`; returns M0. */
MPSI_INLINE double mpsi_wall_weights(const mpsi_transfer *work, int spline, int axis, int32_t first,
                                     double t, mpsi_wall_part part, double *value, double *slope) {
  int place[3];
  double M0 = 0.0, M1 = 0.0, M2 = 0.0, w[4];
  mpsi_unravel(first, MPSI_TILE_SIDE, place);
  mpsi_weights(spline, t, w);
  for (int i = 0; i <= spline; i++) {
    const double s = (double)i - t;
    if (!mpsi_wall_active(work->grid, work->cells, axis, place[axis], i)) w[i] = 0.0;
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

/* Weights of a segment cut by the wall across `axis`. */
MPSI_INLINE void mpsi_wall_places(const mpsi_transfer *work, int dim, int spline,
                                  const mpsi_segment *segment, int axis, mpsi_wall_part part,
                                  mpsi_wall *out) {
  const mpsi_places *from = segment->places;
  const int begin = segment->begin, end = segment->end;
  out->axis = axis;
  out->places.chunk = from->chunk + begin, out->places.count = end - begin;
  for (int k = begin; k < end; k++) {
    double value[3][4], slope[3][4];
    for (int c = 0; c < dim; c++) {
      if (c == axis) {
        out->mass[k - begin] = mpsi_wall_weights(work, spline, c, from->first[k], from->t[c][k],
                                                 part, value[c], slope[c]);
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
