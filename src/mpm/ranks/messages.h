/* messages.h - messages between ranks (partition.h): for each block of cells at a border, which
 * other ranks have as a ghost, the same number of doubles. One exchange is under way at a time. Its
 * status stays in the partition (`lost`), as it ends within a pass.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/grid/blocks.h"
#include "partition.h"

/* Writes the message of block b. */
typedef void (*mpsi_pack_fn)(void *data, int64_t b, int32_t worker, double *message);

/* Memory for messages of at most so many doubles a block. MPS_ERROR_MEMORY. */
mps_status mpsi_mpm_reserve_messages(mps_context *context, mpsi_partition *partition,
                                     const char *function, int64_t doubles);
/* Length of the message of a block in a step, at most: some flags and the part of its tiles in use,
 * of momenta, of forces where they are apart, both across thin bodies where some block has these,
 * and of penalty contact for so many bodies. The most in any step. */
enum { MPSI_TILE_FLAGS = 1 };
int64_t mpsi_mpm_tile_doubles(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies);
int64_t mpsi_mpm_most_doubles(const mpsi_partition *partition, const mpsi_contacts *contacts);
/* Packs and sends the messages of the border blocks, on all threads; completes the exchange; both.
 * Collective. */
void mpsi_mpm_send_messages(mps_context *context, mpsi_partition *partition, const char *function,
                            int64_t doubles, mpsi_pack_fn pack, void *data);
void mpsi_mpm_receive_messages(mpsi_partition *partition);
mps_status mpsi_mpm_exchange_messages(mps_context *context, mpsi_partition *partition,
                                      const char *function, int64_t doubles, mpsi_pack_fn pack,
                                      void *data);
/* The message of a block of cells, as sent or received; NULL of one that no other rank has, and
 * without ranks. False: it is lost, and the step has failed. */
bool mpsi_mpm_find_message(const mpsi_partition *partition, const mpsi_cell_block *cells,
                           double **message);
/* Exchange by a halo of its own (domain/halo.h) of messages of so many doubles, packed for each
 * item and unpacked for each guest: its index, and what it has. `room`: memory for those sent and
 * received. Collective. */
typedef void (*mpsi_item_fn)(void *data, int64_t item, double *message);
mps_status mpsi_mpm_exchange_items(mpsi_halo *halo, const char *function, int64_t doubles,
                                   int64_t guests, double *const *room, mpsi_item_fn pack,
                                   mpsi_item_fn unpack, void *data);
/* Copies the nodes `low` to `high` - 1 of a tile, of `size` bytes each, to (`pack`) or from a
 * message; returns their end there. */
double *mpsi_mpm_copy_nodes(const int32_t *low, const int32_t *high, void *tile, size_t size,
                            double *message, bool pack);
