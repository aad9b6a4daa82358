/* body.h - what the solvers use of a rigid body besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_BODY_H
#define MPSI_BODY_H

#include "core/internal.h"

#include <mps/body.h>

typedef enum mpsi_shape { MPSI_POLYGON = 0, MPSI_DISC = 1, MPSI_HALF_PLANE = 2 } mpsi_shape;

#define MPSI_PART_NAME 48 /* bytes, with the terminating zero */

/* The nearest point of a surface. */
typedef struct mpsi_foot {
  double distance;  /* m, negative inside */
  double normal[2]; /* outward unit vector */
  double at[2];     /* m */
  int64_t edge;
} mpsi_foot;

/* A force on a part of the surface. */
typedef struct mpsi_load {
  double force[2], moment; /* N, N m about the reference point */
} mpsi_load;

typedef struct mpsi_pose {
  double x[2], cosine, sine; /* reference point (m), rotation */
  double v[2], spin;         /* m/s, rad/s */
} mpsi_pose;

struct mps_body {
  mps_context *context;
  int32_t references; /* one thread at a time: no atomics */
  mps_body_def def;
  mpsi_shape shape;
  double radius;    /* disc, m */
  double normal[2]; /* half plane, body's frame */
  int64_t edges;
  double *xy; /* polygon: anticlockwise corners, the first repeated at the end */
  bool reversed;
  int32_t *part_of; /* one an edge, in the caller's order */
  char (*names)[MPSI_PART_NAME];
  int32_t parts;
  mps_signal *signal[3];
  double factor[3];
  double load[3];
  double time;  /* s */
  double angle; /* rad */
  mpsi_pose pose;
  mps_reaction reaction[MPS_BODY_MAX_PARTS];
  void *user; /* the solver that moves it, or NULL */
};

/* Nearest surface point to x; x is finite. Reads only: any number of threads. */
mpsi_foot mpsi_body_foot(const mps_body *body, const double *x);

/* Velocity (m/s) of the body's material at x. */
static inline void mpsi_body_velocity(const mpsi_pose *pose, const double *x, double *v) {
  v[0] = pose->v[0] - pose->spin * (x[1] - pose->x[1]);
  v[1] = pose->v[1] + pose->spin * (x[0] - pose->x[0]);
}

/* Puts a new body where its definition says. */
void mpsi_body_begin(mps_body *body);

/* A solver takes the body: retained, and refused to others. False when another solver has it. */
bool mpsi_body_take(mps_body *body, void *user);
void mpsi_body_give(mps_body *body); /* back, and released; accepts NULL */

/* Writes the forces that act in the step of dt that begins, `count` contacts and load[] per part.
 */
void mpsi_body_react(mps_body *body, double dt, const mpsi_load *load, const int64_t *contacts);
/* Moves the body on by dt: see mps_body_advance. */
void mpsi_body_advance(mps_body *body, double dt);

#endif
