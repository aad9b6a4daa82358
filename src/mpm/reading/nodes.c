/* nodes.c - nodes of the grid for a reader (mps/grid.h): mass, momentum and forces of the
 * particles' present state, Nakamura (23)-(25), (29), with forces apart from momenta. Only scratch
 * memory changes, or what the next step would change first.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/ranks/parcels.h"
#include "mpm/step/tiles.h"

#include <mps/grid.h>

mps_grid *mps_mpm_grid(mps_mpm *mpm) { return mpm ? &mpm->reader : NULL; }

mps_status mps_grid_get_info_sized(const mps_grid *grid, mps_grid_info *out, size_t size) {
  if (!grid) return MPS_ERROR_ARGUMENT;
  const mps_mpm *mpm = grid->mpm;
  mps_grid_info info = {.cell = mpm->grid.cell, .dim = mpm->grid.dim, .spline = mpm->grid.spline};
  for (int c = 0; c < mpm->grid.dim; c++) info.origin[c] = mpm->grid.origin[c];
  return mpsi_out_write(mpm->context, "mps_grid_get_info", out, size, &info, sizeof info);
}

/* P2G with forces apart, after all preparations. */
static mps_status sum_nodes(mps_mpm *mpm, const char *function) {
  mpsi_pass pass = {.data = mpm, .clear = mpsi_mpm_clear_nodes, .scatter = mpsi_step_scatter};
  if (mpm->partition) {
    pass.scatter = mpsi_mpm_scatter_tile;
    pass.arrive = mpsi_step_receive_parcels;
    const mps_status status = mpsi_mpm_send_tiles(mpm, function);
    if (status != MPS_OK) return status;
  }
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
  status = mpsi_mpm_evaluate_signals(mpm, function, mps_mpm_dt(mpm), false);
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
  if (!grid) return MPS_ERROR_ARGUMENT;
  mps_mpm *mpm = grid->mpm;
  mps_status status = MPS_OK;
  if (capacity < 0 || !count)
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "capacity is %lld and count %s, must be >= 0 and given", (long long)capacity,
                       count ? "given" : "NULL");
  status = make_sums(mpm, __func__, status);
  if (status != MPS_OK) return status;
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

/* ---- nodes as a set of particles ------------------------------------------------------------- */

static mps_status check_set(const mps_mpm *mpm, const char *function, mps_particles *set) {
  if (!set || mpsi_particles_context(set) != mpm->context ||
      mps_particles_dim(set) != mpm->grid.dim)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "set is %s, must be one of this context with %d dimensions",
                     set ? "of another context or dimension" : "NULL", mpm->grid.dim);
  return mpsi_particles_check_hold(set, function, MPSI_USE_MOVE);
}

/* Gives the set as many particles as there are nodes. */
static mps_status resize(mps_context *context, const mpsi_grid *grid, const char *function,
                         mps_particles *set, int64_t count, const double *x) {
  const int64_t have = mps_particles_count(set);
  if (count < have) {
    const int64_t *id = mpsi_particles_integers(set, "id");
    return mpsi_as(context, function, mps_particles_remove(set, have - count, id + count));
  }
  double *places = mpsi_alloc(context, (count - have) * grid->dim, sizeof *places);
  if (!places) return mpsi_fail_memory(context, function, (size_t)(count - have) * 24);
  for (int64_t k = have; k < count; k++)
    for (int c = 0; c < grid->dim; c++) places[(k - have) * grid->dim + c] = x[3 * k + c];
  const mps_status status =
      mpsi_as(context, function, mps_particles_append(set, count - have, places));
  mpsi_free(context, places);
  return status;
}

static void write_columns(mps_particles *set, const char *name, int64_t count, int32_t width,
                          const double *from) {
  for (int32_t c = 0; c < 3; c++) {
    double *column = mpsi_particles_column(set, name, c);
    for (int64_t k = 0; column && k < count; k++) column[k] = from[width * k + c];
  }
}

/* Writes the `count` nodes of `grid` to `set`, with `memory` for 10 numbers each. */
static mps_status fill(mps_grid *grid, const char *function, mps_particles *set, int64_t count,
                       double *memory) {
  mps_mpm *mpm = grid->mpm;
  const int32_t fields = mps_particles_field_count(set);
  double *x = memory, *v = x + 3 * count, *f = v + 3 * count, *mass = f + 3 * count;
  mps_status status =
      mpsi_as(mpm->context, function, mps_grid_get_nodes(grid, count, &count, x, mass, v, f));
  if (status == MPS_OK)
    status = mpsi_as(mpm->context, function, mps_particles_add_field(set, "mass", 0));
  if (status == MPS_OK)
    status = mpsi_as(mpm->context, function, mps_particles_add_field(set, "velocity", 0));
  if (status == MPS_OK)
    status = mpsi_as(mpm->context, function, mps_particles_add_field(set, "force", mpm->grid.dim));
  if (status == MPS_OK) status = resize(mpm->context, &mpm->grid, function, set, count, x);
  if (status != MPS_OK) {
    mpsi_particles_drop_fields(set, fields);
    return status;
  }
  write_columns(set, "position", count, 3, x);
  write_columns(set, "velocity", count, 3, v);
  write_columns(set, "force", count, 3, f);
  write_columns(set, "mass", count, 1, mass);
  return MPS_OK;
}

mps_status mps_grid_fill(mps_grid *grid, mps_particles *set) {
  if (!grid) return MPS_ERROR_ARGUMENT;
  mps_mpm *mpm = grid->mpm;
  const mpsi_edit_state before = mpsi_mpm_edit_state(&mpm->run);
  int64_t count = 0;
  mps_status status = mpsi_mpm_agree(mpm->partition, __func__, check_set(mpm, __func__, set));
  if (status == MPS_OK)
    status = mpsi_as(mpm->context, __func__,
                     mps_grid_get_nodes(grid, 0, &count, NULL, NULL, NULL, NULL));
  if (status != MPS_OK) return status;
  double *memory = mpsi_alloc(mpm->context, count * 10, sizeof *memory);
  if (!memory) status = mpsi_fail_memory(mpm->context, __func__, (size_t)count * 80);
  status = mpsi_mpm_agree(mpm->partition, __func__, status);
  if (status == MPS_OK)
    status = mpsi_mpm_agree(mpm->partition, __func__, fill(grid, __func__, set, count, memory));
  if (status != MPS_OK) mpsi_mpm_restore_edit_state(&mpm->run, &before);
  mpsi_free(mpm->context, memory);
  return status;
}
