/* loads.h - forces on particles besides gravity.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_LOADS_H
#define MPSI_MPM_LOADS_H

#include "mpm/base/parts.h"

#include <mps/mpm.h>

/* A load: force area * traction on each particle. */
typedef struct mpsi_traction {
  int64_t count; /* 0: none */
  int64_t *id;
  double *area; /* NULL: by the spacing */
  double traction[3], factor[3];
  mps_signal *signal[3];
  double now[3]; /* value of the signals at the beginning of the step being made; 1 without */
} mpsi_traction;

typedef struct mpsi_loads {
  mpsi_traction *traction;
  int32_t count;
  double *body_acceleration[3]; /* m/s2; NULL where the set has no such field */
  double *external_force[3];    /* N; likewise */
} mpsi_loads;

/* What changing loads works on. */
struct mpsi_load_setup {
  mps_context *context;
  const mpsi_grid *grid;
  mpsi_columns *p;
  mpsi_rooms *rooms;
  mpsi_loads *loads;
  mpsi_partition *partition; /* NULL: one rank */
  const mpsi_run *run;
};

/* loads.c: mps_mpm_add_load and its like, for the public `function`. */
mps_status mpsi_mpm_add_load(const mpsi_load_setup *setup, const char *function,
                             const mps_mpm_load_def *user, int32_t *number);
mps_status mpsi_mpm_set_load(const mpsi_load_setup *setup, const char *function, int32_t number,
                             const mps_mpm_load_def *user);
mps_status mpsi_mpm_remove_load(const mpsi_load_setup *setup, const char *function, int32_t number);
/* loads.c: sums force fields and loads of the step in the columns f. */
mps_status mpsi_mpm_find_forces(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                mpsi_rooms *rooms, mpsi_loads *loads, const char *function);
void mpsi_mpm_drop_loads(mps_context *context, const mpsi_loads *loads);

#endif
