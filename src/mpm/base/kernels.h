/* kernels.h - the inner loops of the solver, compiled once for each instruction set: p2g.c, g2p.c,
 * cut_scatter.c, cut_gather.c, search.c, sweep.c, cell_loops.c, inner_cells.c; common code is in
 * loops.h. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "shape.h"

/* What the transfer between the particles of a block of cells and the nodes works on. */
typedef struct mpsi_transfer {
  const mpsi_grid *grid;
  mpsi_columns *p;
  const mpsi_contacts *contact;
  const mpsi_boundaries *boundaries;
  const mpsi_mirrors *mirrors;
  mpsi_water *water; /* NULL: none */
  const mpsi_energy *energy;
  const mpsi_run *run;
  const mps_mpm_def *def;
  mpsi_cell_block *cells;
  mpsi_worker *worker;
  double keep; /* in [0, 1): fraction that particles keep, in this step, of the part of their
                  velocity that the nodes before the forces do not represent (flip_time of
                  mps_mpm_def) */
  bool before; /* gathers the velocities of the nodes before the forces (g2p.c) */
} mpsi_transfer;

typedef void (*mpsi_transfer_fn)(const mpsi_transfer *work);

/* Stencil and fitted shape functions of a particle; the states of its block's nodes are known. */
typedef void (*mpsi_fit_fn)(const mpsi_transfer *work, int64_t particle, mpsi_stencil *stencil,
                            mpsi_shape_values *out);

/* Shape functions extrapolated to the distance d[3] (m) from a particle, after the scatter of the
 * step. */
typedef void (*mpsi_foot_fn)(const mpsi_transfer *work, int64_t particle, const double *d,
                             mpsi_foot_weights *out);

/* Region known to be far from a body: the ball about x and, for a convex body, the points before
 * the tangent plane at `at` by more than `before` (m; else INFINITY). */
typedef struct mpsi_far {
  double x[3], square; /* m; m2, square of the radius */
  double at[3], normal[3], before;
} mpsi_far;

typedef struct mpsi_kernels {
  /* Indexed by geometry (mps_mpm_geometry) and degree of the spline less 2. */
  const mpsi_transfer_fn (*p2g)[2];  /* P2G of a block of cells */
  const mpsi_transfer_fn (*tile)[2]; /* first half of P2G: sums in the worker's tile */
  mpsi_transfer_fn flush;            /* second half: from the tile to the nodes */
  const mpsi_transfer_fn (*g2p)[2];  /* G2P: velocities and positions; then law and speed */
  mpsi_transfer_fn speed;            /* largest c + |v| of a block */
  mpsi_transfer_fn pore_sum;  /* water in the pores: sums of a block in the worker's tiles, which */
  mpsi_transfer_fn pore_give; /* are clear; and back from the tiles (water/cell_loops.c) */
  /* Of particles whose volumes have changed in the step, from before the laws: first for the block,
   * then for those from `begin` on, at most a chunk, at last for the block: its pressures. */
  mpsi_transfer_fn pore_begin_block, pore_respond;
  void (*pore_strain)(const mpsi_transfer *work, const double *former, int64_t begin, int n);
  /* Of cells of a block of nodes that have whole ones on all faces: pressures at the end of the
   * step with flow; slopes of these (water/inner_cells.c). */
  void (*pore_advance)(const mpsi_transfer *work, int64_t g, const uint64_t *whole);
  void (*pore_slopes)(const mpsi_transfer *work, int64_t g, const uint64_t *whole);
  mpsi_fit_fn fit;
  mpsi_foot_fn foot;
  /* search.c, of particles [begin, end): the largest speed (m/s); the first that is not known to be
   * far from a body, or `end`. Of a block of cells from `begin` on: the first that may be in its
   * cells low to high - 1 of each axis, or its end. */
  double (*fastest)(const mpsi_grid *grid, const mpsi_columns *p, int64_t begin, int64_t end);
  int64_t (*next_near)(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_far *far,
                       int64_t begin, int64_t end);
  int64_t (*next_in)(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_cell_block *cells,
                     const int *low, const int *high, int64_t begin);
  /* sweep.c: warm start of a block's constraints; takes the impulses of listed particles
   * (prescribed.h) off the nodes; a Gauss-Seidel update of each constraint; velocity of the ground
   * at the foot of one (m/s). */
  void (*warm)(mpsi_impulses *all, double dt, const mpsi_constraint_block *block);
  void (*release)(mpsi_impulses *all, const mpsi_constraint_block *block);
  void (*sweep)(mpsi_impulses *all, int32_t dim, mpsi_constraint_block *block, bool back);
  void (*foot_velocity)(const mpsi_impulses *all, int64_t constraint, double *v);
} mpsi_kernels;

/* kernels.c: the kernels of an x86-64 level; 0: the best that processor and build have. */
const mpsi_kernels *mpsi_mpm_kernels(int32_t isa);

/* inside.c: states of the nodes under a cut block's tile, to worker->state. */
void mpsi_mpm_find_states(const mpsi_transfer *work);

/* What the contact stage of a step works on. */
typedef struct mpsi_contact_stage {
  mps_context *context;
  mpsi_transfer transfer; /* of no block of cells yet */
  mpsi_contacts *contact;
  mpsi_prescribed *prescribed; /* lists of particles whose constraints take part; NULL: none */
  mpsi_partition *partition;   /* NULL: one rank */
  const mpsi_kernels *kernels;
  double next_dt; /* s, of the next step; that of this one is in transfer.run */
  bool settling;  /* bodies do not move freely */
} mpsi_contact_stage;

/* The stage's transfer of block of cells b by a worker. */
static inline mpsi_transfer mpsi_contact_transfer(const mpsi_contact_stage *stage, int64_t b,
                                                  int32_t worker) {
  mpsi_transfer work = stage->transfer;
  work.cells = &work.grid->cells[b];
  work.worker = &work.grid->workers[worker];
  return work;
}

/* inside.c: what the search for nodes inside bodies works on. */
typedef struct mpsi_inside_search {
  mps_context *context;
  const mpsi_grid *grid;
  const mpsi_columns *p;
  const mpsi_contacts *contact;
  const mpsi_kernels *kernels;
  bool failed; /* on this rank: it takes part in the exchange alone */
} mpsi_inside_search;
