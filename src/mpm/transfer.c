/* transfer.c - particles to nodes, seed B (23)-(25), (28)-(30), (39), and nodes to particles,
 * (41)-(43), one block of particles at a time.
 *
 * One inline body for each direction; spline and geometry are literal arguments, so that their
 * branches fold away. Particles with a full support take the closed form, row by row of the tile;
 * the others go through the least-squares fit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "contact.h"

#include <string.h>

typedef double (*tile_sums)[MPSI_TILE];

/* ---- particles to nodes ---------------------------------------------------------------------- */

/* A quantity that a particle gives to its nodes: w (value + dx s_x + dy s_y). */
typedef struct linear {
  double value, dx, dy;
} linear;

/* Mass, momentum and force of a particle as linear functions of s, for a full support. */
MPSI_INLINE void linear_parts(const mps_mpm *mpm, int spline, int geometry, int64_t k,
                              linear *part) {
  const mpsi_columns *p = &mpm->p;
  const double h = mpm->def.cell, m = p->m[k], mh = m * h;
  const double sv = -p->V[k] * mpsi_inverse_moment(spline) * mpm->inverse;
  part[MPSI_M] = (linear){m, 0.0, 0.0};
  part[MPSI_PX] = (linear){m * p->v[0][k], mh * p->L[0][k], mh * p->L[1][k]};
  part[MPSI_PY] = (linear){m * p->v[1][k], mh * p->L[2][k], mh * p->L[3][k]};
  part[MPSI_FX] = (linear){m * mpm->def.gravity[0], sv * p->s[0][k], sv * p->s[3][k]};
  part[MPSI_FY] = (linear){m * mpm->def.gravity[1], sv * p->s[3][k], sv * p->s[1][k]};
  if (geometry == MPS_AXISYMMETRIC) part[MPSI_FX].value -= p->V[k] * p->s[2][k] / p->x[0][k];
}

MPSI_INLINE void scatter_full(const mps_mpm *mpm, int spline, int geometry, int64_t k,
                              const mpsi_stencil *stencil, tile_sums sum) {
  linear part[MPSI_EXCESS];
  linear_parts(mpm, spline, geometry, k, part);
  double wx[4], wxs[4];
  for (int i = 0; i < 4; i++) {
    wx[i] = stencil->w[0][i];
    wxs[i] = wx[i] * stencil->s[0][i];
  }
  for (int j = 0; j <= spline; j++) {
    const double wy = stencil->w[1][j], sy = stencil->s[1][j];
    const int t = stencil->first + j * MPSI_TILE_SIDE;
    for (int q = 0; q < MPSI_EXCESS; q++) {
      const double a = wy * (part[q].value + part[q].dy * sy), b = wy * part[q].dx;
      double *to = sum[q] + t;
      for (int i = 0; i < 4; i++) to[i] += wx[i] * a + wxs[i] * b;
    }
  }
}

MPSI_INLINE void scatter_fitted(const mps_mpm *mpm, int spline, int geometry, int64_t k,
                                const mpsi_stencil *stencil, const mpsi_shape_values *f,
                                tile_sums sum) {
  const mpsi_columns *p = &mpm->p;
  const double h = mpm->def.cell, m = p->m[k], V = p->V[k];
  const bool by_weight = mpm->def.transfer == MPS_TRANSFER_WEIGHT;
  const double hoop = geometry == MPS_AXISYMMETRIC ? V * p->s[2][k] / p->x[0][k] : 0.0;
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int n = 4 * j + i, t = stencil->first + j * MPSI_TILE_SIDE + i;
      const double dx = h * stencil->s[0][i], dy = h * stencil->s[1][j];
      const double mass = m * f->phi[n], carried = by_weight ? m * f->w[n] : mass;
      sum[MPSI_M][t] += mass;
      sum[MPSI_EXCESS][t] += m * (f->w[n] - f->phi[n]);
      sum[MPSI_PX][t] += carried * (p->v[0][k] + p->L[0][k] * dx + p->L[1][k] * dy);
      sum[MPSI_PY][t] += carried * (p->v[1][k] + p->L[2][k] * dx + p->L[3][k] * dy);
      sum[MPSI_FX][t] += mass * mpm->def.gravity[0] - f->phi[n] * hoop -
                         V * (p->s[0][k] * f->gx[n] + p->s[3][k] * f->gy[n]);
      sum[MPSI_FY][t] +=
          mass * mpm->def.gravity[1] - V * (p->s[3][k] * f->gx[n] + p->s[1][k] * f->gy[n]);
    }
}

/* Normal force and slip of a particle against one body, seed B (28)-(30). */
static void scatter_contact(const mps_mpm *mpm, int spline, int64_t k, const mpsi_stencil *stencil,
                            const mpsi_shape_values *f, mpsi_meeting *meeting) {
  const mps_body *body = mpm->body[meeting->body];
  mpsi_contact c;
  if (!mpsi_sees(meeting, spline, stencil) || !mpsi_touches(mpm, body, k, &c)) return;
  meeting->touched = true;
  const double x = mpm->p.x[0][k] - body->pose.x[0], y = mpm->p.x[1][k] - body->pose.x[1];
  mpsi_load *load = &meeting->load[c.part];
  load->force[0] -= c.force[0];
  load->force[1] -= c.force[1];
  load->moment[2] -= x * c.force[1] - y * c.force[0];
  meeting->contacts[c.part]++;
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int n = 4 * j + i, t = stencil->first + j * MPSI_TILE_SIDE + i;
      const double mass = mpm->p.m[k] * f->phi[n];
      meeting->sum[MPSI_W][t] += mass;
      meeting->sum[MPSI_SX][t] += mass * c.slip[0];
      meeting->sum[MPSI_SY][t] += mass * c.slip[1];
      meeting->sum[MPSI_CX][t] += f->phi[n] * c.force[0];
      meeting->sum[MPSI_CY][t] += f->phi[n] * c.force[1];
    }
}

MPSI_INLINE void p2g_body(mps_mpm *mpm, int64_t b, int spline, int geometry) {
  const mpsi_cells *cells = &mpm->cells[b];
  tile_sums sum = mpm->tile[b];
  memset(sum, 0, sizeof mpm->tile[b]);
  for (int32_t q = 0; q < cells->meetings; q++) {
    mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + q];
    meeting->touched = false;
    memset(meeting->sum, 0, sizeof meeting->sum);
    memset(meeting->load, 0, sizeof meeting->load);
    memset(meeting->contacts, 0, sizeof meeting->contacts);
  }
  for (int64_t k = cells->begin; k < cells->end; k++) {
    mpsi_stencil stencil;
    mpsi_make_stencil(mpm, cells, spline, k, &stencil);
    if (mpsi_full_support(mpm, cells, spline, &stencil)) {
      scatter_full(mpm, spline, geometry, k, &stencil, sum);
      continue;
    }
    mpsi_shape_values f;
    mpsi_fit_shape(mpm, cells, spline, &stencil, &f);
    scatter_fitted(mpm, spline, geometry, k, &stencil, &f, sum);
    for (int32_t q = 0; q < cells->meetings; q++)
      scatter_contact(mpm, spline, k, &stencil, &f, &mpm->meeting[cells->first_meeting + q]);
  }
}

/* ---- nodes to particles ---------------------------------------------------------------------- */

/* Copies one value a node from the blocks of nodes under a tile. `value(q)` is the block's array of
 * MPSI_OWN values, or NULL for zeros. */
MPSI_INLINE void gather_tile(const double *const value[4], double *tile) {
  for (int j = 0; j < MPSI_TILE_SIDE; j++)
    for (int i = 0; i < MPSI_TILE_SIDE; i++) {
      const int q = (i >= MPSI_SIDE) + 2 * (j >= MPSI_SIDE);
      const int own = (j % MPSI_SIDE) * MPSI_SIDE + i % MPSI_SIDE;
      tile[j * MPSI_TILE_SIDE + i] = value[q] ? value[q][own] : 0.0;
    }
}

/* Velocity and its gradient at a particle. */
typedef struct motion {
  double v[2], L[4];
} motion;

MPSI_INLINE motion gather_full(const mps_mpm *mpm, int spline, const mpsi_stencil *stencil,
                               const double (*v)[MPSI_TILE]) {
  double sum[2][3] = {{0}}; /* of v, v s_x, v s_y */
  for (int j = 0; j <= spline; j++) {
    const double wy = stencil->w[1][j], wys = wy * stencil->s[1][j];
    const int t = stencil->first + j * MPSI_TILE_SIDE;
    for (int c = 0; c < 2; c++) {
      double row = 0.0, slope = 0.0;
      for (int i = 0; i <= spline; i++) {
        const double part = stencil->w[0][i] * v[c][t + i];
        row += part;
        slope += part * stencil->s[0][i];
      }
      sum[c][0] += wy * row;
      sum[c][1] += wy * slope;
      sum[c][2] += wys * row;
    }
  }
  const double scale = mpsi_inverse_moment(spline) * mpm->inverse;
  return (motion){{sum[0][0], sum[1][0]},
                  {scale * sum[0][1], scale * sum[0][2], scale * sum[1][1], scale * sum[1][2]}};
}

MPSI_INLINE motion gather_fitted(int spline, const mpsi_stencil *stencil,
                                 const mpsi_shape_values *f, const double (*v)[MPSI_TILE]) {
  motion out = {{0}, {0}};
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int n = 4 * j + i, t = stencil->first + j * MPSI_TILE_SIDE + i;
      for (int c = 0; c < 2; c++) {
        out.v[c] += f->phi[n] * v[c][t];
        out.L[2 * c] += f->gx[n] * v[c][t];
        out.L[2 * c + 1] += f->gy[n] * v[c][t];
      }
    }
  return out;
}

/* The friction that the nodes have given, back to the part of the surface that each particle in
 * contact touches: at a node by the share of its mass in contact. */
static void share_friction(const mps_mpm *mpm, const mpsi_cells *cells, int spline, int64_t k,
                           const mpsi_stencil *stencil, const mpsi_shape_values *f,
                           mpsi_meeting *meeting) {
  const mps_body *body = mpm->body[meeting->body];
  mpsi_contact c;
  if (!mpsi_sees(meeting, spline, stencil) || !mpsi_touches(mpm, body, k, &c)) return;
  mpsi_load *load = &meeting->load[c.part];
  for (int j = 0; j <= spline; j++)
    for (int i = 0; i <= spline; i++) {
      const int t = stencil->first + j * MPSI_TILE_SIDE + i;
      const double mass = mpm->p.m[k] * f->phi[4 * j + i];
      const double fx = mass * meeting->sum[MPSI_SX][t], fy = mass * meeting->sum[MPSI_SY][t];
      const double x = mpm->def.origin[0] - body->pose.x[0] +
                       mpm->def.cell * ((double)cells->at[0] * MPSI_SIDE + t % MPSI_TILE_SIDE);
      const double y = mpm->def.origin[1] - body->pose.x[1] +
                       mpm->def.cell * ((double)cells->at[1] * MPSI_SIDE + t / MPSI_TILE_SIDE);
      load->force[0] -= fx;
      load->force[1] -= fy;
      load->moment[2] -= x * fy - y * fx;
    }
}

/* Fetches friction over mass in contact to the meetings' slip sums, which are used up. */
static void fetch_friction(mps_mpm *mpm, const mpsi_cells *cells) {
  for (int32_t q = 0; q < cells->meetings; q++) {
    mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + q];
    if (!meeting->touched || mpm->body[meeting->body]->def.friction == 0.0) continue;
    for (int c = 0; c < 2; c++) {
      const double *value[4] = {NULL};
      for (int to = 0; to < 4; to++) {
        const int32_t nodes = cells->to[to];
        for (int32_t t = mpm->touch_first[nodes]; t < mpm->touch_first[nodes + 1]; t++)
          if (mpm->touch[t].body == meeting->body) value[to] = mpm->touch[t].sum[MPSI_TX + c];
      }
      gather_tile(value, meeting->sum[MPSI_SX + c]);
    }
  }
}

/* Moves a particle and looks after it. False: it has left the domain, or is not a number. */
MPSI_INLINE bool move(mps_mpm *mpm, mpsi_cells *cells, int spline, int64_t k, const motion *new) {
  mpsi_columns *p = &mpm->p;
  bool good = true;
  for (int c = 0; c < 2; c++) {
    const double x = p->x[c][k] + mpm->dt * new->v[c];
    const double X = mpsi_grid_coordinate(mpm, c, x);
    p->x[c][k] = x;
    p->v[c][k] = new->v[c];
    p->L[2 * c][k] = new->L[2 * c];
    p->L[2 * c + 1][k] = new->L[2 * c + 1];
    if (!(X >= (double)mpm->low[c] && X <= (double)mpm->high[c]))
      good = false;
    else if (mpsi_block_of(mpsi_base(spline, X)) != cells->at[c])
      cells->left = true;
  }
  return good;
}

MPSI_INLINE void g2p_body(mps_mpm *mpm, int64_t b, int spline, int geometry) {
  mpsi_cells *cells = &mpm->cells[b];
  double v[2][MPSI_TILE];
  for (int c = 0; c < 2; c++) {
    const double *value[4];
    for (int q = 0; q < 4; q++) value[q] = mpm->node[cells->to[q]][MPSI_VX + c];
    gather_tile(value, v[c]);
  }
  fetch_friction(mpm, cells);
  for (int64_t k = cells->begin; k < cells->end; k++) {
    mpsi_stencil stencil;
    motion new;
    mpsi_make_stencil(mpm, cells, spline, k, &stencil);
    if (mpsi_full_support(mpm, cells, spline, &stencil)) {
      new = gather_full(mpm, spline, &stencil, (const double(*)[MPSI_TILE])v);
    } else {
      mpsi_shape_values f;
      mpsi_fit_shape(mpm, cells, spline, &stencil, &f);
      new = gather_fitted(spline, &stencil, &f, (const double(*)[MPSI_TILE])v);
      for (int32_t q = 0; q < cells->meetings; q++) {
        mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + q];
        if (meeting->touched && mpm->body[meeting->body]->def.friction > 0.0)
          share_friction(mpm, cells, spline, k, &stencil, &f, meeting);
      }
    }
    if (geometry == MPS_AXISYMMETRIC) mpm->p.L[4][k] = new.v[0] / mpm->p.x[0][k];
    if (!move(mpm, cells, spline, k, &new) && cells->bad < 0) cells->bad = k;
  }
}

/* ---- variants -------------------------------------------------------------------------------- */

#define MPSI_VARIANTS(X)                                                                           \
  X(plane_strain, cubic, MPS_PLANE_STRAIN, 3)                                                      \
  X(plane_strain, quadratic, MPS_PLANE_STRAIN, 2)                                                  \
  X(axisymmetric, cubic, MPS_AXISYMMETRIC, 3)                                                      \
  X(axisymmetric, quadratic, MPS_AXISYMMETRIC, 2)

#define DEFINE(g, s, geometry, spline)                                                             \
  static void p2g_##g##_##s(mps_mpm *mpm, int64_t b) { p2g_body(mpm, b, spline, geometry); }       \
  static void g2p_##g##_##s(mps_mpm *mpm, int64_t b) { g2p_body(mpm, b, spline, geometry); }
MPSI_VARIANTS(DEFINE)

void mpsi_mpm_p2g(mps_mpm *mpm, int64_t b) {
  static const mpsi_mpm_task table[2][2] = {{p2g_plane_strain_quadratic, p2g_plane_strain_cubic},
                                            {p2g_axisymmetric_quadratic, p2g_axisymmetric_cubic}};
  table[mpm->def.geometry][mpm->def.spline - 2](mpm, b);
}

void mpsi_mpm_g2p(mps_mpm *mpm, int64_t b) {
  static const mpsi_mpm_task table[2][2] = {{g2p_plane_strain_quadratic, g2p_plane_strain_cubic},
                                            {g2p_axisymmetric_quadratic, g2p_axisymmetric_cubic}};
  table[mpm->def.geometry][mpm->def.spline - 2](mpm, b);
}
