/* outside.h - a solver of the caller.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_ELASTIC_OUTSIDE_H
#define MPSI_ELASTIC_OUTSIDE_H

#include <mps/elastic_solver.h>

#include <stdbool.h>

/* A solver of the caller. */
typedef struct mpsi_elastic_outside {
  mps_elastic_solver_def def;
  bool valid;      /* its matrix is the present one, K + shift M */
  double shift;    /* 1/s2 */
  double stiffest; /* the greatest of its values, N/m */
  int64_t nonzeros;
} mpsi_elastic_outside;

/* ---- outside.c ------------------------------------------------------------------------------- */
void mpsi_elastic_drop_outside(mps_elastic *e);
/* solution = (K + shift M)^-1 rhs. */
mps_status mpsi_elastic_solve_outside(mps_elastic *e, const char *function, double shift,
                                      const double *rhs, double *solution);

#endif
