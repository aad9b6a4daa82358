/* move.h - pressure gradient, velocities, positions.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_MOVE_H
#define MPSI_FLUID_MOVE_H

#include <mps/fluid.h>

void mpsi_fluid_find_velocities(mps_fluid *fluid);
int64_t mpsi_fluid_advance(mps_fluid *fluid); /* first particle that failed, or -1 */

#define MPSI_FLUID_OFF_WALL 0.1 /* l0: no particle comes closer to a wall */

#endif
