/* outside.c - the equations for a linear solver of the caller (solver/linear.h): rows of the matrix
 * with all directions of every particle, rigid motions as near null space, and the residual of its
 * solution by the operator. SPDX-License-Identifier: BSD-3-Clause */
#include "outside.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/operator/assemble.h"
#include "implicit/operator/operator.h"
#include "solver/linear.h"

#include <float.h>
#include <string.h>

/* No solution is required below the rounding of displacements in double precision: this many units
 * in the last place of each, times the greatest stiffness. For a bar 20 times as long as wide that
 * is 8e-10 of |b|. */
#define PLACES 64.0

mps_status mpsi_elastic_linear_ready(void *solver, const char *function) {
  const mps_elastic *e = solver;
  if (e->conservative || !mpsi_domain_many(e->domain)) return MPS_OK;
  return mpsi_fail(
      e->context, function, MPS_ERROR_UNSUPPORTED,
      "the published method is solved by each rank alone, by the library's own solver");
}

void mpsi_elastic_linear_changed(void *solver) {
  mps_elastic *e = solver;
  e->pattern_valid = e->analysed = e->factored = false;
}

bool mpsi_elastic_solved_outside(const mps_elastic *e) {
  return mpsi_linear_serves(&e->base, e->n * e->dim);
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
  mpsi_elastic_outside *o = &e->outside;
  o->stiffest = 0.0;
  for (int64_t k = 0; k < a->start[(a->to - a->from) * e->dim]; k++)
    o->stiffest = fmax(o->stiffest, fabs(a->value[k]));
  return e->shared ? mpsi_elastic_join(e, function, MPS_OK, 1, &o->stiffest) : MPS_OK;
}

/* This rank's particles in the order of layers. */
static mpsi_span own_span(const mps_elastic *e) {
  const int64_t rank = e->domain ? mps_domain_rank(e->domain) : 0;
  const int64_t ranks = e->domain ? mps_domain_size(e->domain) : 1;
  return (mpsi_span){.from = e->n * rank / ranks, .to = e->n * (rank + 1) / ranks};
}

static mps_status hand_matrix(mps_elastic *e, const char *function, double shift) {
  mpsi_elastic_outside *o = &e->outside;
  const mpsi_span own = own_span(e);
  const int64_t rows = (own.to - own.from) * e->dim;
  mpsi_elastic_rows a = {.from = own.from, .to = own.to};
  double *mode = mpsi_alloc(e->context, e->modes * rows, sizeof *mode);
  mps_status status = mode ? MPS_OK : mpsi_fail_memory(e->context, function, (size_t)rows * 48);
  if (status == MPS_OK) status = mpsi_elastic_assemble_rows(e, function, shift, &a);
  status = mpsi_elastic_agree(e, function, status); /* before ranks wait for one another */
  if (status == MPS_OK) status = find_stiffest(e, function, &a);
  if (status == MPS_OK) {
    fill_modes(e, own.from, own.to, mode);
    mps_linear_matrix matrix = {.all = e->n * e->dim,
                                .first = own.from * e->dim,
                                .rows = rows,
                                .block = e->dim,
                                .modes = e->modes,
                                .start = a.start,
                                .column = a.column,
                                .value = a.value,
                                .mode = mode};
    o->nonzeros = a.start[rows];
    o->shift = shift;
    status = mpsi_linear_hand(&e->base, function, &matrix);
  }
  MPSI_FREE(e->context, mode, a.start, a.column, a.value);
  return status;
}

/* ---- solution -------------------------------------------------------------------------------- */

/* Squares |rhs - (K + shift M) solution|^2, by the operator, and |rhs|^2, and the part of |rhs|
 * that may be rounding; `work` has room for two vectors. */
static mps_status residual(mps_elastic *e, const char *function, double shift, const double *rhs,
                           const double *solution, double *work, double *rr, double *bb,
                           double *rounding) {
  const int64_t all = e->n * e->dim;
  double *u = work, *f = e->work, *r = work + all, uu = 0.0;
  memset(u, 0, (size_t)all * sizeof *u);
  mpsi_elastic_expand(e, solution, false, u);
  const mps_status status = mpsi_elastic_apply(e, function, u, f);
  for (int64_t k = 0; shift != 0.0 && k < all; k++) f[k] += shift * e->mass[k / e->dim] * u[k];
  mpsi_elastic_reduce(e, f, r);
  *rr = *bb = 0.0;
  for (int64_t k = 0; k < e->unknowns; k++) {
    *rr += (rhs[k] - r[k]) * (rhs[k] - r[k]);
    *bb += rhs[k] * rhs[k];
    uu += solution[k] * solution[k];
  }
  *rounding = *bb > 0.0 ? PLACES * DBL_EPSILON * e->outside.stiffest * sqrt(uu / *bb) : 0.0;
  return status;
}

/* This rank's rows of a vector of free unknowns, 0 in fixed ones. */
static void to_rows(const mps_elastic *e, const double *unknowns, double *rows) {
  const mpsi_span own = own_span(e);
  for (int64_t k = own.from; k < own.to; k++)
    for (int c = 0; c < e->dim; c++) {
      const int64_t dof = e->dof[mpsi_elastic_in_order(e, k) * e->dim + c];
      *rows++ = dof >= 0 ? unknowns[dof] : 0.0;
    }
}

/* The free unknowns of all ranks from each one's rows; `work` is a vector over all particles. */
static mps_status from_rows(mps_elastic *e, const char *function, const double *rows, double *work,
                            double *unknowns) {
  const mpsi_span own = own_span(e);
  for (int64_t k = own.from; k < own.to; k++)
    for (int c = 0; c < e->dim; c++) work[mpsi_elastic_in_order(e, k) * e->dim + c] = *rows++;
  const mps_status status = mpsi_elastic_complete(e, function, work);
  for (int64_t k = 0; status == MPS_OK && k < e->n * e->dim; k++)
    if (e->dof[k] >= 0) unknowns[e->dof[k]] = work[k];
  return status;
}

static mps_status solve(mps_elastic *e, const char *function, double shift, const double *rhs,
                        double *solution, double *work) {
  const int64_t all = e->n * e->dim;
  double *b = work, *x = work + all, rr, bb, rounding;
  memset(x, 0, (size_t)all * sizeof *x);
  to_rows(e, rhs, b);
  MPSI_TRY(mpsi_linear_solve(&e->base, function, e->def.tolerance, b, x));
  MPSI_TRY(from_rows(e, function, x, b, solution));
  MPSI_TRY(residual(e, function, shift, rhs, solution, work, &rr, &bb, &rounding));
  e->report.iterations += e->linear->result.iterations;
  return mpsi_linear_check(&e->base, function, e->def.tolerance, rounding, rr, bb);
}

mps_status mpsi_elastic_solve_outside(mps_elastic *e, const char *function, double shift,
                                      const double *rhs, double *solution) {
  const int64_t words = 2 * e->n * e->dim;
  mps_status status = MPS_OK;
  if (mpsi_cancelled(e->context))
    status = mpsi_fail(e->context, function, MPS_ERROR_CANCELLED, "cancelled before the solution");
  status = mpsi_elastic_agree(e, function, status);
  if (status == MPS_OK && !(e->linear->valid && e->outside.shift == shift))
    status = hand_matrix(e, function, shift);
  if (status != MPS_OK) return status;
  double *work = mpsi_alloc(e->context, words, sizeof *work);
  if (!work) status = mpsi_fail_memory(e->context, function, (size_t)words * sizeof *work);
  status = mpsi_elastic_agree(e, function, status);
  if (status == MPS_OK) status = solve(e, function, shift, rhs, solution, work);
  mpsi_free(e->context, work);
  return status;
}
