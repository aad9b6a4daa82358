/* totals.h - sums over the particles, for the functions of all solvers.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_TOTALS_H
#define MPSI_MPM_TOTALS_H

#include <mps/mpm.h>

mps_status mpsi_mpm_get_totals(void *mpm, const char *function, mps_totals *out);

#endif
