/* characteristics.c - see characteristics.h.
 *
 * In ground at the limit everywhere (Sokolovskii 1965) the stress is given by s, the mean of the
 * principal stresses in the plane, compression positive, and theta, the angle of the major one from
 * the vertical; x points outward, z down. With R = c cos(phi) + s sin(phi) and e = pi/4 - phi/2,
 *
 *   alpha: dx/dz = tan(theta - e),  ds - 2 R dtheta/cos(phi) = weight (dz + tan(phi) dx)
 *   beta:  dx/dz = tan(theta + e),  ds + 2 R dtheta/cos(phi) = weight (dz - tan(phi) dx)
 *
 * Where c grows with depth and phi = 0, equilibrium has -dc/dz (sin(2 theta), cos(2 theta)) more,
 * which adds dc/dz dx along alpha and takes as much off along beta (Davis and Booker 1973).
 *
 * A beta line starts at the surface beside the footing (theta = pi/2), goes down and inward through
 * the fan of alpha lines at the footing's edge, and ends
 *   under a smooth base on the base (theta = 0): the last one at its middle;
 *   under a rough base on the wedge that stays with the footing. The wedge's side is the alpha line
 *   that arrives at the middle line with theta = 0. It starts at the edge; or, where the weight is
 *   so great that the fan would open beyond the horizontal, further in, and the ground slides along
 *   the base as far as there. (Martin 2005, Exact bearing capacity calculations using the method of
 *   characteristics, Proc. 11th IACMAG, Turin, 4, 441-450.)
 * SPDX-License-Identifier: BSD-3-Clause */
#include "characteristics.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

#define SHORT 1e-3 /* half widths: no mechanism is as short */

enum { ITERATIONS = 60, ROOT_STEPS = 50 };

typedef struct point {
  double x, z, s, theta;
} point;

/* Unknowns: the parts of the surface from which beta lines come, the ones that end on the base
 * first, and the angle where the fan, or the base, ends. */
typedef struct net {
  const strip_footing *f;
  double adhesion, sine, tangent, secant; /* c cos(phi) at the surface, and of phi */
  double across;                          /* N/m3: of dx along alpha, less of it along beta */
  double e;           /* rad, between the characteristics and the major stress */
  int lines;          /* in the fan, and in either part of the surface */
  double base, wedge; /* m, lengths of the parts */
  double theta;       /* rad, at the base and the end of the fan */
  point *row[2];      /* two beta lines: the one before, and the present one */
  point end;          /* where the last line ends */
  double load;        /* N/m, on half the footing */
} net;

static double adhesion_at(const net *n, double z) { return n->adhesion + n->f->gradient * z; }

/* R where the mean stress is s and the depth z. */
static double strength(const net *n, double s, double z) { return adhesion_at(n, z) + s * n->sine; }

/* ---- points ---------------------------------------------------------------------------------- */

/* Surface beside the footing. */
static point surface_point(const net *n, double distance) {
  const double s = (n->f->surcharge + n->adhesion) / (1.0 - n->sine);
  return (point){n->f->half_width + distance, 0.0, s, 0.5 * PI};
}

/* The edge, in the fan: weight has no part in it. */
static point edge_point(const net *n, double theta) {
  point p = surface_point(n, 0.0);
  const double turn = 0.5 * PI - theta, R = strength(n, p.s, 0.0);
  p.s += n->sine > 0.0 ? R * expm1(2.0 * n->tangent * turn) / n->sine : 2.0 * R * turn;
  p.theta = theta;
  return p;
}

/* Intersection of the alpha line through a and the beta line through b: trapezoidal rule. */
static point inner_point(const net *n, const point *a, const point *b) {
  const double w = n->f->weight;
  point p = {0.0, 0.0, 0.5 * (a->s + b->s), 0.5 * (a->theta + b->theta)};
  for (int k = 0; k < ITERATIONS; k++) {
    const double old = p.theta;
    const double alpha = 0.5 * (a->theta + p.theta) - n->e;
    const double beta = 0.5 * (b->theta + p.theta) + n->e;
    const double ca = cos(alpha), sa = sin(alpha), cb = cos(beta), sb = sin(beta);
    const double da = a->x * ca - a->z * sa, db = b->x * cb - b->z * sb;
    const double det = sa * cb - ca * sb;
    p.x = (sa * db - sb * da) / det;
    p.z = (ca * db - cb * da) / det;
    const double R = strength(n, p.s, p.z);
    const double A = (strength(n, a->s, a->z) + R) * n->secant;
    const double B = (strength(n, b->s, b->z) + R) * n->secant;
    const double ra = a->s - A * a->theta + w * (p.z - a->z) + n->across * (p.x - a->x);
    const double rb = b->s + B * b->theta + w * (p.z - b->z) - n->across * (p.x - b->x);
    p.theta = (rb - ra) / (A + B);
    p.s = (B * ra + A * rb) / (A + B);
    if (!(fabs(p.theta - old) > 1e-14)) break;
  }
  return p;
}

/* Intersection of the beta line through b and the base. */
static point base_point(const net *n, const point *b) {
  const double beta = 0.5 * (b->theta + n->theta) + n->e;
  const double x = b->x - b->z * tan(beta);
  const double right = b->s - n->f->weight * b->z - n->across * (x - b->x);
  const double turn = (b->theta - n->theta) * n->secant;
  const double s =
      (right + turn * (n->adhesion + strength(n, b->s, b->z))) / (1.0 - turn * n->sine);
  return (point){x, 0.0, s, n->theta};
}

/* ---- the net --------------------------------------------------------------------------------- */

/* Vertical force (N/m) on the base, or on the wedge's side less the wedge's weight, between two
 * points of it. */
static double piece_of_load(const net *n, const point *p, const point *q) {
  double vertical = 0.0, shear = 0.0;
  const point *both[2] = {p, q};
  for (int k = 0; k < 2; k++) {
    const double R = strength(n, both[k]->s, both[k]->z);
    vertical += 0.5 * (both[k]->s + R * cos(2.0 * both[k]->theta));
    shear += 0.5 * R * sin(2.0 * both[k]->theta);
  }
  const double wedge = 0.5 * (p->z + q->z) * n->f->weight;
  return (vertical - wedge) * (p->x - q->x) + shear * (q->z - p->z);
}

/* Lays beta lines one after another. The point j + 1 of a line lies on the alpha line through point
 * j of the line before. Lines are closest at the edge, where the stress changes most. */
static void lay(net *n) {
  const int parts[2] = {n->base > 0.0 ? n->lines : 0, n->wedge > 0.0 ? n->lines : 0};
  int last = n->lines; /* index of the last point of a line */
  for (int j = 0; j <= last; j++)
    n->row[0][j] = edge_point(n, 0.5 * PI + (n->theta - 0.5 * PI) * j / n->lines);
  n->end = n->row[0][last];
  n->load = 0.0;
  for (int i = 1; i <= parts[0] + parts[1]; i++) {
    const bool on_base = i <= parts[0];
    const double part = (double)(on_base ? i : i - parts[0]) / n->lines;
    const double graded = on_base || parts[0] == 0 ? part * part : part;
    const point *before = n->row[(i + 1) % 2];
    point *line = n->row[i % 2];
    line[0] = surface_point(n, on_base ? graded * n->base : n->base + graded * n->wedge);
    for (int j = 0; j <= last; j++) line[j + 1] = inner_point(n, &before[j], &line[j]);
    last++;
    if (on_base) {
      line[last + 1] = base_point(n, &line[last]);
      last++;
    }
    n->load += piece_of_load(n, &n->end, &line[last]);
    n->end = line[last];
  }
}

/* ---- roots ----------------------------------------------------------------------------------- */

typedef double (*residual_fn)(net *n, double t);

/* Root between a and b, where the function changes sign, by the Illinois method; NaN without one.
 */
static double root(net *n, residual_fn function, double a, double b) {
  double fa = function(n, a), fb = function(n, b), t = a;
  if (!(fa * fb <= 0.0)) return NAN;
  for (int k = 0; k < ROOT_STEPS && fabs(b - a) > 1e-10 * (fabs(a) + fabs(b)); k++) {
    t = fa == fb ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
    const double ft = function(n, t);
    if (ft == 0.0) break;
    if (ft * fb < 0.0)
      a = b, fa = fb;
    else
      fa *= 0.5;
    b = t, fb = ft;
  }
  return t;
}

/* Root beyond `start`, looked for in steps that grow or shrink by `factor`. */
static double search(net *n, residual_fn function, double start, double factor) {
  const double sign = function(n, start) > 0.0 ? 1.0 : -1.0;
  double before = start, t = start * factor;
  for (int k = 0; k < ROOT_STEPS && sign * function(n, t) > 0.0; k++) before = t, t *= factor;
  return root(n, function, before, t);
}

/* x of the last line's end, for a part of the surface of this length: positive while too short. */
static double base_end(net *n, double length) {
  n->base = length;
  n->wedge = 0.0;
  lay(n);
  return n->end.x;
}

static double wedge_end(net *n, double length) {
  n->wedge = length;
  lay(n);
  return n->end.x;
}

/* Continues the wedge's side to the middle line and returns theta there, NaN where it does not
 * arrive. The previous wedge gives the start of the search. */
static double close_wedge(net *n) {
  const double guess = 0.5 * n->wedge;
  const bool good = guess > 0.0 && wedge_end(n, guess) > 0.0;
  const double length = search(n, wedge_end, good ? guess : SHORT * n->f->half_width, 1.3);
  wedge_end(n, isnan(length) ? 0.0 : length);
  return isnan(length) ? NAN : n->end.theta;
}

static double wedge_from_edge(net *n, double theta) {
  n->theta = theta;
  n->base = 0.0;
  return close_wedge(n);
}

static double wedge_from_base(net *n, double length) {
  n->base = length;
  return close_wedge(n);
}

static void solve_rough(net *n) {
  const double limit = -(0.5 * PI - n->e); /* alpha lines along the base */
  if (n->across == 0.0) {
    wedge_from_edge(n, 0.0); /* Prandtl's wedge */
  } else if (wedge_from_edge(n, limit) < 0.0) {
    wedge_from_edge(n, search(n, wedge_from_edge, limit, 0.8));
  } else {
    n->theta = limit;
    const double whole = search(n, base_end, SHORT * n->f->half_width, 1.3);
    wedge_from_base(n, search(n, wedge_from_base, 0.9 * whole, 0.8));
  }
}

double characteristics_capacity(const strip_footing *f, int lines) {
  net n = {.f = f, .lines = lines};
  n.adhesion = f->cohesion * cos(f->friction);
  n.sine = sin(f->friction), n.tangent = tan(f->friction), n.secant = 1.0 / cos(f->friction);
  n.across = f->weight * n.tangent + f->gradient;
  n.e = 0.25 * PI - 0.5 * f->friction;
  const size_t most = (size_t)(4 * lines + 8);
  n.row[0] = calloc(2 * most, sizeof *n.row[0]);
  if (!n.row[0]) return NAN;
  n.row[1] = n.row[0] + most;
  if (f->rough)
    solve_rough(&n);
  else
    base_end(&n, search(&n, base_end, SHORT * f->half_width, 1.3));
  free(n.row[0]);
  return fabs(n.end.x) < 1e-6 * f->half_width ? n.load / f->half_width : NAN;
}
