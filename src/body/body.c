/* body.c - creation and release of a rigid body: definition, checks, owners.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "body_internal.h"

#include "mesh.h"

#include <math.h>
#include <string.h>

#define FIRST_PARTS 4 /* room for so many parts at first */

/* ---- definition ------------------------------------------------------------------------------ */

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
  MPSI_FREE(context, body->xy, body->face_of, body->part_of, body->names, body->reaction, body);
  mpsi_context_release(context);
}

mps_status mpsi_body_new(mps_context *context, const char *function, const mps_body_def *user_def,
                         int32_t dim, mpsi_shape shape, int64_t faces, mps_body **out) {
  mps_body_def def;
  MPSI_TRY(MPSI_DEF_READ_OR_DEFAULTS_IN(context, function, mps_body_def, user_def,
                                        mpsi_scene_of(dim), &def));
  drop_unset(&def, dim);
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
  body->part_capacity = FIRST_PARTS;
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

mps_status mps_body_get_def_sized(const mps_body *body, mps_body_def *out, size_t size) {
  if (!body) return mpsi_null(__func__, "body");
  return mpsi_def_write(body->context, "mps_body_get_def", out, size, &body->def, sizeof body->def);
}

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
