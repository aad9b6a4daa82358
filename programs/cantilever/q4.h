/* q4.h - the same cantilever by four-node bilinear finite elements, to compare with.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_Q4_H
#define EXAMPLES_Q4_H

#include "beam.h"

#include <stdint.h>

typedef struct q4 {
  const beam *problem;
  int64_t nx, ny; /* nodes along and up */
  double hx, hy;  /* m: element size */
  double *u;      /* [2 * (i * ny + j) + c], displacement of node (i, j) */
} q4;

/* Solves with nx x ny nodes (at least 2 each). False: out of memory, or the solver failed. */
bool q4_solve(const beam *problem, int64_t nx, int64_t ny, q4 *out);
void q4_free(q4 *f);
/* Displacement at (x, y), interpolated. */
void q4_at(const q4 *f, double x, double y, double *u);

#endif
