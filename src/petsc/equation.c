/* equation.c - symmetric positive definite systems: conjugate gradients with an algebraic multigrid
 * by smoothed aggregation (GAMG), or a Cholesky factor by MUMPS.
 *
 * A multigrid costs as much to make as several iterations, and equations that follow one another
 * (steps of a fluid) differ little: that of a former equation serves until a solution takes half as
 * many iterations again as the first one took. Iterations end on the norm of b - A x itself, not on
 * the preconditioned one. SPDX-License-Identifier: BSD-3-Clause */
#include "equation.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define FUNCTION "mps_petsc_solver" /* in records */
#define MOST 1000                   /* iterations */
#define PATIENCE 60.0               /* s, unless PETSc's option -mps_patience says otherwise */
/* Entries below this part of their diagonals bind no unknowns together. A row of elasticity reaches
 * three particles far, most of it weakly: .05 leaves so few bonds that aggregates have 14 particles
 * and the next level's matrix twice the entries of the first; .02 makes them 70 and the sum of all
 * levels 1.14 of the first, for 28 iterations instead of 18.
 *
 * In space smoothed aggregates reach so far beyond themselves that the product of matrix and
 * prolongation, which several processes make as a whole, has three times the matrix's entries.
 * Plain aggregates with two cycles on each coarser level (a W cycle) take half the memory and
 * less time for 1.5 times the iterations.
 * PETSc's options -mps_pc_gamg_agg_nsmooths 1 -mps_pc_mg_cycle_type v smooth them. */
#define WEAK 0.05
#define WEAK_OF_BODIES 0.02

/* The others do not come: they wait for this one within PETSc, where nothing reaches them. */
static mps_status give_up(const mps_petsc_solver *s, mps_status status) {
  char what[200];
  mpsi_petsc_strand();
  snprintf(what, sizeof what,
           "PETSc has failed on rank %d and the other ranks wait for it there: this process must "
           "end, and with it the run",
           s->rank);
  return mpsi_petsc_fail(s->context, FUNCTION, status, what);
}

/* The worst status of all processes: after what they have done together, and before. Where all have
 * failed all arrive here; one that has failed alone does not wait for ever. `what` has failed here,
 * if anything has. */
static mps_status agree(mps_petsc_solver *s, const char *what, mps_status status) {
  int here = 0;
  const double began = MPI_Wtime();
  s->worst = (int)status;
  if (MPI_Iallreduce(MPI_IN_PLACE, &s->worst, 1, MPI_INT, MPI_MAX, s->comm, &s->request) != 0)
    return mpsi_petsc_fail(s->context, FUNCTION, MPS_ERROR_IO, "MPI_Iallreduce has failed");
  while (status != MPS_OK && !here) {
    const struct timespec nap = {.tv_nsec = 1000000};
    if (MPI_Test(&s->request, &here, MPI_STATUS_IGNORE) != 0) return MPS_ERROR_IO;
    if (!here) (void)nanosleep(&nap, NULL);
    if (!here && MPI_Wtime() - began > s->patience) return give_up(s, status);
  }
  if (!here && MPI_Wait(&s->request, MPI_STATUS_IGNORE) != 0)
    return mpsi_petsc_fail(s->context, FUNCTION, MPS_ERROR_IO, "MPI_Wait has failed");
  if (s->worst == MPS_OK) return MPS_OK;
  return mpsi_petsc_fail(s->context, FUNCTION, (mps_status)s->worst,
                         status != MPS_OK ? what : "PETSc has failed on another rank");
}

/* ---- life ------------------------------------------------------------------------------------ */

/* MUMPS estimates the memory of a factor, and fails where several processes need more than that and
 * 20 % (PETSc's option -mps_mat_mumps_icntl_14): small matrices with full rows do. */
static bool widen_factor(void) {
  PetscBool chosen = PETSC_FALSE;
  return PetscOptionsHasName(NULL, "mps_", "-mat_mumps_icntl_14", &chosen) == 0 &&
         (chosen || PetscOptionsSetValue(NULL, "-mps_mat_mumps_icntl_14", "100") == 0);
}

static bool configure(mps_petsc_solver *s) {
  PC pc;
  PetscReal weak = s->modes > 0 ? WEAK_OF_BODIES : WEAK;
  bool good = KSPCreate(s->comm, &s->ksp) == 0 && KSPGetPC(s->ksp, &pc) == 0;
  if (s->method == MPS_PETSC_METHOD_DIRECT)
    good = good && widen_factor() && KSPSetType(s->ksp, KSPPREONLY) == 0 &&
           PCSetType(pc, PCCHOLESKY) == 0 && PCFactorSetMatSolverType(pc, MATSOLVERMUMPS) == 0;
  else {
    good = good && KSPSetType(s->ksp, KSPCG) == 0 && PCSetType(pc, PCGAMG) == 0 &&
           KSPSetNormType(s->ksp, KSP_NORM_UNPRECONDITIONED) == 0 &&
           KSPSetInitialGuessNonzero(s->ksp, PETSC_TRUE) == 0 &&
           PCGAMGSetThreshold(pc, &weak, 1) == 0;
    if (s->modes == 6) good = good && PCGAMGSetNSmooths(pc, 0) == 0;
  }
  return good && KSPSetOptionsPrefix(s->ksp, "mps_") == 0 && KSPSetFromOptions(s->ksp) == 0;
}

static mps_status create(mps_context *context, const char *function, int32_t method,
                         MPI_Comm communicator, mps_petsc_solver **out) {
  mps_petsc_solver *s = calloc(1, sizeof *s);
  mps_status status = s ? mpsi_petsc_duplicate(context, function, communicator, &s->comm)
                        : mpsi_petsc_fail(context, function, MPS_ERROR_MEMORY, "no memory is left");
  if (status != MPS_OK) {
    free(s);
    mpsi_petsc_leave();
    return status;
  }
  (void)MPI_Comm_rank(s->comm, &s->rank);
  (void)MPI_Comm_size(s->comm, &s->size);
  s->context = context;
  s->method = method;
  s->patience = PATIENCE;
  (void)PetscOptionsGetReal(NULL, "mps_", "-patience", &s->patience, NULL);
  *out = s;
  mpsi_petsc_listen();
  status = agree(s, "PETSc lacks the method or refuses an option",
                 configure(s) ? MPS_OK : MPS_ERROR_UNSUPPORTED);
  if (status != MPS_OK) mps_petsc_solver_destroy(out);
  return status;
}

static mps_status check(mps_context *context, const char *function, int32_t method,
                        mps_petsc_solver **out) {
  char line[120];
  if (!context) return mps_context_set_error(NULL, MPS_ERROR_ARGUMENT, function, "context is NULL");
  if (!out) return mps_context_set_error(context, MPS_ERROR_ARGUMENT, function, "out is NULL");
  *out = NULL;
  snprintf(line, sizeof line,
           "method is %d, allowed are MPS_PETSC_METHOD_MULTIGRID and MPS_PETSC_METHOD_DIRECT",
           (int)method);
  if (method != MPS_PETSC_METHOD_MULTIGRID && method != MPS_PETSC_METHOD_DIRECT)
    return mps_context_set_error(context, MPS_ERROR_ARGUMENT, function, line);
  const mps_status status = mpsi_petsc_enter();
  return status == MPS_OK
             ? MPS_OK
             : mpsi_petsc_fail(context, function, status, "MPI or PETSc cannot be started");
}

mps_status mps_petsc_solver_create(mps_context *context, int32_t method, mps_petsc_solver **out) {
  const mps_status status = check(context, __func__, method, out);
  return status == MPS_OK ? create(context, __func__, method, PETSC_COMM_SELF, out) : status;
}

mps_status mps_petsc_solver_create_world(mps_context *context, int32_t method,
                                         mps_petsc_solver **out) {
  const mps_status status = check(context, __func__, method, out);
  return status == MPS_OK ? create(context, __func__, method, MPI_COMM_WORLD, out) : status;
}

mps_status mps_petsc_solver_create_c2f(mps_context *context, int32_t method, int32_t communicator,
                                       mps_petsc_solver **out) {
  int running = 0;
  if (context && (MPI_Initialized(&running) != 0 || !running))
    return mps_context_set_error(context, MPS_ERROR_STATE, __func__, "MPI is not running");
  const mps_status status = check(context, __func__, method, out);
  return status == MPS_OK
             ? create(context, __func__, method, MPI_Comm_f2c((MPI_Fint)communicator), out)
             : status;
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
  if (mpsi_petsc_stranded()) { /* PETSc's objects and the agreement are still in use by others */
    mpsi_petsc_leave();
    return;
  }
  (void)KSPDestroy(&s->ksp);
  drop(s);
  (void)MPI_Comm_free(&s->comm);
  free(s);
  mpsi_petsc_leave();
}

/* ---- matrix ---------------------------------------------------------------------------------- */

/* The rows with PETSc's integers, which may not be ours. */
typedef struct indices {
  PetscInt *start;
  const PetscInt *column; /* where they are as wide as ours: ours */
  PetscInt *copy;         /* or a copy */
} indices;

static mps_status convert(const mps_linear_matrix *a, indices *x) {
  const int64_t entries = a->start[a->rows];
  if (entries > PETSC_MAX_INT) return MPS_ERROR_UNSUPPORTED;
  x->start = malloc((size_t)(a->rows + 1) * sizeof *x->start);
  if (!x->start) return MPS_ERROR_MEMORY;
  for (int64_t i = 0; i <= a->rows; i++) x->start[i] = (PetscInt)a->start[i];
  x->column = (const PetscInt *)a->column;
  if (sizeof(PetscInt) == sizeof *a->column) return MPS_OK;
  x->copy = malloc((size_t)(entries + 1) * sizeof *x->copy);
  if (!x->copy) return MPS_ERROR_MEMORY;
  for (int64_t k = 0; k < entries; k++) x->copy[k] = (PetscInt)a->column[k];
  x->column = x->copy;
  return MPS_OK;
}

/* PETSc copies the three arrays. Of the two the one that is not of the matrix's type does nothing.
 */
static bool fill(Mat matrix, const indices *x, const double *value) {
  return MatSeqAIJSetPreallocationCSR(matrix, x->start, x->column, value) == 0 &&
         MatMPIAIJSetPreallocationCSR(matrix, x->start, x->column, value) == 0;
}

/* Orthonormal, as PETSc requires null spaces; motions that supports leave nothing of are left out.
 */
static bool add_modes(const mps_petsc_solver *s, const mps_linear_matrix *a) {
  Vec mode[6] = {NULL};
  PetscInt found = 0;
  MatNullSpace space = NULL;
  bool good = a->modes <= 6;
  for (int32_t m = 0; good && m < a->modes; m++) {
    PetscScalar *values = NULL;
    PetscReal size = 0.0, left = 0.0;
    good =
        MatCreateVecs(s->matrix, NULL, &mode[found]) == 0 && VecGetArray(mode[found], &values) == 0;
    for (int64_t i = 0; good && i < a->rows; i++) values[i] = a->mode[m * a->rows + i];
    good = good && VecRestoreArray(mode[found], &values) == 0 &&
           VecNorm(mode[found], NORM_2, &size) == 0;
    for (PetscInt k = 0; good && k < found; k++) {
      PetscScalar along = 0.0;
      good =
          VecDot(mode[found], mode[k], &along) == 0 && VecAXPY(mode[found], -along, mode[k]) == 0;
    }
    good = good && VecNormalize(mode[found], &left) == 0;
    if (left > 1e-6 * size)
      found++;
    else
      good = VecDestroy(&mode[found]) == 0 && good;
  }
  good = good && MatNullSpaceCreate(s->comm, PETSC_FALSE, found, mode, &space) == 0 &&
         MatSetNearNullSpace(s->matrix, space) == 0;
  (void)MatNullSpaceDestroy(&space);
  for (int32_t m = 0; m < 6; m++) (void)VecDestroy(&mode[m]);
  return good;
}

static bool make_vector(const mps_petsc_solver *s, const mps_linear_matrix *a, Vec *v) {
  const PetscInt block = (PetscInt)a->block, rows = (PetscInt)a->rows, all = (PetscInt)a->all;
  if (s->size > 1) return VecCreateMPIWithArray(s->comm, block, rows, all, NULL, v) == 0;
  return VecCreateSeqWithArray(s->comm, block, rows, NULL, v) == 0;
}

static bool make_matrix(mps_petsc_solver *s, const mps_linear_matrix *a, const indices *x) {
  const PetscInt rows = (PetscInt)a->rows, all = (PetscInt)a->all, block = (PetscInt)a->block;
  const int64_t former = s->all;
  drop(s);
  s->all = 0;
  bool good =
      MatCreate(s->comm, &s->matrix) == 0 && MatSetSizes(s->matrix, rows, rows, all, all) == 0 &&
      MatSetType(s->matrix, s->size > 1 ? MATMPIAIJ : MATSEQAIJ) == 0 &&
      MatSetBlockSize(s->matrix, block) == 0 && fill(s->matrix, x, a->value) &&
      MatSetOption(s->matrix, MAT_SPD, PETSC_TRUE) == 0 && (a->modes == 0 || add_modes(s, a)) &&
      make_vector(s, a, &s->x) && make_vector(s, a, &s->b);
  if (good && (s->forgets || a->all != former || a->rows != s->rows || a->modes != s->modes)) {
    s->forgets = false;
    s->modes = a->modes;
    s->first_count = 0; /* what GAMG keeps after a reset is of the former size */
    good = KSPDestroy(&s->ksp) == 0 && configure(s);
  }
  return good && KSPSetOperators(s->ksp, s->matrix, s->matrix) == 0;
}

void mpsi_petsc_forget(mps_petsc_solver *s) { s->forgets = true; }

mps_status mpsi_petsc_take(mps_petsc_solver *s, const mps_linear_matrix *a) {
  indices x = {NULL, NULL, NULL};
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  mpsi_petsc_listen();
  mps_status status = agree(s, "the matrix has no room", convert(a, &x));
  if (status == MPS_OK)
    status =
        agree(s, "PETSc cannot make the matrix", make_matrix(s, a, &x) ? MPS_OK : MPS_ERROR_MEMORY);
  free(x.start);
  free(x.copy);
  if (status != MPS_OK) return status;
  s->fresh = false;
  s->all = a->all, s->rows = a->rows;
  return MPS_OK;
}

/* ---- solution -------------------------------------------------------------------------------- */

/* The cycle of bodies in space, unless PETSc's options say otherwise; levels must be there. */
static bool choose_cycle(const mps_petsc_solver *s) {
  PC pc;
  PetscBool chosen = PETSC_FALSE, ours = PETSC_FALSE;
  if (s->modes != 6) return true;
  if (KSPGetPC(s->ksp, &pc) != 0 ||
      PetscOptionsHasName(NULL, "mps_", "-pc_mg_cycle_type", &chosen) != 0 ||
      PetscObjectTypeCompare((PetscObject)pc, PCGAMG, &ours) != 0)
    return false;
  return chosen || !ours || (KSPSetUp(s->ksp) == 0 && PCMGSetCycleType(pc, PC_MG_CYCLE_W) == 0);
}

/* One run of the Krylov method from s->x on, at most `most` iterations. */
static mps_status iterate(mps_petsc_solver *s, bool keep, double tolerance, PetscInt most,
                          PetscInt *count, bool *converged) {
  KSPConvergedReason reason = 0;
  if (KSPSetTolerances(s->ksp, tolerance, 0.0, 1e10, most) != 0 ||
      KSPSetReusePreconditioner(s->ksp, keep ? PETSC_TRUE : PETSC_FALSE) != 0 || !choose_cycle(s) ||
      KSPSolve(s->ksp, s->b, s->x) != 0 || KSPGetConvergedReason(s->ksp, &reason) != 0 ||
      KSPGetIterationNumber(s->ksp, count) != 0)
    return MPS_ERROR_NUMERIC;
  *converged = reason > 0;
  return MPS_OK;
}

static mps_status solve(mps_petsc_solver *s, double tolerance, int64_t *iterations) {
  const PetscInt patience = s->first_count + s->first_count / 2 + 2;
  PetscInt count = 0;
  bool converged = false;
  mps_status status = MPS_OK;
  if (s->fresh || (s->method == MPS_PETSC_METHOD_MULTIGRID && s->first_count > 0)) {
    status = iterate(s, true, tolerance, s->fresh ? MOST : patience, &count, &converged);
    *iterations += count;
    if (status != MPS_OK || converged) return status;
    if (s->fresh) return MPS_ERROR_NUMERIC;
  }
  status = iterate(s, false, tolerance, MOST, &count, &converged);
  *iterations += count;
  s->fresh = status == MPS_OK;
  if (s->fresh) s->first_count = count > 1 ? count : 1;
  return status == MPS_OK && !converged ? MPS_ERROR_NUMERIC : status;
}

mps_status mpsi_petsc_solve(mps_petsc_solver *s, const double *b, double tolerance, double *x,
                            int64_t *iterations) {
  int nothing = 1, mine = 1;
  if (s->all == 0) return MPS_ERROR_STATE;
  if (mpsi_petsc_stranded()) return MPS_ERROR_IO;
  mpsi_petsc_listen();
  for (int64_t i = 0; i < s->rows; i++) mine = mine && b[i] == 0.0;
  if (MPI_Allreduce(&mine, &nothing, 1, MPI_INT, MPI_LAND, s->comm) != 0) return MPS_ERROR_IO;
  if (nothing) {
    for (int64_t i = 0; i < s->rows; i++) x[i] = 0.0;
    return MPS_OK;
  }
  if (VecPlaceArray(s->b, b) != 0 || VecPlaceArray(s->x, x) != 0) return MPS_ERROR_INTERNAL;
  /* Slightly below the tolerance: the norm that the iteration carries on drifts. */
  const mps_status status = agree(s, "PETSc has failed, or its iterations do not converge",
                                  solve(s, 0.9 * tolerance, iterations));
  (void)VecResetArray(s->b);
  (void)VecResetArray(s->x);
  return status;
}
