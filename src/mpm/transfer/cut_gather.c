/* cut_gather.c - nodes to particles where bodies or sides of the domain cut the support:
 * velocities, velocity gradients, and the momentum retained by nodes of small mass, by the fits
 * that the scatter of the step has stored or by new ones. By the same fits shape functions
 * extrapolated to a contact point on a body. Each particle is a lane of a vector, as in
 * cut_scatter.c. Compiled once for each instruction set. SPDX-License-Identifier: BSD-3-Clause */
#include "cut_contact.h"
#include "spin.h"
#include "mpm/base/energy.h"
#include "mpm/ranks/partition.h"

/* ---- sums over the nodes --------------------------------------------------------------------- */

/* Sums over the nodes of a stencil, by component of the velocity. */
typedef struct node_sums {
  mpsi_quad by[3][4];     /* sum w v times 1, s_x, s_y, s_z */
  mpsi_quad v[3];         /* sum phi v */
  mpsi_quad moment[3][3]; /* sum phi v s_d, d other than the component */
} node_sums;

/* Velocity component `c` of node i of a row, number n of the stencil: for each particle its own
 * value or that across a thin body. */
MPSI_INLINE mpsi_quad value_at(const mpsi_cut *b, const mpsi_node *node, const mpsi_node *across,
                               int n, int i, int c) {
  const double v = node[i][c];
  const mpsi_quad own = {v, v, v, v};
  if (!across) return own;
  const double w = across[i][c];
  const mpsi_mask parted = mpsi_has_node(b->across, n);
  return (mpsi_quad)(((mpsi_mask)(mpsi_quad){w, w, w, w} & parted) | ((mpsi_mask)own & ~parted));
}

/* Adds row (j, k) of nodes to the sums. `across`: values across thin bodies; NULL without such
 * bodies. */
MPSI_INLINE void sum_row(int dim, int spline, const mpsi_cut *b, const mpsi_node *node,
                         const mpsi_node *across, int j, int k, node_sums *out) {
  const mpsi_quad value = mpsi_row_value(dim, b, b->q[0], j, k);
  mpsi_quad one[3] = {{0.0}}, by_x[3] = {{0.0}}, partition[3] = {{0.0}};
  for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
    const mpsi_quad x = b->s[0][i], phi = value + b->q[0][1] * x;
    for (int a = 0; a < dim; a++) {
      const mpsi_quad v = b->w[n] * value_at(b, node, across, n, i, MPSI_VECTOR + a);
      const mpsi_quad by_phi = phi * v;
      one[a] += v;
      by_x[a] += v * x;
      partition[a] += by_phi;
      if (a != 0) out->moment[a][0] += by_phi * x;
    }
  }
  for (int a = 0; a < dim; a++) {
    out->v[a] += partition[a];
    out->by[a][0] += one[a];
    out->by[a][1] += by_x[a];
    for (int d = 1; d < dim; d++) {
      const mpsi_quad s = d == 1 ? b->s[1][j] : b->s[2][k];
      out->by[a][1 + d] += one[a] * s;
      if (a != d) out->moment[a][d] += partition[a] * s;
    }
  }
}

/* Velocities of the nodes of row (j, k) of the stencil. */
MPSI_INLINE const mpsi_node *row_of(const mpsi_cut *b, mpsi_node *tile, int j, int k) {
  return (const mpsi_node *)tile + mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
}

/* Velocities, derivatives (1/s, for the laws) and slopes (for the next scatter) of a batch, to
 * `out` from index `at` on. */
MPSI_INLINE void gather(const mpsi_transfer *work, int dim, int spline, bool thin,
                        const mpsi_cut *b, mpsi_gathered *out, int at) {
  const mpsi_grid *grid = work->grid;
  const mpsi_worker *worker = work->worker;
  node_sums sum = {.v = {{0.0}}};
  mpsi_quad L[3][3];
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++)
      sum_row(dim, spline, b, row_of(b, worker->tile, j, k),
              thin ? row_of(b, worker->across_tile, j, k) : NULL, j, k, &sum);
  for (int a = 0; a < dim; a++)
    for (int d = 0; d < dim; d++) {
      L[a][d] = b->q[1 + d][0] * sum.by[a][0];
      for (int c = 1; c <= dim; c++) L[a][d] += b->q[1 + d][c] * sum.by[a][c];
      mpsi_put(out->derivative[dim * a + d] + at, L[a][d]);
    }
  const mpsi_mask keeps = mpsi_conserves_spin(grid, b);
  if (mpsi_any_lane(keeps)) mpsi_set_spin(dim, spline, grid->inverse, keeps, sum.moment, L);
  for (int a = 0; a < dim; a++) {
    mpsi_put(out->v[a] + at, sum.v[a]);
    for (int d = 0; d < dim; d++) mpsi_put(out->slope[dim * a + d] + at, L[a][d]);
  }
}

/* ---- derivatives along full axes ------------------------------------------------------------- */

/* Ratios (dw/dx)/w at the nodes of one axis, 1/m. */
MPSI_INLINE void find_ratios(const mpsi_grid *grid, int spline, const mpsi_cut *b, int axis,
                             mpsi_quad *ratio) {
  for (int l = 0; l < 4; l++) {
    double slope[4];
    mpsi_slopes(spline, -b->s[axis][0][l], slope);
    for (int i = 0; i <= spline; i++) {
      const double w = b->along[axis][i][l];
      ratio[i][l] = w > 0.0 ? grid->inverse * slope[i] / w : 0.0;
    }
  }
}

/* Derivatives of the velocity for the laws, along the axes whose stencil is full (with ghosts of
 * mirrors), if only sides of the domain cut the support: as in wall_support.h, means of dw/w over
 * the other axes by their weights. Whether a block comes here may depend on what else is in it
 * (`light`), and must change nothing. Along the other axes, and beside bodies, the slopes of the
 * fit are used. */
MPSI_INLINE void find_strain(const mpsi_transfer *work, int dim, int spline, bool thin,
                             const mpsi_cut *b, mpsi_gathered *out, int at) {
  const mpsi_grid *grid = work->grid;
  const mpsi_worker *worker = work->worker;
  const mpsi_mask beside = b->beside | (b->parted != 0);
  mpsi_quad weight = {0.0};
  MPSI_FOR_NODES(dim, spline) weight += b->w[n];
  for (int d = 0; d < dim; d++) {
    const int64_t low = (int64_t)work->cells->at[d] * MPSI_SIDE + b->at[d];
    if (low < grid->use_low[d] || low + spline > grid->use_high[d]) continue;
    mpsi_quad ratio[4], sum[3] = {{0.0}};
    find_ratios(grid, spline, b, d, ratio);
    MPSI_FOR_NODES(dim, spline) {
      const mpsi_quad by = ratio[d == 0 ? i : d == 1 ? j : k] * (b->w[n] / weight);
      const mpsi_node *across = thin ? row_of(b, worker->across_tile, j, k) : NULL;
      for (int a = 0; a < dim; a++)
        sum[a] += by * value_at(b, row_of(b, worker->tile, j, k), across, n, i, MPSI_VECTOR + a);
    }
    for (int a = 0; a < dim; a++) {
      double *to = out->derivative[dim * a + d] + at;
      mpsi_put(to, (mpsi_quad)(((mpsi_mask)mpsi_get(to) & beside) | ((mpsi_mask)sum[a] & ~beside)));
    }
  }
}

/* ---- momentum retained by nodes of small mass ------------------------------------------------ */

/* Momentum (kg m/s) that a node retains: its velocity follows from a mass m of at least
 * MPSI_LEAST_MASS times its mass by weights, `weight`, but its own mass M, which its particles
 * represent, is smaller. What they do not represent is (m - M) times the velocity; `before` the
 * forces, times the velocity then. */
static void find_retained(const mpsi_grid *grid, const mpsi_node_block *nodes, int32_t g, int local,
                          bool before, double *weight, double *retained) {
  const double *node = grid->node[mpsi_first_node(grid, g) + local];
  const double *side = grid->side[mpsi_first_node(grid, nodes->side) + local];
  const double m = node[MPSI_MASS], own = mpsi_own_mass(m, side[MPSI_EXCESS]);
  *weight = own + side[MPSI_EXCESS];
  /* then the momentum before the forces was divided by M itself, and nothing of it is missing */
  const bool moves = nodes->split && mpsi_carried_mass(own, *weight) < 0.0;
  const double *velocity = before ? side : node;
  for (int c = 0; c < 3; c++)
    retained[c] =
        own < m ? (m - own) * (velocity[MPSI_VECTOR + c] - (moves ? side[MPSI_VECTOR + c] : 0.0))
                : 0.0;
}

/* Adds the retained momentum of the nodes to the velocity v of the particle in a lane, by the
 * weights: all particles together get all of it. */
static void return_momentum(const mpsi_transfer *work, int dim, int spline, const mpsi_cut *b,
                            int lane, double *v) {
  mpsi_support at;
  mpsi_make_support(work->grid, work->cells, dim, b->at, &at);
  MPSI_FOR_NODES(dim, spline) {
    const double w = b->w[n][lane];
    int32_t g = mpsi_support_block(work->cells, &at, i, j, k);
    if (w == 0.0) continue;
    if (b->across[lane] >> n & 1) g = work->grid->nodes[g].across;
    const mpsi_node_block *nodes = &work->grid->nodes[g];
    double weight, retained[3];
    if (!nodes->light) continue;
    find_retained(work->grid, nodes, g, mpsi_support_local(&at, i, j, k), work->before, &weight,
                  retained);
    for (int c = 0; c < 3 && weight > 0.0; c++) retained[c] *= w / weight;
    if (mpsi_is_folded(&at, i, j, k))
      mpsi_reflect_at(work, b, i, j, k, retained, work->before ? 0.0 : work->p->m[b->first + lane]);
    for (int c = 0; c < dim && weight > 0.0; c++) v[c] += retained[c];
  }
}

/* Returns retained momentum to the particles of a batch, and enters it in the energy budget. */
MPSI_APART void return_momenta(const mpsi_transfer *work, int dim, int spline, const mpsi_cut *b,
                               mpsi_gathered *out, int at) {
  for (int lane = 0; lane < b->lanes; lane++) {
    double v[3] = {0.0}, before[3] = {0.0};
    for (int c = 0; c < dim; c++) before[c] = v[c] = out->v[c][at + lane];
    return_momentum(work, dim, spline, b, lane, v);
    for (int c = 0; c < dim; c++) {
      out->v[c][at + lane] = v[c];
      before[c] = v[c] - before[c];
    }
    if (work->energy->counts && !work->before)
      mpsi_mpm_energy_returned(work->grid, work->p, work->energy, work->def, work->run->dt,
                               work->cells, b->first + lane, before);
  }
}

/* ---- the standard scheme --------------------------------------------------------------------- */

/* FLIP part of a particle's velocity: `flip` times the difference between its velocity and that of
 * the nodes before the forces, interpolated to the particle. */
MPSI_INLINE void find_flip_part(const mpsi_transfer *work, int dim, int spline,
                                const mpsi_single *one, double *own) {
  const mpsi_grid *grid = work->grid;
  mpsi_quad before = {0.0};
  MPSI_FOR_NODES(dim, spline) {
    const int32_t side = grid->nodes[mpsi_support_block(work->cells, one->at, i, j, k)].side;
    const mpsi_node *node = (const mpsi_node *)(grid->side + mpsi_first_node(grid, side));
    before += one->f.phi[n] * mpsi_get(node[mpsi_support_local(one->at, i, j, k)]);
  }
  for (int c = 0; c < dim; c++)
    own[c] = grid->flip * (work->p->v[c][one->particle] - before[MPSI_VECTOR + c]);
}

/* Velocity and gradient of one particle by the shape functions of standard MPM, to `out` at index
 * `to`. */
MPSI_INLINE void gather_one(const mpsi_transfer *work, int dim, int spline, const mpsi_single *one,
                            mpsi_gathered *out, int to) {
  mpsi_quad v = {0.0}, by[3] = {{0.0}};
  double own[3] = {0.0};
  MPSI_FOR_NODES(dim, spline) {
    const mpsi_quad node = mpsi_get(row_of(one->batch, work->worker->tile, j, k)[i]);
    v += one->f.phi[n] * node;
    for (int d = 0; d < dim; d++) by[d] += one->f.gradient[d][n] * node;
  }
  if (work->grid->flip > 0.0) find_flip_part(work, dim, spline, one, own);
  for (int c = 0; c < dim; c++) {
    out->v[c][to] = v[MPSI_VECTOR + c];
    out->own[c][to] = own[c];
    for (int d = 0; d < dim; d++)
      out->slope[dim * c + d][to] = out->derivative[dim * c + d][to] = by[d][MPSI_VECTOR + c];
  }
}

/* Work done particle by particle: standard MPM, and the loads by friction of penalty contact. */
MPSI_APART void gather_each(const mpsi_transfer *work, int dim, int spline, const mpsi_cut *b,
                            mpsi_gathered *out, int to) {
  const int32_t pairs = b->held & MPSI_PENALTY ? work->cells->pairs : 0;
  mpsi_support at;
  mpsi_make_support(work->grid, work->cells, dim, b->at, &at);
  for (int lane = 0; lane < b->lanes; lane++) {
    mpsi_single one;
    mpsi_take_single(work->grid, dim, spline, b, &at, lane, &one);
    if (work->grid->standard) gather_one(work, dim, spline, &one, out, to + lane);
    for (int32_t q = 0; q < pairs; q++)
      if (mpsi_sees_body(work, dim, spline, &one, q))
        mpsi_add_friction_load(work, dim, spline, &one,
                               &work->contact->cell_pair[work->cells->first_pair + q]);
  }
}

/* ---- segments -------------------------------------------------------------------------------- */

/* Whether the scatter has found the supports of a segment full. */
MPSI_INLINE bool are_full(const mpsi_grid *grid, const mpsi_cell_block *cells,
                          const mpsi_segment *segment) {
  const int64_t first = segment->places->chunk - cells->begin;
  const uint8_t *fitted = grid->fitted + cells->first_fit + first;
  bool full = true;
  for (int k = segment->begin; k < segment->end; k++) full = full && fitted[k] == MPSI_FITTED_FULL;
  return full;
}

MPSI_INLINE void gather_cut(const mpsi_transfer *work, int dim, int spline, bool thin, mpsi_cut *b,
                            mpsi_gathered *out, int at) {
  if (!work->grid->standard) {
    if (mpsi_has_fits(work->grid, work->cells, b))
      mpsi_take_fit(work->grid, work->cells, dim, spline, b);
    else
      mpsi_find_fit(work, dim, spline, thin, true, b);
    gather(work, dim, spline, thin, b, out, at);
    if (mpsi_any_lane(~b->beside)) find_strain(work, dim, spline, thin, b, out, at);
    if (work->cells->light) return_momenta(work, dim, spline, b, out, at);
  }
  if (work->before) return;
  if (work->grid->standard || b->held & MPSI_PENALTY) gather_each(work, dim, spline, b, out, at);
}

MPSI_INLINE bool gather_thin(const mpsi_transfer *work, int dim, int spline, uint32_t held,
                             const mpsi_segment *segment, mpsi_gathered *out, mpsi_cut *b) {
  for (int k = segment->begin; k < segment->end; k += 4) {
    mpsi_place_cut(work->worker, dim, spline, segment, k, held, b);
    gather_cut(work, dim, spline, true, b, out, k);
  }
  return true;
}

MPSI_INLINE bool gather_body(const mpsi_transfer *work, int dim, int spline, uint32_t held,
                             const mpsi_segment *segment, mpsi_gathered *out, mpsi_cut *b) {
  if (work->cells->first_fit >= 0 && !work->cells->light &&
      are_full(work->grid, work->cells, segment))
    return false;
  for (int k = segment->begin; k < segment->end; k += 4) {
    mpsi_place_cut(work->worker, dim, spline, segment, k, held, b);
    gather_cut(work, dim, spline, false, b, out, k);
  }
  return true;
}

#define DEFINE(body, dim, spline)                                                                  \
  MPSI_APART bool body##_##dim##_##spline(const mpsi_transfer *work, uint32_t held,                \
                                          const mpsi_segment *segment, mpsi_gathered *out) {       \
    mpsi_cut b;                                                                                    \
    return body(work, dim, spline, held, segment, out, &b);                                        \
  }
MPSI_INSTANCES(DEFINE, gather_thin)
MPSI_INSTANCES(DEFINE, gather_body)

bool MPSI_LEVELLED(mpsi_mpm_gather_cut)(const mpsi_transfer *work, const mpsi_segment *segment,
                                        mpsi_gathered *out) {
  const int32_t first = segment->places->first[segment->begin];
  const uint32_t held =
      mpsi_support_state(work->worker, work->grid->dim, work->grid->spline, first) & MPSI_HELD;
  return work->cells->thin ? MPSI_CHOOSE_INSTANCE(gather_thin, held, segment, out)
                           : MPSI_CHOOSE_INSTANCE(gather_body, held, segment, out);
}

/* ---- one particle ---------------------------------------------------------------------------- */

MPSI_INLINE void fit_body(const mpsi_transfer *work, int dim, int spline, int64_t particle,
                          mpsi_shape_values *out) {
  mpsi_cut cut, *b = &cut;
  double determinant = 1.0;
  mpsi_place_one(work, dim, spline, particle, b);
  if (!work->grid->standard && work->cells->thin)
    determinant = mpsi_find_fit(work, dim, spline, true, false, b)[0];
  else if (!work->grid->standard)
    determinant = mpsi_find_fit(work, dim, spline, false, false, b)[0];
  mpsi_values_of(work->grid, dim, spline, b, 0, out);
  out->determinant = determinant;
}

#define DEFINE_FIT(body, dim, spline)                                                              \
  MPSI_APART void body##_##dim##_##spline(const mpsi_transfer *work, int64_t particle,             \
                                          mpsi_shape_values *out) {                                \
    body(work, dim, spline, particle, out);                                                        \
  }
MPSI_INSTANCES(DEFINE_FIT, fit_body)

void MPSI_LEVELLED(mpsi_mpm_fit)(const mpsi_transfer *work, int64_t particle, mpsi_stencil *at,
                                 mpsi_shape_values *out) {
  memset(out, 0, sizeof *out);
  mpsi_make_stencil(work->grid, work->p, work->cells, work->grid->dim, work->grid->spline, particle,
                    at);
  MPSI_CHOOSE_INSTANCE(fit_body, particle, out);
}

/* psi = phi + grad phi . d by the fit that the scatter of this step has stored; q: upper half of
 * M^-1. */
MPSI_INLINE bool foot_body(const mpsi_transfer *work, int dim, int spline, const double *q,
                           const mpsi_stencil *at, const double *d, double *psi) {
  double r[4] = {0.0};
  for (int row = 0, n = 0; row <= dim; row++)
    for (int c = row; c <= dim; c++, n++) {
      const double by_row = row == 0 ? 1.0 : d[row - 1] * work->grid->inverse;
      const double by_column = c == 0 ? 1.0 : d[c - 1] * work->grid->inverse;
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
  return true;
}

/* psi = phi + grad phi . d by a new fit, where none is stored. */
static void foot_by_fit(const mpsi_transfer *work, int64_t particle, const double *d,
                        mpsi_foot_weights *out) {
  mpsi_stencil at;
  mpsi_shape_values f;
  MPSI_LEVELLED(mpsi_mpm_fit)(work, particle, &at, &f);
  memcpy(out->at, at.at, sizeof out->at);
  out->active = 0;
  out->across = f.across;
  for (int n = 0; n < MPSI_STENCIL; n++) {
    if (f.w[n] == 0.0) continue;
    out->active |= UINT64_C(1) << n;
    out->psi[n] = f.phi[n];
    for (int a = 0; a < work->grid->dim; a++) out->psi[n] += f.gradient[a][n] * d[a];
  }
}

void MPSI_LEVELLED(mpsi_mpm_foot)(const mpsi_transfer *work, int64_t particle, const double *d,
                                  mpsi_foot_weights *out) {
  const int64_t slot = work->cells->first_fit + (particle - work->cells->begin);
  mpsi_stencil at;
  if (work->cells->first_fit < 0 || !work->grid->fitted[slot]) {
    foot_by_fit(work, particle, d, out);
    return;
  }
  mpsi_make_stencil(work->grid, work->p, work->cells, work->grid->dim, work->grid->spline, particle,
                    &at);
  memcpy(out->at, at.at, sizeof out->at);
  out->active = work->grid->fit[slot].active;
  out->across = 0;
  MPSI_CHOOSE(foot_body, work->grid->fit[slot].q, &at, d, out->psi);
}
