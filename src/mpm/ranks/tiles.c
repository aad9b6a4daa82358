/* tiles.c - tiles between ranks (partition.h): border blocks are summed and sent, the interior is
 * summed meanwhile, and then the tiles received are added to the nodes.
 *
 * A parcel has four numbers (whether its forces are apart, whether they are split, whether thin
 * bodies separate its nodes, whether it has contact constraints) and then the part of the tile that
 * is in use, that of the forces where some tile of the step has them, both across thin bodies
 * (thin_bodies.h) where some tile has these, and those of penalty contact, body by body
 * (penalty.c). SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"

#include <string.h>

enum { HEAD = 4 }; /* doubles */

static int64_t parcel_doubles(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies) {
  const int64_t bytes = (1 + apart) * (1 + thin) * (int64_t)sizeof(mpsi_node) +
                        penalty_bodies * (int64_t)sizeof(mpsi_penalty_node);
  return HEAD + (int64_t)partition->most * (bytes / (int64_t)sizeof(double));
}

mps_status mpsi_mpm_reserve_tiles(mps_mpm *mpm, const char *function) {
  mpsi_partition *partition = mpm->partition;
  const int64_t parcel =
      parcel_doubles(partition, true, mpm->contact.thin != 0, mpm->contact.penalty_bodies) *
      (int64_t)sizeof(double);
  const bool good =
      mpsi_room_ensure(mpm->context, &partition->out_room, partition->borders * parcel, 1) &&
      mpsi_room_ensure(mpm->context, &partition->in_room, partition->ghosts * parcel, 1);
  partition->out = partition->out_room.item;
  partition->in = partition->in_room.item;
  return good ? MPS_OK
              : mpsi_fail_memory(mpm->context, function,
                                 (size_t)((partition->borders + partition->ghosts) * parcel));
}

/* What a tile has follows from bodies, boundaries and blocks, and so does the room of a step. */
bool mpsi_mpm_partition_unchanged(const mps_mpm *mpm) {
  return mpm->partition->ready && !mpm->run.stale && !mpm->run.edited &&
         !mpm->partition->outdated && !mpm->boundaries.outdated && mpm->contact.bodies == 0 &&
         !mpm->settling.on && !mpsi_mpm_absorbs(mpm);
}

mps_status mpsi_mpm_agree_before_step(mps_mpm *mpm, const char *function, mps_status status) {
  mpsi_partition *partition = mpm->partition;
  enum { APART, THIN, SPRINGS, FOUND };
  double found[FOUND] = {0.0};
  if (status == MPS_OK) status = mpsi_mpm_reserve_tiles(mpm, function);
  for (int64_t k = 0; status == MPS_OK && k < partition->borders; k++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[partition->border[k]];
    if (cells->apart) found[APART] = 1.0;
    if (cells->thin) found[THIN] = 1.0;
    double penalty_bodies = 0.0;
    for (int32_t q = 0; q < cells->pairs; q++)
      penalty_bodies += mpsi_mpm_has_penalty(mpm, cells, q);
    found[SPRINGS] = fmax(found[SPRINGS], penalty_bodies);
  }
  status = mpsi_mpm_agree_in_step(mpm, function, status, FOUND, found);
  partition->ready = status == MPS_OK;
  partition->apart = found[APART] > 0.0;
  partition->thin = found[THIN] > 0.0;
  partition->penalty_bodies = (int32_t)found[SPRINGS];
  return status;
}

/* ---- corners of cells with particles, where bodies are near -----------------------------------
 */

mps_status mpsi_mpm_exchange_corners(mps_mpm *mpm, const char *function, bool known) {
  mpsi_partition *partition = mpm->partition;
  const int64_t nodes = (mpm->grid.tile_nodes + 63) / 64;
  const int64_t words = nodes + 1; /* whether thin bodies part it; less than a parcel has */
  uint64_t *out = (uint64_t *)partition->out, *in = (uint64_t *)partition->in;
  if (partition->borders > 0) memset(out, 0, (size_t)(partition->borders * words) * sizeof *out);
  for (int64_t k = 0; known && k < partition->borders; k++) {
    mpsi_mpm_list_reached(mpm, partition->border[k], out + k * words);
    out[k * words + nodes] = mpm->grid.cells[partition->border[k]].thin;
  }
  const int32_t item = (int32_t)(words * (int64_t)sizeof *out);
  mps_status status = mpsi_halo_begin_bytes(partition->halo, function, item, out, in);
  if (status == MPS_OK) status = mpsi_halo_end_bytes(partition->halo, function);
  for (int64_t b = 0; known && status == MPS_OK && b < mpm->grid.cell_count; b++) {
    mpsi_cell_block *cells = &mpm->grid.cells[b];
    if (!cells->ghost) continue;
    mpsi_mpm_take_reached(mpm, b, in + cells->parcel * words);
    cells->thin = in[cells->parcel * words + nodes] != 0;
  }
  return status;
}

/* ---- packing --------------------------------------------------------------------------------- */

/* The part of a tile in use, nodes of `size` bytes, to or from a parcel, which it ends behind. */
static double *copy_nodes(const mpsi_cell_block *cells, void *tile, size_t size, double *parcel,
                          bool pack) {
  const size_t bytes = (size_t)(cells->high[0] - cells->low[0]) * size;
  for (int k = cells->low[2]; k < cells->high[2]; k++)
    for (int j = cells->low[1]; j < cells->high[1]; j++) {
      char *row = (char *)tile + (size_t)mpsi_tile_index(cells->low[0], j, k) * size;
      memcpy(pack ? (void *)parcel : (void *)row, pack ? (void *)row : (void *)parcel, bytes);
      parcel += bytes / sizeof *parcel;
    }
  return parcel;
}

static double *copy_tile(const mpsi_cell_block *cells, mpsi_node *tile, double *parcel, bool pack) {
  return copy_nodes(cells, tile, sizeof *tile, parcel, pack);
}

/* Tiles and those across; those of forces where they are apart. */
static double *copy_tiles(const mpsi_cell_block *cells, const mpsi_worker *worker, double *parcel,
                          bool pack) {
  parcel = copy_tile(cells, worker->tile, parcel, pack);
  if (cells->apart) parcel = copy_tile(cells, worker->force, parcel, pack);
  if (!cells->thin) return parcel;
  parcel = copy_tile(cells, worker->across_tile, parcel, pack);
  if (cells->apart) parcel = copy_tile(cells, worker->across_force, parcel, pack);
  return parcel;
}

static void copy_springs(const mps_mpm *mpm, const mpsi_cell_block *cells,
                         const mpsi_worker *worker, double *parcel, bool pack) {
  for (int32_t q = 0; q < cells->pairs; q++)
    if (mpsi_mpm_has_penalty(mpm, cells, q))
      parcel = copy_nodes(
          cells,
          mpsi_mpm_penalty_tile(mpm, worker, mpm->contact.cell_pair[cells->first_pair + q].body),
          sizeof(mpsi_penalty_node), parcel, pack);
}

static void pack(void *data, int64_t k, int32_t number) {
  mps_mpm *mpm = data;
  mpsi_partition *partition = mpm->partition;
  mpsi_worker *worker = &mpm->grid.workers[number];
  const mpsi_cell_block *cells = &mpm->grid.cells[partition->border[k]];
  double *parcel = partition->out + k * (partition->item / (int64_t)sizeof *partition->out);
  mpsi_mpm_clear_penalty(mpm, cells, worker);
  mpm->kernels->tile[mpm->def.geometry][mpm->def.spline - 2](mpm, partition->border[k], number);
  parcel[0] = cells->apart;
  parcel[1] = cells->split;
  parcel[2] = cells->thin;
  parcel[3] = cells->in_contact;
  parcel = copy_tiles(cells, worker, parcel + HEAD, true);
  copy_springs(mpm, cells, worker, parcel, true);
}

mps_status mpsi_mpm_send_tiles(mps_mpm *mpm, const char *function) {
  mpsi_partition *partition = mpm->partition;
  partition->item = (int32_t)(parcel_doubles(partition, partition->apart, partition->thin,
                                             partition->penalty_bodies) *
                              (int64_t)sizeof(double));
  mpsi_parallel_for(mpm->context, partition->borders, pack, mpm);
  partition->lost = mpsi_halo_begin_bytes(partition->halo, function, partition->item,
                                          partition->out, partition->in);
  return partition->lost;
}

/* Sums of another kind, that `sum` puts into the tiles of a worker. */
typedef struct sums {
  mps_mpm *mpm;
  mpsi_mpm_task sum;
} sums;

static double *parcel_of(const mpsi_partition *partition, bool ghost, int64_t number) {
  return (ghost ? partition->in : partition->out) +
         number * (partition->item / (int64_t)sizeof *partition->out);
}

static void copy_sums(const mpsi_cell_block *cells, const mpsi_worker *worker, double *parcel,
                      bool pack) {
  parcel = copy_tile(cells, worker->tile, parcel + HEAD, pack);
  if (cells->thin) copy_tile(cells, worker->across_tile, parcel, pack);
}

static void pack_sums(void *data, int64_t k, int32_t number) {
  const sums *s = data;
  const mpsi_partition *partition = s->mpm->partition;
  s->sum(s->mpm, partition->border[k], number);
  copy_sums(&s->mpm->grid.cells[partition->border[k]], &s->mpm->grid.workers[number],
            parcel_of(partition, false, k), true);
}

void mpsi_mpm_send_sums(mps_mpm *mpm, mpsi_mpm_task sum) {
  mpsi_partition *partition = mpm->partition;
  sums s = {mpm, sum};
  partition->item =
      (int32_t)(parcel_doubles(partition, false, partition->thin, 0) * (int64_t)sizeof(double));
  mpsi_parallel_for(mpm->context, partition->borders, pack_sums, &s);
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_begin_bytes(partition->halo, "mps_mpm_step", partition->item,
                                            partition->out, partition->in);
}

bool mpsi_mpm_receive_sums(mps_mpm *mpm, int64_t b, int32_t number, mpsi_mpm_task sum) {
  const mpsi_partition *partition = mpm->partition;
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  if (cells->parcel < 0) {
    sum(mpm, b, number);
    return true;
  }
  if (cells->ghost && partition->lost != MPS_OK) return false; /* the step has failed */
  copy_sums(cells, &mpm->grid.workers[number], parcel_of(partition, cells->ghost, cells->parcel),
            false);
  return true;
}

void mpsi_mpm_receive_tiles(mps_mpm *mpm) {
  mpsi_partition *partition = mpm->partition;
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_end_bytes(partition->halo, "mps_mpm_step");
}

/* ---- to the nodes ---------------------------------------------------------------------------- */

void mpsi_mpm_scatter_tile(mps_mpm *mpm, int64_t b, int32_t number) {
  mpsi_partition *partition = mpm->partition;
  mpsi_cell_block *cells = &mpm->grid.cells[b];
  mpsi_worker *worker = &mpm->grid.workers[number];
  if (cells->parcel < 0) {
    mpsi_mpm_scatter_penalty(mpm, b, number);
    return;
  }
  if (cells->ghost && partition->lost != MPS_OK) return; /* the step has failed */
  double *parcel = (cells->ghost ? partition->in : partition->out) +
                   cells->parcel * (partition->item / (int64_t)sizeof *partition->out);
  cells->apart = parcel[0] != 0.0;
  cells->split = parcel[1] != 0.0;
  cells->thin = parcel[2] != 0.0;
  cells->in_contact = parcel[3] != 0.0;
  parcel = copy_tiles(cells, worker, parcel + HEAD, false);
  copy_springs(mpm, cells, worker, parcel, false);
  mpm->kernels->flush(mpm, b, number);
  mpsi_mpm_add_penalty(mpm, cells, worker);
}
