/* strip.c - see strip.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "strip.h"

#include <mps/experimental/domain.h>
#include <mps/experimental/papers.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* On an edge with a row of particles the lattice begins half a spacing outside. */
static mps_status fill(mps_context *context, const strip_def *def, mps_particles **set) {
  mps_particles_def particles = mps_particles_defaults();
  const int on = def->clamped | def->level;
  double lo[2], hi[2];
  for (int c = 0; c < 2; c++) {
    const int first = c ? STRIP_BOTTOM : STRIP_LEFT, last = c ? STRIP_TOP : STRIP_RIGHT;
    lo[c] = def->lower[c] - (on & first ? 0.5 * def->spacing : 0.0);
    hi[c] = def->upper[c] + (on & last ? 0.5 * def->spacing : 0.0);
    particles.origin[c] = lo[c];
  }
  particles.spacing = def->spacing;
  mps_status status = mps_particles_create(context, &particles, set);
  if (status == MPS_OK) status = mps_particles_fill_box(*set, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(*set, "young", 0, def->young);
  if (status == MPS_OK) status = mps_particles_set(*set, "poisson", 0, def->poisson);
  return status == MPS_OK ? mps_particles_set(*set, "density", 0, def->density) : status;
}

/* The particles on an edge: cut, and held where it is clamped. */
static mps_status make_edge(strip *s, int edge, int64_t *ids) {
  const strip_def *def = &s->def;
  const int axis = edge == STRIP_BOTTOM || edge == STRIP_TOP;
  const int side = edge == STRIP_LEFT || edge == STRIP_BOTTOM ? -1 : 1;
  double lo[2] = {-INFINITY, -INFINITY}, hi[2] = {INFINITY, INFINITY};
  int64_t count = 0;
  const double at = side < 0 ? def->lower[axis] : def->upper[axis];
  lo[axis] = at - 0.25 * def->spacing, hi[axis] = at + 0.25 * def->spacing;
  mps_status status =
      mps_particles_select_box(s->set, lo, hi, mps_particles_count(s->set), &count, ids);
  if (status == MPS_OK)
    status = mps_elastic_cut(s->solver, mps_side_of(axis, side > 0), ids, count);
  if (status != MPS_OK || !(def->clamped & edge)) return status;
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  held.ids = ids, held.id_count = count;
  return mps_elastic_add_boundary(s->solver, &held, &s->support);
}

static mps_status find_facets(strip *s) {
  const int wet = s->def.wet, axis = wet == STRIP_BOTTOM || wet == STRIP_TOP;
  const int side = wet == STRIP_LEFT || wet == STRIP_BOTTOM ? -1 : 1;
  const size_t all = (size_t)mps_elastic_facet_count(s->solver);
  s->facet = calloc(all, sizeof *s->facet);
  s->centre = calloc(3 * all, sizeof *s->centre);
  s->area = calloc(all, sizeof *s->area);
  s->given = calloc(3 * all, sizeof *s->given);
  mps_status status = s->facet && s->centre && s->area && s->given ? MPS_OK : MPS_ERROR_MEMORY;
  if (status == MPS_OK)
    status = mps_elastic_select_facets(s->solver, mps_side_of(axis, side > 0), NULL, NULL,
                                       (int64_t)all, &s->count, s->facet);
  if (s->def.domain) status = mps_domain_agree(s->def.domain, status);
  const mps_elastic_facet_arrays arrays = {.centre = s->centre, .area = s->area};
  return status == MPS_OK ? mps_elastic_get_facets(s->solver, s->facet, s->count, &arrays) : status;
}

static mps_status set_load(strip *s, bool first) {
  mps_elastic_load_def def = mps_elastic_load_defaults();
  def.kind = MPS_ELASTIC_LOAD_TRACTION;
  def.ids = s->facet, def.id_count = s->count;
  def.values = s->given;
  return first ? mps_elastic_add_load(s->solver, &def, &s->load)
               : mps_elastic_set_load(s->solver, s->load, &def);
}

mps_status strip_make(mps_context *context, const strip_def *def, strip *out) {
  *out = (strip){.def = *def};
  mps_elastic_def elastic = mps_elastic_defaults();
  elastic.state = MPS_ELASTIC_STATE_PLANE_STRAIN;
  elastic.bending = 0.0; /* as the coupled walls of docs/verification were compared with theory */
  elastic.blas_threads = 1; /* the same bits for every number of threads */
  elastic.domain = def->domain;
  mps_status status = fill(context, def, &out->set);
  int64_t *ids = malloc((size_t)mps_particles_count(out->set) * sizeof *ids + 8);
  if (!ids) status = MPS_ERROR_MEMORY;
  if (def->domain) status = mps_domain_agree(def->domain, status);
  if (status == MPS_OK)
    status = def->published
                 ? mps_experimental_elastic_published(context, out->set, &elastic, 0, &out->solver)
                 : mps_elastic_create(context, out->set, &elastic, &out->solver);
  for (int edge = STRIP_LEFT; status == MPS_OK && edge <= STRIP_TOP; edge *= 2)
    if ((def->clamped | def->level) & edge) status = make_edge(out, edge, ids);
  free(ids);
  if (status == MPS_OK) status = find_facets(out);
  return status == MPS_OK ? set_load(out, true) : status;
}

mps_status strip_load(strip *s, const double *pressure) {
  const int axis = s->def.wet == STRIP_BOTTOM || s->def.wet == STRIP_TOP;
  const double inward = s->def.wet == STRIP_LEFT || s->def.wet == STRIP_BOTTOM ? 1.0 : -1.0;
  for (int64_t k = 0; k < s->count; k++) s->given[3 * k + axis] = inward * pressure[k];
  return set_load(s, false);
}

mps_status strip_displacement(strip *s, const double *lower, const double *upper, int c,
                              double *mean) {
  mps_view x, u;
  double sum = 0.0;
  int64_t count = 0;
  mps_status status = mps_particles_view(s->set, "position", &x);
  if (status == MPS_OK) status = mps_particles_view(s->set, "displacement", &u);
  for (int64_t i = 0; status == MPS_OK && i < x.shape[0]; i++) {
    const double at[2] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    if (at[0] < lower[0] || at[0] > upper[0] || at[1] < lower[1] || at[1] > upper[1]) continue;
    sum += *mps_view_f64(&u, i, c);
    count++;
  }
  *mean = count ? sum / (double)count : 0.0;
  return status;
}

void strip_free(strip *s) {
  mps_elastic_destroy(&s->solver);
  mps_particles_destroy(&s->set);
  free(s->facet);
  free(s->centre);
  free(s->area);
  free(s->given);
  *s = (strip){0};
}
