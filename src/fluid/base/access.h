/* access.h - checks of what a caller asks, loops over chunks of particles, kinetic energy.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* Runs task(fluid, chunk) for this rank's chunks of `items` items on the executor. */
typedef void (*mpsi_fluid_task)(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_for(mps_fluid *fluid, int64_t items, int64_t chunk, mpsi_fluid_task task);
/* Runs task(data, unit, worker) for this rank's units of `size` particles on the executor. */
void mpsi_fluid_units(mps_fluid *fluid, int64_t size, void (*task)(void *, int64_t, int32_t),
                      void *data);
/* The same of all, on every rank. */
void mpsi_fluid_for_all(mps_fluid *fluid, int64_t items, int64_t chunk, mpsi_fluid_task task);
/* Kinetic energy, and with that of gravity, J */
double mpsi_fluid_energy(const mps_fluid *fluid, double *kinetic);
/* MPS_ERROR_STATE within a callback of the run (free), while a step is open (closed), or
 * both (ready). */
mps_status mpsi_fluid_free(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_closed(void *fluid, const char *function);
mps_status mpsi_fluid_ready(mps_fluid *fluid, const char *function);
/* Checks `dt` (s; NaN: chosen by the library). */
mps_status mpsi_fluid_check_dt(void *fluid, const char *function, double dt);
