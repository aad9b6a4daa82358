/* conditions.h - boundaries and loads by number, for the functions of all solvers.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/conditions.h"

#include <mps/mpm.h>

extern const mpsi_condition_kind mpsi_mpm_boundary_kind, mpsi_mpm_load_kind;
mps_status mpsi_mpm_get_reaction(void *mpm, const char *function, mps_status status, int32_t number,
                                 mps_reaction *out);
