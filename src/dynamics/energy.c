/* energy.c - energies and momenta of the present state, free-field columns excluded.
 *
 * Kinetic energy is v-.M.v+ / 2 with the velocities half a step before and after the state: with
 * the strain energy of the state it is the invariant that Verlet and leapfrog keep exactly for a
 * linear body. Sums run by blocks in a fixed order.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "dynamics_private.h"

typedef struct work {
  mps_dynamics *dynamics;
  mps_dynamics_energy *part; /* one a block */
} work;

static void first_pass(void *data, int64_t b, int32_t worker) {
  mps_dynamics *dynamics = ((work *)data)->dynamics;
  dynamics->kernels->pass1[dynamics->def.rotation == MPS_ROTATION_MEAN_MATRIX][0](
      &dynamics->state, &dynamics->mesh, b, dynamics->scratch + worker * MPSI_DYN_SCRATCH);
}

/* |u|^2 of a pair, by the removal in use. */
static double deformation2(const mps_dynamics *dynamics, int64_t i, int64_t j, double r0x,
                           double r0y) {
  const mpsi_dynamics_state *s = &dynamics->state;
  double a = 0.5 * (s->c[i] + s->c[j]), b = 0.5 * (s->s[i] + s->s[j]);
  if (dynamics->def.rotation == MPS_ROTATION_MEAN_ANGLE) {
    a = s->c[i] + s->c[j] + s->c[i] * s->c[j] - s->s[i] * s->s[j];
    b = s->s[i] * (1.0 + s->c[j]) + (1.0 + s->c[i]) * s->s[j];
  }
  const double ux = s->dx[j] - s->dx[i] - (a * r0x - b * r0y);
  const double uy = s->dy[j] - s->dy[i] - (b * r0x + a * r0y);
  return ux * ux + uy * uy;
}

/* Shear energy of the pairs whose first end the block owns, and the pressure forces on its
 * particles (into fx, fy: twice MPSI_DYN_BLOCK doubles). */
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
        shear += 0.5 * run->kf * (s->mu[i] + s->mu[j]) *
                 deformation2(dynamics, i, j, run->r0x, run->r0y);
    }
  }
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++, slot++) {
    const int64_t i = list->i[k], j = list->j[k];
    const double sum = s->p[i] + s->p[j], x = sum * s->ex[slot], y = sum * s->ey[slot];
    if (list->ti[k] >= 0) fx[list->ti[k] - begin] -= x, fy[list->ti[k] - begin] -= y;
    if (list->tj[k] >= 0) fx[list->tj[k] - begin] += x, fy[list->tj[k] - begin] += y;
    if (list->ti[k] == i && i < dynamics->body)
      shear += 0.5 * list->kf[k] * (s->mu[i] + s->mu[j]) *
               deformation2(dynamics, i, j, list->r0x[k], list->r0y[k]);
  }
  return shear;
}

/* v-.v+ of one component; `a` is the acceleration between them. */
static double speeds(const mps_dynamics *dynamics, const double *d, const double *o,
                     const double *v, int64_t k, double a) {
  const bool verlet = dynamics->def.integrator == MPS_INTEGRATOR_VERLET;
  const double before = verlet && !dynamics->fresh ? (d[k] - o[k]) / dynamics->dt : v[k];
  const double after =
      dynamics->def.integrator == MPS_INTEGRATOR_EULER ? before : before + dynamics->dt * a;
  return before * after;
}

static void energy_block(void *data, int64_t b, int32_t worker) {
  (void)worker;
  const work *w = data;
  const mps_dynamics *dynamics = w->dynamics;
  const mpsi_dynamics_state *s = &dynamics->state;
  const mpsi_dynamics_block *block = &dynamics->mesh.block[b];
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double D = mps_particles_spacing(dynamics->particles), area = D * D;
  double fx[MPSI_DYN_BLOCK] = {0}, fy[MPSI_DYN_BLOCK] = {0};
  mps_dynamics_energy e = {0};
  e.shear = area * block_pairs(dynamics, block, fx, fy);
  for (int64_t k = block->begin; k < block->end && k < dynamics->body; k++) {
    const double mass = rho[k] * area, inertia = mass * area / 6.0;
    const double ax = s->ix[k] * (s->gx[k] + fx[k - block->begin]);
    const double ay = s->iy[k] * (s->gy[k] + fy[k - block->begin]);
    e.kinetic += 0.5 * mass *
                 (speeds(dynamics, s->dx, s->ox, s->vx, k, ax) +
                  speeds(dynamics, s->dy, s->oy, s->vy, k, ay));
    e.spin += 0.5 * inertia * speeds(dynamics, s->th, s->oth, s->vth, k, s->ith[k] * s->gth[k]);
    if (s->lambda[k] > 0.0) e.volumetric += 0.5 * area * s->p[k] * s->p[k] / s->lambda[k];
  }
  w->part[b] = e;
}

mps_status mps_dynamics_get_energy(mps_dynamics *dynamics, mps_dynamics_energy *out) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  const mps_status status = mpsi_dynamics_settle_dt(dynamics, __func__);
  if (status != MPS_OK) return status;
  const int64_t blocks = dynamics->mesh.blocks;
  work w = {.dynamics = dynamics,
            .part = mpsi_alloc(dynamics->context, blocks, sizeof(mps_dynamics_energy))};
  if (!w.part)
    return mpsi_fail_memory(dynamics->context, __func__, (size_t)blocks * sizeof *w.part);
  mpsi_parallel_for(dynamics->context, blocks, first_pass, &w);
  mpsi_parallel_for(dynamics->context, blocks, energy_block, &w);
  *out = (mps_dynamics_energy){0};
  for (int64_t b = 0; b < blocks; b++) {
    out->kinetic += w.part[b].kinetic;
    out->spin += w.part[b].spin;
    out->shear += w.part[b].shear;
    out->volumetric += w.part[b].volumetric;
  }
  out->total = out->kinetic + out->spin + out->shear + out->volumetric;
  mpsi_free(dynamics->context, w.part);
  return MPS_OK;
}

mps_status mps_dynamics_get_momentum(mps_dynamics *dynamics, mps_dynamics_momentum *out) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  mpsi_dynamics_publish(dynamics);
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *rho = mpsi_dynamics_column(dynamics, "density", 0);
  const double *x = mpsi_dynamics_column(dynamics, "position", 0);
  const double *y = mpsi_dynamics_column(dynamics, "position", 1);
  const double D = mps_particles_spacing(dynamics->particles), area = D * D;
  mps_dynamics_momentum sum = {{0.0, 0.0}, 0.0, 0.0};
  for (int64_t k = 0; k < dynamics->body; k++) {
    const double mass = rho[k] * area;
    sum.linear[0] += mass * s->vx[k];
    sum.linear[1] += mass * s->vy[k];
    sum.orbital += mass * (x[k] * s->vy[k] - y[k] * s->vx[k]);
    sum.spin += mass * area / 6.0 * s->vth[k];
  }
  *out = sum;
  return MPS_OK;
}
