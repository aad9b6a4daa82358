/* march.h - steps of WLS-MPM, for the loop of all solvers. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/solver_base.h"

mps_status mpsi_mpm_check_dt(void *mpm, const char *function, double dt);
mps_status mpsi_mpm_begin_march(void *mpm, const char *function, mpsi_march *march);
mps_status mpsi_mpm_advance_march(void *mpm, const char *function, mpsi_march *march,
                                  int64_t count);
mps_status mpsi_mpm_end_march(void *mpm, const char *function, const mpsi_march *march,
                              mps_status status);
bool mpsi_mpm_stopped(const void *mpm);
