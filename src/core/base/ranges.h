/* ranges.h - sane ranges of physical quantities, in one table: wide enough for every ground, fluid
 * and laboratory, and narrow enough that no product or quotient of a formula leaves a double.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_RANGES_H
#define MPSI_RANGES_H

#include "core/internal.h"

/* X(name, unit, lowest, highest) */
#define MPSI_RANGE_TABLE(X)                                                                        \
  X(SPACING, " m", 1e-12, 1e12) /* of particles, radii of influence */                             \
  X(LENGTH, " m", 1e-9, 1e9)                                                                       \
  X(MODULUS, " Pa", 1e-6, 1e18)                                                                    \
  X(STRESS, " Pa", 1e-9, 1e18)                                                                     \
  X(POISSON, "", -0.999, 0.49999)                                                                  \
  X(DENSITY, " kg/m3", 1e-9, 1e9)                                                                  \
  X(WAVE_VELOCITY, " m/s", 1e-6, 1e9)                                                              \
  X(VISCOSITY, " Pa s", 1e-12, 1e18)                                                               \
  X(ACCELERATION, " m/s2", 1e-9, 1e9)                                                              \
  X(STRESS_RATIO, "", 1e-9, 1e6)                                                                   \
  X(LEVEL, " m", -1e9, 1e9)                                                                        \
  X(PLACE, " m", -MPSI_FARTHEST, MPSI_FARTHEST)

typedef enum mpsi_range {
#define MPSI_RANGE_ENTRY(name, unit, low, high) MPSI_RANGE_##name,
  MPSI_RANGE_TABLE(MPSI_RANGE_ENTRY)
#undef MPSI_RANGE_ENTRY
} mpsi_range;

bool mpsi_in_range(mpsi_range range, double value);
/* MPS_ERROR_ARGUMENT "<name> is <value> <unit>, must be <low> to <high>" for a value outside. */
mps_status mpsi_check_range(mps_context *context, const char *function, const char *name,
                            double value, mpsi_range range);
/* The same, with 0 allowed too. */
mps_status mpsi_check_range_or_0(mps_context *context, const char *function, const char *name,
                                 double value, mpsi_range range);

#endif
