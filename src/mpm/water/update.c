/* update.c - the water's part of a step: what comes before the scatter, and what comes after the
 * particles have moved. SPDX-License-Identifier: BSD-3-Clause */
#include "water.h"

#include <string.h>

/* ---- before ---------------------------------------------------------------------------------- */

static mps_status make_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                            mpsi_water *water, const char *function) {
  const int64_t blocks = grid->node_count, nodes = blocks * grid->block_nodes;
  if (!mpsi_room_ensure(context, &water->cell_room, nodes, sizeof *water->cell) ||
      !mpsi_room_ensure(context, &water->edge_room, nodes, sizeof *water->edge) ||
      !mpsi_room_ensure(context, &water->beside_room, 6 * blocks, sizeof *water->beside) ||
      !mpsi_room_ensure(context, &water->outflow_room, blocks, sizeof *water->outflow) ||
      !mpsi_room_ensure(context, &water->former_room, p->count, sizeof *water->former) ||
      !mpsi_room_ensure(context, &water->place_room, p->count, sizeof *water->place))
    return mpsi_fail_memory(context, function, (size_t)nodes * sizeof *water->cell);
  water->cell = water->cell_room.item;
  water->edge = water->edge_room.item;
  water->beside = water->beside_room.item;
  water->outflow = water->outflow_room.item;
  water->former = water->former_room.item;
  water->place = water->place_room.item;
  return MPS_OK;
}

/* Number of the block of nodes at `at`, or -1; the list is in order. */
static int32_t find_block(const mpsi_grid *grid, const int32_t *at) {
  int64_t low = 0, high = grid->node_count;
  while (low < high) {
    const int64_t middle = (low + high) / 2;
    if (mpsi_block_before(grid->nodes[middle].at, at))
      low = middle + 1;
    else
      high = middle;
  }
  const bool found = low < grid->node_count && !mpsi_block_before(at, grid->nodes[low].at);
  return found ? (int32_t)low : -1;
}

static void link_blocks(const mpsi_grid *grid, mpsi_water *water) {
  for (int64_t g = 0; g < grid->node_count; g++)
    for (int d = 0; d < 6; d++) {
      int32_t at[3];
      memcpy(at, grid->nodes[g].at, sizeof at);
      at[d / 2] += d & 1 ? 1 : -1;
      water->beside[6 * g + d] = d < 2 * grid->dim ? find_block(grid, at) : -1;
    }
}

static void keep_volumes(mps_mpm *mpm, int64_t b, int32_t worker) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  (void)worker;
  memcpy(mpm->water->former + cells->begin, mpm->p.V + cells->begin,
         (size_t)(cells->end - cells->begin) * sizeof *mpm->p.V);
}

mps_status mpsi_pore_begin(mps_mpm *mpm, const char *function) {
  if (!mpm->water) return MPS_OK;
  const mps_status status = make_room(mpm->context, &mpm->grid, &mpm->p, mpm->water, function);
  if (status != MPS_OK) return status;
  for (int c = 0; c < 3; c++)
    mpm->water->seepage[c] =
        c < mpm->grid.dim ? mpsi_particles_column(mpm->p.set, "seepage", c) : NULL;
  if (mpm->run.steps == 0) mpm->water->start = mpsi_pore_mass(&mpm->p, mpm->water);
  link_blocks(&mpm->grid, mpm->water);
  mpsi_mpm_for_cells(mpm, keep_volumes);
  return MPS_OK;
}

/* ---- after ----------------------------------------------------------------------------------- */

static void sum_outflow(const mpsi_grid *grid, mpsi_water *water, double dt) {
  const double amount = water->def.density * grid->measure;
  for (int f = 0; f < MPSI_PORE_FACES; f++) {
    double sum = 0.0; /* m3/s, in the order of the blocks */
    for (int64_t g = 0; g < grid->node_count; g++) sum += water->outflow[g][f];
    water->rate[f] = amount * sum;
    water->drained[f] += water->rate[f] * dt;
  }
}

void mpsi_pore_update(mps_mpm *mpm) {
  if (!mpm->water) return;
  mpsi_pore_find_cells(mpm);
  mpsi_pore_flow(mpm);
  if (mpm->water->flows) sum_outflow(&mpm->grid, mpm->water, mpm->run.dt);
}
