/* least_squares.c - particles whose support bodies or edges cut: the least-squares fit over the
 * active nodes, transfers with it, and contact, Nakamura (5), (6), (28)-(30). With the standard
 * scheme all particles, and the splines in place of the fit, Nakamura Table 1. Compiled once for
 * each instruction set.
 *
 * Active are, of the stencil's nodes in the domain: those in no body; the corners of the particle's
 * own cell; and corners of other cells that hold particles, if they lie on the particle's side of
 * the surface, n . (x_p - x_i) > 0. Without the corners M can be singular; without the test of the
 * side momentum passes through thin walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/contact/particle.h"
#include "spin.h"
#include "support.h"

/* ---- active nodes ---------------------------------------------------------------------------- */

/* A particle's stencil and its nodes. */
typedef struct support {
  mpsi_stencil at;
  mpsi_support nodes;
} support;

MPSI_INLINE void make_support(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                              int64_t particle, support *out) {
  mpsi_make_stencil(mpm, cells, dim, spline, particle, &out->at);
  mpsi_make_support(mpm, cells, dim, out->at.at, &out->nodes);
}

MPSI_INLINE bool is_folded(const support *s, int i, int j, int k) {
  const mpsi_support *n = &s->nodes;
  return n->any_folds && (n->folds[0][i] || n->folds[1][j] || n->folds[2][k]);
}

/* The force of a contact on a node that is folded, or its slip; `impulse` times what that
 * changes the walls give. */
static void reflect(const mps_mpm *mpm, const mpsi_cell_block *cells, const support *s, int i,
                    int j, int k, double *vector, double impulse) {
  int at[3] = {s->at.at[0] + i, s->at.at[1] + j, s->at.at[2] + k};
  mpsi_mpm_reflect(mpm, cells, at, vector, impulse);
}

/* Outside every body that holds the node, seen from the node along the surface's normal. */
static bool same_side(const mps_mpm *mpm, int32_t g, int local, const double *s) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  int32_t pair = nodes->first_pair;
  for (const double *n; (n = mpsi_next_normal(mpm, nodes, local, &pair)) != NULL;)
    if (!mpsi_contact_same_side(n, s)) return false;
  return true;
}

/* Of a node of the domain inside a body. */
static bool active(const mps_mpm *mpm, const mpsi_cell_block *cells, uint8_t state,
                   const support *s, int i, int j, int k) {
  const mpsi_stencil *at = &s->at;
  const unsigned di = (unsigned)(i - at->own[0]), dj = (unsigned)(j - at->own[1]);
  const unsigned dk = (unsigned)(k - at->own[2]);
  if (di <= 1 && dj <= 1 && dk <= 1) return true;
  if (!(state & MPSI_REACHED)) return false;
  const double from[3] = {s->nodes.ghost[0][i] ? -at->s[0][i] : at->s[0][i],
                          s->nodes.ghost[1][j] ? -at->s[1][j] : at->s[1][j],
                          s->nodes.ghost[2][k] ? -at->s[2][k] : at->s[2][k]};
  return same_side(mpm, mpsi_support_block(cells, &s->nodes, i, j, k),
                   mpsi_support_local(&s->nodes, i, j, k), from);
}

/* Which nodes a thin body parts from the particle. Those of them that it does not use are never
 * corners of its cell. */
static mpsi_parted find_parted(const mps_mpm *mpm, const mpsi_cell_block *cells, int64_t particle,
                               const mpsi_stencil *at) {
  mpsi_parted out = {0, 0};
  double x[3] = {0.0};
  if (!cells->thin) return out;
  for (int c = 0; c < mpm->dim; c++) x[c] = mpm->p.x[c][particle];
  out = mpsi_mpm_find_parted(mpm, cells, at->at, x);
  for (int q = 0; q < 1 << mpm->dim && out.cut != 0; q++) {
    const int i = at->own[0] + (q & 1), j = at->own[1] + (q >> 1 & 1);
    const int k = mpm->dim == 3 ? at->own[2] + (q >> 2) : 0;
    out.cut &= ~(UINT64_C(1) << (16 * k + 4 * j + i));
  }
  return out;
}

#define HELD (MPSI_IMPULSE | MPSI_PENALTY)

/* Weights of the active nodes; returns what bodies hold any of the stencil's: HELD bits. */
MPSI_INLINE uint32_t active_weights(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                    const mpsi_worker *worker, int dim, int spline,
                                    const support *s, const mpsi_parted *parted, double *w) {
  const mpsi_stencil *at = &s->at;
  uint32_t held = 0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const double across = at->w[1][j] * at->w[2][k];
      const int t = mpsi_tile_index(at->at[0], at->at[1] + j, at->at[2] + k);
      const uint8_t *state = worker->state + t;
      mpsi_quad row = across * mpsi_get(at->w[0]);
      uint32_t any;
      memcpy(&any, state, sizeof any);
      if (any != 0) {
        mpsi_mask there = {-1, -1, -1, -1}; /* in a register: the row is read as a vector soon */
        MPSI_UNROLL for (int i = 0; i <= spline; i++) {
          if (state[i] == 0) continue;
          held |= state[i];
          const bool in = (state[i] & MPSI_INSIDE) != 0;
          if (state[i] & MPSI_OUTSIDE || (in && !active(mpm, cells, state[i], s, i, j, k)))
            there[i] = 0;
        }
        row = (mpsi_quad)((mpsi_mask)row & there);
      }
      mpsi_put(w + 16 * k + 4 * j, row);
    }
  for (uint64_t left = parted->cut; left != 0; left &= left - 1) w[__builtin_ctzll(left)] = 0.0;
  return held & HELD;
}

/* ---- the fit --------------------------------------------------------------------------------- */

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

/* The standard scheme's fit: the spline and its derivatives, whatever lies in the support. */
MPSI_INLINE uint32_t take_splines(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                  const mpsi_worker *worker, int dim, int spline,
                                  const mpsi_stencil *at, mpsi_shape_values *out) {
  double slope[3][4] = {{0.0}};
  uint32_t held = 0;
  for (int c = 0; c < dim; c++) mpsi_slopes(spline, -at->s[c][0], slope[c]);
  const mpsi_quad x = mpsi_get(at->w[0]), by_x = mpm->grid.inverse * mpsi_get(slope[0]);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const double y = at->w[1][j], z = at->w[2][k];
      const int n = 16 * k + 4 * j;
      mpsi_put(out->w + n, x * (y * z));
      mpsi_put(out->phi + n, x * (y * z));
      mpsi_put(out->gradient[0] + n, by_x * (y * z));
      mpsi_put(out->gradient[1] + n, x * (mpm->grid.inverse * slope[1][j] * z));
      if (dim == 3) mpsi_put(out->gradient[2] + n, x * (mpm->grid.inverse * y * slope[2][k]));
      const int t = mpsi_tile_index(at->at[0], at->at[1] + j, at->at[2] + k);
      for (int i = 0; i <= spline && cells->pairs > 0; i++) held |= worker->state[t + i];
    }
  out->determinant = 1.0;
  return held & HELD;
}

/* Returns what bodies hold any of the stencil's nodes, or cut it: HELD bits. */
MPSI_INLINE uint32_t fit(const mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_worker *worker, int dim, int spline, const support *s,
                         const mpsi_parted *parted, mpsi_shape_values *out) {
  const mpsi_stencil *at = &s->at;
  out->across = parted->across;
  if (mpm->standard) return take_splines(mpm, cells, worker, dim, spline, at, out);
  double q[4][4];
  uint32_t held = active_weights(mpm, cells, worker, dim, spline, s, parted, out->w);
  if (parted->cut != 0) held |= MPSI_IMPULSE;
  moments(dim, spline, at, out->w, q);
  const double mass = q[0][0];
  out->determinant =
      mpsi_invert(dim + 1, q) / (dim == 3 ? mass * mass * mass * mass : mass * mass * mass);
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
          mpsi_put(out->gradient[r - 1] + n, value * mpm->grid.inverse);
      }
    }
  return held;
}

/* ---- transfers ------------------------------------------------------------------------------- */

/* What a particle gives besides mass: momentum m (v + L dx), force by phi and by its gradient. */
typedef struct source {
  mpsi_quad v, L[3];   /* 1, v; 0, h dv/ds */
  mpsi_quad body;      /* 0, force by phi */
  mpsi_quad stress[3]; /* 0, -V sigma by the derivative along each axis */
  mpsi_quad turn[3];   /* 0, velocity times length by the derivative: see spin.h */
  bool turns;
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
      if (!mpm->standard) out.L[d][1 + a] = mpm->def.cell * c->L[dim * a + d][p];
      out.stress[d][1 + a] = -c->V[p] * c->t[symmetric[a][d]][p];
    }
  }
  if (mpm->def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    out.body[1] -= c->V[p] * c->t[2][p] / c->x[0][p];
  return out;
}

/* Whether node n is one of those across a thin body (thin_bodies.h). */
MPSI_INLINE bool is_across(const mpsi_shape_values *f, int n) { return f->across >> n & 1; }

/* Momentum to the tile, force and excess mass to the tile of forces, as all particles of the block.
 * `held`: what bodies hold nodes of the support. */
MPSI_INLINE void scatter(const mps_mpm *mpm, const mpsi_worker *worker, int dim, int spline,
                         int64_t p, const support *at, const mpsi_shape_values *f, uint32_t held) {
  const bool by_weight = mpm->by_weight;
  const double m = mpm->p.m[p];
  source s = source_of(mpm, dim, p);
  if (mpm->run.moments && mpsi_keeps_spin(mpm, held)) {
    double second[4][4];
    moments(dim, spline, &at->at, f->phi, second);
    s.turns = !mpsi_give_spin(dim, spline, mpm->def.cell, second, s.L, s.turn);
  }
  MPSI_FOR_NODES(dim, spline) {
    const double w = f->w[n], phi = f->phi[n];
    if (w == 0.0) continue;
    const int t = mpsi_tile_index(at->at.at[0] + i, at->at.at[1] + j, at->at.at[2] + k);
    mpsi_quad v = s.v + s.L[0] * at->at.s[0][i] + s.L[1] * at->at.s[1][j];
    mpsi_quad force =
        s.body * phi + s.stress[0] * f->gradient[0][n] + s.stress[1] * f->gradient[1][n];
    if (dim == 3) {
      v += s.L[2] * at->at.s[2][k];
      force += s.stress[2] * f->gradient[2][n];
    }
    mpsi_quad sum = v * (m * (by_weight ? w : phi));
    for (int d = 0; d < dim && s.turns; d++) sum += s.turn[d] * (m * f->gradient[d][n]);
    if (by_weight) sum[MPSI_MASS] = m * phi;
    force[MPSI_EXCESS] = m * (w - phi);
    double *to = (is_across(f, n) ? worker->across_tile : worker->tile)[t];
    double *force_to = (is_across(f, n) ? worker->across_force : worker->force)[t];
    mpsi_put(to, mpsi_get(to) + sum);
    mpsi_put(force_to, mpsi_get(force_to) + force);
  }
}

/* ---- contact --------------------------------------------------------------------------------- */

/* The node `local` of the block g, in contact with body b. */
static mpsi_contact_node *contact_node_of(const mps_mpm *mpm, int32_t g, int local, int32_t b) {
  int32_t t = mpm->grid.nodes[g].first_pair;
  while (mpm->contact.node_pair[t].body != b) t++;
  return &mpm->contact.node[(int64_t)t * mpm->grid.block_nodes + local];
}

/* The node of the tile whose sums a node of the stencil takes part in. */
static int tile_node_of(const mpsi_support *s, int i, int j, int k) {
  const int side = MPSI_SIDE, plane = side * side;
  return mpsi_tile_index((s->corner[0][i] ? side : 0) + s->local[0][i],
                         (s->corner[1][j] ? side : 0) + s->local[1][j] / side,
                         (s->corner[2][k] ? side : 0) + s->local[2][k] / plane);
}

/* Whether the body of the block's pair `number` holds a node of the stencil, in the domain or not.
 */
static bool holds_some(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                       const mpsi_support *s, int32_t number) {
  const int32_t body = mpm->contact.cell_pair[cells->first_pair + number].body;
  bool any = false;
  if (mpsi_by_impulses(mpm->contact.handle[body])) return false;
  MPSI_FOR_NODES(dim, spline) {
    const mpsi_node_block *nodes = &mpm->grid.nodes[mpsi_support_block(cells, s, i, j, k)];
    if (!nodes->inside) continue;
    int32_t t = nodes->first_pair;
    while (mpm->contact.node_pair[t].body != body) t++;
    any = any ||
          mpm->contact.held[(int64_t)t * mpm->grid.block_nodes + mpsi_support_local(s, i, j, k)];
    (void)n;
  }
  return any;
}

/* Normal force and slip of a particle against one body, Nakamura (28)-(30). */
MPSI_INLINE void scatter_contact(mps_mpm *mpm, const mpsi_cell_block *cells,
                                 const mpsi_worker *worker, int dim, int spline, int64_t p,
                                 const support *at, const mpsi_shape_values *f, int32_t number) {
  mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + number];
  const mps_body *body = mpm->contact.body[pair->body];
  mpsi_contact_particle c;
  if (mpsi_by_impulses(mpm->contact.handle[pair->body]) ||
      !mpsi_find_contact(mpm, mpm->contact.handle[pair->body], dim, p, &c))
    return;
  pair->in_contact = true;
  mpsi_pair_load *load = &mpm->contact.load[pair->first_load + c.part];
  load->contacts++;
  if (c.depth > pair->deepest) pair->deepest = c.depth, pair->deep = p;
  double arm[3], reaction[3];
  for (int a = 0; a < 3; a++) arm[a] = c.x[a] - body->pose.x[a], reaction[a] = -c.force[a];
  mpsi_contact_add_load(&load->by, arm, reaction);
  MPSI_FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    mpsi_penalty_node *to =
        mpsi_mpm_penalty_tile(mpm, worker, number) + tile_node_of(&at->nodes, i, j, k);
    const double mass = mpm->p.m[p] * f->phi[n];
    double slip[3] = {0.0}, force[3] = {0.0};
    for (int a = 0; a < dim; a++) slip[a] = mass * c.slip[a], force[a] = f->phi[n] * c.force[a];
    if (is_folded(at, i, j, k)) {
      reflect(mpm, cells, at, i, j, k, slip, 0.0);
      reflect(mpm, cells, at, i, j, k, force, mpm->run.dt);
    }
    to->mass += mass;
    for (int a = 0; a < dim; a++) to->slip[a] += slip[a], to->force[a] += force[a];
  }
}

/* The friction that the nodes have given, back to the part of the surface that the particle
 * particles in contact: at a node by the part of its mass in contact. */
MPSI_INLINE void share_friction(mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                                int64_t p, const support *at, const mpsi_shape_values *f,
                                mpsi_cell_pair *pair) {
  const mps_body *body = mpm->contact.body[pair->body];
  mpsi_contact_particle c;
  if (!pair->in_contact || mpsi_by_impulses(mpm->contact.handle[pair->body]) ||
      mpm->contact.handle[pair->body]->def.friction == 0.0 ||
      !mpsi_find_contact(mpm, mpm->contact.handle[pair->body], dim, p, &c))
    return;
  MPSI_FOR_NODES(dim, spline) {
    if (f->w[n] == 0.0) continue;
    const mpsi_contact_node *from =
        contact_node_of(mpm, mpsi_support_block(cells, &at->nodes, i, j, k),
                        mpsi_support_local(&at->nodes, i, j, k), pair->body);
    const double local[3] = {at->at.at[0] + i, at->at.at[1] + j, at->at.at[2] + k};
    const double mass = mpm->p.m[p] * f->phi[n];
    double arm[3], reaction[3], slip[3] = {from->slip[0], from->slip[1], from->slip[2]};
    if (is_folded(at, i, j, k)) { /* its own slip, and what the wall has given with it */
      reflect(mpm, cells, at, i, j, k, slip, 0.0);
      double given[3] = {slip[0], slip[1], slip[2]};
      reflect(mpm, cells, at, i, j, k, given, mpm->run.dt * mass);
    }
    mpsi_node_position(mpm, cells->at, local, arm);
    for (int a = 0; a < 3; a++) arm[a] -= body->pose.x[a], reaction[a] = -mass * slip[a];
    mpsi_contact_add_load(&mpm->contact.load[pair->first_load + c.part].by, arm, reaction);
  }
}

/* ---- one particle ---------------------------------------------------------------------------- */

MPSI_INLINE void scatter_body(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                              int dim, int spline, int64_t particle) {
  support at;
  mpsi_shape_values f;
  make_support(mpm, cells, dim, spline, particle, &at);
  const mpsi_parted parted = find_parted(mpm, cells, particle, &at.at);
  if (cells->thin) mpm->contact.across[particle] = parted; /* for the way back */
  const uint32_t held = fit(mpm, cells, worker, dim, spline, &at, &parted, &f);
  scatter(mpm, worker, dim, spline, particle, &at, &f, held);
  for (int32_t q = 0; held & MPSI_PENALTY && q < cells->pairs; q++)
    if (holds_some(mpm, cells, dim, spline, &at.nodes, q))
      scatter_contact(mpm, cells, worker, dim, spline, particle, &at, &f, q);
}

/* FLIP: what the particle keeps of its own, flip times its velocity less that of the nodes before
 * the forces. */
MPSI_INLINE void keep_own(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                          int64_t p, const support *at, const mpsi_shape_values *f, double *own) {
  mpsi_quad before = {0.0};
  MPSI_FOR_NODES(dim, spline) {
    const int32_t side = mpm->grid.nodes[mpsi_support_block(cells, &at->nodes, i, j, k)].side;
    const mpsi_node *node = (const mpsi_node *)(mpm->grid.side + mpsi_first_node(mpm, side));
    before += f->phi[n] * mpsi_get(node[mpsi_support_local(&at->nodes, i, j, k)]);
  }
  for (int c = 0; c < dim; c++) own[c] = mpm->flip * (mpm->p.v[c][p] - before[MPSI_VECTOR + c]);
}

/* Derivatives along the axes whose stencil is full, ghosts of mirrors included, where nothing but
 * sides of the domain cuts the support: there the fit falls apart into one along each axis
 * (wall_support.h), so that phi/w along such an axis is constant and d phi = phi dw/w. Along the
 * other axes, and near bodies, the slopes serve. */
MPSI_INLINE void find_strain(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int dim, int spline, const support *at,
                             const mpsi_shape_values *f, double (*derivative)[4]) {
  for (int d = 0; d < dim; d++) {
    const int64_t low = (int64_t)cells->at[d] * MPSI_SIDE + at->at.at[d];
    if (low < mpm->grid.use_low[d] || low + spline > mpm->grid.use_high[d]) continue;
    const double *w = at->at.w[d];
    double slope[4], ratio[4];
    mpsi_slopes(spline, -at->at.s[d][0], slope);
    for (int i = 0; i <= spline; i++)
      ratio[i] = w[i] > 0.0 ? mpm->grid.inverse * slope[i] / w[i] : 0.0;
    mpsi_quad sum = {0.0};
    MPSI_FOR_NODES(dim, spline) {
      const int own = d == 0 ? i : d == 1 ? j : k;
      const int t = mpsi_tile_index(at->at.at[0] + i, at->at.at[1] + j, at->at.at[2] + k);
      const double *node = (is_across(f, n) ? worker->across_tile : worker->tile)[t];
      sum += ratio[own] * f->phi[n] * mpsi_get(node);
    }
    mpsi_put(derivative[d], sum);
  }
}

/* Momentum that a node has and its particles would not get: all is done with a mass m that is never
 * less than MPSI_LEAST_MASS of that by weights, and they take with their own, M. */
static void find_kept(const mps_mpm *mpm, const mpsi_node_block *nodes, int32_t g, int local,
                      double *weight, double *warm) {
  const double *node = mpm->grid.node[mpsi_first_node(mpm, g) + local];
  const double *side = mpm->grid.side[mpsi_first_node(mpm, nodes->side) + local];
  const double m = node[MPSI_MASS], own = mpsi_own_mass(m, side[MPSI_EXCESS]);
  *weight = own + side[MPSI_EXCESS];
  const bool moves = nodes->split && mpsi_carried_mass(own, *weight) < 0.0; /* as they do */
  for (int c = 0; c < 3; c++)
    warm[c] =
        own < m ? (m - own) * (node[MPSI_VECTOR + c] - (moves ? side[MPSI_VECTOR + c] : 0.0)) : 0.0;
}

/* That momentum, back to the particles by their weights: all of it. */
static void give_back(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                      int64_t particle, const support *at, const mpsi_shape_values *f, double *v) {
  MPSI_FOR_NODES(dim, spline) {
    int32_t g = mpsi_support_block(cells, &at->nodes, i, j, k);
    if (f->w[n] == 0.0) continue;
    if (is_across(f, n)) g = mpm->grid.nodes[g].across;
    const mpsi_node_block *nodes = &mpm->grid.nodes[g];
    double weight, warm[3];
    if (!nodes->light) continue;
    find_kept(mpm, nodes, g, mpsi_support_local(&at->nodes, i, j, k), &weight, warm);
    for (int c = 0; c < 3 && weight > 0.0; c++) warm[c] *= f->w[n] / weight;
    if (is_folded(at, i, j, k)) reflect(mpm, cells, at, i, j, k, warm, mpm->p.m[particle]);
    for (int c = 0; c < dim && weight > 0.0; c++) v[MPSI_VECTOR + c] += warm[c];
  }
}

MPSI_INLINE void gather_body(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                             int dim, int spline, int64_t particle, mpsi_fitted *out) {
  support at;
  mpsi_shape_values f;
  make_support(mpm, cells, dim, spline, particle, &at);
  const mpsi_parted none = {0, 0};
  const mpsi_parted *parted = cells->thin ? &mpm->contact.across[particle] : &none;
  const uint32_t held = fit(mpm, cells, worker, dim, spline, &at, parted, &f);
  mpsi_quad sum = {0.0}, by[3] = {sum, sum, sum}, moment[3] = {sum, sum, sum};
  MPSI_FOR_NODES(dim, spline) {
    const int t = mpsi_tile_index(at.at.at[0] + i, at.at.at[1] + j, at.at.at[2] + k);
    const double *from = (is_across(&f, n) ? worker->across_tile : worker->tile)[t];
    const mpsi_quad node = mpsi_get(from), partition = f.phi[n] * node;
    sum += partition;
    for (int d = 0; d < dim; d++) by[d] += f.gradient[d][n] * node;
    moment[0] += at.at.s[0][i] * partition;
    moment[1] += at.at.s[1][j] * partition;
    if (dim == 3) moment[2] += at.at.s[2][k] * partition;
  }
  mpsi_put(out->v, sum);
  if (cells->light) {
    give_back(mpm, cells, dim, spline, particle, &at, &f, out->v);
    if (mpm->energy.counts) {
      const mpsi_quad back = mpsi_get(out->v) - sum;
      const double extra[3] = {back[MPSI_VECTOR], back[MPSI_VECTOR + 1], back[MPSI_VECTOR + 2]};
      mpsi_mpm_energy_given_back(mpm, cells, particle, extra);
    }
  }
  for (int d = 0; d < dim; d++) mpsi_put(out->slope[d], by[d]), mpsi_put(out->derivative[d], by[d]);
  if (!held && !mpm->standard)
    find_strain(mpm, cells, worker, dim, spline, &at, &f, out->derivative);
  if (mpsi_keeps_spin(mpm, held))
    mpsi_take_spin(dim, spline, mpm->grid.inverse, moment, out->slope);
  if (mpm->flip > 0.0) keep_own(mpm, cells, dim, spline, particle, &at, &f, out->own);
  for (int32_t q = 0; held & MPSI_PENALTY && q < cells->pairs; q++)
    if (holds_some(mpm, cells, dim, spline, &at.nodes, q))
      share_friction(mpm, cells, dim, spline, particle, &at, &f,
                     &mpm->contact.cell_pair[cells->first_pair + q]);
}

/* ---- variants -------------------------------------------------------------------------------- */

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

void MPSI_LEVELLED(mpsi_mpm_scatter_fitted)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                            const mpsi_worker *worker, int64_t particle) {
  CHOOSE(mpm->dim, mpm->def.spline, scatter_body, particle);
}

void MPSI_LEVELLED(mpsi_mpm_gather_fitted)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                           const mpsi_worker *worker, int64_t particle,
                                           mpsi_fitted *out) {
  CHOOSE(mpm->dim, mpm->def.spline, gather_body, particle, out);
}

void MPSI_LEVELLED(mpsi_mpm_fit)(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                 const mpsi_worker *worker, int64_t particle, mpsi_stencil *at,
                                 mpsi_shape_values *out) {
  support s;
  memset(out, 0, sizeof *out);
  make_support(mpm, cells, mpm->dim, mpm->def.spline, particle, &s);
  const mpsi_parted parted = find_parted(mpm, cells, particle, &s.at);
  CHOOSE(mpm->dim, mpm->def.spline, fit, &s, &parted, out);
  *at = s.at;
}

/* ---- weights at a foot ----------------------------------------------------------------------- */

/* By the fit that least_squares_batch.c has kept for the particle in this step. */
MPSI_INLINE void foot_body(const mps_mpm *mpm, const mpsi_cell_block *cells,
                           const mpsi_worker *worker, int dim, int spline, const double *q,
                           const mpsi_stencil *at, const double *d, double *psi) {
  double r[4] = {0.0};
  (void)cells, (void)worker;
  for (int row = 0, n = 0; row <= dim; row++)
    for (int c = row; c <= dim; c++, n++) {
      const double by_row = row == 0 ? 1.0 : d[row - 1] * mpm->grid.inverse;
      const double by_column = c == 0 ? 1.0 : d[c - 1] * mpm->grid.inverse;
      r[c] += by_row * q[n];
      if (c != row) r[row] += by_column * q[n];
    }
  const mpsi_quad x = mpsi_get(at->s[0]), w = mpsi_get(at->w[0]);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      double across = r[0] + r[2] * at->s[1][j], weight = at->w[1][j];
      if (dim == 3) across += r[3] * at->s[2][k], weight *= at->w[2][k];
      mpsi_put(psi + 16 * k + 4 * j, w * weight * (across + r[1] * x));
    }
}

/* By a fit of its own. */
static void foot_by_fit(const mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                        int64_t particle, const double *d, mpsi_foot_weights *out) {
  mpsi_stencil at;
  mpsi_shape_values f;
  MPSI_LEVELLED(mpsi_mpm_fit)(mpm, cells, worker, particle, &at, &f);
  memcpy(out->at, at.at, sizeof out->at);
  out->active = 0;
  out->across = f.across;
  for (int n = 0; n < MPSI_STENCIL; n++) {
    if (f.w[n] == 0.0) continue;
    out->active |= UINT64_C(1) << n;
    out->psi[n] = f.phi[n];
    for (int a = 0; a < mpm->dim; a++) out->psi[n] += f.gradient[a][n] * d[a];
  }
}

void MPSI_LEVELLED(mpsi_mpm_foot)(const mps_mpm *mpm, const mpsi_cell_block *cells,
                                  const mpsi_worker *worker, int64_t particle, const double *d,
                                  mpsi_foot_weights *out) {
  const int64_t slot = cells->first_fit + (particle - cells->begin);
  mpsi_stencil at;
  if (cells->first_fit < 0 || !mpm->grid.fitted[slot]) {
    foot_by_fit(mpm, cells, worker, particle, d, out);
    return;
  }
  mpsi_make_stencil(mpm, cells, mpm->dim, mpm->def.spline, particle, &at);
  memcpy(out->at, at.at, sizeof out->at);
  out->active = mpm->grid.fit[slot].active;
  out->across = 0;
  CHOOSE(mpm->dim, mpm->def.spline, foot_body, mpm->grid.fit[slot].q, &at, d, out->psi);
}
