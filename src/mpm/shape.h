/* shape.h - shape functions of one particle: B-spline weights, seed B (35), (36), and the weighted
 * least-squares fit of a linear function over the active nodes, (5), (6), (37), (38).
 *
 * Lengths are in cells here: s = (x_i - x_p)/h, so that the moment matrix M = sum w P P^T with
 * P = [1, s] is well scaled. Where all nodes of the stencil take part M is diagonal, diag(1, m2,
 * m2) with m2 = 1/3 (cubic) or 1/4 (quadratic), and phi = w, grad phi = w s/(m2 h).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_SHAPE_H
#define MPSI_MPM_SHAPE_H

#include "mpm_private.h"

#define MPSI_STENCIL 16 /* nodes 4 j + i; quadratic stencils leave i = 3 and j = 3 out */

typedef struct mpsi_stencil {
  int first;               /* lowest node in the tile */
  int own[2];              /* first corner of the particle's cell, within the stencil */
  double w[2][4], s[2][4]; /* of each axis */
} mpsi_stencil;

typedef struct mpsi_shape_values {
  double w[MPSI_STENCIL], phi[MPSI_STENCIL]; /* 0 where a node does not take part */
  double gx[MPSI_STENCIL], gy[MPSI_STENCIL]; /* grad phi, 1/m */
  double determinant;                        /* det M / M00^3 */
} mpsi_shape_values;

/* Inverse of the second moment of a full stencil. */
MPSI_INLINE double mpsi_inverse_moment(int spline) { return spline == 3 ? 3.0 : 4.0; }

/* Weights along one axis of a particle t cells from the lowest node. */
MPSI_INLINE void mpsi_weights(int spline, double t, double *w, double *s) {
  for (int i = 0; i < 4; i++) s[i] = (double)i - t;
  if (spline == 3) {
    const double f = t - 1.0, g = 2.0 - t;
    w[0] = g * g * g * (1.0 / 6.0);
    w[1] = (3.0 * f * f * f - 6.0 * f * f + 4.0) * (1.0 / 6.0);
    w[2] = (3.0 * g * g * g - 6.0 * g * g + 4.0) * (1.0 / 6.0);
    w[3] = f * f * f * (1.0 / 6.0);
  } else {
    const double f = t - 1.0;
    w[0] = 0.5 * (0.5 - f) * (0.5 - f);
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * (0.5 + f) * (0.5 + f);
    w[3] = 0.0;
  }
}

MPSI_INLINE void mpsi_make_stencil(const mps_mpm *mpm, const mpsi_cells *cells, int spline,
                                   int64_t particle, mpsi_stencil *out) {
  int64_t local[2];
  for (int c = 0; c < 2; c++) {
    const double X = mpsi_grid_coordinate(mpm, c, mpm->p.x[c][particle]);
    const int64_t base = mpsi_base(spline, X);
    local[c] = base - (int64_t)cells->at[c] * MPSI_SIDE;
    mpsi_weights(spline, X - (double)base, out->w[c], out->s[c]);
    out->own[c] = (int)(mpsi_own_cell(mpm, c, X) - base);
  }
  out->first = (int)(local[1] * MPSI_TILE_SIDE + local[0]);
}

/* Whether every node of the stencil is there and in no body: the closed form holds. */
bool mpsi_full_support(const mps_mpm *mpm, const mpsi_cells *cells, int spline,
                       const mpsi_stencil *stencil);
/* The fit over the active nodes. */
void mpsi_fit_shape(const mps_mpm *mpm, const mpsi_cells *cells, int spline,
                    const mpsi_stencil *stencil, mpsi_shape_values *out);
/* Whether some node of the stencil lies inside the body. */
bool mpsi_sees(const mpsi_meeting *meeting, int spline, const mpsi_stencil *stencil);

#endif
