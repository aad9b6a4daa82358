/* access.c - whether a solver may be used between its steps. SPDX-License-Identifier: BSD-3-Clause
 */
#include "core/particles/particles_internal.h"
#include "mpm/base/columns.h"
#include "mpm/base/run.h"

mps_status mpsi_mpm_between_steps(mps_context *context, mpsi_run *run, const char *function) {
  const mps_status status = mpsi_guard_check(run->guard, context, function);
  run->changed = run->changed || status == MPS_OK;
  return status;
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
