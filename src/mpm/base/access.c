/* access.c - queries of a solver between its steps: whether it may be used, Courant limit, time
 * step and time. SPDX-License-Identifier: BSD-3-Clause */
#include "kernels.h"
#include "mpm/particles/mpm_particles.h"

mps_status mpsi_mpm_between_steps(mps_context *context, const mpsi_run *run, const char *function) {
  return mpsi_guard_check(&run->guard, context, function);
}

/* Refuses after a step with values that are not finite, and while a field is being edited. */
mps_status mpsi_mpm_check_whole(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                                const char *function) {
  if (run->broken)
    return mpsi_fail(context, function, MPS_ERROR_STATE,
                     "an earlier step has left no state to go on from: roll back, restore a "
                     "checkpoint or make a new solver");
  return mpsi_particles_ready(p->set, function);
}

mps_status mpsi_mpm_usable(mps_mpm *mpm, const char *function) {
  const mps_status status = mpsi_mpm_between_steps(mpm->context, &mpm->run, function);
  return status == MPS_OK ? mpsi_mpm_check_whole(mpm->context, &mpm->p, &mpm->run, function)
                          : status;
}

double mps_mpm_limit(const mps_mpm *mpm) {
  if (!mpm) return 0.0;
  double speed = mpm->run.speed;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    speed = fmax(speed, mpsi_contact_speed(mpm->contact.handle[b]));
  return speed > 0.0 ? mpm->grid.cell / speed : INFINITY; /* INFINITY without particles */
}

double mps_mpm_dt(const mps_mpm *mpm) {
  if (!mpm) return 0.0;
  return mpm->def.dt > 0.0 ? mpm->def.dt : mpm->def.courant * mps_mpm_limit(mpm);
}

double mps_mpm_time(const mps_mpm *mpm) { return mpm ? mpm->run.time : 0.0; }

int64_t mps_mpm_steps(const mps_mpm *mpm) { return mpm ? mpm->run.steps : 0; }
