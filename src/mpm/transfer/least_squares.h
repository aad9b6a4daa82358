/* least_squares.h - the weighted least-squares fit over the active nodes of cut supports, Nakamura
 * (5), (6): M = sum w P P^T with P = [1, s], phi = w (M^-1 P)_0, its gradient the other rows; by
 * particle in the lanes of a vector. Kept from the scatter of a step to its gather, and to the
 * contact between. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_LEAST_SQUARES_H
#define MPSI_MPM_LEAST_SQUARES_H

#include "support.h"

/* The upper half of sum w P P^T, P = [1, s]. */
MPSI_INLINE void mpsi_moments(int dim, int spline, const mpsi_cut *b, const mpsi_quad *w,
                              mpsi_quad m[4][4]) {
  for (int r = 0; r < 4; r++)
    for (int c = 0; c < 4; c++) m[r][c] = (mpsi_quad){0.0};
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const mpsi_quad *row = w + 16 * k + 4 * j, *x = b->s[0], y = b->s[1][j];
      mpsi_quad one = row[0], by_x = row[0] * x[0], by_xx = by_x * x[0];
      for (int i = 1; i <= spline; i++) {
        one += row[i];
        by_x += row[i] * x[i];
        by_xx += row[i] * x[i] * x[i];
      }
      m[0][0] += one, m[0][1] += by_x, m[1][1] += by_xx;
      m[0][2] += one * y, m[1][2] += by_x * y, m[2][2] += one * y * y;
      if (dim == 2) continue;
      const mpsi_quad z = b->s[2][k];
      m[0][3] += one * z, m[1][3] += by_x * z, m[2][3] += one * y * z, m[3][3] += one * z * z;
    }
}

/* Inverses of symmetric positive definite matrices, given by their upper halves, by Gauss
 * and Jordan; returns the determinants. */
MPSI_INLINE mpsi_quad mpsi_invert_lanes(int n, mpsi_quad m[4][4]) {
  mpsi_quad determinant = {1.0, 1.0, 1.0, 1.0};
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) m[i][j] = m[j][i];
  MPSI_UNROLL for (int p = 0; p < n; p++) {
    const mpsi_quad scale = 1.0 / m[p][p];
    determinant *= m[p][p];
    m[p][p] = (mpsi_quad){1.0, 1.0, 1.0, 1.0};
    for (int j = 0; j < n; j++) m[p][j] *= scale;
    MPSI_UNROLL for (int i = 0; i < n; i++) {
      if (i == p) continue;
      const mpsi_quad factor = m[i][p];
      m[i][p] = (mpsi_quad){0.0};
      for (int j = 0; j < n; j++) m[i][j] -= factor * m[p][j];
    }
  }
  return determinant;
}

/* A linear function of s, q[0] + q[1] s_x + ..., at a row of nodes along x, but for what is by s_x.
 */
MPSI_INLINE mpsi_quad mpsi_across(int dim, const mpsi_cut *b, const mpsi_quad *q, int j, int k) {
  const mpsi_quad sum = q[0] + q[2] * b->s[1][j];
  return dim == 3 ? sum + q[3] * b->s[2][k] : sum;
}

/* From the inverse of M, whose upper half is that of `upper`. */
MPSI_INLINE void mpsi_finish_fit(const mpsi_grid *grid, int dim, mpsi_quad upper[4][4],
                                 mpsi_cut *b) {
  for (int r = 0; r <= dim; r++)
    for (int c = 0; c <= dim; c++) {
      const mpsi_quad q = r <= c ? upper[r][c] : upper[c][r];
      b->q[r][c] = r == 0 ? q : q * grid->inverse;
    }
}

/* ---- kept from the scatter to the gather ----------------------------------------------------- */

MPSI_INLINE void mpsi_keep_fit(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                               int spline, const mpsi_cut *b, mpsi_quad q[4][4]) {
  const int64_t slot = cells->first_fit + (b->first - cells->begin);
  const int n = b->lanes;
  mpsi_quad all[12] = {{0.0}};
  mpsi_mask active = {0};
  int count = 0;
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++) all[count++] = q[r][c];
  for (int part = 0; part < count; part += 4) {
    mpsi_transpose(all + part);
    for (int l = 0; l < n; l++) mpsi_put(grid->fit[slot + l].q + part, all[part + l]);
  }
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++)
      for (int i = 0; i <= spline; i++) {
        const int node = 16 * k + 4 * j + i;
        active |= (b->w[node] != 0.0) & (int64_t)(UINT64_C(1) << node);
      }
  for (int l = 0; l < n; l++) {
    grid->fit[slot + l].active = (uint64_t)active[l];
    grid->fitted[slot + l] = MPSI_FITTED_CUT;
  }
}

/* Takes the fits that mpsi_make_fit has kept. */
MPSI_INLINE void mpsi_take_fit(const mpsi_grid *grid, const mpsi_cell_block *cells, int dim,
                               int spline, mpsi_cut *out) {
  const int n = out->lanes;
  const int64_t slot = cells->first_fit + (out->first - cells->begin);
  mpsi_quad all[12], upper[4][4];
  mpsi_mask active = {0};
  int count = 0;
  for (int part = 0; part < (dim == 2 ? 8 : 12); part += 4) {
    for (int l = 0; l < 4; l++)
      all[part + l] = mpsi_get(grid->fit[slot + (l < n ? l : 0)].q + part);
    mpsi_transpose(all + part);
  }
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++) upper[r][c] = all[count++];
  mpsi_finish_fit(grid, dim, upper, out);
  for (int l = 0; l < 4; l++) active[l] = (int64_t)grid->fit[slot + (l < n ? l : 0)].active;
  for (int z = 0; z <= (dim == 3 ? spline : 0); z++)
    for (int j = 0; j <= spline; j++) {
      mpsi_quad across = out->along[1][j];
      if (dim == 3) across *= out->along[2][z];
      for (int i = 0; i <= spline; i++) {
        const int node = 16 * z + 4 * j + i;
        const mpsi_mask there = mpsi_has_node(active, node);
        out->w[node] = (mpsi_quad)((mpsi_mask)(out->along[0][i] * across) & there);
      }
    }
}

/* Whether all have been kept in this step. */
MPSI_INLINE bool mpsi_has_fits(const mpsi_grid *grid, const mpsi_cell_block *cells,
                               const mpsi_cut *b) {
  bool kept = cells->first_fit >= 0 && !cells->thin;
  for (int l = 0; l < b->lanes && kept; l++)
    kept = grid->fitted[cells->first_fit + (b->first + l - cells->begin)] != 0;
  return kept;
}

/* The inverse of M in `upper`, then the fit; returns det M / M00^(dim + 1). */
MPSI_INLINE mpsi_quad mpsi_invert_fit(const mpsi_grid *grid, int dim, int spline,
                                      mpsi_quad upper[4][4], mpsi_cut *b) {
  mpsi_moments(dim, spline, b, b->w, upper);
  const mpsi_quad mass = upper[0][0];
  const mpsi_quad determinant = mpsi_invert_lanes(dim + 1, upper);
  mpsi_finish_fit(grid, dim, upper, b);
  return determinant / (dim == 3 ? mass * mass * mass * mass : mass * mass * mass);
}

/* A fit for itself. */
MPSI_INLINE mpsi_quad mpsi_find_fit(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                    const mpsi_worker *worker, int dim, int spline, bool thin,
                                    bool known, mpsi_cut *b) {
  mpsi_quad upper[4][4];
  mpsi_find_active(mpm, cells, worker, dim, spline, thin, known, b);
  return mpsi_invert_fit(&mpm->grid, dim, spline, upper, b);
}

/* The fit of the scatter, kept where the block keeps fits. */
MPSI_INLINE void mpsi_make_fit(const mps_mpm *mpm, const mpsi_cell_block *cells,
                               const mpsi_worker *worker, int dim, int spline, bool thin,
                               mpsi_cut *b) {
  mpsi_quad upper[4][4];
  mpsi_find_active(mpm, cells, worker, dim, spline, thin, false, b);
  mpsi_invert_fit(&mpm->grid, dim, spline, upper, b);
  if (!thin && cells->first_fit >= 0) mpsi_keep_fit(&mpm->grid, cells, dim, spline, b, upper);
}

/* phi of node n, which is (i, j, k). */
MPSI_INLINE mpsi_quad mpsi_phi(int dim, const mpsi_cut *b, int n, int i, int j, int k) {
  return b->w[n] * (mpsi_across(dim, b, b->q[0], j, k) + b->q[0][1] * b->s[0][i]);
}

/* ---- one of the particles -------------------------------------------------------------------- */

/* The standard scheme's shape functions: the spline and its derivatives, whatever lies in the
 * support. */
MPSI_INLINE void mpsi_take_splines(const mpsi_grid *grid, int dim, int spline, const mpsi_cut *b,
                                   int lane, mpsi_shape_values *out) {
  double slope[3][4] = {{0.0}}, w[3][4];
  for (int c = 0; c < dim; c++) mpsi_slopes(spline, -b->s[c][0][lane], slope[c]);
  for (int c = 0; c < 3; c++)
    for (int i = 0; i < 4; i++) w[c][i] = c < dim && i <= spline ? b->along[c][i][lane] : i == 0;
  MPSI_FOR_NODES(dim, spline) {
    out->w[n] = out->phi[n] = w[0][i] * w[1][j] * w[2][k];
    out->gradient[0][n] = grid->inverse * slope[0][i] * w[1][j] * w[2][k];
    out->gradient[1][n] = grid->inverse * w[0][i] * slope[1][j] * w[2][k];
    if (dim == 3) out->gradient[2][n] = grid->inverse * w[0][i] * w[1][j] * slope[2][k];
  }
}

MPSI_INLINE void mpsi_values_of(const mpsi_grid *grid, int dim, int spline, const mpsi_cut *b,
                                int lane, mpsi_shape_values *out) {
  out->across = (uint64_t)b->across[lane];
  out->determinant = 1.0;
  if (grid->standard) {
    mpsi_take_splines(grid, dim, spline, b, lane, out);
    return;
  }
  MPSI_FOR_NODES(dim, spline) {
    const double x = b->s[0][i][lane], w = b->w[n][lane];
    out->w[n] = w;
    for (int r = 0; r <= dim; r++) {
      double value = b->q[r][0][lane] + b->q[r][1][lane] * x + b->q[r][2][lane] * b->s[1][j][lane];
      if (dim == 3) value += b->q[r][3][lane] * b->s[2][k][lane];
      *(r == 0 ? &out->phi[n] : &out->gradient[r - 1][n]) = w * value;
    }
  }
}

/* Particle `p` by itself, as mpsi_places of one. */
MPSI_INLINE void mpsi_place_one(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                int spline, int64_t p, mpsi_cut *out) {
  mpsi_places one;
  mpsi_find_places(mpm, cells, dim, spline, 0, 0, p, 1, &one);
  mpsi_place_cut(dim, spline, &one, 0, p, 1, 0, out);
}

/* The function `body` with dimension and spline as literal arguments; of the solver's kind. */
#define MPSI_CHOOSE(body, ...)                                                                     \
  (mpm->grid.dim == 2      ? mpm->grid.spline == 2 ? body(mpm, cells, worker, 2, 2, __VA_ARGS__)   \
                                                   : body(mpm, cells, worker, 2, 3, __VA_ARGS__)   \
        : mpm->grid.spline == 2 ? body(mpm, cells, worker, 3, 2, __VA_ARGS__)                      \
                           : body(mpm, cells, worker, 3, 3, __VA_ARGS__))

#endif
