/* notices.h - blocks that ranks announce to those whose blocks may be beside them: what the
 * searches for ghosts, and for cells of water, begin with. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <mps/experimental/domain.h>

/* A block of another rank. */
typedef struct mpsi_notice {
  int32_t rank, number; /* the rank that announces it, and its number there */
  int32_t at[3];
  int32_t low[3], high[3]; /* of blocks of cells, as in mpsi_cell_block */
} mpsi_notice;

/* Box of the blocks of a rank: lowest (3) and highest (3) block along each axis, and how many. All
 * 0: none. */
enum { MPSI_BLOCK_RANGE = 7 };
typedef int64_t mpsi_block_range[MPSI_BLOCK_RANGE];
void mpsi_mpm_add_to_range(int64_t *range, const int32_t *at);

/* Announces the blocks `own` to all ranks whose range they may be beside. `*list`, of `*found`
 * blocks in order of their ranks, is to be freed whatever is returned; the status is that of this
 * rank, on which ranks agree next. `status`: of the call so far. Collective. */
mps_status mpsi_mpm_exchange_notices(mps_context *context, mps_domain *domain, const char *function,
                                     mps_status status, const int64_t *range, int64_t count,
                                     const mpsi_notice *own, mpsi_notice **list, int64_t *found);
