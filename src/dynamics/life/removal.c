/* removal.c - particles that leave the body between two steps: erosion, excavation. Everything that
 * can fail is done before they are removed; then the solver continues with the remaining ones, from
 * their displacements and velocities. None can be added: in a body in motion a new particle has no
 * reference position.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "removal.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/life/change.h"
#include "dynamics/step/ground.h"

/* Marks removed particles: now[i] = -1. */
static mps_status mark(mps_dynamics *dynamics, const char *function, int64_t count,
                       const int64_t *ids, int32_t *now) {
  for (int64_t k = 0; k < count; k++) {
    const int64_t i = mps_particles_index(dynamics->particles, ids[k]);
    now[i] = -1;
    if (i < dynamics->body) continue;
    (void)mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                    "particle %lld belongs to a free-field column, which stays whole",
                    (long long)ids[k]);
    mpsi_fail_where(dynamics->context, -1, ids[k]);
    return MPS_ERROR_ARGUMENT;
  }
  if (count < dynamics->body) return MPS_OK;
  return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                   "all %lld particles of the body are to be removed, at least one must stay",
                   (long long)dynamics->body);
}

/* Numbers the remaining particles, in the present order, and their positions: x, y, side. */
static int64_t number(const mps_dynamics *dynamics, int32_t *now, double *x, double *y,
                      int64_t *side) {
  const int64_t *column = mpsi_particles_integers(dynamics->particles, "free_field");
  int64_t left = 0;
  for (int64_t i = 0; i < dynamics->count; i++) {
    if (now[i] < 0) continue;
    x[left] = dynamics->state.rx[i], y[left] = dynamics->state.ry[i];
    side[left] = column ? column[i] : 0;
    now[i] = (int32_t)left++;
  }
  return left;
}

static mps_status prepare(mps_dynamics *dynamics, const char *function, int64_t count,
                          const int64_t *ids) {
  mps_context *context = dynamics->context;
  const int64_t n = dynamics->count;
  int32_t *now = mpsi_alloc(context, n, sizeof *now);
  double *x = mpsi_alloc(context, 2 * n, sizeof *x);
  int64_t *side = mpsi_alloc(context, n, sizeof *side);
  mps_status status = MPS_OK;
  if (!now || !x || !side) status = mpsi_fail_memory(context, function, (size_t)n * 28);
  if (status == MPS_OK) status = mark(dynamics, function, count, ids, now);
  if (status == MPS_OK) {
    const int64_t left = number(dynamics, now, x, x + n, side);
    const mpsi_dynamics_geometry g = mpsi_dynamics_geometry_of(dynamics, left, x, x + n, side);
    status = mpsi_dynamics_prepare_change(dynamics, function, &g);
  }
  if (status == MPS_OK) {
    dynamics->change->now = now;
    status = mpsi_dynamics_present_energy(dynamics, function, &dynamics->change->energy);
  } else {
    mpsi_free(context, now);
  }
  MPSI_FREE(context, x, side);
  return status;
}

mps_status mpsi_dynamics_remove(void *self, const char *function, int64_t count,
                                const int64_t *ids) {
  mps_dynamics *dynamics = self;
  mps_status status = mpsi_dynamics_enter(dynamics, function);
  if (mpsi_domain_many(dynamics->domain))
    return mpsi_fail(dynamics->context, function, MPS_ERROR_UNSUPPORTED,
                     "the particles lie on %d ranks: none can be removed there",
                     mps_domain_size(dynamics->domain));
  if (status == MPS_OK) status = mpsi_dynamics_read_edits(dynamics, function, MPS_OK);
  return status == MPS_OK ? prepare(dynamics, function, count, ids) : status;
}

void mpsi_dynamics_renew(void *self) {
  mps_dynamics *dynamics = self;
  const mpsi_dynamics_change *c = dynamics->change;
  mpsi_dynamics_bind(dynamics);
  if (c &&
      mps_particles_count(dynamics->particles) == c->structure.count) { /* no holder has refused */
    const double energy = c->energy;
    mpsi_dynamics_use_change(dynamics);
    double left = 0.0;
    (void)mpsi_dynamics_present_energy(dynamics, "mps_particles_remove", &left); /* one rank */
    dynamics->works.start += left - energy;
    dynamics->no_rate = true;
  }
  mpsi_dynamics_drop_change(dynamics);
}
