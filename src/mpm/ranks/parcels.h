/* parcels.h - messages between ranks (partition.h): a parcel has, for a block of cells at a border,
 * some numbers and the part of its tiles that is in use. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARCELS_H
#define MPSI_MPM_PARCELS_H

#include "mpm/grid/blocks.h"
#include "partition.h"

#define MPSI_PARCEL_HEAD 4 /* doubles before the tiles */

/* Length of a parcel with the tiles of momenta, of forces where they are apart, both across thin
 * bodies where some block has these, and of penalty contact for so many bodies. */
int32_t mpsi_mpm_parcel_bytes(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies);
/* Memory for the parcels of any step. */
mps_status mpsi_mpm_reserve_parcels(mps_context *context, const mpsi_contacts *contacts,
                                    mpsi_partition *partition, const char *function);
/* The parcel received for a ghost, or to send for a block at the border. */
double *mpsi_mpm_parcel(const mpsi_partition *partition, bool ghost, int64_t number);
/* Copies the part of a tile in use, with nodes of `size` bytes, to (`pack`) or from a parcel;
 * returns the end of that part in the parcel. */
double *mpsi_mpm_copy_nodes(const mpsi_cell_block *cells, void *tile, size_t size, double *parcel,
                            bool pack);
/* Sends the sums that `sum`, a task on `data`, puts into a worker's tile to all ranks that have the
 * block as a ghost (collective); in a pass, puts the sums of block b, summed here or received, into
 * the worker's tile: false where messages are lost. */
void mpsi_mpm_send_sums(mps_context *context, const mpsi_grid *grid, mpsi_partition *partition,
                        mpsi_mpm_task sum, void *data);
bool mpsi_mpm_receive_sums(const mpsi_grid *grid, const mpsi_partition *partition, int64_t b,
                           int32_t worker, mpsi_mpm_task sum, void *data);
/* Completes the exchange of parcels. Collective. */
void mpsi_mpm_receive_parcels(mpsi_partition *partition);

#endif
