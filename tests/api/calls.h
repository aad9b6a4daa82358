/* calls.h - common declarations of the files of calls: their tables, and the calls of a scene.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef TESTS_API_CALLS_H
#define TESTS_API_CALLS_H

#include "api.h"

#include <math.h>
#include <string.h>

extern const api_table api_context_calls, api_particles_calls, api_signal_calls, api_material_calls,
    api_body_calls, api_mpm_calls, api_dynamics_calls, api_elastic_calls, api_fluid_calls,
    api_io_calls, api_waves_calls, api_history_calls;

/* A box of `size` within the scene. */
void api_box(api *a, double size, double *lo, double *hi);

#endif
