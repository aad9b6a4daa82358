/* parcels.c - parcels sent for each block of cells at a border and received for each ghost: memory
 * for them, and the exchange of other sums in tiles. SPDX-License-Identifier: BSD-3-Clause */
#include "parcels.h"

#include "mpm/base/all_parts.h"

#include <string.h>

int32_t mpsi_mpm_parcel_bytes(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies) {
  const int64_t bytes = (1 + apart) * (1 + thin) * (int64_t)sizeof(mpsi_node) +
                        penalty_bodies * (int64_t)sizeof(mpsi_penalty_node);
  const int64_t doubles =
      MPSI_PARCEL_HEAD + (int64_t)partition->most * (bytes / (int64_t)sizeof(double));
  return (int32_t)(doubles * (int64_t)sizeof(double));
}

mps_status mpsi_mpm_reserve_parcels(mps_context *context, const mpsi_contacts *contacts,
                                    mpsi_partition *partition, const char *function) {
  const int64_t parcel =
      mpsi_mpm_parcel_bytes(partition, true, contacts->thin != 0, contacts->penalty_bodies);
  const bool good =
      mpsi_room_ensure(context, &partition->out_room, partition->borders * parcel, 1) &&
      mpsi_room_ensure(context, &partition->in_room, partition->ghosts * parcel, 1);
  partition->out = partition->out_room.item;
  partition->in = partition->in_room.item;
  return good ? MPS_OK
              : mpsi_fail_memory(context, function,
                                 (size_t)((partition->borders + partition->ghosts) * parcel));
}

double *mpsi_mpm_parcel(const mpsi_partition *partition, bool ghost, int64_t number) {
  return (ghost ? partition->in : partition->out) +
         number * (partition->item / (int64_t)sizeof *partition->out);
}

double *mpsi_mpm_copy_nodes(const mpsi_cell_block *cells, void *tile, size_t size, double *parcel,
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

/* Sums other than momenta, which `sum` puts into the tiles of a worker. */
typedef struct sums {
  const mpsi_grid *grid;
  const mpsi_partition *partition;
  mpsi_mpm_task sum;
  void *data;
} sums;

static double *copy_tile(const mpsi_cell_block *cells, mpsi_node *tile, double *parcel, bool pack) {
  return mpsi_mpm_copy_nodes(cells, tile, sizeof *tile, parcel, pack);
}

static void copy_sums(const mpsi_cell_block *cells, const mpsi_worker *worker, double *parcel,
                      bool pack) {
  parcel = copy_tile(cells, worker->tile, parcel + MPSI_PARCEL_HEAD, pack);
  if (cells->thin) copy_tile(cells, worker->across_tile, parcel, pack);
}

static void pack_sums(void *data, int64_t k, int32_t number) {
  const sums *s = data;
  const int32_t b = s->partition->border[k];
  s->sum(s->data, b, number);
  copy_sums(&s->grid->cells[b], &s->grid->workers[number], mpsi_mpm_parcel(s->partition, false, k),
            true);
}

void mpsi_mpm_send_sums(mps_context *context, const mpsi_grid *grid, mpsi_partition *partition,
                        mpsi_mpm_task sum, void *data) {
  sums s = {grid, partition, sum, data};
  partition->item = mpsi_mpm_parcel_bytes(partition, false, partition->thin, 0);
  mpsi_parallel_for(context, partition->borders, pack_sums, &s);
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_begin_bytes(partition->halo, "mps_mpm_step", partition->item,
                                            partition->out, partition->in);
}

bool mpsi_mpm_receive_sums(const mpsi_grid *grid, const mpsi_partition *partition, int64_t b,
                           int32_t number, mpsi_mpm_task sum, void *data) {
  const mpsi_cell_block *cells = &grid->cells[b];
  if (cells->parcel < 0) {
    sum(data, b, number);
    return true;
  }
  if (cells->ghost && partition->lost != MPS_OK) return false; /* the step has failed */
  copy_sums(cells, &grid->workers[number], mpsi_mpm_parcel(partition, cells->ghost, cells->parcel),
            false);
  return true;
}

void mpsi_mpm_receive_parcels(mpsi_partition *partition) {
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_end_bytes(partition->halo, "mps_mpm_step");
}
