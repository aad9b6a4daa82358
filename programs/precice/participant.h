/* participant.h - an elastic body as a participant of a preCICE coupling: vertices are the centres
 * of facets, forces or stresses come from the other code, displacements and velocities go to it. A
 * time window that the coupling repeats is undone by snapshot and rollback.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "loop.h"

#include <mps/elastic.h>

typedef struct participant_def {
  const char *config; /* preCICE's configuration file */
  const char *name, *mesh;
  const char *force;        /* name of the data read: N on each facet; NULL: `stress` */
  const char *stress;       /* Pa; NULL: `force` */
  const char *displacement; /* names of the data written: m; NULL: not written */
  const char *velocity;     /* m/s; NULL: not written */
  double dt;                /* s: the largest step; preCICE may ask for shorter ones */
  /* After each completed time window; may be NULL. False ends the coupling. */
  bool (*each)(void *user, mps_elastic *solver);
  void *user;
} participant_def;

/* Couples the motion of `solver`, which has been started, by the `count` facets until preCICE ends
 * it. False, with an error line, on a failure. */
bool participant_run(app *a, mps_elastic *solver, int64_t count, const int64_t *facets,
                     const participant_def *def, participant_result *result);
