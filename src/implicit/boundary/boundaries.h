/* boundaries.h - prescribed displacements and rollers; reactions and works by boundary.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "solver/conditions.h"

#include <mps/elastic.h>

#include <stdbool.h>

/* A boundary of the caller, of the kept definition. */
typedef struct mpsi_elastic_boundary {
  const mps_elastic_boundary_def *def; /* ids: also of removed particles */
  uint32_t dofs;
  double normal[3];    /* of a roller, unit */
  int64_t present;     /* of the ids, in the present body */
  double motion[3][3]; /* factor * signal at the time driven to: [derivative][component] */
  mps_reaction reaction;
} mpsi_elastic_boundary;

/* Prescribed displacements, velocities and accelerations become those of time t. */
mps_status mpsi_elastic_drive(mps_elastic *e, const char *function, double t);
/* Resultants of e->reaction by boundary; dt > 0: adds the mean of former and new ones times dt to
 * the impulses. */
void mpsi_elastic_count_reactions(mps_elastic *e, double dt);
/* Adds the work of `force` (n * dim, of fixed directions) over the displacements `du` by boundary,
 * and the change of kinetic energy of driven particles from v0 to v1 (NULL: statics); returns the
 * sum. */
double mpsi_elastic_count_work(mps_elastic *e, const double *force, const double *du,
                               const double *v0, const double *v1);
void mpsi_elastic_forget_reactions(mps_elastic *e);
/* Supports from the present boundaries. On an error the former ones stay. */
mps_status mpsi_elastic_make_supports(mps_elastic *e, const char *function);

extern const mpsi_condition_kind mpsi_elastic_boundaries;
mps_status mpsi_elastic_get_reaction(void *elastic, const char *function, mps_status status,
                                     int32_t number, mps_reaction *out);
