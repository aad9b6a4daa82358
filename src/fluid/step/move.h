/* move.h - pressure gradient, velocities, positions.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

void mpsi_fluid_find_velocities(mps_fluid *fluid);
/* The first particle that is not finite, or the one that moves most where that is too far; -1:
 * none. `way`: its displacement (m). */
int64_t mpsi_fluid_advance(mps_fluid *fluid, double *way);

#define MPSI_FLUID_OFF_WALL 0.1 /* l0: no particle comes closer to a wall */
