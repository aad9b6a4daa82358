/* p2g.c - particles to nodes, Nakamura (23)-(25), (39), one block of cells at a time, for particles
 * with a full support or at one wall; the others go to fitted.c. Compiled once for each
 * instruction set.
 *
 * Consecutive particles with the same stencil, a segment, are summed in registers before they are
 * added to the tile: particles are sorted by their stencils, and nearly sorted ones do as well.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "wall.h"

/* What a particle gives to its nodes: w (part[0] + part[1] s_x + part[2] s_y + part[3] s_z). */
typedef struct parts {
  double sum[MPSI_CHUNK][4][4] __attribute__((aligned(64)));   /* mass, momentum */
  double force[MPSI_CHUNK][4][4] __attribute__((aligned(64))); /* 0, force: of split blocks */
} parts;

/* Rows of four columns to part `d` of particles k to k + 3. */
MPSI_INLINE void put(double (*part)[4][4], int k, int d, mpsi_quad m, mpsi_quad x, mpsi_quad y,
                     mpsi_quad z) {
  mpsi_quad a[4] = {m, x, y, z};
  mpsi_transpose(a);
  for (int i = 0; i < 4; i++) mpsi_put(part[k + i][d], a[i]);
}

/* With dt > 0 `sum` has dt times the force with the momentum; else (split) they are apart. */
MPSI_INLINE void find_parts(const mps_mpm *mpm, int geometry, int spline, bool split, int64_t begin,
                            int n, parts *out) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  const int dim = mpsi_dim_of(geometry);
  const mpsi_columns *p = &mpm->p;
  const double h = mpm->def.cell, stiff = -mpsi_inverse_moment(spline) * mpm->grid.inverse;
  const double dt = split ? 1.0 : mpm->run.dt;
  const mpsi_quad zero = {0.0};
  for (int k = 0; k < n; k += 4) {
    const int64_t at = begin + k;
    const mpsi_quad m = mpsi_get(p->m + at), V = dt * mpsi_get(p->V + at);
    mpsi_quad momentum[3] = {zero, zero, zero}, force[3] = {zero, zero, zero};
    for (int c = 0; c < dim; c++) {
      momentum[c] = m * mpsi_get(p->v[c] + at);
      force[c] = m * (dt * mpm->def.gravity[c]);
    }
    if (p->f[0])
      for (int c = 0; c < dim; c++) force[c] += dt * mpsi_get(p->f[c] + at);
    if (geometry == MPS_MPM_AXISYMMETRIC)
      force[0] -= V * mpsi_get(p->s[2] + at) / mpsi_get(p->x[0] + at);
    for (int c = 0; c < dim && !split; c++) momentum[c] += force[c];
    put(out->sum, k, 0, m, momentum[0], momentum[1], momentum[2]);
    if (split) put(out->force, k, 0, zero, force[0], force[1], force[2]);
    const mpsi_quad mh = m * h, Vs = V * stiff;
    for (int d = 0; d < dim; d++) {
      for (int c = 0; c < dim; c++) {
        momentum[c] = mh * mpsi_get(p->L[dim * c + d] + at);
        force[c] = Vs * mpsi_get(p->s[symmetric[c][d]] + at);
        if (!split) momentum[c] += force[c];
      }
      put(out->sum, k, 1 + d, zero, momentum[0], momentum[1], momentum[2]);
      if (split) put(out->force, k, 1 + d, zero, force[0], force[1], force[2]);
    }
  }
}

/* Adds particles [begin, end) of a chunk, all of one stencil, to a tile. What they give is spread
 * along x once, and from there to each row by that row's weights alone. */
MPSI_INLINE void add_segment(int dim, int spline, const mpsi_places *places, const mpsi_rows *rows,
                             int begin, int end, double (*part)[4][4], mpsi_node *tile) {
  mpsi_vec along[MPSI_SEGMENT][3][MPSI_ROW]; /* by w of y and z, by w s of y, by w s of z */
  for (int k = begin; k < end; k++) {
    mpsi_vec w[MPSI_ROW], ws[MPSI_ROW], a[4];
    mpsi_weights_along(spline, places, rows, k, w, ws);
    for (int d = 0; d <= dim; d++) a[d] = mpsi_spread(mpsi_get(part[k][d]));
    MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
      along[k - begin][0][v] = w[v] * a[0] + ws[v] * a[1];
      for (int d = 2; d <= dim; d++) along[k - begin][d - 1][v] = w[v] * a[d];
    }
  }
  tile += places->first[begin];
  for (int plane = 0; plane <= (dim == 3 ? spline : 0); plane++) {
    mpsi_vec sum[4][MPSI_ROW] = {{{0.0}}};
    for (int k = begin; k < end; k++) {
      MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
        mpsi_vec value = along[k - begin][0][v], slope = along[k - begin][1][v];
        if (dim == 3) {
          const double wz = places->w[1][plane][k], wzs = places->ws[1][plane][k];
          value = wz * value + wzs * along[k - begin][2][v];
          slope *= wz;
        }
        MPSI_UNROLL for (int j = 0; j <= spline; j++) {
          sum[j][v] += places->w[0][j][k] * value; /* apart: each is one fused operation */
          sum[j][v] += places->ws[0][j][k] * slope;
        }
      }
    }
    MPSI_UNROLL for (int j = 0; j <= spline; j++) {
      double *to = tile[mpsi_tile_index(0, j, plane)];
      MPSI_UNROLL for (int v = 0; v < MPSI_ROW; v++) {
        double *at = to + 4 * MPSI_WIDE * v;
        mpsi_put_row(at, mpsi_get_row(at) + sum[j][v]);
      }
    }
  }
}

/* The same where a wall across `axis` cuts the stencil: momentum to the tile, force and excess mass
 * (see mpsi_node) to the tile of forces. Weights of the derivatives differ across and along it. */
MPSI_INLINE void add_at_wall(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int geometry, int spline,
                             const mpsi_places *places, int axis, int64_t chunk, int begin,
                             int end) {
  const int dim = mpsi_dim_of(geometry), n = end - begin;
  mpsi_wall wall;
  parts part, other;
  find_parts(mpm, geometry, spline, true, chunk + begin, n, &part);
  mpsi_wall_places(mpm, cells, dim, spline, places, begin, end, axis, MPSI_WALL_VALUE, &wall);
  add_segment(dim, spline, &wall.places, &wall.rows, 0, n, part.sum, worker->tile);
  memset(other.force, 0, (size_t)n * sizeof *other.force);
  for (int k = 0; k < n; k++) {
    const double m = mpm->p.m[chunk + begin + k];
    other.force[k][0][MPSI_EXCESS] = m * wall.mass[k];
    for (int d = 0; d < dim; d++)
      if (d != axis) memcpy(other.force[k][1 + d], part.force[k][1 + d], sizeof(mpsi_node));
    for (int d = 0; d < dim; d++)
      if (d != axis) memset(part.force[k][1 + d], 0, sizeof(mpsi_node));
    part.force[k][0][MPSI_EXCESS] = -m;
  }
  mpsi_wall_places(mpm, cells, dim, spline, places, begin, end, axis, MPSI_WALL_SLOPE, &wall);
  add_segment(dim, spline, &wall.places, &wall.rows, 0, n, part.force, worker->force);
  mpsi_wall_places(mpm, cells, dim, spline, places, begin, end, axis, MPSI_WALL_ALONG, &wall);
  add_segment(dim, spline, &wall.places, &wall.rows, 0, n, other.force, worker->force);
}

MPSI_INLINE void clear(const mpsi_cell_block *cells, mpsi_node *tile) {
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++)
      for (int i = cells->low[0]; i < cells->high[0]; i++)
        mpsi_put(tile[mpsi_tile_index(i, j, k)], (mpsi_quad){0.0});
}

/* Adds the tile to one of the blocks of nodes under it. */
MPSI_INLINE void flush(const mps_mpm *mpm, const mpsi_cell_block *cells, int q,
                       const mpsi_worker *from) {
  const mpsi_node_block *nodes = &mpm->grid.nodes[cells->to[q]];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(mpm, cells->to[q]);
  mpsi_node *side = nodes->side >= 0 ? mpm->grid.side + mpsi_first_node(mpm, nodes->side) : NULL;
  int low[3], high[3];
  for (int c = 0; c < 3; c++) { /* of the tile */
    const int first = q >> c & 1 ? MPSI_SIDE : 0;
    low[c] = cells->low[c] > first ? cells->low[c] : first;
    high[c] = first || cells->high[c] < MPSI_SIDE ? cells->high[c] : MPSI_SIDE;
  }
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++) {
      const int t = mpsi_tile_index(0, j, k);
      const int to =
          ((k % MPSI_SIDE) * MPSI_SIDE + j % MPSI_SIDE) * MPSI_SIDE - (q & 1) * MPSI_SIDE;
      for (int i = low[0]; i < high[0]; i++) {
        mpsi_quad sum = mpsi_get(from->tile[t + i]);
        if (cells->apart) {
          mpsi_quad force = mpsi_get(from->force[t + i]);
          if (nodes->split) {
            mpsi_put(side[to + i], mpsi_get(side[to + i]) + force);
          } else {
            if (side) side[to + i][MPSI_EXCESS] += force[MPSI_EXCESS];
            force[MPSI_EXCESS] = 0.0;
            sum += mpm->run.dt * force;
          }
        }
        mpsi_put(node[to + i], mpsi_get(node[to + i]) + sum);
      }
    }
}

MPSI_INLINE void p2g_chunk(mps_mpm *mpm, const mpsi_cell_block *cells, const mpsi_worker *worker,
                           int geometry, int spline, int64_t begin, int n) {
  const int dim = mpsi_dim_of(geometry);
  mpsi_places places;
  parts part;
  mpsi_find_places(mpm, cells, dim, spline, begin, n, &places);
  if (cells->split)
    find_parts(mpm, geometry, spline, true, begin, n, &part);
  else
    find_parts(mpm, geometry, spline, false, begin, n, &part);
  for (int k = 0, end; k < n; k = end) {
    for (end = k + 1; end < n && end < k + MPSI_SEGMENT && places.first[end] == places.first[k];)
      end++;
    const uint32_t state =
        cells->cut ? mpsi_support_state(worker, dim, spline, places.first[k]) : 0;
    if (state != 0) {
      const int axis = mpsi_wall_axis(mpm, cells, dim, spline, state, places.first[k]);
      if (axis >= 0)
        add_at_wall(mpm, cells, worker, geometry, spline, &places, axis, begin, k, end);
      for (int f = k; f < end && axis < 0; f++)
        MPSI_LEVELLED(mpsi_scatter_fitted)(mpm, cells, worker, begin + f);
      continue;
    }
    add_segment(dim, spline, &places, NULL, k, end, part.sum, worker->tile);
    if (cells->split) add_segment(dim, spline, &places, NULL, k, end, part.force, worker->force);
  }
}

/* Asks the memory for the columns of a chunk. In the plane the few particles of a block end before
 * the processor has seen that it reads on, and the next block of the colour is elsewhere. */
MPSI_INLINE void prefetch_chunk(const mpsi_columns *p, int64_t begin, int64_t end) {
  for (int64_t k = begin; k < end && k < begin + MPSI_CHUNK; k += 8) {
    for (int c = 0; c < 2; c++) __builtin_prefetch(p->x[c] + k), __builtin_prefetch(p->v[c] + k);
    for (int c = 0; c < 4; c++) __builtin_prefetch(p->L[c] + k), __builtin_prefetch(p->s[c] + k);
    __builtin_prefetch(p->V + k);
    __builtin_prefetch(p->m + k);
  }
}

/* What the particles of a block give, into the tile. */
MPSI_INLINE void tile_body(mps_mpm *mpm, int64_t b, int32_t number, int geometry, int spline) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_worker *worker = &mpm->grid.workers[number];
  const int dim = mpsi_dim_of(geometry);
  for (int32_t q = 0; q < cells->pairs; q++) {
    mpsi_cell_pair *pair = &mpm->contact.cell_pair[cells->first_pair + q];
    pair->touched = false;
    pair->deepest = 0.0;
    memset(pair->load, 0, sizeof pair->load);
    memset(pair->contacts, 0, sizeof pair->contacts);
  }
  if (cells->cut) mpsi_mpm_find_states(mpm, cells, worker);
  if (cells->mirrors) mpsi_mpm_begin_mirrors(mpm, cells);
  clear(cells, worker->tile);
  if (cells->apart) clear(cells, worker->force);
  const mpsi_cell_block *next = dim == 2 && b + 2 < mpm->grid.cell_count ? cells + 2 : NULL;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int64_t rest = cells->end - k;
    if (next) prefetch_chunk(&mpm->p, next->begin + (k - cells->begin), next->end);
    p2g_chunk(mpm, cells, worker, geometry, spline, k, rest < MPSI_CHUNK ? (int)rest : MPSI_CHUNK);
  }
  if (cells->mirrors) mpsi_mpm_fold(mpm, cells, worker);
}

MPSI_INLINE void flush_body(mps_mpm *mpm, int64_t b, int32_t number, int dim) {
  for (int q = 0; q < 1 << dim; q++)
    flush(mpm, &mpm->grid.cells[b], q, &mpm->grid.workers[number]);
}

void MPSI_LEVELLED(mpsi_flush)(mps_mpm *mpm, int64_t b, int32_t worker) {
  flush_body(mpm, b, worker, mpm->dim);
}

#define DEFINE(g, s, geometry, spline)                                                             \
  static void tile_##g##_##s(mps_mpm *mpm, int64_t b, int32_t worker) {                            \
    tile_body(mpm, b, worker, geometry, spline);                                                   \
  }                                                                                                \
  static void p2g_##g##_##s(mps_mpm *mpm, int64_t b, int32_t worker) {                             \
    tile_##g##_##s(mpm, b, worker);                                                                \
    flush_body(mpm, b, worker, mpsi_dim_of(geometry));                                             \
  }
MPSI_VARIANTS(DEFINE)

#define TILE_ENTRY(g, s, geometry, spline) [geometry][spline - 2] = tile_##g##_##s,
const mpsi_mpm_task MPSI_LEVELLED(mpsi_tile)[3][2] = {MPSI_VARIANTS(TILE_ENTRY)};

#define ENTRY(g, s, geometry, spline) [geometry][spline - 2] = p2g_##g##_##s,
const mpsi_mpm_task MPSI_LEVELLED(mpsi_p2g)[3][2] = {MPSI_VARIANTS(ENTRY)};
