/* block.c - see block.h. SPDX-License-Identifier: BSD-3-Clause */
#include "block.h"

const double block_corner[8] = {0.65, 0.5, 0.95, 0.5, 0.95, 0.7, 0.65, 0.7};

static mps_status make_soil(app *a, double dt, block *b) {
  static const double lo[2] = {0.0, 0.0}, hi[2] = {0.85, 0.5};
  mps_particles_def particles = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_mpm_boundary_def floor = mps_mpm_boundary_defaults();
  particles.spacing = 0.025;
  def.cell = 0.05, def.dt = dt, def.gravity[1] = -9.81;
  def.lower[0] = def.lower[1] = 0.0;
  mps_status status = mps_particles_create(a->context, &particles, &b->set);
  if (status == MPS_OK) status = mps_particles_fill_box(b->set, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(b->set, "density", 0, 1600.0);
  if (status == MPS_OK) status = mps_material_create_linear_elastic(a->context, 1e6, 0.3, &b->law);
  if (status == MPS_OK) status = mps_mpm_create(a->context, b->set, b->law, &def, &b->soil);
  return status == MPS_OK ? mps_mpm_set_boundary(b->soil, MPS_SIDE_Y_LOWER, &floor) : status;
}

static mps_status make_box(app *a, bool free, block *b) {
  mps_body_def def = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  if (free) {
    def.motion = MPS_BODY_MOTION_FREE;
    def.mass = BLOCK_BOX_MASS, def.inertia[2] = BLOCK_BOX_INERTIA, def.gravity[1] = -9.81;
  }
  def.position[0] = BLOCK_BOX_X, def.position[1] = BLOCK_BOX_Y;
  contact.friction = 0.3;
  mps_status status = mps_body_create_box(a->context, &def, 0.3, 0.2, &b->box);
  return status == MPS_OK ? mps_mpm_add_contact(b->soil, b->box, &contact, NULL) : status;
}

bool block_make(app *a, double dt, bool free, block *out) {
  *out = (block){0};
  mps_status status = make_soil(a, dt, out);
  if (status == MPS_OK) status = make_box(a, free, out);
  return app_check(a, status);
}

void block_free(block *b) {
  mps_mpm_destroy(&b->soil);
  mps_body_destroy(&b->box);
  mps_material_destroy(&b->law);
  mps_particles_destroy(&b->set);
}
