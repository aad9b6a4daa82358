/* fitted.c - particles whose support bodies or edges cut: the least-squares fit over the active
 * nodes, transfers with it, and contact, seed B (5), (6), (28)-(30). Compiled once for each
 * instruction set.
 *
 * Active are, of the stencil's nodes in the domain: those in no body; the corners of the particle's
 * own cell; and corners of other cells that hold particles, if they lie on the particle's side of
 * the surface, n . (x_p - x_i) > 0. Without the corners M can be singular; without the test of the
 * side momentum passes through thin walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "contact.h"
#include "loops.h"

/* ---- active nodes -----------------------------------------------------------------------------
 */

static int64_t node_of(const mps_mpm *mpm, const mpsi_cells *cells, const mpsi_stencil *at, int i,
                       int j, int k) {
  return mpsi_node_under(mpm, cells, at->at[0] + i, at->at[1] + j, at->at[2] + k);
}

/* Outside every body that holds the node, seen from the node along the surface's normal. */
static bool same_side(const mps_mpm *mpm, int64_t node, const double *s) {
  const int64_t g = node / mpm->own;
  const mpsi_nodes *nodes = &mpm->nodes[g];
  for (int32_t t = nodes->first_touch; t < nodes->first_touch + nodes->touches; t++) {
    const double *n = mpm->touch_node[t * mpm->own + node % mpm->own].normal;
    if (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0) continue;
    if (!(n[0] * s[0] + n[1] * s[1] + n[2] * s[2] < 0.0)) return false;
  }
  return true;
}

static bool active(const mps_mpm *mpm, const mpsi_cells *cells, uint8_t state,
                   const mpsi_stencil *at, int i, int j, int k) {
  if (state == 0) return true;
  if (state & MPSI_OUTSIDE) return false;
  const unsigned di = (unsigned)(i - at->own[0]), dj = (unsigned)(j - at->own[1]);
  const unsigned dk = (unsigned)(k - at->own[2]);
  if (di <= 1 && dj <= 1 && dk <= 1) return true;
  if (!(state & MPSI_REACHED)) return false;
  const double s[3] = {at->s[0][i], at->s[1][j], at->s[2][k]};
  return same_side(mpm, node_of(mpm, cells, at, i, j, k), s);
}

/* Weights of the active nodes. */
MPSI_INLINE void active_weights(const mps_mpm *mpm, const mpsi_cells *cells,
                                const mpsi_worker *worker, int dim, int spline,
                                const mpsi_stencil *at, double *w) {
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const double across = at->w[1][j] * at->w[2][k];
      const uint8_t *state =
          worker->state + mpsi_tile_index(at->at[0], at->at[1] + j, at->at[2] + k);
      double *row = w + 16 * k + 4 * j;
      for (int i = 0; i < 4; i++)
        row[i] =
            i <= spline && active(mpm, cells, state[i], at, i, j, k) ? across * at->w[0][i] : 0.0;
    }
}

/* ---- the fit ----------------------------------------------------------------------------------
 */

MPSI_INLINE double sum_of(mpsi_quad a) { return (a[0] + a[2]) + (a[1] + a[3]); }

/* M = sum w P P^T: rows along x are summed as vectors. */
MPSI_INLINE void moments(int dim, int spline, const mpsi_stencil *at, const double *w,
                         double m[4][4]) {
  mpsi_quad one = {0.0}, y = {0.0}, z = {0.0}, yy = {0.0}, yz = {0.0}, zz = {0.0};
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const mpsi_quad row = mpsi_get(w + 16 * k + 4 * j);
      const mpsi_quad row_y = row * at->s[1][j];
      one += row, y += row_y, yy += row_y * at->s[1][j];
      if (dim == 3)
        z += row * at->s[2][k], yz += row_y * at->s[2][k], zz += row * at->s[2][k] * at->s[2][k];
    }
  const mpsi_quad x = mpsi_get(at->s[0]);
  m[0][0] = sum_of(one), m[0][1] = sum_of(one * x), m[1][1] = sum_of(one * x * x);
  m[0][2] = sum_of(y), m[1][2] = sum_of(y * x), m[2][2] = sum_of(yy);
  if (dim == 3) {
    m[0][3] = sum_of(z), m[1][3] = sum_of(z * x), m[2][3] = sum_of(yz), m[3][3] = sum_of(zz);
  }
}

/* Inverse of a symmetric positive definite matrix of which the upper half is given, by Gauss and
 * Jordan; returns its determinant. */
MPSI_INLINE double invert(int n, double m[4][4]) {
  double determinant = 1.0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) m[i][j] = m[j][i];
  for (int p = 0; p < n; p++) {
    const double pivot = m[p][p], one = 1.0 / pivot;
    determinant *= pivot;
    m[p][p] = 1.0;
    for (int j = 0; j < n; j++) m[p][j] *= one;
    for (int i = 0; i < n; i++) {
      if (i == p) continue;
      const double factor = m[i][p];
      m[i][p] = 0.0;
      for (int j = 0; j < n; j++) m[i][j] -= factor * m[p][j];
    }
  }
  return determinant;
}

MPSI_INLINE void fit(const mps_mpm *mpm, const mpsi_cells *cells, const mpsi_worker *worker,
                     int dim, int spline, const mpsi_stencil *at, mpsi_shape_values *out) {
  double q[4][4];
  active_weights(mpm, cells, worker, dim, spline, at, out->w);
  moments(dim, spline, at, out->w, q);
  const double mass = q[0][0];
  out->determinant =
      invert(dim + 1, q) / (dim == 3 ? mass * mass * mass * mass : mass * mass * mass);
  const mpsi_quad x = mpsi_get(at->s[0]);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const int n = 16 * k + 4 * j;
      const mpsi_quad w = mpsi_get(out->w + n);
      for (int r = 0; r <= dim; r++) {
        double across = q[r][0] + q[r][2] * at->s[1][j];
        if (dim == 3) across += q[r][3] * at->s[2][k];
        const mpsi_quad value = w * (across + q[r][1] * x);
        if (r == 0)
          mpsi_put(out->phi + n, value);
        else
          mpsi_put(out->gradient[r - 1] + n, value * mpm->inverse);
      }
    }
}

/* ---- transfers --------------------------------------------------------------------------------
 */

/* All nodes n of a stencil, with their indices i, j, k. */
#define FOR_NODES(dim, spline)                                                                     \
  for (int k = 0; k <= ((dim) == 3 ? (spline) : 0); k++)                                           \
    for (int j = 0; j <= (spline); j++)                                                            \
      for (int i = 0, n = 16 * k + 4 * j; i <= (spline); i++, n++)

/* What a particle gives besides mass: momentum m (v + L dx), force by phi and by its gradient. */
typedef struct source {
  mpsi_quad v, L[3];   /* 1, v; 0, h dv/ds */
  mpsi_quad body;      /* 0, force by phi */
  mpsi_quad stress[3]; /* 0, -V sigma by the derivative along each axis */
} source;

MPSI_INLINE source source_of(const mps_mpm *mpm, int dim, int64_t p) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *c = &mpm->p;
  source out = {.v = {1.0}};
  for (int a = 0; a < dim; a++) {
    out.v[1 + a] = c->v[a][p];
    out.body[1 + a] = c->m[p] * mpm->def.gravity[a];
    if (c->f[a]) out.body[1 + a] += c->f[a][p];
    for (int d = 0; d < dim; d++) {
      out.L[d][1 + a] = mpm->def.cell * c->L[dim * a + d][p];
      out.stress[d][1 + a] = -c->V[p] * c->s[symmetric[a][d]][p];
    }
  }
  if (mpm->def.geometry == MPS_AXISYMMETRIC) out.body[1] -= c->V[p] * c->s[2][p] / c->x[0][p];
  return out;
}

MPSI_INLINE void scatter(mps_mpm *mpm, const mpsi_cells *cells, int dim, int spline, int64_t p,
                         const mpsi_stencil *at, const mpsi_shape_values *f) {
  const bool by_weight = mpm->def.transfer == MPS_TRANSFER_WEIGHT;
  const double m = mpm->p.m[p];
  const source s = source_of(mpm, dim, p);
  FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    const int64_t to = node_of(mpm, cells, at, i, j, k);
    const mpsi_nodes *nodes = &mpm->nodes[to / mpm->own];
    mpsi_quad v = s.v + s.L[0] * at->s[0][i] + s.L[1] * at->s[1][j];
    mpsi_quad force =
        s.body * f->phi[n] + s.stress[0] * f->gradient[0][n] + s.stress[1] * f->gradient[1][n];
    if (dim == 3) {
      v += s.L[2] * at->s[2][k];
      force += s.stress[2] * f->gradient[2][n];
    }
    mpsi_quad sum = v * (m * (by_weight ? f->w[n] : f->phi[n]));
    sum[MPSI_MASS] = m * f->phi[n];
    double *side = mpm->side[mpsi_first_node(mpm, nodes->side) + to % mpm->own];
    if (nodes->split)
      mpsi_put(side, mpsi_get(side) + force);
    else
      sum += mpm->dt * force;
    side[MPSI_EXCESS] += m * (f->w[n] - f->phi[n]);
    mpsi_put(mpm->node[to], mpsi_get(mpm->node[to]) + sum);
  }
}

/* ---- contact ----------------------------------------------------------------------------------
 */

/* Bodies that a node of the stencil is inside of, bit by bit. */
MPSI_INLINE uint32_t seen(const mpsi_worker *worker, int dim, int spline, const mpsi_stencil *at) {
  uint32_t bodies = 0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++)
      for (int i = 0; i <= spline; i++)
        bodies |= worker->inside[mpsi_tile_index(at->at[0] + i, at->at[1] + j, at->at[2] + k)];
  return bodies;
}

/* The node `to` of the grid, as body b touches it. */
static mpsi_touch_node *touch_of(const mps_mpm *mpm, int64_t to, int32_t b) {
  const mpsi_nodes *nodes = &mpm->nodes[to / mpm->own];
  int32_t t = nodes->first_touch;
  while (mpm->touch[t].body != b) t++;
  return &mpm->touch_node[(int64_t)t * mpm->own + to % mpm->own];
}

/* Adds force f at `arm` from the body's reference point to a load. */
static void add_load(mpsi_load *load, const double *arm, const double *f) {
  for (int c = 0; c < 3; c++) load->force[c] += f[c];
  load->moment[0] += arm[1] * f[2] - arm[2] * f[1];
  load->moment[1] += arm[2] * f[0] - arm[0] * f[2];
  load->moment[2] += arm[0] * f[1] - arm[1] * f[0];
}

/* Normal force and slip of a particle against one body, seed B (28)-(30). */
MPSI_INLINE void scatter_contact(mps_mpm *mpm, const mpsi_cells *cells, int dim, int spline,
                                 int64_t p, const mpsi_stencil *at, const mpsi_shape_values *f,
                                 mpsi_meeting *meeting) {
  const mps_body *body = mpm->body[meeting->body];
  mpsi_contact c;
  if (!mpsi_touches(mpm, body, dim, p, &c)) return;
  meeting->touched = true;
  meeting->contacts[c.part]++;
  double arm[3], reaction[3];
  for (int a = 0; a < 3; a++) arm[a] = c.x[a] - body->pose.x[a], reaction[a] = -c.force[a];
  add_load(&meeting->load[c.part], arm, reaction);
  FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    mpsi_touch_node *to = touch_of(mpm, node_of(mpm, cells, at, i, j, k), meeting->body);
    const double mass = mpm->p.m[p] * f->phi[n];
    to->mass += mass;
    for (int a = 0; a < dim; a++) {
      to->slip[a] += mass * c.slip[a];
      to->force[a] += f->phi[n] * c.force[a];
    }
  }
}

/* The friction that the nodes have given, back to the part of the surface that the particle
 * touches: at a node by the share of its mass in contact. */
MPSI_INLINE void share_friction(mps_mpm *mpm, const mpsi_cells *cells, int dim, int spline,
                                int64_t p, const mpsi_stencil *at, const mpsi_shape_values *f,
                                mpsi_meeting *meeting) {
  const mps_body *body = mpm->body[meeting->body];
  mpsi_contact c;
  if (!meeting->touched || body->def.friction == 0.0 || !mpsi_touches(mpm, body, dim, p, &c))
    return;
  FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    const mpsi_touch_node *from = touch_of(mpm, node_of(mpm, cells, at, i, j, k), meeting->body);
    const double local[3] = {at->at[0] + i, at->at[1] + j, at->at[2] + k};
    const double mass = mpm->p.m[p] * f->phi[n];
    double arm[3], reaction[3];
    mpsi_node_position(mpm, cells->at, local, arm);
    for (int a = 0; a < 3; a++) arm[a] -= body->pose.x[a], reaction[a] = -mass * from->slip[a];
    add_load(&meeting->load[c.part], arm, reaction);
  }
}

/* ---- one particle -----------------------------------------------------------------------------
 */

MPSI_INLINE void scatter_body(mps_mpm *mpm, const mpsi_cells *cells, const mpsi_worker *worker,
                              int dim, int spline, int64_t particle) {
  mpsi_stencil at;
  mpsi_shape_values f;
  mpsi_make_stencil(mpm, cells, dim, spline, particle, &at);
  fit(mpm, cells, worker, dim, spline, &at, &f);
  scatter(mpm, cells, dim, spline, particle, &at, &f);
  const uint32_t bodies = cells->meetings > 0 ? seen(worker, dim, spline, &at) : 0;
  for (int32_t q = 0; bodies && q < cells->meetings; q++) {
    mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + q];
    if (bodies >> meeting->body & 1)
      scatter_contact(mpm, cells, dim, spline, particle, &at, &f, meeting);
  }
}

MPSI_INLINE void gather_body(mps_mpm *mpm, const mpsi_cells *cells, const mpsi_worker *worker,
                             int dim, int spline, int64_t particle, double (*motion)[4]) {
  mpsi_stencil at;
  mpsi_shape_values f;
  mpsi_make_stencil(mpm, cells, dim, spline, particle, &at);
  fit(mpm, cells, worker, dim, spline, &at, &f);
  mpsi_quad v = {0.0}, by[3] = {v, v, v};
  FOR_NODES(dim, spline) {
    const double *from = worker->tile[mpsi_tile_index(at.at[0] + i, at.at[1] + j, at.at[2] + k)];
    const mpsi_quad node = mpsi_get(from);
    v += f.phi[n] * node;
    for (int d = 0; d < dim; d++) by[d] += f.gradient[d][n] * node;
  }
  mpsi_put(motion[0], v);
  for (int d = 0; d < dim; d++) mpsi_put(motion[1 + d], by[d]);
  const uint32_t bodies = cells->meetings > 0 ? seen(worker, dim, spline, &at) : 0;
  for (int32_t q = 0; bodies && q < cells->meetings; q++) {
    mpsi_meeting *meeting = &mpm->meeting[cells->first_meeting + q];
    if (bodies >> meeting->body & 1)
      share_friction(mpm, cells, dim, spline, particle, &at, &f, meeting);
  }
}

/* ---- variants ---------------------------------------------------------------------------------
 */

/* The body with dimension and spline as literal arguments. */
#define CHOOSE(dim, spline, body, ...)                                                             \
  do {                                                                                             \
    if ((dim) == 2 && (spline) == 2)                                                               \
      body(mpm, cells, worker, 2, 2, __VA_ARGS__);                                                 \
    else if ((dim) == 2)                                                                           \
      body(mpm, cells, worker, 2, 3, __VA_ARGS__);                                                 \
    else if ((spline) == 2)                                                                        \
      body(mpm, cells, worker, 3, 2, __VA_ARGS__);                                                 \
    else                                                                                           \
      body(mpm, cells, worker, 3, 3, __VA_ARGS__);                                                 \
  } while (0)

void MPSI_LEVELLED(mpsi_scatter_fitted)(mps_mpm *mpm, const mpsi_cells *cells,
                                        const mpsi_worker *worker, int64_t particle) {
  CHOOSE(mpm->dim, mpm->def.spline, scatter_body, particle);
}

void MPSI_LEVELLED(mpsi_gather_fitted)(mps_mpm *mpm, const mpsi_cells *cells,
                                       const mpsi_worker *worker, int64_t particle,
                                       double (*motion)[4]) {
  CHOOSE(mpm->dim, mpm->def.spline, gather_body, particle, motion);
}

void MPSI_LEVELLED(mpsi_fit)(const mps_mpm *mpm, const mpsi_cells *cells, const mpsi_worker *worker,
                             int64_t particle, mpsi_stencil *at, mpsi_shape_values *out) {
  memset(out, 0, sizeof *out);
  mpsi_make_stencil(mpm, cells, mpm->dim, mpm->def.spline, particle, at);
  CHOOSE(mpm->dim, mpm->def.spline, fit, at, out);
}
