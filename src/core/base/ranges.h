/* ranges.h - sane ranges of physical quantities, in one table: wide enough for every ground, fluid
 * and laboratory, and narrow enough that no product or quotient of a formula leaves a double.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/definition/ends.h"
#include "core/internal.h"

/* X(name, unit, lowest, highest) */
#define MPSI_RANGE_TABLE(X)                                                                        \
  X(SPACING, " m", MPSI_SPACINGS) /* of particles, radii of influence */                           \
  X(LENGTH, " m", MPSI_LENGTHS)                                                                    \
  X(MODULUS, " Pa", MPSI_MODULI)                                                                   \
  X(STRESS, " Pa", MPSI_STRESSES)                                                                  \
  X(POISSON, "", MPSI_POISSONS)                                                                    \
  X(DENSITY, " kg/m3", MPSI_DENSITIES)                                                             \
  X(WAVE_VELOCITY, " m/s", MPSI_WAVE_VELOCITIES)                                                   \
  X(VISCOSITY, " Pa s", MPSI_VISCOSITIES)                                                          \
  X(ACCELERATION, " m/s2", MPSI_ACCELERATIONS)                                                     \
  X(STRESS_RATIO, "", MPSI_STRESS_RATIOS)                                                          \
  X(LEVEL, " m", MPSI_HEIGHTS)                                                                      \
  X(PLACE, " m", MPSI_PLACES)

typedef enum mpsi_range {
#define MPSI_RANGE_ENTRY(name, unit, ...) MPSI_RANGE_##name,
  MPSI_RANGE_TABLE(MPSI_RANGE_ENTRY)
#undef MPSI_RANGE_ENTRY
} mpsi_range;

bool mpsi_in_range(mpsi_range range, double value);
/* MPS_ERROR_ARGUMENT "<name> is <value> <unit>, must be <low> to <high>" for a value outside. */
mps_status mpsi_check_range(mps_context *context, const char *function, const char *name,
                            double value, mpsi_range range);
