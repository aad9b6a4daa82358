/* clearance.c - bodies keep at least re away from polylines: then no line of sight shorter than re
 * is reflected at both, and the images in each are all that there are.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/boundary/clearance.h"

#include "fluid/boundary/pose.h"

/* Square of the distance of x from the edge of a body from a to b. */
static double from_edge(const double *x, const double *a, const double *b) {
  const double e[2] = {b[0] - a[0], b[1] - a[1]}, d[2] = {x[0] - a[0], x[1] - a[1]};
  const double share = (d[0] * e[0] + d[1] * e[1]) / (e[0] * e[0] + e[1] * e[1]);
  const double at = fmin(fmax(share, 0.0), 1.0);
  const double way[2] = {d[0] - at * e[0], d[1] - at * e[1]};
  return way[0] * way[0] + way[1] * way[1];
}

static bool crosses(const mpsi_fluid_segment *s, const double *a, const double *b) {
  const double da = mpsi_fluid_before_segment(s, a), db = mpsi_fluid_before_segment(s, b);
  if ((da > 0.0) == (db > 0.0)) return false;
  const double share = da / (da - db);
  const double along =
      mpsi_fluid_along(&s->wall, a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]));
  return along >= s->wall.from && along <= s->wall.to;
}

/* Distance (m) of a body's edges from a segment; 0 where they cross. */
static double gap(const mpsi_fluid_body *body, bool next, const mpsi_fluid_segment *s) {
  double least = INFINITY, a[2], b[2];
  for (int k = 0; k < body->faces; k++) {
    mpsi_fluid_corner(body, next, k, a);
    mpsi_fluid_corner(body, next, k + 1, b);
    if (crosses(s, a, b)) return 0.0;
    least = fmin(least, mpsi_fluid_from_segment(s, a));
    for (int c = 0; c < 2; c++)
      if (!s->infinite[c]) least = fmin(least, from_edge(s->end[c], a, b));
  }
  return sqrt(least);
}

/* The middle of a body's corners, and their largest distance from it, m. */
static double extent(const mpsi_fluid_body *body, bool next, double *middle) {
  double radius = 0.0, x[2];
  middle[0] = middle[1] = 0.0;
  for (int k = 0; k < body->faces; k++) {
    mpsi_fluid_corner(body, next, k, x);
    for (int c = 0; c < 2; c++) middle[c] += x[c] / body->faces;
  }
  for (int k = 0; k < body->faces; k++) {
    mpsi_fluid_corner(body, next, k, x);
    radius = fmax(radius, hypot(x[0] - middle[0], x[1] - middle[1]));
  }
  return radius;
}

/* The first segment that is closer than re to a body at the beginning of the step, or at its end
 * (next), and its distance (m); NULL: none. */
static const mpsi_fluid_segment *too_close(const mps_fluid *f, const mpsi_fluid_body *body,
                                           bool next, const mpsi_fluid_polyline *line,
                                           double *distance) {
  double middle[2];
  const double radius = extent(body, next, middle), far = radius + f->reach;
  for (int64_t k = 0; k < line->count; k++) {
    const mpsi_fluid_segment *s = &line->segment[k];
    if (fabs(mpsi_fluid_before_segment(s, middle)) > far ||
        mpsi_fluid_from_segment(s, middle) > far * far)
      continue;
    *distance = gap(body, next, s);
    if (*distance < f->reach) return s;
  }
  return NULL;
}

mps_status mpsi_fluid_check_clearance(mps_fluid *f, const char *function, bool next,
                                      int32_t number) {
  const mpsi_fluid_body *body = &f->body[number];
  for (int b = 0; b < f->boundaries; b++) {
    double distance;
    const mpsi_fluid_segment *s =
        f->wall[b].line ? too_close(f, body, next, f->wall[b].line, &distance) : NULL;
    if (s && next)
      return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                       "step %lld, t = %g s: body %d comes within %g m of segment %d of the "
                       "polyline of boundary %d, must stay re = %g m away; the step is not made",
                       (long long)f->steps, f->time, number, distance, s->number, b, f->reach);
    if (s)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "body is %g m from segment %d of the polyline of boundary %d, must be at "
                       "least re = %g m away",
                       distance, s->number, b, f->reach);
  }
  return MPS_OK;
}

mps_status mpsi_fluid_check_bodies(mps_fluid *f, const char *function,
                                   const mpsi_fluid_polyline *line) {
  for (int b = 0; b < f->bodies; b++) {
    double distance;
    const mpsi_fluid_segment *s =
        f->body[b].body ? too_close(f, &f->body[b], false, line, &distance) : NULL;
    if (s)
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "corners: segment %d of the polyline, from (%g, %g) m, is %g m from body "
                       "%d, must be at least re = %g m away",
                       s->number, s->end[0][0], s->end[0][1], distance, b, f->reach);
  }
  return MPS_OK;
}
