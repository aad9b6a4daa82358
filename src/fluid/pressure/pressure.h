/* pressure.h - rows of the pressure equation, and its solution.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/fluid.h>

/* Rows of the pressure equation and vectors of its solution; see pcg.c. */
typedef struct mpsi_fluid_system {
  double *diagonal, *right; /* count */
  double *x;                /* count + ghosts; in the place of q, which a solution becomes */
  double *p, *r, *z, *q;    /* count */
  int32_t *lower_end;       /* of row i, in its block's stretch of lower_col and lower */
  uint16_t *lower_col;      /* from the first row of the block */
  float *lower;             /* of L */
  float *inverse;           /* of D, which is what this rounded reciprocal says */
  double *sums;             /* by chunk or block, two values each */
  double mean;              /* of the right side, or the shift of the solution; see closed.c */
  double datum;             /* Pa: x is q less this */
} mpsi_fluid_system;

mps_status mpsi_fluid_prepare_pressure(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_solve_pressure(mps_fluid *fluid, const char *function);
