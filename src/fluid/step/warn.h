/* warn.h - assumptions of the model: warnings, and errors of steps that break them.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* Warnings that are logged once per solver. */
typedef enum mpsi_fluid_warning {
  MPSI_FLUID_WARNED_GUARDS = 1, /* act often */
  MPSI_FLUID_WARNED_TRAVEL = 2, /* of a wall in a step */
  MPSI_FLUID_WARNED_SLOPE = 4,  /* of a bent wall */
  MPSI_FLUID_WARNED_AIR = 8     /* a pressure on the surface, none on a floating body's dry faces */
} mpsi_fluid_warning;

/* MPS_ERROR_DIVERGED for a step whose walls move or bend too far; warnings to the log. */
mps_status mpsi_fluid_check_walls(mps_fluid *fluid, const char *function);
void mpsi_fluid_warn_of_guards(mps_fluid *fluid);
void mpsi_fluid_warn_of_angles(mps_fluid *fluid);
void mpsi_fluid_warn_of_ground(mps_fluid *fluid);
void mpsi_fluid_warn_of_bodies(mps_fluid *fluid);
void mpsi_fluid_warn_of_air(mps_fluid *fluid);
