/* totals.c - sums over the particles, and the memory of the grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

static int64_t grid_bytes(const mps_mpm *mpm) {
  const struct {
    int64_t capacity;
    size_t size;
  } list[] = {{mpm->grid.cells_room.capacity, sizeof *mpm->grid.cells},
              {mpm->grid.coloured_room.capacity, sizeof *mpm->grid.coloured},
              {mpm->grid.nodes_room.capacity, sizeof *mpm->grid.nodes},
              {mpm->grid.digits_room.capacity, 2048 * sizeof(int32_t)},
              {mpm->grid.pass_room.capacity, sizeof(int32_t)},
              {mpm->grid.node_room.capacity, sizeof *mpm->grid.node},
              {mpm->grid.side_room.capacity, sizeof *mpm->grid.side},
              {mpm->contact.cell_pair_room.capacity, sizeof *mpm->contact.cell_pair},
              {mpm->contact.node_pair_room.capacity, sizeof *mpm->contact.node_pair},
              {mpm->contact.node_room.capacity, sizeof *mpm->contact.node},
              {mpm->contact.inside_room.capacity, sizeof *mpm->contact.inside},
              {mpm->contact.reached_room.capacity, sizeof *mpm->contact.reached},
              {mpm->boundaries.held_room.capacity + mpm->boundaries.old_held_room.capacity,
               sizeof *mpm->boundaries.held},
              {mpm->boundaries.dash_room.capacity + mpm->boundaries.old_dash_room.capacity,
               sizeof *mpm->boundaries.dash},
              {mpm->grid.worker_count, mpsi_worker_bytes(mpm)},
              {mpm->rooms.force.item ? mpm->p.count : 0, (size_t)mpm->dim * sizeof(double)},
              {mpm->p.stencil ? mpm->p.count : 0, sizeof *mpm->p.stencil},
              {mpm->p.count, 2 * sizeof *mpm->grid.radix + sizeof *mpm->laws.flags}};
  int64_t bytes = 0;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    bytes += list[k].capacity * (int64_t)list[k].size;
  return bytes;
}

mps_status mps_mpm_get_totals(mps_mpm *mpm, mps_mpm_totals *out) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  const mpsi_columns *p = &mpm->p;
  const int dim = mpm->dim;
  const double h = mpm->def.cell, full = h * h / (mpm->def.spline == 3 ? 3.0 : 4.0);
  const double moment = mpm->standard ? 0.0 : full; /* particles without L carry no spin */
  mps_mpm_totals t = {.blocks = mpm->grid.cell_count,
                      .nodes = mpm->grid.node_count * mpm->grid.block_nodes,
                      .bytes = grid_bytes(mpm)};
  for (int64_t k = 0; k < mpm->p.count; k++) {
    const double m = p->m[k];
    double x[3] = {0}, v[3] = {0}, L[3][3] = {{0}};
    for (int c = 0; c < dim; c++) {
      x[c] = p->x[c][k], v[c] = p->v[c][k];
      for (int d = 0; d < dim; d++) L[c][d] = p->L[dim * c + d][k];
      t.linear[c] += m * v[c];
      t.kinetic += 0.5 * m * v[c] * v[c];
    }
    for (int c = 0; c < 3; c++) {
      const int a = (c + 1) % 3, b = (c + 2) % 3;
      t.angular[c] += m * (x[a] * v[b] - x[b] * v[a] + moment * (L[b][a] - L[a][b]));
    }
    t.mass += m;
    t.volume += p->V[k];
  }
  *out = t;
  return MPS_OK;
}
