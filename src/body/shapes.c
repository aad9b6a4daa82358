/* shapes.c - creation of bodies by a few numbers or by a polygon.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "core/base/polygon.h"
#include "core/definition/digits.h"

#include <stdio.h>

#define MAX_VERTICES 10000

/* MPS_ERROR_ARGUMENT where the length `name` of a shape is not between MPSI_BODY_SMALL and
 * MPSI_BODY_FAR. */
static mps_status check_length(mps_context *context, const char *function, const char *name,
                               double value) {
  if (value >= MPSI_BODY_SMALL && value <= MPSI_BODY_FAR) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s m, must be in %g to %g m", name,
                   mpsi_outside(value, MPSI_BODY_SMALL, MPSI_BODY_FAR).text, MPSI_BODY_SMALL,
                   MPSI_BODY_FAR);
}

/* Twice the area, positive when the corners run anticlockwise. */
static double area2(int64_t n, const double *xy) {
  double sum = 0.0;
  for (int64_t k = 0; k < n; k++) { /* from the first corner: exact enough far from the origin */
    const double *a = xy + 2 * k, *b = xy + 2 * ((k + 1) % n);
    sum += (a[0] - xy[0]) * (b[1] - xy[1]) - (b[0] - xy[0]) * (a[1] - xy[1]);
  }
  return sum;
}

/* The faces of a polygon's edges in the caller's order, edge k being face k. */
static mps_status make_polygon(mps_context *context, const char *function, const mps_body_def *def,
                               int32_t dim, int64_t n, const double *xy, mps_body **out) {
  mps_body *body = NULL;
  MPSI_TRY(mpsi_body_new(context, function, def, dim, dim == 2 ? MPSI_POLYGON : MPSI_REVOLUTION, n,
                         &body));
  body->edges = n;
  body->xy = mpsi_alloc(context, 2 * (n + 1), sizeof *body->xy);
  if (body->xy) body->face_of = mpsi_alloc(context, n, sizeof *body->face_of);
  if (!body->face_of) {
    mpsi_body_release(body);
    return mpsi_fail_memory(context, function, (size_t)(n + 1) * 2 * sizeof *body->xy);
  }
  const bool reversed = area2(n, xy) < 0.0;
  /* Reversed, edge k is the caller's edge n - 1 - k, and corner k the caller's n - k. */
  for (int64_t k = 0; k <= n; k++) {
    const double *corner = xy + 2 * ((reversed ? n - k : k) % n);
    body->xy[2 * k] = corner[0], body->xy[2 * k + 1] = corner[1];
    if (k < n) body->face_of[k] = reversed ? n - 1 - k : k;
  }
  *out = body;
  return MPS_OK;
}

/* Checks the corners (`names` of their two components) of a simple polygon. */
static mps_status check_corners(mps_context *context, const char *function, int64_t vertices,
                                const double *xy, const char *names) {
  if (!xy) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is NULL", names);
  if (vertices < 3 || vertices > MAX_VERTICES)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "vertices is %lld, must be 3 to %d",
                     (long long)vertices, MAX_VERTICES);
  for (int64_t k = 0; k < 2 * vertices; k++)
    if (!(fabs(xy[k]) <= MPSI_BODY_FAR))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "vertices: corner %lld has %c = %g m, must be finite and within +-%g m",
                       (long long)(k / 2), names[k % 2], xy[k], MPSI_BODY_FAR);
  return mpsi_polygon_check(context, function, vertices, xy);
}

/* ---- 2D -------------------------------------------------------------------------------------- */

mps_status mps_body_create_polygon(mps_context *context, const mps_body_def *def, int64_t vertices,
                                   const double *xy, mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_corners(context, __func__, vertices, xy, "xy"));
  return make_polygon(context, __func__, def, 2, vertices, xy, out);
}

mps_status mps_body_create_box(mps_context *context, const mps_body_def *def, double width,
                               double height, mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_length(context, __func__, "width", width));
  MPSI_TRY(check_length(context, __func__, "height", height));
  const double x = 0.5 * width, y = 0.5 * height;
  const double xy[8] = {-x, -y, x, -y, x, y, -x, y};
  return make_polygon(context, __func__, def, 2, 4, xy, out);
}

static mps_status make_ball(mps_context *context, const char *function, const mps_body_def *def,
                            int32_t dim, double radius, mps_body **out) {
  if (!context) return mpsi_null(function, "context");
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_status status = check_length(context, function, "radius", radius);
  if (status == MPS_OK) status = mpsi_body_new(context, function, def, dim, MPSI_BALL, 1, out);
  if (status == MPS_OK) (*out)->radius = radius;
  return status;
}

static mps_status make_half(mps_context *context, const char *function, const mps_body_def *def,
                            int32_t dim, const double *normal, mps_body **out) {
  if (!context) return mpsi_null(function, "context");
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!normal) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "normal is NULL");
  const double z = dim == 3 ? normal[2] : 0.0, length = hypot(hypot(normal[0], normal[1]), z);
  if (!isfinite(length) || length <= 0.0) {
    char third[32] = "";
    if (dim == 3) snprintf(third, sizeof third, ", %g", z);
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "normal is (%g, %g%s), must be finite and not zero", normal[0], normal[1],
                     third);
  }
  const mps_status status = mpsi_body_new(context, function, def, dim, MPSI_HALF, 1, out);
  for (int32_t c = 0; status == MPS_OK && c < dim; c++) (*out)->normal[c] = normal[c] / length;
  return status;
}

mps_status mps_body_create_disc(mps_context *context, const mps_body_def *def, double radius,
                                mps_body **out) {
  return make_ball(context, __func__, def, 2, radius, out);
}

mps_status mps_body_create_half_plane(mps_context *context, const mps_body_def *def,
                                      const double *normal, mps_body **out) {
  return make_half(context, __func__, def, 2, normal, out);
}

/* ---- 3D -------------------------------------------------------------------------------------- */

mps_status mps_body_create_sphere(mps_context *context, const mps_body_def *def, double radius,
                                  mps_body **out) {
  return make_ball(context, __func__, def, 3, radius, out);
}

mps_status mps_body_create_half_space(mps_context *context, const mps_body_def *def,
                                      const double *normal, mps_body **out) {
  return make_half(context, __func__, def, 3, normal, out);
}

/* The profile must not cross the axis, and may have whole edges on it, not single points: a solid
 * of no thickness at a point has no inside there. */
static mps_status check_profile(mps_context *context, const char *function, int64_t n,
                                const double *rz) {
  for (int64_t k = 0; k < n; k++) {
    const double before = rz[2 * ((k + n - 1) % n)], r = rz[2 * k], after = rz[2 * ((k + 1) % n)];
    if (r < 0.0)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "vertices: corner %lld has r = %g m, must be >= 0", (long long)k, r);
    if (r == 0.0 && (before == 0.0) == (after == 0.0))
      return mpsi_fail(
          context, function, MPS_ERROR_ARGUMENT,
          "vertices: corner %lld is on the axis with %s of its edges: must be with one",
          (long long)k, before == 0.0 ? "both" : "neither");
  }
  return MPS_OK;
}

mps_status mps_body_create_revolution(mps_context *context, const mps_body_def *def,
                                      int64_t vertices, const double *rz, mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_corners(context, __func__, vertices, rz, "rz"));
  MPSI_TRY(check_profile(context, __func__, vertices, rz));
  return make_polygon(context, __func__, def, 3, vertices, rz, out);
}

mps_status mps_body_create_cylinder(mps_context *context, const mps_body_def *def, double radius,
                                    double length, mps_body **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_length(context, __func__, "radius", radius));
  MPSI_TRY(check_length(context, __func__, "length", length));
  const double z = 0.5 * length;
  const double rz[8] = {0.0, -z, radius, -z, radius, z, 0.0, z};
  MPSI_TRY(make_polygon(context, __func__, def, 3, 4, rz, out));
  (*out)->faces = 3; /* the edge on the axis has no face, and the side is the last */
  (*out)->face_of[1] = 2, (*out)->face_of[2] = 1;
  return MPS_OK;
}
