/* circles.c - the factor of safety of a slope by slip circles, Bishop's simplified method (1955),
 * and the search for the least factor of slip lines.
 *
 * A line is given by where it enters the crest's side and leaves at the toe's, and by how far a
 * circle through both sags below the chord. F = sum [(c b + (W - u b) tan(phi))/m]/sum W sin(a),
 * with m = cos(a) + sin(a) tan(phi)/F, over slices of width b whose base has the inclination a. The
 * water of a pool is taken off everywhere as a pressure at rest, which is in equilibrium: its part
 * of W and of u. SPDX-License-Identifier: BSD-3-Clause */
#include "slope.h"

#include <math.h>

enum { SLICES = 60, TURNS = 40 };
#define DEGREE (3.14159265358979323846 / 180.0)
#define LEAST_M 0.2     /* of m: below, the method gives forces without bound */
#define NO_FACTOR 0.001 /* below it the search ends: 0 */

double slope_cohesion(const settings *s, double y) {
  return s->cohesion + s->gradient * (s->height - y);
}

/* Sums of a circle for the factor `guess`; false where it is none. */
static bool sums(const settings *s, const slope_circle *c, double from, double to, double guess,
                 double *holds, double *drives) {
  const double tangent = tan(s->phi * DEGREE), unit = WATER * s->gravity, pool = slope_pool(s);
  const double b = (to - from) / SLICES;
  *holds = *drives = 0.0;
  for (int k = 0; k < SLICES; k++) {
    const double x = from + (k + 0.5) * b, off = x - c->x, top = slope_surface(s, x);
    const double y = c->y - sqrt(c->radius * c->radius - off * off);
    if (y > top + 1e-9 * s->height || y < -s->base - 1e-9 * s->height) return false;
    const double still = unit * fmax(0.0, pool - y), outside = unit * fmax(0.0, pool - top);
    const double weight = slope_overburden(s, x, y) - outside - (still - outside);
    const double u = slope_pressure(s, x, y) - still;
    const double sine = -off / c->radius, m = sqrt(1.0 - sine * sine) + sine * tangent / guess;
    if (m < LEAST_M) return false;
    *holds += b * (slope_cohesion(s, y) + fmax(0.0, weight - u) * tangent) / m;
    *drives += b * weight * sine;
  }
  return *drives > 0.0;
}

bool slope_ends(const settings *s, const slope_arc *a, double *y0, double *y1) {
  *y0 = slope_surface(s, a->from);
  *y1 = a->to < s->slope * s->height ? slope_surface(s, a->to) : 0.0; /* also of a vertical cut */
  return a->to > a->from + 1e-6 * s->height && *y0 > *y1 && a->sag > 0.0 && a->sag < 0.5;
}

/* Infinite where the arc is no circle in the ground. */
static double factor_of(const settings *s, const slope_arc *a, double start, slope_circle *c) {
  const double x0 = a->from, x1 = a->to;
  double y0, y1, factor = start, holds, drives;
  if (!slope_ends(s, a, &y0, &y1)) return INFINITY;
  const double chord = hypot(x1 - x0, y1 - y0), sag = a->sag * chord;
  c->radius = 0.125 * chord * chord / sag + 0.5 * sag;
  const double away =
      (c->radius - sag) / chord; /* from the chord's middle, across it and upwards */
  c->x = 0.5 * (x0 + x1) + away * (y0 - y1);
  c->y = 0.5 * (y0 + y1) + away * (x1 - x0);
  if (y0 > c->y) return INFINITY; /* beyond the vertical */
  for (int k = 0; k < 60; k++) {
    const double before = factor;
    if (!sums(s, c, x0, x1, factor, &holds, &drives)) return INFINITY;
    factor = holds / drives;
    if (fabs(factor - before) < 1e-9 * factor) break;
  }
  return factor;
}

/* Steps of each of the three numbers, halved until they are small. */
static double descend(const settings *s, slope_slip_fn slip, slope_arc *best, double least) {
  double step[3] = {0.2 * s->height, 0.2 * s->height, 0.04};
  slope_circle c;
  for (int turn = 0; turn < TURNS && least > NO_FACTOR;) {
    bool better = false;
    for (int k = 0; k < 6; k++) {
      slope_arc next = *best;
      double *const number[] = {&next.from, &next.to, &next.sag};
      *number[k / 2] += (k % 2 ? 1.0 : -1.0) * step[k / 2];
      const double factor = slip(s, &next, least, &c);
      if (!(factor < least * (1.0 - 1e-9))) continue;
      least = factor, *best = next, better = true;
    }
    if (better) continue;
    turn++;
    for (int k = 0; k < 3; k++) step[k] *= 0.7;
  }
  return least;
}

double slope_least_slip(const settings *s, slope_slip_fn slip, slope_circle *out) {
  const double run = s->slope * s->height, behind = fmin(s->crest, 3.0 * s->height);
  const double before = s->base > 0.0 ? run + fmin(s->toe, 3.0 * s->height) : run;
  double least = INFINITY;
  slope_arc best = {0.0, run, 0.1};
  if (s->slope == 0.0 && s->cohesion == 0.0 && s->gradient == 0.0) {
    *out = (slope_circle){NAN, NAN, NAN}; /* planes of any inclination: tan(phi) over its tangent */
    return 0.0;
  }
  for (int i = 0; i <= 24; i++)
    for (int j = 0; j <= 24; j++)
      for (int k = 1; k <= 12; k++) {
        slope_arc next = {-behind + (behind + run) * i / 24.0, before * j / 24.0, 0.035 * k};
        const double factor = slip(s, &next, isinf(least) ? 1.0 : least, out);
        if (factor < least) least = factor, best = next;
      }
  if (!isinf(least)) least = descend(s, slip, &best, least);
  (void)slip(s, &best, isinf(least) ? 1.0 : least, out);
  return least > NO_FACTOR ? least : 0.0;
}

double slope_circles(const settings *s, slope_circle *out) {
  return slope_least_slip(s, factor_of, out);
}
