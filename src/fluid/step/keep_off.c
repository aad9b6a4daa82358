/* keep_off.c - no particle passes a polyline: one whose way in a step crosses a segment, or ends
 * closer than .1 l0, is put back to that distance, in an acute corner to the point that has it from
 * both segments, and loses its velocity into them.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "keep_off.h"
#include "fluid/step/move.h"
#include "fluid/boundary/vicinity.h"
#include "fluid/step/exchange.h"

enum { TIMES = 4 };

/* The segments at a corner of less than 180 degrees that are both closer than `off`: the point that
 * has the distance from both. */
static bool into_corner(const mpsi_fluid_segment *s, const mpsi_fluid_segment *other, double off,
                        const double *corner, double *x) {
  const double *n = s->wall.normal, *m = other->wall.normal;
  const double d = mpsi_fluid_before_segment(s, x), e = mpsi_fluid_before_segment(other, x);
  const double back[2] = {x[0] + (off - d) * n[0], x[1] + (off - d) * n[1]};
  if (mpsi_fluid_before_segment(other, back) >= off) return false;
  const double fore[2] = {x[0] + (off - e) * m[0], x[1] + (off - e) * m[1]};
  if (e < off && mpsi_fluid_before_segment(s, fore) >= off) {
    x[0] = fore[0], x[1] = fore[1];
    return true;
  }
  const double size = off / (1.0 + n[0] * m[0] + n[1] * m[1]);
  for (int c = 0; c < 2; c++) x[c] = corner[c] + size * (n[c] + m[c]);
  return true;
}

/* The neighbours of a segment in its polyline, NULL: none. */
static const mpsi_fluid_segment *neighbour(const mpsi_fluid_polyline *line,
                                           const mpsi_fluid_segment *s, int end) {
  if (s->infinite[end]) return NULL;
  return &line->segment[(s->number + (end ? 1 : -1) + line->count) % line->count];
}

/* Takes x back to `off` from segment s and, at a concave corner, from its neighbour. */
static void put_back(const mps_fluid *f, const mpsi_fluid_segment *s, double off, double *x) {
  const mpsi_fluid_polyline *line = f->wall[s->boundary].line;
  for (int end = 0; end < 2; end++) {
    const mpsi_fluid_segment *other = neighbour(line, s, end);
    if (other && s->angle[end] < 3.14159 && into_corner(s, other, off, s->end[end], x)) return;
  }
  const double d = mpsi_fluid_before_segment(s, x);
  for (int c = 0; c < 2; c++) x[c] += (off - d) * s->wall.normal[c];
}

/* Takes the velocity into a segment out of u, and gives it to the boundary. */
static void stop(const mps_fluid *f, const mpsi_fluid_segment *s, int64_t i, double *u) {
  const double *n = s->wall.normal, into = u[0] * n[0] + u[1] * n[1];
  if (!(into < 0.0)) return;
  const double dv[2] = {-into * n[0], -into * n[1]};
  for (int c = 0; c < 2; c++) u[c] += dv[c];
  mpsi_fluid_exchange_wall(f, i / MPSI_FLUID_CHUNK, s->boundary, i, dv);
}

/* The nearest segment of the first polyline that is closer to x than `off`, or in front of x. The
 * list has all segments within `reach`. */
static const mpsi_fluid_segment *too_near(const mps_fluid *f, const mpsi_fluid_listed *list,
                                          double reach, double off, const double *x) {
  for (int64_t n = 0; n < list->count;) {
    const mpsi_fluid_segment *nearest = NULL;
    const double d = mpsi_fluid_before_listed(f, list, &n, x, &nearest);
    if (d < off && d > -reach) return nearest;
  }
  return NULL;
}

bool mpsi_fluid_keep_off_lines(const mps_fluid *f, int64_t i, double *x, double *u) {
  const double from[2] = {f->x[0][i], f->x[1][i]}, off = MPSI_FLUID_OFF_WALL * f->l0;
  const double way = hypot(x[0] - from[0], x[1] - from[1]);
  const double left = mpsi_fluid_listed_reach(f) - way;
  const bool far = !(left > 2.0 * off); /* in a step that fails, or by a caller's dt */
  const mpsi_fluid_listed list =
      far ? mpsi_fluid_all_segments(f) : mpsi_fluid_near_chunk(f, i / MPSI_FLUID_CHUNK);
  const double reach = far ? (double)INFINITY : left;
  double share = 0.0;
  bool moved = false;
  for (int k = 0; k < TIMES; k++) {
    const mpsi_fluid_segment *s = mpsi_fluid_crossed(f, &list, NULL, from, x, &share);
    if (!s) s = too_near(f, &list, reach, off * (1.0 - 1e-9), x);
    if (!s) return moved;
    put_back(f, s, off, x);
    stop(f, s, i, u);
    moved = true;
  }
  /* among several segments at once: it stays where it was */
  for (int c = 0; c < 2; c++) x[c] = from[c];
  const mpsi_fluid_segment *s = too_near(f, &list, reach, 2.0 * off, x);
  if (s) stop(f, s, i, u);
  return true;
}
