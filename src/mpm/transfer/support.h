/* support.h - the nodes of a stencil beside bodies and mirrors, for least_squares.c and
 * least_squares_batch.c. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_SUPPORT_H
#define MPSI_MPM_SUPPORT_H

#include "mpm/base/loops.h"

/* Where in the blocks of nodes the nodes of a stencil are. */
typedef struct mpsi_support {
  int corner[3][4], local[3][4]; /* which block under the tile, and the node's number in it: sums;
                                    of a ghost beyond a mirror those of its partner (mirror.h) */
  bool ghost[3][4];              /* which are, along each axis; */
  bool folds[3][4], any_folds;   /* and which are folded, on the mirror or beyond */
} mpsi_support;

/* The partner of tile node t along axis c, or -1: t is inside. */
MPSI_INLINE int mpsi_partner_of(const mps_mpm *mpm, const mpsi_cell_block *cells, int c, int t) {
  const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
  if (cells->mirrors >> (2 * c) & 1 && t <= mpm->grid.low[c] - first)
    return 2 * (int)(mpm->grid.low[c] - first) - t;
  if (cells->mirrors >> (2 * c + 1) & 1 && t >= mpm->grid.high[c] - first)
    return 2 * (int)(mpm->grid.high[c] - first) - t;
  return -1;
}

/* Of the stencil whose lowest node in the tile is `at`. */
MPSI_INLINE void mpsi_make_support(const mps_mpm *mpm, const mpsi_cell_block *cells, int dim,
                                   const int *at, mpsi_support *out) {
  out->any_folds = false;
  for (int c = 0, stride = 1; c < 3; c++, stride *= MPSI_SIDE)
    for (int i = 0; i < 4; i++) {
      const int node = at[c] + i;
      const int partner = cells->mirrors && c < dim ? mpsi_partner_of(mpm, cells, c, node) : -1;
      const int t = partner >= 0 ? partner : node;
      out->ghost[c][i] = t != node;
      out->folds[c][i] = partner >= 0;
      out->any_folds = out->any_folds || partner >= 0;
      out->corner[c][i] = c < dim && t >= MPSI_SIDE ? 1 << c : 0;
      out->local[c][i] = c < dim ? (t & (MPSI_SIDE - 1)) * stride : 0;
    }
}

/* Block of nodes of a node of the stencil, and the node in it. */
MPSI_INLINE int32_t mpsi_support_block(const mpsi_cell_block *cells, const mpsi_support *s, int i,
                                       int j, int k) {
  return cells->to[s->corner[0][i] | s->corner[1][j] | s->corner[2][k]];
}

MPSI_INLINE int mpsi_support_local(const mpsi_support *s, int i, int j, int k) {
  return s->local[0][i] + s->local[1][j] + s->local[2][k];
}

/* The normal of the next body that holds the node `local` of a block, which is MPSI_REACHED, from
 * its pair *pair on, which begins as nodes->first_pair; NULL behind the last. */
MPSI_INLINE const double *mpsi_next_normal(const mps_mpm *mpm, const mpsi_node_block *nodes,
                                           int local, int32_t *pair) {
  if (nodes->near < 0) return NULL;
  while (*pair < nodes->first_pair + nodes->pairs) {
    const int64_t at = (int64_t)(*pair)++ * mpm->grid.block_nodes + local;
    if (mpm->contact.held[at]) return mpm->contact.normal[at];
  }
  return NULL;
}

/* All nodes n of a stencil, with their indices i, j, k. */
#define MPSI_FOR_NODES(dim, spline)                                                                \
  for (int k = 0; k <= ((dim) == 3 ? (spline) : 0); k++)                                           \
    for (int j = 0; j <= (spline); j++)                                                            \
      for (int i = 0, n = 16 * k + 4 * j; i <= (spline); i++, n++)

#endif
