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
 * (contacts.c), and conjugate gradients with its diagonal solve it.
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

#include <string.h>

#define TOLERANCE 1e-9 /* of the residual, over the right-hand side */
enum { MOST_ITERATIONS = 5000 };
typedef struct mpsi_pore_system system_of;

/* ---- the operator ---------------------------------------------------------------------------- */

/* How far places q of a span lie from the first in a tile. */
static void list_shifts(const mpsi_grid *grid, int *shift) {
  for (int q = 0; q < mpsi_pore_span_nodes(grid); q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    shift[q] = (i[2] * MPSI_PORE_BOX + i[1]) * MPSI_PORE_BOX + i[0];
  }
}

/* Velocities of nodes under the pressures `direction`, per dt, of a block of the grid or the rim.
 * Node k is number q of the cell that lies q places before the last of those in reach. */
static void find_velocities(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid);
  const int32_t *tile = s->tile + g * mpsi_pore_box_places(grid);
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  list_shifts(grid, shift);
  for (int k = 0; k < grid->block_nodes; k++) {
    const int64_t node = mpsi_pore_number(grid, s, g, k);
    if (node < 0) continue;
    double *v = s->velocity[node];
    v[0] = v[1] = v[2] = 0.0;
    if (!(s->mass[node] > 0.0)) continue;
    const int last = mpsi_pore_place(grid, k, MPSI_PORE_SPAN - 2) + shift[nodes - 1];
    for (int q = 0; q < nodes; q++) {
      const int64_t cell = tile[last - shift[q]];
      if (cell < 0 || !(s->scale[cell] > 0.0)) continue;
      const double *force = mpsi_pore_row(grid, s, cell), d = s->scale[cell] * s->direction[cell];
      for (int c = 0; c < grid->dim; c++) v[c] += force[c * nodes + q] * d;
    }
    for (int c = 0; c < grid->dim; c++) v[c] = s->held[node] >> c & 1 ? 0.0 : v[c] / s->mass[node];
  }
}

/* G^T v of a cell, m3/s; or of the matrix's diagonal. */
static double squeeze_of(const mps_mpm *mpm, const system_of *s, int64_t g, int k, const int *shift,
                         bool diagonal) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid);
  const int64_t cell = mpsi_first_node(grid, g) + k;
  const double *force = mpsi_pore_row(grid, s, cell);
  double sum = 0.0;
  const int32_t *near = s->tile + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 1);
  for (int q = 0; q < nodes; q++) {
    const int64_t node = near[shift[q]];
    if (node < 0 || !(s->mass[node] > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++) {
      const double f = force[c * nodes + q];
      if (!diagonal)
        sum += f * s->velocity[node][c];
      else if (!(s->held[node] >> c & 1))
        sum += f * f * s->scale[cell] / s->mass[node];
    }
  }
  return s->scale[cell] * sum / grid->measure;
}

/* The matrix times `direction`; their product to the sums. Cells that water flows to are in reach.
 */
static void multiply(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  static const int stride[3] = {1, MPSI_PORE_BOX, MPSI_PORE_BOX * MPSI_PORE_BOX};
  const mpsi_grid *grid = &mpm->grid;
  mpsi_water *water = mpm->water;
  const int64_t first = mpsi_first_node(grid, g);
  const mpsi_pore_cell *cell = water->cell + first;
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  list_shifts(grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!mpsi_pore_is_unknown(water, g, k, cell)) continue;
    const int32_t *here = s->tile + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 0);
    const double own = s->direction[first + k];
    double sum = s->diagonal[first + k] * own;
    for (int d = 0; d < 2 * grid->dim; d++) {
      if (s->conductance[first + k][d] == 0.0) continue;
      const int64_t beside = here[d & 1 ? stride[d / 2] : -stride[d / 2]];
      sum += mpm->run.dt * s->conductance[first + k][d] * (own - s->direction[beside]);
    }
    sum += mpm->run.dt * mpm->run.dt * squeeze_of(mpm, s, g, k, shift, false);
    s->product[first + k] = sum;
    s->part[g] += own * sum;
  }
}

/* ---- conjugate gradients --------------------------------------------------------------------- */

/* d = 0, r = the right-hand side, z = r/diagonal; r.z to the sums. */
static void start(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  list_shifts(&mpm->grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k, cell)) continue;
    double diagonal =
        s->diagonal[first + k] + mpm->run.dt * mpm->run.dt * squeeze_of(mpm, s, g, k, shift, true);
    for (int d = 0; d < 2 * mpm->grid.dim; d++)
      diagonal += mpm->run.dt * s->conductance[first + k][d];
    const double carried = s->scale[first + k] * s->carried[first + k] / mpm->grid.measure;
    s->squeeze[first + k] = mpm->run.dt * (squeeze_of(mpm, s, g, k, shift, false) + carried);
    s->residual[first + k] -= s->squeeze[first + k];
    s->inverse[first + k] = 1.0 / diagonal;
    s->change[first + k] = 0.0;
    s->direction[first + k] = s->inverse[first + k] * s->residual[first + k];
    s->part[g] += s->residual[first + k] * s->direction[first + k];
  }
}

/* Along the direction; the new r.z to the sums. */
static void advance(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  s->part[g] = 0.0;
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k, cell)) continue;
    const int64_t at = first + k;
    s->change[at] += factor * s->direction[at];
    s->residual[at] -= factor * s->product[at];
    s->part[g] += s->residual[at] * s->residual[at] * s->inverse[at];
  }
}

static void turn(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k, cell))
      s->direction[first + k] =
          s->inverse[first + k] * s->residual[first + k] + factor * s->direction[first + k];
}

static void take(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  mpsi_pore_cell *cell = mpm->water->cell + first;
  (void)factor;
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k, cell))
      cell[k].now = cell[k].p + s->change[first + k];
}

/* What the corrected motion takes of the cells of a block, over their space. */
static void find_squeeze(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  const mpsi_pore_cell *cell = mpm->water->cell + first;
  const double dt = mpm->run.dt;
  int shift[MPSI_PORE_MOST_SPAN];
  (void)factor;
  list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k, cell)) continue;
    const double own = s->squeeze[first + k] + dt * dt * squeeze_of(mpm, s, g, k, shift, false);
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

static mps_status refuse(mps_mpm *mpm, const char *function, double rest, double least) {
  const mps_status status =
      mpsi_fail(mpm->context, function, MPS_ERROR_NUMERIC,
                "step %lld: pressures of the pore water have a residual of %g after %lld "
                "iterations, must come to %g: choose a smaller dt or K_w",
                (long long)mpm->run.steps, sqrt(rest), (long long)mpm->water->system->iterations,
                sqrt(least));
  /* all ranks have the same sums, and fail alike */
  return mpm->partition ? mpsi_domain_agree(mpm->partition->domain, function, status) : status;
}

/* One iteration; `*rest`: r.z. */
static mps_status iterate(mps_mpm *mpm, const char *function, double *rest) {
  const double before = *rest;
  double along;
  mps_status status = mpm->partition ? mpsi_pore_send_direction(mpm, function) : MPS_OK;
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_NEAR, find_velocities, 0.0);
  status = mpsi_pore_hold_contacts(mpm, function);
  if (status == MPS_OK) status = mpsi_pore_sum_blocks(mpm, function, multiply, 0.0, &along);
  if (status == MPS_OK) status = mpsi_pore_sum_blocks(mpm, function, advance, before / along, rest);
  if (status == MPS_OK) mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, turn, *rest / before);
  return status;
}

static mps_status find_changes(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  double rest;
  mps_status status = mpsi_pore_sum_blocks(mpm, function, start, 0.0, &rest);
  const double least = TOLERANCE * TOLERANCE * rest;
  for (s->iterations = 0; status == MPS_OK && (rest > least || !isfinite(rest)); s->iterations++) {
    if (s->iterations == MOST_ITERATIONS || !isfinite(rest))
      return refuse(mpm, function, rest, least);
    status = iterate(mpm, function, &rest);
  }
  return status;
}

/* Velocities and volumes by the changes of the pressures that have been found. */
static mps_status move_nodes(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  memcpy(s->direction, s->change,
         (size_t)(mpm->grid.node_count * mpm->grid.block_nodes) * sizeof *s->change);
  mps_status status = mpm->partition ? mpsi_pore_send_direction(mpm, function) : MPS_OK;
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_NEAR, find_velocities, 0.0);
  status = mpsi_pore_hold_contacts(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_bear_contacts(mpm);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, find_squeeze, 0.0);
  return MPS_OK;
}

mps_status mpsi_pore_solve(mps_mpm *mpm, const char *function) {
  mpsi_pore_find_tiles(mpm);
  mps_status status = mpsi_pore_find_forces(mpm, function);
  if (status == MPS_OK) status = mpsi_pore_find_contacts(mpm, function);
  if (status == MPS_OK) status = find_changes(mpm, function);
  if (status == MPS_OK) status = move_nodes(mpm, function);
  if (status == MPS_OK && mpm->partition) status = mpsi_pore_send_changes(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, take, 0.0);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COMPUTED, correct, mpm->run.dt);
  mpsi_pore_exchange(mpm, MPSI_PORE_NOW);
  return MPS_OK;
}
