/* mesh.h - the fixed pair structure of an explicit MPS body, arranged for vector instructions.
 *
 * Particles are sorted so that lattice neighbours in one direction are consecutive. A pair class
 * (same offset r0) then forms long runs (i, j), (i+1, j+1), ...: contiguous loads, no indices.
 * Pairs that fit no run (strip edges, bodies off a lattice, free-field coupling) are a scattered
 * list with indices. Particles are cut into blocks; a block computes every pair that acts on one of
 * its particles and writes only to its own, so blocks are free of conflicts, and a particle's sum
 * has one fixed order whatever the number of threads. A pair inside a block is computed once.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_MESH_H
#define MPSI_DYNAMICS_MESH_H

#include "core/internal.h"

#include <mps/kernel.h>

#define MPSI_DYN_BLOCK 512 /* particles a block: its sums stay in the first-level cache */
#define MPSI_DYN_CHUNK 128 /* pairs a vector loop */
#define MPSI_DYN_STRIP 64  /* particles a row before a wide body is cut into strips */

/* Pairs (i0 + t, j0 + t), t in [0, count), all with the offset r0 = r0_j - r0_i. */
typedef struct mpsi_dynamics_pair_run {
  int32_t i0, j0, count;
  int32_t own_i, own_j; /* 1: this block owns that side and adds to it */
  double r0x, r0y;      /* m */
  double
      kf; /* (4d/n0) w/r0^2 / 2, 1/m2: times (mu_i + mu_j) u is the force term, Yoshida (A6, A7) */
  double kc; /* (d/n0) w/r0, 1/m: times cn is the divergence term, Yoshida (A11) */
} mpsi_dynamics_pair_run;

/* Scattered pairs: state of i and j, added to particles ti and tj (-1: not added). An ordinary
 * pair has ti = i and tj = j where the block owns them. */
typedef struct mpsi_dynamics_scattered {
  int32_t *i, *j, *ti, *tj;
  double *r0x, *r0y, *kf, *kc;
  int64_t count;
} mpsi_dynamics_scattered;

typedef struct mpsi_dynamics_block {
  int32_t begin, end; /* particles */
  int64_t run_begin, run_end;
  int64_t scattered_begin, scattered_end;
  int64_t slot; /* first pair slot of the block: runs in order, then scattered */
} mpsi_dynamics_block;

typedef struct mpsi_dynamics_mesh {
  int64_t particles;
  int64_t pairs; /* distinct ordinary pairs */
  int64_t slots; /* pair evaluations a step */
  int64_t blocks, runs;
  mpsi_dynamics_block *block;
  mpsi_dynamics_pair_run *run;
  mpsi_dynamics_scattered scattered;
} mpsi_dynamics_mesh;

/* One pair as found by the neighbour search, before it is arranged. */
typedef struct mpsi_dynamics_pair {
  int32_t i, j, ti, tj;
  double r0x, r0y;
} mpsi_dynamics_pair;

/* What arranging needs to know of the discretisation. */
typedef struct mpsi_dynamics_mesh_def {
  const mps_kernel *kernel; /* w(r) */
  double density;           /* n0 */
} mpsi_dynamics_mesh_def;

/* Arranges `count` pairs over `particles` sorted particles. `pair` is reordered. False: out of
 * memory (everything released). */
bool mpsi_dynamics_mesh_build(mps_context *context, mpsi_dynamics_mesh *mesh,
                              const mpsi_dynamics_mesh_def *def, int64_t particles, int64_t count,
                              mpsi_dynamics_pair *pair);
void mpsi_dynamics_mesh_free(mps_context *context, mpsi_dynamics_mesh *mesh);

#endif
