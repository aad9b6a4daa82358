/* supports.c - fixed directions of particles, and the remaining free unknowns.
 *
 * The supports of a particle are rows normal . u = value. Gram-Schmidt turns them into orthonormal
 * fixed directions with their displacements; the rest of an orthonormal basis is free. The matrix
 * is assembled in these local directions, so that it stays symmetric and positive definite for
 * rollers at any angle.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "supports.h"
#include "implicit/base/implicit_solver.h"

#include <string.h>

#define PARALLEL 1e-9 /* sine below which two directions are the same */

/* ---- one particle ---------------------------------------------------------------------------- */

static double dot(const double *a, const double *b, int d) {
  double sum = 0.0;
  for (int c = 0; c < d; c++) sum += a[c] * b[c];
  return sum;
}

/* Subtracts from v its components along basis[0..count); returns the remaining length. */
static double orthogonalise(const double (*basis)[3], int32_t count, int d, double *v) {
  for (int pass = 0; pass < 2; pass++) /* twice is enough */
    for (int32_t b = 0; b < count; b++) {
      const double part = dot(basis[b], v, d);
      for (int c = 0; c < d; c++) v[c] -= part * basis[b][c];
    }
  return sqrt(dot(v, v, d));
}

/* The basis from the rows. False: the last row depends on the others. */
static bool orient(mpsi_support *s, int d) {
  for (int32_t r = 0; r < s->count; r++) {
    double v[3] = {s->normal[r][0], s->normal[r][1], s->normal[r][2]};
    const double length = orthogonalise((const double(*)[3])s->basis, r, d, v);
    if (length < PARALLEL) return false;
    for (int c = 0; c < d; c++) s->basis[r][c] = v[c] / length;
  }
  /* Completed by the axes with the largest remaining length. */
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

bool mpsi_elastic_add_row(mpsi_support *s, int d, const double *normal, double offset,
                          int32_t owner, int32_t signal) {
  int32_t row = s->count;
  for (int32_t r = 0; r < s->count && row == s->count; r++) {
    const double cosine = dot(s->normal[r], normal, d);
    double across[3];
    for (int c = 0; c < d; c++) across[c] = normal[c] - cosine * s->normal[r][c];
    if (sqrt(dot(across, across, d)) > PARALLEL) continue;
    row = r;
  }
  if (row == d) return false;
  if (row == s->count) s->count++;
  for (int c = 0; c < d; c++) s->normal[row][c] = normal[c];
  s->offset[row] = offset;
  s->owner[row] = owner;
  s->signal[row] = signal;
  return orient(s, d);
}

double mpsi_elastic_row(const mpsi_support *s, int32_t r, int32_t c) {
  return dot(s->normal[r], s->basis[c], 3);
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
        value = e->supports[s].fixed[0][c];
      if (s < 0) {
        u[i * d + c] += value;
        continue;
      }
      mpsi_elastic_direction(e, i, c, direction);
      for (int b = 0; b < d; b++) u[i * d + b] += value * direction[b];
    }
  }
}

void mpsi_elastic_impose(const mps_elastic *e, int derivative, double *values) {
  const int d = e->dim;
  for (int64_t k = 0; k < e->support_count; k++) {
    const mpsi_support *s = &e->supports[k];
    double *v = values + s->particle * d;
    for (int32_t r = 0; r < s->count; r++) {
      const double change = s->fixed[derivative][r] - dot(v, s->basis[r], d);
      for (int c = 0; c < d; c++) v[c] += change * s->basis[r][c];
    }
    if (s->count < d) continue;
    memset(v, 0, (size_t)d * sizeof *v); /* all is prescribed: without rounding */
    for (int32_t r = 0; r < d; r++)
      for (int c = 0; c < d; c++) v[c] += s->fixed[derivative][r] * s->basis[r][c];
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
