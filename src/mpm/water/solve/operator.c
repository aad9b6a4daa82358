/* operator.c - see operator.h. SPDX-License-Identifier: BSD-3-Clause */
#include "operator.h"

#include "mpm/water/contacts.h"
#include "mpm/water/wide_halo.h"

typedef struct mpsi_pore_system system_of;

/* Velocities of nodes under the pressures `direction`, per dt, of a block of the grid or the wide
 * halo. Node k is number q of the cell that lies q places before the last of those in reach. */
void mpsi_pore_find_velocities(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid);
  const int32_t *reach = s->reach + g * mpsi_pore_box_places(grid);
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(grid, shift);
  for (int k = 0; k < grid->block_nodes; k++) {
    const int64_t node = mpsi_pore_number(grid, s, g, k);
    if (node < 0) continue;
    double *v = s->velocity[node];
    v[0] = v[1] = v[2] = 0.0;
    if (!(s->inertia[node][0] > 0.0)) continue;
    const int last = mpsi_pore_place(grid, k, MPSI_PORE_SPAN - 2) + shift[nodes - 1];
    for (int q = 0; q < nodes; q++) {
      const int64_t cell = reach[last - shift[q]];
      if (cell < 0 || s->row[cell] < 0) continue;
      const double *force = mpsi_pore_row(grid, s, cell), d = s->direction[cell];
      for (int c = 0; c < grid->dim; c++) v[c] += force[c * nodes + q] * d;
    }
    for (int c = 0; c < grid->dim; c++) v[c] /= s->inertia[node][c];
  }
}

/* G^T v of a cell, m3/s, or the diagonal of G^T m^-1 G. */
static double squeeze_of(const mps_mpm *mpm, const system_of *s, int64_t g, int k, const int *shift,
                         bool diagonal) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid);
  const int64_t cell = mpsi_first_node(grid, g) + k;
  const double *force = mpsi_pore_row(grid, s, cell);
  double sum = 0.0;
  const int32_t *near = s->reach + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 1);
  for (int q = 0; q < nodes; q++) {
    const int64_t node = near[shift[q]];
    if (node < 0 || !(s->inertia[node][0] > 0.0)) continue;
    for (int c = 0; c < grid->dim; c++) {
      const double f = force[c * nodes + q];
      sum += diagonal ? f * f / s->inertia[node][c] : f * s->velocity[node][c];
    }
  }
  return sum / grid->measure;
}

double mpsi_pore_squeeze_of(const mps_mpm *mpm, const system_of *s, int64_t g, int k,
                            const int *shift) {
  return squeeze_of(mpm, s, g, k, shift, false);
}

/* The matrix times `direction`; their product to the sums. Cells that water flows to are in reach.
 */
static void multiply(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  static const int stride[3] = {1, MPSI_PORE_BOX, MPSI_PORE_BOX * MPSI_PORE_BOX};
  const mpsi_grid *grid = &mpm->grid;
  const int64_t first = mpsi_first_node(grid, g);
  const double dt = mpm->run.dt;
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(grid, shift);
  s->part[g] = 0.0;
  for (int k = 0; k < grid->block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    const int32_t *here = s->reach + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 0);
    const double own = s->direction[first + k];
    double sum = s->diagonal[first + k] * own;
    for (int d = 0; d < 2 * grid->dim; d++) {
      if (s->conductance[first + k][d] == 0.0) continue;
      const int64_t beside = here[d & 1 ? stride[d / 2] : -stride[d / 2]];
      sum += dt * s->conductance[first + k][d] * (own - s->direction[beside]);
    }
    sum += dt * dt * squeeze_of(mpm, s, g, k, shift, false);
    s->product[first + k] = sum;
    s->part[g] += own * sum;
  }
}

double mpsi_pore_diagonal_of(const mps_mpm *mpm, const system_of *s, int64_t g, int k,
                             const int *shift) {
  const int64_t cell = mpsi_first_node(&mpm->grid, g) + k;
  const double dt = mpm->run.dt;
  double diagonal = s->diagonal[cell] + dt * dt * squeeze_of(mpm, s, g, k, shift, true);
  for (int d = 0; d < 2 * mpm->grid.dim; d++) diagonal += dt * s->conductance[cell][d];
  return diagonal;
}

mps_status mpsi_pore_find_motion(mps_mpm *mpm, const char *function) {
  MPSI_TRY(mpm->partition ? mpsi_pore_send_direction(mpm, function) : MPS_OK);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_NEAR, mpsi_pore_find_velocities, 0.0);
  return mpsi_pore_hold_contacts(mpm, function);
}

mps_status mpsi_pore_apply(mps_mpm *mpm, const char *function, double *along) {
  MPSI_TRY(mpsi_pore_find_motion(mpm, function));
  return mpsi_pore_sum_blocks(mpm, function, multiply, 0.0, along);
}
