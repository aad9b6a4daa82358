/* limit.c - Courant limit and time step of a solver. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

double mpsi_mpm_limit(const void *solver) {
  const mps_mpm *mpm = solver;
  double speed = mpm->run.speed;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    speed = fmax(speed, mpsi_contact_speed(mpm->contact.handle[b]));
  return speed > 0.0 ? mpm->grid.cell / speed : INFINITY; /* INFINITY without particles */
}

double mpsi_mpm_dt(const mps_mpm *mpm) {
  return isnan(mpm->def.dt) ? mpm->def.courant * mpsi_mpm_limit(mpm) : mpm->def.dt;
}
