/* halo.h - cells of the water between ranks: sums over the particles of border blocks, and the
 * layers of cells beside the blocks of nodes whose cells a rank computes.
 *
 * A rank computes the cells of all blocks of nodes that its own blocks of cells cover
 * (partition.h), each with the bits of one rank. Fluxes and slopes there need one cell beyond: the
 * layers of other blocks at their faces, which the rank that counts such a block sends in each
 * stage of a step. Their blocks stand behind the rank's own in the lists of cells.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/room.h"
#include "domain/halo.h"
#include "mpm/ranks/notices.h"
#include "water.h"

struct mpsi_pore_halo {
  mpsi_halo *messages; /* of layers; NULL: none yet */
  int64_t searches;    /* of the partition, for which the layers are those of its ghosts */
  int64_t guests;      /* layers that come, in order of their ranks */
  int64_t blocks;      /* that they are of */
  int32_t *block;      /* number of each guest's block, behind the rank's own */
  int8_t *direction;   /* the face of that block at which it lies */
  int32_t (*at)[3];    /* where the blocks are */
  int64_t most;        /* cells of the widest region (mpsi_pore_region) of a border block */
  mpsi_room block_room, direction_room, at_room, out_room, in_room;
};

/* What the layers have of their cells, stage by stage. */
typedef enum mpsi_pore_stage {
  MPSI_PORE_FILLED, /* which are filled */
  MPSI_PORE_EDGES,  /* pressures, permeabilities, filled parts and faces */
  MPSI_PORE_NOW     /* pressures at the end of the step */
} mpsi_pore_stage;

/* Blocks near those that this rank computes, which another rank counts: the list is to be freed
 * whatever is returned, the status is that of this rank. Collective. */
mps_status mpsi_pore_find_notices(const mps_mpm *mpm, const char *function, mpsi_notice **list,
                                  int64_t *found);
/* Finds the layers of the present ghosts. Collective. */
mps_status mpsi_pore_find_halo(mps_mpm *mpm, const char *function);
/* The number of the block at `at` behind the rank's own ones, or -1. Not collective. */
int32_t mpsi_pore_guest_block(const mpsi_grid *grid, const mpsi_water *water, const int32_t *at);
/* Length of the message with the sums of a border block. */
static inline int64_t mpsi_pore_sum_doubles(const mpsi_pore_halo *halo) {
  return 2 * halo->most * (int64_t)(sizeof(mpsi_node) / sizeof(double));
}
/* Layers of a stage; nothing without ranks. A failure of the transport stays in the partition. */
void mpsi_pore_exchange(mps_mpm *mpm, mpsi_pore_stage stage);
/* Not collective; accepts none. */
void mpsi_pore_free_halo(mps_context *context, mpsi_pore_halo **halo);
