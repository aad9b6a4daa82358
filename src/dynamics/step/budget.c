/* budget.c - energies and momenta of the present state, works of a step. Free-field columns are not
 * counted.
 *
 * The energy that Verlet and leapfrog keep exactly for a linear body without damping is v-.M.v+ / 2
 * + U(x), with the velocities half a step before and after the state x. With other forces P besides
 * the restoring ones F, v+ = v- + dt F/M the velocity by these alone, and v the final velocity of
 * the step, it changes in a step by dt P.(v- + v)/2: docs/dynamics.md 3.3. That work is summed here
 * and in constrain.c. Sums run in a fixed order within a block, and over blocks without round-off
 * (core/exact.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "budget.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/limit/dt.h"
#include "dynamics/ranks/partition.h"

#include <string.h>

static void first_pass(void *data, int64_t b, int32_t worker) {
  mps_dynamics *dynamics = data;
  dynamics->kernels->pass1[dynamics->def.rotation][MPSI_DYN_FORCES](
      &dynamics->state, &dynamics->mesh, b, dynamics->scratch + worker * MPSI_DYN_SCRATCH);
}

/* |u|^2 of a pair, by the removal in use. */
static double deformation2(const mps_dynamics *dynamics, int64_t i, int64_t j, double r0x,
                           double r0y) {
  const mpsi_dynamics_state *s = &dynamics->state;
  double a = 0.5 * (s->c[i] + s->c[j]), b = 0.5 * (s->s[i] + s->s[j]);
  if (dynamics->def.rotation == MPS_DYNAMICS_ROTATION_MEAN_ANGLE) {
    a = s->c[i] + s->c[j] + s->c[i] * s->c[j] - s->s[i] * s->s[j];
    b = s->s[i] * (1.0 + s->c[j]) + (1.0 + s->c[i]) * s->s[j];
  }
  const double ux = s->dx[j] - s->dx[i] - (a * r0x - b * r0y);
  const double uy = s->dy[j] - s->dy[i] - (b * r0x + a * r0y);
  return ux * ux + uy * uy;
}

/* Energy of the pairs whose first end the block owns (per area and thickness), and the pressure
 * forces on its particles (into fx, fy). */
static double block_pairs(const mps_dynamics *dynamics, const mpsi_dynamics_block *block,
                          double *fx, double *fy) {
  const mpsi_dynamics_mesh *mesh = &dynamics->mesh;
  const mpsi_dynamics_state *s = &dynamics->state;
  const mpsi_dynamics_scattered *list = &mesh->scattered;
  const int64_t begin = block->begin;
  double shear = 0.0;
  int64_t slot = block->slot;
  for (int64_t r = block->run_begin; r < block->run_end; r++) {
    const mpsi_dynamics_pair_run *run = &mesh->run[r];
    for (int64_t k = 0; k < run->count; k++, slot++) {
      const int64_t i = run->i0 + k, j = run->j0 + k;
      const double sum = s->p[i] + s->p[j], x = sum * s->ex[slot], y = sum * s->ey[slot];
      if (run->own_i) fx[i - begin] -= x, fy[i - begin] -= y;
      if (run->own_j) fx[j - begin] += x, fy[j - begin] += y;
      if (run->own_i && i < dynamics->body)
        shear += 0.5 * run->kf * mpsi_dynamics_pair_shear(s->mu[i], s->mu[j]) *
                 deformation2(dynamics, i, j, run->r0x, run->r0y);
    }
  }
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++, slot++) {
    const int64_t i = list->i[k], j = list->j[k];
    const double sum = s->p[i] + s->p[j], x = sum * s->ex[slot], y = sum * s->ey[slot];
    if (list->ti[k] >= 0) fx[list->ti[k] - begin] -= x, fy[list->ti[k] - begin] -= y;
    if (list->tj[k] >= 0) fx[list->tj[k] - begin] += x, fy[list->tj[k] - begin] += y;
    if (list->ti[k] == i && i < dynamics->body)
      shear += 0.5 * list->kf[k] * mpsi_dynamics_pair_shear(s->mu[i], s->mu[j]) *
               deformation2(dynamics, i, j, list->r0x[k], list->r0y[k]);
  }
  return shear;
}

static void energy_block(void *data, int64_t b, int32_t worker) {
  const mps_dynamics *dynamics = data;
  const mpsi_dynamics_state *s = &dynamics->state;
  const mpsi_dynamics_block *block = &dynamics->mesh.block[b];
  const double D = mps_particles_spacing(dynamics->particles);
  const double volume = D * D * dynamics->def.measure;
  const bool euler = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER;
  const double ahead = euler ? 0.0 : dynamics->kept; /* s from v- to v+ */
  double f[2][MPSI_DYN_BLOCK] = {{0}, {0}};
  double kinetic = 0.0, strain = volume * block_pairs(dynamics, block, f[0], f[1]);
  for (int64_t k = block->begin; k < block->end && k < dynamics->body; k++) {
    const int64_t at = k - block->begin;
    const double a[3] = {s->ix[k] * (s->gx[k] + f[0][at]), s->iy[k] * (s->gy[k] + f[1][at]),
                         s->ith[k] * s->gth[k]};
    for (int c = 0; c < 3; c++) {
      const double v = mpsi_dynamics_velocity(dynamics, c, k);
      kinetic += 0.5 * mpsi_dynamics_mass(dynamics, c, k) * v * (v + ahead * a[c]);
    }
    if (s->lambda[k] > 0.0) strain += 0.5 * volume * s->p[k] * s->p[k] / s->lambda[k];
  }
  dynamics->part[2 * b] = kinetic;
  dynamics->part[2 * b + 1] = strain;
}

mps_status mpsi_dynamics_energies(mps_dynamics *dynamics, const char *function, double *kinetic,
                                  double *strain) {
  const int64_t blocks = dynamics->mesh.blocks;
  MPSI_TRY(mpsi_dynamics_bring_motion(dynamics, function));
  mpsi_parallel_for(dynamics->context, blocks + dynamics->mesh.ghosts, first_pass, dynamics);
  mpsi_parallel_for(dynamics->context, blocks, energy_block, dynamics);
  mpsi_exact sum[2] = {{{0}}, {{0}}};
  for (int64_t k = 0; k < 2 * blocks; k++) mpsi_exact_add(&sum[k % 2], dynamics->part[k]);
  mps_status status = mpsi_domain_sum_exact(dynamics->domain, function, 2, sum);
  *kinetic = mpsi_exact_value(&sum[0]);
  *strain = mpsi_exact_value(&sum[1]);
  return status;
}

/* ---- works of a step ------------------------------------------------------------------------- */

void mpsi_dynamics_note_velocities(mps_dynamics *dynamics, int64_t block) {
  const mpsi_dynamics_block *b = &dynamics->mesh.block[block];
  for (int c = 0; c < 3; c++)
    for (int64_t k = b->begin; k < b->end; k++)
      dynamics->before[c * dynamics->count + k] = mpsi_dynamics_velocity(dynamics, c, k);
}

/* The works of one block's particles in the step that has ended, J. */
static void work_block(void *data, int64_t block, int32_t worker) {
  const mpsi_dynamics_account *account = data;
  mps_dynamics *dynamics = account->dynamics;
  const mpsi_dynamics_block *b = &dynamics->mesh.block[block];
  double loads = 0.0, damping = 0.0;
  for (int c = 0; c < 3; c++) {
    const double *before = dynamics->before + c * dynamics->count;
    for (int64_t k = b->begin; k < b->end && k < dynamics->body; k++) {
      const double path = 0.5 * (before[k] + mpsi_dynamics_velocity(dynamics, c, k));
      if (c < 2 && account->forces->load[c]) loads += account->forces->load[c][k] * path;
      if (c < 2 && account->forces->external[c]) loads += account->forces->external[c][k] * path;
      if (account->drag)
        damping +=
            mpsi_dynamics_mass(dynamics, c, k) * account->drag[c * dynamics->count + k] * path;
    }
  }
  dynamics->part[2 * block] = account->kick * loads;
  dynamics->part[2 * block + 1] = account->kick * damping;
}

void mpsi_dynamics_count_works(mpsi_dynamics_account *account) {
  mps_dynamics *dynamics = account->dynamics;
  const int64_t blocks = dynamics->mesh.blocks;
  mpsi_parallel_for(dynamics->context, blocks, work_block, account);
  for (int64_t b = 0; b < blocks; b++) {
    mpsi_exact_add(&dynamics->works.loads, dynamics->part[2 * b]);
    mpsi_exact_add(&dynamics->works.damping, -dynamics->part[2 * b + 1]);
  }
}

/* ---- totals ---------------------------------------------------------------------------------- */

enum { MASS, LINEAR_X, LINEAR_Y, ANGULAR, MOMENTA, LOADS = MOMENTA, BOUNDARIES, DAMPING, SUMS };

/* Momenta and works, over all ranks. */
static mps_status sum_up(mps_dynamics *dynamics, const char *function, mps_totals *out) {
  const mpsi_dynamics_state *s = &dynamics->state;
  const double D = mps_particles_spacing(dynamics->particles);
  mpsi_exact sum[SUMS];
  memset(sum, 0, sizeof sum);
  sum[LOADS] = dynamics->works.loads;
  sum[BOUNDARIES] = dynamics->works.boundaries;
  sum[DAMPING] = dynamics->works.damping;
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++) {
    double part[MOMENTA] = {0.0};
    for (int64_t k = dynamics->mesh.block[b].begin;
         k < dynamics->mesh.block[b].end && k < dynamics->body; k++) {
      const double mass = mpsi_dynamics_mass(dynamics, 0, k);
      const double x = s->rx[k] + s->dx[k], y = s->ry[k] + s->dy[k];
      const double vx = mpsi_dynamics_velocity(dynamics, 0, k);
      const double vy = mpsi_dynamics_velocity(dynamics, 1, k);
      part[MASS] += mass;
      part[LINEAR_X] += mass * vx;
      part[LINEAR_Y] += mass * vy;
      part[ANGULAR] += mass * (x * vy - y * vx) +
                       mpsi_dynamics_mass(dynamics, 2, k) * mpsi_dynamics_velocity(dynamics, 2, k);
    }
    for (int m = 0; m < MOMENTA; m++) mpsi_exact_add(&sum[m], part[m]);
  }
  const mps_status status = mpsi_domain_sum_exact(dynamics->domain, function, SUMS, sum);
  *out = (mps_totals){
      .mass = mpsi_exact_value(&sum[MASS]),
      .volume = (double)dynamics->whole_body * D * D * dynamics->def.measure,
      .linear = {mpsi_exact_value(&sum[LINEAR_X]), mpsi_exact_value(&sum[LINEAR_Y]), 0.0},
      .angular = {0.0, 0.0, mpsi_exact_value(&sum[ANGULAR])},
      .work_loads = mpsi_exact_value(&sum[LOADS]),
      .work_boundaries = mpsi_exact_value(&sum[BOUNDARIES]),
      .dissipated = mpsi_exact_value(&sum[DAMPING])};
  return status;
}

/* Energies need the pressures of the present positions, which the field does not have: the kernels
 * write them to `own`. */
static mps_status read_energies(mps_dynamics *dynamics, const char *function, double *own,
                                mps_totals *out) {
  mpsi_dynamics_state *s = &dynamics->state;
  double *const field = s->p;
  memcpy(own, field, (size_t)(dynamics->count + dynamics->ghosts) * sizeof *own);
  s->p = own;
  const mps_status status = mpsi_dynamics_energies(dynamics, function, &out->kinetic, &out->strain);
  s->p = field;
  return status;
}

static mps_status find_totals(mps_dynamics *dynamics, const char *function, mps_totals *t) {
  const int64_t length = dynamics->count + dynamics->ghosts + MPSI_PARTICLES_PADDING;
  double *own = mpsi_alloc(dynamics->context, length, sizeof *own);
  mps_status status = mpsi_particles_committed(dynamics->particles, function);
  if (!own) status = mpsi_fail_memory(dynamics->context, function, (size_t)length * sizeof *own);
  status = mpsi_domain_agree(dynamics->domain, function, status);
  if (status == MPS_OK) status = mpsi_dynamics_choose_dt(dynamics, function);
  if (status == MPS_OK && dynamics->fresh) dynamics->kept = dynamics->dt; /* the step to come */
  if (status == MPS_OK) status = sum_up(dynamics, function, t);
  if (status == MPS_OK) status = read_energies(dynamics, function, own, t);
  mpsi_free(dynamics->context, own);
  return status;
}

mps_status mpsi_dynamics_get_totals(void *solver, const char *function, mps_totals *out) {
  mps_dynamics *dynamics = solver;
  mps_totals t;
  MPSI_TRY(find_totals(dynamics, function, &t));
  const mpsi_dynamics_works *w = &dynamics->works;
  const double start = dynamics->begun ? w->start : t.kinetic + t.strain;
  const double rest =
      t.work_loads + t.work_boundaries - t.dissipated - (t.kinetic + t.strain - start);
  t.scheme = NAN;
  if (dynamics->body < dynamics->count) {
    t.work_boundaries -= rest;
  } else {
    t.dissipated += rest;
    if (dynamics->damping == MPSI_DYN_UNDAMPED || dynamics->def.watch_damping) t.scheme = rest;
  }
  *out = t;
  return MPS_OK;
}
