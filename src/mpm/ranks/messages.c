/* messages.c - see messages.h. SPDX-License-Identifier: BSD-3-Clause */
#include "messages.h"

#include "mpm/contact/pairs.h"

#include <string.h>

mps_status mpsi_mpm_reserve_messages(mps_context *context, mpsi_partition *partition,
                                     const char *function, int64_t doubles) {
  const int64_t out = partition->borders * doubles, in = partition->ghosts * doubles;
  const bool good = mpsi_room_ensure(context, &partition->out_room, out, sizeof(double)) &&
                    mpsi_room_ensure(context, &partition->in_room, in, sizeof(double));
  return good ? MPS_OK : mpsi_fail_memory(context, function, (size_t)(out + in) * sizeof(double));
}

int64_t mpsi_mpm_tile_doubles(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies) {
  const int64_t bytes = (1 + apart) * (1 + thin) * (int64_t)sizeof(mpsi_node) +
                        penalty_bodies * (int64_t)sizeof(mpsi_penalty_node);
  return MPSI_TILE_FLAGS + partition->most * (bytes / (int64_t)sizeof(double));
}

int64_t mpsi_mpm_most_doubles(const mpsi_partition *partition, const mpsi_contacts *contacts) {
  return mpsi_mpm_tile_doubles(partition, true, contacts->thin != 0, contacts->penalty_bodies);
}

typedef struct packing {
  const mpsi_partition *partition;
  mpsi_pack_fn pack;
  void *data;
} packing;

static void pack_one(void *data, int64_t k, int32_t worker) {
  const packing *all = data;
  const mpsi_partition *partition = all->partition;
  all->pack(all->data, partition->border[k], worker,
            (double *)partition->out_room.item + k * partition->doubles);
}

void mpsi_mpm_send_messages(mps_context *context, mpsi_partition *partition, const char *function,
                            int64_t doubles, mpsi_pack_fn pack, void *data) {
  packing all = {partition, pack, data};
  partition->doubles = doubles;
  partition->function = function;
  mpsi_parallel_for(context, partition->borders, pack_one, &all);
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_begin_bytes(partition->halo, function,
                                            (int32_t)(doubles * (int64_t)sizeof(double)),
                                            partition->out_room.item, partition->in_room.item);
}

void mpsi_mpm_receive_messages(mpsi_partition *partition) {
  if (partition->lost == MPS_OK)
    partition->lost = mpsi_halo_end_bytes(partition->halo, partition->function);
}

mps_status mpsi_mpm_exchange_messages(mps_context *context, mpsi_partition *partition,
                                      const char *function, int64_t doubles, mpsi_pack_fn pack,
                                      void *data) {
  partition->lost = MPS_OK;
  mpsi_mpm_send_messages(context, partition, function, doubles, pack, data);
  mpsi_mpm_receive_messages(partition);
  return partition->lost;
}

bool mpsi_mpm_find_message(const mpsi_partition *partition, const mpsi_cell_block *cells,
                           double **message) {
  *message = NULL;
  if (!partition || cells->parcel < 0) return true;
  const mpsi_room *room = cells->ghost ? &partition->in_room : &partition->out_room;
  *message = (double *)room->item + cells->parcel * partition->doubles;
  return !cells->ghost || partition->lost == MPS_OK;
}

mps_status mpsi_mpm_exchange_items(mpsi_halo *halo, const char *function, int64_t doubles,
                                   int64_t guests, double *const *room, mpsi_item_fn pack,
                                   mpsi_item_fn unpack, void *data) {
  const int64_t *item, items = mpsi_halo_items(halo, &item);
  const int32_t bytes = (int32_t)(doubles * (int64_t)sizeof(double));
  for (int64_t k = 0; k < items; k++) pack(data, item[k], room[0] + k * doubles);
  mps_status status = mpsi_halo_begin_bytes(halo, function, bytes, room[0], room[1]);
  if (status == MPS_OK) status = mpsi_halo_end_bytes(halo, function);
  for (int64_t q = 0; status == MPS_OK && q < guests; q++) unpack(data, q, room[1] + q * doubles);
  return status;
}

double *mpsi_mpm_copy_nodes(const int32_t *low, const int32_t *high, void *tile, size_t size,
                            double *message, bool pack) {
  const size_t bytes = (size_t)(high[0] - low[0]) * size;
  for (int k = low[2]; k < high[2]; k++)
    for (int j = low[1]; j < high[1]; j++) {
      char *row = (char *)tile + (size_t)mpsi_tile_index(low[0], j, k) * size;
      memcpy(pack ? (void *)message : (void *)row, pack ? (void *)row : (void *)message, bytes);
      message += bytes / sizeof *message;
    }
  return message;
}
