/* totals.c - sums over the particles, the energy budget, and the memory of the grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include <mps/mpm_energy.h>

static int64_t grid_bytes(const mps_mpm *mpm) {
  const struct {
    int64_t capacity;
    size_t size;
  } list[] = {{mpm->grid.cells_room.capacity, sizeof *mpm->grid.cells},
              {mpm->grid.coloured_room.capacity, sizeof *mpm->grid.coloured},
              {mpm->grid.nodes_room.capacity, sizeof *mpm->grid.nodes},
              {mpm->grid.digits_room.capacity, sizeof(int32_t)},
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
              {mpm->energy.cells_room.capacity, sizeof *mpm->energy.cells},
              {mpm->energy.nodes_room.capacity, sizeof *mpm->energy.nodes},
              {mpm->rooms.force.item ? mpm->p.count : 0, (size_t)mpm->dim * sizeof(double)},
              {mpm->rooms.strain.capacity, sizeof(double)},
              {mpm->p.stencil ? mpm->p.count : 0, sizeof *mpm->p.stencil},
              {mpm->p.count, 2 * sizeof *mpm->grid.radix + sizeof *mpm->laws.flags}};
  int64_t bytes = 0;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    bytes += list[k].capacity * (int64_t)list[k].size;
  return bytes;
}

/* Mass, volume, momenta and kinetic energy of the particles. */
static void sum_particles(const mps_mpm *mpm, mps_totals *t) {
  const mpsi_columns *p = &mpm->p;
  const int dim = mpm->dim;
  const double h = mpm->def.cell, full = h * h / (mpm->def.spline == 3 ? 3.0 : 4.0);
  const double moment = mpm->standard ? 0.0 : full; /* particles without L carry no spin */
  for (int64_t k = 0; k < mpm->p.count; k++) {
    const double m = p->m[k];
    double x[3] = {0}, v[3] = {0}, L[3][3] = {{0}};
    for (int c = 0; c < dim; c++) {
      x[c] = p->x[c][k], v[c] = p->v[c][k];
      for (int d = 0; d < dim; d++) L[c][d] = p->L[dim * c + d][k];
      t->linear[c] += m * v[c];
      t->kinetic += 0.5 * m * v[c] * v[c];
    }
    for (int c = 0; c < 3; c++) {
      const int a = (c + 1) % 3, b = (c + 2) % 3;
      t->angular[c] += m * (x[a] * v[b] - x[b] * v[a] + moment * (L[b][a] - L[a][b]));
    }
    t->mass += m;
    t->volume += p->V[k];
  }
}

mps_status mps_mpm_get_totals_sized(mps_mpm *mpm, mps_totals *out, size_t size) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mps_status refused = mpsi_share_refuse(mpm, "mps_mpm_get_totals", "the totals");
  if (refused != MPS_OK) return refused;
  const mpsi_energy_sums *e = &mpm->energy.sum;
  mps_totals t = {.work_boundaries = e->boundaries, .work_bodies = e->bodies};
  sum_particles(mpm, &t);
  t.strain = e->kept + e->springs;
  t.scheme = e->transfer + e->stepping + e->strain;
  t.dissipated = e->spent + e->boundary_loss + e->friction_loss + e->damping_loss + t.scheme;
  t.work_loads = e->loads;
  if (!mpm->energy.counts) t.strain = t.scheme = t.dissipated = t.work_loads = NAN;
  return mpsi_out_write(mpm->context, "mps_mpm_get_totals", out, size, &t, sizeof t);
}

mps_status mps_mpm_get_losses_sized(mps_mpm *mpm, mps_mpm_losses *out, size_t size) {
  static const char function[] = "mps_mpm_get_losses";
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!mpm->energy.counts)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "budget is 0 in the solver's definition: the losses are not known");
  const mpsi_energy_sums *e = &mpm->energy.sum;
  mps_mpm_losses l = {.laws = e->spent,
                      .boundaries = e->boundary_loss,
                      .bodies = e->friction_loss,
                      .damping = e->damping_loss,
                      .transfer = e->transfer,
                      .stepping = e->stepping,
                      .strain = e->strain};
  l.residual = e->loads + e->boundaries + e->bodies - e->kinetic - e->kept - e->springs - l.laws -
               l.boundaries - l.bodies - l.damping - l.transfer - l.stepping - l.strain;
  return mpsi_out_write(mpm->context, function, out, size, &l, sizeof l);
}

mps_status mps_mpm_get_usage_sized(mps_mpm *mpm, mps_mpm_usage *out, size_t size) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mps_mpm_usage usage = {.blocks = mpm->grid.cell_count,
                               .nodes = mpm->grid.node_count * mpm->grid.block_nodes,
                               .bytes = grid_bytes(mpm)};
  return mpsi_out_write(mpm->context, "mps_mpm_get_usage", out, size, &usage, sizeof usage);
}
