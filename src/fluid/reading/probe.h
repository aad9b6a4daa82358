/* probe.h - pressure at walls, level of the surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

mps_status mpsi_fluid_load_walls(mps_fluid *fluid, const char *function);

/* What boundary `number` exerts. */
mps_status mpsi_fluid_get_reaction(void *fluid, const char *function, mps_status status,
                                   int32_t number, mps_reaction *out);
