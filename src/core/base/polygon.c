/* polygon.c - checks of a simple polygon.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "polygon.h"

static const double *corner(int64_t n, const double *xy, int64_t k) { return xy + 2 * (k % n); }

/* Twice the signed area of the triangle a b c: > 0 when it runs anticlockwise. */
static double turn(const double *a, const double *b, const double *c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool between(const double *a, const double *b, const double *x) {
  return x[0] >= fmin(a[0], b[0]) && x[0] <= fmax(a[0], b[0]) && x[1] >= fmin(a[1], b[1]) &&
         x[1] <= fmax(a[1], b[1]);
}

/* Whether the closed segments ab and cd have a point in common. */
static bool segments_intersect(const double *a, const double *b, const double *c, const double *d) {
  for (int axis = 0; axis < 2; axis++)
    if (fmax(a[axis], b[axis]) < fmin(c[axis], d[axis]) ||
        fmax(c[axis], d[axis]) < fmin(a[axis], b[axis]))
      return false;
  const double tc = turn(a, b, c), td = turn(a, b, d), ta = turn(c, d, a), tb = turn(c, d, b);
  if (((tc > 0.0 && td < 0.0) || (tc < 0.0 && td > 0.0)) &&
      ((ta > 0.0 && tb < 0.0) || (ta < 0.0 && tb > 0.0)))
    return true;
  return (tc == 0.0 && between(a, b, c)) || (td == 0.0 && between(a, b, d)) ||
         (ta == 0.0 && between(c, d, a)) || (tb == 0.0 && between(c, d, b));
}

/* Corners that coincide, and edges that lie on each other at their common corner. Edge k runs from
 * corner k to corner k + 1. */
static mps_status check_corners(mps_context *context, const char *function, int64_t n,
                                const double *xy) {
  for (int64_t k = 0; k < n; k++) {
    const double *a = corner(n, xy, k), *b = corner(n, xy, k + 1), *c = corner(n, xy, k + 2);
    const long long next = (k + 1) % n;
    if (a[0] == b[0] && a[1] == b[1])
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "vertices: corners %lld and %lld of the polygon coincide at (%g, %g) m (it is "
          "closed without repeating the first)",
          (long long)k, next, a[0], a[1]);
    if (turn(a, b, c) == 0.0 && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) < 0.0)
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "vertices: edges %lld and %lld of the polygon lie on each other at corner %lld: "
          "(%g, %g) m",
          (long long)k, next, next, b[0], b[1]);
  }
  return MPS_OK;
}

/* Edges that are not neighbours must not intersect; the last is a neighbour of the first. */
static mps_status check_edges(mps_context *context, const char *function, int64_t n,
                              const double *xy) {
  for (int64_t k = 0; k < n; k++)
    for (int64_t m = k + 2; m < n - (k == 0); m++) {
      const double *a = corner(n, xy, k), *c = corner(n, xy, m);
      if (segments_intersect(a, corner(n, xy, k + 1), c, corner(n, xy, m + 1)))
        return mpsi_fail(
            context, function, MPS_ERROR_ARGUMENT,
            "vertices: edges %lld and %lld of the polygon intersect: from corner (%g, %g) "
            "and from corner (%g, %g) m",
            (long long)k, (long long)m, a[0], a[1], c[0], c[1]);
    }
  return MPS_OK;
}

mps_status mpsi_polygon_check(mps_context *context, const char *function, int64_t n,
                              const double *xy) {
  MPSI_TRY(check_corners(context, function, n, xy));
  return check_edges(context, function, n, xy);
}
