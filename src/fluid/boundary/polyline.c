/* polyline.c - boundaries of straight segments with concave and convex corners of 15 to 345 degrees
 * of fluid: how they are made and checked, and the distance from them. An open polyline continues
 * beyond both ends without limit, so that each divides the plane into fluid and solid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/boundary/vicinity.h"

#include <string.h>

#define LEAST_ANGLE 15.0 /* degrees of fluid at a corner, and of solid */
#define PI 3.141592653589793

static double cross(const double *a, const double *b) { return a[0] * b[1] - a[1] * b[0]; }

/* ---- distances ------------------------------------------------------------------------------- */

/* Square of the distance of x; *at: -1, 1 or 0 where the nearest point is the start, the end or
 * between them. */
static double nearest_point(const mpsi_fluid_segment *s, const double *x, int *at) {
  const double *n = s->wall.normal, *from = s->end[0];
  const double to[2] = {x[0] - from[0], x[1] - from[1]};
  const double along = to[0] * n[1] - to[1] * n[0], across = to[0] * n[0] + to[1] * n[1];
  *at = along < 0.0 && !s->infinite[0] ? -1 : along > s->wall.length && !s->infinite[1] ? 1 : 0;
  const double beyond = *at < 0 ? along : *at > 0 ? along - s->wall.length : 0.0;
  return across * across + beyond * beyond;
}

double mpsi_fluid_from_segment(const mpsi_fluid_segment *s, const double *x) {
  int at;
  return nearest_point(s, x, &at);
}

/* Distance of x from a polyline whose nearest segment is s, with the nearest point as by
 * nearest_point, and the square of the distance to it: negative behind it. */
static double signed_distance(const mpsi_fluid_polyline *line, const mpsi_fluid_segment *s,
                              const double *x, int where, double square) {
  double side = mpsi_fluid_before_segment(s, x);
  if (where != 0) { /* by the mean normal of the corner */
    const int64_t k = s->number + where;
    const mpsi_fluid_segment *other = &line->segment[(k + line->count) % line->count];
    side += mpsi_fluid_before_segment(other, x);
  }
  return side < 0.0 ? -sqrt(square) : sqrt(square);
}

double mpsi_fluid_before_line(const mpsi_fluid_polyline *line, const double *x,
                              const mpsi_fluid_segment **nearest) {
  double least = INFINITY;
  const mpsi_fluid_segment *found = NULL;
  int where = 0;
  for (int64_t k = 0; k < line->count; k++) {
    int at;
    const double square = nearest_point(&line->segment[k], x, &at);
    if (!found || square < least) /* of a point too far for its square, the first */
      least = square, found = &line->segment[k], where = at;
  }
  if (nearest) *nearest = found;
  return signed_distance(line, found, x, where, least);
}

double mpsi_fluid_before_listed(const mps_fluid *f, const mpsi_fluid_listed *list, int64_t *next,
                                const double *x, const mpsi_fluid_segment **nearest) {
  double least = INFINITY;
  const mpsi_fluid_segment *found = NULL;
  int where = 0;
  const int32_t number = mpsi_fluid_segment_of(f, list->item[*next])->boundary;
  for (; *next < list->count; ++*next) {
    const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, list->item[*next]);
    int at;
    if (s->boundary != number) break;
    const double square = nearest_point(s, x, &at);
    if (!found || square < least) least = square, found = s, where = at;
  }
  *nearest = found;
  return signed_distance(f->wall[number].line, found, x, where, least);
}

double mpsi_fluid_before_lines(const mps_fluid *f, const double *x) {
  double least = INFINITY;
  for (int b = 0; b < f->boundaries; b++)
    if (f->wall[b].line) least = fmin(least, mpsi_fluid_before_line(f->wall[b].line, x, NULL));
  return least;
}

/* ---- checks ---------------------------------------------------------------------------------- */

mps_status mpsi_fluid_check_corners(mps_fluid *f, const char *function, int64_t corners,
                                    const double *xy) {
  for (int64_t k = 0; k < 3 * corners; k++)
    if (!(fabs(xy[k]) <= 1e12) || (k % 3 == 2 && xy[k] != 0.0))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "corners: that of number %lld of the polyline has the coordinate %g m: must "
                       "be within 1e12 m, "
                       "z 0",
                       (long long)(k / 3), xy[k]);
  for (int64_t k = 0; k + 1 < corners; k++) {
    const double length = hypot(xy[3 * k + 3] - xy[3 * k], xy[3 * k + 4] - xy[3 * k + 1]);
    if (!(length >= f->l0 * (1.0 - 1e-9)))
      return mpsi_fail(
          f->context, function, MPS_ERROR_ARGUMENT,
          "corners: segment %lld of the polyline, from (%g, %g) m, is %g m long, must be at "
          "least l0 = %g m",
          (long long)k, xy[3 * k], xy[3 * k + 1], length, f->l0);
  }
  return MPS_OK;
}

static mps_status check_angles(mps_fluid *f, const char *function,
                               const mpsi_fluid_polyline *line) {
  for (int64_t k = 0; k < line->count; k++) {
    const mpsi_fluid_segment *s = &line->segment[k];
    const double angle = s->angle[1] * 180.0 / PI;
    if (angle < LEAST_ANGLE - 1e-6 || angle > 360.0 - LEAST_ANGLE + 1e-6)
      return mpsi_fail(
          f->context, function, MPS_ERROR_ARGUMENT,
          "corners: that of the polyline at (%g, %g) m has %g degrees of fluid, allowed are "
          "%g to %g; the fluid is to the left of the way along the corners",
          s->end[1][0], s->end[1][1], angle, LEAST_ANGLE, 360.0 - LEAST_ANGLE);
  }
  return MPS_OK;
}

/* Whether two segments that do not share a corner have a common point. */
static bool cross_each_other(const mpsi_fluid_segment *a, const mpsi_fluid_segment *b) {
  const double e[2] = {a->wall.normal[1], -a->wall.normal[0]};
  const double g[2] = {b->wall.normal[1], -b->wall.normal[0]};
  const double way[2] = {b->end[0][0] - a->end[0][0], b->end[0][1] - a->end[0][1]};
  const double det = cross(e, g);
  if (fabs(det) < 1e-12) return false;
  const double s = cross(way, g) / det, t = cross(way, e) / det;
  return (s >= 0.0 || a->infinite[0]) && (s <= a->wall.length || a->infinite[1]) &&
         (t >= 0.0 || b->infinite[0]) && (t <= b->wall.length || b->infinite[1]);
}

static mps_status check_crossings(mps_fluid *f, const char *function,
                                  const mpsi_fluid_polyline *line) {
  const int64_t n = line->count;
  for (int64_t k = 0; k < n; k++)
    for (int64_t m = k + 2; m < n; m++) {
      if (line->closed && k == 0 && m == n - 1) continue;
      if (cross_each_other(&line->segment[k], &line->segment[m]))
        return mpsi_fail(
            f->context, function, MPS_ERROR_ARGUMENT,
            "corners: segments %lld and %lld of the polyline cross each other; an open one "
            "continues beyond its first and last corner",
            (long long)k, (long long)m);
    }
  return MPS_OK;
}

/* Where the polyline passes through the plane it stands on it at a right angle, and corners are
 * farther than re from it: images in both are then those of a corner of 90 degrees. */
mps_status mpsi_fluid_check_meeting(mps_fluid *f, const char *function,
                                    const mpsi_fluid_wall *plane, int32_t number,
                                    const mpsi_fluid_polyline *line) {
  for (int64_t k = 0; k < line->count; k++) {
    const mpsi_fluid_segment *s = &line->segment[k];
    const double *n = plane->normal, turn = s->wall.normal[0] * n[0] + s->wall.normal[1] * n[1];
    double d[2];
    for (int c = 0; c < 2; c++)
      d[c] = mpsi_fluid_distance(plane, plane->now.s, s->end[c][0], s->end[c][1]);
    const double rise = (d[1] - d[0]) / s->wall.length; /* over the walk */
    const double before = s->infinite[0] && fabs(rise) > 1e-9 ? -rise * (double)INFINITY : d[0];
    const double beyond = s->infinite[1] && fabs(rise) > 1e-9 ? rise * (double)INFINITY : d[1];
    const bool passes = fmin(before, beyond) < 0.0 && fmax(before, beyond) > 0.0;
    if (passes && fabs(turn) > 1e-6)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "corners, point and normal: segment %lld of the polyline, from (%g, %g) m, "
                       "passes boundary %d at %g "
                       "degrees: must be 90, or one polyline of both",
                       (long long)k, s->end[0][0], s->end[0][1], number,
                       90.0 - asin(fmin(fabs(turn), 1.0)) * 180.0 / PI);
    if (mpsi_fluid_turns(s) && fabs(d[1]) < f->reach)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "corners, point and normal: the polyline's corner at (%g, %g) m is %g m "
                       "from boundary %d: must be at "
                       "least re = %g m",
                       s->end[1][0], s->end[1][1], fabs(d[1]), number, f->reach);
  }
  return MPS_OK;
}

static mps_status check_particles(mps_fluid *f, const char *function,
                                  const mpsi_fluid_polyline *line) {
  enum { LEAST = 3 }; /* tenths of l0 */
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  for (int64_t i = 0; i < f->count; i++) {
    const double at[2] = {x[i], y[i]}, d = mpsi_fluid_before_line(line, at, NULL);
    if (d < 0.1 * LEAST * f->l0)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "corners: particle %lld at (%g, %g) m is %g m inside the polyline, must be "
                       "at least 0.%d l0 = %g m; the fluid is to the left of the way along the "
                       "corners",
                       (long long)mpsi_particles_integers(f->particles, "id")[i], x[i], y[i], d,
                       LEAST, 0.1 * LEAST * f->l0);
  }
  return MPS_OK;
}

/* ---- making ---------------------------------------------------------------------------------- */

static void place_segment(mpsi_fluid_segment *s, const double *from, const double *to) {
  const double d[2] = {to[0] - from[0], to[1] - from[1]}, length = hypot(d[0], d[1]);
  mpsi_fluid_wall *w = &s->wall;
  for (int c = 0; c < 2; c++) s->end[0][c] = from[c], w->at[c] = s->end[1][c] = to[c];
  w->normal[0] = -d[1] / length, w->normal[1] = d[0] / length;
  w->length = length;
  w->from = s->infinite[1] ? -INFINITY : 0.0;
  w->to = s->infinite[0] ? (double)INFINITY : length;
}

static void find_angles(mpsi_fluid_polyline *line) {
  for (int64_t k = 0; k < line->count; k++)
    line->segment[k].angle[0] = line->segment[k].angle[1] = PI;
  for (int64_t k = 0; k + !line->closed < line->count; k++) {
    mpsi_fluid_segment *a = &line->segment[k], *b = &line->segment[(k + 1) % line->count];
    const double *n = a->wall.normal, *m = b->wall.normal;
    const double turn = atan2(cross(n, m), n[0] * m[0] + n[1] * m[1]);
    a->angle[1] = b->angle[0] = PI - turn;
  }
}

static mps_status make_segments(mps_fluid *f, const char *function, int32_t number,
                                const double *xy, const mpsi_fluid_wall *wall,
                                mpsi_fluid_polyline *line) {
  for (int64_t k = 0; k < line->count; k++) {
    mpsi_fluid_segment *s = &line->segment[k];
    *s = (mpsi_fluid_segment){.boundary = number, .number = (int32_t)k};
    s->wall = (mpsi_fluid_wall){
        .kind = wall->kind, .of_line = number + 1, .factor = 1.0, .friction = wall->friction};
    s->infinite[0] = !line->closed && k == 0;
    s->infinite[1] = !line->closed && k + 1 == line->count;
    place_segment(s, xy + 3 * k, xy + 3 * k + 3);
    MPSI_TRY(mpsi_fluid_make_motion(f, function, &s->wall, 0, NULL));
  }
  find_angles(line);
  return MPS_OK;
}

mps_status mpsi_fluid_make_polyline(mps_fluid *f, const char *function, int32_t number,
                                    int64_t corners, const double *xy, mpsi_fluid_wall *wall) {
  const size_t size =
      sizeof(mpsi_fluid_polyline) + (size_t)(corners - 1) * sizeof(mpsi_fluid_segment);
  mpsi_fluid_polyline *line = mpsi_alloc(f->context, 1, size);
  if (!line) return mpsi_fail_memory(f->context, function, size);
  memset(line, 0, size);
  line->count = corners - 1;
  line->closed = corners > 3 && xy[0] == xy[3 * corners - 3] && xy[1] == xy[3 * corners - 2];
  wall->line = line; /* dropped with the wall */
  mps_status status = make_segments(f, function, number, xy, wall, line);
  for (int c = 0; c < 2; c++)
    wall->at[c] = xy[c], wall->normal[c] = line->segment[0].wall.normal[c];
  if (status == MPS_OK) status = check_angles(f, function, line);
  if (status == MPS_OK) status = check_crossings(f, function, line);
  for (int b = 0; b < f->boundaries && status == MPS_OK; b++)
    if (b != number && f->wall[b].used)
      status = mpsi_fluid_check_meeting(f, function, &f->wall[b], b, line);
  return status == MPS_OK ? check_particles(f, function, line) : status;
}
