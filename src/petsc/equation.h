/* equation.h - symmetric positive definite systems of one process, solved by PETSc.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_PETSC_EQUATION_H
#define MPSI_PETSC_EQUATION_H

#include "guest.h"

#include <stdbool.h>

struct mps_petsc_solver {
  int32_t method; /* mps_petsc_method */
  KSP ksp;
  Mat matrix; /* the last one */
  Vec x, b;   /* without values of their own */
  PetscInt rows;
  bool fresh;     /* the preconditioner is of the last matrix */
  PetscInt first; /* iterations of its first solution, when it was fresh */
};

/* A by rows, with both halves, ascending columns and the diagonal; it is copied. */
typedef struct mpsi_petsc_matrix {
  int64_t rows, block; /* rows of a node, which follow one another */
  const int64_t *start;
  const int32_t *column;
  const double *value;
  int32_t modes; /* that cost hardly any energy, `rows` values each, orthonormal; 0: constants */
  const double *mode;
} mpsi_petsc_matrix;

mps_status mpsi_petsc_take(mps_petsc_solver *s, const mpsi_petsc_matrix *a);
/* x holds a start and receives the solution: |b - A x| <= tolerance |b|. */
mps_status mpsi_petsc_solve(mps_petsc_solver *s, const double *b, double tolerance, double *x,
                            int64_t *iterations);

#endif
