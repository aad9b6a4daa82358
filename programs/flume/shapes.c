/* shapes.c - the shapes of mps-flume: bed, structure and the bed behind as one polyline, a closed
 * body in the water, rock; which points are solid, and which cells water at rest fills.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SHALLOWEST 2.0 /* spacings of water before a piston */

/* ---- the ground ------------------------------------------------------------------------------ */

static void add_point(flume *m, double x, double y) {
  const double *before = m->grounds ? m->ground[m->grounds - 1] : NULL;
  if (before && hypot(x - before[0], y - before[1]) < 1e-9) return;
  m->ground[m->grounds][0] = x, m->ground[m->grounds][1] = y;
  m->grounds++;
}

/* The face of --wall from the toe over the crest to its rear edge. */
static void make_face(flume *m) {
  const flume_settings *s = &m->s;
  flume_shapes *p = &m->shape;
  const double high = s->depth + s->crest,
               lean = s->wall == FLUME_SLOPE ? s->cotangent * high : 0.0;
  const double simple[3][2] = {{0.0, 0.0}, {lean, high}, {lean + s->width, high}};
  if (s->wall == FLUME_CAISSON || s->wall == FLUME_SLOPE) {
    p->structure = 3;
    memcpy(p->structure_point, simple, sizeof simple);
  }
  for (int k = 0; k < p->structure && s->wall >= FLUME_CAISSON; k++)
    p->structure_point[k][0] += s->length;
}

/* Rock half a spacing below the middle of the body's base, from its heel to the front. */
static void find_bedding(flume *m) {
  double front = m->heel[0];
  for (int k = 0; k < m->shape.body; k++)
    if (fabs(m->shape.body_point[k][1] - m->heel[1]) < 1e-9)
      front = fmin(front, m->shape.body_point[k][0]);
  m->bedded = flume_has_body(m) &&
              flume_rock_at(m, 0.5 * (front + m->heel[0]), m->heel[1] - 0.5 * m->s.spacing) >= 0;
}

/* Behind its rear edge a structure stands upright, to the height 0 of the bed there. */
void flume_make_ground(flume *m) {
  flume_shapes *p = &m->shape;
  make_face(m);
  m->toe = m->outlet = m->s.length;
  m->grounds = 0;
  for (int k = 0; k < p->bed; k++) add_point(m, p->bed_point[k][0], p->bed_point[k][1]);
  if (p->bed == 0) add_point(m, 0.0, 0.0);
  if (flume_has_structure(m)) {
    m->toe = p->structure_point[0][0];
    add_point(m, m->toe, p->structure_point[0][1]);
    m->first = m->grounds - 1;
    for (int k = 1; k < p->structure; k++)
      add_point(m, p->structure_point[k][0], p->structure_point[k][1]);
    m->heel[0] = p->structure_point[p->structure - 1][0], m->heel[1] = 0.0;
    add_point(m, m->heel[0], 0.0);
    m->last = m->grounds - 1;
    if (flume_is_open(m)) m->outlet = m->heel[0] + fmax(0.3, 8.0 * m->s.spacing);
  }
  for (int k = 0; k < p->body; k++) {
    const double *at = p->body_point[k];
    m->toe = k == 0 && !flume_has_structure(m) ? at[0] : fmin(m->toe, at[0]);
    if (k == 0 || at[1] < m->heel[1] || (at[1] == m->heel[1] && at[0] > m->heel[0]))
      memcpy(m->heel, at, sizeof m->heel); /* the rear one of the lowest corners */
  }
  add_point(m, m->outlet, m->ground[m->grounds - 1][1]);
  find_bedding(m);
}

/* ---- points ---------------------------------------------------------------------------------- */

/* Whether the upward ray from a point crosses a segment. */
static bool crosses(const double *p, const double *q, double x, double y) {
  if ((p[0] > x) == (q[0] > x)) return false;
  return p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]) > y;
}

static bool in_polygon(int count, const double (*point)[2], double x, double y) {
  bool inside = false;
  for (int k = 0; k < count; k++)
    if (crosses(point[k], point[(k + 1) % count], x, y)) inside = !inside;
  return inside;
}

/* Below the ground an upward ray crosses it an odd number of times. */
bool flume_is_solid(const flume *m, double x, double y) {
  bool below = false;
  for (int k = 0; k + 1 < m->grounds; k++)
    if (crosses(m->ground[k], m->ground[k + 1], x, y)) below = !below;
  return below || in_polygon(m->shape.body, m->shape.body_point, x, y);
}

double flume_ground_at(const flume *m, double x) {
  double y = -INFINITY;
  for (int k = 0; k + 1 < m->grounds; k++) {
    const double *p = m->ground[k], *q = m->ground[k + 1];
    if (x < p[0] || x > q[0] || p[0] == q[0]) continue;
    y = fmax(y, p[1] + (q[1] - p[1]) * (x - p[0]) / (q[0] - p[0]));
  }
  return y;
}

double flume_end_depth(const flume *m) { return m->s.depth - m->ground[m->grounds - 1][1]; }

bool flume_end_is_wet(const flume *m) {
  return flume_end_depth(m) >= SHALLOWEST * m->s.spacing * (1.0 - 1e-9);
}

bool flume_in_rock(const flume_rock *r, double x, double y) {
  return in_polygon(r->corners, r->corner, x, y);
}

int flume_rock_at(const flume *m, double x, double y) {
  for (int k = 0; k < m->shape.rocks; k++)
    if (flume_in_rock(&m->shape.rock[k], x, y)) return k;
  return -1;
}

static double to_segment(const double *p, const double *q, const double *x, double *on) {
  const double e[2] = {q[0] - p[0], q[1] - p[1]};
  const double along = ((x[0] - p[0]) * e[0] + (x[1] - p[1]) * e[1]) / (e[0] * e[0] + e[1] * e[1]);
  const double s = fmin(fmax(along, 0.0), 1.0);
  on[0] = p[0] + s * e[0], on[1] = p[1] + s * e[1];
  return hypot(x[0] - on[0], x[1] - on[1]);
}

static double turn(const double *p, const double *q, const double *r) {
  return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

bool flume_cross(const double *p, const double *q, const double *r, const double *s) {
  return turn(p, q, r) * turn(p, q, s) < 0.0 && turn(r, s, p) * turn(r, s, q) < 0.0;
}

double flume_distance(const double *p, const double *q, const double *r, const double *s) {
  double on[2];
  if (flume_cross(p, q, r, s)) return 0.0;
  return fmin(fmin(to_segment(p, q, r, on), to_segment(p, q, s, on)),
              fmin(to_segment(r, s, p, on), to_segment(r, s, q, on)));
}

/* Keeps the nearer of two faces. */
static void compare(double distance, const double *at, int32_t number, double *least, double *on,
                    int32_t *wall) {
  if (distance >= *least) return;
  *least = distance;
  memcpy(on, at, 2 * sizeof *on);
  *wall = number;
}

static double nearest(const flume *m, const double *x, double *on, int32_t *wall) {
  const flume_shapes *p = &m->shape;
  double least = INFINITY, at[2];
  for (int k = 0; k + 1 < m->grounds; k++)
    compare(to_segment(m->ground[k], m->ground[k + 1], x, at), at, FLUME_BED, &least, on, wall);
  for (int k = 0; k < p->body; k++)
    compare(to_segment(p->body_point[k], p->body_point[(k + 1) % p->body], x, at), at, FLUME_BODY,
            &least, on, wall);
  return least;
}

double flume_face_distance(const flume *m, const double *x) {
  double on[2];
  int32_t wall;
  return nearest(m, x, on, &wall);
}

double flume_nearest_face(const flume *m, const double *x, double *on, int32_t *wall) {
  double least = nearest(m, x, on, wall);
  const double end[2] = {m->outlet, x[1]};
  if (!flume_is_open(m)) compare(fabs(x[0] - m->outlet), end, FLUME_END, &least, on, wall);
  return least;
}

/* ---- water at rest --------------------------------------------------------------------------- */

static bool may_be_wet(const flume *m, int64_t i, int64_t j) {
  const flume_cells *c = &m->cells;
  const double x = ((double)i + 0.5) * c->pitch, y = c->lower + ((double)j + 0.5) * c->pitch;
  return y < m->s.depth && !flume_is_solid(m, x, y);
}

/* From the foot of the maker to all cells that water reaches below its level. False without memory.
 */
bool flume_fill_cells(flume *m) {
  flume_cells *c = &m->cells;
  int64_t *stack, used = 0;
  c->pitch = 0.5 * m->s.spacing, c->lower = 0.0;
  for (int k = 0; k < m->grounds; k++) c->lower = fmin(c->lower, m->ground[k][1]);
  c->columns = llround(m->outlet / c->pitch);
  c->rows = (int64_t)ceil((m->s.depth - c->lower) / c->pitch - 1e-6);
  const int64_t all = c->columns * c->rows;
  c->wet = calloc((size_t)all, 1);
  stack = malloc((size_t)all * sizeof *stack);
  if (c->wet && stack)
    for (int64_t j = 0; j < c->rows; j++) /* the column at the maker */
      if (may_be_wet(m, 0, j)) c->wet[j * c->columns] = 1, stack[used++] = j * c->columns;
  while (c->wet && stack && used > 0) {
    const int64_t at = stack[--used], i = at % c->columns, j = at / c->columns;
    const int64_t next[4][2] = {{i - 1, j}, {i + 1, j}, {i, j - 1}, {i, j + 1}};
    for (int k = 0; k < 4; k++) {
      const int64_t a = next[k][0], b = next[k][1], cell = b * c->columns + a;
      if (a < 0 || a >= c->columns || b < 0 || b >= c->rows || c->wet[cell]) continue;
      if (may_be_wet(m, a, b)) c->wet[cell] = 1, stack[used++] = cell;
    }
  }
  free(stack);
  return c->wet && stack;
}

bool flume_is_wet(const flume *m, double x, double y) {
  const flume_cells *c = &m->cells;
  const int64_t i = (int64_t)floor(x / c->pitch), j = (int64_t)floor((y - c->lower) / c->pitch);
  return i >= 0 && i < c->columns && j >= 0 && j < c->rows && c->wet[j * c->columns + i];
}
