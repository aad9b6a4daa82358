/* step.h - steps of the fluid, and their size, for the run of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/solver_base.h"

double mpsi_fluid_limit(const void *fluid);
double mpsi_fluid_dt(void *fluid, const char *function);
mps_status mpsi_fluid_begin_march(void *fluid, const char *function, mpsi_march *march);
mps_status mpsi_fluid_advance_march(void *fluid, const char *function, mpsi_march *march,
                                    int64_t count);
