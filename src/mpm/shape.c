/* shape.c - the least-squares shape functions of particles near bodies and edges.
 *
 * Active are, of the stencil's nodes in the domain: those in no body; the corners of the particle's
 * own cell; and corners of other cells that hold particles, if they lie on the particle's side of
 * the surface, n . (x_p - x_i) > 0. Without the corners M can be singular; without the test of the
 * side momentum passes through thin walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "shape.h"

#include <string.h>

static bool in_domain(const mps_mpm *mpm, const mpsi_cells *cells, int tile) {
  const int64_t x = (int64_t)cells->at[0] * MPSI_SIDE + tile % MPSI_TILE_SIDE;
  const int64_t y = (int64_t)cells->at[1] * MPSI_SIDE + tile / MPSI_TILE_SIDE;
  return x >= mpm->low[0] && x <= mpm->high[0] && y >= mpm->low[1] && y <= mpm->high[1];
}

bool mpsi_full_support(const mps_mpm *mpm, const mpsi_cells *cells, int spline,
                       const mpsi_stencil *stencil) {
  if (cells->near < 0 && !cells->edge) return true;
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int t = stencil->first + j * MPSI_TILE_SIDE + i;
      if (cells->near < 0 ? !in_domain(mpm, cells, t)
                          : mpm->near[cells->near].state[t] & (MPSI_OUTSIDE | MPSI_INSIDE))
        return false;
    }
  return true;
}

bool mpsi_sees(const mpsi_meeting *meeting, int spline, const mpsi_stencil *stencil) {
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int t = stencil->first + j * MPSI_TILE_SIDE + i;
      if (meeting->normal[0][t] != 0.0 || meeting->normal[1][t] != 0.0) return true;
    }
  return false;
}

/* Outside every body that holds the node, seen from the node along the surface's normal. */
static bool same_side(const mps_mpm *mpm, const mpsi_cells *cells, const mpsi_stencil *stencil,
                      int i, int j, int tile) {
  for (int32_t k = 0; k < cells->meetings; k++) {
    const mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + k];
    const double nx = meeting->normal[0][tile], ny = meeting->normal[1][tile];
    if (nx == 0.0 && ny == 0.0) continue;
    if (!(nx * stencil->s[0][i] + ny * stencil->s[1][j] < 0.0)) return false;
  }
  return true;
}

static bool active(const mps_mpm *mpm, const mpsi_cells *cells, const mpsi_stencil *stencil, int i,
                   int j) {
  const int t = stencil->first + j * MPSI_TILE_SIDE + i;
  if (cells->near < 0) return in_domain(mpm, cells, t);
  const uint8_t state = mpm->near[cells->near].state[t];
  if (state & MPSI_OUTSIDE) return false;
  if (!(state & MPSI_INSIDE)) return true;
  const int di = i - stencil->own[0], dj = j - stencil->own[1];
  if (di >= 0 && di <= 1 && dj >= 0 && dj <= 1) return true;
  return (state & MPSI_REACHED) && same_side(mpm, cells, stencil, i, j, t);
}

/* Inverse of the symmetric 3 x 3 matrix m00 m01 m02 m11 m12 m22, in the same order; its
 * determinant over m00^3 is returned. */
static double invert(const double *m, double *out) {
  const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5];
  const double c02 = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02, one = 1.0 / determinant;
  out[0] = c00 * one;
  out[1] = c01 * one;
  out[2] = c02 * one;
  out[3] = (m[0] * m[5] - m[2] * m[2]) * one;
  out[4] = (m[1] * m[2] - m[0] * m[4]) * one;
  out[5] = (m[0] * m[3] - m[1] * m[1]) * one;
  return determinant / (m[0] * m[0] * m[0]);
}

void mpsi_fit_shape(const mps_mpm *mpm, const mpsi_cells *cells, int spline,
                    const mpsi_stencil *stencil, mpsi_shape_values *out) {
  double m[6] = {0}, q[6];
  memset(out, 0, sizeof *out);
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      if (!active(mpm, cells, stencil, i, j)) continue;
      const double w = stencil->w[0][i] * stencil->w[1][j];
      const double x = stencil->s[0][i], y = stencil->s[1][j];
      out->w[4 * j + i] = w;
      m[0] += w, m[1] += w * x, m[2] += w * y;
      m[3] += w * x * x, m[4] += w * x * y, m[5] += w * y * y;
    }
  out->determinant = invert(m, q);
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int k = 4 * j + i;
      const double w = out->w[k], x = stencil->s[0][i], y = stencil->s[1][j];
      out->phi[k] = w * (q[0] + q[1] * x + q[2] * y);
      out->gx[k] = w * (q[1] + q[3] * x + q[4] * y) * mpm->inverse;
      out->gy[k] = w * (q[2] + q[4] * x + q[5] * y) * mpm->inverse;
    }
}
