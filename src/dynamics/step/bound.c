/* bound.c - see bound.h. Verlet and leapfrog keep E = v-.M.v+/2 + U (budget.c) but for the works of
 * boundaries and loads, and damping takes from it. With r = dt over the limit of a linear body,
 * E >= (1 - r^2) v-.M.v-/2, so that the kinetic energy of the half steps is
 *
 *   T <= (E0 + largest sum of works so far)/(1 - r^2),
 *
 * 1e6 times that energy for every dt up to all but 5e-7 of the limit. Above the limit T grows by
 * (r + sqrt(r^2 - 1))^4 in a step, 3.5 for r = 1.05. Euler's method without damping always grows;
 * its limit for a duration allows amplitudes of 1e15 times the first, energies of 1e30. Free-field
 * columns do work on the body that is not counted: with them, and where the caller gives a
 * criterion of divergence, accelerations alone are bounded.
 *
 * Saving every step would cost more than the sums of the energy: a step is saved after a change by
 * the caller, and where accelerations or the energy are near their bounds.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "bound.h"

#include "dynamics/base/dynamics_solver.h"

#define TINY 1e-20 /* m Vp^2: round-off of a body at rest */
#define EVERY 32   /* steps */
#define NEAR 1e-4  /* part of the bound from which every step is checked and saved */

static void kinetic_of_block(void *data, int64_t b, int32_t worker) {
  mps_dynamics *dynamics = data;
  const mpsi_dynamics_state *s = &dynamics->state;
  const mpsi_dynamics_block *block = &dynamics->mesh.block[b];
  const bool verlet = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_VERLET;
  const double *const now[3] = {s->dx, s->dy, s->th}, *const old[3] = {s->ox, s->oy, s->oth};
  const double *const v[3] = {s->vx, s->vy, s->vth}, *const inverse[3] = {s->ix, s->iy, s->ith};
  const double rate = 1.0 / dynamics->lag;
  const int64_t end = block->end < dynamics->body ? block->end : dynamics->body;
  double sum = 0.0;
  for (int c = 0; c < 3; c++) /* ith is 3/(rho D^2), of half the moment of inertia */
    for (int64_t k = block->begin; k < end; k++) {
      const double speed = verlet ? (now[c][k] - old[c][k]) * rate : v[c][k];
      sum += speed * speed / inverse[c][k];
    }
  dynamics->part[b] = sum;
}

enum { KINETIC, LOADS, BOUNDARIES, SUMS };

/* Kinetic energy by the velocities half a step before, with twice that of the spins, and works, J:
 * of all ranks, with the bits of one. */
static mps_status find_sums(mps_dynamics *dynamics, const char *function, double *out) {
  mpsi_exact sum[SUMS] = {{{0}}, dynamics->works.loads, dynamics->works.boundaries};
  const double scale = 0.5 * dynamics->spacing * dynamics->spacing * dynamics->def.measure;
  mpsi_parallel_for(dynamics->context, dynamics->mesh.blocks, kinetic_of_block, dynamics);
  for (int64_t b = 0; b < dynamics->mesh.blocks; b++)
    mpsi_exact_add(&sum[KINETIC], scale * dynamics->part[b]);
  const mps_status status = mpsi_domain_sum_exact(dynamics->domain, function, SUMS, sum);
  for (int k = 0; k < SUMS; k++) out[k] = mpsi_exact_value(&sum[k]);
  return status;
}

/* Adds the kinetic energy of the body if all moves with its fastest wave, J, to the bound, as a
 * measure of round-off; and whether some rank has not saved the step. */
static mps_status find_rest(mps_dynamics *dynamics, const char *function, bool *saved) {
  const mpsi_dynamics_state *s = &dynamics->state;
  mpsi_dynamics_bound_state *b = &dynamics->limits;
  double most[2] = {0.0, !b->before || b->saved != dynamics->steps - 1};
  for (int64_t k = 0; k < dynamics->body; k++)
    most[0] = fmax(most[0], s->lambda[k] + 2.0 * s->mu[k]);
  const mps_status status = mpsi_domain_max(dynamics->domain, function, 2, most);
  b->most += TINY * most[0] * dynamics->spacing * dynamics->spacing * dynamics->def.measure *
             (double)dynamics->whole_body;
  *saved = most[1] == 0.0;
  return status;
}

mps_status mpsi_dynamics_find_excess(mps_dynamics *dynamics, const char *function) {
  mpsi_dynamics_bound_state *b = &dynamics->limits;
  double sum[SUMS];
  bool saved = false;
  b->excess = 0.0;
  if (!b->bounded || dynamics->whole_body < dynamics->whole || isinf(dynamics->def.divergence))
    return MPS_OK;
  if (dynamics->steps % EVERY != 0 && !b->near) return MPS_OK;
  mps_status status = find_sums(dynamics, function, sum);
  if (status != MPS_OK) return status;
  b->works = fmax(b->works, sum[LOADS] + sum[BOUNDARIES]);
  b->factor = dynamics->def.integrator == MPS_DYNAMICS_INTEGRATOR_EULER ? 1e30 : 1e6;
  b->most = b->factor * (fmax(dynamics->works.start, 0.0) + fmax(b->works, 0.0) + b->accepted);
  b->near = sum[KINETIC] > NEAR * b->most;
  if (sum[KINETIC] > b->most) status = find_rest(dynamics, function, &saved);
  if (status == MPS_OK && sum[KINETIC] > b->most && saved) b->excess = sum[KINETIC];
  return status;
}

mps_status mpsi_dynamics_save_before(mps_dynamics *dynamics, const char *function) {
  mpsi_dynamics_bound_state *b = &dynamics->limits;
  if (isinf(dynamics->def.divergence)) return MPS_OK;
  if (b->accepts) {
    double kinetic, strain;
    MPSI_TRY(mpsi_dynamics_energies(dynamics, function, &kinetic, &strain));
    b->accepted = fmax(kinetic + strain, 0.0);
    b->accepts = false;
  }
  const bool due = b->changed || b->alarmed || b->near;
  b->changed = false;
  if (!due) return MPS_OK;
  b->saved = -1;
  const mps_status status = dynamics->keeper->save(dynamics, function, &b->before);
  if (status == MPS_OK) b->saved = dynamics->steps;
  return mpsi_domain_many(dynamics->domain) ? MPS_OK : status; /* others have saved it or not */
}

mps_status mpsi_dynamics_undo(mps_dynamics *dynamics, const char *function, mps_status status) {
  mpsi_dynamics_bound_state *b = &dynamics->limits;
  double lost = isinf(dynamics->def.divergence) || !b->before || b->saved < 0 ||
                b->saved != dynamics->steps - 1;
  const mps_status agreed = mpsi_domain_max(dynamics->domain, function, 1, &lost);
  dynamics->diverged = true;
  if (agreed != MPS_OK) return agreed;
  if (lost == 0.0 && dynamics->keeper->restore(dynamics, function, b->before) == MPS_OK)
    dynamics->diverged = false;
  b->changed = true;
  b->saved = -1;
  return status;
}
