/* means.h - sums over particles at the nodes, {sum V, sum V value} and in the filter a third, for
 * means by cell or by node after the step's G2P. They replace the mass and momentum of the nodes,
 * which are not needed any more. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/mpm_solver.h"

enum { MPSI_SUM_VOLUME = 0, MPSI_SUM_VALUE = 1, MPSI_SUM_FLOW = 2, MPSI_SUMS = 3 };

/* Position (m) of a particle when G2P found its stencil, whose lowest tile node is `base`. It has
 * moved since; not by dt v where it has a FLIP part or was moved back to a wall. */
static inline void mpsi_former_place(const mpsi_grid *grid, const mpsi_columns *p,
                                     const mpsi_cell_block *cells, const int *base, int64_t k,
                                     double *x) {
  double local[3] = {0.0};
  for (int c = 0; c < grid->dim; c++) local[c] = base[c] + p->t[c][k];
  mpsi_node_position(grid, cells->at, local, x);
}

/* Sums of tile node (i, j, k): those of a block, in the tile of a worker, or (worker NULL) those of
 * all blocks, at the node; `across`: values across thin bodies (thin_bodies.h). */
static inline double *mpsi_sums_at(const mpsi_grid *grid, const mpsi_cell_block *cells,
                                   const mpsi_worker *worker, bool across, int i, int j, int k) {
  if (worker) return (across ? worker->across_tile : worker->tile)[mpsi_tile_index(i, j, k)];
  return grid->node[across ? mpsi_node_across(grid, cells, i, j, k)
                           : mpsi_node_under(grid, cells, i, j, k)];
}

/* Sets the part of the worker's tiles that the block uses to zero. */
void mpsi_clear_sums(const mpsi_grid *grid, int64_t b, int32_t worker);
/* Scatter task of a pass: adds what `sum` puts into a worker's tile, here or on the block's own
 * rank, to the nodes. */
void mpsi_add_sums(mps_mpm *mpm, int64_t b, int32_t worker, mpsi_mpm_task sum);
/* A pass: `add` calls mpsi_add_sums with `sum`; then `gather`, block by block. */
void mpsi_run_sums(mps_mpm *mpm, mpsi_mpm_task sum, mpsi_mpm_task add, mpsi_mpm_task gather);
/* Whether the step has failed on any rank, so that positions may not be finite; whether a law has
 * refused on any. Collective. */
bool mpsi_any_failed(const mpsi_grid *grid, mpsi_partition *partition);
bool mpsi_any_refused(const mpsi_columns *p, mpsi_partition *partition);

/* volumetric.c: after the step's G2P the laws that wait for means, and what is smoothed. */
void mpsi_mpm_apply_laws_by_cell(mps_mpm *mpm);
/* filter.c: whether this step, by its number and the interval, filters the mean stresses of
 * frictional laws; the filter. */
bool mpsi_mpm_filters(const mpsi_columns *p, const struct mpsi_water *water, const mpsi_run *run);
void mpsi_mpm_filter(mps_mpm *mpm);
