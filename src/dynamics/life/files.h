/* files.h - checkpoints of several ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/state.h"

#include <mps/dynamics.h>

mps_status mpsi_dynamics_save_partitions(mps_dynamics *dynamics, const mpsi_state_of *of,
                                         const char *function, const char *path,
                                         const mps_checkpoint *info);
mps_status mpsi_dynamics_take_values(void *solver, const char *function, mps_status status,
                                     mps_snapshot *values);
