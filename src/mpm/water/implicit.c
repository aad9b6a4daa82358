/* implicit.c - pressures of cells, implicit in time, and the velocities that they correct. With the
 * velocities v* of the nodes under the forces of the old pressures, contacts made,
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
 * Vectors are by cells, loops by blocks; a block's part of a sum is added in the order of its
 * cells, and the parts exactly, so that no bit depends on the number of threads or ranks. On
 * several ranks each solves for the cells that it counts, with those of its rim (rim.h) beside
 * them. SPDX-License-Identifier: BSD-3-Clause */
#include "implicit.h"

#include "contacts.h"
#include "forces.h"
#include "layers.h"
#include "rim.h"
#include "solve/gradients.h"
#include "solve/operator.h"

typedef struct mpsi_pore_system system_of;

static void take(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  mpsi_pore_cell *cell = mpm->water->cell + first;
  (void)factor;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k, cell))
      cell[k].now = cell[k].p + s->change[first + k];
}

/* The change of volume that the motion without changes of the pressures makes. */
static void take_motion(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  mpsi_pore_list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k, cell)) continue;
    const double carried = s->scale[first + k] * s->carried[first + k] / mpm->grid.measure;
    s->squeeze[first + k] = mpm->run.dt * (mpsi_pore_squeeze_of(mpm, s, g, k, shift) + carried);
    s->residual[first + k] -= s->squeeze[first + k];
  }
}

/* What the corrected motion takes of the cells of a block, over their space. */
static void find_squeeze(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  const double dt = mpm->run.dt;
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  mpsi_pore_list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k, cell)) continue;
    const double own = s->squeeze[first + k] + dt * dt * mpsi_pore_squeeze_of(mpm, s, g, k, shift);
    s->squeeze[first + k] = own / s->space[first + k];
  }
}

/* Corrects the velocities of the nodes of a block. */
static void correct(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  const int32_t across = grid->nodes[g].across;
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!(grid->node[first + k][MPSI_MASS] > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++)
      grid->node[first + k][MPSI_VECTOR + c] += factor * s->velocity[first + k][c];
    double *other = across < 0 ? NULL : grid->node[mpsi_first_node(grid, across) + k];
    for (int c = 0; c < grid->dim && other && other[MPSI_MASS] > 0.0; c++)
      other[MPSI_VECTOR + c] += factor * s->velocity[first + k][c];
  }
}

/* Velocities and volumes by the changes of the pressures that have been found. */
static mps_status move_nodes(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  const int64_t cells = mpm->grid.node_count * mpm->grid.block_nodes; /* a rank may have none */
  if (cells > 0) memcpy(s->direction, s->change, (size_t)cells * sizeof *s->change);
  const mps_status status = mpsi_pore_find_motion(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_bear_contacts(mpm);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, find_squeeze, 0.0);
  return MPS_OK;
}

mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function) {
  mpsi_pore_find_tiles(mpm);
  mps_status status = mpsi_pore_find_forces(mpm, function);
  if (status == MPS_OK) status = mpsi_pore_find_contacts(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, take_motion, 0.0);
  status = mpsi_pore_find_changes(mpm, function);
  if (status == MPS_OK) status = move_nodes(mpm, function);
  if (status == MPS_OK && mpm->partition) status = mpsi_pore_send_changes(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, take, 0.0);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, correct, mpm->run.dt);
  mpsi_pore_exchange(mpm, MPSI_PORE_NOW);
  return MPS_OK;
}
