/* closed.h - fluid without a free surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* MPS_ERROR_STATE for a step that changes the volume of a space that the fluid fills. */
mps_status mpsi_fluid_check_space(mps_fluid *fluid, const char *function);
/* For a fluid without surface: subtracts the mean of the right side; sets the solution's constant.
 */
void mpsi_fluid_balance(mps_fluid *fluid);
void mpsi_fluid_set_level(mps_fluid *fluid);
