/* cell_loops.c - the loops of the water over particles: their sums in the cells of a worker's tile,
 * and back to them what the cells of a block have. Compiled once for each instruction set.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cell_loops.h"

#include "mpm/base/loops.h"

#include <string.h>

/* ---- places ---------------------------------------------------------------------------------- */

/* The first node of a tile (cells), and the first and last of its cells that are in the domain. */
typedef struct region {
  double first[3];
  int low[3], last[3];
} region;

static region region_of(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  region out = {{0.0}, {0}, {0}};
  mpsi_pore_region(grid, cells, out.low, out.last);
  for (int c = 0; c < grid->dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
    const int64_t least = grid->low[c] - first, most = grid->high[c] - 1 - first;
    out.first[c] = (double)first;
    out.low[c] = least > out.low[c] ? (int)least : out.low[c];
    out.last[c] = most < out.last[c] - 1 ? (int)most : out.last[c] - 1;
  }
  return out;
}

/* Of the particles of a chunk: their cells in the tile, and how far they are from their centres. */
typedef struct places {
  double from[3][MPSI_COLUMN] MPSI_LINE; /* m, x less that of the centre */
  int32_t at[MPSI_COLUMN];
  double off[MPSI_COLUMN]; /* cells: farthest along an axis from the centre */
} places;

/* A particle that has left the domain is in the nearest cell. */
MPSI_INLINE void find_cells(const mpsi_grid *grid, const mpsi_columns *p, const region *in, int dim,
                            int64_t begin, int n, places *out) {
  int32_t *at = out->at;
  MPSI_UNROLL for (int c = 0; c < dim; c++) {
    const double *x = p->x[c] + begin, origin = grid->origin[c], inverse = grid->inverse;
    const double first = in->first[c], h = grid->cell;
    const int32_t low = in->low[c], last = in->last[c];
    const int32_t stride = c == 0 ? 1 : c == 1 ? MPSI_TILE_SIDE : MPSI_TILE_SIDE * MPSI_TILE_SIDE;
    double *from = out->from[c], *off = out->off;
    MPSI_SIMD for (int k = 0; k < n; k++) {
      const double X = (x[k] - origin) * inverse - first;
      int32_t cell = (int32_t)X; /* of negative ones the next above, which `low` raises */
      cell = cell < last ? cell : last;
      cell = cell > low ? cell : low;
      from[k] = x[k] - (origin + h * ((double)cell + (first + 0.5)));
      at[k] = c == 0 ? cell : at[k] + stride * cell;
      const double away = fabs(X - ((double)cell + 0.5));
      off[k] = c == 0 || away > off[k] ? away : off[k];
    }
  }
}

/* Cells that share a particle on a border between them, by equal parts, as in a mirror image: to
 * which of them it belonged round-off would decide. */
typedef struct shared {
  int count;
  int32_t at[8];
  double from[8][3]; /* m, x less that of each centre */
} shared;

static bool is_shared(const places *in, int k) { return in->off[k] > 0.5 - MPSI_ON_BORDER; }

static shared find_shared(const mpsi_grid *grid, const mpsi_columns *p, const region *in, int dim,
                          const places *of, int64_t begin, int k) {
  static const int32_t stride[3] = {1, MPSI_TILE_SIDE, MPSI_TILE_SIDE * MPSI_TILE_SIDE};
  shared out = {1, {of->at[k]}, {{0.0}}};
  for (int c = 0; c < dim; c++) out.from[0][c] = of->from[c][k];
  for (int c = 0; c < dim; c++) {
    const double X = mpsi_grid_at(grid, c, p->x[c][begin + k]) - in->first[c];
    const int cell = of->at[k] / stride[c] % MPSI_TILE_SIDE;
    const double away = X - ((double)cell + 0.5);
    const int other = away < 0.0 ? cell - 1 : cell + 1;
    if (fabs(away) <= 0.5 - MPSI_ON_BORDER || other < in->low[c] || other > in->last[c]) continue;
    for (int i = 0, before = out.count; i < before; i++) {
      const int new = out.count++;
      memcpy(out.from[new], out.from[i], sizeof out.from[i]);
      out.at[new] = out.at[i] + (other - cell) * stride[c];
      out.from[new][c] -= grid->cell * (double)(other - cell);
    }
  }
  return out;
}

/* ---- to the tile ----------------------------------------------------------------------------- */

/* Contributions of the particles of a chunk to their cells, as MPSI_PORE_VOLUME and so on. */
typedef struct sums {
  double part[8][MPSI_COLUMN] MPSI_LINE;
} sums;

MPSI_INLINE void find_sums(const mpsi_columns *p, const double *rest, const places *in, int dim,
                           int64_t begin, int n, sums *out) {
  const double *V = p->V + begin, *u = p->u + begin, *porosity = p->n + begin;
  const double *g0 = p->g[0] + begin, *g1 = p->g[1] + begin, *g2 = dim == 3 ? p->g[2] + begin : g1;
  MPSI_SIMD for (int k = 0; k < n; k++) {
    double there = u[k] - (g0[k] * in->from[0][k] + g1[k] * in->from[1][k]);
    if (dim == 3) there -= g2[k] * in->from[2][k];
    out->part[MPSI_PORE_VOLUME][k] = V[k];
    out->part[MPSI_PORE_PRESSURE][k] = V[k] * there;
    out->part[MPSI_PORE_POROSITY][k] = V[k] * porosity[k];
    out->part[4 + MPSI_PORE_SLOPE][k] = V[k] * g0[k];
    out->part[5 + MPSI_PORE_SLOPE][k] = V[k] * g1[k];
    out->part[6 + MPSI_PORE_SLOPE][k] = dim == 3 ? V[k] * g2[k] : 0.0;
  }
  for (int k = 0; k < n; k++) out->part[MPSI_PORE_CHANGE][k] = rest ? rest[begin + k] : 0.0;
  for (int k = 0; k < n; k++)
    out->part[4 + MPSI_PORE_PERMEABILITY][k] = p->k ? V[k] * p->k[begin + k] : 0.0;
}

MPSI_INLINE void add_sums(const places *in, int n, const sums *from, const mpsi_worker *worker) {
  for (int k = 0; k < n; k += 4) {
    mpsi_quad sum[4], flow[4];
    MPSI_UNROLL for (int c = 0; c < 4; c++) {
      sum[c] = mpsi_get(from->part[c] + k);
      flow[c] = mpsi_get(from->part[4 + c] + k);
    }
    mpsi_transpose(sum);
    mpsi_transpose(flow);
    MPSI_UNROLL for (int i = 0; i < 4; i++) {
      if (k + i >= n) break;
      double *to = worker->tile[in->at[k + i]], *flow_to = worker->force[in->at[k + i]];
      mpsi_put(to, mpsi_get(to) + sum[i]);
      mpsi_put(flow_to, mpsi_get(flow_to) + flow[i]);
    }
  }
}

/* The sums of the particles that several cells share, in place of what `part` has of them. */
MPSI_APART void share_sums(const mpsi_grid *grid, const mpsi_columns *p, const double *rest,
                           const region *in, int dim, const places *at, int64_t begin, int n,
                           const mpsi_worker *worker, sums *part) {
  for (int k = 0; k < n; k++) {
    if (!is_shared(at, k)) continue;
    const shared s = find_shared(grid, p, in, dim, at, begin, k);
    for (int c = 0; c < 8; c++) part->part[c][k] = 0.0;
    for (int i = 0; i < s.count; i++) {
      const int64_t own = begin + k;
      const double V = p->V[own] / s.count;
      double *to = worker->tile[s.at[i]], *flow = worker->force[s.at[i]], there = p->u[own];
      for (int c = 0; c < dim; c++) there -= p->g[c][own] * s.from[i][c];
      to[MPSI_PORE_VOLUME] += V;
      to[MPSI_PORE_CHANGE] += rest ? rest[own] / s.count : 0.0;
      to[MPSI_PORE_PRESSURE] += V * there;
      to[MPSI_PORE_POROSITY] += V * p->n[own];
      flow[MPSI_PORE_PERMEABILITY] += p->k ? V * p->k[own] : 0.0;
      for (int c = 0; c < dim; c++) flow[MPSI_PORE_SLOPE + c] += V * p->g[c][own];
    }
  }
}

MPSI_INLINE bool any_shared(const places *at, int n) {
  double most = 0.0;
  for (int k = 0; k < n; k++) most = at->off[k] > most ? at->off[k] : most;
  return most > 0.5 - MPSI_ON_BORDER;
}

/* v = 1/(1 - n) follows the volume. */
MPSI_INLINE void change_porosities(const mpsi_columns *p, const double *former, int64_t begin,
                                   int n) {
  double *porosity = p->n + begin;
  const double *V = p->V + begin;
  MPSI_SIMD for (int k = 0; k < n; k++) porosity[k] =
      1.0 - (1.0 - porosity[k]) * (former[k] / V[k]);
}

MPSI_INLINE void sum_body(const mpsi_grid *grid, const mpsi_columns *p, mpsi_water *water,
                          const mpsi_cell_block *cells, const mpsi_worker *worker, int dim) {
  const region in = region_of(grid, cells);
  const bool done = mpsi_pore_responds(water); /* pressures and porosities have followed volumes */
  const double *former = done ? p->V : water->former, *rest = done ? NULL : water->rest;
  places at;
  sums part;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    find_cells(grid, p, &in, dim, k, n, &at);
    find_sums(p, rest, &at, dim, k, n, &part);
    for (int i = 0; !done && i < n; i++) water->place[k + i] = (uint16_t)at.at[i];
    if (any_shared(&at, n)) share_sums(grid, p, rest, &in, dim, &at, k, n, worker, &part);
    add_sums(&at, n, &part, worker);
    if (done || water->expecting) continue;
    if (water->flows) mpsi_pore_change_permeability(p, water, former + k, k, k + n);
    change_porosities(p, former + k, k, n);
  }
}

void MPSI_LEVELLED(mpsi_pore_sum)(const mpsi_transfer *work) {
  if (work->grid->dim == 2)
    sum_body(work->grid, work->p, work->water, work->cells, work->worker, 2);
  else
    sum_body(work->grid, work->p, work->water, work->cells, work->worker, 3);
}

/* ---- undrained steps ------------------------------------------------------------------------- */

/* Sums of the particles with one stencil at its lowest node in a tile: of V before the laws and of
 * dV; then what n u grows by, Pa. */
enum { BEFORE, STRAIN, GROWTH };
typedef double pair __attribute__((vector_size(2 * sizeof(double)), aligned(8), may_alias));

/* That of the forces, which the scatter has done with, unless it has the velocities before the
 * forces (flip_time, g2p.c). */
MPSI_INLINE mpsi_node *strain_tile(const mpsi_transfer *work) {
  return work->keep > 0.0 ? work->worker->strain : work->worker->force;
}

/* Whether cell `at` (its lowest tile node) along axis c is in the domain and in the part of the
 * tile in use, as in step/volumetric.c. */
static bool has_place(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int at) {
  const int64_t node = (int64_t)cells->at[c] * MPSI_SIDE + at + 1;
  if (at < cells->low[c] || at >= cells->high[c]) return false;
  return grid->spline != 3 || (node >= grid->low[c] && node < grid->high[c]);
}

/* Cells of a particle that lies on borders between them, from mpsi_pore_place. */
static int find_places(const mpsi_grid *grid, const mpsi_cell_block *cells, uint16_t place,
                       int32_t *out) {
  int at[3], count = 1;
  int code = place / MPSI_PORE_PLACES;
  mpsi_unravel(place % MPSI_PORE_PLACES, MPSI_TILE_SIDE, at);
  out[0] = place % MPSI_PORE_PLACES;
  for (int c = 0, stride = 1; c < grid->dim; c++, code /= 3, stride *= MPSI_TILE_SIDE) {
    const int border = code % 3 == 2 ? -1 : code % 3;
    if (border == 0 || !has_place(grid, cells, c, at[c] + border)) continue;
    const bool inside = has_place(grid, cells, c, at[c]);
    for (int k = 0, before = count; k < before; k++) {
      const int32_t other = out[k] + border * stride;
      out[inside ? count++ : k] = other;
    }
  }
  return count;
}

void MPSI_LEVELLED(mpsi_pore_begin_block)(const mpsi_transfer *work) {
  const mpsi_cell_block *cells = work->cells;
  const size_t bytes = (size_t)(cells->high[0] - cells->low[0]) * sizeof(mpsi_node);
  mpsi_node *tile = strain_tile(work);
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++)
      memset(tile[mpsi_tile_index(cells->low[0], j, k)], 0, bytes);
}

void MPSI_LEVELLED(mpsi_pore_strain)(const mpsi_transfer *work, const double *former, int64_t begin,
                                     int n) {
  mpsi_node *tile = strain_tile(work);
  const uint16_t *place = work->water->place + begin;
  const double *V = work->p->V + begin;
  if (work->water->flows)
    mpsi_pore_change_permeability(work->p, work->water, former, begin, begin + n);
  change_porosities(work->p, former, begin, n);
  for (int k = 0; k < n; k++) {
    if (place[k] < MPSI_PORE_PLACES) {
      pair *to = (pair *)tile[place[k]];
      *to += (pair){former[k], V[k] - former[k]};
      continue;
    }
    int32_t at[8];
    const int count = find_places(work->grid, work->cells, place[k], at);
    for (int i = 0; i < count; i++)
      *(pair *)tile[at[i]] += (pair){former[k] / count, (V[k] - former[k]) / count};
  }
}

void MPSI_LEVELLED(mpsi_pore_respond)(const mpsi_transfer *work) {
  const mpsi_cell_block *cells = work->cells;
  mpsi_node *tile = strain_tile(work);
  const double bulk = work->water->def.bulk;
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++)
      for (int i = cells->low[0]; i < cells->high[0]; i++) {
        double *at = tile[mpsi_tile_index(i, j, k)];
        at[GROWTH] = at[BEFORE] > 0.0 ? -bulk * (at[STRAIN] / at[BEFORE]) : 0.0;
      }
  for (int64_t begin = cells->begin; begin < cells->end; begin += MPSI_CHUNK) {
    const int n = cells->end - begin < MPSI_CHUNK ? (int)(cells->end - begin) : MPSI_CHUNK;
    const uint16_t *place = work->water->place + begin;
    double *u = work->p->u + begin, growth[MPSI_CHUNK];
    const double *porosity = work->p->n + begin;
    for (int k = 0; k < n; k++) {
      if (place[k] < MPSI_PORE_PLACES) {
        growth[k] = tile[place[k]][GROWTH];
        continue;
      }
      int32_t at[8];
      const int count = find_places(work->grid, work->cells, place[k], at);
      growth[k] = 0.0;
      for (int i = 0; i < count; i++) growth[k] += tile[at[i]][GROWTH] / count;
    }
    MPSI_SIMD for (int k = 0; k < n; k++) u[k] += growth[k] / porosity[k];
  }
}

/* ---- to the particles ------------------------------------------------------------------------ */

/* What the particles of a chunk take from their cells. */
typedef struct taken {
  double p[MPSI_COLUMN] MPSI_LINE, g[3][MPSI_COLUMN], gain[MPSI_COLUMN], more[MPSI_COLUMN];
} taken;

MPSI_INLINE void take_cells(const places *in, int n, const mpsi_worker *worker, bool flows,
                            bool expecting, taken *out) {
  for (int k = 0; k < n; k += 4) {
    mpsi_quad a[4];
    MPSI_UNROLL for (int i = 0; i < 4; i++) a[i] =
        mpsi_get(worker->tile[in->at[k + i < n ? k + i : n - 1]]);
    mpsi_transpose(a);
    mpsi_put(out->p + k, a[0]);
    MPSI_UNROLL for (int c = 0; c < 3; c++) mpsi_put(out->g[c] + k, a[1 + c]);
  }
  for (int k = 0; flows && k < n; k++) out->gain[k] = worker->force[in->at[k]][0];
  for (int k = 0; expecting && k < n; k++) out->more[k] = worker->force[in->at[k]][1];
}

MPSI_INLINE void give_pressures(const mpsi_columns *p, const places *in, const taken *from, int dim,
                                int64_t begin, int n) {
  double *u = p->u + begin, *g0 = p->g[0] + begin, *g1 = p->g[1] + begin;
  double *g2 = dim == 3 ? p->g[2] + begin : NULL;
  MPSI_SIMD for (int k = 0; k < n; k++) {
    double now = from->p[k] + (from->g[0][k] * in->from[0][k] + from->g[1][k] * in->from[1][k]);
    if (dim == 3) now += from->g[2][k] * in->from[2][k];
    u[k] = now;
    g0[k] = from->g[0][k];
    g1[k] = from->g[1][k];
    if (dim == 3) g2[k] = from->g[2][k];
  }
}

/* What the particles that several cells share take: the mean. */
MPSI_APART void take_shared(const mpsi_transfer *work, const region *in, int dim, const places *at,
                            int64_t begin, int n, taken *from) {
  const mpsi_columns *p = work->p;
  for (int k = 0; k < n; k++) {
    if (!is_shared(at, k)) continue;
    const shared s = find_shared(work->grid, p, in, dim, at, begin, k);
    double u = 0.0, g[3] = {0.0}, gain = 0.0, more = 0.0;
    for (int i = 0; i < s.count; i++) {
      const double *tile = work->worker->tile[s.at[i]], *flow = work->worker->force[s.at[i]];
      u += tile[0], gain += flow[0], more += flow[1];
      for (int c = 0; c < dim; c++) u += tile[1 + c] * s.from[i][c], g[c] += tile[1 + c];
    }
    p->u[begin + k] = u / s.count;
    for (int c = 0; c < dim; c++) p->g[c][begin + k] = g[c] / s.count;
    from->gain[k] = gain / s.count, from->more[k] = more / s.count;
  }
}

MPSI_INLINE void give_body(const mpsi_transfer *work, int dim) {
  const mpsi_columns *p = work->p;
  const mpsi_cell_block *cells = work->cells;
  const mpsi_grid *grid = work->grid;
  const region in = region_of(grid, cells);
  const bool flows = work->water->flows, expecting = work->water->expecting;
  places at;
  taken from;
  for (int64_t k = cells->begin; k < cells->end; k += MPSI_CHUNK) {
    const int n = cells->end - k < MPSI_CHUNK ? (int)(cells->end - k) : MPSI_CHUNK;
    find_cells(grid, p, &in, dim, k, n, &at);
    take_cells(&at, n, work->worker, flows, expecting, &from);
    give_pressures(p, &at, &from, dim, k, n);
    if (any_shared(&at, n)) take_shared(work, &in, dim, &at, k, n, &from);
    if (expecting) {
      double *after = work->water->rest + k;
      const double *V = p->V + k;
      MPSI_SIMD for (int i = 0; i < n; i++) after[i] = V[i] * (1.0 + from.more[i]);
    }
    if (flows) {
      double *m = p->m + k;
      const double *V = p->V + k;
      MPSI_SIMD for (int i = 0; i < n; i++) m[i] += from.gain[i] * V[i];
      mpsi_pore_give_flow(work, k, k + n);
    }
  }
}

void MPSI_LEVELLED(mpsi_pore_give)(const mpsi_transfer *work) {
  if (work->grid->dim == 2)
    give_body(work, 2);
  else
    give_body(work, 3);
}
