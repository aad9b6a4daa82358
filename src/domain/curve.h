/* curve.h - owners of blocks of cells: blocks are numbered along Hilbert's curve, and each rank has
 * an interval of these numbers (keys), so that its blocks are contiguous and data along the curve
 * have the same order for every number of ranks.
 *
 *   mpsi_curve_key     key of a block, by its place in the grid of blocks
 *   mpsi_curve_cut     the intervals, weighed: the same on all ranks
 *   mpsi_curve_owner   owner of any key, also of a block that has nothing
 *
 * Owners follow from keys, not from lists of blocks: a particle that enters an empty block has an
 * owner at once, without a message. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain_internal.h"

/* Blocks at 0 to MPSI_CURVE_SIDE(dim) - 1 in each direction; keys from 0 to MPSI_CURVE_END - 1. */
#define MPSI_CURVE_BITS(dim) ((dim) == 2 ? 30 : 20)
#define MPSI_CURVE_SIDE(dim) (INT32_C(1) << MPSI_CURVE_BITS(dim))
#define MPSI_CURVE_END (INT64_C(1) << 60)

/* Two keys that follow one another are blocks that share a side. Not collective, no errors: `block`
 * is within the bounds above, and has `dim` (2, 3) places. */
int64_t mpsi_curve_key(int32_t dim, const int32_t *block);
void mpsi_curve_block(int32_t dim, int64_t key, int32_t *block);

/* Cuts the curve into an interval for each rank: rank r has the keys from first[r] to first[r + 1]
 * - 1, none where the two are the same; first[0] is 0 and first[ranks] is MPSI_CURVE_END. `first`
 * has room for ranks + 1.
 *
 * Each rank gives `count` keys in ascending order with their weights, >= 0: numbers of particles,
 * or measured ns. A key may come from several ranks; its weights add up. A block belongs to the
 * rank in whose equal part of all the weight its middle lies, so that a rank gets at most the mean
 * and the heaviest block's weight, wherever more ranks than blocks are too. Where all weights are 0
 * the last rank has all.
 *
 * Collective; MPS_ERROR_ARGUMENT (keys not ascending or out of bounds, a negative weight, a sum
 * beyond 2^61 over ranks) and MPS_ERROR_MEMORY on all ranks alike. Needs memory for `count` and a
 * few numbers for each rank, and about a reduction for each bit of the greatest key, of at most 8
 * bytes x max(ranks, 4096). Without other ranks first is {0, MPSI_CURVE_END}. */
mps_status mpsi_curve_cut(mps_domain *domain, const char *function, int64_t count,
                          const int64_t *key, const int64_t *weight, int64_t *first);

/* Owner of a key, 0 <= key < MPSI_CURVE_END. Not collective. */
int32_t mpsi_curve_owner(int32_t ranks, const int64_t *first, int64_t key);
