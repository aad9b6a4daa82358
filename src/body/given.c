/* given.c - definition and pose of a body, as named numbers.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mesh.h"
#include "signal/signal_internal.h"

static void give_shape(mpsi_given *list, const mps_body *body) {
  mpsi_give(list, "the body's shape", body->shape);
  mpsi_give(list, "the body's dimension", body->dim);
  mpsi_give(list, "the body's radius", body->radius);
  mpsi_give_vector(list, "the body's normal", 3, body->normal);
  mpsi_give(list, "the body's number of faces", (double)body->faces);
  mpsi_give_bytes(list, "a hash of the body's corners", body->xy,
                  2 * (size_t)(body->edges + 1) * sizeof *body->xy);
  mpsi_give(list, "the body's number of parts", body->parts);
  mpsi_give_bytes(list, "a hash of the parts of the body's faces", body->part_of,
                  (size_t)body->faces * sizeof *body->part_of);
  const mpsi_mesh *mesh = body->mesh;
  mpsi_give_bytes(list, "a hash of the points of the body's mesh", mesh ? mesh->xyz : NULL,
                  mesh ? 3 * (size_t)mesh->vertices * sizeof *mesh->xyz : 0);
  mpsi_give_bytes(list, "a hash of the triangles of the body's mesh", mesh ? mesh->corner : NULL,
                  mesh ? 3 * (size_t)mesh->triangles * sizeof *mesh->corner : 0);
}

void mpsi_body_give(mpsi_given *list, const mps_body *body) {
  const mps_body_def *d = &body->def;
  give_shape(list, body);
  mpsi_give(list, "the body's motion", d->motion);
  mpsi_give(list, "the body's mass", d->mass);
  mpsi_give_vector(list, "the body's inertia", 3, d->inertia);
  mpsi_give_vector(list, "the body's gravity", 3, d->gravity);
  mpsi_give_vector(list, "the body's damping", 2, d->damping);
  mpsi_give_vector(list, "the body's first position", 3, d->position);
  mpsi_give_vector(list, "the body's first rotation", 3, d->rotation);
  for (int c = 0; c < MPSI_MOTIONS; c++) {
    mpsi_signal_give(list, "a hash of a signal of the body", body->signal[c]);
    mpsi_give(list, "a factor on a signal of the body", body->signal[c] ? body->factor[c] : 0.0);
  }
  mpsi_body_give_state(list, body);
}

void mpsi_body_give_state(mpsi_given *list, const mps_body *body) {
  const mpsi_pose *pose = &body->pose;
  mpsi_give_vector(list, "the body's position", 3, pose->x);
  mpsi_give_vector(list, "the body's orientation", 9, pose->R);
  mpsi_give_vector(list, "the body's velocity", 3, pose->v);
  mpsi_give_vector(list, "the body's spin", 3, pose->spin);
  mpsi_give_vector(list, "the load on the body", 3, body->load.force);
  mpsi_give_vector(list, "the moment on the body", 3, body->load.moment);
  mpsi_give_vector(list, "the impulses pending on the body", 3, body->pending.force);
  mpsi_give_vector(list, "the moments pending on the body", 3, body->pending.moment);
  mpsi_give(list, "the body's time", body->time);
  mpsi_give(list, "moving the body from outside", body->outside);
}

void mpsi_body_give_ahead(mpsi_given *list, const mps_body *body) {
  if (body->def.motion != MPS_BODY_MOTION_DRIVEN || body->outside) return;
  mpsi_give_vector(list, "the body's next position", MPSI_MOTIONS, body->ahead.at);
  mpsi_give_vector(list, "the body's next velocity", MPSI_MOTIONS, body->ahead.rate);
}
