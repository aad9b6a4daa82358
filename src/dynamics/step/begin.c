/* begin.c - the initial state, at creation and at a restart, and the fields of the present one.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "begin.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/boundary/constrain.h"

#include <float.h>
#include <string.h>

mps_status mpsi_dynamics_begin(mps_dynamics *dynamics, const char *function, double time) {
  const double former[2] = {dynamics->base_time, dynamics->length};
  const int64_t counted[2] = {dynamics->base_step, dynamics->steps};
  const bool fresh = dynamics->fresh;
  dynamics->base_time = time;
  dynamics->steps = dynamics->base_step = 0;
  dynamics->fresh = true;
  dynamics->kernels->trig[dynamics->def.rotation](&dynamics->state, 0, dynamics->count);
  const mps_status status = mpsi_dynamics_agree_signals(
      dynamics, function, mpsi_dynamics_take_bounds(dynamics, function), 0, NULL);
  if (status != MPS_OK) { /* a signal refused */
    dynamics->base_time = former[0];
    dynamics->base_step = counted[0], dynamics->steps = counted[1];
    dynamics->fresh = fresh;
    return status;
  }
  dynamics->diverged = dynamics->begun = dynamics->no_rate = false;
  dynamics->rewritten = NULL;
  dynamics->begins = false;
  memset(&dynamics->works, 0, sizeof dynamics->works);
  dynamics->limits.works = dynamics->limits.accepted = 0.0;
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++) {
    mpsi_dynamics_boundary *b = mpsi_dynamics_boundary_of(dynamics, k);
    if (!b) continue;
    memset(b->pushed, 0, sizeof b->pushed);
    memset(b->impulse, 0, sizeof b->impulse);
    memset(&b->work, 0, sizeof b->work);
    b->kick = 0.0;
  }
  for (int64_t k = 0; k < dynamics->dashpots; k++) dynamics->dashpot[k].force = 0.0;
  mpsi_dynamics_publish(dynamics);
  return MPS_OK;
}

mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time) {
  if (!dynamics) return mpsi_null(__func__, "dynamics");
  mps_status status = mpsi_dynamics_enter(dynamics, __func__);
  if (status == MPS_OK) status = mpsi_particles_ready(dynamics->particles, __func__);
  if (status != MPS_OK) return status;
  if (!isfinite(time))
    return mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                     "time is %g s, must be finite", time);
  const mpsi_dynamics_state *s = &dynamics->state;
  const double *const column[6] = {s->dx, s->dy, s->th, s->vx, s->vy, s->vth};
  const double fastest = MPSI_DYNAMICS_FASTEST;
  const double most[6] = {DBL_MAX, DBL_MAX, DBL_MAX, fastest, fastest, fastest / dynamics->spacing};
  for (int c = 0; c < 6 && status == MPS_OK; c++)
    for (int64_t k = 0; k < dynamics->count && status == MPS_OK; k++)
      if (!(fabs(column[c][k]) <= most[c]))
        status =
            mpsi_fail(dynamics->context, __func__, MPS_ERROR_ARGUMENT,
                      "dynamics: the initial state of particle %lld is not finite (%g), or a speed "
                      "beyond %g m/s",
                      (long long)mpsi_particles_integers(dynamics->particles, "id")[k],
                      column[c][k], MPSI_DYNAMICS_FASTEST);
  status = mpsi_domain_agree_same(dynamics->domain, __func__, status, "time", time);
  if (status != MPS_OK) return status;
  return mpsi_dynamics_begin(dynamics, __func__, time);
}

static void publish_reactions(mps_dynamics *dynamics) {
  double *const r[2] = {mpsi_particles_column(dynamics->particles, "reaction", 0),
                        mpsi_particles_column(dynamics->particles, "reaction", 1)};
  if (!r[0]) return;
  for (int64_t k = 0; k < dynamics->count; k++) r[0][k] = r[1][k] = 0.0;
  for (int64_t k = 0; k < dynamics->bounds; k++)
    if (dynamics->bound[k].component < 2)
      r[dynamics->bound[k].component][dynamics->bound[k].particle] += dynamics->bound[k].force;
  for (int64_t k = 0; k < dynamics->dashpots; k++)
    if (dynamics->dashpot[k].boundary >= 0)
      r[dynamics->dashpot[k].component][dynamics->dashpot[k].particle] +=
          dynamics->dashpot[k].force;
}

void mpsi_dynamics_publish(mps_dynamics *dynamics) {
  mpsi_dynamics_state *s = &dynamics->state;
  const double *const d[3] = {s->dx, s->dy, s->th}, *const o[3] = {s->ox, s->oy, s->oth};
  const double *const reference[2] = {s->rx, s->ry};
  double *const v[3] = {s->vx, s->vy, s->vth};
  for (int c = 0; c < 2; c++) {
    double *position = mpsi_dynamics_column(dynamics, "position", c);
    for (int64_t k = 0; k < dynamics->count; k++) position[k] = reference[c][k] + d[c][k];
  }
  publish_reactions(dynamics);
  if (dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_VERLET || dynamics->fresh) return;
  for (int c = 0; c < 3; c++)
    for (int64_t k = 0; k < dynamics->count; k++) v[c][k] = (d[c][k] - o[c][k]) / dynamics->lag;
}
