/* outside.h - the equations for a linear solver of the caller.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/elastic.h>

#include <stdbool.h>

/* The matrix that it has, K + shift M. */
typedef struct mpsi_elastic_outside {
  double shift;    /* 1/s2 */
  double stiffest; /* the greatest of its values, N/m */
  int64_t nonzeros;
} mpsi_elastic_outside;

/* ---- outside.c ------------------------------------------------------------------------------- */
/* Of the solver's kind: whether one can be set, and what follows where one is. */
mps_status mpsi_elastic_linear_ready(void *elastic, const char *function);
void mpsi_elastic_linear_changed(void *elastic);
bool mpsi_elastic_solved_outside(const mps_elastic *e);
/* solution = (K + shift M)^-1 rhs. */
mps_status mpsi_elastic_solve_outside(mps_elastic *e, const char *function, double shift,
                                      const double *rhs, double *solution);
