/* state.h - the state of explicit dynamics, for the driver of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/state.h"

#include <mps/io.h>

mpsi_state_of mpsi_dynamics_describe(void *dynamics);
mps_status mpsi_dynamics_settle(void *dynamics, const char *function);
mps_status mpsi_dynamics_returned(void *dynamics, const char *function);
mps_status mpsi_dynamics_save(void *dynamics, const mpsi_state_of *of, const char *function,
                              const char *path, const mps_checkpoint *info);
