/* loads.h - forces on particles and pressures on the surface.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/conditions.h"

#include <mps/fluid.h>

/* A load of the kept definition, whose ids are ascending. */
typedef struct mpsi_fluid_given {
  const mps_fluid_load_def *def;
  double lower[2], upper[2]; /* of its box, infinite where there is no bound */
  double amount[2];          /* m/s2, or Pa, or 1/s */
  double now[2];             /* factor times signal */
} mpsi_fluid_given;

/* push and over as of time t, of the particles in their present order. */
mps_status mpsi_fluid_find_loads(mps_fluid *fluid, const char *function, double t);
/* m/s2: the largest acceleration that loads and the caller's forces give a particle now, that of
 * all loads together; without those that follow a caller's function, unless `call` it. */
double mpsi_fluid_pushed(const mps_fluid *fluid, bool call);
double mpsi_fluid_work_of_loads(const mps_fluid *fluid); /* J, of the step being made */

extern const mpsi_condition_kind mpsi_fluid_loads;
