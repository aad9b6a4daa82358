/* bound.h - what energy allows the water. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

/* Before a step: energy that the caller has put in by edits, or by a former state. */
void mpsi_fluid_begin_bound(mps_fluid *f);
/* After the particles of a step have moved and the walls have their loads: MPS_ERROR_DIVERGED where
 * they have more kinetic energy than they can have. */
mps_status mpsi_fluid_check_bound(mps_fluid *f, const char *function);
