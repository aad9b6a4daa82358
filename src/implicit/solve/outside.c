/* outside.c - the equations for a solver of the caller (mps/elastic_solver.h): rows of the matrix
 * with all directions of every particle, rigid motions as near null space, and the residual of its
 * solution by the operator. SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/base/defs.h"
#include "outside.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/operator/assemble.h"
#include "implicit/operator/operator.h"

#include <float.h>
#include <string.h>

#define ROUNDING 1e-12 /* of |b|: the smallest tolerance that is required of a solver */
/* Nor below the rounding of displacements in double precision: this many units in the last place of
 * each, times the greatest stiffness. For a bar 20 times as long as wide that is 8e-10 of |b|. */
#define PLACES 64.0

void mpsi_elastic_drop_outside(mps_elastic *e) {
  mpsi_free(e->context, e->outside);
  e->outside = NULL;
}

mps_status mps_elastic_set_solver(mps_elastic *e, const mps_elastic_solver_def *user) {
  if (!e) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  mps_elastic_solver_def def = mpsi_elastic_solver_defaults;
  if (user) status = MPSI_DEF_READ(e->context, __func__, mps_elastic_solver_def, user, &def);
  if (status == MPS_OK && user && (!def.matrix || !def.solve))
    status = mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                       "matrix is %s and solve %s: both must be given",
                       def.matrix ? "given" : "NULL", def.solve ? "given" : "NULL");
  if (status == MPS_OK && user && (def.parts < 1 || def.part < 0 || def.part >= def.parts))
    status = mpsi_fail(e->context, __func__, MPS_ERROR_ARGUMENT,
                       "part is %d of %d parts, allowed is 0 to parts - 1, parts >= 1", def.part,
                       def.parts);
  mpsi_elastic_outside *outside = NULL;
  if (status == MPS_OK && user && !(outside = mpsi_alloc(e->context, 1, sizeof *outside)))
    status = mpsi_fail_memory(e->context, __func__, sizeof *outside);
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "having a solver", user != NULL);
  MPSI_GIVE(&given, &def, parts);
  status = mpsi_elastic_agree_given(e, __func__, status, &given);
  if (status != MPS_OK) mpsi_free(e->context, outside);
  if (status == MPS_OK) {
    if (outside) outside->def = def;
    mpsi_elastic_drop_outside(e);
    e->outside = outside;
    e->pattern_valid = e->analysed = e->factored = false;
  }
  return mpsi_elastic_leave(e, status);
}

/* ---- matrix ---------------------------------------------------------------------------------- */

/* Velocity of particle i in rigid motion `mode`: translations first, rotations about `centre`. */
static void rigid(const mps_elastic *e, int32_t mode, const double *centre, int64_t i, double *v) {
  double r[3] = {0.0, 0.0, 0.0};
  v[0] = v[1] = v[2] = 0.0;
  if (mode < e->dim) {
    v[mode] = 1.0;
    return;
  }
  for (int c = 0; c < e->dim; c++) r[c] = e->x[i * e->dim + c] - centre[c];
  const int about = e->dim == 2 ? 2 : mode - 3;
  v[(about + 1) % 3] = -r[(about + 2) % 3];
  v[(about + 2) % 3] = r[(about + 1) % 3];
}

/* The rigid motions in the rows of particles [from, to) of the order of layers. */
static void fill_modes(const mps_elastic *e, int64_t from, int64_t to, double *mode) {
  const int d = e->dim;
  double centre[3] = {0.0, 0.0, 0.0};
  for (int64_t i = 0; i < e->n; i++)
    for (int c = 0; c < d; c++) centre[c] += e->x[i * d + c] / (double)e->n;
  for (int32_t m = 0; m < e->modes; m++)
    for (int64_t k = from; k < to; k++) {
      const int64_t i = mpsi_elastic_in_order(e, k);
      double v[3], direction[3];
      rigid(e, m, centre, i, v);
      for (int c = 0; c < d; c++, mode++) {
        mpsi_elastic_direction(e, i, c, direction);
        *mode = 0.0;
        for (int b = 0; b < d && e->dof[i * d + c] >= 0; b++) *mode += v[b] * direction[b];
      }
    }
}

/* Of the rows of all ranks. */
static mps_status find_stiffest(mps_elastic *e, const char *function, const mpsi_elastic_rows *a) {
  mpsi_elastic_outside *o = e->outside;
  o->stiffest = 0.0;
  for (int64_t k = 0; k < a->start[(a->to - a->from) * e->dim]; k++)
    o->stiffest = fmax(o->stiffest, fabs(a->value[k]));
  return e->shared ? mpsi_elastic_join(e, function, MPS_OK, 1, &o->stiffest) : MPS_OK;
}

static mps_status hand_matrix(mps_elastic *e, const char *function, double shift) {
  mpsi_elastic_outside *o = e->outside;
  const int64_t d = e->dim, from = e->n * o->def.part / o->def.parts;
  const int64_t to = e->n * (o->def.part + 1) / o->def.parts, rows = (to - from) * d;
  mpsi_elastic_rows a = {.from = from, .to = to};
  double *mode = mpsi_alloc(e->context, e->modes * rows, sizeof *mode);
  mps_status status = mode ? MPS_OK : mpsi_fail_memory(e->context, function, (size_t)rows * 48);
  if (status == MPS_OK) status = mpsi_elastic_assemble_rows(e, function, shift, &a);
  status = mpsi_elastic_agree(e, function, status); /* before ranks wait for one another */
  if (status == MPS_OK) status = find_stiffest(e, function, &a);
  if (status == MPS_OK) {
    fill_modes(e, from, to, mode);
    const mps_elastic_matrix matrix = {.all = e->n * d,
                                       .first = from * d,
                                       .rows = rows,
                                       .block = e->dim,
                                       .modes = e->modes,
                                       .start = a.start,
                                       .column = a.column,
                                       .value = a.value,
                                       .mode = mode};
    o->nonzeros = a.start[rows];
    const int64_t failures = mpsi_failures(e->context);
    status =
        mpsi_callback_status(e->context, function, "the callback matrix of mps_elastic_set_solver",
                             failures, o->def.matrix(o->def.user, &matrix, sizeof matrix));
    status = mpsi_elastic_agree(e, function, status);
  }
  mpsi_free(e->context, mode);
  mpsi_free(e->context, a.start);
  mpsi_free(e->context, a.column);
  mpsi_free(e->context, a.value);
  return status;
}

/* ---- solution -------------------------------------------------------------------------------- */

/* |rhs - (K + shift M) solution| over |rhs|, by the operator, and the part that may be rounding;
 * `work` has room for two vectors. */
static mps_status residual(mps_elastic *e, const char *function, double shift, const double *rhs,
                           const double *solution, double *work, double *out, double *rounding) {
  const int64_t all = e->n * e->dim;
  double *u = work, *f = e->work, *r = work + all, rr = 0.0, bb = 0.0, uu = 0.0;
  memset(u, 0, (size_t)all * sizeof *u);
  mpsi_elastic_expand(e, solution, false, u);
  const mps_status status = mpsi_elastic_apply(e, function, u, f);
  for (int64_t k = 0; shift != 0.0 && k < all; k++) f[k] += shift * e->mass[k / e->dim] * u[k];
  mpsi_elastic_reduce(e, f, r);
  for (int64_t k = 0; k < e->unknowns; k++) {
    rr += (rhs[k] - r[k]) * (rhs[k] - r[k]);
    bb += rhs[k] * rhs[k];
    uu += solution[k] * solution[k];
  }
  *rounding = bb > 0.0 ? PLACES * DBL_EPSILON * e->outside->stiffest * sqrt(uu / bb) : 0.0;
  *out = bb > 0.0 ? sqrt(rr / bb) : sqrt(rr);
  return status;
}

/* Between a vector of free unknowns and one of all rows, 0 in fixed ones. */
static void copy_rows(const mps_elastic *e, double *unknowns, double *rows, bool to_rows) {
  for (int64_t i = 0; i < e->n; i++)
    for (int c = 0; c < e->dim; c++) {
      const int64_t dof = e->dof[i * e->dim + c];
      double *row = &rows[mpsi_elastic_place(e, i) * e->dim + c];
      if (to_rows)
        *row = dof >= 0 ? unknowns[dof] : 0.0;
      else if (dof >= 0)
        unknowns[dof] = *row;
    }
}

static mps_status solve(mps_elastic *e, const char *function, const double *rhs, double *solution,
                        double *work) {
  const mps_elastic_solver_def *def = &e->outside->def;
  const int64_t all = e->n * e->dim;
  double *b = work, *x = work + all;
  int64_t iterations = 0;
  memset(x, 0, (size_t)all * sizeof *x);
  copy_rows(e, (double *)rhs, b, true);
  const int64_t failures = mpsi_failures(e->context);
  const mps_status status =
      mpsi_callback_status(e->context, function, "the callback solve of mps_elastic_set_solver",
                           failures, def->solve(def->user, b, e->def.tolerance, x, &iterations));
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < all; k++) /* also of fixed rows, which are not read */
    if (!isfinite(x[k]))
      return mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                       "the callback solve of mps_elastic_set_solver has given x[%lld] = %g",
                       (long long)k, x[k]);
  e->report.iterations += iterations;
  copy_rows(e, solution, x, false);
  return MPS_OK;
}

mps_status mpsi_elastic_solve_outside(mps_elastic *e, const char *function, double shift,
                                      const double *rhs, double *solution) {
  mpsi_elastic_outside *o = e->outside;
  const int64_t words = 2 * e->n * e->dim;
  mps_status status = MPS_OK;
  if (mpsi_cancelled(e->context))
    status = mpsi_fail(e->context, function, MPS_ERROR_CANCELLED, "cancelled before the solution");
  status = mpsi_elastic_agree(e, function, status);
  if (status != MPS_OK) return status;
  if (!o->valid || o->shift != shift) {
    o->valid = false;
    status = hand_matrix(e, function, shift);
    if (status != MPS_OK) return status;
    o->valid = true, o->shift = shift;
  }
  double *work = mpsi_alloc(e->context, words, sizeof *work);
  if (!work) status = mpsi_fail_memory(e->context, function, (size_t)words * sizeof *work);
  status = mpsi_elastic_agree(e, function, status);
  if (status == MPS_OK)
    status = mpsi_elastic_agree(e, function, solve(e, function, rhs, solution, work));
  double left = 0.0, rounding = 0.0;
  if (status == MPS_OK) {
    status = residual(e, function, shift, rhs, solution, work, &left, &rounding);
    if (status == MPS_OK && !(left <= 1.01 * e->def.tolerance + fmax(ROUNDING, rounding)))
      status = mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                         "the solution of the callback solve of mps_elastic_set_solver has the "
                         "residual %g of the right side, tolerance is %g",
                         left, e->def.tolerance);
  }
  mpsi_free(e->context, work);
  return status;
}
