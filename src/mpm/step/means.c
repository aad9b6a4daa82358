/* means.c - see means.h. Blocks of one colour have no nodes in common, and add in the order of
 * their colours: no sum depends on the number of threads or ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "means.h"

#include "mpm/ranks/messages.h"

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

/* The part of the worker's tiles in use, to or from a message. */
static void copy_tiles(const mpsi_cell_block *cells, const mpsi_worker *worker, double *message,
                       bool pack) {
  message =
      mpsi_mpm_copy_nodes(cells->low, cells->high, worker->tile, sizeof(mpsi_node), message, pack);
  if (cells->thin)
    mpsi_mpm_copy_nodes(cells->low, cells->high, worker->across_tile, sizeof(mpsi_node), message,
                        pack);
}

void mpsi_add_sums(mps_mpm *mpm, int64_t b, int32_t number, mpsi_mpm_task sum) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  double *message;
  if (!mpsi_mpm_find_message(mpm->partition, cells, &message)) return;
  if (message)
    copy_tiles(cells, &mpm->grid.workers[number], message, false);
  else
    sum(mpm, b, number);
  for (int across = 0; across < (cells->thin ? 2 : 1); across++)
    add_tile(&mpm->grid, cells, &mpm->grid.workers[number], across != 0);
}

typedef struct sums {
  mps_mpm *mpm;
  mpsi_mpm_task sum;
} sums;

static void pack(void *data, int64_t b, int32_t number, double *message) {
  const sums *s = data;
  s->sum(s->mpm, b, number);
  copy_tiles(&s->mpm->grid.cells[b], &s->mpm->grid.workers[number], message, true);
}

void mpsi_run_sums(mps_mpm *mpm, mpsi_mpm_task sum, mpsi_mpm_task add, mpsi_mpm_task gather) {
  const mpsi_pass pass = {.data = mpm,
                          .clear = mpsi_mpm_clear_nodes,
                          .scatter = add,
                          .gather = gather,
                          .ranks = mpm->partition,
                          .arrive = mpsi_mpm_receive_messages};
  sums s = {mpm, sum};
  if (mpm->partition)
    mpsi_mpm_send_messages(mpm->context, mpm->partition, "mps_mpm_step",
                           mpsi_mpm_tile_doubles(mpm->partition, false, mpm->partition->thin, 0),
                           pack, &s);
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
