/* curve_orientation.h - orientation of Hilbert's curve (domain/curve.h) over the blocks of a body.
 * The curve divides a cube recursively into halves; the position of the cube over the blocks
 * determines how much of the body is at borders of ranks. So several orientations are tried, and
 * the one is chosen in which the rank with the most ghosts has the fewest. Results do not depend on
 * it. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/mpm.h>

#include <stdbool.h>

typedef struct mpsi_curve_orientation {
  int32_t axis[3]; /* axis of the grid along each axis of the curve */
  int32_t
      low[3]; /* first block of the grid: it lies `base` places from the beginning of the curve */
  int64_t base;
  int64_t side, extent[3]; /* number of blocks, by axis, along `side` places */
} mpsi_curve_orientation;

/* The key of the block `at`, also beyond the curve's ends. */
int64_t mpsi_mpm_curve_key(int32_t dim, const mpsi_curve_orientation *orientation,
                           const int32_t *at);
/* A block of cells with its number of particles. */
typedef struct mpsi_placed {
  int32_t at[3];
  int64_t particles;
} mpsi_placed;
/* Chooses the orientation for all blocks, in their order, on `ranks` ranks; false: memory
 * refused. */
bool mpsi_mpm_choose_orientation(mps_context *context, int32_t dim, int32_t ranks, int64_t blocks,
                                 const mpsi_placed *block, mpsi_curve_orientation *out);
