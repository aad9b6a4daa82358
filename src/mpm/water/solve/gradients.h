/* gradients.h - conjugate gradients for the pressures that are implicit in time.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/water/system.h"

/* `change`: the matrix times it is the right-hand side, which `residual` holds at the call.
 * Collective. MPS_ERROR_NUMERIC: no solution to the tolerance. */
mps_status mpsi_pore_find_changes(mps_mpm *mpm, const char *function);
