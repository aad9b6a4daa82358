/* run.h - step and run as the caller sees them.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_RUN_H
#define MPSI_DYNAMICS_RUN_H

#include <mps/dynamics.h>

/* MPS_ERROR_STATE when the run has diverged. */
mps_status mpsi_dynamics_check_diverged(const mps_dynamics *dynamics, const char *function);
/* MPS_ERROR_STATE when a call is under way or the run has diverged; reads edited material
 * fields and chooses dt if need be. */
mps_status mpsi_dynamics_ready(mps_dynamics *dynamics, const char *function);

#endif
