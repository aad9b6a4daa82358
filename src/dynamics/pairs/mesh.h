/* mesh.h - the fixed pair structure of an explicit MPS body, arranged for vector instructions.
 *
 * Particles are sorted so that lattice neighbours in one direction are consecutive. A pair class
 * (same offset r0) then forms long runs (i, j), (i+1, j+1), ...: contiguous loads, no indices.
 * Pairs that fit no run (strip edges, bodies off a lattice, free-field coupling) are a scattered
 * list with indices. Particles are cut into blocks; a block computes every pair that acts on one of
 * its particles and writes only to its own, so blocks are free of conflicts, and a particle's sum
 * has one fixed order whatever the number of threads. A pair inside a block is computed once.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

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
  int64_t slots; /* pair evaluations a step */
  int64_t blocks, runs;
  int64_t ghosts;   /* ghost blocks of other ranks, behind the own ones: first pass only */
  int64_t interior; /* own blocks that read no particle of another rank: the first of `turn` */
  int32_t *turn;    /* the order of the first pass: all blocks; NULL: as they lie */
  mpsi_dynamics_block *block;
  mpsi_dynamics_pair_run *run;
  mpsi_dynamics_scattered scattered;
} mpsi_dynamics_mesh;

/* One pair as found by the neighbour search, before it is arranged. */
typedef struct mpsi_dynamics_pair {
  int32_t i, j, ti, tj;
  double r0x, r0y;
} mpsi_dynamics_pair;

/* The part of a body that one rank has. Particles and blocks of the whole body have global numbers,
 * in which pairs are arranged; so a particle's sum has one order whatever the number of ranks. */
typedef struct mpsi_dynamics_cut {
  int64_t blocks, ghosts; /* of this rank; ghost blocks, of which some particles are needed */
  int32_t *block;         /* their global numbers */
  int32_t *begin, *end;   /* local particles of each that are here: of ghosts not all */
  int32_t *slot;          /* by global block: which of these it is, -1: none */
  int32_t *local;         /* by global particle: its number here, -1: it is not here */
  uint8_t
      *wanted;   /* by global particle: 1: a ghost of the first layer, whose pressure is computed */
  int64_t count; /* local particles that are this rank's own */
} mpsi_dynamics_cut;

/* Discretisation, as the arrangement of pairs needs it. */
typedef struct mpsi_dynamics_mesh_def {
  const mps_kernel *kernel; /* w(r) */
  double density;           /* n0 */
  int64_t particles, body;  /* sorted; those of the body, which come first: no block has both them
                               and free-field columns */
  const mpsi_dynamics_cut *cut; /* NULL: all of the body is here */
} mpsi_dynamics_mesh_def;

/* Number of a particle's block, and of all blocks. */
static inline int64_t mpsi_dynamics_block_of(int64_t body, int64_t particle) {
  const int64_t body_blocks = (body + MPSI_DYN_BLOCK - 1) / MPSI_DYN_BLOCK;
  return particle < body ? particle / MPSI_DYN_BLOCK
                         : body_blocks + (particle - body) / MPSI_DYN_BLOCK;
}

/* Arranges the pairs of the source (batch.h), a batch of blocks at a time. `own` receives how many
 * ordinary pairs begin at particles of blocks that are this rank's, `lattice` whether all offsets
 * of pairs are whole spacings. On an error everything is released. */
struct mpsi_dynamics_source;
mps_status mpsi_dynamics_mesh_build(mps_context *context, mpsi_dynamics_mesh *mesh,
                                    const mpsi_dynamics_mesh_def *def,
                                    struct mpsi_dynamics_source *source, int64_t *own,
                                    bool *lattice);
void mpsi_dynamics_mesh_free(mps_context *context, mpsi_dynamics_mesh *mesh);
