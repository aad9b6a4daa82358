/* particles.h - the set: insertion, removal, edits, outflow.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_PARTICLES_H
#define MPSI_FLUID_PARTICLES_H

#include <mps/fluid.h>

#include <stdbool.h>

void mpsi_fluid_remove_outflow(
    mps_fluid *fluid); /* removes particles beyond an open side, at the end of a step */

#define MPSI_FLUID_MOST_PARTICLES (INT32_MAX / 4)

bool mpsi_fluid_reserve(mps_fluid *fluid, int64_t count);
void mpsi_fluid_find_speed(mps_fluid *fluid);
mps_status mpsi_fluid_commit(void *fluid, const char *function, const char *field,
                             const double *former);
mps_status mpsi_fluid_insert(void *fluid, const char *function, int64_t first, int64_t count);
mps_status mpsi_fluid_remove(void *fluid, const char *function, int64_t count, const int64_t *ids);
void mpsi_fluid_renew(void *fluid);

#endif
