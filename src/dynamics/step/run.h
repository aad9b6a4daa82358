/* run.h - steps and runs, for the loop of all solvers.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/solver_base.h"

#include <mps/dynamics.h>

/* MPS_ERROR_STATE when the run has diverged. */
mps_status mpsi_dynamics_check_diverged(const mps_dynamics *dynamics, const char *function);
/* MPS_ERROR_STATE when a call is under way or the run has diverged; reads edited material
 * fields and chooses dt if need be. */
mps_status mpsi_dynamics_ready(mps_dynamics *dynamics, const char *function);

mps_status mpsi_dynamics_begin_march(void *dynamics, const char *function, mpsi_march *march);
int64_t mpsi_dynamics_batch(const void *dynamics, const mpsi_march *march, int64_t most);
mps_status mpsi_dynamics_advance_march(void *dynamics, const char *function, mpsi_march *march,
                                       int64_t count);
mps_status mpsi_dynamics_end_march(void *dynamics, const char *function, const mpsi_march *march,
                                   mps_status status);
