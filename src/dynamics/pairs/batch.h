/* batch.h - the pairs of a body, a batch of its blocks at a time: scratch memory of one batch is
 * released before the next, so that memory holds the arranged pairs, and not all neighbour lists
 * besides.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_DYNAMICS_BATCH_H
#define MPSI_DYNAMICS_BATCH_H

#include "layout.h"

/* Bounds of particles begin to end - 1 of those that are here, of one block and near one another.
 */
typedef struct mpsi_dynamics_piece {
  int64_t block, begin, end;
  double lo[2], hi[2]; /* m */
} mpsi_dynamics_piece;

/* Whether points of both, or of a copy a period (m; 0: none) away, may be within `reach` (m). */
static inline bool mpsi_dynamics_within_reach(const mpsi_dynamics_piece *a,
                                              const mpsi_dynamics_piece *b, double reach,
                                              double period) {
  const int copies = period > 0.0;
  if (a->lo[1] - b->hi[1] > reach || b->lo[1] - a->hi[1] > reach) return false;
  for (int copy = -copies; copy <= copies; copy++) {
    const double shift = copy * period;
    if (a->lo[0] + shift - b->hi[0] <= reach && b->lo[0] - a->hi[0] - shift <= reach) return true;
  }
  return false;
}

/* Sorted particles by number, and the bounds of those of each block. */
typedef struct mpsi_dynamics_source {
  mps_context *context;
  const char *function;       /* that errors name */
  mpsi_dynamics_geometry g;   /* by number; with `edge` where particles are missing */
  const int64_t *near;        /* numbers of the particles that are here, ascending; NULL: all */
  int64_t nears, body;        /* how many; numbers from `body` on are free-field columns */
  mpsi_dynamics_piece *piece; /* by mpsi_dynamics_source_open */
  int64_t pieces;
  uint8_t *taken; /* by block: of the batch */
} mpsi_dynamics_source;

mps_status mpsi_dynamics_source_open(mpsi_dynamics_source *source);
void mpsi_dynamics_source_close(mpsi_dynamics_source *source);

/* How many of so many blocks make a batch: all of a body with free-field columns. */
int64_t mpsi_dynamics_batch_size(const mpsi_dynamics_source *source, int64_t blocks);

/* All pairs that act on a particle of these blocks (with columns, all pairs): an array for
 * mpsi_free. `distinct` of them, the first, are ordinary pairs. */
mps_status mpsi_dynamics_source_pairs(mpsi_dynamics_source *source, int64_t blocks,
                                      const int32_t *block, int64_t *count,
                                      mpsi_dynamics_pair **pairs, int64_t *distinct);

/* Are all offsets whole spacings? Those of a lattice have been made exact. */
bool mpsi_dynamics_on_lattice(double spacing, int64_t count, const mpsi_dynamics_pair *pair);

#endif
