/* nearest.h - the points of a fixed set that lie nearest to a place.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

/* A k-d tree without nodes: of each part of `order` the middle item is the root, and splits the
 * others by their coordinate along the part's axis. */
typedef struct mpsi_nearest {
  const double *x; /* dim values a point, the caller's */
  int64_t count;
  int32_t dim;
  int64_t *order; /* of mpsi_alloc; the caller frees it */
} mpsi_nearest;

typedef struct mpsi_near {
  double square; /* of the distance, m2 */
  int64_t point;
} mpsi_near;

/* Sorts order[0] to order[count - 1] = 0, 1, ... for a search. */
void mpsi_nearest_build(mpsi_nearest *tree);

/* The `wanted` points nearest to `at`, nearest first, of equally near ones the lower number first,
 * in `out`. Returns their number, at most the count. */
int32_t mpsi_nearest_find(const mpsi_nearest *tree, const double *at, int32_t wanted,
                          mpsi_near *out);
