/* clearance.h - distance of bodies from polylines: see clearance.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/boundary/polyline.h"

/* Body `number` and all polylines: MPS_ERROR_ARGUMENT where they are too close, MPS_ERROR_STATE
 * where they come too close in the step (next). */
mps_status mpsi_fluid_check_clearance(mps_fluid *fluid, const char *function, bool next,
                                      int32_t number);
/* A polyline and all bodies: MPS_ERROR_ARGUMENT where they are too close. */
mps_status mpsi_fluid_check_bodies(mps_fluid *fluid, const char *function,
                                   const mpsi_fluid_polyline *line);
/* Before weights of a larger radius (m) are used, those of rock: MPS_ERROR_ARGUMENT where a body or
 * a plane wall is closer than that to a polyline or its corners. */
mps_status mpsi_fluid_check_reach(mps_fluid *fluid, const char *function, double reach);
