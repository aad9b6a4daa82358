/* mpm_cut_reference.h - what one particle with a cut support gives to the nodes and takes from
 * them, written out particle by particle and node by node from its shape functions: the reference
 * for the vectors of src/mpm/transfer. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPM_CUT_REFERENCE_H
#define MPS_TEST_MPM_CUT_REFERENCE_H

#include "mpm/base/loops.h"
#include "mpm/base/mpm_solver.h"

/* Inverse of a symmetric positive definite matrix by Gauss and Jordan; returns its determinant. */
static inline double reference_invert(int n, double m[4][4]) {
  double determinant = 1.0;
  for (int p = 0; p < n; p++) {
    const double pivot = m[p][p];
    determinant *= pivot;
    m[p][p] = 1.0;
    for (int j = 0; j < n; j++) m[p][j] /= pivot;
    for (int i = 0; i < n; i++) {
      if (i == p) continue;
      const double factor = m[i][p];
      m[i][p] = 0.0;
      for (int j = 0; j < n; j++) m[i][j] -= factor * m[p][j];
    }
  }
  return determinant;
}

typedef struct reference {
  double v[3], slope[3][3], derivative[3][3]; /* of component by axis */
} reference;

/* Of all nodes n of a stencil, with their indices. */
#define REFERENCE_NODES(n, i, j, k)                                                                \
  for (int n = 0, i = 0, j = 0, k = 0; n < MPSI_STENCIL; n++, i = n % 4, j = n / 4 % 4, k = n / 16)

/* sum phi s s^T */
static inline void reference_second(const mpsi_stencil *at, const mpsi_shape_values *f,
                                    double K[3][3]) {
  memset(K, 0, 9 * sizeof K[0][0]);
  REFERENCE_NODES(n, i, j, k) {
    const double s[3] = {at->s[0][i], at->s[1][j], at->s[2][k]};
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) K[a][b] += f->phi[n] * s[a] * s[b];
  }
}

/* The rotation by which the particle gives its moment, added to L (m/s a cell, component by axis);
 * or, where its inertia is too small for that, `turn` (m2/s): spin.h. */
static inline void reference_spin(const mps_mpm *mpm, const mpsi_stencil *at,
                                  const mpsi_shape_values *f, double L[3][3], double turn[3][3]) {
  const int dim = mpm->grid.dim;
  const double full = mpm->grid.spline == 3 ? 1.0 / 3.0 : 0.25;
  double K[3][3], lack[3] = {0.0}, spin[3] = {0.0}, inertia[4][4] = {{0.0}};
  reference_second(at, f, K);
  for (int a = 0; a < dim; a++) {
    const int b = (a + 1) % 3, axis = (a + 2) % 3;
    if (b >= dim) continue;
    lack[axis] = full * (L[b][a] - L[a][b]);
    for (int d = 0; d < dim; d++) lack[axis] -= K[a][d] * L[b][d] - K[b][d] * L[a][d];
  }
  const double trace = dim == 2 ? K[0][0] + K[1][1] : K[0][0] + K[1][1] + K[2][2];
  double least = trace / (2.0 * full);
  spin[2] = lack[2] / trace;
  if (dim == 3) {
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++) inertia[a][b] = (a == b ? trace : 0.0) - K[a][b];
    least = fmin(least, reference_invert(3, inertia) * 9.0 / (8.0 * full * trace * trace));
    for (int a = 0; a < 3; a++) {
      spin[a] = 0.0;
      for (int b = 0; b < 3; b++) spin[a] += inertia[a][b] * lack[b];
    }
  }
  const bool turns = least > 0.1;
  double(*to)[3] = turns ? L : turn;
  for (int a = 0; a < dim; a++) {
    const int b = (a + 1) % 3, axis = (a + 2) % 3;
    if (b >= dim) continue;
    const double by = turns ? spin[axis] : 0.5 * mpm->grid.cell * lack[axis];
    to[b][a] += by;
    to[a][b] -= by;
  }
}

/* Momentum to the tile, force and excess mass to the tile of forces. `spins`: it gives its moment.
 */
static inline void reference_scatter(const mps_mpm *mpm, const mpsi_stencil *at,
                                     const mpsi_shape_values *f, int64_t p, bool spins,
                                     mpsi_node *tile, mpsi_node *forces) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *c = &mpm->p;
  const int dim = mpm->grid.dim;
  double L[3][3] = {{0.0}}, turn[3][3] = {{0.0}};
  for (int a = 0; a < dim; a++)
    for (int d = 0; d < dim; d++) L[a][d] = mpm->grid.cell * c->L[dim * a + d][p];
  if (spins) reference_spin(mpm, at, f, L, turn);
  REFERENCE_NODES(n, i, j, k) {
    if (f->w[n] == 0.0) continue;
    const double s[3] = {at->s[0][i], at->s[1][j], at->s[2][k]};
    const int t = mpsi_tile_index(at->at[0] + i, at->at[1] + j, at->at[2] + k);
    tile[t][0] += c->m[p] * f->phi[n];
    forces[t][0] += c->m[p] * (f->w[n] - f->phi[n]);
    for (int a = 0; a < dim; a++) {
      double v = c->v[a][p], force = c->m[p] * mpm->def.gravity[a] * f->phi[n], by = 0.0;
      if (mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && a == 0)
        force -= c->V[p] * c->s[2][p] / c->x[0][p] * f->phi[n];
      for (int d = 0; d < dim; d++) {
        v += L[a][d] * s[d];
        by += turn[a][d] * f->gradient[d][n];
        force -= c->V[p] * c->s[symmetric[a][d]][p] * f->gradient[d][n];
      }
      tile[t][1 + a] += c->m[p] * (f->phi[n] * v + by);
      forces[t][1 + a] += force;
    }
  }
}

/* Derivatives along axes with a full stencil, where sides alone cut the support: means of dw/w over
 * the other axes by their weights, as at one side alone (wall_support.h). */
static inline void reference_strain(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                    const mpsi_stencil *at, const mpsi_shape_values *f,
                                    const mpsi_node *tile, reference *out) {
  const int spline = mpm->grid.spline;
  double weight = 0.0;
  REFERENCE_NODES(n, i, j, k) weight += ((void)i, (void)j, (void)k, f->w[n]);
  for (int d = 0; d < mpm->grid.dim; d++) {
    const int64_t low = (int64_t)cells->at[d] * MPSI_SIDE + at->at[d];
    double slope[4];
    if (low < mpm->grid.use_low[d] || low + spline > mpm->grid.use_high[d]) continue;
    mpsi_slopes(spline, -at->s[d][0], slope);
    for (int a = 0; a < mpm->grid.dim; a++) out->derivative[a][d] = 0.0;
    REFERENCE_NODES(n, i, j, k) {
      const int own = d == 0 ? i : d == 1 ? j : k;
      const int t = mpsi_tile_index(at->at[0] + i, at->at[1] + j, at->at[2] + k);
      if (f->w[n] == 0.0) continue;
      for (int a = 0; a < mpm->grid.dim; a++)
        out->derivative[a][d] +=
            mpm->grid.inverse * slope[own] / at->w[d][own] * (f->w[n] / weight) * tile[t][1 + a];
    }
  }
}

/* `spins`: the slope gets the spin of the nodes' moment. */
static inline reference reference_gather(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                         const mpsi_stencil *at, const mpsi_shape_values *f,
                                         bool held, bool spins, const mpsi_node *tile) {
  reference out = {.v = {0.0}};
  double moment[3][3] = {{0.0}};
  REFERENCE_NODES(n, i, j, k) {
    const double s[3] = {at->s[0][i], at->s[1][j], at->s[2][k]};
    const int t = mpsi_tile_index(at->at[0] + i, at->at[1] + j, at->at[2] + k);
    if (f->w[n] == 0.0) continue;
    for (int a = 0; a < mpm->grid.dim; a++) {
      out.v[a] += f->phi[n] * tile[t][1 + a];
      for (int d = 0; d < mpm->grid.dim; d++) {
        out.slope[a][d] += f->gradient[d][n] * tile[t][1 + a];
        moment[a][d] += f->phi[n] * s[d] * tile[t][1 + a];
      }
    }
  }
  memcpy(out.derivative, out.slope, sizeof out.slope);
  if (!held) reference_strain(mpm, cells, at, f, tile, &out);
  const double scale = (mpm->grid.spline == 3 ? 3.0 : 4.0) * mpm->grid.inverse;
  for (int a = 0; a < mpm->grid.dim && spins; a++)
    for (int b = a + 1; b < mpm->grid.dim; b++) {
      const double spin = scale * (moment[b][a] - moment[a][b]);
      const double more = 0.5 * (spin - (out.slope[b][a] - out.slope[a][b]));
      out.slope[b][a] += more;
      out.slope[a][b] -= more;
    }
  return out;
}

#endif
