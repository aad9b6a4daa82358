/* tangent.c - the tangent of the restoring forces at the reference state, Yoshida (A6), (A7),
 * (A10), (A11) and (A14) for small u and theta, in its symmetric form M^-1/2 K M^-1/2.
 *
 * Every pair term is the gradient of an energy in (x, y, theta) with half of a pair's moment to
 * either end, so K is symmetric; the inertia that belongs to it is rho D^2/6 a unit of area (half
 * of that for the printed torque). Free-field forces on an edge depend on the column alone: they
 * make the whole matrix block triangular without a change of its eigenvalues, so they are left out.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tangent.h"
#include "dynamics/base/dynamics_solver.h"

typedef struct tangent {
  const mps_dynamics *dynamics;
  const double *x; /* displacements and rotations, 3 columns of count + ghosts */
  double *y, *p;
  const double *weight; /* or NULL */
} tangent;

/* Sums of a block: force and moment of the shear part, divergence. */
typedef struct sums {
  double fx[MPSI_DYN_BLOCK], fy[MPSI_DYN_BLOCK], moment[MPSI_DYN_BLOCK], div[MPSI_DYN_BLOCK];
} sums;

/* A pair of particles; i and j are added to at ti and tj of the block, where these are >= 0. */
typedef struct pair {
  int64_t i, j, ti, tj;
  double r0x, r0y; /* m, from i to j at the start */
  double kf, kc;   /* factors of force and divergence */
} pair;

/* One pair of the first pass. */
static inline void shear_pair(const tangent *t, pair q, sums *s) {
  const int64_t n = t->dynamics->count + t->dynamics->ghosts, i = q.i, j = q.j;
  const double *x = t->x, *mu = t->dynamics->state.mu;
  const double dx = x[j] - x[i], dy = x[n + j] - x[n + i];
  const double mean = 0.5 * (x[2 * n + i] + x[2 * n + j]);
  const double weight = t->weight ? 0.5 * (t->weight[i] + t->weight[j]) : 1.0;
  const double stiff = weight * q.kf * mpsi_dynamics_pair_shear(mu[i], mu[j]);
  const double fx = stiff * (dx + mean * q.r0y), fy = stiff * (dy - mean * q.r0x);
  const double moment = 0.5 * (q.r0x * fy - q.r0y * fx);
  const double div = q.kc * (q.r0x * dx + q.r0y * dy) / sqrt(q.r0x * q.r0x + q.r0y * q.r0y);
  if (q.ti >= 0)
    s->fx[q.ti] += fx, s->fy[q.ti] += fy, s->moment[q.ti] += moment, s->div[q.ti] += div;
  if (q.tj >= 0)
    s->fx[q.tj] -= fx, s->fy[q.tj] -= fy, s->moment[q.tj] += moment, s->div[q.tj] += div;
}

static inline void pressure_pair(const tangent *t, pair q, sums *s) {
  const double f = (t->p[q.i] + t->p[q.j]) * q.kc / sqrt(q.r0x * q.r0x + q.r0y * q.r0y);
  if (q.ti >= 0) s->fx[q.ti] -= f * q.r0x, s->fy[q.ti] -= f * q.r0y;
  if (q.tj >= 0) s->fx[q.tj] += f * q.r0x, s->fy[q.tj] += f * q.r0y;
}

/* All pairs of a block but free-field ghosts; pressure: which of the two passes. */
static void block_pairs(const tangent *t, const mpsi_dynamics_block *block, bool pressure,
                        sums *s) {
  const mpsi_dynamics_mesh *mesh = &t->dynamics->mesh;
  const int64_t begin = block->begin;
  for (int64_t r = block->run_begin; r < block->run_end; r++) {
    const mpsi_dynamics_pair_run *run = &mesh->run[r];
    for (int64_t k = 0; k < run->count; k++) {
      const int64_t i = run->i0 + k, j = run->j0 + k;
      const pair q = {.i = i,
                      .j = j,
                      .ti = run->own_i ? i - begin : -1,
                      .tj = run->own_j ? j - begin : -1,
                      .r0x = run->r0x,
                      .r0y = run->r0y,
                      .kf = run->kf,
                      .kc = run->kc};
      if (pressure)
        pressure_pair(t, q, s);
      else
        shear_pair(t, q, s);
    }
  }
  const mpsi_dynamics_scattered *list = &mesh->scattered;
  for (int64_t k = block->scattered_begin; k < block->scattered_end; k++) {
    const int64_t i = list->i[k], j = list->j[k];
    const pair q = {.i = i,
                    .j = j,
                    .ti = list->ti[k] == i ? i - begin : -1,
                    .tj = list->tj[k] == j ? j - begin : -1,
                    .r0x = list->r0x[k],
                    .r0y = list->r0y[k],
                    .kf = list->kf[k],
                    .kc = list->kc[k]};
    if (pressure)
      pressure_pair(t, q, s);
    else
      shear_pair(t, q, s);
  }
}

static void shear_block(void *data, int64_t b, int32_t worker) {
  const tangent *t = data;
  const mpsi_dynamics_block *block = &t->dynamics->mesh.block[b];
  const int64_t n = t->dynamics->count, begin = block->begin;
  sums s = {0};
  block_pairs(t, block, false, &s);
  for (int64_t k = begin; k < block->end; k++) {
    if (k < n) { /* not a ghost */
      t->y[k] = s.fx[k - begin];
      t->y[n + k] = s.fy[k - begin];
      t->y[2 * n + k] = s.moment[k - begin];
    }
    t->p[k] = -(t->weight ? t->weight[k] : 1.0) * t->dynamics->state.lambda[k] * s.div[k - begin];
  }
}

static void pressure_block(void *data, int64_t b, int32_t worker) {
  const tangent *t = data;
  const mpsi_dynamics_state *state = &t->dynamics->state;
  const mpsi_dynamics_block *block = &t->dynamics->mesh.block[b];
  const int64_t n = t->dynamics->count, begin = block->begin;
  sums s = {0};
  block_pairs(t, block, true, &s);
  for (int64_t k = begin; k < block->end; k++) {
    t->y[k] = -sqrt(state->ix[k]) * (t->y[k] + s.fx[k - begin]);
    t->y[n + k] = -sqrt(state->iy[k]) * (t->y[n + k] + s.fy[k - begin]);
    t->y[2 * n + k] *= -sqrt(2.0 * state->ith[k]);
  }
}

mps_status mpsi_dynamics_tangent_apply(mps_dynamics *dynamics, const char *function,
                                       const double *weight, const double *x, double *y,
                                       double *work) {
  const mpsi_dynamics_state *state = &dynamics->state;
  const int64_t n = dynamics->count, m = n + dynamics->ghosts;
  double *const column[3] = {work, work + m, work + 2 * m};
  for (int64_t k = 0; k < n; k++) {
    column[0][k] = sqrt(state->ix[k]) * x[k];
    column[1][k] = sqrt(state->iy[k]) * x[n + k];
    column[2][k] = sqrt(2.0 * state->ith[k]) * x[2 * n + k];
  }
  if (dynamics->halo) {
    MPSI_TRY(mpsi_halo_begin(dynamics->halo, function, 3, column));
    MPSI_TRY(mpsi_halo_end(dynamics->halo, function, column));
  }
  tangent t = {.dynamics = dynamics, .x = work, .y = y, .p = work + 3 * m, .weight = weight};
  mpsi_parallel_for(dynamics->context, dynamics->mesh.blocks + dynamics->mesh.ghosts, shear_block,
                    &t);
  mpsi_parallel_for(dynamics->context, dynamics->mesh.blocks, pressure_block, &t);
  for (int64_t k = 0; k < dynamics->bounds; k++)
    y[dynamics->bound[k].component * n + dynamics->bound[k].particle] = 0.0;
  return MPS_OK;
}
