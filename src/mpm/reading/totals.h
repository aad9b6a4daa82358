/* totals.h - sums over the particles, for the functions of all solvers.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/mpm.h>

mps_status mpsi_mpm_get_totals(void *mpm, const char *function, mps_totals *out);
