/* partition.h - the part of one rank in a body that lies on several; all functions are collective.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/particles/particles_internal.h"
#include "dynamics/pairs/structure.h"

#include <mps/dynamics.h>

/* Keeps this rank's part of the sorted set; the rest is in *former. `status` is that of this rank
 * so far. */
mps_status mpsi_dynamics_take_partition(mps_dynamics *dynamics, const char *function,
                                        mps_status status, mpsi_dynamics_structure *out,
                                        mpsi_storage **former, mpsi_backup *backup);
/* Present displacement and rotation of ghosts; nothing to do on one rank. */
mps_status mpsi_dynamics_bring_motion(mps_dynamics *dynamics, const char *function);
/* After mpsi_dynamics_set_coefficients: those of ghosts, extremes, kind of damping. */
mps_status mpsi_dynamics_join_coefficients(mps_dynamics *dynamics, const char *function,
                                           mps_status status);
