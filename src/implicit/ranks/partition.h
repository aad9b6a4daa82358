/* partition.h - a rank's part of the operator: the order of layers, and its window.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <mps/elastic.h>

/* An interval of the order of layers (partition.c). */
typedef struct mpsi_span {
  int64_t from, to;
} mpsi_span;

#define MPSI_SPANS 9 /* own particles, and with 1 to 8 layers around them */

/* Order, spans and window of e->shared, from positions. */
mps_status mpsi_elastic_open_window(mps_elastic *e, const char *function);
/* Collective where the body is shared: each value, given by one rank and -INFINITY on others (none
 * NaN), is sent to all. `status` is this rank's so far. */
MPS_NODISCARD mps_status mpsi_elastic_join(mps_elastic *e, const char *function, mps_status status,
                                           int64_t count, double *values);
/* The same for a vector over all particles, with the rows of each owner. */
MPS_NODISCARD mps_status mpsi_elastic_complete(mps_elastic *e, const char *function,
                                               double *values);
