/* shape.h - shape functions of one particle: B-spline weights, Nakamura (35), (36), and the
 * weighted least-squares fit of a linear function over the active nodes, (5), (6), (37), (38).
 *
 * Lengths are in cells here: s = (x_i - x_p)/h, so that the moment matrix M = sum w P P^T with P =
 * [1, s] is well scaled. Where all nodes of the stencil are active M is diagonal, diag(1, m2, m2,
 * m2) with m2 = 1/3 (cubic) or 1/4 (quadratic), and phi = w, grad phi = w s/(m2 h).
 *
 * `dim` and `spline` are literal arguments wherever speed counts.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/grid/blocks.h"

#define MPSI_STENCIL                                                                               \
  64 /* nodes 16 k + 4 j + i; in 2D k = 0, quadratic stencils have i, j, k below 3 */

typedef struct mpsi_stencil {
  int at[3];  /* lowest node of the stencil, in the tile */
  int own[3]; /* first corner of the particle's cell, within the stencil */
  double w[3][4],
      s[3][4]; /* weights and distances of the nodes, by axis; w is 0 where there is no node */
} mpsi_stencil;

typedef struct mpsi_shape_values {
  double w[MPSI_STENCIL], phi[MPSI_STENCIL]; /* 0 at inactive nodes */
  double gradient[3][MPSI_STENCIL];          /* of phi, 1/m */
  double determinant;                        /* det M / M00^(dim + 1) */
  uint64_t across; /* nodes whose values across thin bodies are used: thin_bodies.h */
} mpsi_shape_values;

/* psi = phi + grad phi . d at the nodes of a stencil whose lowest is tile node `at`: the shape
 * functions of a particle, extrapolated linearly to the distance d (m) from it. */
typedef struct mpsi_foot_weights {
  int at[3];
  uint64_t active,
      across; /* bit n: node n is active; its values across thin bodies are used (thin_bodies.h) */
  double psi[MPSI_STENCIL]; /* psi of the active nodes */
} mpsi_foot_weights;

/* Inverse of the second moment of a full stencil. */
MPSI_INLINE double mpsi_inverse_moment(int spline) { return spline == 3 ? 3.0 : 4.0; }

/* Value of the B-spline s cells from its middle. */
MPSI_INLINE double mpsi_spline_at(int spline, double s) {
  s = fabs(s);
  if (spline == 2) return s < 0.5 ? 0.75 - s * s : s < 1.5 ? 0.5 * (1.5 - s) * (1.5 - s) : 0.0;
  return s < 1.0   ? 2.0 / 3.0 - s * s + 0.5 * s * s * s
         : s < 2.0 ? (2.0 - s) * (2.0 - s) * (2.0 - s) / 6.0
                   : 0.0;
}

/* B-spline weights along one axis of a particle t cells from the lowest node. */
MPSI_INLINE void mpsi_weights(int spline, double t, double *w) {
  const double f = t - 1.0;
  if (spline == 3) {
    const double g = 2.0 - t;
    w[0] = g * g * g * (1.0 / 6.0);
    w[1] = (3.0 * f * f * f - 6.0 * f * f + 4.0) * (1.0 / 6.0);
    w[2] = (3.0 * g * g * g - 6.0 * g * g + 4.0) * (1.0 / 6.0);
    w[3] = f * f * f * (1.0 / 6.0);
  } else {
    w[0] = 0.5 * (0.5 - f) * (0.5 - f);
    w[1] = 0.75 - f * f;
    w[2] = 0.5 * (0.5 + f) * (0.5 + f);
    w[3] = 0.0;
  }
}

/* Derivatives of the weights by t, the particle's position in cells. */
MPSI_INLINE void mpsi_slopes(int spline, double t, double *slope) {
  const double f = t - 1.0;
  if (spline == 3) {
    const double g = 2.0 - t;
    slope[0] = -0.5 * g * g;
    slope[1] = (1.5 * f - 2.0) * f;
    slope[2] = (2.0 - 1.5 * g) * g;
    slope[3] = 0.5 * f * f;
  } else {
    slope[0] = f - 0.5;
    slope[1] = -2.0 * f;
    slope[2] = f + 0.5;
    slope[3] = 0.0;
  }
}

MPSI_INLINE void mpsi_make_stencil(const mpsi_grid *grid, const mpsi_columns *p,
                                   const mpsi_cell_block *cells, int dim, int spline,
                                   int64_t particle, mpsi_stencil *out) {
  *out = (mpsi_stencil){.w[2][0] = 1.0};
  for (int c = 0; c < dim; c++) {
    const double X = mpsi_grid_at(grid, c, p->x[c][particle]);
    const double base = mpsi_base(spline, X);
    mpsi_weights(spline, X - base, out->w[c]);
    for (int i = 0; i < 4; i++) out->s[c][i] = (double)i - (X - base);
    out->at[c] = (int)((int64_t)base - (int64_t)cells->at[c] * MPSI_SIDE);
    out->own[c] = (int)(mpsi_own_cell(grid, c, X) - (int64_t)base);
  }
}
