/* facets.c - the surface: faces of cells that no neighbour shares, found from the lattice.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "facets.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/gradient.h"

#include <string.h>

mps_status mpsi_elastic_find_facets(mps_elastic *e, const char *function) {
  for (int pass = 0; pass < 2; pass++) {
    e->facet_count = 0;
    for (int64_t i = 0; i < e->n; i++)
      for (int axis = 0; axis < e->dim; axis++)
        for (int up = 0; up < 2; up++) {
          if (e->faces[i] >> (2 * axis + up) & 1) continue;
          if (pass == 1)
            e->facets[e->facet_count] =
                (mpsi_facet){.particle = i, .axis = (int8_t)axis, .side = (int8_t)(up ? 1 : -1)};
          e->facet_count++;
        }
    if (pass == 1) break;
    e->facets = mpsi_alloc(e->context, e->facet_count, sizeof *e->facets);
    if (!e->facets)
      return mpsi_fail_memory(e->context, function, (size_t)e->facet_count * sizeof *e->facets);
  }
  return MPS_OK;
}

void mpsi_elastic_reach(const mps_elastic *e, int64_t i, int axis, double *low, double *high) {
  *low = e->cut[i] & 1 << 2 * axis ? 0.0 : -0.5 * e->spacing;
  *high = e->cut[i] & 2 << 2 * axis ? 0.0 : 0.5 * e->spacing;
}

void mpsi_elastic_facet_box(const mps_elastic *e, const mpsi_facet *f, double *low, double *high) {
  for (int axis = 0; axis < e->dim; axis++) {
    mpsi_elastic_reach(e, f->particle, axis, &low[axis], &high[axis]);
    if (axis == f->axis) low[axis] = high[axis] = f->side > 0 ? high[axis] : low[axis];
  }
}

int64_t mps_elastic_facet_count(const mps_elastic *e) { return e ? e->facet_count : 0; }

void mpsi_elastic_facet_centre(const mps_elastic *e, const mpsi_facet *f, double *centre) {
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  mpsi_elastic_facet_box(e, f, low, high);
  for (int c = 0; c < 3; c++)
    centre[c] = c < e->dim ? e->x[f->particle * e->dim + c] + 0.5 * (low[c] + high[c]) : 0.0;
}

mps_status mps_elastic_select_facets(const mps_elastic *e, int32_t side, const double *lo,
                                     const double *hi, int64_t capacity, int64_t *count,
                                     int64_t *facets) {
  if (!e) return mpsi_null(__func__, "elastic");
  if (side < MPS_SIDE_ANY || side >= 2 * e->dim)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "side is %s, allowed are MPS_SIDE_ANY and MPS_SIDE_X_LOWER to %s",
                     mpsi_name_of("mps_side", side).text,
                     mpsi_name_of("mps_side", 2 * e->dim - 1).text);
  if (capacity < 0)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  if (!count || (capacity > 0 && !facets))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "%s is NULL",
                     count ? "facets" : "count");
  *count = 0;
  for (int64_t k = 0; k < e->facet_count; k++) {
    const mpsi_facet *f = &e->facets[k];
    double centre[3];
    if (side != MPS_SIDE_ANY && side != mps_side_of(f->axis, f->side > 0)) continue;
    mpsi_elastic_facet_centre(e, f, centre);
    bool inside = true;
    for (int c = 0; c < e->dim; c++)
      inside = inside && (!lo || centre[c] >= lo[c]) && (!hi || centre[c] <= hi[c]);
    if (!inside) continue;
    if (*count < capacity) facets[*count] = k;
    ++*count;
  }
  return MPS_OK;
}

/* The value at r (relative to the particle) of a field whose gradients are given. */
static void extrapolate(const mps_elastic *e, int64_t i, const double *u, const double *gradient,
                        const double *r, double *out) {
  const int d = e->dim;
  for (int c = 0; c < 3; c++) {
    out[c] = c < d ? u[i * d + c] : 0.0;
    for (int b = 0; c < d && b < d; b++)
      out[c] += gradient[(mpsi_elastic_slot(e, i) * d + c) * d + b] * r[b];
  }
}

static void write_shape(const mps_elastic *e, const mpsi_facet *f, int64_t k,
                        const mps_elastic_facet_arrays *a) {
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  double area = e->dim == 2 ? e->def.measure : 1.0;
  mpsi_elastic_facet_box(e, f, low, high);
  for (int c = 0; c < e->dim; c++)
    if (c != f->axis) area *= high[c] - low[c];
  if (a->particle) a->particle[k] = e->id[f->particle];
  if (a->area) a->area[k] = area;
  if (a->centre) mpsi_elastic_facet_centre(e, f, a->centre + 3 * k);
  for (int c = 0; c < 3; c++) {
    if (a->normal) a->normal[3 * k + c] = c == f->axis ? f->side : 0.0;
    if (a->extent) a->extent[3 * k + c] = high[c] - low[c];
  }
}

/* The displacement (or velocity) at the centre of a facet, from gradients at its particle. */
static void find_motion(const mps_elastic *e, const mpsi_facet *f, const double *u, double *out) {
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  mpsi_elastic_facet_box(e, f, low, high);
  for (int c = 0; c < 3; c++) low[c] = 0.5 * (low[c] + high[c]);
  extrapolate(e, f->particle, u, e->gradient, low, out);
}

/* Values of all facets on all ranks, from those of each rank's own particles. */
static mps_status share_motion(mps_elastic *e, const char *function, const double *u,
                               double **out) {
  const int64_t words = 3 * e->facet_count;
  double *all = *out = mpsi_alloc(e->context, words, sizeof *all);
  const mps_status status =
      all ? MPS_OK : mpsi_fail_memory(e->context, function, (size_t)words * sizeof *all);
  for (int64_t k = 0; all && k < e->facet_count; k++) {
    for (int c = 0; c < 3; c++) all[3 * k + c] = -INFINITY;
    if (mpsi_elastic_within(e, e->span[0], e->facets[k].particle))
      find_motion(e, &e->facets[k], u, all + 3 * k);
  }
  return mpsi_elastic_join(e, function, status, words, all);
}

/* Displacements (or velocities) at the centres of facets. */
static mps_status write_motion(mps_elastic *e, const char *function, int64_t count,
                               const int64_t *facets, const double *u, double *out) {
  mpsi_elastic_gradients(e, u, e->gradient);
  if (!e->shared) {
    for (int64_t k = 0; k < count; k++)
      find_motion(e, &e->facets[facets ? facets[k] : k], u, out + 3 * k);
    return MPS_OK;
  }
  double *all = NULL;
  const bool agreed = mpsi_elastic_begin_reading(e);
  const mps_status status = share_motion(e, function, u, &all);
  e->agreed = agreed;
  for (int64_t k = 0; status == MPS_OK && k < count; k++)
    memcpy(out + 3 * k, all + 3 * (facets ? facets[k] : k), 3 * sizeof *out);
  mpsi_free(e->context, all);
  return status;
}

mps_status mps_elastic_get_facets_sized(const mps_elastic *handle, const int64_t *facets,
                                        int64_t count, const mps_elastic_facet_arrays *arrays,
                                        size_t size) {
  mps_elastic *e = (mps_elastic *)handle; /* scratch and messages only: the state stays */
  static const char function[] = "mps_elastic_get_facets";
  if (!e) return mpsi_null(__func__, "elastic");
  mps_elastic_facet_arrays a = {0};
  if (!arrays || size == 0)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     arrays ? "size is 0, must be that of mps_elastic_facet_arrays"
                            : "arrays is NULL");
  if (!facets && count != e->facet_count)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     "count is %lld, must be %lld where facets is NULL (all)", (long long)count,
                     (long long)e->facet_count);
  if (count < 0)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  mps_status status = mpsi_elastic_check_between(e, function);
  if (status != MPS_OK) return status;
  memcpy(&a, arrays, size < sizeof a ? size : sizeof a);
  for (int64_t k = 0; facets && k < count; k++)
    if (facets[k] < 0 || facets[k] >= e->facet_count)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "facets[%lld] is %lld, allowed are 0 to %lld", (long long)k,
                       (long long)facets[k], (long long)e->facet_count - 1);
  for (int64_t k = 0; k < count; k++) write_shape(e, &e->facets[facets ? facets[k] : k], k, &a);
  if (a.displacement)
    status = write_motion(e, function, count, facets, e->displacement, a.displacement);
  if (status == MPS_OK && a.velocity && e->motion)
    status = write_motion(e, function, count, facets, e->motion->velocity, a.velocity);
  if (a.velocity && !e->motion) memset(a.velocity, 0, (size_t)(3 * count) * sizeof *a.velocity);
  return status;
}
