/* motion.h - steps of a motion, for the loop of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/solver_base.h"

double mpsi_elastic_limit(const void *elastic);
mps_status mpsi_elastic_check_dt(void *elastic, const char *function, double dt);
mps_status mpsi_elastic_use_dt(void *elastic, const char *function, double dt);
mps_status mpsi_elastic_begin_march(void *elastic, const char *function, mpsi_march *march);
mps_status mpsi_elastic_advance_march(void *elastic, const char *function, mpsi_march *march,
                                      int64_t count);
mps_status mpsi_elastic_end_march(void *elastic, const char *function, const mpsi_march *march,
                                  mps_status status);
