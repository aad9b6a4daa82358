/* system.c - from the assembled matrix to displacements: analysis, factorisation, solution with
 * iterative refinement, reactions.
 *
 * Refinement takes its residual from the matrix-free operator (operator.c), which uses displacement
 * differences and is the more accurate of the two; the first pass, from the prescribed
 * displacements alone, is the solution itself.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "system.h"
#include "implicit/base/implicit_solver.h"
#include "implicit/base/motion_state.h"
#include "implicit/body/thin.h"
#include "implicit/body/window.h"
#include "implicit/operator/assemble.h"
#include "implicit/operator/moduli.h"
#include "implicit/operator/operator.h"
#include "implicit/solve/cg.h"
#include "implicit/solve/rigid.h"
#include "solver/linear.h"

#include <string.h>
#include <time.h>

#define CASES_AT_ONCE 16 /* right-hand sides of one triangular solution */

/* Where the caller leaves the choice, fewer load cases at rest than FEW_CASES are solved by
 * conjugate gradients where the factor takes more operations than FACTOR_FLOPS for each entry of
 * the lower triangle. Cubes of 2700, 9450, 30 492 unknowns have 1e4, 5e4, 2e5 of these; one
 * solution, with the factor or by iterations on two threads, took .05 and .014, .61 and .19, 9.8
 * and .66 s. Slender bars have some hundred: their factor is cheaper. Plates of the plane stay with
 * the factor, as iterations grow with the number of cells along a side. */
#define FEW_CASES 8
#define FACTOR_FLOPS 2e4

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static mpsi_matrix matrix(const mps_elastic *e) {
  return (mpsi_matrix){.n = e->unknowns, .column = e->column, .row = e->row, .value = e->value};
}

/* ---- preparation ----------------------------------------------------------------------------- */

/* The symbolic factor, ordered by particles. */
static mps_status order(mps_elastic *e, const char *function) {
  int64_t *group = mpsi_alloc(e->context, e->unknowns, sizeof *group), groups = 0;
  if (!group) return mpsi_fail_memory(e->context, function, (size_t)e->unknowns * sizeof *group);
  for (int64_t i = 0; i < e->n; i++) {
    bool any = false;
    for (int32_t c = 0; c < e->dim; c++) {
      if (e->dof[i * e->dim + c] < 0) continue;
      group[e->dof[i * e->dim + c]] = groups;
      any = true;
    }
    if (any) groups++;
  }
  const mpsi_matrix a = matrix(e);
  const mps_status status =
      mpsi_cholesky_analyse(e->cholesky, function, &a, group, groups, &e->symbolic);
  mpsi_free(e->context, group);
  return status;
}

static mps_status analyse(mps_elastic *e, const char *function) {
  static const mpsi_ordering orderings[] = {MPSI_ORDER_BEST, MPSI_ORDER_AMD, MPSI_ORDER_METIS};
  e->use_cg = e->def.solver == MPS_ELASTIC_SOLVER_CG;
  e->iterates = false;
  memset(&e->symbolic, 0, sizeof e->symbolic);
  if (e->use_cg || e->unknowns == 0) {
    e->analysed = true;
    return MPS_OK;
  }
  mps_status status = MPS_OK;
  if (!e->cholesky)
    status = mpsi_cholesky_create(
        e->context, function, orderings[e->def.ordering], e->def.solver == MPS_ELASTIC_SOLVER_LDLT,
        e->def.blas_threads ? e->def.blas_threads : mps_context_threads(e->context), &e->cholesky);
  if (status == MPS_OK) status = order(e, function);
  if (status != MPS_OK) return status;
  e->report.analyses++;
  if (e->symbolic.bytes > e->def.memory_limit) {
    if (e->def.solver != MPS_ELASTIC_SOLVER_AUTO)
      return mpsi_fail(e->context, function, MPS_ERROR_MEMORY,
                       "the factor takes %.4g bytes, memory_limit is %.4g: raise it, or set solver "
                       "to MPS_ELASTIC_SOLVER_AUTO or _CG",
                       e->symbolic.bytes, e->def.memory_limit);
    e->use_cg = true;
    mpsi_cholesky_destroy(&e->cholesky);
  }
  e->iterates = e->def.solver == MPS_ELASTIC_SOLVER_AUTO && e->dim == 3 &&
                e->symbolic.flops > FACTOR_FLOPS * (double)e->column[e->unknowns];
  e->analysed = true;
  return MPS_OK;
}

/* A solver of the caller receives the matrix before a solution. */
static mps_status prepare_outside(mps_elastic *e, const char *function) {
  if (e->pattern_valid && e->values_valid) return MPS_OK;
  e->linear->valid = false;
  MPSI_TRY(e->pattern_valid ? MPS_OK : mpsi_elastic_make_vectors(e, function));
  memset(&e->symbolic, 0, sizeof e->symbolic);
  mpsi_cholesky_destroy(&e->cholesky);
  e->pattern_valid = e->values_valid = e->analysed = e->use_cg = true;
  e->iterates = false;
  return MPS_OK;
}

mps_status mpsi_elastic_prepare(mps_elastic *e, const char *function) {
  mps_status status = MPS_OK;
  double start = now();
  if (e->unread) status = mpsi_elastic_renew_material(e, function);
  if (status == MPS_OK) status = mpsi_elastic_choose_window(e, function);
  const bool assemble = !e->pattern_valid || !e->values_valid;
  if (status == MPS_OK) status = mpsi_elastic_warn_of_thin_parts(e, function);
  if (status == MPS_OK && !e->pattern_valid) status = mpsi_elastic_check_supported(e, function);
  if (status == MPS_OK && mpsi_elastic_solved_outside(e)) return prepare_outside(e, function);
  if (status == MPS_OK) status = mpsi_elastic_assemble(e, function);
  if (status != MPS_OK) return status;
  if (assemble) e->report.seconds_assemble = now() - start;
  if (e->analysed) return MPS_OK;
  start = now();
  status = analyse(e, function);
  e->report.seconds_analyse = now() - start;
  return status;
}

/* ---- factor ---------------------------------------------------------------------------------- */

/* Which particle and direction does a free unknown belong to? */
static void locate(const mps_elastic *e, int64_t unknown, int64_t *particle, int32_t *direction) {
  *particle = *direction = 0;
  for (int64_t k = 0; k < e->n * e->dim; k++)
    if (e->dof[k] == unknown) {
      *particle = k / e->dim;
      *direction = (int32_t)(k % e->dim);
    }
}

static mps_status diagnose(mps_elastic *e, const char *function, int64_t bad) {
  int64_t particle;
  int32_t direction;
  locate(e, bad, &particle, &direction);
  const mps_status status = mpsi_fail(
      e->context, function, MPS_ERROR_NUMERIC,
      "the stiffness matrix is not positive definite at direction %d of particle %lld although the "
      "supports prevent every rigid motion: a part of the body is joined by too few particles, or "
      "the stiffnesses differ by more than double precision can resolve",
      direction, (long long)e->id[particle]);
  mpsi_fail_where(e->context, -1, e->id[particle]);
  return status;
}

/* Adds shift * mass to the diagonal, the first entry of each column; `kept` receives the former
 * values. */
static void shift_diagonal(mps_elastic *e, double shift, double *kept) {
  for (int64_t i = 0; i < e->n; i++)
    for (int32_t c = 0; c < e->dim; c++) {
      const int64_t dof = e->dof[i * e->dim + c];
      if (dof < 0) continue;
      kept[dof] = e->value[e->column[dof]];
      e->value[e->column[dof]] += shift * e->mass[i];
    }
}

static mps_status factor(mps_elastic *e, const char *function, double shift) {
  if (e->factored && e->factored_shift == shift) return MPS_OK;
  const double start = now();
  double *kept = e->solution;
  int64_t bad;
  e->factored = false;
  if (shift != 0.0) shift_diagonal(e, shift, kept);
  const mpsi_matrix a = matrix(e);
  const mps_status status = mpsi_cholesky_factor(e->cholesky, function, &a, &bad);
  if (shift != 0.0)
    for (int64_t c = 0; c < e->unknowns; c++) e->value[e->column[c]] = kept[c];
  if (status != MPS_OK) return bad >= 0 ? diagnose(e, function, bad) : status;
  e->factored = true;
  e->factored_shift = shift;
  e->report.factorisations++;
  e->report.seconds_factor = now() - start;
  e->report.peak_bytes = mpsi_cholesky_peak_bytes(e->cholesky);
  const double rcond = mpsi_cholesky_rcond(e->cholesky);
  e->report.condition = rcond > 0.0 ? 1.0 / rcond : 0.0;
  return MPS_OK;
}

mps_status mpsi_elastic_factor(mps_elastic *e, const char *function, double shift) {
  e->shift = shift;
  e->by_cg = e->use_cg;
  return e->use_cg || e->unknowns == 0 ? MPS_OK : factor(e, function, shift);
}

/* The same for `count` load cases at rest. Whether a factor is there already makes no difference:
 * results do not depend on what was solved before. */
static mps_status prepare_cases(mps_elastic *e, const char *function, int64_t count) {
  if (!e->iterates || count >= FEW_CASES) return mpsi_elastic_factor(e, function, 0.0);
  e->shift = 0.0;
  e->by_cg = true;
  return MPS_OK;
}

mps_status mpsi_elastic_backsolve(mps_elastic *e, const char *function, int64_t count,
                                  const double *rhs, double *solution) {
  if (e->unknowns == 0) return MPS_OK;
  for (int64_t k = 0; k < count && e->by_cg; k++) {
    const int64_t at = k * e->unknowns;
    bool good = true;
    MPSI_TRY(mpsi_elastic_solved_outside(e)
                 ? mpsi_elastic_solve_outside(e, function, e->shift, rhs + at, solution + at)
                 : mpsi_elastic_cg(e, function, e->shift, rhs + at, solution + at,
                                   e->iterates ? &good : NULL));
    if (!good) { /* stiffnesses of many orders: the factor does not mind */
      MPSI_TRY(mpsi_elastic_factor(e, function, 0.0));
      return mpsi_cholesky_solve(e->cholesky, function, count - k, rhs + at, solution + at);
    }
  }
  if (e->by_cg) return MPS_OK;
  return mpsi_cholesky_solve(e->cholesky, function, count, rhs, solution);
}

/* ---- solution -------------------------------------------------------------------------------- */

static double norm(const double *v, int64_t n) {
  double sum = 0.0;
  for (int64_t i = 0; i < n; i++) sum += v[i] * v[i];
  return sqrt(sum);
}

/* work = load - K u; its free components to `out`. */
static mps_status residual(mps_elastic *e, const char *function, const double *load,
                           const double *u, double *out) {
  const mps_status status = mpsi_elastic_apply(e, function, u, e->work);
  for (int64_t k = 0; k < e->n * e->dim; k++) e->work[k] = load[k] - e->work[k];
  mpsi_elastic_reduce(e, e->work, out);
  return status;
}

/* Displacements u of `count` load cases; rhs and solution have room for them. */
static mps_status solve_block(mps_elastic *e, const char *function, int64_t count,
                              const double *loads, double *u, double *rhs, double *solution) {
  const int64_t all = e->n * e->dim;
  memset(u, 0, (size_t)(count * all) * sizeof *u);
  for (int64_t k = 0; k < count; k++) mpsi_elastic_expand(e, NULL, true, u + k * all);
  for (int32_t pass = 0; pass < (e->by_cg ? 1 : 1 + e->def.refinements); pass++) {
    mps_status status = MPS_OK;
    for (int64_t k = 0; k < count && status == MPS_OK; k++)
      status = residual(e, function, loads + k * all, u + k * all, rhs + k * e->unknowns);
    if (status == MPS_OK) status = mpsi_elastic_backsolve(e, function, count, rhs, solution);
    if (status != MPS_OK) return status;
    for (int64_t k = 0; k < count; k++)
      mpsi_elastic_expand(e, solution + k * e->unknowns, false, u + k * all);
  }
  for (int64_t k = 0; k < count * all; k++)
    if (!isfinite(u[k]))
      return mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                       "the displacement of particle %lld is %g: loads or stiffnesses are too "
                       "large for double precision",
                       (long long)e->id[k % all / e->dim], u[k]);
  return MPS_OK;
}

/* Energies are numbers. */
static mps_status check_work(const mps_elastic *e, const char *function, const double *u) {
  double sum = 0.0;
  for (int64_t k = 0; k < e->n * e->dim; k++) sum += fabs(u[k] * e->load[k]) + u[k] * u[k];
  if (isfinite(sum)) return MPS_OK;
  return mpsi_fail(e->context, function, MPS_ERROR_NUMERIC,
                   "the work of the loads is %g J, or a square of displacements beyond double "
                   "precision: loads are too large",
                   sum);
}

static int64_t nonzeros(const mps_elastic *e) {
  if (mpsi_elastic_solved_outside(e)) return e->outside.nonzeros;
  return e->column ? e->column[e->unknowns] : 0;
}

static int32_t solver_used(const mps_elastic *e) {
  if (mpsi_elastic_solved_outside(e)) return MPS_ELASTIC_SOLVER_FOREIGN;
  if (e->use_cg || e->iterates) return MPS_ELASTIC_SOLVER_CG;
  return e->def.solver == MPS_ELASTIC_SOLVER_AUTO ? MPS_ELASTIC_SOLVER_LLT : e->def.solver;
}

mps_status mps_elastic_analyse_sized(mps_elastic *e, mps_elastic_estimate *out, size_t size) {
  static const char function[] = "mps_elastic_analyse";
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_enter(e, function));
  mps_status status = mpsi_elastic_prepare(e, function);
  if (status != MPS_OK) return mpsi_elastic_leave(e, status);
  const mps_elastic_estimate found = {.unknowns = e->unknowns,
                                      .matrix_nonzeros = nonzeros(e),
                                      .factor_nonzeros = e->symbolic.nonzeros,
                                      .factor_flops = e->symbolic.flops,
                                      .factor_bytes = e->symbolic.bytes,
                                      .ordering = (int32_t)e->symbolic.ordering,
                                      .solver = solver_used(e)};
  return mpsi_elastic_leave(e,
                            mpsi_out_write(e->context, function, out, size, &found, sizeof found));
}

/* Scale of the residual: the load together with the forces of prescribed displacements. */
static mps_status residual_scale(mps_elastic *e, const char *function, double *u, double *scale) {
  memset(u, 0, (size_t)(e->n * e->dim) * sizeof *u);
  mpsi_elastic_expand(e, NULL, true, u);
  const mps_status status = residual(e, function, e->load, u, e->rhs);
  *scale = norm(e->rhs, e->unknowns);
  return status;
}

static mps_status solve(mps_elastic *e, const char *function, double *u, double **mass) {
  const int64_t all = e->n * e->dim;
  MPSI_TRY(mpsi_elastic_prepare(e, function));
  MPSI_TRY(mpsi_elastic_weigh(e, function, mass));
  MPSI_TRY(mpsi_elastic_drive(e, function, mpsi_elastic_time(e)));
  MPSI_TRY(mpsi_elastic_gather_loads(e, function, mpsi_elastic_time(e)));
  MPSI_TRY(prepare_cases(e, function, 1));
  const double start = now();
  e->report.iterations = 0;
  double scale;
  MPSI_TRY(residual_scale(e, function, u, &scale));
  MPSI_TRY(solve_block(e, function, 1, e->load, u, e->rhs, e->solution));
  MPSI_TRY(residual(e, function, e->load, u, e->rhs));
  MPSI_TRY(check_work(e, function, u));
  memcpy(e->displacement, u, (size_t)all * sizeof *u);
  e->report.residual = scale > 0.0 ? norm(e->rhs, e->unknowns) / scale : 0.0;
  for (int64_t k = 0; k < all; k++) e->reaction[k] = -e->work[k];
  mpsi_elastic_keep_fixed(e, e->reaction);
  e->report.seconds_solve = now() - start;
  mpsi_elastic_end_motion(e);
  mpsi_elastic_count_solution(e);
  MPSI_TRY(mpsi_elastic_write(e, function, "displacement", e->displacement, e->dim));
  return mpsi_elastic_write(e, function, "reaction", e->reaction, e->dim);
}

mps_status mps_elastic_solve(mps_elastic *e) {
  if (!e) return mpsi_null(__func__, "elastic");
  mps_status status = mpsi_elastic_enter(e, __func__);
  if (status != MPS_OK) return status;
  e->within = true;
  double *mass = e->mass, *u = mpsi_alloc(e->context, e->n * e->dim, sizeof *u);
  if (!u)
    status = mpsi_fail_memory(e->context, __func__, (size_t)(e->n * e->dim) * sizeof *u);
  else
    status = solve(e, __func__, u, &mass);
  mpsi_elastic_finish_mass(e, mass, status == MPS_OK);
  mpsi_free(e->context, u);
  return mpsi_elastic_leave(e, status);
}

/* Between the caller's order, three components a particle, and the solver's. */
static void sort_cases(const mps_elastic *e, int64_t count, double *ours, double *callers,
                       bool to_caller) {
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < e->n; i++) {
      const int64_t at = k * e->n + mps_particles_index(e->particles, e->id[i]);
      double *own = ours + (k * e->n + i) * e->dim, *other = callers + 3 * at;
      for (int c = 0; c < 3; c++) {
        if (to_caller)
          other[c] = c < e->dim ? own[c] : 0.0;
        else if (c < e->dim)
          own[c] = other[c];
      }
    }
}

void mpsi_elastic_to_caller(const mps_elastic *e, int64_t count, double *ours, double *out) {
  sort_cases(e, count, ours, out, true);
}

static mps_status solve_cases(mps_elastic *e, const char *function, int64_t count,
                              const double *loads, double *displacements) {
  const int64_t all = e->n * e->dim, block = count < CASES_AT_ONCE ? count : CASES_AT_ONCE;
  mps_status status = mpsi_elastic_prepare(e, function);
  if (status == MPS_OK) status = mpsi_elastic_drive(e, function, mpsi_elastic_time(e));
  if (status == MPS_OK) status = prepare_cases(e, function, count);
  if (status != MPS_OK || count == 0) return status;
  const int64_t words = 2 * block * (e->unknowns + all);
  double *rhs = mpsi_alloc(e->context, words, sizeof *rhs);
  if (!rhs) return mpsi_fail_memory(e->context, function, (size_t)words * sizeof *rhs);
  double *solution = rhs + block * e->unknowns, *load = solution + block * e->unknowns;
  double *u = load + block * all;
  for (int64_t k = 0; k < count && status == MPS_OK; k += block) {
    const int64_t some = count - k < block ? count - k : block;
    sort_cases(e, some, load, (double *)loads + k * e->n * 3, false);
    status = solve_block(e, function, some, load, u, rhs, solution);
    if (status == MPS_OK) sort_cases(e, some, u, displacements + k * e->n * 3, true);
  }
  mpsi_free(e->context, rhs);
  return status;
}

static mps_status check_cases(const mps_elastic *e, const char *function, int64_t count,
                              const double *loads, const double *displacements) {
  if (count < 0)
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && (!loads || !displacements))
    return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     loads ? "displacements" : "loads");
  for (int64_t k = 0; k < count * e->n * 3; k++)
    if (k % 3 < e->dim && !isfinite(loads[k]))
      return mpsi_fail(e->context, function, MPS_ERROR_ARGUMENT,
                       "loads[%lld] is %g, must be finite (N)", (long long)k, loads[k]);
  return MPS_OK;
}

mps_status mps_elastic_solve_cases(mps_elastic *e, int64_t count, const double *loads,
                                   double *displacements) {
  if (!e) return mpsi_null(__func__, "elastic");
  MPSI_TRY(mpsi_elastic_enter(e, __func__));
  e->within = true;
  mps_status status = check_cases(e, __func__, count, loads, displacements);
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "count", (double)count);
  mpsi_give_bytes(&given, "a hash of loads", status == MPS_OK ? loads : NULL,
                  status == MPS_OK ? (size_t)(count * e->n) * 3 * sizeof *loads : 0);
  status = mpsi_elastic_agree_given(e, __func__, status, &given);
  if (status == MPS_OK) status = solve_cases(e, __func__, count, loads, displacements);
  return mpsi_elastic_leave(e, status);
}

mps_status mps_elastic_get_report_sized(const mps_elastic *e, mps_elastic_report *out,
                                        size_t size) {
  static const char function[] = "mps_elastic_get_report";
  if (!e) return mpsi_null(__func__, "elastic");
  mps_elastic_report r = e->report;
  r.unknowns = e->unknowns;
  r.matrix_nonzeros = nonzeros(e);
  r.factor_nonzeros = e->symbolic.nonzeros;
  r.factor_flops = e->symbolic.flops;
  r.ordering = (int32_t)e->symbolic.ordering;
  r.solver = solver_used(e);
  r.factor_bytes =
      e->use_cg ? 16.0 * (double)r.matrix_nonzeros + 48.0 * (double)e->unknowns : e->symbolic.bytes;
  return mpsi_out_write(e->context, function, out, size, &r, sizeof r);
}
