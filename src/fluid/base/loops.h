/* loops.h - the solver's inner loops over neighbours, compiled once for each instruction set
 * (loops.c); dispatch.c chooses. Lists of neighbours are filled up to whole vectors with the
 * particle itself at weight 0, so that the loops have no remainders.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

static inline int32_t mpsi_fluid_padded(int32_t near) {
  return (near + MPSI_FLUID_WIDE - 1) & ~(MPSI_FLUID_WIDE - 1);
}

/* Sums over the neighbours, see moments.c. */
typedef struct mpsi_fluid_sums {
  double n, m[2], r2, M[3], du[2], G[4], shift[2];
} mpsi_fluid_sums;

struct mpsi_fluid_loops {
  /* Appends slots [begin, end) of the sorted cloud within `radius` (m) of particle i; `index` and
   * `r2` have room for all and one more. Returns the new length of the list. */
  int64_t (*search)(const mps_fluid *f, int64_t i, double radius, int64_t begin, int64_t end,
                    int64_t found, int32_t *index, double *r2);
  /* Weights of squares of distances, both filled up as the list is; MPSI_FLUID_NEAR_IMAGES and
   * _CLOSE. */
  int32_t (*weigh)(const mps_fluid *f, const mpsi_fluid_weight *weight, int64_t i, int64_t count,
                   int32_t *index, double *r2, float *w);
  void (*add_up)(const mps_fluid *f, int64_t i, mpsi_fluid_sums *out);
  /* Rows [begin, end) of the pressure's matrix times v, to `out`; v . out over these rows. */
  double (*times)(const mps_fluid *f, int64_t begin, int64_t end, const double *v, double *out);
  /* Parts of an iteration of pcg.c for the rows [first, end) of a block, whose entries of L begin
   * at `offset`. forward: v = U^-T v. descend: update of p, x, s, r, then z = U^-1 D^-1 r; r . D^-1
   * r. rise: q = U^-T A (z - Z e), e as of coarse.h, z = U^-1 D^-1 r; q . D^-1 r. */
  void (*forward)(const mps_fluid *f, int64_t first, int64_t end, int64_t offset, double *v);
  double (*descend)(const mps_fluid *f, int64_t first, int64_t end, int64_t offset, double alpha,
                    double beta);
  double (*rise)(const mps_fluid *f, int64_t first, int64_t end, int64_t offset);
  /* |U^T v|^2 over these rows. */
  double (*norm)(const mps_fluid *f, int64_t first, int64_t end, int64_t offset, const double *v);
  /* Whether a neighbour of particle i has another value in `of` (particles, then ghosts). */
  bool (*mixed)(const mps_fluid *f, int64_t i, const int32_t *of);
  /* sum w (q_j - q_i) dx/r^2 */
  void (*slope)(const mps_fluid *f, int64_t i, double *sum);
  /* Change of velocity by smoothing between pairs, m/s, see smooth.c. */
  void (*smooth)(const mps_fluid *f, int64_t i, double *sum);
};

/* dispatch.c: the loops of an x86-64 level; 0: the best that processor and build have. */
const mpsi_fluid_loops *mpsi_fluid_choose_loops(int32_t level);
