/* wall.h - a wall: a boundary of the caller, the face of a body, or the segment of a polyline; its
 * place and motion.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

#include <stdbool.h>

/* How a wall moves along its normal, at its nodes: linear between them, constant beyond the ends.
 * A wall that stays plane has one node. */
typedef struct mpsi_fluid_motion {
  double *s, *u, *a; /* m, m/s, m/s2; a is the mean over the step that ends there */
} mpsi_fluid_motion;

/* Force, moment and power of a wall on the fluid. */
typedef struct mpsi_fluid_load {
  double force[2], moment, power; /* N; N m about the origin; W */
  int64_t wetted;                 /* points with water */
} mpsi_fluid_load;

/* Impulse, moment and work of a wall in a step besides the pressure, see exchange.c. */
typedef struct mpsi_fluid_struck {
  double impulse[2], moment, work; /* N s; N m s about the origin; J */
} mpsi_fluid_struck;

typedef struct mpsi_fluid_polyline mpsi_fluid_polyline; /* polyline.h */

/* A wall: a boundary of the caller, the face of a body, or the segment of a polyline. */
typedef struct mpsi_fluid_wall {
  bool used;                 /* as a wall */
  bool open;                 /* an open side instead */
  int32_t of_body;           /* 0: a boundary; number of the body + 1 */
  int32_t of_line;           /* of a segment of a polyline: number of the boundary + 1 */
  mpsi_fluid_polyline *line; /* of a boundary that is a polyline, and no plane wall; owned */
  double from, to, length;   /* of a face or segment, m along it: its end, or its extension behind a
                                boundary */
  double tip[2];             /* m, of a face: its end, where that is `length` */
  bool limited, stood_on;    /* it ends; a body stands on it: see sight.c */
  bool bent, sticky;         /* it has several nodes; no slip */
  bool given, placed;        /* next.u, and next.s, are prescribed by the caller */
  int32_t kind;
  double at[2], normal[2]; /* m, of the wall without displacement; unit, into the fluid */
  mps_signal *signal;
  double friction;       /* friction factor */
  double factor, origin; /* origin: the signal's displacement that counts as 0, m */
  double rate;           /* m/s: factor times the signal's velocity now */
  double ahead[2];       /* m, m/s: displacement and rate at the end of the step being made */
  int64_t nodes;
  double *node;                 /* m along the wall from `at`, ascending */
  int64_t *order;               /* order[k]: the caller's number of node k */
  mpsi_fluid_motion now, next;  /* at the beginning and at the end of the step being made */
  double *mean;                 /* m/s, over the step being made */
  double *motion;               /* the memory of all these */
  int64_t first_image, images;  /* ghosts: images of particles here alone, in their order */
  mpsi_fluid_load load, before; /* of the last step or solution; before the step being made */
  mpsi_fluid_load former;       /* of the solution before the one being made */
  mpsi_fluid_struck struck;     /* by collisions and smoothing, of the step being made */
  mpsi_fluid_struck sheared;     /* by friction, likewise; 0 until velocities are known */
  double impulse[2], moment_impulse, work;
  int64_t first_sum; /* of its values in a row of mpsi_fluid_exchange */
  int64_t first_shear; /* of those of friction, where it has some */
  int64_t removed;   /* particles through an open side */
  double removed_mass;
} mpsi_fluid_wall;

#define MPSI_FLUID_NO_WALL UINT16_MAX

/* The walls that an image is mirrored at, by ascending number, then MPSI_FLUID_NO_WALL. Those of
 * one image are at right angles: more than two there cannot be. */
typedef struct mpsi_fluid_flips {
  uint16_t wall[2];
} mpsi_fluid_flips;

/* for (k of the walls of `flips`) */
#define MPSI_FLUID_FLIPS(k, flips)                                                                 \
  for (int k = 0; k < 2 && (flips).wall[k] != MPSI_FLUID_NO_WALL; k++)

mps_status mpsi_fluid_make_motion(mps_fluid *fluid, const char *function, mpsi_fluid_wall *wall,
                                  int64_t nodes, const double *points);
void mpsi_fluid_drop_wall(mps_fluid *fluid, mpsi_fluid_wall *wall);
void mpsi_fluid_mirror_point(const mps_fluid *fluid, mpsi_fluid_flips flips,
                             double *x); /* at these walls */
double mpsi_fluid_between(const mpsi_fluid_wall *wall, const double *values, double along);
