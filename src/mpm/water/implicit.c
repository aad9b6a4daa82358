/* implicit.c - pressures of cells, implicit in time. With increments d of the pressures
 *
 *   [S + dt T + dt^2 G^T m^-1 G] d = dt (fluxes at p) - change of volume,   S = V n/K_w
 *
 * T are the fluxes per difference of pressure, and G the forces on the nodes per pressure of a
 * cell: a pressure that rises pushes the ground apart, which the last term sees in advance. So
 * neither waves in the water nor its flow limit the step, which is that of the dry ground. The
 * matrix is symmetric and positive definite, and conjugate gradients solve it (solve/gradients.h).
 * The forces of the next step are those of the new pressures; velocities are not corrected.
 *
 * G is that of full supports, mirrored at sides of the domain, with the particles where they are at
 * the end of the step: what it lacks beside bodies delays pressures, and changes no steady state.
 * Vectors are by cells, loops by blocks; a block's part of a sum is added in the order of its
 * cells, and the parts exactly, so that no bit depends on the number of threads or ranks. On
 * several ranks each solves for the cells that it counts, with those of its rim (rim.h) beside
 * them. SPDX-License-Identifier: BSD-3-Clause */
#include "implicit.h"

#include "forces.h"
#include "layers.h"
#include "rim.h"
#include "solve/gradients.h"

typedef struct mpsi_pore_system system_of;

static void take(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  mpsi_pore_cell *cell = mpm->water->cell + first;
  (void)factor;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k, cell))
      cell[k].now = cell[k].p + s->change[first + k];
}

mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function) {
  mpsi_pore_find_tiles(mpm);
  mps_status status = mpsi_pore_find_forces(mpm, function);
  if (status == MPS_OK) status = mpsi_pore_find_changes(mpm, function);
  if (status == MPS_OK && mpm->partition) status = mpsi_pore_send_changes(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, take, 0.0);
  mpsi_pore_exchange(mpm, MPSI_PORE_NOW);
  return MPS_OK;
}
