/* cells.c - pressures of cells: sums over the particles of a cell, and their means.
 *
 * A cell's pressure is the mean over its particles of p + g.(x_c - x), each particle carrying its
 * own p and g = grad p; means are weighted by volumes. The particles of a block are summed into the
 * worker's tile first and then added to the cells, block by block in the order of their colours: on
 * several ranks the tiles of border blocks travel, and the cells have the bits of one rank.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cell_loops.h"
#include "halo.h"
#include "mpm/base/kernels.h"
#include "mpm/ranks/messages.h"

#include <string.h>

#define FOLLOWS (1.0 / 32) /* of the rest of the way, in a step: as slopes of explicit ones do */

/* ---- to the tile ----------------------------------------------------------------------------- */

static void clear_region(const mpsi_grid *grid, const mpsi_cell_block *cells,
                         const mpsi_worker *worker) {
  int low[3], high[3];
  mpsi_pore_region(grid, cells, low, high);
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
  clear_region(work.grid, work.cells, work.worker);
  mpm->kernels->pore_sum(&work);
}

/* ---- between ranks --------------------------------------------------------------------------- */

static void copy_region(const mpsi_grid *grid, const mpsi_cell_block *cells,
                        const mpsi_worker *worker, double *message, bool to) {
  int low[3], high[3];
  mpsi_pore_region(grid, cells, low, high);
  message = mpsi_mpm_copy_nodes(low, high, worker->tile, sizeof(mpsi_node), message, to);
  mpsi_mpm_copy_nodes(low, high, worker->force, sizeof(mpsi_node), message, to);
}

static void pack(void *data, int64_t b, int32_t number, double *message) {
  const mps_mpm *mpm = data;
  sum_block(data, b, number);
  copy_region(&mpm->grid, &mpm->grid.cells[b], &mpm->grid.workers[number], message, true);
}

/* ---- to the cells ---------------------------------------------------------------------------- */

static void clear(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  memset(mpm->water->block[g].filled, 0, sizeof mpm->water->block[g].filled);
}

MPSI_INLINE void add_to_cell(mpsi_pore_cell *cell, bool first, const double *sum,
                             const double *flow) {
  cell->volume = sum[MPSI_PORE_VOLUME] + (first ? 0.0 : cell->volume);
  cell->change = sum[MPSI_PORE_CHANGE] + (first ? 0.0 : cell->change);
  cell->p = sum[MPSI_PORE_PRESSURE] + (first ? 0.0 : cell->p);
  cell->n = sum[MPSI_PORE_POROSITY] + (first ? 0.0 : cell->n);
  cell->k = flow[MPSI_PORE_PERMEABILITY] + (first ? 0.0 : cell->k);
  for (int c = 0; c < 3; c++) cell->g[c] = flow[MPSI_PORE_SLOPE + c] + (first ? 0.0 : cell->g[c]);
}

/* To cells of a row of block g, from number `local` on; marks those that have sums, of which some
 * may be zero. The first sums of a cell take the place of what it had in the last step. */
static void add_row(const mpsi_grid *grid, mpsi_water *water, int64_t g, int local, int cells,
                    const mpsi_node *sum, const mpsi_node *flow) {
  mpsi_pore_cell *cell = water->cell + mpsi_first_node(grid, g) + local;
  uint64_t *word = &water->block[g].filled[local >> 6];
  const uint64_t row = ((UINT64_C(1) << cells) - 1) << (local & 63), before = *word & row;
  *word |= row;
  if (before == 0)
    for (int i = 0; i < cells; i++) add_to_cell(cell + i, true, sum[i], flow[i]);
  else if (before == row)
    for (int i = 0; i < cells; i++) add_to_cell(cell + i, false, sum[i], flow[i]);
  else
    for (int i = 0; i < cells; i++)
      add_to_cell(cell + i, !(before >> ((local & 63) + i) & 1), sum[i], flow[i]);
}

static void add_tile(const mpsi_grid *grid, mpsi_water *water, int64_t b,
                     const mpsi_worker *worker) {
  const mpsi_cell_block *cells = &grid->cells[b];
  int low[3], high[3];
  mpsi_pore_region(grid, cells, low, high);
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++)
      for (int i = low[0], end; i < high[0]; i = end) {
        const int at = mpsi_tile_index(i, j, k);
        end = i < MPSI_SIDE && high[0] > MPSI_SIDE ? MPSI_SIDE : high[0];
        add_row(grid, water, mpsi_block_under(cells, i, j, k), mpsi_local_under(i, j, k), end - i,
                (const mpsi_node *)(worker->tile + at), (const mpsi_node *)(worker->force + at));
      }
}

static void add_block(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  double *message;
  if (!mpsi_mpm_find_message(mpm->partition, &mpm->grid.cells[b], &message)) return;
  if (message)
    copy_region(&mpm->grid, &mpm->grid.cells[b], &mpm->grid.workers[number], message, false);
  else
    sum_block(mpm, b, number);
  add_tile(&mpm->grid, mpm->water, b, &mpm->grid.workers[number]);
}

/* As if the cell were inside: faces.c sees to those that are not. */
static void find_mean(mpsi_water *water, mpsi_pore_cell *cell) {
  const double inverse = 1.0 / cell->volume;
  cell->p *= inverse;
  cell->n *= inverse;
  cell->k *= inverse;
  for (int c = 0; c < 3; c++) cell->g[c] *= inverse;
  cell->inside = true;
  cell->free = 0;
  cell->thin = false;
  if (!water->flows && !water->expecting) cell->now = cell->p + mpsi_pore_squeeze(water, cell);
}

static void find_means(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_pore_cell *cell = mpm->water->cell + mpsi_first_node(&mpm->grid, g);
  uint64_t *filled = mpm->water->block[g].filled;
  for (int w = 0; w < MPSI_PORE_WORDS; w++)
    for (uint64_t left = filled[w]; left; left &= left - 1) {
      const int k = 64 * w + mpsi_pore_lowest(left);
      if (cell[k].volume == 0.0)
        filled[w] &= ~(left & (~left + 1));
      else
        find_mean(mpm->water, &cell[k]);
    }
}

void mpsi_pore_find_cells(mps_mpm *mpm) {
  const mpsi_pass sums = {.data = mpm,
                          .clear = clear,
                          .scatter = add_block,
                          .update = find_means,
                          .ranks = mpm->partition,
                          .arrive = mpsi_mpm_receive_messages};
  if (mpm->partition)
    mpsi_mpm_send_messages(mpm->context, mpm->partition, "mps_mpm_step",
                           mpsi_pore_sum_doubles(mpm->water->halo), pack, mpm);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &sums);
  mpsi_pore_exchange(mpm, MPSI_PORE_FILLED);
}

/* ---- what cells do not expect ---------------------------------------------------------------- */

/* What particles have for their cells where pressures are implicit, besides pressure and porosity.
 * Before the motion that is V (u - slow), by which the cells are above the pressures of which P2G
 * has the forces. After the motion and the laws it is what the motion has taken of the volumes
 * besides what the pressures expected (flow.c). Where grains are drawn apart their volume V stays,
 * and the gap g (a volume strain, "opening") grows: water fills it, so that the motion changes V (1
 * + g). The filter of mean stresses (step/filter.c) changes V and g without a motion: what was not
 * expected is noted before it. */

static void find_ahead(void *data, int64_t b, int32_t worker) {
  const mps_mpm *mpm = data;
  const mpsi_columns *p = &mpm->p;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  double *rest = mpm->water->rest;
  for (int64_t k = cells->begin; k < cells->end; k++) rest[k] = p->V[k] * (p->u[k] - p->slow[k]);
}

void mpsi_pore_find_ahead(mps_mpm *mpm) {
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, find_ahead, mpm);
}

static void follow(void *data, int64_t b, int32_t worker) {
  const mps_mpm *mpm = data;
  const mpsi_columns *p = &mpm->p;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int64_t k = cells->begin; k < cells->end; k++)
    p->slow[k] += FOLLOWS * (p->u[k] - p->slow[k]);
}

void mpsi_pore_follow_means(mps_mpm *mpm) {
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, follow, mpm);
}

void mpsi_pore_begin_means(const mpsi_columns *p) {
  if (p->slow != p->u && p->count > 0) memcpy(p->slow, p->u, (size_t)p->count * sizeof *p->slow);
}

/* The gap of particle k, m3 at the volume V. */
static double gap_of(const mpsi_columns *p, int64_t k, double V) {
  const mpsi_law_use *law = mpsi_law_of(p, k);
  return law->opening < 0 ? 0.0 : V * law->history[law->opening][k];
}

void mpsi_pore_keep_volumes(mps_mpm *mpm, int64_t b) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_water *water = mpm->water;
  if (!mpsi_pore_predicts(mpm)) return;
  for (int64_t k = cells->begin; k < cells->end; k++) {
    water->former[k] = mpm->p.V[k];
    water->rest[k] += gap_of(&mpm->p, k, mpm->p.V[k]);
  }
}

/* V (1 + g) less what was expected of it; both gaps by the volume before the motion. */
static void note_rest(void *data, int64_t b, int32_t worker) {
  const mps_mpm *mpm = data;
  const mpsi_water *water = mpm->water;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  for (int64_t k = cells->begin; k < cells->end; k++)
    water->rest[k] = mpm->p.V[k] + gap_of(&mpm->p, k, water->former[k]) - water->rest[k];
}

void mpsi_pore_note_rest(mps_mpm *mpm) {
  if (!mpsi_pore_predicts(mpm) || mpm->water->noted) return;
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, note_rest, mpm);
  mpm->water->noted = true;
}
