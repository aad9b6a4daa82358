/* polygon.h - the check of a polygon's corners that fills and rigid bodies share.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

/* MPS_ERROR_ARGUMENT unless the n >= 3 finite corners xy[2 * k], xy[2 * k + 1] make a simple
 * polygon: no two edges intersect, except neighbours at their common corner. */
mps_status mpsi_polygon_check(mps_context *context, const char *function, int64_t n,
                              const double *xy);
