/* friction.h - friction of walls, polylines and bodies: see friction.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

/* Particles of a chunk that lie beside faces with friction, whose new velocities are known. */
void mpsi_fluid_add_friction(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
