/* restart.h - the state of a motion, for the driver of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/state/state.h"

mpsi_state_of mpsi_elastic_state(void *elastic);
/* MPS_ERROR_STATE without a motion; for the second a removal may have ended it. */
mps_status mpsi_elastic_settle(void *elastic, const char *function);
mps_status mpsi_elastic_leave_state(void *elastic, const char *function);
