/* mpm_anchor.h - the least that a WLS-MPM step has to do, as fast as one thread does it: the
 * yardstick of bench-mpm, which states the library's time as a ratio to this one's.
 *
 * A lattice block of linear elastic particles with full supports on a dense grid: no bodies, walls,
 * threads or checks. The particles must stay about where they start, in the order of their cells.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef BENCH_MPM_ANCHOR_H
#define BENCH_MPM_ANCHOR_H

#include <stdint.h>

/* Components of the particles' columns; in 2D only those of x and y, and zz of the stress. */
enum {
  ANCHOR_X = 0,  /* m: 3 */
  ANCHOR_V = 3,  /* m/s: 3 */
  ANCHOR_L = 6,  /* 1/s, dv_i/dx_j at 3 i + j: 9 */
  ANCHOR_S = 15, /* Pa: xx yy zz xy yz zx */
  ANCHOR_VOLUME = 21,
  ANCHOR_MASS = 22,
  ANCHOR_COLUMNS = 23
};

typedef struct anchor {
  int dim, degree;
  int64_t count;
  int64_t nodes[3]; /* of the grid, whose node 0 lies at the origin */
  double cell, dt, lambda, mu;
  double *column[ANCHOR_COLUMNS];
  double *node; /* mass and momentum, later velocity: 4 a node */
  void *memory;
} anchor;

/* A block of `side` cells each way with two particles along each edge of a cell; velocities are
 * zero. Ends the program where memory does not suffice. */
anchor anchor_create(int dim, int degree, int64_t side, double cell, double density, double young,
                     double poisson, double dt);
void anchor_free(anchor *a);
void anchor_step(anchor *a, int64_t steps);

#endif
