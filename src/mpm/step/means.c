/* means.c - see means.h. Blocks of one colour have no nodes in common, and add in the order of
 * their colours: no sum depends on the number of threads or ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "means.h"

#include "mpm/ranks/parcels.h"
#include "tiles.h"

#include <string.h>

void mpsi_clear_sums(const mpsi_grid *grid, int64_t b, int32_t number) {
  const mpsi_cell_block *cells = &grid->cells[b];
  const mpsi_worker *worker = &grid->workers[number];
  const size_t bytes = (size_t)(cells->high[0] - cells->low[0]) * sizeof(mpsi_node);
  for (int across = 0; across < (cells->thin ? 2 : 1); across++)
    for (int k = cells->low[2]; k < cells->high[2]; k++)
      for (int j = cells->low[1]; j < cells->high[1]; j++)
        memset(mpsi_sums_at(grid, cells, worker, across != 0, cells->low[0], j, k), 0, bytes);
}

static void add_tile(const mpsi_grid *grid, const mpsi_cell_block *cells, const mpsi_worker *worker,
                     bool across) {
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++)
      for (int i = cells->low[0]; i < cells->high[0]; i++) {
        const double *from = mpsi_sums_at(grid, cells, worker, across, i, j, k);
        if (from[MPSI_SUM_VOLUME] == 0.0) continue;
        double *to = mpsi_sums_at(grid, cells, NULL, across, i, j, k);
        for (int c = 0; c < MPSI_SUMS; c++) to[c] += from[c];
      }
}

void mpsi_add_sums(mps_mpm *mpm, int64_t b, int32_t number, mpsi_mpm_task sum) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  if (!mpm->partition)
    sum(mpm, b, number);
  else if (!mpsi_mpm_receive_sums(&mpm->grid, mpm->partition, b, number, sum, mpm))
    return;
  for (int across = 0; across < (cells->thin ? 2 : 1); across++)
    add_tile(&mpm->grid, cells, &mpm->grid.workers[number], across != 0);
}

void mpsi_run_sums(mps_mpm *mpm, mpsi_mpm_task sum, mpsi_mpm_task add, mpsi_mpm_task gather) {
  const mpsi_pass pass = {.data = mpm,
                          .clear = mpsi_mpm_clear_nodes,
                          .scatter = add,
                          .gather = gather,
                          .arrive = mpm->partition ? mpsi_step_receive_parcels : NULL};
  if (mpm->partition) mpsi_mpm_send_sums(mpm->context, &mpm->grid, mpm->partition, sum, mpm);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
}

static bool on_any_rank(mpsi_partition *partition, bool failed) {
  if (!partition || partition->lost != MPS_OK) return failed;
  partition->lost = mpsi_mpm_any_rank(partition, "mps_mpm_step", &failed);
  return failed || partition->lost != MPS_OK;
}

bool mpsi_any_failed(const mpsi_grid *grid, mpsi_partition *partition) {
  bool failed = false;
  for (int64_t b = 0; b < grid->cell_count; b++)
    failed = failed || (grid->cells[b].bad >= 0 && !grid->cells[b].lost);
  return on_any_rank(partition, failed);
}

bool mpsi_any_refused(const mpsi_columns *p, mpsi_partition *partition) {
  return on_any_rank(partition, p->laws.refusal.cells != NULL);
}
