/* afloat.h - floating bodies, solved with the pressure.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

bool mpsi_fluid_any_afloat(const mps_fluid *fluid);
mps_status mpsi_fluid_solve_afloat(mps_fluid *fluid, const char *function);
