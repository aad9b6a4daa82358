/* least_squares.h - weighted least-squares fit of a linear function over the active nodes of cut
 * supports: moment matrix M = sum w P P^T with P = [1, s], shape functions phi = w (M^-1 P)_0,
 * their gradient by the other rows, Nakamura (5), (6). Each particle is a lane of a vector. The
 * scatter of a step stores the fits for its gather and for the contact stage between.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "support.h"

/* Upper half of the moment matrix M = sum w P P^T, P = [1, s]. */
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

/* Inverts symmetric positive definite matrices, given by their upper halves, by Gauss-Jordan
 * elimination; returns the determinants. */
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

/* Value of the linear function q[0] + q[1] s_x + q[2] s_y + q[3] s_z at s_x = 0 on row (j, k) of
 * nodes along x. */
MPSI_INLINE mpsi_quad mpsi_row_value(int dim, const mpsi_cut *b, const mpsi_quad *q, int j, int k) {
  const mpsi_quad sum = q[0] + q[2] * b->s[1][j];
  return dim == 3 ? sum + q[3] * b->s[2][k] : sum;
}

/* Stores M^-1, given by its upper half, in b->q, with the rows of the gradient divided by h. */
MPSI_INLINE void mpsi_finish_fit(const mpsi_grid *grid, int dim, mpsi_quad upper[4][4],
                                 mpsi_cut *b) {
  for (int r = 0; r <= dim; r++)
    for (int c = 0; c <= dim; c++) {
      const mpsi_quad q = r <= c ? upper[r][c] : upper[c][r];
      b->q[r][c] = r == 0 ? q : q * grid->inverse;
    }
}

/* ---- fits stored by the scatter for the gather ----------------------------------------------- */

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

/* Reads the fits that mpsi_make_fit has stored and recomputes the weights of the active nodes. */
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

/* Whether the scatter of this step has stored the fits of all particles of the batch. */
MPSI_INLINE bool mpsi_has_fits(const mpsi_grid *grid, const mpsi_cell_block *cells,
                               const mpsi_cut *b) {
  bool kept = cells->first_fit >= 0 && !cells->thin;
  for (int l = 0; l < b->lanes && kept; l++)
    kept = grid->fitted[cells->first_fit + (b->first + l - cells->begin)] != 0;
  return kept;
}

/* M^-1 for the weights b->w, its upper half in `upper`, and the fit in b->q; returns det M /
 * M00^(dim + 1), which is near 0 if M is nearly singular. */
MPSI_INLINE mpsi_quad mpsi_invert_fit(const mpsi_grid *grid, int dim, int spline,
                                      mpsi_quad upper[4][4], mpsi_cut *b) {
  mpsi_moments(dim, spline, b, b->w, upper);
  const mpsi_quad mass = upper[0][0];
  const mpsi_quad determinant = mpsi_invert_lanes(dim + 1, upper);
  mpsi_finish_fit(grid, dim, upper, b);
  return determinant / (dim == 3 ? mass * mass * mass * mass : mass * mass * mass);
}

/* Active nodes and fit of a batch, without storing them; returns det M / M00^(dim + 1). */
MPSI_INLINE mpsi_quad mpsi_find_fit(const mpsi_transfer *work, int dim, int spline, bool thin,
                                    bool known, mpsi_cut *b) {
  mpsi_quad upper[4][4];
  mpsi_find_active(work, dim, spline, thin, known, b);
  return mpsi_invert_fit(work->grid, dim, spline, upper, b);
}

/* Active nodes and fit of a batch in the scatter, stored if the block stores fits. */
MPSI_INLINE void mpsi_make_fit(const mpsi_transfer *work, int dim, int spline, bool thin,
                               mpsi_cut *b) {
  mpsi_quad upper[4][4];
  mpsi_find_active(work, dim, spline, thin, false, b);
  mpsi_invert_fit(work->grid, dim, spline, upper, b);
  if (!thin && work->cells->first_fit >= 0)
    mpsi_keep_fit(work->grid, work->cells, dim, spline, b, upper);
}

/* Shape function phi of node n = 16 k + 4 j + i. */
MPSI_INLINE mpsi_quad mpsi_phi(int dim, const mpsi_cut *b, int n, int i, int j, int k) {
  return b->w[n] * (mpsi_row_value(dim, b, b->q[0], j, k) + b->q[0][1] * b->s[0][i]);
}

/* ---- one particle of a batch ----------------------------------------------------------------- */

/* Shape functions of standard MPM: B-splines and their derivatives, not changed by what cuts the
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

/* Weights, shape functions and gradients (1/m) of the particle in a lane, at all nodes of its
 * stencil. */
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

/* Batch of the single particle `p`. */
MPSI_INLINE void mpsi_place_one(const mpsi_transfer *work, int dim, int spline, int64_t p,
                                mpsi_cut *out) {
  mpsi_places one;
  const mpsi_segment segment = {&one, 0, 1};
  mpsi_find_places(work, dim, spline, 0, 0, p, 1, &one);
  mpsi_place_cut(work->worker, dim, spline, &segment, 0, 0, out);
}

/* A particle of a batch, for work that is done particle by particle. */
typedef struct mpsi_single {
  int64_t particle;       /* its index */
  int lane;               /* its lane in the batch */
  const mpsi_cut *batch;  /* whose stencil it has */
  const mpsi_support *at; /* nodes of the stencil */
  mpsi_shape_values f;    /* its shape functions */
} mpsi_single;

/* The particle in a lane of a batch. */
MPSI_INLINE void mpsi_take_single(const mpsi_grid *grid, int dim, int spline, const mpsi_cut *b,
                                  const mpsi_support *at, int lane, mpsi_single *out) {
  out->particle = b->first + lane;
  out->lane = lane;
  out->batch = b;
  out->at = at;
  mpsi_values_of(grid, dim, spline, b, lane, &out->f);
}

/* Calls `body` with the solver's dimension and degree of the spline as literal arguments, for which
 * the compiler specialises it. */
#define MPSI_CHOOSE(body, ...)                                                                     \
  (work->grid->dim == 2                                                                            \
       ? work->grid->spline == 2 ? body(work, 2, 2, __VA_ARGS__) : body(work, 2, 3, __VA_ARGS__)   \
   : work->grid->spline == 2 ? body(work, 3, 2, __VA_ARGS__)                                       \
                             : body(work, 3, 3, __VA_ARGS__))

/* The instances of a body, each a function of its own, which MPSI_CHOOSE_INSTANCE calls: where the
 * processor's registers are shorter than the vectors, gcc keeps every vector of a function at a
 * place of its own on the stack. */
#define MPSI_INSTANCES(X, body) X(body, 2, 2) X(body, 2, 3) X(body, 3, 2) X(body, 3, 3)
#define MPSI_CHOOSE_INSTANCE(body, ...)                                                            \
  (work->grid->dim == 2                                                                            \
       ? work->grid->spline == 2 ? body##_2_2(work, __VA_ARGS__) : body##_2_3(work, __VA_ARGS__)   \
   : work->grid->spline == 2 ? body##_3_2(work, __VA_ARGS__)                                       \
                             : body##_3_3(work, __VA_ARGS__))
