/* sides.c - checks of the sides of shapes of mps-flume: their length, whether they cross, how near
 * a body is to the ground, and whether rock lies in the flume. The errors name the line of the
 * file. SPDX-License-Identifier: BSD-3-Clause */
#include "flume.h"

#include "common/options.h"
#include "common/units.h"

#include <math.h>
#include <stdio.h>

/* Spacings between ground and body: more than the radius of the weights. */
#define BEDDING (FLUME_ROCK_RADIUS + 0.1)

/* The line of the model file with a point of a shape; 0: it is of the options. */
static int line_of(const document *d, const double *at) {
  double x[2];
  if (!d || d->kind == DOCUMENT_TEXT) return 0;
  bool here = d->kind == DOCUMENT_LIST && d->count == 2;
  for (int c = 0; c < 2 && here; c++)
    here = d->child[c].kind == DOCUMENT_TEXT &&
           units_read(d->child[c].text, "m", &x[c]) == UNITS_GOOD && fabs(x[c] - at[c]) < 1e-12;
  if (here) return d->line;
  for (int k = 0; k < d->count; k++) {
    const int line = line_of(&d->child[k], at);
    if (line > 0) return line;
  }
  return 0;
}

int flume_refuse_at(const options_program *program, const flume *m, const char *key,
                    const double *at, const char *why) {
  char text[500], place[300] = "";
  const int line = m->text ? line_of(document_find(m->text, key), at) : 0;
  if (line > 0) snprintf(place, sizeof place, "%.200s, line %d: ", m->s.model, line);
  snprintf(text, sizeof text, "%s%s %g,%g %s", place, key, at[0], at[1], why);
  return options_refuse(program, text);
}

/* Sides of at least a spacing, as the library wants them. */
int flume_check_sides(const options_program *program, const flume *m, const char *what, int count,
                      bool closed, const double (*at)[2]) {
  for (int k = closed ? 0 : 1; k < count; k++) {
    const double *before = at[k ? k - 1 : count - 1];
    if (hypot(at[k][0] - before[0], at[k][1] - before[1]) < m->s.spacing * (1.0 - 1e-9))
      return flume_refuse_at(program, m, what, at[k],
                             "lies less than --spacing from the corner before it");
  }
  return -1;
}

/* ---- body ------------------------------------------------------------------------------------ */

/* The corner of the body at which it is nearer to bed and structure than allowed; -1: none. */
static int near_ground(const flume *m) {
  const flume_shapes *p = &m->shape;
  for (int k = 0; k < p->body; k++) {
    const double *a = p->body_point[k], *b = p->body_point[(k + 1) % p->body];
    if (a[1] < flume_ground_at(m, a[0])) return k;
    for (int j = 0; j + 1 < m->grounds; j++)
      if (flume_distance(a, b, m->ground[j], m->ground[j + 1]) <
          BEDDING * m->s.spacing * (1.0 - 1e-9))
        return a[1] < b[1] ? k : (k + 1) % p->body;
  }
  return -1;
}

static int check_weight(const options_program *program, const flume *m) {
  flume copy = *m; /* weight and arm are of the build */
  char text[200];
  const double weight = flume_is_caisson(m) ? flume_weight(&copy) : 1.0;
  if (weight > 0.0) return -1;
  snprintf(text, sizeof text,
           "--wall-density is too low: the caisson floats, its weight in still water would be "
           "%.4g N",
           weight);
  return flume_refuse(program, m, text);
}

int flume_check_body(const options_program *program, const flume *m) {
  const flume_shapes *p = &m->shape;
  if (!flume_has_body(m)) return check_weight(program, m);
  if (flume_is_open(m))
    return flume_refuse(program, m, "--end must be closed with a caisson: water is on both sides");
  for (int k = 0; k < p->body; k++) {
    const double *at = p->body_point[k];
    if (at[0] < 8.0 * m->s.spacing || at[0] > m->outlet - 8.0 * m->s.spacing)
      return flume_refuse_at(program, m, "caisson", at,
                             "must be 8 times --spacing from both ends of the flume");
  }
  const int near = near_ground(m);
  if (near >= 0)
    return flume_refuse_at(program, m, "caisson", p->body_point[near],
                           "must be 3.7 times --spacing above the bed, and as far from a "
                           "structure: one that stands on it is a structure");
  const int code = flume_check_sides(program, m, "caisson", p->body, true, p->body_point);
  return code < 0 ? check_weight(program, m) : code;
}

/* ---- rock ------------------------------------------------------------------------------------ */

static bool crosses_itself(const flume_rock *r) {
  for (int k = 0; k < r->corners; k++)
    for (int j = 0; j < k; j++)
      if (flume_cross(r->corner[k], r->corner[(k + 1) % r->corners], r->corner[j],
                      r->corner[(j + 1) % r->corners]))
        return true;
  return false;
}

/* Whether a point of a region of rock, of a grid of half a spacing, is in the flume and not solid.
 */
static bool is_in_flume(const flume *m, const flume_rock *r) {
  double lower[2] = {INFINITY, INFINITY}, upper[2] = {-INFINITY, -INFINITY};
  for (int k = 0; k < r->corners; k++)
    for (int c = 0; c < 2; c++) {
      lower[c] = fmin(lower[c], r->corner[k][c]);
      upper[c] = fmax(upper[c], r->corner[k][c]);
    }
  lower[0] = fmax(lower[0], 0.0), upper[0] = fmin(upper[0], m->outlet);
  lower[1] = fmax(lower[1], m->cells.lower), upper[1] = fmin(upper[1], 3.0 * m->s.depth);
  const double step = 0.5 * m->s.spacing;
  for (double y = lower[1] + 0.5 * step; y < upper[1]; y += step)
    for (double x = lower[0] + 0.5 * step; x < upper[0]; x += step)
      if (!flume_is_solid(m, x, y) && flume_in_rock(r, x, y)) return true;
  return false;
}

int flume_check_rock(const options_program *program, const flume *m) {
  for (int k = 0; k < m->shape.rocks; k++) {
    const flume_rock *r = &m->shape.rock[k];
    const char *why = NULL;
    if (isnan(r->diameter)) why = "needs the size of its stones, --stone";
    if (!why && crosses_itself(r)) why = "has sides that cross each other";
    if (!why && !is_in_flume(m, r))
      why = "lies outside the flume: behind its end, in the ground or above 3 times --depth, or is "
            "thinner than half a --spacing";
    if (why) return flume_refuse_at(program, m, "rock", r->corner[0], why);
  }
  return -1;
}
