/* energy.c - see energy.h. Sums within a block are in order, sums over blocks exact.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body/rotation.h"
#include "core/base/room_array.h"
#include "mpm/contact/particle.h"
#include "mpm/base/energy.h"
#include "mpm/particles/loads.h"
#include "mpm/ranks/partition.h"

#include <string.h>

void mpsi_mpm_energy_add(mpsi_energy *budget, mpsi_energy_sum which, double energy) {
  if (budget->counts) mpsi_exact_add(&budget->step[which], energy);
}

void mpsi_mpm_energy_add_at_once(mpsi_energy *budget, mpsi_energy_sum which, double energy) {
  if (budget->counts) mpsi_exact_add(&budget->sum[which], energy);
}

/* ---- particles ------------------------------------------------------------------------------- */

static mpsi_cell_energy *of_cells(const mpsi_grid *grid, const mpsi_energy *energy,
                                  const mpsi_cell_block *cells) {
  return &energy->cells[cells - grid->cells];
}

static double kinetic_of(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin, int64_t end) {
  double sum = 0.0;
  for (int64_t k = begin; k < end; k++)
    for (int c = 0; c < grid->dim; c++) sum += 0.5 * p->m[k] * p->v[c][k] * p->v[c][k];
  return sum;
}

void mpsi_mpm_energy_before(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                            const mpsi_cell_block *cells, int64_t begin, int64_t end) {
  of_cells(grid, energy, cells)->kinetic_before += kinetic_of(grid, p, begin, end);
}

void mpsi_mpm_energy_after(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                           const mpsi_cell_block *cells, int64_t begin, int64_t end) {
  of_cells(grid, energy, cells)->kinetic += kinetic_of(grid, p, begin, end);
}

/* Column of the velocity gradient and of the stress of d(v_a)/d(x_b). */
static int gradient_column(int dim, int a, int b) { return dim * a + b; }
static int stress_column(int a, int b) {
  static const int symmetric[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
  return symmetric[a][b];
}

void mpsi_mpm_energy_moved(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                           const mps_mpm_def *def, double dt, const mpsi_cell_block *cells,
                           int64_t begin, int64_t end) {
  const int dim = grid->dim;
  double loads = 0.0, stresses = 0.0;
  for (int64_t k = begin; k < end; k++) {
    double power = 0.0;
    for (int a = 0; a < dim; a++) {
      loads += (p->m[k] * def->gravity[a] + (p->f[a] ? p->f[a][k] : 0.0)) * p->v[a][k];
      for (int b = 0; b < dim; b++)
        power += p->s[stress_column(a, b)][k] * p->L[gradient_column(dim, a, b)][k];
    }
    if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC) power += p->s[2][k] * p->L[4][k];
    stresses += p->V[k] * power;
  }
  of_cells(grid, energy, cells)->loads += dt * loads;
  of_cells(grid, energy, cells)->stresses += dt * stresses;
}

void mpsi_mpm_energy_returned(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_energy *energy, const mps_mpm_def *def, double dt,
                              const mpsi_cell_block *cells, int64_t particle, const double *v) {
  double power = 0.0;
  for (int a = 0; a < grid->dim; a++)
    power += (p->m[particle] * def->gravity[a] + (p->f[a] ? p->f[a][particle] : 0.0)) * v[a];
  if (grid->geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC)
    power -= p->V[particle] * p->s[2][particle] * v[0] / p->x[0][particle];
  of_cells(grid, energy, cells)->returned += dt * power;
}

/* The column of what a law has dissipated, over all particles; NULL: it counts nothing. */
static const double *dissipated_column(const mpsi_law_use *law) {
  if (mpsi_material_kept(law->material) != MPSI_KEPT_UNDISSIPATED) return NULL;
  return law->history[mpsi_material_dissipated()];
}

void mpsi_mpm_energy_before_law(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin,
                                int64_t end, mpsi_before_law *out) {
  const size_t bytes = (size_t)(end - begin) * sizeof(double);
  for (int c = 0; c < 2 * grid->dim; c++) memcpy(out->stress[c], p->s[c] + begin, bytes);
  memcpy(out->volume, p->V + begin, bytes);
  for (int64_t k = begin; k < end; k++) {
    const double *dissipated = dissipated_column(mpsi_law_of(p, k));
    out->dissipated[k - begin] = dissipated ? dissipated[k] : 0.0;
  }
}

double mpsi_elastic_energy(const double *s, double bulk, double shear) {
  const double trace = s[0] + s[1] + s[2], mean = trace / 3.0;
  const double a = s[0] - mean, b = s[1] - mean, c = s[2] - mean;
  const double square = a * a + b * b + c * c + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
  return trace * mean / (6.0 * bulk) + square / (4.0 * shear);
}

/* Work dt sum V sigma_ab d_ab of a step, trapezoidal in V sigma; `trace`: that of the mean
 * stress. */
static double stress_work(const mps_material_block *block, int64_t k, const double *s0,
                          const double *s1, double V0, double V1, double *trace) {
  double mean[6], work = 0.0, rate = 0.0;
  for (int c = 0; c < 6; c++) mean[c] = 0.5 * (V0 * s0[c] + V1 * s1[c]);
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) {
      const double *L = block->gradient[3 * a + b];
      if (L) work += mean[stress_column(a, b)] * L[k];
      if (L && a == b) rate += L[k];
    }
  *trace = block->dt * rate * (mean[0] + mean[1] + mean[2]) / 3.0;
  return block->dt * work;
}

void mpsi_mpm_energy_law(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_energy *energy,
                         const mpsi_cell_block *cells, const mpsi_law_use *law,
                         const mps_material_block *block, const mpsi_before_law *before,
                         int64_t begin) {
  const mpsi_kept stored = mpsi_material_kept(law->material);
  const double shear = mpsi_material_shear(law->material), bulk = law->modulus - 4.0 / 3.0 * shear;
  const double *dissipated = dissipated_column(law);
  mpsi_cell_energy *sum = of_cells(grid, energy, cells);
  for (int64_t k = 0; k < block->count; k++) {
    double s0[6] = {0.0}, s1[6] = {0.0}, trace;
    for (int c = 0; c < 2 * grid->dim; c++)
      s0[c] = before->stress[c][k], s1[c] = p->s[c][begin + k];
    const double V0 = before->volume[k], V1 = p->V[begin + k];
    sum->seen += stress_work(block, k, s0, s0, V0, V0, &trace);
    const double work = stress_work(block, k, s0, s1, V0, V1, &trace);
    double stays = work;
    if (stored == MPSI_KEPT_PRESSURE)
      stays = trace;
    else if (dissipated)
      stays = work - 0.5 * (V0 + V1) * (dissipated[begin + k] - before->dissipated[k]);
    else if (stored == MPSI_KEPT_ELASTIC && block->flags[k] != 0)
      stays = 0.5 * (V0 + V1) *
              (mpsi_elastic_energy(s1, bulk, shear) - mpsi_elastic_energy(s0, bulk, shear)) /
              mpsi_mpm_stiffness(p, begin + k);
    sum->stored += stays;
    sum->spent += work - stays;
  }
}

/* Change (J) of a fluid's energy between two stresses whose volumes differ by dV. */
static double fluid_energy(const double *s0, const double *s1, double dV) {
  return (s0[0] + s0[1] + s0[2] + s1[0] + s1[1] + s1[2]) / 6.0 * dV;
}

void mpsi_mpm_energy_smoothed(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_energy *energy, const mpsi_cell_block *cells,
                              const mpsi_before_law *before, int64_t begin, int64_t end) {
  mpsi_cell_energy *sum = of_cells(grid, energy, cells);
  for (int64_t k = begin; k < end; k++) {
    double s0[6] = {0.0}, s1[6] = {0.0}, wave, shear;
    const mpsi_law_use *law = mpsi_law_of(p, k);
    if (!law->filtered) continue;
    mpsi_mpm_elastic(p, k, &wave, &shear);
    for (int c = 0; c < 2 * grid->dim; c++)
      s0[c] = before->stress[c][k - begin], s1[c] = p->s[c][k];
    if (law->gap < 0) {
      sum->smoothed -= fluid_energy(s0, s1, p->V[k] - before->volume[k - begin]);
      continue;
    }
    const double bulk = wave - 4.0 / 3.0 * shear, V = 0.5 * (before->volume[k - begin] + p->V[k]);
    const double lost =
        V * (mpsi_elastic_energy(s0, bulk, shear) - mpsi_elastic_energy(s1, bulk, shear));
    sum->smoothed += lost;
  }
}

/* ---- nodes ----------------------------------------------------------------------------------- */

/* Work of all bodies in penalty contact on node k with the velocity v. */
static void count_contact(const mpsi_grid *grid, const mpsi_contacts *contacts, double dt,
                          const mpsi_node_block *nodes, int k, const double *v,
                          mpsi_node_energy *out) {
  const int32_t pairs = contacts->penalty_bodies > 0 ? nodes->pairs : 0;
  for (int32_t t = nodes->first_pair; t < nodes->first_pair + pairs; t++) {
    const mpsi_node_pair *pair = &contacts->node_pair[t];
    const mpsi_contact_node *at = &contacts->node[(int64_t)t * grid->block_nodes + k];
    if (at->mass == 0.0) continue;
    out->normal += dt * mpsi_dot3(at->force, v);
    if (contacts->handle[pair->body]->def.friction == 0.0 || pair->mass == 0.0) continue;
    double x[3], surface[3], f[3];
    mpsi_node_place(grid, nodes->at, k, x);
    mpsi_body_velocity(&contacts->body[pair->body]->pose, x, surface);
    for (int c = 0; c < 3; c++) f[c] = dt * at->mass * at->slip[c];
    out->friction += mpsi_dot3(f, v);
    out->surface += mpsi_dot3(f, surface);
  }
}

void mpsi_mpm_energy_nodes(const mpsi_grid *grid, const mpsi_contacts *contacts,
                           const mpsi_energy *energy, double dt, int64_t g, const mpsi_node *held,
                           const mpsi_node *damped) {
  const mpsi_node_block *nodes = &grid->nodes[g];
  const mpsi_node *node = (const mpsi_node *)(grid->node + mpsi_first_node(grid, g));
  const mpsi_node *side = (const mpsi_node *)(grid->side + mpsi_first_node(grid, nodes->side));
  mpsi_node_energy sum = {0};
  for (int k = 0; k < grid->block_nodes; k++) {
    const double m = node[k][MPSI_MASS], *v = node[k] + MPSI_VECTOR;
    const double *before = side[k] + MPSI_VECTOR;
    if (!(m > 0.0)) continue;
    for (int c = 0; c < 3; c++) {
      sum.kinetic_before += 0.5 * m * before[c] * before[c];
      sum.kinetic += 0.5 * m * v[c] * v[c];
      sum.jump += 0.5 * m * (v[c] - before[c]) * (v[c] - before[c]);
      sum.boundaries += m * (damped[k][MPSI_VECTOR + c] - held[k][MPSI_VECTOR + c]) * v[c];
      sum.damping += m * (v[c] - damped[k][MPSI_VECTOR + c]) * v[c];
    }
    count_contact(grid, contacts, dt, nodes, k, v, &sum);
  }
  energy->nodes[g] = sum;
}

/* ---- penalty contact ------------------------------------------------------------------------- */

/* Elastic energy of penalty contact: half the normal force times the depth, over all particles;
 * adds `sign` times it, and subtracts it from the work of the bodies. */
static void add_springs(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_contacts *contacts,
                        mpsi_energy *budget, const mps_mpm_def *def, double sign) {
  for (int32_t b = 0; b < contacts->bodies; b++) {
    const mps_contact *contact = contacts->handle[b];
    if (mpsi_by_impulses(contact)) continue;
    for (int64_t k = 0; k < p->count; k++) {
      mpsi_contact_particle c;
      double x[3] = {0.0};
      for (int a = 0; a < grid->dim; a++) x[a] = p->x[a][k];
      if (!mpsi_body_reaches(contact->body, x, contact->def.offset) ||
          !mpsi_find_contact(grid, p, def, contact, grid->dim, k, &c))
        continue;
      const double energy =
          sign * 0.5 * sqrt(mpsi_dot3(c.force, c.force)) * (c.depth + contact->def.offset);
      mpsi_mpm_energy_add(budget, MPSI_ENERGY_SPRINGS, energy);
      mpsi_mpm_energy_add(budget, MPSI_ENERGY_STEPPING, -energy);
    }
  }
}

/* ---- a step ---------------------------------------------------------------------------------- */

mps_status mpsi_mpm_energy_begin(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                                 const mpsi_contacts *contacts, mpsi_energy *e,
                                 const mps_mpm_def *def, const char *function) {
  if (!e->counts) return MPS_OK;
  const int64_t cells = grid->cell_count, nodes = mpsi_all_nodes(grid);
  if (!MPSI_ENSURE(context, e, cells, cells) || !MPSI_ENSURE(context, e, nodes, nodes))
    return mpsi_fail_memory(context, function,
                            (size_t)cells * sizeof *e->cells + (size_t)nodes * sizeof *e->nodes);
  if (cells > 0) memset(e->cells, 0, (size_t)cells * sizeof *e->cells);
  if (nodes > 0) memset(e->nodes, 0, (size_t)nodes * sizeof *e->nodes);
  memset(e->step, 0, sizeof e->step);
  add_springs(grid, p, contacts, e, def, -1.0);
  return MPS_OK;
}

static void add_cells(const mpsi_grid *grid, mpsi_energy *energy) {
  for (int64_t b = 0; b < grid->cell_count; b++) {
    const mpsi_cell_energy *e = &energy->cells[b];
    if (grid->cells[b].ghost) continue;
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_KINETIC, e->kinetic - e->kinetic_before);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_TRANSFER, e->kinetic_before - e->kinetic + e->returned);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_KEPT, e->stored - e->smoothed);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_SPENT, e->spent + e->smoothed);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_LOADS, e->loads);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_STEPPING, e->seen - e->stored - e->spent);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_STRAIN, e->stresses - e->seen);
  }
}

/* Adds the energies of the nodes. The part of the bodies' work that is not done at nodes or by
 * friction is stored in penalty contact. */
static void add_nodes(const mpsi_grid *grid, mpsi_partition *partition, mpsi_energy *energy) {
  for (int64_t g = 0; g < mpsi_all_nodes(grid); g++) {
    const mpsi_node_energy *e = &energy->nodes[g];
    if (partition && !mpsi_mpm_counts_node_block(grid, g)) continue;
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_TRANSFER, e->kinetic - e->kinetic_before);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_STEPPING, e->jump - e->surface - e->normal);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_BOUNDARY_LOSS, -e->boundaries);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_FRICTION_LOSS, e->surface - e->friction);
    mpsi_mpm_energy_add(energy, MPSI_ENERGY_DAMPING_LOSS, -e->damping);
  }
}

void mpsi_mpm_energy_end(const mpsi_grid *grid, const mpsi_columns *p,
                         const mpsi_contacts *contacts, mpsi_partition *partition, mpsi_energy *e,
                         const mps_mpm_def *def) {
  const double bodies = e->bodies; /* equal on all ranks: one counts it */
  e->work_bodies += bodies;
  e->bodies = 0.0;
  if (!e->counts) return;
  add_cells(grid, e);
  add_nodes(grid, partition, e);
  add_springs(grid, p, contacts, e, def, 1.0);
  if (!partition || mps_domain_rank(partition->domain) == 0)
    mpsi_mpm_energy_add(e, MPSI_ENERGY_STEPPING, bodies);
  for (int k = 0; k < MPSI_ENERGY_SUMS; k++) mpsi_exact_merge(&e->sum[k], &e->step[k]);
}
