/* batch.h - the pairs of a body, a batch of its blocks at a time: scratch memory of one batch is
 * released before the next, so that memory has the arranged pairs, and not all neighbour lists
 * besides.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "layout.h"

/* Particles [begin, end) of this rank that belong to one block and lie near one another, with their
 * bounds. */
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

/* The particles among which pairs are sought, sorted, and the pieces of each block. */
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

/* Number of blocks in a batch of a body of `blocks`; all of a body with free-field columns. */
int64_t mpsi_dynamics_batch_size(const mpsi_dynamics_source *source, int64_t blocks);

/* All pairs with an end in one of these blocks (with columns, all pairs): an array that the caller
 * releases by mpsi_free. The first `distinct` of them are ordinary pairs. */
mps_status mpsi_dynamics_source_pairs(mpsi_dynamics_source *source, int64_t blocks,
                                      const int32_t *block, int64_t *count,
                                      mpsi_dynamics_pair **pairs, int64_t *distinct);

/* Whether all offsets are whole multiples of `spacing`, exactly: those of a lattice are rounded to
 * that when pairs are made. */
bool mpsi_dynamics_on_lattice(double spacing, int64_t count, const mpsi_dynamics_pair *pair);
