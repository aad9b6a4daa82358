/* tiles.c - scatter of a step, and its tiles between ranks (ranks/partition.h): border blocks are
 * summed and sent, the interior is summed meanwhile, and then the tiles received are added to the
 * nodes.
 *
 * A message has flags of the block and then the part of the tile that is in use, that of the forces
 * where the block has them, both across thin bodies (thin_bodies.h), and those of penalty contact,
 * body by body (penalty.c). SPDX-License-Identifier: BSD-3-Clause */
#include "tiles.h"

#include "mpm/base/mpm_solver.h"
#include "mpm/ranks/messages.h"

/* The contents of tiles and the memory of a step depend on bodies, boundaries and blocks alone. */
bool mpsi_mpm_partition_unchanged(const mpsi_boundaries *boundaries, const mpsi_contacts *contacts,
                                  mpsi_partition *partition, const mpsi_settling *settling,
                                  const mpsi_run *run) {
  return partition->ready && !run->stale && !run->edited && !partition->outdated &&
         !boundaries->outdated && contacts->bodies == 0 && !settling->on &&
         !mpsi_mpm_absorbs(boundaries);
}

mps_status mpsi_mpm_agree_before_step(mps_mpm *mpm, const char *function, mps_status status) {
  mpsi_partition *partition = mpm->partition;
  enum { FORCES, ACROSS, SPRINGS, FOUND };
  double found[FOUND] = {0.0};
  if (status == MPS_OK)
    status = mpsi_mpm_reserve_messages(mpm->context, partition, function,
                                       mpsi_mpm_most_doubles(partition, &mpm->contact));
  for (int64_t k = 0; status == MPS_OK && k < partition->borders; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[partition->border[k]];
    if (cells->apart) found[FORCES] = 1.0;
    if (cells->thin) found[ACROSS] = 1.0;
    double penalty_bodies = 0.0;
    for (int32_t q = 0; q < cells->pairs; q++)
      penalty_bodies += mpsi_mpm_has_penalty(&mpm->contact, cells, q);
    found[SPRINGS] = fmax(found[SPRINGS], penalty_bodies);
  }
  status = mpsi_mpm_agree_in_step(mpm, function, status, FOUND, found);
  partition->ready = status == MPS_OK;
  partition->apart = found[FORCES] > 0.0;
  partition->thin = found[ACROSS] > 0.0;
  partition->penalty_bodies = (int32_t)found[SPRINGS];
  return status;
}

/* ---- messages -------------------------------------------------------------------------------- */

static double *copy_tile(const mpsi_cell_block *cells, mpsi_node *tile, double *message,
                         bool pack) {
  return mpsi_mpm_copy_nodes(cells->low, cells->high, tile, sizeof *tile, message, pack);
}

/* The tiles of a block, to or from its message. */
static void copy_tiles(const mpsi_transfer *work, double *message, bool pack) {
  const mpsi_cell_block *cells = work->cells;
  const mpsi_worker *worker = work->worker;
  message = copy_tile(cells, worker->tile, message, pack);
  if (cells->apart) message = copy_tile(cells, worker->force, message, pack);
  if (cells->thin) message = copy_tile(cells, worker->across_tile, message, pack);
  if (cells->thin && cells->apart) message = copy_tile(cells, worker->across_force, message, pack);
  for (int32_t q = 0; q < cells->pairs; q++)
    if (mpsi_mpm_has_penalty(work->contact, cells, q))
      message =
          mpsi_mpm_copy_nodes(cells->low, cells->high, mpsi_mpm_penalty_tile(work->grid, worker, q),
                              sizeof(mpsi_penalty_node), message, pack);
}

enum { APART = 1, SPLIT = 2, THIN = 4, IN_CONTACT = 8 };

static void pack(void *data, int64_t b, int32_t number, double *message) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, number);
  const mpsi_cell_block *cells = work.cells;
  mpsi_mpm_clear_penalty(work.grid, work.contact, cells, work.worker);
  mpm->kernels->tile[mpm->grid.geometry][mpm->grid.spline - 2](&work);
  *message = (cells->apart ? APART : 0) + (cells->split ? SPLIT : 0) + (cells->thin ? THIN : 0) +
             (cells->in_contact ? IN_CONTACT : 0);
  copy_tiles(&work, message + MPSI_TILE_FLAGS, true);
}

static void unpack(const mpsi_transfer *work, double *message) {
  mpsi_cell_block *cells = work->cells;
  const int flags = (int)*message;
  cells->apart = (flags & APART) != 0;
  cells->split = (flags & SPLIT) != 0;
  cells->thin = (flags & THIN) != 0;
  cells->in_contact = (flags & IN_CONTACT) != 0;
  copy_tiles(work, message + MPSI_TILE_FLAGS, false);
}

mps_status mpsi_mpm_send_tiles(mps_mpm *mpm, const char *function) {
  mpsi_partition *partition = mpm->partition;
  partition->lost = MPS_OK;
  mpsi_mpm_send_messages(mpm->context, partition, function,
                         mpsi_mpm_tile_doubles(partition, partition->apart, partition->thin,
                                               partition->penalty_bodies),
                         pack, mpm);
  return partition->lost;
}

/* ---- sums at the nodes ----------------------------------------------------------------------- */

void mpsi_step_scatter(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  const bool penalty = mpm->contact.penalty_bodies > 0;
  double *message;
  if (!mpsi_mpm_find_message(mpm->partition, work.cells, &message))
    return; /* the step has failed */
  if (message) {
    unpack(&work, message);
    mpm->kernels->flush(&work);
  } else {
    if (penalty) mpsi_mpm_clear_penalty(work.grid, work.contact, work.cells, work.worker);
    mpm->kernels->p2g[mpm->grid.geometry][mpm->grid.spline - 2](&work);
  }
  if (penalty) mpsi_mpm_add_penalty(work.grid, work.contact, work.cells, work.worker);
}
