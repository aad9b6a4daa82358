/* implicit.c - pressures of cells, implicit in time, and the velocities that they correct. With the
 * velocities v* of the nodes under the forces of the old pressures, contacts made and boundaries
 * foreseen (foresee.c),
 *
 *   [S + dt T + dt^2 G^T m^-1 G] d = dt (fluxes at p) - dt G^T v*,   v = v* + dt m^-1 G d
 *
 * gives the increments d of the pressures p; S = V n/K_w, T are the fluxes per difference of
 * pressure, and G the forces on the nodes per pressure of a cell, by the supports that the
 * particles have in the step (forces.c): dt G^T v is what the particles will change their volumes
 * by. So neither waves in the water nor its flow limit the step, which is that of the dry ground.
 * The matrix is symmetric and positive definite, also where contacts hold the correction
 * (contacts.c), and conjugate gradients solve it (solve/gradients.h).
 *
 * The forces F p of P2G, by the pressures and slopes of particles, differ from G p in cells that
 * are filled in part, at walls and beside bodies. Such a difference acts as an explicit spring,
 * which is not stable for K_w far above the ground's modulus. But those of the ground's stresses,
 * which must cancel these at a free surface, are by particles too. So P2G takes the forces of a
 * mean s of the pressures over some 32 steps, and before contacts the nodes get those of what the
 * cells are above it, G (p - s): only what is slow is by particles, and at rest all is.
 *
 * Vectors are by cells, loops by blocks; a block's part of a sum is added in the order of its
 * cells, and the parts exactly, so that no bit depends on the number of threads or ranks. On
 * several ranks each solves for the cells that it counts, with those of its wide halo (wide_halo.h)
 * beside them. SPDX-License-Identifier: BSD-3-Clause */
#include "implicit.h"

#include "contacts.h"
#include "forces.h"
#include "halo.h"
#include "wide_halo.h"
#include "solve/gradients.h"
#include "solve/operator.h"

typedef struct mpsi_pore_system system_of;

static void take(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  mpsi_pore_cell *cell = mpm->water->cell + first;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k)) cell[k].now = cell[k].p + s->change[first + k];
}

/* The change of volume that the motion without changes of the pressures makes. */
static void take_motion(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    const double carried = s->carried[first + k] / mpm->grid.measure;
    s->squeeze[first + k] = mpm->run.dt * (mpsi_pore_squeeze_of(mpm, s, g, k, shift) + carried);
    s->residual[first + k] -= s->squeeze[first + k];
  }
}

/* What the corrected motion takes of the cells of a block, over their space. */
static void find_squeeze(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const double dt = mpm->run.dt;
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    const double own = s->squeeze[first + k] + dt * dt * mpsi_pore_squeeze_of(mpm, s, g, k, shift);
    s->squeeze[first + k] = own / s->space[first + k];
  }
}

/* Corrects the velocities of the nodes of a block; dashpots and damping, which have yet to act,
 * will leave that part of it which m is of the inertia. */
static void correct(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  const int32_t across = grid->nodes[g].across;
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!(grid->node[first + k][MPSI_MASS] > 0.0)) continue;
    double *other = across < 0 ? NULL : grid->node[mpsi_first_node(grid, across) + k];
    for (int c = 0; c < grid->dim; c++) {
      const double v = s->velocity[first + k][c];
      if (v == 0.0) continue; /* prescribed, of an infinite inertia */
      const double by = factor * v * (s->inertia[first + k][c] / grid->node[first + k][MPSI_MASS]);
      grid->node[first + k][MPSI_VECTOR + c] += by;
      if (other && other[MPSI_MASS] > 0.0) other[MPSI_VECTOR + c] += by;
    }
  }
}

/* Velocities and volumes by the changes of the pressures that have been found. */
static mps_status move_nodes(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  const int64_t cells = mpm->grid.node_count * mpm->grid.block_nodes; /* a rank may have none */
  if (cells > 0) memcpy(s->direction, s->change, (size_t)cells * sizeof *s->change);
  MPSI_TRY(mpsi_pore_find_motion(mpm, function));
  mpsi_pore_bear_contacts(mpm);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, find_squeeze, 0.0);
  return MPS_OK;
}

/* `ahead` of a block's cells, as the direction of the operator. */
static void take_ahead(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    const bool unknown = mpsi_pore_is_unknown(mpm->water, g, k);
    s->ahead[first + k] = unknown ? cell[k].change / cell[k].volume : 0.0;
    s->direction[first + k] = s->ahead[first + k];
  }
}

mps_status mpsi_pore_press_nodes(mps_mpm *mpm, const char *function) {
  mpsi_pore_find_reach(mpm);
  mps_status status = mpsi_pore_find_forces(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, take_ahead, 0.0);
  if (mpm->partition) status = mpsi_pore_send_direction(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, mpsi_pore_find_velocities, 0.0);
  if (mpm->partition) status = mpsi_pore_send_changes(mpm, function);
  if (status == MPS_OK) mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, correct, mpm->run.dt);
  return status;
}

/* By the pressure on what is beyond mirrors of cell `local` of block g, that P2G had not. */
static void add_reaction(mps_mpm *mpm, int64_t g, int local) {
  const mpsi_grid *grid = &mpm->grid;
  const system_of *s = mpm->water->system;
  const int64_t cell = mpsi_first_node(grid, g) + local;
  int place[3];
  double x[3];
  mpsi_unravel(local, MPSI_SIDE, place);
  const double middle[3] = {place[0] + 0.5, place[1] + 0.5, place[2] + 0.5};
  mpsi_node_position(grid, grid->nodes[g].at, middle, x);
  for (int d = 0; d < 2 * grid->dim; d++) {
    mpsi_boundary *side = &mpm->boundaries.boundary[d];
    double impulse[3] = {0.0}, moment[3];
    impulse[d / 2] = mpm->run.dt * (s->ahead[cell] + s->change[cell]) * s->turned[cell][d];
    if (impulse[d / 2] == 0.0) continue;
    mpsi_cross3(x, impulse, moment);
    mpsi_mpm_boundary_add_impulse(side, impulse, moment, mpsi_dot3(impulse, side->v), 0);
  }
}

void mpsi_pore_add_reactions(mps_mpm *mpm) {
  const mpsi_water *water = mpm->water;
  if (!mpsi_pore_predicts(mpm)) return;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    if (!mpsi_mpm_counts_node_block(&mpm->grid, g)) continue;
    const mpsi_pore_block *block = &water->block[g];
    for (int w = 0; w < MPSI_PORE_WORDS; w++) /* cells at a side are not inside */
      for (uint64_t left = block->filled[w] & ~block->inside[w]; left; left &= left - 1)
        add_reaction(mpm, g, 64 * w + mpsi_pore_lowest(left));
  }
}

mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function) {
  MPSI_TRY(mpsi_pore_find_nodes(mpm, function));
  MPSI_TRY(mpsi_pore_find_contacts(mpm, function));
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, take_motion, 0.0);
  MPSI_TRY(mpsi_pore_find_changes(mpm, function));
  MPSI_TRY(move_nodes(mpm, function));
  if (mpm->partition) MPSI_TRY(mpsi_pore_send_changes(mpm, function));
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, take, 0.0);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, correct, mpm->run.dt);
  mpsi_pore_exchange(mpm, MPSI_PORE_NOW);
  return MPS_OK;
}
