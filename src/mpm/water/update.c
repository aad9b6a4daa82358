/* update.c - the water's part of a step: what comes before the scatter, and what comes after the
 * particles have moved. SPDX-License-Identifier: BSD-3-Clause */
#include "halo.h"

#include "core/base/room_array.h"
#include "mpm/boundary/free_field.h"
#include "mpm/base/kernels.h"
#include "mpm/particles/mpm_particles.h"
#include "system.h"
#include "water.h"

#include <string.h>

enum { EVERY = 8, SLOPES = 32 }; /* steps: at most between two exchanges; in which slopes follow */
#define VISCOSITY 0.008          /* of the water, over that of a wave that crosses a cell */

/* ---- before ---------------------------------------------------------------------------------- */

/* Of blocks of cells that have been laid out; those of other ranks come last. */
static mps_status make_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                            mpsi_water *water, int64_t column, const char *function) {
  const int64_t blocks = grid->node_count + (water->halo ? water->halo->blocks : 0);
  const int64_t nodes = blocks * grid->block_nodes;
  if (!MPSI_ENSURE(context, water, cell, nodes) || !MPSI_ENSURE(context, water, faces, nodes) ||
      !MPSI_ENSURE(context, water, block, blocks) ||
      !mpsi_room_ensure(context, &water->linked_room, grid->node_count, sizeof *water->linked_at) ||
      !MPSI_ENSURE(context, water, outflow, grid->node_count) ||
      !MPSI_ENSURE(context, water, former, p->count) ||
      !MPSI_ENSURE(context, water, rest, mpsi_pore_responds(water) ? 0 : p->count) ||
      !MPSI_ENSURE(context, water, column, column) || !MPSI_ENSURE(context, water, place, p->count))
    return mpsi_fail_memory(context, function, (size_t)nodes * sizeof *water->cell);
  water->linked_at = water->linked_room.item;
  return MPS_OK;
}

/* Number of the block of nodes at `at` whose cells are known here, or -1. */
static int32_t find_block(const mpsi_grid *grid, const mpsi_water *water, const int32_t *at) {
  const int32_t own = mpsi_pore_own_block(grid, at);
  if (own >= 0 || !water->halo) return own;
  return mpsi_pore_guest_block(grid, water, at);
}

static bool are_linked(const mpsi_grid *grid, const mpsi_water *water) {
  bool same = water->linked == grid->node_count;
  for (int64_t g = 0; same && g < grid->node_count; g++)
    same = memcmp(water->linked_at[g], grid->nodes[g].at, sizeof water->linked_at[g]) == 0;
  return same;
}

static void link_blocks(const mpsi_grid *grid, mpsi_water *water) {
  if (are_linked(grid, water)) return;
  for (int64_t g = 0; g < grid->node_count; g++) {
    memcpy(water->linked_at[g], grid->nodes[g].at, sizeof water->linked_at[g]);
    for (int d = 0; d < 6; d++) {
      int32_t at[3];
      memcpy(at, grid->nodes[g].at, sizeof at);
      at[d / 2] += d & 1 ? 1 : -1;
      const bool known = d < 2 * grid->dim && !grid->nodes[g].foreign;
      water->block[g].beside[d] = known ? find_block(grid, water, at) : -1;
    }
  }
  water->linked = grid->node_count;
}

/* On several ranks: the layers of the present ghosts. Collective. */
static mps_status renew_layers(mps_mpm *mpm, const char *function, mps_status status) {
  mpsi_water *water = mpm->water;
  if (!mpm->partition) return status;
  if (water->halo && water->halo->searches == mpm->partition->searches) return status;
  if (status == MPS_OK && !water->halo) {
    water->halo = mpsi_alloc(mpm->context, 1, sizeof *water->halo);
    if (!water->halo) status = mpsi_fail_memory(mpm->context, function, sizeof *water->halo);
    if (water->halo) *water->halo = (mpsi_pore_halo){.searches = -1};
  }
  status = mpsi_domain_agree(mpm->domain, function, status);
  if (status == MPS_OK) status = mpsi_pore_find_halo(mpm, function);
  water->linked = -1;
  return status;
}

/* Scenes for which the matrix is not right, the same on all ranks. The forces of cells (forces.c)
 * do not part the ground on both sides of a thin body, which those of particles do; local damping
 * is no linear function of the correction (foresee.c). */
static mps_status refuse_scene(const mps_mpm *mpm, const char *function) {
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    if (mpm->contact.state[b].parts)
      return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                       "contact %d is with a body that has a wall thinner than %g cells of %g m: "
                       "MPS_PORE_SCHEME_IMPLICIT does not hold beside it, choose smaller cells or "
                       "MPS_PORE_SCHEME_EXPLICIT",
                       b, MPSI_THIN_CELLS, mpm->grid.cell);
  if (mpm->def.local_damping > 0.0)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "local_damping is %g, must be 0 where the scheme of pore water is "
                     "MPS_PORE_SCHEME_IMPLICIT: use viscous_damping",
                     mpm->def.local_damping);
  return MPS_OK;
}

mps_status mpsi_pore_begin(mps_mpm *mpm, const char *function, mps_status status) {
  if (!mpm->water) return status;
  if (status == MPS_OK && mpsi_pore_predicts(mpm)) status = refuse_scene(mpm, function);
  status = renew_layers(mpm, function, status);
  int64_t column = 0;
  for (int side = 0; side < 2; side++) {
    const mpsi_free_field *field = mpm->boundaries.boundary[side].field;
    if (field && field->nodes > column) column = field->nodes;
  }
  if (status == MPS_OK)
    status = make_room(mpm->context, &mpm->grid, &mpm->p, mpm->water, column, function);
  if (mpm->water->def.scheme == MPS_PORE_SCHEME_IMPLICIT)
    status = mpsi_pore_make_system(mpm, function, status);
  if (status != MPS_OK) return status;
  const double impedance = sqrt(mpm->water->def.density * mpm->water->def.bulk); /* Pa s/m */
  mpm->water->viscosity =
      mpsi_pore_responds(mpm->water) ? VISCOSITY * impedance * mpm->grid.cell : 0.0;
  for (int c = 0; c < 3; c++)
    mpm->water->seepage[c] =
        c < mpm->grid.dim ? mpsi_particles_column(mpm->p.set, "seepage", c) : NULL;
  if (mpm->run.steps == 0) {
    memset(&mpm->water->start, 0, sizeof mpm->water->start);
    mpsi_pore_mass(&mpm->p, mpm->water, &mpm->water->start);
    mpsi_pore_begin_means(&mpm->p);
  }
  mpm->water->noted = false;
  link_blocks(&mpm->grid, mpm->water);
  return MPS_OK;
}

void mpsi_pore_plan(mps_mpm *mpm) {
  mpsi_water *water = mpm->water;
  if (!water) return;
  const double after = water->elapsed + 2.0 * mpm->run.dt; /* that of an exchange one step later */
  const bool short_flow = after * mpm->run.flow > mpm->def.courant * mpm->grid.cell;
  const bool first = mpm->run.steps == 0; /* pressures as the caller wrote them, without slopes */
  water->due = !mpsi_pore_responds(water) || first || water->steps + 1 >= EVERY || short_flow;
}

static void find_speed(void *data, int64_t b, int32_t worker) {
  mps_mpm *mpm = data;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  mpm->kernels->speed(&work);
}

void mpsi_pore_set_scheme(mps_mpm *mpm, int32_t scheme) {
  mpm->water->def.scheme = scheme;
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
  mpsi_pore_begin_means(&mpm->p);
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, find_speed, mpm);
}

/* ---- after ----------------------------------------------------------------------------------- */

/* What blocks have let out, each block counted on one rank: exactly, in whatever order. */
static void sum_outflow(const mpsi_grid *grid, mpsi_water *water, double dt) {
  const double amount = water->def.density * grid->measure;
  memset(water->rate, 0, sizeof water->rate);
  for (int64_t g = 0; g < grid->node_count; g++) {
    if (!mpsi_mpm_counts_node_block(grid, g)) continue;
    for (int f = 0; f < MPSI_PORE_FACES; f++) {
      const double rate = amount * water->outflow[g][f];
      if (rate == 0.0) continue;
      mpsi_exact_add(&water->rate[f], rate);
      mpsi_exact_add(&water->drained[f], rate * dt);
    }
    const double entering = amount * water->outflow[g][MPSI_PORE_FACES];
    if (entering != 0.0) mpsi_exact_add(&water->entered, entering * dt);
  }
}

void mpsi_pore_update(mps_mpm *mpm) {
  mpsi_water *water = mpm->water;
  if (!water) return;
  water->elapsed += mpm->run.dt;
  water->steps++;
  if (!water->due) {
    mpsi_pore_update_columns(mpm);
    return;
  }
  const bool lags = mpsi_pore_responds(water) && mpm->run.steps > 1;
  water->share = lags ? fmin(1.0, (double)water->steps / SLOPES) : 1.0;
  mpsi_pore_note_rest(mpm);
  mpsi_pore_find_cells(mpm);
  mpsi_pore_find_faces(mpm);
  mpsi_pore_flow(mpm);
  mpsi_pore_update_columns(mpm);
  if (water->flows) sum_outflow(&mpm->grid, water, water->elapsed);
  water->elapsed = 0.0;
  water->steps = 0;
}
