/* update.c - the water's part of a step: what comes before the scatter, and what comes after the
 * particles have moved. SPDX-License-Identifier: BSD-3-Clause */
#include "layers.h"
#include "mpm/base/kernels.h"
#include "system.h"
#include "water.h"

#include <string.h>

enum { EVERY = 8, SLOPES = 32 }; /* steps: at most between two exchanges; in which slopes follow */
#define VISCOSITY 0.008          /* of the water, over that of a wave that crosses a cell */

/* ---- before ---------------------------------------------------------------------------------- */

/* Of blocks of cells that have been laid out; those of other ranks come last. */
static mps_status make_room(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                            mpsi_water *water, const char *function) {
  const int64_t blocks = grid->node_count + (water->layers ? water->layers->blocks : 0);
  const int64_t nodes = blocks * grid->block_nodes;
  if (!mpsi_room_ensure(context, &water->cell_room, nodes, sizeof *water->cell) ||
      !mpsi_room_ensure(context, &water->edge_room, nodes, sizeof *water->edge) ||
      !mpsi_room_ensure(context, &water->block_room, blocks, sizeof *water->block) ||
      !mpsi_room_ensure(context, &water->linked_room, grid->node_count, sizeof *water->linked_at) ||
      !mpsi_room_ensure(context, &water->outflow_room, grid->node_count, sizeof *water->outflow) ||
      !mpsi_room_ensure(context, &water->former_room, p->count, sizeof *water->former) ||
      !mpsi_room_ensure(context, &water->expected_room,
                        water->def.scheme == MPS_PORE_SCHEME_IMPLICIT ? p->count : 0,
                        sizeof *water->expected) ||
      !mpsi_room_ensure(context, &water->place_room, p->count, sizeof *water->place))
    return mpsi_fail_memory(context, function, (size_t)nodes * sizeof *water->cell);
  water->cell = water->cell_room.item;
  water->edge = water->edge_room.item;
  water->block = water->block_room.item;
  water->linked_at = water->linked_room.item;
  water->outflow = water->outflow_room.item;
  water->former = water->former_room.item;
  water->expected = water->expected_room.item;
  water->place = water->place_room.item;
  return MPS_OK;
}

/* Number of the block of nodes at `at` whose cells are known here, or -1. */
static int32_t find_block(const mpsi_grid *grid, const mpsi_water *water, const int32_t *at) {
  const int32_t own = mpsi_pore_own_block(grid, at);
  if (own >= 0 || !water->layers) return own;
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
  if (water->layers && water->layers->searches == mpm->partition->searches) return status;
  if (status == MPS_OK && !water->layers) {
    water->layers = mpsi_alloc(mpm->context, 1, sizeof *water->layers);
    if (!water->layers) status = mpsi_fail_memory(mpm->context, function, sizeof *water->layers);
    if (water->layers) *water->layers = (mpsi_pore_layers){.searches = -1};
  }
  status = mpsi_domain_agree(mpm->partition->domain, function, status);
  if (status == MPS_OK) status = mpsi_pore_find_layers(mpm, function);
  water->linked = -1;
  return status;
}

void mpsi_pore_keep_volumes(mps_mpm *mpm, int64_t b) {
  const mpsi_cell_block *cells = &mpm->grid.cells[b];
  if (!mpm->water || mpsi_pore_responds(mpm->water)) return;
  memcpy(mpm->water->former + cells->begin, mpm->p.V + cells->begin,
         (size_t)(cells->end - cells->begin) * sizeof *mpm->p.V);
}

/* A cone that moved so had a force 8 % too low, and ground beside it had lost up to 13 % of its
 * volume (docs/pore-water.md). */
static void warn_of_bodies(mps_mpm *mpm) {
  mpsi_water *water = mpm->water;
  if (water->warned || water->flows || water->def.scheme != MPS_PORE_SCHEME_IMPLICIT) return;
  for (int32_t b = 0; b < mpm->contact.bodies && !water->warned; b++)
    water->warned = mpsi_contact_speed(mpm->contact.handle[b]) > 0.0;
  if (water->warned)
    mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
             "implicit pressures of undrained ground lag beside a body that moves: its forces are "
             "too low, and ground beside its edges loses volume; take explicit ones");
}

mps_status mpsi_pore_begin(mps_mpm *mpm, const char *function, mps_status status) {
  if (!mpm->water) return status;
  status = renew_layers(mpm, function, status);
  if (status == MPS_OK) status = make_room(mpm->context, &mpm->grid, &mpm->p, mpm->water, function);
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
  }
  link_blocks(&mpm->grid, mpm->water);
  warn_of_bodies(mpm);
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
  if (!water->due) return;
  const bool lags = mpsi_pore_responds(water) && mpm->run.steps > 1;
  water->share = lags ? fmin(1.0, (double)water->steps / SLOPES) : 1.0;
  mpsi_pore_find_cells(mpm);
  mpsi_pore_find_faces(mpm);
  mpsi_pore_flow(mpm);
  if (water->flows) sum_outflow(&mpm->grid, water, water->elapsed);
  water->elapsed = 0.0;
  water->steps = 0;
}
