/* holder.h - the fluid as a holder of its particle set (mpsi_holder): particles edited, added and
 * removed between steps, and those that have left through an open side.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

#define MPSI_FLUID_MOST_PARTICLES (INT32_MAX / 4)

/* Memory for `count` particles; false: refused. */
bool mpsi_fluid_reserve(mps_fluid *fluid, int64_t count);
/* Finds the largest speed (m/s), which limits the next step. */
void mpsi_fluid_find_speed(mps_fluid *fluid);
/* Finds the speed that rates of a fluid without gravity follow in this step. */
void mpsi_fluid_find_stir(mps_fluid *fluid);
/* Removes the particles beyond an open side, at the end of a step. */
void mpsi_fluid_remove_outflow(mps_fluid *fluid);

/* Callbacks of the set: see mpsi_holder. */
mps_status mpsi_fluid_commit(void *fluid, const char *function, const char *field,
                             const double *former);
mps_status mpsi_fluid_insert(void *fluid, const char *function, int64_t first, int64_t count);
mps_status mpsi_fluid_remove(void *fluid, const char *function, int64_t count, const int64_t *ids);
void mpsi_fluid_renew(void *fluid);
