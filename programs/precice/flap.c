/* flap.c - see flap.h. Plane strain. The lowest row of particles lies on the ground and the highest
 * on the top, both cut in half, so that the free length is the height. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "flap.h"

#include <math.h>
#include <stdlib.h>

static mps_status fill(mps_context *context, const flap_def *def, mps_particles **out) {
  const double half = 0.5 * def->spacing;
  const double lo[2] = {def->x - 0.5 * def->width, def->y - half};
  const double hi[2] = {def->x + 0.5 * def->width, def->y + def->height + half};
  mps_particles_def set = mps_particles_defaults();
  set.spacing = def->spacing;
  set.origin[0] = lo[0], set.origin[1] = lo[1];
  mps_status status = mps_particles_create(context, &set, out);
  if (status == MPS_OK) status = mps_particles_fill_box(*out, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(*out, "young", 0, def->young);
  if (status == MPS_OK) status = mps_particles_set(*out, "poisson", 0, def->poisson);
  if (status == MPS_OK) status = mps_particles_set(*out, "density", 0, def->density);
  return status;
}

/* Cuts the row of particles at height y, whose outer half is on `side` of it. */
static mps_status cut_row(flap *f, const flap_def *def, double y, int32_t side) {
  const double lo[2] = {-INFINITY, y - 0.25 * def->spacing},
               hi[2] = {INFINITY, y + 0.25 * def->spacing};
  const int64_t all = mps_particles_count(f->particles);
  int64_t count = 0, *ids = malloc((size_t)all * sizeof *ids);
  if (!ids) return MPS_ERROR_MEMORY;
  mps_status status = mps_particles_select_box(f->particles, lo, hi, all, &count, ids);
  if (status == MPS_OK) status = mps_elastic_cut(f->solver, mps_side_of(1, side > 0), ids, count);
  free(ids);
  return status;
}

static mps_status hold(flap *f, const flap_def *def) {
  mps_elastic_boundary_def foot = mps_elastic_boundary_defaults();
  for (int c = 0; c < 3; c++) foot.lower[c] = -INFINITY, foot.upper[c] = INFINITY;
  foot.upper[1] = def->y + 0.25 * def->spacing;
  return mps_elastic_add_boundary(f->solver, &foot, NULL);
}

static mps_status choose_facets(flap *f, const flap_def *def) {
  const double lo[2] = {-INFINITY, def->y + 0.125 * def->spacing}, hi[2] = {INFINITY, INFINITY};
  int64_t count = 0;
  mps_status status = mps_elastic_select_facets(f->solver, MPS_SIDE_ANY, lo, hi, 0, &count, NULL);
  if (status != MPS_OK) return status;
  f->facets = malloc((size_t)(count + 1) * sizeof *f->facets);
  if (!f->facets) return MPS_ERROR_MEMORY;
  return mps_elastic_select_facets(f->solver, MPS_SIDE_ANY, lo, hi, count, &f->facet_count,
                                   f->facets);
}

bool flap_make(app *a, const flap_def *def, flap *out) {
  *out = (flap){0};
  mps_elastic_def method = mps_elastic_defaults();
  mps_elastic_motion_def motion = mps_elastic_motion_defaults();
  const double top[2] = {def->x, def->y + def->height};
  method.state = MPS_ELASTIC_STATE_PLANE_STRAIN;
  method.bending = def->bending;
  motion.dt = def->dt;
  mps_status status = fill(a->context, def, &out->particles);
  if (status == MPS_OK)
    status = mps_elastic_create(a->context, out->particles, &method, &out->solver);
  if (status == MPS_OK) status = cut_row(out, def, def->y, -1);
  if (status == MPS_OK) status = cut_row(out, def, def->y + def->height, 1);
  if (status == MPS_OK) status = hold(out, def);
  if (status == MPS_OK) status = choose_facets(out, def);
  if (status == MPS_OK) status = mps_elastic_start(out->solver, &motion);
  if (status == MPS_OK) out->tip = mps_particles_nearest(out->particles, top);
  return app_check(a, status);
}

void flap_free(flap *f) {
  mps_elastic_destroy(&f->solver);
  mps_particles_destroy(&f->particles);
  free(f->facets);
  f->facets = NULL;
}

bool flap_tip(app *a, const flap *f, double *u) {
  mps_view view;
  if (!app_check(a, mps_particles_view(f->particles, "displacement", &view))) return false;
  const int64_t k = mps_particles_index(f->particles, f->tip);
  u[0] = *mps_view_f64(&view, k, 0);
  u[1] = *mps_view_f64(&view, k, 1);
  return true;
}
