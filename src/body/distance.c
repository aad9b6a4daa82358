/* distance.c - signed distance, outward normal and foot point on a rigid body's surface: the d_p
 * and n_p of Nakamura (27), (28). Meshes are in mesh_foot.c.
 *
 * The sign at a corner is that of (x - corner) . (n1 + n2), with the normals of its two edges: in
 * 2D that side is right for convex and for concave corners, so no crossings need to be counted, and
 * sign, normal and foot always belong to the same feature. A solid of revolution is its profile, a
 * polygon in the half plane r >= 0, in the plane through the axis and the point.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "mesh.h"
#include "rotation.h"

/* The nearest feature found so far. */
typedef struct nearest {
  double square; /* of the distance, m2 */
  int64_t edge;
  int where; /* 0: inner point of the edge, -1: its start, 1: its end */
} nearest;

/* Unit normal of edge k of the anticlockwise corners: the direction rotated clockwise. */
static void edge_normal(const mps_body *body, int64_t k, double *n) {
  const double *a = body->xy + 2 * k, *b = a + 2;
  const double dx = b[0] - a[0], dy = b[1] - a[1], length = sqrt(dx * dx + dy * dy);
  n[0] = dy / length;
  n[1] = -dx / length;
}

/* An edge of a profile that lies on the axis is no surface. */
MPSI_INLINE bool on_axis(const double *edge) { return edge[0] == 0.0 && edge[2] == 0.0; }

MPSI_INLINE nearest search(const mps_body *body, const double *x, bool revolved) {
  nearest best = {.square = INFINITY};
  for (int64_t k = 0; k < body->edges; k++) {
    const double *a = body->xy + 2 * k, *b = a + 2;
    if (revolved && on_axis(a)) continue;
    const double ex = b[0] - a[0], ey = b[1] - a[1], px = x[0] - a[0], py = x[1] - a[1];
    const double t = px * ex + py * ey, length2 = ex * ex + ey * ey;
    double square;
    int where = 0;
    if (t <= 0.0) {
      where = -1;
      square = px * px + py * py;
    } else if (t >= length2) {
      where = 1;
      square = (x[0] - b[0]) * (x[0] - b[0]) + (x[1] - b[1]) * (x[1] - b[1]);
    } else {
      const double across = px * ey - py * ex;
      square = across * across / length2;
    }
    /* An inner point prevails over a corner at the same distance by rounding. */
    if (square < best.square || (square == best.square && where == 0 && best.where != 0))
      best = (nearest){square, k, where};
  }
  return best;
}

/* The normal of the other edge at a corner of edge k. On the axis of a solid of revolution that is
 * the mirror image of edge k itself. */
MPSI_INLINE void neighbour_normal(const mps_body *body, int64_t k, int where, bool revolved,
                                  const double *own, double *out) {
  const int64_t n = body->edges, other = where < 0 ? (k + n - 1) % n : (k + 1) % n;
  if (revolved && on_axis(body->xy + 2 * other))
    out[0] = -own[0], out[1] = own[1];
  else
    edge_normal(body, other, out);
}

MPSI_INLINE mpsi_foot polygon_foot(const mps_body *body, const double *x, bool revolved) {
  const nearest best = search(body, x, revolved);
  const int64_t k = best.edge;
  mpsi_foot f = {.face = body->face_of[k], .narrowing = 1.0};
  double one[2], two[2];
  edge_normal(body, k, one);
  if (best.where == 0) {
    const double *a = body->xy + 2 * k;
    f.distance = (x[0] - a[0]) * one[0] + (x[1] - a[1]) * one[1];
    for (int c = 0; c < 2; c++) {
      f.normal[c] = one[c];
      f.at[c] = x[c] - f.distance * one[c];
    }
    return f;
  }
  const double *corner = body->xy + 2 * (best.where < 0 ? k : k + 1);
  neighbour_normal(body, k, best.where, revolved, one, two);
  const double mx = one[0] + two[0], my = one[1] + two[1], mean = sqrt(mx * mx + my * my);
  const double dx = x[0] - corner[0], dy = x[1] - corner[1], d = sqrt(dx * dx + dy * dy);
  const double sign = dx * mx + dy * my < 0.0 ? -1.0 : 1.0;
  f.at[0] = corner[0], f.at[1] = corner[1];
  f.distance = sign * d;
  if (d > 0.0)
    f.normal[0] = sign * dx / d, f.normal[1] = sign * dy / d;
  else
    f.normal[0] = mx / mean, f.normal[1] = my / mean;
  f.narrowing = mpsi_rim_narrowing(f.normal[0] * one[0] + f.normal[1] * one[1]);
  return f;
}

/* Disc and sphere. */
MPSI_INLINE mpsi_foot ball_foot(const mps_body *body, const double *x, int dim) {
  mpsi_foot f = {.normal = {1.0, 0.0, 0.0}, .narrowing = 1.0};
  const double r = sqrt(x[0] * x[0] + x[1] * x[1] + (dim == 3 ? x[2] * x[2] : 0.0));
  f.distance = r - body->radius;
  for (int c = 0; c < dim; c++) {
    if (r > 0.0) f.normal[c] = x[c] / r;
    f.at[c] = body->radius * f.normal[c];
    if (c > 0 && r > 0.0) f.narrowing *= body->radius / r;
  }
  return f;
}

/* Half plane and half space. */
static mpsi_foot half_foot(const mps_body *body, const double *x) {
  const double *n = body->normal;
  mpsi_foot f = {.distance = mpsi_dot3(x, n), .normal = {n[0], n[1], n[2]}, .narrowing = 1.0};
  for (int c = 0; c < 3; c++) f.at[c] = x[c] - f.distance * n[c];
  return f;
}

static mpsi_foot revolution_foot(const mps_body *body, const double *x) {
  const double r = sqrt(x[0] * x[0] + x[1] * x[1]), rz[2] = {r, x[2]};
  mpsi_foot f = polygon_foot(body, rz, true);
  const double ex = r > 0.0 ? x[0] / r : 1.0, ey = r > 0.0 ? x[1] / r : 0.0;
  const double n[2] = {f.normal[0], f.normal[1]}, at[2] = {f.at[0], f.at[1]};
  f.normal[0] = n[0] * ex, f.normal[1] = n[0] * ey, f.normal[2] = n[1];
  f.at[0] = at[0] * ex, f.at[1] = at[0] * ey, f.at[2] = at[1];
  if (r > 0.0) f.narrowing *= at[0] / r;
  return f;
}

static mpsi_foot solid_foot(const mps_body *body, const double *x) {
  const mpsi_pose *p = &body->pose;
  const double from[3] = {x[0] - p->x[0], x[1] - p->x[1], x[2] - p->x[2]};
  double local[3];
  mpsi_rotate_back(p->R, from, local);
  const mpsi_foot own = body->shape == MPSI_BALL         ? ball_foot(body, local, 3)
                        : body->shape == MPSI_HALF       ? half_foot(body, local)
                        : body->shape == MPSI_REVOLUTION ? revolution_foot(body, local)
                                                         : mpsi_mesh_foot(body->mesh, local);
  mpsi_foot f = own;
  mpsi_rotate(p->R, own.normal, f.normal);
  mpsi_rotate(p->R, own.at, f.at);
  for (int c = 0; c < 3; c++) f.at[c] += p->x[c];
  return f;
}

mpsi_foot mpsi_body_foot(const mps_body *body, const double *x) {
  if (body->dim == 3) return solid_foot(body, x);
  const mpsi_pose *p = &body->pose;
  const double cosine = p->R[0], sine = p->R[3];
  const double dx = x[0] - p->x[0], dy = x[1] - p->x[1];
  const double local[3] = {cosine * dx + sine * dy, cosine * dy - sine * dx, 0.0};
  mpsi_foot f = body->shape == MPSI_POLYGON ? polygon_foot(body, local, false)
                : body->shape == MPSI_BALL  ? ball_foot(body, local, 2)
                                            : half_foot(body, local);
  const double n[2] = {f.normal[0], f.normal[1]}, at[2] = {f.at[0], f.at[1]};
  f.normal[0] = cosine * n[0] - sine * n[1];
  f.normal[1] = sine * n[0] + cosine * n[1];
  f.at[0] = p->x[0] + (cosine * at[0] - sine * at[1]);
  f.at[1] = p->x[1] + (sine * at[0] + cosine * at[1]);
  return f;
}

/* Whether x is further than `reach` from the cube around a mesh. */
static bool beyond_cube(const mps_body *body, const double *x, double reach) {
  const mpsi_pose *p = &body->pose;
  const double from[3] = {x[0] - p->x[0], x[1] - p->x[1], x[2] - p->x[2]};
  double local[3], square = 0.0;
  mpsi_rotate_back(p->R, from, local);
  for (int c = 0; c < 3; c++) {
    const double out = fmax(fabs(local[c] - body->mesh->middle[c]) - body->mesh->size, 0.0);
    square += out * out;
  }
  return square > reach * reach * (1.0 + 1e-12);
}

bool mpsi_body_reaches(const mps_body *body, const double *x, double reach) {
  if (body->shape == MPSI_MESH && beyond_cube(body, x, reach)) return false;
  return mpsi_body_foot(body, x).distance <= reach;
}

bool mpsi_body_reaches_next(const mps_body *body, const double *x, double reach,
                            mpsi_last_distance *last) {
  const double slack = last->distance * (1.0 - 1e-9) - reach; /* more than round-off */
  double square = 0.0;
  for (int c = 0; c < 3; c++) square += (x[c] - last->x[c]) * (x[c] - last->x[c]);
  if (slack > 0.0 && square < slack * slack) return false;
  if (body->shape == MPSI_MESH && beyond_cube(body, x, reach)) return false;
  memcpy(last->x, x, sizeof last->x);
  last->distance = mpsi_body_foot(body, x).distance;
  return last->distance <= reach;
}

#define MAX_POINTS (INT64_C(1) << 40)

mps_status mps_body_distance(const mps_body *body, int64_t count, const double *x, double *distance,
                             double *normal, double *foot, int64_t *face) {
  if (!body) return mpsi_null(__func__, "body");
  if (count < 0 || count > MAX_POINTS)
    return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %lld points, allowed are 0 to %lld", (long long)count,
                     (long long)MAX_POINTS);
  if (count > 0 && !x) return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT, "x is NULL");
  const int32_t dim = body->dim;
  for (int64_t i = 0; i < dim * count; i++)
    if (!isfinite(x[i]))
      return mpsi_fail(body->context, __func__, MPS_ERROR_ARGUMENT,
                       "x: point %lld has %c = %g m, must be finite", (long long)(i / dim),
                       "xyz"[i % dim], x[i]);
  for (int64_t i = 0; i < count; i++) {
    const mpsi_foot f = mpsi_body_foot(body, x + dim * i);
    if (distance) distance[i] = f.distance;
    if (face) face[i] = f.face;
    for (int32_t c = 0; c < dim; c++) {
      if (normal) normal[dim * i + c] = f.normal[c];
      if (foot) foot[dim * i + c] = f.at[c];
    }
  }
  return MPS_OK;
}
