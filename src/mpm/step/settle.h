/* settle.h - the first step after settling.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_SETTLE_H
#define MPSI_MPM_SETTLE_H

#include "mpm/base/mpm_solver.h"

/* mpsi_mpm_take_step, before which the particles stop where mps_mpm_settle was cancelled. A step
 * that fails has changed nothing (on several ranks they stay at rest). */
mps_status mpsi_mpm_step_from_settling(mps_mpm *mpm, const char *function, double dt);
#endif
