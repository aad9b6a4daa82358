/* limit.c - Courant limit, time step, time and number of steps of a solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

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
