/* loads.h - forces on particles besides gravity.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "solver/conditions.h"

#include <mps/mpm.h>

/* A load of the kept definition: force area * traction on each particle. */
typedef struct mpsi_traction {
  const mps_mpm_load_def *def;
  double now[3];    /* value of the signals at the beginning of the step being made; 1 without */
  double former[3]; /* in the step before */
} mpsi_traction;

typedef struct mpsi_loads {
  const mpsi_conditions *list;
  double *body_acceleration[3]; /* m/s2; NULL where the set has no such field */
  double *external_force[3];    /* N; likewise */
} mpsi_loads;

/* The load of a number below list->capacity; NULL where it is free. */
static inline mpsi_traction *mpsi_load_of(const mpsi_loads *loads, int32_t number) {
  return loads->list->own[number];
}

/* loads.c: for life/conditions.c: rules that the table of the definition does not have
 * (`partition` NULL: one rank), and memory for forces. */
mps_status mpsi_mpm_check_load(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_partition *partition, const char *function,
                               const mps_mpm_load_def *def);
mps_status mpsi_mpm_make_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                mpsi_rooms *rooms, const char *function);
/* loads.c: sums force fields and loads of the step in the columns f. */
mps_status mpsi_mpm_find_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                mpsi_rooms *rooms, mpsi_loads *loads, const char *function);
