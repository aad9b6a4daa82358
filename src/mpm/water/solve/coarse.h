/* coarse.h - the coarse space of the conjugate gradients (gradients.c): pressures that are constant
 * over tiles of 4 by 4 (by 4) cells, columns of Z. The diagonal alone reduces an error that is
 * smooth over many cells slowly, so that iterations grow as the number of cells along the ground.
 *
 * E = Z^T A Z joins a tile with those beside it only, as A reaches three cells. A tile's row of E
 * is found on the rank that counts its block, in the order of its cells, and sent to all, and so is
 * in each iteration the sum of the residual over each tile; all ranks then solve E e = Z^T r with
 * the same factors. So the bits are those of any number of threads and ranks. Where the factors of
 * E cost too much, tiles are joined to larger ones, of twice the side each time.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/envelope.h"
#include "mpm/water/system.h"

struct mpsi_pore_coarse {
  bool used;         /* in the present step */
  int dim;           /* of the grid */
  int tiles, beside; /* of a block; entries of a tile's row of E: itself and those beside it */
  int64_t searches;  /* of the partition, for which the list is that of the blocks */
  int64_t blocks;    /* in the list: those that some rank counts, in the order of their places */
  int32_t (*at)[3];
  int32_t (*around)[MPSI_PORE_AROUND]; /* numbers in the list, or -1 */
  int32_t *number;       /* by blocks of the grid: in the list, or -1, of another rank */
  double *row;           /* of E, m3/Pa: [blocks][tiles][beside] */
  double *sum;           /* of the residual, m3: [blocks][tiles] */
  int32_t *unknown;      /* of E, or -1: [blocks][tiles] */
  double *velocity;      /* of nodes under the pressures of tiles in reach: [nodes][2^dim][dim] */
  double *right, *value; /* Z^T r, m3, and e, Pa */
  mpsi_envelope matrix;  /* E */
  mpsi_room at_room, around_room, number_room, row_room, sum_room, unknown_room, velocity_room,
      value_room, order_room;
};

/* E and its factors for the present matrix, unless the system is small. Collective.
 * MPS_ERROR_MEMORY. */
mps_status mpsi_pore_find_coarse(mps_mpm *mpm, const char *function);
/* Sums of the residual over the tiles of block g, which this rank counts. */
void mpsi_pore_coarse_restrict(mps_mpm *mpm, int64_t g);
/* Solves E e = Z^T r; `*product`: their product. Collective. */
mps_status mpsi_pore_coarse_solve(mps_mpm *mpm, const char *function, double *product);
/* Z e of cell k of block g, which this rank counts. */
double mpsi_pore_coarse_at(const mps_mpm *mpm, int64_t g, int k);
void mpsi_pore_free_coarse(mps_context *context, mpsi_pore_coarse **coarse); /* accepts none */
