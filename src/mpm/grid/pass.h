/* pass.h - work on the grid that goes from the particles to the nodes and back.
 *
 * A pass has no stages that wait for each other. A block of nodes is updated when all blocks of
 * cells whose tiles cover it have given to it, and a block of cells takes from its nodes when all
 * of them are done, while others still give elsewhere:
 *
 *   scatter(b) --> scatter of the next colour ... --> update(g) --> finish(g) --> gather(b)
 *
 * Blocks of cells that share a block of nodes give to it one after the other, in the order of their
 * colours (mpsi_node_block): sums do not depend on the order or number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PASS_H
#define MPSI_MPM_PASS_H

#include "mpm/base/parts.h"
#include "core/base/room.h"

#include <mps/mpm.h>

/* Work on the block of cells or nodes `index`. */
typedef void (*mpsi_mpm_task)(mps_mpm *mpm, int64_t index, int32_t worker);

typedef struct mpsi_pass {
  mpsi_mpm_task clear;                       /* of nodes, before the first gives to them */
  mpsi_mpm_task scatter;                     /* of cells; NULL: none, and nothing is cleared */
  mpsi_mpm_task update;                      /* of nodes, all having given; NULL: none */
  bool (*between)(mps_mpm *mpm, void *data); /* NULL: nothing; else runs once, when all blocks of
                                    nodes that `wait` are updated and before any of these is
                                    finished; with one thread before anything is finished, and false
                                    ends the pass */
  void *data;
  mpsi_mpm_task finish;         /* of nodes; NULL: none */
  mpsi_mpm_task gather;         /* of cells; NULL: none */
  void (*arrive)(mps_mpm *mpm); /* NULL: nothing; else brings what ghosts give (partition.h), on the
                                    caller's thread, when little or nothing else is left to do */
  bool ghosts; /* ghosts gather too, and nodes that only they cover are updated and finished */
} mpsi_pass;

/* Whether one thread makes the passes. */
bool mpsi_mpm_passes_alone(const mpsi_grid *grid, const mpsi_columns *p);
/* Returns when all is done. */
void mpsi_mpm_run_pass(mps_mpm *mpm, const mpsi_pass *pass);

/* Room for the passes over the present blocks; false when out of memory. */
bool mpsi_mpm_ensure_pass(mps_context *context, mpsi_grid *grid);
/* Which blocks follow each other on each block of nodes, from mpsi_node_block.from. */
void mpsi_mpm_link_blocks(const mpsi_grid *grid);

/* task(mpm, index, worker) for all blocks of cells, which do not depend on each other. */
void mpsi_mpm_for_cells(mps_mpm *mpm, mpsi_mpm_task task);

#endif
