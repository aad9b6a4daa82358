/* nodes.c - nodes of the grid for a reader (mps/grid.h): mass, momentum and forces of the
 * particles' present state, Nakamura (23)-(25), (29), with forces apart from momenta. Only scratch
 * memory changes, or what the next step would change first.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/ranks/messages.h"
#include "mpm/step/tiles.h"

#include <mps/grid.h>

mps_grid *mps_mpm_grid(mps_mpm *mpm) { return mpm ? &mpm->reader : NULL; }

mps_status mps_grid_get_info_sized(const mps_grid *grid, mps_grid_info *out, size_t size) {
  if (!grid) return mpsi_null(__func__, "grid");
  const mps_mpm *mpm = grid->mpm;
  mps_grid_info info = {.cell = mpm->grid.cell, .dim = mpm->grid.dim, .spline = mpm->grid.spline};
  for (int c = 0; c < mpm->grid.dim; c++) info.origin[c] = mpm->grid.origin[c];
  return mpsi_out_write(mpm->context, "mps_grid_get_info", out, size, &info, sizeof info);
}

/* P2G with forces apart, after all preparations. */
static mps_status sum_nodes(mps_mpm *mpm, const char *function) {
  const mpsi_pass pass = {.data = mpm,
                          .clear = mpsi_mpm_clear_nodes,
                          .scatter = mpsi_step_scatter,
                          .ranks = mpm->partition,
                          .arrive = mpsi_mpm_receive_messages};
  MPSI_TRY(mpm->partition ? mpsi_mpm_send_tiles(mpm, function) : MPS_OK);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  return mpm->partition ? mpm->partition->lost : MPS_OK;
}

/* P2G after the caller's edits are applied. `status`: of the call so far on this rank. */
static mps_status find_sums(mps_mpm *mpm, const char *function, mps_status status) {
  status = mpsi_mpm_agree(mpm->partition, function, status);
  if (status == MPS_OK) status = mpsi_mpm_apply_edits(mpm, function);
  if (status == MPS_OK && mpm->partition) status = mpsi_mpm_partition_update(mpm, function, status);
  if (status == MPS_OK && mpm->run.stale) {
    status = mpsi_mpm_sort(mpm, function);
    mpm->boundaries.outdated = true;
  }
  if (status != MPS_OK) return status; /* on all ranks */
  mpm->grid.apart = true;
  status = mpsi_mpm_evaluate_signals(mpm, function, mpsi_mpm_dt(mpm), false);
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(mpm);
  status = mpsi_mpm_update_boundaries(&boundaries, function, status);
  status = mpsi_mpm_find_near(mpm, function, status);
  if (status == MPS_OK)
    status =
        mpsi_mpm_find_forces(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->loads, function);
  if (mpm->partition) status = mpsi_mpm_agree_before_step(mpm, function, status);
  if (status == MPS_OK) status = sum_nodes(mpm, function);
  mpm->grid.apart = false;
  return status;
}

/* Sums of mass, momentum and force at the nodes; one that fails leaves the edits unread.
 * Collective. */
static mps_status make_sums(mps_mpm *mpm, const char *function, mps_status status) {
  const mpsi_edit_state before = mpsi_mpm_edit_state(&mpm->run);
  status = find_sums(mpm, function, status);
  if (status != MPS_OK) mpsi_mpm_restore_edit_state(&mpm->run, &before);
  return status;
}

typedef struct node {
  double x[3], v[3], f[3], mass;
} node;

/* Values of node k of block g; false where no particle reaches it. */
static bool read_node(const mpsi_grid *grid, const mpsi_contacts *contacts, int64_t g, int k,
                      node *out) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  if (nodes->side < 0) return false; /* the tile's part over it is not in use */
  const double *sum = grid->node[mpsi_first_node(grid, g) + k];
  const double *side = grid->side[mpsi_first_node(grid, nodes->side) + k];
  const double weight = sum[MPSI_MASS] + side[MPSI_EXCESS];
  if (!(weight > 0.0)) return false;
  const double carried = grid->by_weight ? weight : mpsi_carried_mass(sum[MPSI_MASS], weight);
  mpsi_node_place(grid, nodes->at, k, out->x);
  out->mass = sum[MPSI_MASS];
  for (int c = 0; c < 3; c++) {
    out->v[c] = c < grid->dim ? sum[MPSI_VECTOR + c] / carried : 0.0;
    out->f[c] = c < grid->dim ? side[MPSI_VECTOR + c] : 0.0;
  }
  const int32_t pairs = contacts->penalty_bodies > 0 ? nodes->pairs : 0;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + pairs; t++) {
    const mpsi_contact_node *at = &contacts->node[(int64_t)t * grid->block_nodes + k];
    for (int c = 0; c < grid->dim && at->mass != 0.0; c++) out->f[c] += at->force[c];
  }
  return true;
}

static void put(double *array, int64_t n, const double *value) {
  for (int c = 0; array && c < 3; c++) array[3 * n + c] = value[c];
}

mps_status mps_grid_get_nodes(const mps_grid *grid, int64_t capacity, int64_t *count,
                              double *position, double *mass, double *velocity, double *force) {
  if (!grid) return mpsi_null(__func__, "grid");
  mps_mpm *mpm = grid->mpm;
  mps_status status = MPS_OK;
  if (!count)
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "count is NULL");
  else if (capacity < 0)
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                       (long long)capacity);
  MPSI_TRY(make_sums(mpm, __func__, status));
  int64_t n = 0;
  for (int64_t g = 0; g < mpsi_all_nodes(&mpm->grid); g++)
    for (int k = 0; k < mpm->grid.block_nodes; k++) {
      if (mpm->partition && !mpsi_mpm_counts_node_block(&mpm->grid, g)) break;
      node at;
      if (!read_node(&mpm->grid, &mpm->contact, g, k, &at)) continue;
      if (n < capacity) {
        put(position, n, at.x);
        put(velocity, n, at.v);
        put(force, n, at.f);
        if (mass) mass[n] = at.mass;
      }
      n++;
    }
  *count = n;
  return MPS_OK;
}
