/* cholesky.h - interface to a sparse Cholesky library. Only cholesky.c depends on CHOLMOD. Matrices
 * are symmetric: lower triangle in compressed columns, rows ascending.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

typedef struct mpsi_cholesky mpsi_cholesky;

typedef enum mpsi_ordering { MPSI_ORDER_BEST, MPSI_ORDER_AMD, MPSI_ORDER_METIS } mpsi_ordering;

typedef struct mpsi_matrix {
  int64_t n;
  const int64_t *column; /* n + 1 */
  const int64_t *row;
  const double *value;
} mpsi_matrix;

typedef struct mpsi_cholesky_symbolic {
  int64_t nonzeros; /* of L */
  double flops;
  double bytes; /* of the numerical factor */
  mpsi_ordering ordering;
} mpsi_cholesky_symbolic;

/* One CHOLMOD workspace. */
mps_status mpsi_cholesky_create(mps_context *context, const char *function, mpsi_ordering ordering,
                                bool ldlt, int32_t threads, mpsi_cholesky **out);
void mpsi_cholesky_destroy(mpsi_cholesky **cholesky);
/* Orders and analyses the pattern; drops a former factor. group[c], ascending from 0, is the node
 * (particle) that unknown c belongs to: the ordering is found on the graph of the `groups` nodes,
 * which is several times smaller, and their unknowns stay together. */
mps_status mpsi_cholesky_analyse(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                                 const int64_t *group, int64_t groups, mpsi_cholesky_symbolic *out);
/* Factorises values on the analysed pattern.
 * Not positive definite: MPS_ERROR_NUMERIC with *bad the row of the first pivot <= 0 (else -1). */
mps_status mpsi_cholesky_factor(mpsi_cholesky *c, const char *function, const mpsi_matrix *a,
                                int64_t *bad);
/* x = A^-1 b, count columns of n. */
mps_status mpsi_cholesky_solve(mpsi_cholesky *c, const char *function, int64_t count,
                               const double *b, double *x);
/* Reciprocal condition estimate from the factor's diagonal (crude, 0 without factor). */
double mpsi_cholesky_rcond(mpsi_cholesky *c);
double mpsi_cholesky_peak_bytes(const mpsi_cholesky *c);
