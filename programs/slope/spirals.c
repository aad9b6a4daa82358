/* spirals.c - the factor of safety of a slope by logarithmic spirals (Rendulic 1935, Taylor 1937),
 * an upper bound of limit analysis where the flow is associated (Chen 1975).
 *
 * The ground above the spiral r = r0 exp(theta tan(phi_F)), tan(phi_F) = tan(phi)/F, turns about
 * the pole. Its resistance by friction acts through the pole, so that moments about it give F: sum
 * (c/F) r^2 dtheta = sum b W (x_pole - x) + sum u r^2 tan(phi_F) dtheta, with weights W and
 * pressures u of the water as in circles.c. Without friction the spiral is a circle.
 *
 * Ground that dilates less than its friction has no such bound. Along a line on which it only
 * slides its strength is that of Davis (1968), cos(psi) cos(phi)/(1 - sin(psi) sin(phi)) times c
 * and tan(phi): a factor that it does not fall short of, beside the one that it does not exceed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "slope.h"

#include <math.h>

enum { SLICES = 80, ITERATIONS = 12 };
#define DEGREE (3.14159265358979323846 / 180.0)

/* Of the strength over `factor`, what a line has on which the ground dilates by psi. */
static double share_of_davis(const settings *s, double factor) {
  const double phi = atan(tan(s->phi * DEGREE) / factor), psi = fmin(s->psi * DEGREE, phi);
  return cos(psi) * cos(phi) / (1.0 - sin(psi) * sin(phi));
}

/* Resistance less driving moment over the sum of their parts, with this share of the strength; NaN
 * where the spiral leaves the ground. */
static double excess(const settings *s, const slope_arc *a, double share, slope_circle *pole) {
  double y0, y1, holds = 0.0, drives = 0.0, size = 0.0;
  if (!slope_ends(s, a, &y0, &y1)) return NAN;
  const double tangent = tan(s->phi * DEGREE) * share, turn = 4.0 * atan(2.0 * a->sag);
  /* From entry to exit in the frame of the entry's radius, in r0. */
  const double grown = exp(turn * tangent);
  const double along = grown * cos(turn) - 1.0, across = grown * sin(turn);
  const double dx = a->to - a->from, dy = y1 - y0;
  const double r0 = hypot(dx, dy) / hypot(along, across);
  const double first = atan2(dy, dx) - atan2(across, along), step = turn / SLICES;
  const double level = slope_pool(s), unit = WATER * s->gravity, little = 1e-9 * s->height;
  *pole = (slope_circle){a->from - r0 * cos(first), y0 - r0 * sin(first), r0};
  if (y0 > pole->y) return NAN;
  double x = a->from;
  for (int k = 0; k < SLICES; k++) {
    const double to = (k + 1) * step, mean = (k + 0.5) * step;
    const double next = pole->x + r0 * exp(to * tangent) * cos(first + to), b = next - x;
    const double r = r0 * exp(mean * tangent), px = 0.5 * (x + next);
    const double py = pole->y + r * sin(first + mean), top = slope_surface(s, px);
    x = next;
    if (!(b > 0.0) || py > top + little || py < -s->base - little) return NAN;
    const double still = unit * fmax(0.0, level - py);
    const double weight = slope_overburden(s, px, py) - still;
    const double u = slope_pressure(s, px, py) - still, swept = r * r * step;
    holds += slope_cohesion(s, py) * share * swept;
    drives += b * weight * (pole->x - px) + u * swept * tangent;
    size += b * weight * fabs(pole->x - px);
  }
  return (holds - drives) / (holds + size);
}

/* By secants from `start`; infinite where there is no root near it. */
static double solve(const settings *s, const slope_arc *a, bool davis, double start,
                    slope_circle *out) {
  double before = NAN, factor = start, old = NAN;
  for (int k = 0; k < ITERATIONS; k++) {
    const double share = (davis ? share_of_davis(s, factor) : 1.0) / factor;
    const double now = excess(s, a, share, out);
    if (k == 0) {
      before = factor, old = now, factor *= 1.02;
      continue;
    }
    const double next = factor - now * (factor - before) / (now - old);
    if (!(next > 0.2 * factor && next < 5.0 * factor)) return INFINITY;
    if (fabs(next - factor) < 1e-9 * factor) return next;
    before = factor, old = now, factor = next;
  }
  return INFINITY;
}

static double associated(const settings *s, const slope_arc *a, double start, slope_circle *out) {
  return solve(s, a, false, start, out);
}

static double of_davis(const settings *s, const slope_arc *a, double start, slope_circle *out) {
  return solve(s, a, true, start, out);
}

double slope_spirals(const settings *s, bool davis, slope_circle *out) {
  return slope_least_slip(s, davis ? of_davis : associated, out);
}
