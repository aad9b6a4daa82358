/* least_squares_batch.c - particles beside bodies with contact by impulses, up to four of one
 * stencil at once: the fit over the active nodes and the transfers of least_squares.c, particle by
 * particle in the lanes of a vector. What else may cut a support (corners of sides that are no
 * mirrors, thin bodies), penalty contact and the variants for comparison are in least_squares.c.
 * Compiled once for each instruction set. SPDX-License-Identifier: BSD-3-Clause */
#include "spin.h"
#include "support.h"

/* Particles of one stencil; lanes without one have the place of the first, and no mass. */
typedef struct batch {
  int at[3];                      /* lowest node in the tile */
  uint32_t held;                  /* MPSI_IMPULSE where bodies hold any of them */
  mpsi_quad s[3][4], along[3][4]; /* cells, to the nodes of each axis; weights */
  mpsi_quad w[MPSI_STENCIL];      /* of the active nodes, else 0 */
  mpsi_quad q[4][4];              /* inverse of M; rows from 1 on over h */
} batch;

/* ---- active nodes ---------------------------------------------------------------------------- */

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

/* mpsi_contact_same_side for all bodies that hold the node. A ghost beyond a mirror has the normals
 * of its partner, the other way across the mirror. */
MPSI_INLINE mpsi_mask same_side(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                const batch *b, int i, int j, int k) {
  const int place[3] = {i, j, k};
  mpsi_quad s[3];
  int t[3] = {0};
  for (int c = 0; c < dim; c++) {
    const int node = b->at[c] + place[c];
    const int partner = cells->mirrors ? mpsi_partner_of(mpm, cells, c, node) : -1;
    t[c] = partner >= 0 ? partner : node;
    s[c] = t[c] != node ? -b->s[c][place[c]] : b->s[c][place[c]];
  }
  const mpsi_node_block *nodes = &mpm->grid.nodes[mpsi_block_under(cells, t[0], t[1], t[2])];
  const int local = mpsi_local_under(t[0], t[1], t[2]);
  mpsi_mask same = {-1, -1, -1, -1};
  int32_t pair = nodes->first_pair;
  for (const double *n; (n = mpsi_next_normal(mpm, nodes, local, &pair)) != NULL;) {
    const mpsi_quad across = n[0] * s[0] + n[1] * s[1];
    same &= (dim == 3 ? across + n[2] * s[2] : across) < 0.0;
  }
  return same;
}

/* Whether particles may use a node that lies in a body. */
MPSI_INLINE mpsi_mask is_active(const mps_mpm *mpm, const mpsi_cell_block *cells, uint8_t state,
                                int dim, const batch *b, mpsi_mask (*corner)[4], int i, int j,
                                int k) {
  mpsi_mask active = corner[0][i] & corner[1][j];
  if (dim == 3) active &= corner[2][k];
  if ((active[0] & active[1] & active[2] & active[3]) != 0 || !(state & MPSI_REACHED))
    return active;
  return active | same_side(mpm, cells, dim, b, i, j, k);
}

/* Weights of the active nodes. */
MPSI_INLINE void find_active(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int dim, int spline, batch *b) {
  mpsi_mask corner[3][4];
  find_corners(mpm, cells, dim, spline, b, corner);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const uint8_t *state = worker->state + mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      mpsi_quad *w = b->w + 16 * k + 4 * j, across = b->along[1][j];
      if (dim == 3) across *= b->along[2][k];
      for (int i = 0; i <= spline; i++) w[i] = b->along[0][i] * across;
      uint32_t any;
      memcpy(&any, state, sizeof any);
      for (int i = 0; i <= spline && any != 0; i++) {
        if (state[i] & MPSI_OUTSIDE)
          w[i] = (mpsi_quad){0.0};
        else if (state[i] & MPSI_INSIDE)
          w[i] = (mpsi_quad)((mpsi_mask)w[i] &
                             is_active(mpm, cells, state[i], dim, b, corner, i, j, k));
      }
    }
}

/* Whether particles of the stencil from tile node `first` may all have a full support: nothing but
 * bodies has any of its nodes, and those are corners of cells with particles. */
MPSI_INLINE bool may_be_full(const mpsi_worker *worker, int dim, int spline, int32_t first) {
  const uint32_t in = spline == 3 ? 0x01010101u : 0x00010101u;
  uint32_t other = 0;
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      uint32_t row;
      memcpy(&row, worker->state + first + mpsi_tile_index(0, j, k), sizeof row);
      row &= in * 0xffu;
      other |= row & ~(in * (MPSI_INSIDE | MPSI_REACHED | MPSI_IMPULSE)); /* outside, ... */
      other |= (row / MPSI_INSIDE ^ row / MPSI_REACHED) & in;
    }
  return other == 0;
}

/* Whether all particles of the batch may use all nodes of their stencil, of which may_be_full. */
MPSI_INLINE bool is_full(const mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_worker *worker, int dim, int spline, const batch *b) {
  mpsi_mask corner[3][4];
  find_corners(mpm, cells, dim, spline, b, corner);
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const uint8_t *state = worker->state + mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      for (int i = 0; i <= spline; i++) {
        if (state[i] == 0) continue;
        const mpsi_mask active = is_active(mpm, cells, state[i], dim, b, corner, i, j, k);
        if ((active[0] & active[1] & active[2] & active[3]) == 0) return false;
      }
    }
  return true;
}

/* ---- the fit --------------------------------------------------------------------------------- */

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
MPSI_INLINE mpsi_quad invert(int n, mpsi_quad m[4][4]) {
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
MPSI_INLINE mpsi_quad across(int dim, const batch *b, const mpsi_quad *q, int j, int k) {
  const mpsi_quad sum = q[0] + q[2] * b->s[1][j];
  return dim == 3 ? sum + q[3] * b->s[2][k] : sum;
}

/* From the inverse of M, whose upper half is that of `upper`. */
MPSI_INLINE void finish_fit(const mps_mpm *mpm, int dim, mpsi_quad upper[4][4], batch *b) {
  for (int r = 0; r <= dim; r++)
    for (int c = 0; c <= dim; c++) {
      const mpsi_quad q = r <= c ? upper[r][c] : upper[c][r];
      b->q[r][c] = r == 0 ? q : q * mpm->grid.inverse;
    }
}

/* ---- kept from the scatter to the gather ----------------------------------------------------- */

/* Of particles p, p + 1, ... of the block. */
MPSI_INLINE void keep_fit(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                          const batch *b, mpsi_quad q[4][4], int64_t p, int n) {
  const int64_t slot = cells->first_fit + (p - cells->begin);
  mpsi_quad all[12] = {{0.0}};
  mpsi_mask active = {0};
  int count = 0;
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++) all[count++] = q[r][c];
  for (int part = 0; part < count; part += 4) {
    mpsi_transpose(all + part);
    for (int l = 0; l < n; l++) mpsi_put(mpm->grid.fit[slot + l].q + part, all[part + l]);
  }
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++)
      for (int i = 0; i <= spline; i++) {
        const int node = 16 * k + 4 * j + i;
        active |= (b->w[node] != 0.0) & (int64_t)(UINT64_C(1) << node);
      }
  for (int l = 0; l < n; l++) {
    mpm->grid.fit[slot + l].active = (uint64_t)active[l];
    mpm->grid.fitted[slot + l] = MPSI_FITTED_CUT;
  }
}

/* Particles from number k of the chunk on, `n` of them, the first of which is particle p: as
 * make_batch has made them for the scatter. */
MPSI_INLINE void take_batch(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                            const mpsi_places *places, int k, int64_t p, int n, uint32_t held,
                            batch *out) {
  const int64_t slot = cells->first_fit + (p - cells->begin);
  mpsi_quad all[12], upper[4][4];
  mpsi_mask active = {0};
  int count = 0;
  out->held = held;
  place_batch(dim, spline, places, k, n, out);
  for (int part = 0; part < (dim == 2 ? 8 : 12); part += 4) {
    for (int l = 0; l < 4; l++)
      all[part + l] = mpsi_get(mpm->grid.fit[slot + (l < n ? l : 0)].q + part);
    mpsi_transpose(all + part);
  }
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++) upper[r][c] = all[count++];
  finish_fit(mpm, dim, upper, out);
  for (int l = 0; l < 4; l++) active[l] = (int64_t)mpm->grid.fit[slot + (l < n ? l : 0)].active;
  for (int z = 0; z <= (dim == 3 ? spline : 0); z++)
    for (int j = 0; j <= spline; j++) {
      mpsi_quad across = out->along[1][j];
      if (dim == 3) across *= out->along[2][z];
      for (int i = 0; i <= spline; i++) {
        const int node = 16 * z + 4 * j + i;
        const mpsi_mask there = (active & (int64_t)(UINT64_C(1) << node)) != 0;
        out->w[node] = (mpsi_quad)((mpsi_mask)(out->along[0][i] * across) & there);
      }
    }
}

MPSI_INLINE void make_batch(const mps_mpm *mpm, const mpsi_cell_block *cells,
                            const mpsi_worker *worker, int dim, int spline,
                            const mpsi_places *places, int k, int64_t p, int n, uint32_t held,
                            batch *out) {
  mpsi_quad upper[4][4];
  out->held = held;
  place_batch(dim, spline, places, k, n, out);
  find_active(mpm, cells, worker, dim, spline, out);
  moments(dim, spline, out, out->w, upper);
  invert(dim + 1, upper);
  keep_fit(mpm, cells, dim, spline, out, upper, p, n);
  finish_fit(mpm, dim, upper, out);
}

/* MPSI_IMPULSE where bodies hold nodes of a stencil; 0 where its particles are least_squares.c's.
 */
MPSI_INLINE uint32_t held_of(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int dim, int spline, int32_t first) {
  if (mpm->standard || mpm->by_weight || cells->thin || cells->first_fit < 0) return 0;
  const uint32_t state = mpsi_support_state(worker, dim, spline, first);
  return state & MPSI_PENALTY ? 0 : state & MPSI_IMPULSE;
}

/* ---- particles to nodes ---------------------------------------------------------------------- */

/* What the particles give to node i: its share w P_0 = phi of mass and momentum, and force by w:
 * all of these are linear functions of s, 1, s_x, s_y, s_z side by side. */
typedef struct source {
  mpsi_quad m;
  mpsi_quad momentum[3][4];  /* kg m/s, by phi; by component */
  mpsi_quad turn[3][3];      /* kg m2/s, by the derivative along each axis: see spin.h */
  mpsi_quad by_weight[3][4]; /* kg m/s, what `turn` gives, by w */
  mpsi_quad force[3][4];     /* N, by w */
} source;

/* V sigma and the forces by phi of particles [p, p + n), to what they give by w: grad phi of axis d
 * is w q[1 + d]. */
MPSI_INLINE void find_force(const mps_mpm *mpm, int dim, const batch *b, int64_t p, int n,
                            source *out) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const mpsi_columns *from = &mpm->p;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  const mpsi_quad V = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->V + p, n) & there);
  for (int a = 0; a < dim; a++) {
    mpsi_quad body = out->m * mpm->def.gravity[a];
    if (from->f[a]) body += (mpsi_quad)((mpsi_mask)mpsi_get_some(from->f[a] + p, n) & there);
    if (mpm->def.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC && a == 0)
      body -= V * mpsi_get_some(from->t[2] + p, n) / mpsi_get_some(from->x[0] + p, n);
    for (int c = 0; c <= dim; c++) out->force[a][c] = body * b->q[0][c];
    for (int d = 0; d < dim; d++) {
      const mpsi_quad stress = V * mpsi_get_some(from->t[symmetric[a][d]] + p, n);
      for (int c = 0; c <= dim; c++) out->force[a][c] -= stress * b->q[1 + d][c];
    }
  }
}

/* Lanes without a particle have no mass and no volume. */
MPSI_INLINE void find_source(const mps_mpm *mpm, int dim, const batch *b, int64_t p, int n,
                             source *out) {
  const mpsi_columns *from = &mpm->p;
  const mpsi_mask there = (mpsi_mask){0, 1, 2, 3} < n;
  out->m = (mpsi_quad)((mpsi_mask)mpsi_get_some(from->m + p, n) & there);
  const mpsi_quad mh = out->m * mpm->def.cell;
  for (int a = 0; a < dim; a++) {
    out->momentum[a][0] = out->m * mpsi_get_some(from->v[a] + p, n);
    for (int d = 0; d < dim; d++) {
      out->momentum[a][1 + d] = mh * mpsi_get_some(from->L[dim * a + d] + p, n);
      out->turn[a][d] = (mpsi_quad){0.0};
    }
  }
  find_force(mpm, dim, b, p, n, out);
}

/* sum phi s s^T. */
MPSI_INLINE void find_second(int dim, int spline, const batch *b, mpsi_quad K[3][3]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) K[r][c] = (mpsi_quad){0.0};
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const mpsi_quad value = across(dim, b, b->q[0], j, k), y = b->s[1][j];
      mpsi_quad one = {0.0}, by_x = {0.0};
      for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
        const mpsi_quad x = b->s[0][i], phi = b->w[n] * (value + b->q[0][1] * x);
        one += phi, by_x += phi * x, K[0][0] += phi * x * x;
      }
      K[0][1] += by_x * y, K[1][1] += one * y * y;
      if (dim == 2) continue;
      const mpsi_quad z = b->s[2][k];
      K[0][2] += by_x * z, K[1][2] += one * y * z, K[2][2] += one * z * z;
    }
  for (int r = 0; r < dim; r++)
    for (int c = 0; c < r; c++) K[r][c] = K[c][r];
}

/* Which lanes turn without giving by the derivative, and by how much about each axis: see
 * mpsi_give_spin. `lack` is what is missing of their moments. */
MPSI_INLINE mpsi_mask find_spin(int dim, double full, mpsi_quad K[3][3], const mpsi_quad *lack,
                                mpsi_quad *spin) {
  const mpsi_quad trace = dim == 2 ? K[0][0] + K[1][1] : K[0][0] + K[1][1] + K[2][2];
  mpsi_mask turns = trace > MPSI_LEAST_INERTIA * 2.0 * full;
  if (dim == 2) {
    spin[2] = lack[2] / trace;
    return turns;
  }
  mpsi_quad inertia[4][4];
  for (int a = 0; a < 3; a++)
    for (int c = a; c < 3; c++) inertia[a][c] = (a == c ? trace : (mpsi_quad){0.0}) - K[a][c];
  const mpsi_quad determinant = invert(3, inertia);
  turns &= determinant * 9.0 > MPSI_LEAST_INERTIA * 8.0 * full * trace * trace;
  for (int a = 0; a < 3; a++)
    spin[a] = inertia[a][0] * lack[0] + inertia[a][1] * lack[1] + inertia[a][2] * lack[2];
  return turns;
}

/* The rotation by which the particles give their moments. Returns whether some give it by the
 * derivative. */
MPSI_INLINE bool give_spin(const mps_mpm *mpm, int dim, int spline, const batch *b, source *s) {
  const double full = 1.0 / mpsi_inverse_moment(spline);
  mpsi_quad K[3][3], lack[3] = {{0.0}}, spin[3] = {{0.0}};
  find_second(dim, spline, b, K);
  for (int a = 0; a < dim; a++) {
    const int o = (a + 1) % 3, axis = (a + 2) % 3;
    if (o >= dim) continue;
    lack[axis] = full * (s->momentum[o][1 + a] - s->momentum[a][1 + o]);
    for (int d = 0; d < dim; d++)
      lack[axis] -= K[a][d] * s->momentum[o][1 + d] - K[o][d] * s->momentum[a][1 + d];
  }
  const mpsi_mask turns = find_spin(dim, full, K, lack, spin);
  for (int a = 0; a < dim; a++) {
    const int o = (a + 1) % 3, axis = (a + 2) % 3;
    if (o >= dim) continue;
    const mpsi_quad more = (mpsi_quad)((mpsi_mask)spin[axis] & turns);
    const mpsi_quad turn = (mpsi_quad)((mpsi_mask)(0.5 * mpm->def.cell * lack[axis]) & ~turns);
    s->momentum[o][1 + a] += more, s->momentum[a][1 + o] -= more;
    s->turn[o][a] = turn, s->turn[a][o] = -turn;
  }
  for (int a = 0; a < dim; a++)
    for (int c = 0; c <= dim; c++) {
      s->by_weight[a][c] = (mpsi_quad){0.0};
      for (int d = 0; d < dim; d++) s->by_weight[a][c] += s->turn[a][d] * b->q[1 + d][c];
    }
  return (turns[0] & turns[1] & turns[2] & turns[3]) == 0;
}

/* The same of one row of nodes along x, by particle: at s_x = 0, and by s_x. */
typedef struct row_source {
  mpsi_quad phi, momentum[3], by_weight[3], force[3];
} row_source;

MPSI_INLINE void find_row(int dim, const batch *b, const source *s, bool turns, int j, int k,
                          row_source *out) {
  out->phi = across(dim, b, b->q[0], j, k);
  for (int a = 0; a < dim; a++) {
    out->momentum[a] = across(dim, b, s->momentum[a], j, k);
    out->force[a] = across(dim, b, s->force[a], j, k);
    if (turns) out->by_weight[a] = across(dim, b, s->by_weight[a], j, k);
  }
}

/* Sums of a row: mass, momentum; mass by weights, force. The nodes side by side. */
MPSI_INLINE void add_row(int dim, const batch *b, const source *s, const row_source *row,
                         bool turns, int lanes, const mpsi_quad *w, mpsi_quad *sum,
                         mpsi_quad *force) {
  const mpsi_quad nodes = {0.0, 1.0, 2.0, 3.0};
  for (int l = 0; l < lanes; l++) {
    const mpsi_quad x = nodes + b->s[0][0][l];
    const mpsi_quad phi = w[l] * (row->phi[l] + b->q[0][1][l] * x);
    sum[0] += s->m[l] * phi;
    force[0] += s->m[l] * w[l];
    for (int a = 0; a < dim; a++) {
      sum[1 + a] += phi * (row->momentum[a][l] + s->momentum[a][1][l] * x);
      force[1 + a] += w[l] * (row->force[a][l] + s->force[a][1][l] * x);
      if (turns) sum[1 + a] += w[l] * (row->by_weight[a][l] + s->by_weight[a][1][l] * x);
    }
  }
  force[0] -= sum[0];
}

/* To the nodes: momentum to the tile, force and excess mass to the tile of forces. */
MPSI_INLINE void give_rows(const mpsi_worker *worker, int dim, int spline, const batch *b,
                           const source *s, bool turns, int lanes) {
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++) {
      const int t = mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k);
      mpsi_quad w[4] = {{0.0}}, sum[4] = {{0.0}}, force[4] = {{0.0}};
      row_source row;
      find_row(dim, b, s, turns, j, k, &row);
      for (int i = 0; i <= spline; i++) w[i] = b->w[16 * k + 4 * j + i];
      mpsi_transpose(w);
      add_row(dim, b, s, &row, turns, lanes, w, sum, force);
      mpsi_transpose(sum);
      mpsi_transpose(force);
      for (int i = 0; i <= spline; i++) {
        mpsi_put(worker->tile[t + i], mpsi_get(worker->tile[t + i]) + sum[i]);
        mpsi_put(worker->force[t + i], mpsi_get(worker->force[t + i]) + force[i]);
      }
    }
}

MPSI_INLINE void scatter(const mps_mpm *mpm, const mpsi_worker *worker, int dim, int spline,
                         const batch *b, int64_t p, int lanes) {
  source s;
  find_source(mpm, dim, b, p, lanes, &s);
  if (mpm->run.moments && mpsi_keeps_spin(mpm, b->held) && give_spin(mpm, dim, spline, b, &s))
    give_rows(worker, dim, spline, b, &s, true, lanes);
  else
    give_rows(worker, dim, spline, b, &s, false, lanes);
}

/* ---- nodes to particles ---------------------------------------------------------------------- */

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

/* Sums over the nodes, by component of their velocities. */
typedef struct node_sums {
  mpsi_quad by[3][4];     /* w by 1, s_x, s_y, s_z */
  mpsi_quad v[3];         /* phi, */
  mpsi_quad moment[3][3]; /* and that by s of the other axes */
} node_sums;

MPSI_INLINE void sum_row(int dim, int spline, const batch *b, const mpsi_node *node, int j, int k,
                         node_sums *out) {
  const mpsi_quad value = across(dim, b, b->q[0], j, k);
  mpsi_quad one[3] = {{0.0}}, by_x[3] = {{0.0}}, partition[3] = {{0.0}};
  for (int i = 0, n = 16 * k + 4 * j; i <= spline; i++, n++) {
    const mpsi_quad x = b->s[0][i], phi = value + b->q[0][1] * x;
    for (int a = 0; a < dim; a++) {
      const mpsi_quad v = b->w[n] * node[i][MPSI_VECTOR + a], by_phi = phi * v;
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

MPSI_INLINE void gather(const mps_mpm *mpm, const mpsi_worker *worker, int dim, int spline,
                        const batch *b, mpsi_gathered *out, int at) {
  node_sums sum = {.v = {{0.0}}};
  mpsi_quad L[3][3];
  for (int k = 0; k <= (dim == 3 ? spline : 0); k++)
    for (int j = 0; j <= spline; j++)
      sum_row(dim, spline, b,
              (const mpsi_node *)worker->tile +
                  mpsi_tile_index(b->at[0], b->at[1] + j, b->at[2] + k),
              j, k, &sum);
  for (int a = 0; a < dim; a++)
    for (int d = 0; d < dim; d++) {
      L[a][d] = b->q[1 + d][0] * sum.by[a][0];
      for (int c = 1; c <= dim; c++) L[a][d] += b->q[1 + d][c] * sum.by[a][c];
      mpsi_put(out->derivative[dim * a + d] + at, L[a][d]);
    }
  if (mpsi_keeps_spin(mpm, b->held)) take_spin(dim, spline, mpm->grid.inverse, sum.moment, L);
  for (int a = 0; a < dim; a++) {
    mpsi_put(out->v[a] + at, sum.v[a]);
    for (int d = 0; d < dim; d++) mpsi_put(out->slope[dim * a + d] + at, L[a][d]);
  }
}

/* ---- full supports --------------------------------------------------------------------------- */

/* Keeps the fit of particles p, p + 1, ... with a full support: see shape.h. */
MPSI_INLINE void keep_full(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim, int spline,
                           int64_t p, int particles) {
  const int64_t slot = cells->first_fit + (p - cells->begin);
  mpsi_kept_fit fit = {.q = {1.0}};
  int count = 0;
  for (int r = 0; r <= dim; r++)
    for (int c = r; c <= dim; c++, count++)
      if (r == c && r > 0) fit.q[count] = mpsi_inverse_moment(spline);
  MPSI_FOR_NODES(dim, spline) fit.active |= UINT64_C(1) << n;
  for (int l = 0; l < particles; l++) {
    mpm->grid.fit[slot + l] = fit;
    mpm->grid.fitted[slot + l] = MPSI_FITTED_FULL;
  }
}

/* Nodes in bodies cut no support where particles may use all of them. */
MPSI_INLINE bool find_full(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                           int dim, int spline, const mpsi_places *places, int64_t chunk, int begin,
                           int end) {
  if (!may_be_full(worker, dim, spline, places->first[begin])) return false;
  for (int k = begin; k < end; k += 4) {
    batch b;
    place_batch(dim, spline, places, k, end - k < 4 ? end - k : 4, &b);
    if (!is_full(mpm, cells, worker, dim, spline, &b)) return false;
  }
  keep_full(mpm, cells, dim, spline, chunk + begin, end - begin);
  return true;
}

MPSI_INLINE bool are_full(const mps_mpm *mpm, const mpsi_cell_block *cells, int64_t chunk,
                          int begin, int end) {
  const uint8_t *fitted = mpm->grid.fitted + cells->first_fit + (chunk - cells->begin);
  bool full = true;
  for (int k = begin; k < end; k++) full = full && fitted[k] == MPSI_FITTED_FULL;
  return full;
}

/* ---- segments -------------------------------------------------------------------------------- */

MPSI_INLINE mpsi_batched scatter_body(mps_mpm *mpm, const mpsi_cell_block *cells,
                                      const mpsi_worker *worker, int dim, int spline,
                                      const mpsi_places *places, int64_t chunk, int begin,
                                      int end) {
  const uint32_t held = held_of(mpm, cells, worker, dim, spline, places->first[begin]);
  if (!held) return MPSI_BATCHED_NOT;
  if (find_full(mpm, cells, worker, dim, spline, places, chunk, begin, end))
    return MPSI_BATCHED_FULL;
  for (int k = begin; k < end; k += 4) {
    const int n = end - k < 4 ? end - k : 4;
    batch b;
    make_batch(mpm, cells, worker, dim, spline, places, k, chunk + k, n, held, &b);
    scatter(mpm, worker, dim, spline, &b, chunk + k, n);
  }
  return MPSI_BATCHED;
}

MPSI_INLINE mpsi_batched gather_body(mps_mpm *mpm, const mpsi_cell_block *cells,
                                     const mpsi_worker *worker, int dim, int spline,
                                     const mpsi_places *places, int64_t chunk, int begin, int end,
                                     mpsi_gathered *out) {
  const uint32_t held = held_of(mpm, cells, worker, dim, spline, places->first[begin]);
  if (!held) return MPSI_BATCHED_NOT;
  if (are_full(mpm, cells, chunk, begin, end)) return MPSI_BATCHED_FULL;
  for (int k = begin; k < end; k += 4) {
    const int n = end - k < 4 ? end - k : 4;
    batch b;
    take_batch(mpm, cells, dim, spline, places, k, chunk + k, n, held, &b);
    gather(mpm, worker, dim, spline, &b, out, k);
  }
  return MPSI_BATCHED;
}

/* The body with dimension and spline as literal arguments. */
#define CHOOSE(body, ...)                                                                          \
  (mpm->dim == 2          ? mpm->def.spline == 2 ? body(mpm, cells, worker, 2, 2, __VA_ARGS__)     \
                                                 : body(mpm, cells, worker, 2, 3, __VA_ARGS__)     \
            : mpm->def.spline == 2 ? body(mpm, cells, worker, 3, 2, __VA_ARGS__)                   \
                          : body(mpm, cells, worker, 3, 3, __VA_ARGS__))

mpsi_batched MPSI_LEVELLED(mpsi_mpm_scatter_batches)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                                     const mpsi_worker *worker,
                                                     const mpsi_places *places, int64_t chunk,
                                                     int begin, int end) {
  return CHOOSE(scatter_body, places, chunk, begin, end);
}

mpsi_batched MPSI_LEVELLED(mpsi_mpm_gather_batches)(mps_mpm *mpm, const mpsi_cell_block *cells,
                                                    const mpsi_worker *worker,
                                                    const mpsi_places *places, int64_t chunk,
                                                    int begin, int end, mpsi_gathered *out) {
  return CHOOSE(gather_body, places, chunk, begin, end, out);
}
