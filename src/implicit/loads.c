/* loads.c - surface facets, found from the lattice, and loads as nodal forces.
 *
 * The virtual work of a traction t on a facet of cell i is int t . (u_i + G_i u (x - x_i)) dA: its
 * resultant acts on particle i, its first moment on the sites of the gradient G_i. The same holds
 * for a body force on a cell that is cut in half.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include <string.h>

/* ---- facets -------------------------------------------------------------------------------------
 */

mps_status mpsi_elastic_find_facets(mps_elastic *e, const char *function) {
  const mpsi_links *l = &e->links;
  for (int pass = 0; pass < 2; pass++) {
    e->facet_count = 0;
    for (int64_t i = 0; i < e->n; i++)
      for (int axis = 0; axis < e->dim; axis++)
        for (int up = 0; up < 2; up++) {
          if (l->to[i * l->count + l->face[axis][up]] >= 0) continue;
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

/* The cell of particle i reaches from low to high (relative to the particle) along `axis`. */
static void reach(const mps_elastic *e, int64_t i, int axis, double *low, double *high) {
  *low = e->cut[i] & 1 << 2 * axis ? 0.0 : -0.5 * e->spacing;
  *high = e->cut[i] & 2 << 2 * axis ? 0.0 : 0.5 * e->spacing;
}

/* The facet as a box relative to its particle. */
static void facet_box(const mps_elastic *e, const mpsi_facet *f, double *low, double *high) {
  for (int axis = 0; axis < e->dim; axis++) {
    reach(e, f->particle, axis, &low[axis], &high[axis]);
    if (axis == f->axis) low[axis] = high[axis] = f->side > 0 ? high[axis] : low[axis];
  }
}

int64_t mps_elastic_facet_count(const mps_elastic *e) { return e ? e->facet_count : 0; }

mps_status mps_elastic_get_facet(const mps_elastic *e, int64_t facet, mps_elastic_facet *out) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (!out || facet < 0 || facet >= e->facet_count)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     out ? "facet is %lld, allowed are 0..%lld"
                         : "out is NULL (facet %lld of %lld)",
                     (long long)facet, (long long)e->facet_count - 1);
  const mpsi_facet *f = &e->facets[facet];
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  memset(out, 0, sizeof *out);
  facet_box(e, f, low, high);
  out->particle = f->particle;
  out->axis = f->axis;
  out->side = f->side;
  out->area = e->dim == 2 ? e->def.thickness : 1.0;
  for (int c = 0; c < e->dim; c++) {
    out->centre[c] = e->x[f->particle * e->dim + c] + 0.5 * (low[c] + high[c]);
    out->extent[c] = high[c] - low[c];
    if (c != f->axis) out->area *= out->extent[c];
  }
  return MPS_OK;
}

mps_status mps_elastic_select_facets(const mps_elastic *e, int32_t axis, int32_t side,
                                     const double *lo, const double *hi, int64_t capacity,
                                     int64_t *facets, int64_t *count) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (axis < 0 || axis >= e->dim || side < -1 || side > 1)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "axis is %d and side %d, allowed are 0..%d and -1, 0 (any), 1", axis, side,
                     e->dim - 1);
  if (!count || capacity < 0 || (capacity > 0 && !facets))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "%s",
                     !count ? "count is NULL" : "facets is NULL or capacity negative");
  *count = 0;
  for (int64_t k = 0; k < e->facet_count; k++) {
    const mpsi_facet *f = &e->facets[k];
    mps_elastic_facet facet;
    if (side != 0 && (f->axis != axis || f->side != side)) continue;
    const mps_status status = mps_elastic_get_facet(e, k, &facet);
    if (status != MPS_OK) return status;
    bool inside = true;
    for (int c = 0; c < e->dim; c++)
      inside = inside && (!lo || facet.centre[c] >= lo[c]) && (!hi || facet.centre[c] <= hi[c]);
    if (!inside) continue;
    if (*count < capacity) facets[*count] = k;
    ++*count;
  }
  return MPS_OK;
}

/* ---- loads ----------------------------------------------------------------------------------- */

/* Adds the force and the first moment m[c][b] = int t_c (x - x_i)_b of a load on cell i. */
static void add_load(mps_elastic *e, int64_t i, const double *force, const double (*moment)[3]) {
  const int d = e->dim;
  for (int c = 0; c < d; c++) e->load[i * d + c] += force[c];
  if (!e->def.first_moment) return;
  mpsi_elastic_spread(e, i, moment, e->load);
}

mps_status mps_elastic_clear_loads(mps_elastic *e) {
  if (!e) return MPS_ERROR_ARGUMENT;
  memset(e->load, 0, (size_t)(e->n * e->dim) * sizeof *e->load);
  return MPS_OK;
}

mps_status mps_elastic_add_forces(mps_elastic *e, int64_t count, const int64_t *ids,
                                  const double *forces) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (count < 0 || (count > 0 && (!ids || !forces)))
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "count is %lld (must be >= 0), ids or forces may be NULL", (long long)count);
  for (int64_t i = 0; i < count; i++) {
    if (ids[i] < 0 || ids[i] >= e->n)
      return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
    for (int c = 0; c < e->dim; c++)
      if (!isfinite(forces[i * e->dim + c]))
        return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                         "force %c on particle %lld is %g, must be finite (N)", "xyz"[c],
                         (long long)ids[i], forces[i * e->dim + c]);
  }
  for (int64_t i = 0; i < count; i++)
    for (int c = 0; c < e->dim; c++) e->load[ids[i] * e->dim + c] += forces[i * e->dim + c];
  return MPS_OK;
}

static mps_status check_vector(const mps_elastic *e, const char *function, const char *name,
                               const double *v) {
  if (!v) return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s is NULL", name);
  for (int c = 0; c < e->dim; c++)
    if (!isfinite(v[c]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s[%d] is %g, must be finite",
                       name, c, v[c]);
  return MPS_OK;
}

mps_status mps_elastic_add_body_force(mps_elastic *e, const double *force) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mps_status status = check_vector(e, __func__, "force", force);
  if (status != MPS_OK) return status;
  for (int64_t i = 0; i < e->n; i++) {
    double total[3] = {0.0, 0.0, 0.0}, moment[3][3];
    for (int c = 0; c < e->dim; c++) {
      total[c] = force[c] * e->volume[i];
      for (int b = 0; b < e->dim; b++) {
        double low, high;
        reach(e, i, b, &low, &high);
        moment[c][b] = total[c] * 0.5 * (low + high);
      }
    }
    add_load(e, i, total, (const double(*)[3])moment);
  }
  return MPS_OK;
}

static mps_status check_facets(const mps_elastic *e, const char *function, int64_t count,
                               const int64_t *facets) {
  if (count < 0 || (count > 0 && !facets))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     count < 0 ? "count is %lld, must be >= 0" : "facets is NULL, count is %lld",
                     (long long)count);
  for (int64_t k = 0; k < count; k++)
    if (facets[k] < 0 || facets[k] >= e->facet_count)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "facets[%lld] is %lld, allowed are 0..%lld", (long long)k,
                       (long long)facets[k], (long long)e->facet_count - 1);
  return MPS_OK;
}

/* A uniform traction on one facet. */
static void add_uniform(mps_elastic *e, int64_t k, const double *traction) {
  const mpsi_facet *f = &e->facets[k];
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0}, force[3], moment[3][3];
  double area = e->dim == 2 ? e->def.thickness : 1.0;
  facet_box(e, f, low, high);
  for (int c = 0; c < e->dim; c++)
    if (c != f->axis) area *= high[c] - low[c];
  for (int c = 0; c < e->dim; c++) {
    force[c] = traction[c] * area;
    for (int b = 0; b < e->dim; b++) moment[c][b] = force[c] * 0.5 * (low[b] + high[b]);
  }
  add_load(e, f->particle, force, (const double(*)[3])moment);
}

mps_status mps_elastic_add_traction(mps_elastic *e, int64_t count, const int64_t *facets,
                                    const double *traction) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = check_vector(e, __func__, "traction", traction);
  if (status == MPS_OK) status = check_facets(e, __func__, count, facets);
  for (int64_t k = 0; k < count && status == MPS_OK; k++) add_uniform(e, facets[k], traction);
  return status;
}

mps_status mps_elastic_add_pressure(mps_elastic *e, int64_t count, const int64_t *facets,
                                    const double *pressures) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mps_status status = check_facets(e, __func__, count, facets);
  if (status != MPS_OK) return status;
  if (count > 0 && !pressures)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "pressures is NULL");
  for (int64_t k = 0; k < count; k++)
    if (!isfinite(pressures[k]))
      return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                       "pressures[%lld] is %g, must be finite (Pa)", (long long)k, pressures[k]);
  for (int64_t k = 0; k < count; k++) {
    double traction[3] = {0.0, 0.0, 0.0};
    const mpsi_facet *f = &e->facets[facets[k]];
    traction[f->axis] = -pressures[k] * f->side;
    add_uniform(e, facets[k], traction);
  }
  return MPS_OK;
}

/* Integrates the caller's traction over one facet. */
static mps_status integrate(const mps_elastic *e, const char *function, int64_t k,
                            mps_traction_fn traction, void *user, double *force,
                            double (*moment)[3]) {
  static const double at[3] = {-0.7745966692414834, 0.0, 0.7745966692414834}; /* sqrt(3/5) */
  static const double weight[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
  const mpsi_facet *f = &e->facets[k];
  double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
  double normal[3] = {0.0, 0.0, 0.0}, x[3] = {0.0, 0.0, 0.0}, r[3] = {0.0, 0.0, 0.0};
  facet_box(e, f, low, high);
  normal[f->axis] = f->side;
  memset(force, 0, 3 * sizeof *force);
  memset(moment, 0, 9 * sizeof **moment);
  const int p = f->axis == 0 ? 1 : 0, q = f->axis == 2 ? 1 : 2; /* the facet's own axes */
  for (int b = 0; b < (e->dim == 3 ? 3 : 1); b++)
    for (int a = 0; a < 3; a++) {
      double dA = e->dim == 2 ? e->def.thickness : weight[b] * (high[q] - low[q]), t[3] = {0};
      dA *= weight[a] * (high[p] - low[p]);
      r[f->axis] = low[f->axis];
      r[p] = 0.5 * (low[p] + high[p]) + 0.5 * at[a] * (high[p] - low[p]);
      if (e->dim == 3) r[q] = 0.5 * (low[q] + high[q]) + 0.5 * at[b] * (high[q] - low[q]);
      for (int c = 0; c < e->dim; c++) x[c] = e->x[f->particle * e->dim + c] + r[c];
      mps_status status = traction(user, x, normal, t);
      if (status != MPS_OK)
        return mpsi_fail(e->context, function, status, "the traction callback stopped the call");
      status = check_vector(e, function, "traction", t);
      if (status != MPS_OK) return status;
      for (int c = 0; c < e->dim; c++) {
        force[c] += t[c] * dA;
        for (int m = 0; m < e->dim; m++) moment[c][m] += t[c] * dA * r[m];
      }
    }
  return MPS_OK;
}

mps_status mps_elastic_add_traction_fn(mps_elastic *e, int64_t count, const int64_t *facets,
                                       mps_traction_fn traction, void *user) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (!traction) return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "traction is NULL");
  mps_status status = check_facets(e, __func__, count, facets);
  if (status != MPS_OK) return status;
  const size_t bytes = (size_t)(e->n * e->dim) * sizeof *e->load;
  memcpy(e->work, e->load, bytes); /* put back when the caller's function misbehaves */
  for (int64_t k = 0; k < count && status == MPS_OK; k++) {
    double force[3], moment[3][3];
    status = integrate(e, __func__, facets[k], traction, user, force, moment);
    if (status == MPS_OK)
      add_load(e, e->facets[facets[k]].particle, force, (const double(*)[3])moment);
  }
  if (status != MPS_OK) memcpy(e->load, e->work, bytes);
  return status;
}

/* ---- resultants ------------------------------------------------------------------------------ */

void mpsi_elastic_resultant(const mps_elastic *e, const double *f, const double *about,
                            double *force, double *moment) {
  const int d = e->dim;
  double sum[3] = {0.0, 0.0, 0.0}, turn[3] = {0.0, 0.0, 0.0};
  for (int64_t i = 0; i < e->n; i++) {
    double r[3] = {0.0, 0.0, 0.0}, p[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < d; c++) {
      r[c] = e->x[i * d + c] - (about ? about[c] : 0.0);
      p[c] = f[i * d + c];
      sum[c] += p[c];
    }
    for (int c = 0; c < 3; c++)
      turn[c] += r[(c + 1) % 3] * p[(c + 2) % 3] - r[(c + 2) % 3] * p[(c + 1) % 3];
  }
  if (force) memcpy(force, sum, (size_t)d * sizeof *force);
  if (!moment) return;
  if (d == 2)
    moment[0] = turn[2];
  else
    memcpy(moment, turn, sizeof turn);
}

mps_status mps_elastic_load_resultant(const mps_elastic *e, const double *about, double *force,
                                      double *moment) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mpsi_elastic_resultant(e, e->load, about, force, moment);
  return MPS_OK;
}

mps_status mps_elastic_reaction_resultant(const mps_elastic *e, const double *about, double *force,
                                          double *moment) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mpsi_elastic_resultant(e, e->reaction, about, force, moment);
  return MPS_OK;
}
