/* node_update.c - one block of nodes: sums set to zero before P2G; then velocities without and with
 * the forces, Nakamura (25), (26), (39). SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

#include <string.h>

enum { MOST = MPSI_SIDE * MPSI_SIDE * MPSI_SIDE }; /* nodes of a block */

void mpsi_mpm_clear_nodes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_node_block *nodes = &mpm->grid.nodes[g];
  const size_t bytes = (size_t)mpm->grid.block_nodes * sizeof *mpm->grid.node;
  memset(mpm->grid.node + mpsi_first_node(&mpm->grid, g), 0, bytes);
  if (nodes->side >= 0) memset(mpm->grid.side + mpsi_first_node(&mpm->grid, nodes->side), 0, bytes);
  if (nodes->across >= 0) mpsi_mpm_clear_nodes(mpm, nodes->across, worker);
}

/* Velocities of nodes whose particles all have full supports: the momentum includes the force. */
static void update_free(const mpsi_grid *grid, mpsi_node *node) {
  for (int k = 0; k < grid->block_nodes; k++) {
    if (node[k][MPSI_MASS] == 0.0) continue; /* no particle near, as most nodes of an edge block */
    const double inverse = 1.0 / node[k][MPSI_MASS];
    for (int c = MPSI_VECTOR; c < 4; c++) node[k][c] *= inverse;
  }
}

/* Velocities of nodes with side values; returns whether the own mass of some node is less than the
 * mass that forces accelerate. */
static bool update_cut(const mpsi_grid *grid, double dt, bool split, mpsi_node *node,
                       mpsi_node *side) {
  bool light = false;
  for (int k = 0; k < grid->block_nodes; k++) {
    const double weight = node[k][MPSI_MASS] + side[k][MPSI_EXCESS];
    if (!(weight > 0.0)) {
      memset(node[k], 0, sizeof node[k]);
      memset(side[k], 0, sizeof side[k]);
      continue;
    }
    const double own = node[k][MPSI_MASS], m = mpsi_node_mass(own, weight);
    const double carried = grid->by_weight ? weight : split ? mpsi_carried_mass(own, weight) : m;
    node[k][MPSI_MASS] = m;
    light = light || own < m;
    for (int c = MPSI_VECTOR; c < 4; c++) {
      const double before = node[k][c] / carried;
      node[k][c] = before;
      if (split) node[k][c] += dt * (side[k][c] / m);
      side[k][c] = before;
    }
  }
  return light && !grid->by_weight && !grid->standard;
}

void mpsi_mpm_update_nodes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  mpsi_node_block *nodes = &mpm->grid.nodes[g];
  mpsi_node *node = mpm->grid.node + mpsi_first_node(&mpm->grid, g);
  nodes->light = false;
  if (nodes->side < 0)
    update_free(&mpm->grid, node);
  else
    nodes->light = update_cut(&mpm->grid, mpm->run.dt, nodes->split, node,
                              mpm->grid.side + mpsi_first_node(&mpm->grid, nodes->side));
  if (nodes->pairs > 0) mpsi_mpm_apply_contact(&mpm->grid, &mpm->contact, mpm->run.dt, g);
  if (nodes->across >= 0) mpsi_mpm_update_nodes(mpm, nodes->across, worker);
}

/* Copies of the nodes of a block, in the worker's scratch memory. */
typedef struct copies {
  mpsi_node before[MOST], old[MOST], held[MOST], damped[MOST];
  mpsi_side_impulses impulses;
} copies;
_Static_assert(sizeof(copies) <= MPSI_WORKER_SCRATCH, "scratch of a worker");

/* Friction with bodies, after mirrors. `held` receives the velocities that the nodes would have
 * without boundaries. */
static void apply_body_friction(mps_mpm *mpm, int64_t g, mpsi_node *held, copies *scratch) {
  mpsi_node *before = scratch->before, *old = scratch->old;
  const mpsi_node *node = (const mpsi_node *)(mpm->grid.node + mpsi_first_node(&mpm->grid, g));
  const size_t bytes = (size_t)mpm->grid.block_nodes * sizeof *held;
  memcpy(held, node, bytes);
  if (mpm->grid.nodes[g].pairs == 0 || mpm->grid.nodes[g].side < 0) return;
  mpsi_node *side = mpm->grid.side + mpsi_first_node(&mpm->grid, mpm->grid.nodes[g].side);
  memcpy(old, side, bytes);
  mpsi_mpm_prescribe_mirrors(&mpm->grid, &mpm->boundaries, &mpm->mirrors, mpm->run.dt, g);
  memcpy(before, node, bytes);
  mpsi_mpm_apply_friction(&mpm->grid, &mpm->contact, mpm->run.dt, g);
  memcpy(side, old, bytes);
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    for (int c = MPSI_VECTOR; c < 4; c++) held[k][c] += node[k][c] - before[k][c];
}

/* Friction, boundaries and damping of the nodes, with their energies and unbalanced forces where
 * these are needed. */
static void damp(mps_mpm *mpm, int64_t g, const uint8_t *fixed, const mpsi_node *held,
                 mpsi_node *damped) {
  const mpsi_node *node = (const mpsi_node *)(mpm->grid.node + mpsi_first_node(&mpm->grid, g));
  memcpy(damped, node, (size_t)mpm->grid.block_nodes * sizeof *damped);
  if (mpm->settling.on)
    mpsi_mpm_measure_balance(&mpm->grid, &mpm->contact, &mpm->settling, mpm->run.dt, g, fixed,
                             held);
  mpsi_mpm_damp_nodes(&mpm->grid, &mpm->def, mpm->run.dt, g, fixed);
  if (mpm->energy.counts)
    mpsi_mpm_energy_nodes(&mpm->grid, &mpm->contact, &mpm->energy, mpm->run.dt, g, held,
                          (const mpsi_node *)damped);
}

static void finish_and_damp(mps_mpm *mpm, int64_t g, copies *scratch) {
  uint8_t fixed[MOST] = {0};
  apply_body_friction(mpm, g, scratch->held, scratch);
  mpsi_mpm_prescribe_nodes(&mpm->grid, &mpm->boundaries, mpm->run.dt, g, scratch->impulses, fixed);
  damp(mpm, g, fixed, (const mpsi_node *)scratch->held, scratch->damped);
}

static bool damps(const mps_mpm *mpm) {
  return mpsi_forces_apart(&mpm->energy, &mpm->settling, &mpm->p, &mpm->def) ||
         mpm->def.viscous_damping > 0.0;
}

static void finish(mps_mpm *mpm, int64_t g, copies *scratch) {
  uint8_t own[MOST], *fixed = own;
  if (mpm->prescribed.on) {
    fixed = mpm->prescribed.fixed + mpsi_first_node(&mpm->grid, g);
    if (damps(mpm)) {
      apply_body_friction(mpm, g, mpm->prescribed.before + mpsi_first_node(&mpm->grid, g), scratch);
      mpsi_mpm_prescribe_nodes(&mpm->grid, &mpm->boundaries, mpm->run.dt, g, scratch->impulses,
                               fixed);
      return;
    }
  } else if (damps(mpm)) {
    finish_and_damp(mpm, g, scratch);
    return;
  }
  if (mpm->grid.nodes[g].pairs > 0) {
    mpsi_mpm_prescribe_mirrors(&mpm->grid, &mpm->boundaries, &mpm->mirrors, mpm->run.dt, g);
    mpsi_mpm_apply_friction(&mpm->grid, &mpm->contact, mpm->run.dt, g);
  }
  mpsi_mpm_prescribe_nodes(&mpm->grid, &mpm->boundaries, mpm->run.dt, g, scratch->impulses, fixed);
}

void mpsi_mpm_finish_nodes(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  copies *scratch = mpm->grid.workers[worker].scratch;
  const int32_t across = mpm->grid.nodes[g].across;
  mpsi_mpm_begin_held(&mpm->grid, &mpm->boundaries, g);
  finish(mpm, g, scratch);
  if (across >= 0) finish(mpm, across, scratch);
}

void mpsi_mpm_damp_after_lists(void *data, int64_t g, int32_t worker) {
  mps_mpm *mpm = data;
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  if (!damps(mpm)) return;
  copies *scratch = mpm->grid.workers[worker].scratch;
  damp(mpm, g, mpm->prescribed.fixed + first, (const mpsi_node *)mpm->prescribed.before + first,
       scratch->damped);
  if (mpm->grid.nodes[g].across >= 0)
    mpsi_mpm_damp_after_lists(data, mpm->grid.nodes[g].across, worker);
}
