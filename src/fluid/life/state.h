/* state.h - the state of the fluid, for the driver of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/state.h"

mpsi_state_of mpsi_fluid_state(void *fluid);
/* MPS_ERROR_STATE while a step is open; a caller's solver forgets former equations. */
