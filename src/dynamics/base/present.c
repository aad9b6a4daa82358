/* present.c - access to the present state: time, velocities, masses, fields; arrays of the energy
 * budget. SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "present.h"
#include "dynamics/base/dynamics_solver.h"

mps_status mpsi_dynamics_enter(mps_dynamics *dynamics, const char *function) {
  const mps_status status = mpsi_guard_check(&dynamics->guard, dynamics->context, function);
  dynamics->limits.changed = dynamics->limits.changed || status == MPS_OK;
  return status;
}

double *mpsi_dynamics_column(const mps_dynamics *dynamics, const char *name, int32_t component) {
  return mpsi_particles_column(dynamics->particles, name, component);
}

double mpsi_dynamics_time(const void *solver) {
  const mps_dynamics *dynamics = solver;
  return dynamics->base_time + (double)(dynamics->steps - dynamics->base_step) * dynamics->length;
}

int64_t mpsi_dynamics_steps(const void *solver) { return ((const mps_dynamics *)solver)->steps; }

double mpsi_dynamics_velocity(const mps_dynamics *dynamics, int32_t component, int64_t k) {
  const mpsi_dynamics_state *s = &dynamics->state;
  if (dynamics->def.integrator != MPS_DYNAMICS_INTEGRATOR_VERLET || dynamics->fresh)
    return (component == 0 ? s->vx : component == 1 ? s->vy : s->vth)[k];
  if (component == 2) return (s->th[k] - s->oth[k]) / dynamics->lag;
  return component == 0 ? (s->dx[k] - s->ox[k]) / dynamics->lag
                        : (s->dy[k] - s->oy[k]) / dynamics->lag;
}

double mpsi_dynamics_mass(const mps_dynamics *dynamics, int32_t component, int64_t k) {
  const double D = dynamics->spacing, area = D * D;
  const double mass = area * dynamics->def.measure / dynamics->state.ix[k];
  return component == 2 ? mass * area / 6.0 : mass;
}

void mpsi_dynamics_forget_limit(mps_dynamics *dynamics) {
  dynamics->have_limit = dynamics->checked = false;
  if (isnan(dynamics->def.dt)) dynamics->dt = NAN;
}

bool mpsi_dynamics_reserve_accounts(mps_dynamics *dynamics) {
  if (!dynamics->before)
    dynamics->before = mpsi_alloc(dynamics->context, 3 * dynamics->count, sizeof(double));
  return dynamics->before != NULL;
}

mps_status mpsi_dynamics_reserve_watch(mps_dynamics *dynamics, const char *function) {
  if (!dynamics->def.watch_damping) return MPS_OK; /* whether it is damped may change */
  if (!dynamics->drag)
    dynamics->drag = mpsi_alloc(dynamics->context, 3 * dynamics->count, sizeof *dynamics->drag);
  if (dynamics->drag && mpsi_dynamics_reserve_accounts(dynamics)) return MPS_OK;
  return mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
}
