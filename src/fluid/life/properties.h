/* properties.h - density and viscosity from the set and a material.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

mps_status mpsi_fluid_check_viscosity(mps_context *context, const char *function, double viscosity);
/* Density and viscosity of a definition where it leaves them to the set's field and a
 * material. */
mps_status mpsi_fluid_read_material(mps_context *context, const char *function,
                                    const mps_particles *particles, mps_fluid_def *def);
