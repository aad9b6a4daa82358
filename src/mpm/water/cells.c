/* cells.c - pressures of cells: sums over the particles of a cell, and their means.
 *
 * A cell's pressure is the mean over its particles of p + g.(x_c - x), each particle carrying its
 * own p and g = grad p; means are weighted by volumes. The particles of a block are summed into the
 * worker's tile first and then added to the cells, block by block in the order of their colours: on
 * several ranks the tiles of border blocks travel, and the cells have the bits of one rank.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cell_loops.h"
#include "layers.h"
#include "mpm/base/kernels.h"

#include <string.h>

/* ---- to the tile ----------------------------------------------------------------------------- */

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

/* To the tiles of the worker. */
static void sum_block(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, number);
  clear_region(work.cells, work.worker);
  mpm->kernels->pore_sum(&work);
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
  if (first) {
    cell->volume = sum[MPSI_PORE_VOLUME];
    cell->change = sum[MPSI_PORE_CHANGE];
    cell->p = sum[MPSI_PORE_PRESSURE];
    cell->n = sum[MPSI_PORE_POROSITY];
    cell->k = flow[MPSI_PORE_PERMEABILITY];
    for (int c = 0; c < 3; c++) cell->g[c] = flow[MPSI_PORE_SLOPE + c];
    return;
  }
  cell->volume += sum[MPSI_PORE_VOLUME];
  cell->change += sum[MPSI_PORE_CHANGE];
  cell->p += sum[MPSI_PORE_PRESSURE];
  cell->n += sum[MPSI_PORE_POROSITY];
  cell->k += flow[MPSI_PORE_PERMEABILITY];
  for (int c = 0; c < 3; c++) cell->g[c] += flow[MPSI_PORE_SLOPE + c];
}

static void add_row(mpsi_pore_cell *cell, uint64_t *filled, int local, int cells, mpsi_node *sum,
                    mpsi_node *flow) {
  for (int i = 0; i < cells; i++) {
    if (sum[i][MPSI_PORE_VOLUME] == 0.0) continue;
    const bool first = !mpsi_pore_marked(filled, local + i);
    mpsi_pore_mark(filled, local + i);
    add_to_cell(cell + i, first, sum[i], flow[i]);
  }
}

static void add_tile(const mpsi_grid *grid, mpsi_water *water, int64_t b,
                     const mpsi_worker *worker) {
  const mpsi_cell_block *cells = &grid->cells[b];
  int low[3], high[3];
  mpsi_pore_region(cells, low, high);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++)
      for (int i = low[0], end; i < high[0]; i = end) {
        const int32_t g = mpsi_block_under(cells, i, j, k);
        const int local = mpsi_local_under(i, j, k), at = mpsi_tile_index(i, j, k);
        end = i < MPSI_SIDE && high[0] > MPSI_SIDE ? MPSI_SIDE : high[0];
        add_row(water->cell + mpsi_first_node(grid, g) + local, water->block[g].filled, local,
                end - i, worker->tile + at, worker->force + at);
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
