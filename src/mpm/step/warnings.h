/* warnings.h - what the log says of a step, once. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/mpm_solver.h"

/* Before the step: of a dt that is too long for the Courant limit or for a penalty contact, of a
 * steady acceleration that water in the pores does not feel. */
void mpsi_step_warn_before(mps_mpm *mpm);
/* After it: of ground that has grown to more than the loosest sand. */
void mpsi_step_warn_about_volume(mps_mpm *mpm);
/* After it: of bodies that have come to overlap, or beyond a side of the domain, and of friction by
 * penalty where water bears a part of the normal force. */
void mpsi_step_warn_about_bodies(mps_mpm *mpm);
