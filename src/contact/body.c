/* body.c - life of a rigid body: definition, shapes, owners.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body.h"

#include "core/polygon.h"

#include <string.h>

#define MAX_VERTICES 10000

static const mps_body_def body_defaults = {.struct_size = sizeof(mps_body_def)};
/* Size of the structure in the first release: it may only grow. */
#define BODY_DEF_MINIMUM (offsetof(mps_body_def, damping) + sizeof(double[2]))

mps_status mps_body_def_init(mps_body_def *def, size_t size) {
  return mpsi_def_init(def, size, BODY_DEF_MINIMUM, &body_defaults, sizeof body_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

static mps_status check_numbers(mps_context *context, const char *function, const mps_body_def *d) {
  const struct {
    const char *name, *unit;
    double value;
    bool negative; /* allowed */
  } list[] = {{"position[0]", "m", d->position[0], true},
              {"position[1]", "m", d->position[1], true},
              {"angle", "rad", d->angle, true},
              {"velocity[0]", "m/s", d->velocity[0], true},
              {"velocity[1]", "m/s", d->velocity[1], true},
              {"spin", "rad/s", d->spin, true},
              {"friction", "", d->friction, false},
              {"penalty", "N/m", d->penalty, false},
              {"gravity[0]", "m/s2", d->gravity[0], true},
              {"gravity[1]", "m/s2", d->gravity[1], true},
              {"damping[0]", "1/s", d->damping[0], false},
              {"damping[1]", "1/s", d->damping[1], false}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (!isfinite(list[k].value) || (!list[k].negative && list[k].value < 0.0))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %g %s, must be finite%s",
                       list[k].name, list[k].value, list[k].unit,
                       list[k].negative ? "" : " and >= 0");
  return MPS_OK;
}

/* A prescribed body has no use for what only a free one needs: most likely a slip. */
static mps_status check_motion(mps_context *context, const char *function, const mps_body_def *d) {
  if (d->motion == MPS_MOTION_FREE) {
    if (!isfinite(d->mass) || d->mass <= 0.0 || !isfinite(d->inertia) || d->inertia <= 0.0)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "mass is %g kg and inertia %g kg m2, a free body needs both > 0", d->mass,
                       d->inertia);
    return MPS_OK;
  }
  if (d->motion != MPS_MOTION_PRESCRIBED)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "motion is %d, allowed are 0 (prescribed) and 1 (free)", d->motion);
  const double unused[] = {d->velocity[0], d->velocity[1], d->spin,       d->mass,      d->inertia,
                           d->gravity[0],  d->gravity[1],  d->damping[0], d->damping[1]};
  for (size_t k = 0; k < sizeof unused / sizeof *unused; k++)
    if (unused[k] != 0.0)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "velocity, spin, mass, inertia, gravity and damping (here %g) are for free "
                       "bodies: a prescribed one follows the signals of mps_body_drive",
                       unused[k]);
  return MPS_OK;
}

/* ---- life ------------------------------------------------------------------------------------ */

static void release(mps_body *body) {
  if (--body->references > 0) return;
  mps_context *context = body->context;
  for (int c = 0; c < 3; c++) mps_signal_destroy(&body->signal[c]);
  mpsi_free(context, body->xy);
  mpsi_free(context, body->part_of);
  mpsi_free(context, body->names);
  mpsi_free(context, body);
  mpsi_context_release(context);
}

/* A body of `edges` edges without its shape, at its first position. */
static mps_status begin(mps_context *context, const char *function, const mps_body_def *user_def,
                        mpsi_shape shape, int64_t edges, mps_body **out) {
  mps_body_def def = body_defaults;
  mps_status status = MPS_OK;
  if (user_def)
    status = mpsi_def_read(context, function, user_def, BODY_DEF_MINIMUM, &def, sizeof def);
  if (status == MPS_OK) status = check_numbers(context, function, &def);
  if (status == MPS_OK) status = check_motion(context, function, &def);
  if (status != MPS_OK) return status;
  mps_body *body = mpsi_alloc(context, 1, sizeof *body);
  if (!body) return mpsi_fail_memory(context, function, sizeof *body);
  body->context = mpsi_context_retain(context);
  body->references = 1;
  body->def = def;
  body->shape = shape;
  body->edges = edges;
  body->parts = 1;
  body->part_of = mpsi_alloc(context, edges, sizeof *body->part_of);
  if (body->part_of) body->names = mpsi_alloc(context, MPS_BODY_MAX_PARTS, sizeof *body->names);
  if (!body->names) {
    release(body);
    return mpsi_fail_memory(context, function, (size_t)edges * sizeof *body->part_of);
  }
  strcpy(body->names[0], "rest");
  mpsi_body_begin(body);
  *out = body;
  return MPS_OK;
}

void mps_body_destroy(mps_body **body) {
  if (!body || !*body) return;
  mps_body *b = *body;
  *body = NULL;
  release(b);
}

bool mpsi_body_take(mps_body *body, void *user) {
  if (body->user) return false;
  body->user = user;
  body->references++;
  return true;
}

void mpsi_body_give(mps_body *body) {
  if (!body) return;
  body->user = NULL;
  release(body);
}

/* ---- shapes ---------------------------------------------------------------------------------- */

/* Twice the area, positive when the corners run anticlockwise. */
static double area2(int64_t n, const double *xy) {
  double sum = 0.0;
  for (int64_t k = 0; k < n; k++) { /* from the first corner: exact enough far from the origin */
    const double *a = xy + 2 * k, *b = xy + 2 * ((k + 1) % n);
    sum += (a[0] - xy[0]) * (b[1] - xy[1]) - (b[0] - xy[0]) * (a[1] - xy[1]);
  }
  return sum;
}

static mps_status make_polygon(mps_context *context, const char *function, const mps_body_def *def,
                               int64_t n, const double *xy, mps_body **out) {
  mps_body *body = NULL;
  const mps_status status = begin(context, function, def, MPSI_POLYGON, n, &body);
  if (status != MPS_OK) return status;
  body->xy = mpsi_alloc(context, 2 * (n + 1), sizeof *body->xy);
  if (!body->xy) {
    release(body);
    return mpsi_fail_memory(context, function, (size_t)(n + 1) * 2 * sizeof *body->xy);
  }
  body->reversed = area2(n, xy) < 0.0;
  /* Reversed, edge k of ours is edge n - 1 - k of the caller: our corner k is their n - k. */
  for (int64_t k = 0; k <= n; k++) {
    const double *corner = xy + 2 * ((body->reversed ? n - k : k) % n);
    body->xy[2 * k] = corner[0], body->xy[2 * k + 1] = corner[1];
  }
  *out = body;
  return MPS_OK;
}

mps_status mps_body_create_polygon(mps_context *context, const mps_body_def *def, int64_t vertices,
                                   const double *xy, mps_body **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!xy) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "xy is NULL");
  if (vertices < 3 || vertices > MAX_VERTICES)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "vertices is %lld, must be 3 to %d",
                     (long long)vertices, MAX_VERTICES);
  for (int64_t k = 0; k < 2 * vertices; k++)
    if (!isfinite(xy[k]))
      return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                       "corner %lld has %c = %g m, must be finite", (long long)(k / 2), "xy"[k % 2],
                       xy[k]);
  const mps_status status = mpsi_polygon_check(context, __func__, vertices, xy);
  if (status != MPS_OK) return status;
  return make_polygon(context, __func__, def, vertices, xy, out);
}

mps_status mps_body_create_box(mps_context *context, const mps_body_def *def, double width,
                               double height, mps_body **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!isfinite(width) || width <= 0.0 || !isfinite(height) || height <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "width is %g m and height %g m, must be finite and > 0", width, height);
  const double x = 0.5 * width, y = 0.5 * height;
  const double xy[8] = {-x, -y, x, -y, x, y, -x, y};
  return make_polygon(context, __func__, def, 4, xy, out);
}

mps_status mps_body_create_disc(mps_context *context, const mps_body_def *def, double radius,
                                mps_body **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!isfinite(radius) || radius <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "radius is %g m, must be finite and > 0", radius);
  const mps_status status = begin(context, __func__, def, MPSI_DISC, 1, out);
  if (status == MPS_OK) (*out)->radius = radius;
  return status;
}

mps_status mps_body_create_half_plane(mps_context *context, const mps_body_def *def,
                                      const double *normal, mps_body **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  if (!normal) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "normal is NULL");
  const double length = hypot(normal[0], normal[1]);
  if (!isfinite(length) || length <= 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "normal is (%g, %g), must be finite and not zero", normal[0], normal[1]);
  const mps_status status = begin(context, __func__, def, MPSI_HALF_PLANE, 1, out);
  for (int c = 0; status == MPS_OK && c < 2; c++) (*out)->normal[c] = normal[c] / length;
  return status;
}
