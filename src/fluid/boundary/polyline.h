/* polyline.h - boundaries of several straight segments with corners between them; see polyline.c
 * for their geometry and mirrors.c for the images of particles in them.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/ranks/partition.h"

enum {
  MPSI_FLUID_REFLECTIONS = 16
}; /* of one line of sight, at most; a corner of 15 degrees: 12 */

/* A segment, from the walk's start to its end; the fluid is to its left. */
typedef struct mpsi_fluid_segment {
  mpsi_fluid_wall wall;     /* its place, normal, images and load; coordinates along it are from the
                               end, against the walk */
  double end[2][2];         /* m, start and end of the walk */
  double angle[2];          /* rad, of the fluid at these corners; pi where there is none */
  bool infinite[2];         /* continues beyond the end */
  int32_t boundary, number; /* of the boundary; of the segment in its polyline */
  int32_t all;              /* index in fluid->segment */
} mpsi_fluid_segment;

struct mpsi_fluid_polyline {
  int64_t count;
  bool closed;
  mpsi_fluid_segment segment[];
};

/* The mirrors that reflect the line of sight from a particle to an image, in this order; and their
 * product, by which vectors are mirrored. */
typedef struct mpsi_fluid_path {
  double M[4];
  int32_t count;
  int32_t segment[MPSI_FLUID_REFLECTIONS];
} mpsi_fluid_path;

/* Whether the polyline turns at a segment's last corner. */
static inline bool mpsi_fluid_turns(const mpsi_fluid_segment *s) {
  return fabs(s->angle[1] - 3.141592653589793) > 1e-9;
}

/* Distance along the normal, > 0 in the fluid. */
static inline double mpsi_fluid_before_segment(const mpsi_fluid_segment *s, const double *x) {
  const double *at = s->wall.at, *n = s->wall.normal;
  return (x[0] - at[0]) * n[0] + (x[1] - at[1]) * n[1];
}

/* Distance (m) of the foot of x on a segment from the nearer one of its ends around which the water
 * turns; infinite where it turns around neither. */
static inline double mpsi_fluid_past_turn(const mpsi_fluid_segment *s, const double *x) {
  const double along[2] = {-s->wall.normal[1], s->wall.normal[0]};
  double least = INFINITY;
  for (int e = 0; e < 2; e++) {
    const double d[2] = {x[0] - s->end[e][0], x[1] - s->end[e][1]};
    if (!s->infinite[e] && s->angle[e] > 3.141592653589793 + 1e-9)
      least = fmin(least, fabs(d[0] * along[0] + d[1] * along[1]));
  }
  return least;
}

/* Corners of a definition that are NULL, out of range or too near to each other. */
mps_status mpsi_fluid_check_corners(mps_fluid *fluid, const char *function, int64_t corners,
                                    const double *xy);
/* A polyline's own segments from its corners; of a boundary with this number. */
mps_status mpsi_fluid_make_polyline(mps_fluid *fluid, const char *function, int32_t number,
                                    int64_t corners, const double *xy, mpsi_fluid_wall *wall);
/* Whether a plane wall and a polyline join only at right angles, away from its corners. */
mps_status mpsi_fluid_check_meeting(mps_fluid *fluid, const char *function,
                                    const mpsi_fluid_wall *plane, int32_t number,
                                    const mpsi_fluid_polyline *line);
/* Distance (m) to the nearest point of a polyline, negative behind it; *nearest: that segment
 * (NULL: not asked for). */
double mpsi_fluid_before_line(const mpsi_fluid_polyline *line, const double *x,
                              const mpsi_fluid_segment **nearest);
/* The least of all polylines; infinite where there is none. */
double mpsi_fluid_before_lines(const mps_fluid *fluid, const double *x);
/* Square of the distance (m) of a segment from x. */
double mpsi_fluid_from_segment(const mpsi_fluid_segment *segment, const double *x);

/* vicinity.c: numbers all segments, where they are not yet; false: no memory. After a change of
 * boundaries they are to be forgotten. */
bool mpsi_fluid_list_segments(mps_fluid *fluid);
void mpsi_fluid_forget_segments(mps_fluid *fluid);
void mpsi_fluid_drop_lines(mps_fluid *fluid);
static inline mpsi_fluid_segment *mpsi_fluid_segment_of(const mps_fluid *f, int64_t k) {
  return ((mpsi_fluid_segment *const *)f->segment_room.item)[k];
}

/* mirrors.c: images of the cloud at all segments; false: no room for them. */
bool mpsi_fluid_mirror_lines(mps_fluid *fluid);
/* The neighbours of particle i that it sees past the polylines and in them. */
int64_t mpsi_fluid_keep_seen(const mps_fluid *fluid, int64_t i, int64_t count, int32_t *index,
                             double *r2);
/* Whether a segment, other than `except` (NULL: none), is between a and b, less than re apart; in
 * one thread. */
bool mpsi_fluid_behind_line(const mps_fluid *fluid, const mpsi_fluid_segment *except,
                            const double *a, const double *b);
/* Whether a point is behind a polyline by more than `least`, within re of it; in one thread. */
bool mpsi_fluid_in_solid(const mps_fluid *fluid, const double *x, double least);
/* Whether a corner around which the fluid turns by 30 degrees or more is within 1.5 l0. */
bool mpsi_fluid_near_turn(const mps_fluid *fluid, int64_t i);

/* The path of a ghost; NULL: it is no image in a polyline. */
static inline const mpsi_fluid_path *mpsi_fluid_path_of(const mps_fluid *f, int64_t ghost) {
  if (f->segments == 0) return NULL;
  const mpsi_fluid_path *path = (const mpsi_fluid_path *)f->path_room.item + ghost;
  return path->count > 0 ? path : NULL;
}
static inline void mpsi_fluid_reflect(const mpsi_fluid_path *path, double *v) {
  const double x = v[0], *M = path->M;
  v[0] = M[0] * x + M[1] * v[1], v[1] = M[2] * x + M[3] * v[1];
}
static inline void mpsi_fluid_reflect_back(const mpsi_fluid_path *path, double *v) {
  const double x = v[0], *M = path->M;
  v[0] = M[0] * x + M[2] * v[1], v[1] = M[1] * x + M[3] * v[1];
}
