/* pass.h - a pass: work on the grid from the particles to the nodes and back.
 *
 * The stages of a pass overlap. A block of nodes is updated when all blocks of cells whose tiles
 * cover it have added to it, and a block of cells gathers from its nodes when all of them are
 * finished, while others still scatter elsewhere:
 *
 *   scatter(b) --> scatter of the next colour ... --> update(g) --> finish(g) --> gather(b)
 *
 * Blocks of cells that share a block of nodes add to it one after the other, in the order of their
 * colours (mpsi_node_block): sums do not depend on the order or number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "core/base/room.h"

#include <mps/mpm.h>

/* Work on the block of cells or nodes `index`; `data` is what the task reads and writes. */
typedef void (*mpsi_mpm_task)(void *data, int64_t index, int32_t worker);

typedef struct mpsi_pass {
  void *data;                  /* of the tasks */
  mpsi_mpm_task clear;         /* of nodes, before the first block of cells adds to them */
  mpsi_mpm_task scatter;       /* of cells; NULL: none, and nothing is cleared */
  mpsi_mpm_task update;        /* of nodes, after all have added to them; NULL: none */
  bool (*between)(void *step); /* NULL: nothing; else runs once, when all blocks of nodes that
                                  `wait` are updated and before any of these is finished; with one
                                  thread before anything is finished, and false ends the pass */
  void *step;                  /* data of `between` */
  mpsi_mpm_task finish;        /* of nodes; NULL: none */
  mpsi_mpm_task gather;        /* of cells; NULL: none */
  mpsi_partition *ranks;       /* NULL: one process */
  void (*arrive)(mpsi_partition *ranks); /* on several ranks, or NULL: receives the messages of
                                    ghosts (ranks/messages.h), on the caller's thread, when little
                                    or nothing else is left to do */
  bool ghosts; /* ghosts gather too, and nodes that only they cover are updated and finished */
} mpsi_pass;

/* Whether one thread runs the passes. */
bool mpsi_mpm_passes_alone(const mpsi_grid *grid, const mpsi_columns *p);
/* Runs a pass; returns when all its tasks are complete. */
void mpsi_mpm_run_pass(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                       const mpsi_pass *pass);

/* Memory for the passes over the present blocks; false when out of memory. */
bool mpsi_mpm_ensure_pass(mps_context *context, mpsi_grid *grid);
/* Order in which blocks of cells add to each block of nodes (`next`, `waits`, `first` of
 * mpsi_cell_block), from mpsi_node_block.from. */
void mpsi_mpm_link_blocks(const mpsi_grid *grid);

/* Calls task(data, index, worker) for all blocks of cells, in any order. */
void mpsi_mpm_for_cells(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                        mpsi_mpm_task task, void *data);
