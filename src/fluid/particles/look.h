/* look.h - copies of the particles, their order and neighbours, as a step and a reading begin with.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* Copies of positions, velocities and the last reduced pressure; their surroundings; and
 * both with the loads. */
void mpsi_fluid_load_cloud(mps_fluid *fluid);
mps_status mpsi_fluid_look_around(mps_fluid *fluid, const char *function, mps_status status);
mps_status mpsi_fluid_look(mps_fluid *fluid, const char *function);
/* Data of readings between steps, which follow from the state alone: the fields of the
 * surface (know); and with them the cloud, its loads and walls (refresh). After the latter
 * mpsi_fluid_show_surface writes the fields if the whole reading has succeeded, and otherwise
 * changes nothing; it returns `status`. */
mps_status mpsi_fluid_ensure_surface(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_refresh(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_show_surface(mps_fluid *fluid, mps_status status);
/* Sorts the particles by position. */
mps_status mpsi_fluid_sort(mps_fluid *fluid, const char *function);
