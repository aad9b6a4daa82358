/* bodies.h - rigid bodies, whose faces are walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/body_internal.h"
#include "fluid/boundary/wall.h"

#include <mps/fluid.h>

#include <stdbool.h>

/* Pose and motion of a body. */
typedef struct mpsi_fluid_pose {
  double x[2], R[4], v[2], spin;
} mpsi_fluid_pose;

typedef struct mpsi_fluid_body {
  struct mps_body *body;  /* NULL: none */
  int first, faces;       /* walls */
  double low[2], high[2]; /* m: a box that has all its faces; infinite where one extends behind a
                             boundary */
  mpsi_fluid_pose pose, next;
  struct mps_contact *contact; /* the caller's handle of it */
  mpsi_body_source *source; /* a member of that: by parts, forces of the water and its points, and
                               impulses of collisions, to be applied in the next step */
  bool floats;              /* see afloat.c */
  bool leaves; /* its handle was destroyed in the open step: it leaves the water when that ends */
  double rate[3], mass[9]; /* accelerations (m/s2); masses with the added ones (kg), 0: unknown */
  double rate_before[3], mass_before[9]; /* before the step being made */
  double tried[3], missed[3];    /* accelerations of the last trial, and what was out of balance */
  bool warned, warned_of_ground; /* of its angle with a boundary, and where it goes through one */
  bool looked, warned_of_bodies; /* for others too near, and of one */
  bool warned_of_gap;            /* to a boundary */
} mpsi_fluid_body;

#define MPSI_FLUID_MOST_FACES 50000 /* of all bodies; numbers of walls have 16 bits */

void mpsi_fluid_place_bodies(mps_fluid *fluid); /* faces as of the pose */
/* Evaluates the signals of bodies that the fluid moves for the end of a step of dt. */
mps_status mpsi_fluid_look_ahead_of_bodies(mps_fluid *fluid, const char *function, double dt);
void mpsi_fluid_drive_bodies(mps_fluid *fluid, double dt); /* next of the faces */
void mpsi_fluid_load_body(const mps_fluid *fluid, mpsi_fluid_body *body, const double *about);
void mpsi_fluid_end_bodies(mps_fluid *fluid);
/* m: rotations count as displacements at this radius. */
double mpsi_fluid_body_length(const mpsi_fluid_body *body, const mps_fluid *fluid);
void mpsi_fluid_drop_body(mps_fluid *fluid, mpsi_fluid_body *body);
void mpsi_fluid_drop_leaving(mps_fluid *fluid); /* once no step is open */
/* Of the body that a contact is with; -1: none of this fluid's, or it has ended. */
int32_t mpsi_fluid_body_number(const mps_fluid *fluid, const mps_contact *contact);

#define MPSI_FLUID_FLUSH 0.1        /* l0: distance at which a corner stands on a boundary */
#define MPSI_FLUID_LEAST_ANGLE 15.0 /* degrees of fluid between a face and what it stands on */

/* Whether the beginning (0) or the end (1) of a face stands on boundary number b. */
bool mpsi_fluid_stands_on(const mps_fluid *fluid, const mpsi_fluid_wall *face, int end, int b);
/* Degrees of fluid between a face and boundary number b; 180 where it does not stand there. */
double mpsi_fluid_angle(const mps_fluid *fluid, const mpsi_fluid_wall *face, int b);
/* The face nearest to x, in the body's order, and the distance, negative inside. */
int mpsi_fluid_face_of(const mps_fluid *fluid, const mpsi_fluid_body *body, bool moved,
                       const double *x, double *distance);
/* Whether x is inside a body other than number `besides` - 1. */
bool mpsi_fluid_inside_body(const mps_fluid *fluid, int besides, const double *x);
