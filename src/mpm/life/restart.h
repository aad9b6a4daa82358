/* restart.h - the state of WLS-MPM, for the driver of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/state.h"

#include <mps/io.h>

mpsi_state_of mpsi_mpm_state(void *mpm);
mps_status mpsi_mpm_settle_state(void *mpm, const char *function);
void mpsi_mpm_settled_state(void *mpm, mps_status status);
mps_status mpsi_mpm_returned(void *mpm, const char *function);
mps_status mpsi_mpm_save_state(void *mpm, const mpsi_state_of *of, const char *function,
                               const char *path, const mps_checkpoint *info);
