/* supports.c - prescribed displacements and rollers, and the free unknowns that they leave.
 *
 * The supports of a particle are rows normal . u = value. Gram-Schmidt turns them into orthonormal
 * fixed directions with their displacements; the rest of an orthonormal basis is free. The matrix
 * is assembled in these local directions, so that it stays symmetric and positive definite for
 * rollers at any angle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include <string.h>

#define PARALLEL 1e-9 /* sine below which two directions are the same */

/* ---- one particle -----------------------------------------------------------------------------
 */

static double dot(const double *a, const double *b, int d) {
  double sum = 0.0;
  for (int c = 0; c < d; c++) sum += a[c] * b[c];
  return sum;
}

/* Subtracts from v its parts along basis[0..count); returns the length that remains. */
static double orthogonalise(const double (*basis)[3], int32_t count, int d, double *v) {
  for (int pass = 0; pass < 2; pass++) /* twice is enough */
    for (int32_t b = 0; b < count; b++) {
      const double part = dot(basis[b], v, d);
      for (int c = 0; c < d; c++) v[c] -= part * basis[b][c];
    }
  return sqrt(dot(v, v, d));
}

/* Basis and fixed displacements from the rows. False: the last row depends on the others. */
static bool orient(mpsi_support *s, int d) {
  for (int32_t r = 0; r < s->count; r++) {
    double v[3] = {s->normal[r][0], s->normal[r][1], s->normal[r][2]};
    const double length = orthogonalise((const double(*)[3])s->basis, r, d, v);
    if (length < PARALLEL) return false;
    double rest = s->value[r];
    for (int32_t b = 0; b < r; b++) rest -= dot(s->normal[r], s->basis[b], d) * s->fixed[b];
    for (int c = 0; c < d; c++) s->basis[r][c] = v[c] / length;
    s->fixed[r] = rest / length;
  }
  /* Completed by the axes that are farthest from what is there. */
  for (int32_t r = s->count; r < d; r++) {
    double best[3] = {0.0, 0.0, 0.0}, longest = 0.0;
    for (int axis = 0; axis < d; axis++) {
      double v[3] = {axis == 0, axis == 1, axis == 2};
      const double length = orthogonalise((const double(*)[3])s->basis, r, d, v);
      if (length <= longest + PARALLEL) continue;
      longest = length;
      for (int c = 0; c < d; c++) best[c] = v[c] / length;
    }
    memcpy(s->basis[r], best, sizeof best);
  }
  return true;
}

/* Adds the row normal . u = value, or replaces the value of a parallel one. */
static bool add_row(mpsi_support *s, int d, const double *normal, double value, bool *new_row) {
  *new_row = false;
  for (int32_t r = 0; r < s->count; r++) {
    const double cosine = dot(s->normal[r], normal, d);
    double across[3];
    for (int c = 0; c < d; c++) across[c] = normal[c] - cosine * s->normal[r][c];
    if (sqrt(dot(across, across, d)) > PARALLEL) continue;
    s->value[r] = cosine > 0.0 ? value : -value;
    return orient(s, d);
  }
  if (s->count == d) return false;
  const int32_t r = s->count++;
  for (int c = 0; c < d; c++) s->normal[r][c] = normal[c];
  s->value[r] = value;
  *new_row = true;
  return orient(s, d);
}

/* ---- public calls -------------------------------------------------------------------------------
 */

static mps_status check_list(const mps_elastic *e, const char *function, int64_t count,
                             const int64_t *ids, const double *values) {
  if (count < 0 || (count > 0 && !ids))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                     count < 0 ? "count is %lld, must be >= 0" : "ids is NULL for %lld particles",
                     (long long)count);
  for (int64_t i = 0; i < count; i++) {
    if (ids[i] < 0 || ids[i] >= e->n)
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "ids[%lld] is %lld: no particle of the solver has that id", (long long)i,
                       (long long)ids[i]);
    if (values && !isfinite(values[i]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "values[%lld] is %g, must be finite (m)", (long long)i, values[i]);
  }
  return MPS_OK;
}

/* Room for `more` particles with supports. */
static mps_status reserve(mps_elastic *e, const char *function, int64_t more) {
  const int64_t need = e->support_count + more;
  if (need <= e->support_capacity) return MPS_OK;
  const int64_t capacity = need > 2 * e->support_capacity ? need : 2 * e->support_capacity;
  if (!mpsi_grow(e->context, (void **)&e->supports, e->support_capacity, capacity,
                 sizeof *e->supports))
    return mpsi_fail_memory(e->context, function, (size_t)capacity * sizeof *e->supports);
  e->support_capacity = capacity;
  return MPS_OK;
}

static mpsi_support *support_for(mps_elastic *e, int64_t particle) {
  if (e->support_of[particle] < 0) {
    mpsi_support *s = &e->supports[e->support_count];
    memset(s, 0, sizeof *s);
    s->particle = particle;
    e->support_of[particle] = e->support_count++;
  }
  return &e->supports[e->support_of[particle]];
}

static mps_status fix(mps_elastic *e, const char *function, const double *normal, int64_t count,
                      const int64_t *ids, const double *values) {
  mps_status status = check_list(e, function, count, ids, values);
  if (status != MPS_OK) return status;
  bool new_row;
  for (int64_t i = 0; i < count; i++) { /* a trial first: an error must change nothing */
    const int64_t found = e->support_of[ids[i]];
    mpsi_support trial = {0};
    if (found >= 0) trial = e->supports[found];
    if (!add_row(&trial, e->dim, normal, 0.0, &new_row))
      return mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "direction (%g, %g, %g) of particle %lld is already fixed by its other "
                       "supports",
                       normal[0], normal[1], normal[2], (long long)ids[i]);
  }
  if ((status = reserve(e, function, count)) != MPS_OK) return status;
  for (int64_t i = 0; i < count; i++) {
    mpsi_support *s = support_for(e, ids[i]);
    (void)add_row(s, e->dim, normal, values ? values[i] : 0.0, &new_row);
    if (new_row) e->pattern_valid = false;
  }
  return MPS_OK;
}

mps_status mps_elastic_prescribe(mps_elastic *e, int32_t component, int64_t count,
                                 const int64_t *ids, const double *values) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (component < 0 || component >= e->dim)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "component is %d, allowed are 0..%d",
                     component, e->dim - 1);
  const double normal[3] = {component == 0, component == 1, component == 2};
  return fix(e, __func__, normal, count, ids, values);
}

mps_status mps_elastic_roller(mps_elastic *e, const double *normal, int64_t count,
                              const int64_t *ids, const double *values) {
  if (!e) return MPS_ERROR_ARGUMENT;
  if (!normal) return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT, "normal is NULL");
  double unit[3] = {0.0, 0.0, 0.0};
  const double length = sqrt(dot(normal, normal, e->dim));
  if (!isfinite(length) || length <= 0.0)
    return mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                     "the length of normal is %g, must be finite and > 0", length);
  for (int c = 0; c < e->dim; c++) unit[c] = normal[c] / length;
  return fix(e, __func__, unit, count, ids, values);
}

mps_status mps_elastic_clear_supports(mps_elastic *e) {
  if (!e) return MPS_ERROR_ARGUMENT;
  for (int64_t s = 0; s < e->support_count; s++) e->support_of[e->supports[s].particle] = -1;
  e->support_count = 0;
  e->pattern_valid = false;
  return MPS_OK;
}

/* ---- free unknowns --------------------------------------------------------------------------- */

void mpsi_elastic_direction(const mps_elastic *e, int64_t i, int32_t c, double *out) {
  if (e->support_of[i] >= 0) {
    memcpy(out, e->supports[e->support_of[i]].basis[c], 3 * sizeof *out);
    return;
  }
  out[0] = c == 0;
  out[1] = c == 1;
  out[2] = c == 2;
}

static int32_t fixed_count(const mps_elastic *e, int64_t i) {
  return e->support_of[i] >= 0 ? e->supports[e->support_of[i]].count : 0;
}

void mpsi_elastic_number(mps_elastic *e) {
  e->unknowns = 0;
  for (int64_t i = 0; i < e->n; i++) {
    const int32_t fixed = fixed_count(e, i);
    for (int32_t c = 0; c < e->dim; c++) e->dof[i * e->dim + c] = c < fixed ? -1 : e->unknowns++;
  }
}

void mpsi_elastic_expand(const mps_elastic *e, const double *free_values, bool prescribed,
                         double *u) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++) {
    const int64_t s = e->support_of[i];
    for (int32_t c = 0; c < d; c++) {
      const int64_t dof = e->dof[i * d + c];
      double value = 0.0, direction[3];
      if (dof >= 0)
        value = free_values ? free_values[dof] : 0.0;
      else if (prescribed)
        value = e->supports[s].fixed[c];
      if (s < 0) {
        u[i * d + c] += value;
        continue;
      }
      mpsi_elastic_direction(e, i, c, direction);
      for (int b = 0; b < d; b++) u[i * d + b] += value * direction[b];
    }
  }
}

void mpsi_elastic_reduce(const mps_elastic *e, const double *f, double *free_values) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++)
    for (int32_t c = 0; c < d; c++) {
      const int64_t dof = e->dof[i * d + c];
      double direction[3];
      if (dof < 0) continue;
      if (e->support_of[i] < 0) {
        free_values[dof] = f[i * d + c];
        continue;
      }
      mpsi_elastic_direction(e, i, c, direction);
      free_values[dof] = dot(f + i * d, direction, d);
    }
}

void mpsi_elastic_keep_fixed(const mps_elastic *e, double *f) {
  const int d = e->dim;
  for (int64_t i = 0; i < e->n; i++) {
    double kept[3] = {0.0, 0.0, 0.0}, direction[3];
    for (int32_t c = 0; c < fixed_count(e, i); c++) {
      mpsi_elastic_direction(e, i, c, direction);
      const double part = dot(f + i * d, direction, d);
      for (int b = 0; b < d; b++) kept[b] += part * direction[b];
    }
    memcpy(f + i * d, kept, (size_t)d * sizeof *f);
  }
}
