/* block_range.h - the box of blocks that a rank has, by which others see whether some of theirs may
 * be beside them: searches for neighbours begin with the boxes of all ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_BLOCK_RANGE_H
#define MPSI_MPM_BLOCK_RANGE_H

#include <stdbool.h>
#include <stdint.h>

/* Numbers of a range: lowest (3) and highest (3) block along each axis, and how many blocks. All 0:
 * none. Ranks add up a list of ranges of which each has set its own. */
enum { MPSI_BLOCK_RANGE = 7 };

/* Adds the block at `at`. */
static inline void mpsi_block_range_add(int64_t *range, const int32_t *at) {
  for (int c = 0; c < 3; c++) {
    if (range[6] == 0 || at[c] < range[c]) range[c] = at[c];
    if (range[6] == 0 || at[c] > range[3 + c]) range[3 + c] = at[c];
  }
  range[6]++;
}

/* Whether the block at `at` may be beside one of the range, or one of them. */
static inline bool mpsi_block_range_near(const int64_t *range, const int32_t *at) {
  bool near = range[6] > 0;
  for (int c = 0; c < 3; c++) near = near && at[c] >= range[c] - 1 && at[c] <= range[3 + c] + 1;
  return near;
}

#endif
