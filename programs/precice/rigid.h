/* rigid.h - a rigid body in the soil of WLS-MPM (mps/mpm.h), in 2D, as a participant of a preCICE
 * coupling: displacements of its vertices come from the other code, which has its mass, and the
 * forces of the soil on it go there. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "loop.h"

#include <mps/mpm.h>

typedef struct rigid_def {
  const char *config, *name, *mesh;
  const char *displacement; /* name of the data read: m from the position at the start */
  const char *force;        /* name of the data written: N on each vertex */
  int64_t count;            /* vertices; of 1 the body does not turn, and its moment is not given */
  const double *x;          /* m, 2 a vertex, fixed to the body, in its position at the start */
  double dt; /* s: the largest step, of one or more steps of the soil; preCICE may ask for less */
  bool (*each)(void *user, mps_mpm *mpm); /* after each completed time window; may be NULL */
  void *user;
} rigid_def;

/* Couples `body`, a driven one in contact with the soil of `mpm`, until preCICE ends it. Its motion
 * is the rigid one nearest to the displacements (least squares), which must be rigid to a twentieth
 * of the vertices' extent, at constant velocity and spin in a step. The forces are means over the
 * step. Their sum and moment are those on the body; among forces with these they have the least
 * squares. False, with an error line, on a failure. */
bool rigid_run(app *a, mps_mpm *mpm, mps_body *body, const rigid_def *def,
               participant_result *result);
