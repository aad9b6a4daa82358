/* loads.h - forces on particles and pressures on the surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_LOADS_H
#define MPSI_FLUID_LOADS_H

#include <mps/fluid.h>

/* A load of the caller, loads.c. */
typedef struct mpsi_fluid_given {
  int32_t kind;
  int64_t count; /* of ids, 0: no list */
  int64_t *ids;  /* ascending */
  double lower[2], upper[2];
  double amount[2]; /* m/s2, or Pa, or 1/s */
  int32_t side;
  double factor[2], now[2];
  mps_signal *signal[2];
} mpsi_fluid_given;

void mpsi_fluid_drop_loads(mps_fluid *fluid);
/* push and over as of time t, of the particles in their present order. */
mps_status mpsi_fluid_find_loads(mps_fluid *fluid, const char *function, double t);
double mpsi_fluid_work_of_loads(const mps_fluid *fluid); /* J, of the step being made */

#endif
