/* parcels.h - parcels between ranks (partition.h): for each block of cells at a border some numbers
 * about it and the part of its tiles that is in use. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARCELS_H
#define MPSI_MPM_PARCELS_H

#include "mpm/grid/blocks.h"
#include "partition.h"

#define MPSI_PARCEL_HEAD 4 /* doubles before the tiles */

/* Of a parcel with the tiles of momenta, and of forces where they are apart, both across thin
 * bodies too where some block has these, and of penalty contact for so many bodies. */
int32_t mpsi_mpm_parcel_bytes(const mpsi_partition *partition, bool apart, bool thin,
                              int32_t penalty_bodies);
/* Room for parcels, whatever the step. */
mps_status mpsi_mpm_reserve_parcels(mps_context *context, const mpsi_contacts *contacts,
                                    mpsi_partition *partition, const char *function);
/* The one that comes for a ghost or goes for a block at the border. */
double *mpsi_mpm_parcel(const mpsi_partition *partition, bool ghost, int64_t number);
/* The part of a tile in use, nodes of `size` bytes, to or from a parcel; returns its place behind
 * them. */
double *mpsi_mpm_copy_nodes(const mpsi_cell_block *cells, void *tile, size_t size, double *parcel,
                            bool pack);
/* In a pass: sums that `sum` puts into a worker's tile go to all ranks that have the block as a
 * ghost (collective); then such a tile of block b, false where messages are lost. */
void mpsi_mpm_send_sums(mps_mpm *mpm, mpsi_mpm_task sum);
bool mpsi_mpm_receive_sums(mps_mpm *mpm, int64_t b, int32_t worker, mpsi_mpm_task sum);
/* What has been sent, whatever it is, is there. Collective. */
void mpsi_mpm_receive_parcels(mps_mpm *mpm);

#endif
