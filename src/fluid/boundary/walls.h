/* walls.h - positions and motions of all walls, and the images of particles in them (ghosts).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/conditions.h"

#include <mps/fluid.h>

#include <stdbool.h>

/* Evaluates the signals of walls for the end of a step of dt; not collective; on an error nothing
 * has changed. */
mps_status mpsi_fluid_look_ahead(mps_fluid *fluid, const char *function, double dt);
void mpsi_fluid_begin_walls(mps_fluid *fluid, double dt); /* next, from signals and callers */
void mpsi_fluid_end_walls(mps_fluid *fluid);              /* now = next */
void mpsi_fluid_add_impulses(mps_fluid *fluid);
/* Room for so many particles and ghosts; false: none. */
bool mpsi_fluid_grow_cloud(mps_fluid *fluid, int64_t particles, int64_t ghosts);
mps_status mpsi_fluid_make_ghosts(mps_fluid *fluid, const char *function);
void mpsi_fluid_move_ghosts(mps_fluid *fluid); /* their velocities */
void mpsi_fluid_press_ghosts(
    mps_fluid *fluid); /* their pressure offsets, by walls' new velocities */

extern const mpsi_condition_kind mpsi_fluid_boundaries; /* boundaries.c */
