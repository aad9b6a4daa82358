/* loads.h - nodal forces of the loads.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/conditions.h"

#include <mps/elastic.h>

#include <stdbool.h>

/* Force and first moment int t_c (x - x_i)_b of a load on one cell, which may have been removed. */
typedef struct mpsi_patch {
  int64_t id;
  double force[3], moment[3][3];
} mpsi_patch;

/* A load of the kept definition. */
typedef struct mpsi_elastic_load {
  const mps_elastic_load_def *def;
  double scale[3];     /* factor times the signal's value, at the requested time */
  mpsi_patch *patches; /* one for each id of the definition; none: the whole body */
} mpsi_elastic_load;

/* With a load by mass: reads `density` again, as mpsi_elastic_read_mass. */
mps_status mpsi_elastic_weigh(mps_elastic *e, const char *function, double **former);
/* The nodal forces of all loads and of `external_force` at time t, to e->load. */
mps_status mpsi_elastic_gather_loads(mps_elastic *e, const char *function, double t);
/* MPS_ERROR_ARGUMENT unless the point of moments (NULL: the origin) is finite. */
mps_status mpsi_elastic_check_about(const mps_elastic *e, const char *function,
                                    const double *about);
/* Resultant of nodal forces. */
void mpsi_elastic_resultant(const mps_elastic *e, const double *f, const double *about,
                            double *force, double *moment);

extern const mpsi_condition_kind mpsi_elastic_loads;
