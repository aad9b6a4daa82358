/* tiles.c - tiles between ranks (ranks/partition.h): border blocks are summed and sent, the
 * interior is summed meanwhile, and then the tiles received are added to the nodes.
 *
 * A parcel has four numbers (whether its forces are apart, whether they are split, whether thin
 * bodies separate its nodes, whether it has contact constraints) and then the part of the tile that
 * is in use, that of the forces where some tile of the step has them, both across thin bodies
 * (thin_bodies.h) where some tile has these, and those of penalty contact, body by body
 * (penalty.c). SPDX-License-Identifier: BSD-3-Clause */
#include "tiles.h"

#include "mpm/base/mpm_solver.h"
#include "mpm/ranks/parcels.h"

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
  enum { APART, THIN, SPRINGS, FOUND };
  double found[FOUND] = {0.0};
  if (status == MPS_OK)
    status = mpsi_mpm_reserve_parcels(mpm->context, &mpm->contact, mpm->partition, function);
  for (int64_t k = 0; status == MPS_OK && k < partition->borders; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[partition->border[k]];
    if (cells->apart) found[APART] = 1.0;
    if (cells->thin) found[THIN] = 1.0;
    double penalty_bodies = 0.0;
    for (int32_t q = 0; q < cells->pairs; q++)
      penalty_bodies += mpsi_mpm_has_penalty(&mpm->contact, cells, q);
    found[SPRINGS] = fmax(found[SPRINGS], penalty_bodies);
  }
  status = mpsi_mpm_agree_in_step(mpm, function, status, FOUND, found);
  partition->ready = status == MPS_OK;
  partition->apart = found[APART] > 0.0;
  partition->thin = found[THIN] > 0.0;
  partition->penalty_bodies = (int32_t)found[SPRINGS];
  return status;
}

/* ---- packing --------------------------------------------------------------------------------- */

static double *copy_tile(const mpsi_cell_block *cells, mpsi_node *tile, double *parcel, bool pack) {
  return mpsi_mpm_copy_nodes(cells, tile, sizeof *tile, parcel, pack);
}

/* Copies the tiles of momenta, those of forces where they are apart, and both across thin bodies,
 * to or from a parcel. */
static double *copy_tiles(const mpsi_cell_block *cells, const mpsi_worker *worker, double *parcel,
                          bool pack) {
  parcel = copy_tile(cells, worker->tile, parcel, pack);
  if (cells->apart) parcel = copy_tile(cells, worker->force, parcel, pack);
  if (!cells->thin) return parcel;
  parcel = copy_tile(cells, worker->across_tile, parcel, pack);
  if (cells->apart) parcel = copy_tile(cells, worker->across_force, parcel, pack);
  return parcel;
}

static void copy_penalty_tiles(const mpsi_grid *grid, const mpsi_contacts *contacts,
                               const mpsi_cell_block *cells, const mpsi_worker *worker,
                               double *parcel, bool pack) {
  for (int32_t q = 0; q < cells->pairs; q++)
    if (mpsi_mpm_has_penalty(contacts, cells, q))
      parcel = mpsi_mpm_copy_nodes(cells, mpsi_mpm_penalty_tile(grid, worker, q),
                                   sizeof(mpsi_penalty_node), parcel, pack);
}

static void pack(void *data, int64_t k, int32_t number) {
  mps_mpm *mpm = data;
  mpsi_partition *partition = mpm->partition;
  const mpsi_transfer work = mpsi_transfer_of(mpm, partition->border[k], number);
  const mpsi_worker *worker = work.worker;
  const mpsi_cell_block *cells = work.cells;
  double *parcel = mpsi_mpm_parcel(partition, false, k);
  mpsi_mpm_clear_penalty(&mpm->grid, &mpm->contact, cells, worker);
  mpm->kernels->tile[mpm->grid.geometry][mpm->grid.spline - 2](&work);
  parcel[0] = cells->apart;
  parcel[1] = cells->split;
  parcel[2] = cells->thin;
  parcel[3] = cells->in_contact;
  parcel = copy_tiles(cells, worker, parcel + MPSI_PARCEL_HEAD, true);
  copy_penalty_tiles(&mpm->grid, &mpm->contact, cells, worker, parcel, true);
}

mps_status mpsi_mpm_send_tiles(mps_mpm *mpm, const char *function) {
  mpsi_partition *partition = mpm->partition;
  partition->item = mpsi_mpm_parcel_bytes(partition, partition->apart, partition->thin,
                                          partition->penalty_bodies);
  mpsi_parallel_for(mpm->context, partition->borders, pack, mpm);
  partition->lost = mpsi_halo_begin_bytes(partition->halo, function, partition->item,
                                          partition->out, partition->in);
  return partition->lost;
}

void mpsi_step_receive_parcels(void *solver) {
  mpsi_mpm_receive_parcels(((mps_mpm *)solver)->partition);
}

/* ---- sums at the nodes ----------------------------------------------------------------------- */

void mpsi_step_scatter(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  const bool penalty = mpm->contact.penalty_bodies > 0;
  if (penalty) mpsi_mpm_clear_penalty(work.grid, work.contact, work.cells, work.worker);
  mpm->kernels->p2g[mpm->grid.geometry][mpm->grid.spline - 2](&work);
  if (penalty) mpsi_mpm_add_penalty(work.grid, work.contact, work.cells, work.worker);
}

void mpsi_mpm_scatter_tile(void *data, int64_t b, int32_t number) {
  mps_mpm *mpm = data;
  mpsi_partition *partition = mpm->partition;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, number);
  const mpsi_worker *worker = work.worker;
  mpsi_cell_block *cells = work.cells;
  if (cells->parcel < 0) {
    mpsi_step_scatter(mpm, b, number);
    return;
  }
  if (cells->ghost && partition->lost != MPS_OK) return; /* the step has failed */
  double *parcel = mpsi_mpm_parcel(partition, cells->ghost, cells->parcel);
  cells->apart = parcel[0] != 0.0;
  cells->split = parcel[1] != 0.0;
  cells->thin = parcel[2] != 0.0;
  cells->in_contact = parcel[3] != 0.0;
  parcel = copy_tiles(cells, worker, parcel + MPSI_PARCEL_HEAD, false);
  copy_penalty_tiles(&mpm->grid, &mpm->contact, cells, worker, parcel, false);
  mpm->kernels->flush(&work);
  mpsi_mpm_add_penalty(&mpm->grid, &mpm->contact, cells, worker);
}
