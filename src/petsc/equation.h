/* equation.h - symmetric positive definite systems solved by PETSc, in one process or on all of a
 * communicator. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_PETSC_EQUATION_H
#define MPSI_PETSC_EQUATION_H

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
  int64_t all, first, rows;
  int *counts, *places; /* of the parts of all ranks */
  bool forgets;         /* the next matrix is as the first one */
  int32_t modes;        /* of the last one */
  bool fresh;           /* the preconditioner is of the last matrix */
  PetscInt first_count; /* iterations of its first solution, when it was fresh */
};

/* Rows [first, first + rows) of A, with both halves, ascending columns and the diagonal; it is
 * copied. Collective, as the solution is. */
typedef struct mpsi_petsc_matrix {
  int64_t all, first, rows, block; /* block: rows of a node, which follow one another */
  const int64_t *start;
  const int32_t *column;
  const double *value;
  int32_t modes;      /* motions that cost hardly any energy; 0: constants */
  const double *mode; /* `rows` values each */
} mpsi_petsc_matrix;

/* The record of a solver whose processes are not the ranks of what it is to solve. */
mps_status mpsi_petsc_refuse_ranks(const mps_petsc_solver *s, const char *function, int32_t ranks);
mps_status mpsi_petsc_take(mps_petsc_solver *s, const mpsi_petsc_matrix *a);
/* Nothing of former equations serves any more. */
void mpsi_petsc_forget(mps_petsc_solver *s);
/* x holds a start and receives the solution, both of all rows: |b - A x| <= tolerance |b|. Of b and
 * of the start only this rank's rows are read. */
mps_status mpsi_petsc_solve(mps_petsc_solver *s, const double *b, double tolerance, double *x,
                            int64_t *iterations);

#endif
