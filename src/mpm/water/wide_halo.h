/* wide_halo.h - the wide halo of a rank, for pressures that are implicit: cells that other ranks
 * count, within three cells of those that this rank counts.
 *
 * A rank solves for the cells of the blocks of nodes that it counts (partition.h). One product with
 * the matrix needs pressures three cells beyond them, and velocities of nodes in between: those are
 * computed here too, from the forces that the cells of the wide halo exert. The ranks that count
 * these cells send their forces, inertias and velocities of their nodes once a step, and the
 * direction of the conjugate gradients in each iteration. Cells of the wide halo stand behind those
 * of the grid in the vectors of the system. The cells of blocks that a rank computes but does not
 * count are in the wide halo as well; what such blocks need after the solution comes whole: they
 * are shared. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/room.h"
#include "domain/halo.h"
#include "system.h"

/* A block of nodes with cells in the wide halo. */
typedef struct mpsi_pore_wide_block {
  int32_t at[3];
  int32_t number; /* in the wide halo, in order of the ranks; the list itself is in order of `at` */
} mpsi_pore_wide_block;

struct mpsi_pore_wide_halo {
  mpsi_halo *halo;       /* of cells; NULL: none yet */
  mpsi_halo *shared;     /* of blocks that this rank computes but does not count */
  int64_t searches;      /* of the partition, for which the wide halo is that of its ghosts */
  int64_t blocks, cells; /* in the wide halo */
  int64_t shared_blocks; /* shared blocks */
  int64_t particles;     /* most of a border block, on all ranks */
  mpsi_pore_wide_block *block;
  int32_t *cell;    /* [blocks][nodes of a block]: number of the cell in the wide halo, or -1 */
  uint8_t *reached; /* by cells: the node is one of those of a cell that this rank counts */
  int32_t *shared_block; /* numbers of these blocks in the grid */
  mpsi_room block_room, cell_room, reached_room, shared_block_room, out_room, in_room;
};

/* Finds the wide halo of the present ghosts, which is the system's own from then on. Collective. */
mps_status mpsi_pore_find_wide_halo(mps_mpm *mpm, const char *function);
/* The block at `at` of the wide halo, or -1. Not collective; accepts no wide halo. */
int32_t mpsi_pore_wide_block_at(const mpsi_pore_wide_halo *wide, const int32_t *at);

/* Particles of border blocks, to the ranks that have these as ghosts; a failure of the transport
 * stays in the partition. */
void mpsi_pore_send_particles(mps_mpm *mpm);
/* Those of ghost b, `*count` of them, none where they have not come. Not collective. */
const mpsi_pore_particle *mpsi_pore_particles_of(const mps_mpm *mpm, int64_t b, int64_t *count);

/* Forces of the cells of the wide halo; inertias and velocities of their nodes. */
mps_status mpsi_pore_send_forces(mps_mpm *mpm, const char *function);
mps_status mpsi_pore_send_nodes(mps_mpm *mpm, const char *function);
/* The direction in the wide halo. */
mps_status mpsi_pore_send_direction(mps_mpm *mpm, const char *function);
/* Changes of the pressures in blocks that are computed but not counted. */
mps_status mpsi_pore_send_changes(mps_mpm *mpm, const char *function);

/* Not collective; accepts none. */
void mpsi_pore_free_wide_halo(mps_context *context, mpsi_pore_wide_halo **wide);
