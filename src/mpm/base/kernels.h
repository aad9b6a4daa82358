/* kernels.h - the inner loops of the solver, compiled once for each instruction set: p2g.c, g2p.c,
 * cut_scatter.c, cut_gather.c, search.c, sweep.c, and loops.h for what they have in
 * common. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_KERNELS_H
#define MPSI_MPM_KERNELS_H

#include "shape.h"

/* The stencil and the fitted shape functions of a particle of a block whose states are known. */
typedef void (*mpsi_fit_fn)(const mps_mpm *mpm, const mpsi_cell_block *cells,
                            const mpsi_worker *worker, int64_t particle, mpsi_stencil *stencil,
                            mpsi_shape_values *out);

/* The same at the distance d[3] from it, in the step whose scatter has been. */
typedef void (*mpsi_foot_fn)(const mps_mpm *mpm, const mpsi_cell_block *cells,
                             const mpsi_worker *worker, int64_t particle, const double *d,
                             mpsi_foot_weights *out);

/* What is known to be far from a body: the ball about x and, of a convex body, what is before the
 * tangent plane at `at` by more than `before` (m; else INFINITY). */
typedef struct mpsi_far {
  double x[3], square; /* m, m2 */
  double at[3], normal[3], before;
} mpsi_far;

typedef struct mpsi_kernels {
  /* By geometry (mps_mpm_geometry) and degree of the spline less 2. */
  const mpsi_mpm_task (*p2g)[2];  /* a block of cells, of the colour in work, to its nodes */
  const mpsi_mpm_task (*tile)[2]; /* the first half of that: into the worker's tile; */
  mpsi_mpm_task flush;            /* and the second: from there to the nodes */
  const mpsi_mpm_task (*g2p)[2];  /* from the nodes: velocities, places; then law and speed */
  mpsi_mpm_task speed;            /* largest speed of a block, by itself */
  mpsi_fit_fn fit;
  mpsi_foot_fn foot;
  /* search.c, of particles [begin, end): the largest speed (m/s); and the first that is not far, or
   * `end`. Of a block of cells from `begin` on: the first that may be in its cells low to high - 1
   * of each axis, or its end. */
  double (*fastest)(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin, int64_t end);
  int64_t (*next_near)(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_far *far,
                       int64_t begin, int64_t end);
  int64_t (*next_in)(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_cell_block *cells,
                     const int *low, const int *high, int64_t begin);
  /* sweep.c: the first impulses of a block's constraints; an update of each; velocity of the
   * particle's side at the foot of one (m/s). */
  void (*warm)(mpsi_impulses *all, double dt, const mpsi_constraint_block *block);
  void (*sweep)(mpsi_impulses *all, int32_t dim, mpsi_constraint_block *block, bool back);
  void (*foot_velocity)(const mpsi_impulses *all, int64_t constraint, double *v);
} mpsi_kernels;

/* kernels.c: the kernels of an x86-64 level; 0: the best that processor and build have. */
const mpsi_kernels *mpsi_mpm_kernels(int32_t isa);

/* inside.c: states of the nodes under a cut block's tile, to worker->state and worker->inside. */
void mpsi_mpm_find_states(const mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker);

#endif
