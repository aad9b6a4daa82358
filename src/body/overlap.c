/* overlap.c - checks of bodies before a solver starts: overlap of two bodies, and thickness of a
 * body's walls.
 *
 * Two surfaces are compared piece by piece (edges, triangles): the distance to the other body
 * changes no faster than the position, so a piece of radius r around a point at distance d >= r is
 * outside; else it is divided, down to the given depth.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"
#include "rotation.h"

#include <string.h>

#define SECTORS 48 /* of a solid of revolution, approximated by triangles */
#define END 1e-6   /* the samples nearest to an edge's ends, in its length */

/* ---- overlap --------------------------------------------------------------------------------- */

/* A point X of the body's frame in space. */
static void to_space(const mps_body *body, const double *X, double *x) {
  mpsi_rotate(body->pose.R, X, x);
  for (int c = 0; c < 3; c++) x[c] += body->pose.x[c];
}

/* Whether a point of the segment (n = 2) or triangle (n = 3) with the corners p is deeper than
 * `depth` inside the body. */
static bool piece_inside(const mps_body *body, int n, const double p[3][3], double depth) {
  double centre[3] = {0.0}, radius = 0.0;
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) centre[c] += p[k][c] / n;
  for (int k = 0; k < n; k++) {
    const double d[3] = {p[k][0] - centre[0], p[k][1] - centre[1], p[k][2] - centre[2]};
    radius = fmax(radius, sqrt(mpsi_dot3(d, d)));
  }
  const double d = mpsi_body_foot(body, centre).distance;
  if (d < -depth) return true;
  if (d - radius >= -depth) return false;
  double middle[3][3], part[3][3]; /* of the side from corner k to the next */
  for (int k = 0; k < n; k++)
    for (int c = 0; c < 3; c++) middle[k][c] = 0.5 * (p[k][c] + p[(k + 1) % n][c]);
  for (int k = 0; k < n; k++) { /* the piece at corner k */
    memcpy(part[0], p[k], sizeof part[0]);
    memcpy(part[1], middle[k], sizeof part[1]);
    if (n == 3) memcpy(part[2], middle[(k + 2) % 3], sizeof part[2]);
    if (piece_inside(body, n, (const double(*)[3])part, depth)) return true;
  }
  return n == 3 && piece_inside(body, 3, (const double(*)[3])middle, depth);
}

/* The surface of edge k of a profile, in triangles. */
static bool ring_inside(const mps_body *a, int64_t k, const mps_body *b, double depth) {
  const double *from = a->xy + 2 * k, *to = from + 2, step = 8.0 * atan(1.0) / SECTORS;
  for (int s = 0; s < SECTORS; s++) {
    double corner[4][3], p[3][3];
    for (int q = 0; q < 4; q++) {
      const double *rz = q < 2 ? from : to, angle = step * (s + (q == 1 || q == 2));
      const double own[3] = {rz[0] * cos(angle), rz[0] * sin(angle), rz[1]};
      to_space(a, own, corner[q]);
    }
    memcpy(p, corner, sizeof p);
    if (piece_inside(b, 3, (const double(*)[3])p, depth)) return true;
    memcpy(p[1], corner[3], sizeof p[1]);
    if (piece_inside(b, 3, (const double(*)[3])p, depth)) return true;
  }
  return false;
}

/* Whether the surface of polygon, solid of revolution or mesh `a` is somewhere inside b. */
static bool surface_inside(const mps_body *a, const mps_body *b, double depth) {
  double p[3][3];
  if (a->shape == MPSI_MESH) {
    for (int64_t t = 0; t < a->mesh->triangles; t++) {
      for (int k = 0; k < 3; k++)
        to_space(a, a->mesh->xyz + 3 * (int64_t)a->mesh->corner[3 * t + k], p[k]);
      if (piece_inside(b, 3, (const double(*)[3])p, depth)) return true;
    }
    return false;
  }
  for (int64_t k = 0; k < a->edges; k++) {
    const double *xy = a->xy + 2 * k;
    if (a->shape == MPSI_REVOLUTION) {
      if ((xy[0] > 0.0 || xy[2] > 0.0) && ring_inside(a, k, b, depth)) return true;
      continue;
    }
    for (int e = 0; e < 2; e++) {
      const double own[3] = {xy[2 * e], xy[2 * e + 1], 0.0};
      to_space(a, own, p[e]);
    }
    if (piece_inside(b, 2, (const double(*)[3])p, depth)) return true;
  }
  return false;
}

/* The lowest point of body a over the surface of half space b. */
static double lowest(const mps_body *a, const mps_body *b) {
  double n[3], own[3], least = INFINITY;
  mpsi_rotate(b->pose.R, b->normal, n);
  mpsi_rotate_back(a->pose.R, n, own);
  const double from[3] = {a->pose.x[0] - b->pose.x[0], a->pose.x[1] - b->pose.x[1],
                          a->pose.x[2] - b->pose.x[2]};
  const double middle = mpsi_dot3(from, n), across = hypot(own[0], own[1]);
  if (a->shape == MPSI_BALL) return middle - a->radius;
  if (a->shape == MPSI_HALF) /* bounded by parallel edges only where they face each other */
    return mpsi_dot3(a->normal, own) < -1.0 + 1e-12 ? middle : -INFINITY;
  if (a->shape == MPSI_MESH)
    for (int64_t s = 0; s < 3 * a->mesh->triangles; s++)
      least = fmin(least, mpsi_dot3(a->mesh->xyz + 3 * (int64_t)a->mesh->corner[s], own));
  for (int64_t k = 0; k < a->edges; k++) {
    const double *xy = a->xy + 2 * k;
    least = fmin(least, a->shape == MPSI_POLYGON ? xy[0] * own[0] + xy[1] * own[1]
                                                 : xy[1] * own[2] - xy[0] * across);
  }
  return middle + least;
}

bool mpsi_body_overlap(const mps_body *a, const mps_body *b, double depth) {
  if (a->shape == MPSI_HALF) return lowest(b, a) < -depth;
  if (b->shape == MPSI_HALF) return lowest(a, b) < -depth;
  if (a->shape == MPSI_BALL) return mpsi_body_foot(b, a->pose.x).distance < a->radius - depth;
  if (b->shape == MPSI_BALL) return mpsi_body_foot(a, b->pose.x).distance < b->radius - depth;
  return surface_inside(a, b, depth) || surface_inside(b, a, depth);
}

/* ---- walls ----------------------------------------------------------------------------------- */

/* Edge k of the polygon; of a profile, k from `edges` on, its mirror image at the axis. False where
 * it is no surface. */
static bool wall_edge(const mps_body *body, int64_t k, double *a, double *b) {
  const bool mirrored = k >= body->edges;
  const double *xy = body->xy + 2 * (mirrored ? k - body->edges : k);
  if (body->shape == MPSI_REVOLUTION && xy[0] == 0.0 && xy[2] == 0.0) return false;
  memcpy(a, mirrored ? xy + 2 : xy, 2 * sizeof *a);
  memcpy(b, mirrored ? xy : xy + 2, 2 * sizeof *b);
  if (mirrored) a[0] = -a[0], b[0] = -b[0];
  return true;
}

/* Outward unit normal of the edge a b. */
static void normal_of(const double *a, const double *b, double *n) {
  const double x = b[0] - a[0], y = b[1] - a[1], length = hypot(x, y);
  n[0] = y / length, n[1] = -x / length;
}

/* Distance from x on edge k straight inwards to the next edge, INFINITY where that is not a wall's
 * other side. */
static double wall_at(const mps_body *body, int64_t k, const double *x, const double *n) {
  const int64_t all = body->shape == MPSI_REVOLUTION ? 2 * body->edges : body->edges;
  double nearest = INFINITY, facing = 0.0;
  for (int64_t m = 0; m < all; m++) {
    double a[2], b[2], other[2];
    if (m == k || !wall_edge(body, m, a, b)) continue;
    const double ex = b[0] - a[0], ey = b[1] - a[1], px = a[0] - x[0], py = a[1] - x[1];
    const double across = n[1] * ex - n[0] * ey; /* x - t n = a + s e */
    if (across == 0.0) continue;
    const double t = (px * ey - py * ex) / across, s = (n[0] * py - n[1] * px) / across;
    if (!(t > 0.0 && t < nearest && s >= 0.0 && s <= 1.0)) continue;
    normal_of(a, b, other);
    nearest = t;
    facing = n[0] * other[0] + n[1] * other[1];
  }
  return facing <= MPSI_BODY_OPPOSITE ? nearest : INFINITY;
}

static double polygon_thickness(const mps_body *body) {
  const int samples = body->edges > 200 ? 2 : 16;
  double least = INFINITY;
  for (int64_t k = 0; k < body->edges; k++) {
    double a[2], b[2], n[2];
    if (!wall_edge(body, k, a, b)) continue;
    normal_of(a, b, n);
    for (int s = 0; s <= samples; s++) {
      const double t = fmin(fmax((double)s / samples, END), 1.0 - END);
      const double x[2] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])};
      least = fmin(least, wall_at(body, k, x, n));
    }
  }
  return least;
}

double mpsi_body_thickness(const mps_body *body) {
  double least = INFINITY;
  switch (body->shape) {
  case MPSI_BALL:
    return 2.0 * body->radius;
  case MPSI_HALF:
    return INFINITY;
  case MPSI_MESH:
    for (int64_t t = 0; t < body->mesh->triangles; t++)
      least = fmin(least, mpsi_mesh_wall(body->mesh, t));
    return least;
  default:
    return polygon_thickness(body);
  }
}

/* Whether a convex polygon (r, z) is convex with its image beyond the axis: it has an edge there,
 * and does not extend beyond the ends of that edge. */
static bool is_convex_about_axis(const mps_body *body) {
  bool closed = false;
  for (int64_t k = 0; k < body->edges; k++) {
    const double *a = body->xy + 2 * k, *b = a + 2;
    closed = closed || (a[0] == 0.0 && b[0] == 0.0);
    if ((a[0] == 0.0) != (b[0] == 0.0) && b[1] < a[1]) return false;
  }
  return closed;
}

bool mpsi_body_is_convex(const mps_body *body) {
  if (body->shape == MPSI_BALL || body->shape == MPSI_HALF) return true;
  if (body->shape == MPSI_MESH) return false;
  if (body->shape == MPSI_REVOLUTION && !is_convex_about_axis(body)) return false;
  for (int64_t k = 0; k < body->edges; k++) {
    const double *a = body->xy + 2 * k, *b = a + 2, *c = body->xy + 2 * ((k + 1) % body->edges) + 2;
    if ((b[0] - a[0]) * (c[1] - b[1]) < (b[1] - a[1]) * (c[0] - b[0])) return false;
  }
  return true;
}
