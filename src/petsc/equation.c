/* equation.c - symmetric positive definite systems of one process: conjugate gradients with an
 * algebraic multigrid by smoothed aggregation (GAMG), or a Cholesky factor by MUMPS.
 *
 * A multigrid costs as much to make as several iterations, and equations that follow one another
 * (steps of a fluid) differ little: that of a former equation serves until a solution takes half as
 * many iterations again as the first one took. Iterations end on the norm of b - A x itself, not on
 * the preconditioned one. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

#include <stdlib.h>

#define MOST 1000 /* iterations */
#define WEAK 0.05 /* entries below this part of their diagonals bind no unknowns together */

/* ---- life ------------------------------------------------------------------------------------ */

static bool configure(mps_petsc_solver *s) {
  PC pc;
  PetscReal weak = WEAK;
  bool good = KSPCreate(PETSC_COMM_SELF, &s->ksp) == 0 && KSPGetPC(s->ksp, &pc) == 0;
  if (s->method == MPS_PETSC_DIRECT)
    good = good && KSPSetType(s->ksp, KSPPREONLY) == 0 && PCSetType(pc, PCCHOLESKY) == 0 &&
           PCFactorSetMatSolverType(pc, MATSOLVERMUMPS) == 0;
  else
    good = good && KSPSetType(s->ksp, KSPCG) == 0 && PCSetType(pc, PCGAMG) == 0 &&
           KSPSetNormType(s->ksp, KSP_NORM_UNPRECONDITIONED) == 0 &&
           KSPSetInitialGuessNonzero(s->ksp, PETSC_TRUE) == 0 &&
           PCGAMGSetThreshold(pc, &weak, 1) == 0;
  return good && KSPSetOptionsPrefix(s->ksp, "mps_") == 0 && KSPSetFromOptions(s->ksp) == 0;
}

mps_status mps_petsc_solver_create(int32_t method, mps_petsc_solver **out) {
  if (!out) return MPS_ERROR_ARGUMENT;
  *out = NULL;
  if (method != MPS_PETSC_MULTIGRID && method != MPS_PETSC_DIRECT) return MPS_ERROR_ARGUMENT;
  mps_petsc_solver *s = calloc(1, sizeof *s);
  if (!s) return MPS_ERROR_MEMORY;
  const mps_status status = mpsi_petsc_enter();
  if (status != MPS_OK) {
    free(s);
    return status;
  }
  s->method = method;
  *out = s;
  if (configure(s)) return MPS_OK;
  mps_petsc_solver_destroy(out);
  return MPS_ERROR_UNSUPPORTED;
}

static void drop(mps_petsc_solver *s) {
  (void)MatDestroy(&s->matrix);
  (void)VecDestroy(&s->x);
  (void)VecDestroy(&s->b);
}

void mps_petsc_solver_destroy(mps_petsc_solver **solver) {
  if (!solver || !*solver) return;
  mps_petsc_solver *s = *solver;
  *solver = NULL;
  (void)KSPDestroy(&s->ksp);
  drop(s);
  free(s);
  mpsi_petsc_leave();
}

/* ---- matrix ---------------------------------------------------------------------------------- */

/* PETSc copies the three arrays; where its integers are not ours they are copied twice. */
static bool fill(Mat matrix, const mpsi_petsc_matrix *a) {
  const int64_t entries = a->start[a->rows];
  PetscInt *start = malloc((size_t)(a->rows + 1) * sizeof *start);
  PetscInt *column = malloc((size_t)(entries + 1) * sizeof *column);
  if (start && column) {
    for (int64_t i = 0; i <= a->rows; i++) start[i] = (PetscInt)a->start[i];
    for (int64_t k = 0; k < entries; k++) column[k] = (PetscInt)a->column[k];
  }
  const bool good =
      start && column && MatSeqAIJSetPreallocationCSR(matrix, start, column, a->value) == 0;
  free(start);
  free(column);
  return good;
}

static bool add_modes(Mat matrix, const mpsi_petsc_matrix *a) {
  Vec mode[6] = {NULL};
  MatNullSpace space = NULL;
  bool good = a->modes <= 6;
  for (int32_t m = 0; good && m < a->modes; m++)
    good = VecCreateSeqWithArray(PETSC_COMM_SELF, (PetscInt)a->block, (PetscInt)a->rows,
                                 a->mode + m * a->rows, &mode[m]) == 0;
  good = good && MatNullSpaceCreate(PETSC_COMM_SELF, PETSC_FALSE, a->modes, mode, &space) == 0 &&
         MatSetNearNullSpace(matrix, space) == 0;
  (void)MatNullSpaceDestroy(&space);
  for (int32_t m = 0; m < 6; m++) (void)VecDestroy(&mode[m]);
  return good;
}

mps_status mpsi_petsc_take(mps_petsc_solver *s, const mpsi_petsc_matrix *a) {
  if (a->start[a->rows] > PETSC_MAX_INT) return MPS_ERROR_UNSUPPORTED;
  const PetscInt rows = (PetscInt)a->rows, former = s->rows, block = (PetscInt)a->block;
  drop(s);
  s->rows = 0;
  bool good = MatCreate(PETSC_COMM_SELF, &s->matrix) == 0 &&
              MatSetSizes(s->matrix, rows, rows, rows, rows) == 0 &&
              MatSetType(s->matrix, MATSEQAIJ) == 0 && MatSetBlockSize(s->matrix, block) == 0 &&
              fill(s->matrix, a) && MatSetOption(s->matrix, MAT_SPD, PETSC_TRUE) == 0 &&
              (a->modes == 0 || add_modes(s->matrix, a)) &&
              VecCreateSeqWithArray(PETSC_COMM_SELF, block, rows, NULL, &s->x) == 0 &&
              VecCreateSeqWithArray(PETSC_COMM_SELF, block, rows, NULL, &s->b) == 0;
  if (good && rows != former) {
    s->first = 0; /* no preconditioner yet: what GAMG keeps after a reset is of the former size */
    good = KSPDestroy(&s->ksp) == 0 && configure(s);
  }
  good = good && KSPSetOperators(s->ksp, s->matrix, s->matrix) == 0;
  if (!good) return MPS_ERROR_MEMORY;
  s->fresh = false;
  s->rows = rows;
  return MPS_OK;
}

/* ---- solution -------------------------------------------------------------------------------- */

/* One run of the Krylov method from s->x on, at most `most` iterations. */
static mps_status iterate(mps_petsc_solver *s, bool keep, double tolerance, PetscInt most,
                          PetscInt *count, bool *converged) {
  KSPConvergedReason reason = 0;
  if (KSPSetTolerances(s->ksp, tolerance, 0.0, 1e10, most) != 0 ||
      KSPSetReusePreconditioner(s->ksp, keep ? PETSC_TRUE : PETSC_FALSE) != 0 ||
      KSPSolve(s->ksp, s->b, s->x) != 0 || KSPGetConvergedReason(s->ksp, &reason) != 0 ||
      KSPGetIterationNumber(s->ksp, count) != 0)
    return MPS_ERROR_NUMERIC;
  *converged = reason > 0;
  return MPS_OK;
}

static mps_status solve(mps_petsc_solver *s, double tolerance, int64_t *iterations) {
  const PetscInt patience = s->first + s->first / 2 + 2;
  PetscInt count = 0;
  bool converged = false;
  mps_status status = MPS_OK;
  if (s->fresh || (s->method == MPS_PETSC_MULTIGRID && s->first > 0)) {
    status = iterate(s, true, tolerance, s->fresh ? MOST : patience, &count, &converged);
    *iterations += count;
    if (status != MPS_OK || converged) return status;
    if (s->fresh) return MPS_ERROR_NUMERIC;
  }
  status = iterate(s, false, tolerance, MOST, &count, &converged);
  *iterations += count;
  s->fresh = status == MPS_OK;
  if (s->fresh) s->first = count > 1 ? count : 1;
  return status == MPS_OK && !converged ? MPS_ERROR_NUMERIC : status;
}

mps_status mpsi_petsc_solve(mps_petsc_solver *s, const double *b, double tolerance, double *x,
                            int64_t *iterations) {
  double size = 0.0;
  if (s->rows == 0) return MPS_ERROR_STATE;
  for (PetscInt i = 0; i < s->rows; i++) size += b[i] * b[i];
  if (size == 0.0) {
    for (PetscInt i = 0; i < s->rows; i++) x[i] = 0.0;
    return MPS_OK;
  }
  if (VecPlaceArray(s->b, b) != 0 || VecPlaceArray(s->x, x) != 0) return MPS_ERROR_INTERNAL;
  /* A little closer than asked for: the norm that the iteration carries on drifts. */
  const mps_status status = solve(s, 0.9 * tolerance, iterations);
  (void)VecResetArray(s->b);
  (void)VecResetArray(s->x);
  return status;
}
