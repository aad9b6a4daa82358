/* cells.c - pressures of cells: sums over the particles of a cell, and their means.
 *
 * A cell's pressure is the mean over its particles of p + g.(x_c - x), each particle carrying its
 * own p and g = grad p; means are weighted by volumes. The particles of a block are summed into the
 * worker's tile first and then added to the cells, block by block in the order of their colours: on
 * several ranks the tiles of border blocks travel, and the cells have the bits of one rank.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"
#include "water.h"

#include <string.h>

/* ---- to the tile ----------------------------------------------------------------------------- */

/* Values of a cell in the worker's two tiles: sums over its particles of V, dV, V p, V n; V k and
 * V g. */
enum { VOLUME, CHANGE, PRESSURE, POROSITY };
enum { PERMEABILITY, SLOPE };

static void clear_region(const mpsi_cell_block *cells, const mpsi_worker *worker) {
  int low[3], high[3];
  mpsi_pore_region(cells, low, high);
  const size_t bytes = (size_t)(high[0] - low[0]) * sizeof(mpsi_node);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++) {
      memset(worker->tile[mpsi_tile_index(low[0], j, k)], 0, bytes);
      memset(worker->force[mpsi_tile_index(low[0], j, k)], 0, bytes);
    }
}

/* The first node of a tile, and the first and last of its cells, or those of the domain. */
typedef struct region {
  double first[3];
  int low[3], last[3];
} region;

static region region_of(const mpsi_grid *grid, const mpsi_cell_block *cells) {
  region out = {{0.0}, {0}, {0}};
  mpsi_pore_region(cells, out.low, out.last);
  for (int c = 0; c < grid->dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE, most = grid->high[c] - 1 - first;
    out.first[c] = (double)first;
    out.last[c] = most < out.last[c] - 1 ? (int)most : out.last[c] - 1;
  }
  return out;
}

/* The cell of a particle in the tile. One that has left the domain is in the nearest. */
MPSI_INLINE int find_place(const mpsi_grid *grid, const mpsi_columns *p, const region *in, int dim,
                           int64_t particle) {
  int place = 0;
  for (int c = 0, stride = 1; c < dim; c++, stride *= MPSI_TILE_SIDE) {
    const double X = mpsi_grid_at(grid, c, p->x[c][particle]) - in->first[c];
    int cell = X > 0.0 ? (int)X : 0; /* without a call of floor */
    cell = cell < in->last[c] ? cell : in->last[c];
    cell = cell > in->low[c] ? cell : in->low[c];
    place += stride * cell;
  }
  return place;
}

/* Particles of a stencil are neighbours: those in a row that are in the same cell are summed before
 * they are added to it. */
MPSI_INLINE void sum_body(const mpsi_grid *grid, const mpsi_columns *p, mpsi_water *water,
                          int64_t b, const mpsi_worker *worker, int dim) {
  const mpsi_cell_block *cells = &grid->cells[b];
  const double *former = water->former;
  uint16_t *place = water->place;
  const region in = region_of(grid, cells);
  clear_region(cells, worker);
  for (int64_t k = cells->begin; k < cells->end; k++)
    place[k] = (uint16_t)find_place(grid, p, &in, dim, k);
  for (int64_t k = cells->begin; k < cells->end;) {
    const int at = place[k];
    double centre[3], sum[4] = {0.0}, flow[4] = {0.0};
    (void)mpsi_pore_cell_at(grid, water, cells, at, centre);
    for (; k < cells->end && place[k] == at; k++) {
      const double V = p->V[k];
      double there = p->u[k];
      for (int c = 0; c < dim; c++) {
        there += p->g[c][k] * (centre[c] - p->x[c][k]);
        flow[SLOPE + c] += V * p->g[c][k];
      }
      sum[VOLUME] += V;
      sum[CHANGE] += V - former[k];
      sum[PRESSURE] += V * there;
      sum[POROSITY] += V * p->n[k];
      if (p->k) flow[PERMEABILITY] += V * p->k[k];
    }
    for (int c = 0; c < 4; c++) {
      worker->tile[at][c] += sum[c];
      worker->force[at][c] += flow[c];
    }
  }
}

/* To the tiles of the worker. */
static void sum_block(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_worker *worker = &mpm->grid.workers[number];
  if (mpm->grid.dim == 2)
    sum_body(&mpm->grid, &mpm->p, mpm->water, b, worker, 2);
  else
    sum_body(&mpm->grid, &mpm->p, mpm->water, b, worker, 3);
}

/* ---- to the cells ---------------------------------------------------------------------------- */

static void clear(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  uint64_t *filled = mpm->water->block[g].filled;
  (void)worker;
  memset(filled, 0, sizeof mpm->water->block[g].filled);
}

/* The first sums of a cell take the place of what it had in the last step. */
static void add_to_cell(mpsi_pore_cell *cell, bool first, const double *sum, const double *flow) {
  cell->volume = (first ? 0.0 : cell->volume) + sum[VOLUME];
  cell->change = (first ? 0.0 : cell->change) + sum[CHANGE];
  cell->p = (first ? 0.0 : cell->p) + sum[PRESSURE];
  cell->n = (first ? 0.0 : cell->n) + sum[POROSITY];
  cell->k = (first ? 0.0 : cell->k) + flow[PERMEABILITY];
  for (int c = 0; c < 3; c++) cell->g[c] = (first ? 0.0 : cell->g[c]) + flow[SLOPE + c];
}

static void add_tile(const mpsi_grid *grid, mpsi_water *water, int64_t b,
                     const mpsi_worker *worker) {
  const mpsi_cell_block *cells = &grid->cells[b];
  int low[3], high[3];
  mpsi_pore_region(cells, low, high);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++)
      for (int i = low[0]; i < high[0]; i++) {
        const int at = mpsi_tile_index(i, j, k);
        if (worker->tile[at][VOLUME] == 0.0) continue;
        const int32_t g = mpsi_block_under(cells, i, j, k);
        const int local = mpsi_local_under(i, j, k);
        const bool first = !mpsi_pore_marked(water->block[g].filled, local);
        mpsi_pore_mark(water->block[g].filled, local);
        add_to_cell(water->cell + mpsi_first_node(grid, g) + local, first, worker->tile[at],
                    worker->force[at]);
      }
}

static void add_block(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  if (mpm->grid.cells[b].parcel < 0 || !mpm->partition)
    sum_block(mpm, b, number);
  else if (!mpsi_pore_take_parcel(mpm, b, number))
    return;
  add_tile(&mpm->grid, mpm->water, b, &mpm->grid.workers[number]);
}

static void find_means(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  (void)worker;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_marked(mpm->water->block[g].filled, k)) continue;
    const double inverse = 1.0 / cell[k].volume;
    cell[k].p *= inverse;
    cell[k].n *= inverse;
    cell[k].k *= inverse;
    for (int c = 0; c < mpm->grid.dim; c++) cell[k].g[c] *= inverse;
  }
}

void mpsi_pore_find_cells(mps_mpm *mpm) {
  const mpsi_pass sums = {.data = mpm,
                          .clear = clear,
                          .scatter = add_block,
                          .update = find_means,
                          .arrive = mpm->partition ? mpsi_pore_receive_parcels : NULL};
  if (mpm->partition) mpsi_pore_send_parcels(mpm, sum_block);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &sums);
  mpsi_pore_exchange(mpm, MPSI_PORE_FILLED);
}
