/* vicinity.h - the segments of polylines near a place: see vicinity.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/boundary/polyline.h"

/* Numbers of segments, or of chunks of particles, ascending. */
typedef struct mpsi_fluid_listed {
  const int32_t *item;
  int64_t count;
} mpsi_fluid_listed;

/* m: lists have all segments within this of the particles at the beginning of the step. */
double mpsi_fluid_listed_reach(const mps_fluid *fluid);
/* After the segments have been listed: those of each chunk of particles, whose boxes are known.
 * False: no memory. */
bool mpsi_fluid_find_vicinities(mps_fluid *fluid);
mpsi_fluid_listed mpsi_fluid_near_chunk(const mps_fluid *fluid, int64_t chunk);
mpsi_fluid_listed mpsi_fluid_all_segments(const mps_fluid *fluid);
/* Chunks with this segment in their lists. */
mpsi_fluid_listed mpsi_fluid_chunks_near(const mps_fluid *fluid, int64_t segment);
/* Segments near a place, within the same distance; valid until the next call, in one thread. */
mpsi_fluid_listed mpsi_fluid_near_place(const mps_fluid *fluid, const double *x);

/* polyline.c: distance (m) of x from the polyline of entry *next of a list, negative behind it, by
 * its segments in the list, and the nearest of them; *next: the first entry of another one. It is
 * that of the polyline where it is within reach of the list. */
double mpsi_fluid_before_listed(const mps_fluid *fluid, const mpsi_fluid_listed *list,
                                int64_t *next, const double *x, const mpsi_fluid_segment **nearest);
/* mirrors.c: the first of a list that the way from a to b crosses from its front; *share: where on
 * the way. */
const mpsi_fluid_segment *mpsi_fluid_crossed(const mps_fluid *fluid, const mpsi_fluid_listed *list,
                                             const mpsi_fluid_segment *except, const double *a,
                                             const double *b, double *share);
