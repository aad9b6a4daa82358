/* totals.c - sums over the particles, the energy budget, and the memory of the grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "totals.h"
#include "mpm/base/mpm_solver.h"

#include <string.h>

#include <mps/experimental/mpm_energy.h>

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
              {mpm->grid.fit_room.capacity, sizeof *mpm->grid.fit},
              {mpm->grid.fitted_room.capacity, sizeof *mpm->grid.fitted},
              {mpm->contact.cell_pair_room.capacity, sizeof *mpm->contact.cell_pair},
              {mpm->contact.node_pair_room.capacity, sizeof *mpm->contact.node_pair},
              {mpm->contact.node_room.capacity, sizeof *mpm->contact.node},
              {mpm->contact.normal_room.capacity, sizeof *mpm->contact.normal},
              {mpm->contact.load_room.capacity, sizeof *mpm->contact.load},
              {mpm->contact.held_room.capacity, sizeof *mpm->contact.held},
              {mpm->contact.inside_room.capacity, sizeof *mpm->contact.inside},
              {mpm->contact.reached_room.capacity, sizeof *mpm->contact.reached},
              {mpm->contact.sight_room.capacity, sizeof *mpm->contact.sight},
              {mpm->contact.across_room.capacity, sizeof *mpm->contact.across},
              {mpm->contact.beside_room.capacity, sizeof *mpm->contact.beside},
              {mpm->contact.penalty_room.capacity, sizeof(mpsi_penalty_node)},
              {mpm->grid.across_room.capacity, sizeof(mpsi_node)},
              {mpm->boundaries.held_room.capacity + mpm->boundaries.old_held_room.capacity,
               sizeof *mpm->boundaries.held},
              {mpm->boundaries.dashpot_room.capacity + mpm->boundaries.old_dashpot_room.capacity,
               sizeof *mpm->boundaries.dashpot},
              {mpm->boundaries.borne_room.capacity, sizeof *mpm->boundaries.borne},
              {mpm->grid.worker_count, mpsi_worker_bytes(&mpm->grid)},
              {mpm->energy.cells_room.capacity, sizeof *mpm->energy.cells},
              {mpm->energy.nodes_room.capacity, sizeof *mpm->energy.nodes},
              {mpm->rooms.force.item ? mpm->p.count : 0, (size_t)mpm->grid.dim * sizeof(double)},
              {mpm->rooms.strain.capacity + mpm->rooms.rough.capacity + mpm->rooms.places.capacity,
               sizeof(double)},
              {mpm->p.stencil ? mpm->p.count : 0, sizeof *mpm->p.stencil},
              {mpm->p.count, 2 * sizeof *mpm->grid.radix}};
  int64_t bytes = 0;
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    bytes += list[k].capacity * (int64_t)list[k].size;
  return bytes;
}

/* Volume, momenta and kinetic energy of particles [begin, end). */
static void sum_particles(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin, int64_t end,
                          mps_totals *t) {
  const int dim = grid->dim;
  const double h = grid->cell, full = h * h / (grid->spline == 3 ? 3.0 : 4.0);
  /* without L particles have no angular momentum of their own */
  const double moment = grid->standard ? 0.0 : full;
  for (int64_t k = begin; k < end; k++) {
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
    t->volume += p->V[k];
  }
}

enum { LINEAR = 0, ANGULAR = 3, MASS = 6, VOLUME, KINETIC, WORK, SUMS };

static void add_part(mpsi_exact *sum, const mps_totals *t) {
  for (int c = 0; c < 3; c++) {
    mpsi_exact_add(&sum[LINEAR + c], t->linear[c]);
    mpsi_exact_add(&sum[ANGULAR + c], t->angular[c]);
  }
  mpsi_exact_add(&sum[VOLUME], t->volume);
  mpsi_exact_add(&sum[KINETIC], t->kinetic);
}

/* Sums in order within blocks, and exactly over blocks; where the caller has written or removed
 * particles since, exactly over all particles. */
static void sum_share(const mpsi_grid *grid, const mpsi_columns *p,
                      const mpsi_boundaries *boundaries, const mpsi_run *run, mpsi_exact *sum) {
  for (int64_t b = 0; !run->edited && b < grid->cell_count; b++) {
    mps_totals part = {0};
    if (grid->cells[b].ghost) continue;
    sum_particles(grid, p, grid->cells[b].begin, grid->cells[b].end, &part);
    add_part(sum, &part);
  }
  for (int64_t k = 0; run->edited && k < p->count; k++) {
    mps_totals part = {0};
    sum_particles(grid, p, k, k + 1, &part);
    add_part(sum, &part);
  }
  /* exact over particles: the total mass must not depend on the blocks */
  for (int64_t k = 0; k < p->count; k++) mpsi_exact_add(&sum[MASS], p->m[k]);
  mpsi_mpm_boundary_add_works(boundaries, &sum[WORK]);
}

/* Energies summed over all ranks. */
static mps_status sum_energies(mpsi_partition *partition, const mpsi_energy *energy,
                               const char *function, double *out) {
  mpsi_exact sum[MPSI_ENERGY_SUMS];
  mps_status status = MPS_OK;
  memcpy(sum, energy->sum, sizeof sum);
  if (partition && energy->counts)
    status = mpsi_domain_sum_exact(partition->domain, function, MPSI_ENERGY_SUMS, sum);
  for (int k = 0; k < MPSI_ENERGY_SUMS; k++) out[k] = mpsi_exact_value(&sum[k]);
  return status;
}

mps_status mpsi_mpm_get_totals(void *solver, const char *function, mps_totals *out) {
  mps_mpm *mpm = solver;
  mpsi_exact sum[SUMS] = {{{0}}};
  double e[MPSI_ENERGY_SUMS];
  mps_status status = mpsi_particles_committed(mpm->p.set, function);
  if (mpm->partition)
    status = mpsi_mpm_compare_edits(&mpm->contact, mpm->partition, &mpm->run, &mpm->def, function,
                                    status);
  if (status != MPS_OK) return status;
  sum_share(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->run, sum);
  if (mpm->partition) status = mpsi_domain_sum_exact(mpm->domain, function, SUMS, sum);
  if (status == MPS_OK) status = sum_energies(mpm->partition, &mpm->energy, function, e);
  if (status != MPS_OK) return status;
  mps_totals t = {.mass = mpsi_exact_value(&sum[MASS]),
                  .volume = mpsi_exact_value(&sum[VOLUME]),
                  .kinetic = mpsi_exact_value(&sum[KINETIC]),
                  .work_boundaries = mpsi_exact_value(&sum[WORK]),
                  .work_bodies = mpm->energy.work_bodies};
  for (int c = 0; c < 3; c++) {
    t.linear[c] = mpsi_exact_value(&sum[LINEAR + c]);
    t.angular[c] = mpsi_exact_value(&sum[ANGULAR + c]);
  }
  t.strain = e[MPSI_ENERGY_KEPT] + e[MPSI_ENERGY_SPRINGS];
  t.scheme = e[MPSI_ENERGY_TRANSFER] + e[MPSI_ENERGY_STEPPING] + e[MPSI_ENERGY_STRAIN];
  t.dissipated = e[MPSI_ENERGY_SPENT] + e[MPSI_ENERGY_BOUNDARY_LOSS] +
                 e[MPSI_ENERGY_FRICTION_LOSS] + e[MPSI_ENERGY_DAMPING_LOSS] + t.scheme;
  t.work_loads = e[MPSI_ENERGY_LOADS];
  if (!mpm->energy.counts) t.strain = t.scheme = t.dissipated = t.work_loads = NAN;
  *out = t;
  return MPS_OK;
}

mps_status mps_mpm_get_energy_report_sized(const mps_mpm *handle, mps_mpm_energy_report *out,
                                           size_t size) {
  mps_mpm *mpm = (mps_mpm *)handle; /* scratch and messages only: the state stays */
  static const char function[] = "mps_mpm_get_energy_report";
  if (!mpm) return mpsi_null(__func__, "mpm");
  if (!mpm->energy.counts)
    return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                     "budget is 0 in the solver's definition: the losses are not known");
  double e[MPSI_ENERGY_SUMS];
  MPSI_TRY(mpsi_mpm_agree(mpm->partition, function, MPS_OK));
  MPSI_TRY(sum_energies(mpm->partition, &mpm->energy, function, e));
  mps_mpm_energy_report l = {.laws = e[MPSI_ENERGY_SPENT],
                             .boundaries = e[MPSI_ENERGY_BOUNDARY_LOSS],
                             .bodies = e[MPSI_ENERGY_FRICTION_LOSS],
                             .damping = e[MPSI_ENERGY_DAMPING_LOSS],
                             .transfer = e[MPSI_ENERGY_TRANSFER],
                             .stepping = e[MPSI_ENERGY_STEPPING],
                             .strain = e[MPSI_ENERGY_STRAIN]};
  l.residual = e[MPSI_ENERGY_LOADS] + e[MPSI_ENERGY_BOUNDARIES] + mpm->energy.work_bodies -
               e[MPSI_ENERGY_KINETIC] - e[MPSI_ENERGY_KEPT] - e[MPSI_ENERGY_SPRINGS] - l.laws -
               l.boundaries - l.bodies - l.damping - l.transfer - l.stepping - l.strain;
  return mpsi_out_write(mpm->context, function, out, size, &l, sizeof l);
}

mps_status mps_mpm_get_report_sized(const mps_mpm *mpm, mps_mpm_report *out, size_t size) {
  if (!mpm) return mpsi_null(__func__, "mpm");
  const mps_mpm_report usage = {.blocks = mpm->grid.cell_count,
                                .nodes = mpm->grid.node_count * mpm->grid.block_nodes,
                                .bytes = grid_bytes(mpm),
                                .sweeps = mpm->contact.impulses.sweeps,
                                .left = mpm->contact.impulses.left};
  return mpsi_out_write(mpm->context, "mps_mpm_get_report", out, size, &usage, sizeof usage);
}
