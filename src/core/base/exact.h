/* exact.h - sums of doubles without round-off: the same bits in whatever order, and on however many
 * ranks, the terms are added. A sum is a fixed-point number over the whole range of a double, in
 * limbs of 32 bits held in 64, so that carries wait, and so that sums of several ranks are added as
 * integers. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#define MPSI_EXACT_VALUE 67 /* limbs of the value; bit 0 is 2^-1074 */
#define MPSI_EXACT_LIMBS                                                                           \
  71 /* and numbers of terms NaN, +inf, -inf; terms since carries were made */

typedef struct mpsi_exact {
  int64_t limb[MPSI_EXACT_LIMBS];
} mpsi_exact;

void mpsi_exact_add(mpsi_exact *sum, double term);
/* Adds a sum to another. */
void mpsi_exact_merge(mpsi_exact *to, const mpsi_exact *from);
/* Before the limbs of several sums are added as integers: at most 2^30 of them. */
void mpsi_exact_carry(mpsi_exact *sum);
/* Whether limbs of a file are those of a sum, to which more can be added without an overflow. */
bool mpsi_exact_is_sum(const int64_t limb[MPSI_EXACT_LIMBS]);
/* The double nearest to the sum. */
double mpsi_exact_value(const mpsi_exact *sum);
