/* batch.c - particles beside bodies that act by impulses, up to four of one stencil at once: the
 * fit over the active nodes and the transfers of fitted.c, particle by particle in the lanes of a
 * vector. What else may cut a support (corners of sides that are no mirrors, thin bodies), springs
 * and the variants for comparison are fitted.c's. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "spin.h"
#include "support.h"

/* Particles of one stencil; lanes without one have the place of the first, and no mass. */
typedef struct batch {
  int at[3];                                    /* lowest node in the tile */
  uint32_t bodies;                              /* that hold any of them */
  mpsi_quad s[3][4], along[3][4];               /* cells, to the nodes of each axis; weights */
  mpsi_quad w[MPSI_STENCIL], phi[MPSI_STENCIL]; /* of the active nodes, else 0 */
  mpsi_quad q[4][4];                            /* inverse of M; rows from 1 on over h */
} batch;

/* ---- active nodes -----------------------------------------------------------------------------
 */

/* Particles [k, k + n) of the chunk, n at most 4. */
MPSI_INLINE void place_batch(int dim, int spline, const mpsi_places *places, int k, int n,
                             batch *out) {
  mpsi_unravel(places->first[k], MPSI_TILE_SIDE, out->at);
  for (int c = 0; c < dim; c++) {
    const mpsi_quad t = mpsi_get_some(places->t[c] + k, n);
    mpsi_lane_weights(spline, t, out->along[c]);
    for (int i = 0; i <= spline; i++) out->s[c][i] = (double)i - t;
  }
}

/* Which nodes of each axis are corners of the particles' own cells; on the upper side of the domain
 * those of the last cell. */
MPSI_INLINE void find_corners(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                              const batch *b, mpsi_mask (*corner)[4]) {
  for (int c = 0; c < dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE + b->at[c];
    const double last = (double)(mpm->grid.high[c] - first);
    mpsi_quad t = -b->s[c][0];
    for (int l = 0; l < 4 && last <= 2.0; l++) t[l] = t[l] < last ? t[l] : last - 0.5;
    for (int i = 0; i <= spline; i++) {
      const mpsi_quad s = (double)i - t;
      corner[c][i] = (s > -1.0) & (s <= 1.0);
    }
  }
}

/* As same_side of fitted.c. A ghost beyond a mirror has the normals of its partner, the other way
 * across the mirror. */
MPSI_INLINE mpsi_mask same_side(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                const batch *b, int i, int j, int k) {
  const int place[3] = {i, j, k};
  double sign[3] = {1.0, 1.0, 1.0};
  int t[3] = {0};
  for (int c = 0; c < dim; c++) {
    const int node = b->at[c] + place[c];
    const int partner = cells->mirrors ? mpsi_partner_of(mpm, cells, c, node) : -1;
    t[c] = partner >= 0 ? partner : node;
    if (t[c] != node) sign[c] = -1.0;
  }
  const int64_t under = mpsi_node_under(mpm, cells, t[0], t[1], t[2]);
  const mpsi_node_block *block = &mpm->grid.nodes[under / mpm->grid.block_nodes];
  const int64_t local = under % mpm->grid.block_nodes;
  mpsi_mask same = {-1, -1, -1, -1};
  for (int32_t q = block->first_pair; q < block->first_pair + block->pairs; q++) {
    const double *n = mpm->contact.node[(int64_t)q * mpm->grid.block_nodes + local].normal;
    if (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0) continue;
    mpsi_quad across = {0.0};
    for (int c = 0; c < dim; c++) across += sign[c] * n[c] * b->s[c][place[c]];
    same &= across < 0.0;
  }
  return same;
}

/* Weights of the active nodes. */
MPSI_INLINE void find_active(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int dim, int spline, batch *b) {
  mpsi_mask corner[3][4];
  find_corners(mpm, cells, dim, spline, b, corner);
  MPSI_FOR_NODES(dim, spline) {
    const int t = mpsi_tile_index(b->at[0] + i, b->at[1] + j, b->at[2] + k);
    const uint8_t state = worker->state[t];
    mpsi_quad w = b->along[0][i] * b->along[1][j];
    if (dim == 3) w *= b->along[2][k];
    if (state & MPSI_INSIDE) {
      mpsi_mask active = corner[0][i] & corner[1][j];
      if (dim == 3) active &= corner[2][k];
      if (state & MPSI_REACHED) active |= same_side(mpm, cells, dim, b, i, j, k);
      w = (mpsi_quad)((mpsi_mask)w & active);
    }
    b->w[n] = state & MPSI_OUTSIDE ? (mpsi_quad){0.0} : w;
  }
}

/* ---- the fit ----------------------------------------------------------------------------------
 */

/* The upper half of sum w P P^T, P = [1, s]. */
MPSI_INLINE void moments(int dim, int spline, const batch *b, const mpsi_quad *w,
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

/* Inverses of symmetric positive definite matrices, given by their upper halves: see mpsi_invert.
 */
MPSI_INLINE void invert(int n, mpsi_quad m[4][4]) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) m[i][j] = m[j][i];
  MPSI_UNROLL for (int p = 0; p < n; p++) {
    const mpsi_quad scale = 1.0 / m[p][p];
    m[p][p] = (mpsi_quad){1.0, 1.0, 1.0, 1.0};
    for (int j = 0; j < n; j++) m[p][j] *= scale;
    MPSI_UNROLL for (int i = 0; i < n; i++) {
      if (i == p) continue;
      const mpsi_quad factor = m[i][p];
      m[i][p] = (mpsi_quad){0.0};
      for (int j = 0; j < n; j++) m[i][j] -= factor * m[p][j];
    }
  }
}

/* Row r of the fit at a row of nodes along x, but for what is by s_x. */
MPSI_INLINE mpsi_quad across(int dim, const batch *b, int r, int j, int k) {
  const mpsi_quad sum = b->q[r][0] + b->q[r][2] * b->s[1][j];
  return dim == 3 ? sum + b->q[r][3] * b->s[2][k] : sum;
}

MPSI_INLINE void fit(const mps_mpm *mpm, int dim, int spline, batch *b) {
  moments(dim, spline, b, b->w, b->q);
  invert(dim + 1, b->q);
  for (int r = 1; r <= dim; r++)
    for (int c = 0; c <= dim; c++) b->q[r][c] *= mpm->grid.inverse;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const mpsi_quad value = across(dim, b, 0, j, k);
      for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++)
        b->phi[n] = b->w[n] * (value + b->q[0][1] * b->s[0][i]);
    }
}

MPSI_INLINE void make_batch(const mps_mpm *mpm, const mpsi_cell_block *cells,
                            const mpsi_worker *worker, int dim, int spline,
                            const mpsi_places *places, int k, int n, uint32_t bodies, batch *out) {
  out->bodies = bodies;
  place_batch(dim, spline, places, k, n, out);
  find_active(mpm, cells, worker, dim, spline, out);
  fit(mpm, dim, spline, out);
}

/* Bodies that hold nodes of a stencil, bit by bit; 0 where its particles are fitted.c's. */
MPSI_INLINE uint32_t bodies_of(const mps_mpm *mpm, const mpsi_cell_block *cells,
                               const mpsi_worker *worker, int dim, int spline, int32_t first) {
  uint32_t bodies = 0;
  if (mpm->standard || mpm->by_weight || cells->thin) return 0;
  MPSI_FOR_NODES(dim, spline) bodies |= worker->inside[first + mpsi_tile_index(i, j, k)], (void)n;
  for (int32_t q = 0; q < cells->pairs; q++) {
    const int32_t body = mpm->contact.cell_pair[cells->first_pair + q].body;
    if (bodies >> body & 1 && !mpsi_by_impulses(mpm->contact.handle[body])) return 0;
  }
  return bodies;
}

/* ---- particles to nodes -----------------------------------------------------------------------
 */

/* What the particles give: see source of fitted.c. By component, and by axis. */
typedef struct source {
  mpsi_quad m;
  mpsi_quad v[3], L[3][3];         /* kg m/s; the same a cell */
  mpsi_quad body[3], stress[3][3]; /* N, N m */
  mpsi_quad turn[3][3];            /* kg m2/s, by the derivative: see spin.h */
} source;

/* Particles [p, p + n). */
MPSI_INLINE void find_source(const mps_mpm *mpm, int dim, int64_t p, int n, source *out) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *from = &mpm->p;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  const mpsi_quad m = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->m + p, n) & there);
  const mpsi_quad V = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->V + p, n) & there);
  out->m = m;
  for (int a = 0; a < dim; a++) {
    out->v[a] = m * mpsi_get_some(from->v[a] + p, n);
    out->body[a] = m * mpm->def.gravity[a];
    if (from->f[a])
      out->body[a] += (mpsi_quad)((mpsi_mask)mpsi_get_some(from->f[a] + p, n) & there);
    for (int d = 0; d < dim; d++) {
      out->L[a][d] = m * mpm->def.cell * mpsi_get_some(from->L[dim * a + d] + p, n);
      out->stress[a][d] = -V * mpsi_get_some(from->s[symmetric[a][d]] + p, n);
      out->turn[a][d] = (mpsi_quad){0.0};
    }
  }
  if (mpm->def.geometry == MPS_MPM_AXISYMMETRIC)
    out->body[0] -= V * mpsi_get_some(from->s[2] + p, n) / mpsi_get_some(from->x[0] + p, n);
}

/* The rotation by which the particles give their moments: mpsi_give_spin, in the plane. Returns
 * whether some give it by the derivative. */
MPSI_INLINE bool give_spin_in_plane(const mps_mpm *mpm, int spline, mpsi_quad (*m)[4], source *s) {
  const double full = 1.0 / mpsi_inverse_moment(spline);
  const mpsi_quad trace = m[1][1] + m[2][2];
  const mpsi_quad lack = (full - m[1][1]) * s->L[1][0] - (full - m[2][2]) * s->L[0][1] -
                         m[1][2] * (s->L[1][1] - s->L[0][0]);
  const mpsi_mask turns = trace > MPSI_LEAST_INERTIA * 2.0 * full;
  const mpsi_quad spin = (mpsi_quad)((mpsi_mask)(lack / trace) & turns);
  const mpsi_quad turn = (mpsi_quad)((mpsi_mask)(0.5 * mpm->def.cell * lack) & ~turns);
  s->L[1][0] += spin, s->L[0][1] -= spin;
  s->turn[1][0] = turn, s->turn[0][1] = -turn;
  return (turns[0] & turns[1] & turns[2] & turns[3]) == 0;
}

/* The same in space, particle by particle. */
MPSI_INLINE bool give_spin_in_space(const mps_mpm *mpm, int spline, mpsi_quad (*second)[4], int n,
                                    source *s) {
  bool turns = false;
  for (int l = 0; l < n; l++) {
    double m[4][4] = {{0.0}};
    mpsi_quad L[3] = {{0.0}}, turn[3] = {{0.0}};
    for (int r = 1; r < 4; r++)
      for (int c = r; c < 4; c++) m[r][c] = second[r][c][l];
    for (int d = 0; d < 3; d++)
      for (int a = 0; a < 3; a++) L[d][1 + a] = s->L[a][d][l];
    if (!mpsi_give_spin(3, spline, mpm->def.cell, m, L, turn)) turns = true;
    for (int d = 0; d < 3; d++)
      for (int a = 0; a < 3; a++) s->L[a][d][l] = L[d][1 + a], s->turn[a][d][l] = turn[d][1 + a];
  }
  return turns;
}

MPSI_INLINE bool give_spin(const mps_mpm *mpm, int dim, int spline, const batch *b, int n,
                           source *s) {
  mpsi_quad second[4][4];
  moments(dim, spline, b, b->phi, second);
  return dim == 2 ? give_spin_in_plane(mpm, spline, second, s)
                  : give_spin_in_space(mpm, spline, second, n, s);
}

/* The sums of four vectors, side by side. */
MPSI_INLINE mpsi_quad sums(mpsi_quad a, mpsi_quad b, mpsi_quad c, mpsi_quad d) {
  mpsi_quad all[4] = {a, b, c, d};
  mpsi_transpose(all);
  return (all[0] + all[2]) + (all[1] + all[3]);
}

/* To one node: momentum to the tile, force and excess mass to the tile of forces. */
MPSI_INLINE void give(int dim, const batch *b, const source *s, bool turns, int n,
                      const mpsi_quad *to, const mpsi_quad *gradient, double *tile, double *force) {
  const mpsi_quad phi = b->phi[n], zero = {0.0};
  mpsi_quad momentum[3] = {zero, zero, zero}, push[3] = {zero, zero, zero};
  for (int a = 0; a < dim; a++) {
    mpsi_quad v = s->v[a];
    push[a] = s->body[a] * phi;
    for (int d = 0; d < dim; d++) {
      v += s->L[a][d] * to[d];
      push[a] += s->stress[a][d] * gradient[d];
    }
    momentum[a] = v * phi;
    for (int d = 0; d < dim && turns; d++) momentum[a] += s->turn[a][d] * gradient[d];
  }
  mpsi_put(tile, mpsi_get(tile) + sums(s->m * phi, momentum[0], momentum[1], momentum[2]));
  mpsi_put(force, mpsi_get(force) + sums(s->m * (b->w[n] - phi), push[0], push[1], push[2]));
}

MPSI_INLINE void scatter(const mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_worker *worker, int dim, int spline, const batch *b, int64_t p,
                         int lanes) {
  source s;
  find_source(mpm, dim, p, lanes, &s);
  const bool turns = mpm->run.moments && mpsi_keeps_spin(mpm, cells, b->bodies) &&
                     give_spin(mpm, dim, spline, b, lanes, &s);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      mpsi_quad slope[3];
      for (int d = 0; d < dim; d++) slope[d] = across(dim, b, 1 + d, j, k);
      for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
        const int t = mpsi_tile_index(b->at[0] + i, b->at[1] + j, b->at[2] + k);
        const mpsi_quad to[3] = {b->s[0][i], b->s[1][j], b->s[2][k]};
        mpsi_quad gradient[3];
        if (worker->state[t] & MPSI_OUTSIDE) continue;
        for (int d = 0; d < dim; d++) gradient[d] = b->w[n] * (slope[d] + b->q[1 + d][1] * to[0]);
        give(dim, b, &s, turns, n, to, gradient, worker->tile[t], worker->force[t]);
      }
    }
}

/* ---- nodes to particles -----------------------------------------------------------------------
 */

/* The spin of the slopes L[component][axis]: see mpsi_take_spin. */
MPSI_INLINE void take_spin(int dim, int spline, double inverse, mpsi_quad (*moment)[3],
                           mpsi_quad (*L)[3]) {
  const double scale = mpsi_inverse_moment(spline) * inverse;
  for (int a = 0; a < dim; a++)
    for (int b = a + 1; b < dim; b++) {
      const mpsi_quad spin = scale * (moment[b][a] - moment[a][b]);
      const mpsi_quad more = 0.5 * (spin - (L[b][a] - L[a][b]));
      L[b][a] += more;
      L[a][b] -= more;
    }
}

MPSI_INLINE void gather(const mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                        int dim, int spline, const batch *b, mpsi_gathered *out, int at) {
  mpsi_quad v[3] = {{0.0}}, L[3][3] = {{{0.0}}}, moment[3][3] = {{{0.0}}};
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      mpsi_quad slope[3];
      for (int d = 0; d < dim; d++) slope[d] = across(dim, b, 1 + d, j, k);
      for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
        const double *node =
            worker->tile[mpsi_tile_index(b->at[0] + i, b->at[1] + j, b->at[2] + k)];
        const mpsi_quad to[3] = {b->s[0][i], b->s[1][j], b->s[2][k]};
        for (int a = 0; a < dim; a++) {
          const mpsi_quad share = b->phi[n] * node[MPSI_VECTOR + a];
          v[a] += share;
          for (int d = 0; d < dim; d++) {
            if (d != a) moment[a][d] += share * to[d];
            L[a][d] += b->w[n] * (slope[d] + b->q[1 + d][1] * to[0]) * node[MPSI_VECTOR + a];
          }
        }
      }
    }
  for (int a = 0; a < dim; a++)
    for (int d = 0; d < dim; d++) mpsi_put(out->derivative[dim * a + d] + at, L[a][d]);
  if (mpsi_keeps_spin(mpm, cells, b->bodies)) take_spin(dim, spline, mpm->grid.inverse, moment, L);
  for (int a = 0; a < dim; a++) {
    mpsi_put(out->v[a] + at, v[a]);
    for (int d = 0; d < dim; d++) mpsi_put(out->slope[dim * a + d] + at, L[a][d]);
  }
}

/* ---- segments ---------------------------------------------------------------------------------
 */

MPSI_INLINE bool scatter_body(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                              int dim, int spline, const mpsi_places *places, int64_t chunk,
                              int begin, int end) {
  const uint32_t bodies = bodies_of(mpm, cells, worker, dim, spline, places->first[begin]);
  for (int k = begin; k < end && bodies; k += 4) {
    const int n = end - k < 4 ? end - k : 4;
    batch b;
    make_batch(mpm, cells, worker, dim, spline, places, k, n, bodies, &b);
    scatter(mpm, cells, worker, dim, spline, &b, chunk + k, n);
  }
  return bodies != 0;
}

MPSI_INLINE bool gather_body(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                             int dim, int spline, const mpsi_places *places, int begin, int end,
                             mpsi_gathered *out) {
  const uint32_t bodies = bodies_of(mpm, cells, worker, dim, spline, places->first[begin]);
  for (int k = begin; k < end && bodies; k += 4) {
    const int n = end - k < 4 ? end - k : 4;
    batch b;
    make_batch(mpm, cells, worker, dim, spline, places, k, n, bodies, &b);
    gather(mpm, cells, worker, dim, spline, &b, out, k);
  }
  return bodies != 0;
}

/* The body with dimension and spline as literal arguments. */
#define CHOOSE(body, ...)                                                                          \
  (mpm->dim == 2          ? mpm->def.spline == 2 ? body(mpm, cells, worker, 2, 2, __VA_ARGS__)     \
                                                 : body(mpm, cells, worker, 2, 3, __VA_ARGS__)     \
            : mpm->def.spline == 2 ? body(mpm, cells, worker, 3, 2, __VA_ARGS__)                   \
                          : body(mpm, cells, worker, 3, 3, __VA_ARGS__))

bool MPSI_LEVELLED(mpsi_mpm_scatter_batches)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                             const mpsi_worker *worker, const mpsi_places *places,
                                             int64_t chunk, int begin, int end) {
  return CHOOSE(scatter_body, places, chunk, begin, end);
}

bool MPSI_LEVELLED(mpsi_mpm_gather_batches)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                            const mpsi_worker *worker, const mpsi_places *places,
                                            int begin, int end, mpsi_gathered *out) {
  return CHOOSE(gather_body, places, begin, end, out);
}
