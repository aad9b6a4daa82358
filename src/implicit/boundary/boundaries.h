/* boundaries.h - prescribed displacements and rollers; reactions and works by boundary.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_BOUNDARIES_H
#define MPSI_ELASTIC_BOUNDARIES_H

#include <mps/elastic_solver.h>

#include <stdbool.h>

/* A boundary of the caller. */
typedef struct mpsi_elastic_boundary {
  bool used;
  int32_t kind;
  uint32_t dofs;
  double normal[3]; /* unit */
  int64_t count;
  int64_t *id;     /* count, also of removed particles */
  double *values;  /* count * 3, a roller's count; or NULL */
  int64_t present; /* of these, in the present body */
  mps_signal *signal[3];
  double factor[3];
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
void mpsi_elastic_drop_boundaries(mps_elastic *e);
/* Supports from the present boundaries. On an error the former ones stay. */
mps_status mpsi_elastic_make_supports(mps_elastic *e, const char *function);

#endif
