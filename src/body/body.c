/* body.c - creation and release of a rigid body: definition, checks, owners.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "mesh.h"
#include "core/base/digits.h"

#include <math.h>
#include <string.h>

#define FIRST_PARTS 4 /* room for so many parts at first */

static const mps_body_def body_defaults = {
    .struct_size = sizeof(mps_body_def), .mass = NAN, .inertia = {NAN, NAN, NAN}};

mps_status mps_body_def_init(mps_body_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_body_def, def, size, &body_defaults);
}

/* ---- checks ---------------------------------------------------------------------------------- */

/* The vectors of a definition. */
typedef struct vector {
  const char *name, *unit;
  size_t at;     /* in mps_body_def */
  bool plane[3]; /* a component that 2D has */
  bool free;     /* for free bodies only */
  double most;
} vector;

static const vector vectors[] = {
    {"position", "m", offsetof(mps_body_def, position), {true, true, false}, false, MPSI_BODY_FAR},
    {"rotation",
     "rad",
     offsetof(mps_body_def, rotation),
     {false, false, true},
     false,
     MPSI_BODY_FAR},
    {"velocity", "m/s", offsetof(mps_body_def, velocity), {true, true, false}, true, MPSI_BODY_FAR},
    {"spin", "rad/s", offsetof(mps_body_def, spin), {false, false, true}, true, MPSI_BODY_FAR},
    {"inertia",
     "kg m2",
     offsetof(mps_body_def, inertia),
     {false, false, true},
     true,
     MPSI_BODY_HEAVY},
    {"gravity", "m/s2", offsetof(mps_body_def, gravity), {true, true, false}, true, MPSI_BODY_FAR},
};
enum { VECTORS = sizeof vectors / sizeof *vectors };

static double component(const mps_body_def *def, const vector *v, int c) {
  return ((const double *)(const void *)((const char *)def + v->at))[c];
}

static mps_status check_vectors(mps_context *context, const char *function, const mps_body_def *d,
                                int32_t dim) {
  for (const vector *v = vectors; v < vectors + VECTORS; v++)
    for (int c = 0; c < 3; c++) {
      const double value = component(d, v, c);
      if (!(fabs(value) <= v->most))
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "%s[%d] is %g %s, must be finite and within +-%g", v->name, c, value,
                         v->unit, v->most);
      if (dim == 2 && !v->plane[c] && value != 0.0)
        return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                         "%s[%d] is %g %s, must be 0 for a 2D shape", v->name, c, value, v->unit);
    }
  return MPS_OK;
}

static mps_status check_numbers(mps_context *context, const char *function, const mps_body_def *d) {
  const struct {
    const char *name, *unit;
    double value;
  } list[] = {{"damping[0]", "1/s", d->damping[0]}, {"damping[1]", "1/s", d->damping[1]}};
  for (size_t k = 0; k < sizeof list / sizeof *list; k++)
    if (!(list[k].value >= 0.0 && list[k].value <= MPSI_BODY_HEAVY))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is %s %s, must be in 0 to %g",
                       list[k].name, mpsi_outside(list[k].value, 0.0, MPSI_BODY_HEAVY).text,
                       list[k].unit, MPSI_BODY_HEAVY);
  return MPS_OK;
}

static mps_status check_free(mps_context *context, const char *function, const mps_body_def *d,
                             int32_t dim) {
  if (!(d->mass >= MPSI_BODY_LIGHT && d->mass <= MPSI_BODY_HEAVY))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "mass is %g kg, a free body needs %g to %g", d->mass, MPSI_BODY_LIGHT,
                     MPSI_BODY_HEAVY);
  for (int c = dim == 2 ? 2 : 0; c < 3; c++)
    if (!(d->inertia[c] >= MPSI_BODY_LIGHT && d->inertia[c] <= MPSI_BODY_HEAVY))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "inertia[%d] is %g kg m2, a free body needs %g to %g", c, d->inertia[c],
                       MPSI_BODY_LIGHT, MPSI_BODY_HEAVY);
  return MPS_OK;
}

/* A value of free bodies only, given for a prescribed one, is most likely a mistake. */
static mps_status check_motion(mps_context *context, const char *function, const mps_body_def *d,
                               int32_t dim) {
  if (d->motion == MPS_BODY_MOTION_FREE) return check_free(context, function, d, dim);
  if (d->motion != MPS_BODY_MOTION_DRIVEN)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "motion is %d, allowed are 0 (prescribed) and 1 (free)", d->motion);
  double unused = d->mass != 0.0 ? d->mass : d->damping[0] != 0.0 ? d->damping[0] : d->damping[1];
  for (const vector *v = vectors; v < vectors + VECTORS; v++)
    for (int c = 0; v->free && c < 3; c++)
      if (component(d, v, c) != 0.0) unused = component(d, v, c);
  if (unused != 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "velocity, spin, mass, inertia, gravity and damping (here %g) are for free "
                     "bodies: a prescribed one follows the signals of mps_body_drive",
                     unused);
  return MPS_OK;
}

/* What is not there is 0 from here on: mass and inertia of a driven body, inertia about axes that
 * 2D does not have. */
static void drop_unset(mps_body_def *d, int32_t dim) {
  const bool free = d->motion == MPS_BODY_MOTION_FREE;
  if (!free && isnan(d->mass)) d->mass = 0.0;
  for (int c = 0; c < 3; c++)
    if (isnan(d->inertia[c]) && (!free || (dim == 2 && c < 2))) d->inertia[c] = 0.0;
}

/* ---- life ------------------------------------------------------------------------------------ */

void mpsi_body_release(mps_body *body) {
  if (--body->references > 0) return;
  mps_context *context = body->context;
  for (int c = 0; c < MPSI_MOTIONS; c++) mps_signal_destroy(&body->signal[c]);
  mpsi_mesh_destroy(context, body->mesh);
  mpsi_free(context, body->xy);
  mpsi_free(context, body->face_of);
  mpsi_free(context, body->part_of);
  mpsi_free(context, body->names);
  mpsi_free(context, body->reaction);
  mpsi_free(context, body);
  mpsi_context_release(context);
}

mps_status mpsi_body_new(mps_context *context, const char *function, const mps_body_def *user_def,
                         int32_t dim, mpsi_shape shape, int64_t faces, mps_body **out) {
  mps_body_def def = body_defaults;
  mps_status status = MPS_OK;
  if (user_def) status = MPSI_DEF_READ(context, function, mps_body_def, user_def, &def);
  drop_unset(&def, dim);
  if (status == MPS_OK) status = check_numbers(context, function, &def);
  if (status == MPS_OK) status = check_vectors(context, function, &def, dim);
  if (status == MPS_OK) status = check_motion(context, function, &def, dim);
  if (status != MPS_OK) return status;
  mps_body *body = mpsi_alloc(context, 1, sizeof *body);
  if (!body) return mpsi_fail_memory(context, function, sizeof *body);
  body->context = mpsi_context_retain(context);
  body->references = 1;
  body->def = def;
  body->shape = shape;
  body->dim = dim;
  body->faces = faces;
  body->parts = 1;
  body->part_of = mpsi_alloc(context, faces, sizeof *body->part_of);
  body->part_room = FIRST_PARTS;
  if (body->part_of) body->names = mpsi_alloc(context, FIRST_PARTS, sizeof *body->names);
  if (body->names) body->reaction = mpsi_alloc(context, FIRST_PARTS, sizeof *body->reaction);
  if (!body->reaction) {
    mpsi_body_release(body);
    return mpsi_fail_memory(context, function, (size_t)faces * sizeof *body->part_of);
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
  mpsi_body_release(b);
}

int32_t mps_body_dim(const mps_body *body) { return body ? body->dim : 0; }

double mpsi_body_extent(const mps_body *body) {
  double most = 0.0;
  switch (body->shape) {
  case MPSI_BALL:
    return body->radius;
  case MPSI_HALF:
    return 0.0;
  case MPSI_MESH:
    for (int64_t s = 0; s < 3 * body->mesh->triangles; s++) {
      const double *x = body->mesh->xyz + 3 * (int64_t)body->mesh->corner[s];
      most = fmax(most, hypot(hypot(x[0], x[1]), x[2]));
    }
    return most;
  default:
    for (int64_t k = 0; k < body->edges; k++)
      most = fmax(most, hypot(body->xy[2 * k], body->xy[2 * k + 1]));
    return most;
  }
}
