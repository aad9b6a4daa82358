/* equation.h - symmetric positive definite systems solved by PETSc, in one process or on all of a
 * communicator. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "guest.h"

#include <stdbool.h>

struct mps_petsc_solver {
  mps_context *context; /* for records */
  int32_t method;       /* mps_petsc_method */
  MPI_Comm comm;
  int rank, size;
  PetscReal patience;  /* s: how long one that has failed waits for the others */
  MPI_Request request; /* of the agreement under way */
  int worst;           /* of all processes, in that; written until all have joined it */
  KSP ksp;
  Mat matrix; /* the last one */
  Vec x, b;   /* without values of their own */
  int64_t all, rows;
  bool forgets;         /* the next matrix is as the first one */
  int32_t modes;        /* of the last one */
  bool fresh;           /* the preconditioner is of the last matrix */
  PetscInt first_count; /* iterations of its first solution, when it was fresh */
};

/* The matrix is copied. Collective, as the solution is. */
mps_status mpsi_petsc_take(mps_petsc_solver *s, const mps_linear_matrix *a);
/* Nothing of former equations serves any more. */
void mpsi_petsc_forget(mps_petsc_solver *s);
/* This rank's rows: x is a start and receives the solution, |b - A x| <= tolerance |b|. */
mps_status mpsi_petsc_solve(mps_petsc_solver *s, const double *b, double tolerance, double *x,
                            int64_t *iterations);
