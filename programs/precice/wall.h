/* wall.h - a wall of an incompressible fluid (mps/fluid.h) as a participant of a preCICE coupling:
 * displacements come from the other code, forces of the water on the wall go to it. The motion
 * along the wall's normal is used. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "loop.h"

#include <mps/fluid.h>

typedef struct wall_def {
  const char *config, *name, *mesh;
  const char *displacement; /* name of the data read: m from the position at the start */
  const char *velocity;     /* m/s, read too; NULL: the mean over the step, as of a driven wall */
  const char *force;        /* name of the data written: N on each vertex */
  int32_t number;           /* of the wall, added without a signal */
  int bends;     /* 0: the wall stays plane, and moves by the mean of its vertices; 1: the vertices
                    are its `nodes` (mps_fluid_boundary_def), in their order */
  int64_t count; /* vertices */
  const double *x;  /* m, 3 a vertex, on the wall */
  double normal[3]; /* unit, of the wall, into the fluid */
  double area;      /* m2 of the wall for each vertex, with the fluid's `measure` */
  double dt;        /* s: the largest step; mps_fluid_limit and preCICE may ask for shorter ones */
  bool (*each)(void *user, mps_fluid *fluid); /* after each completed time window; may be NULL */
  void *user;
} wall_def;

/* Couples the wall until preCICE ends it. The forces written are those of the pressures at the
 * middle of the last step, on the wall, along its normal. False, with an error line, on a failure.
 */
bool wall_run(app *a, mps_fluid *fluid, const wall_def *def, participant_result *result);
