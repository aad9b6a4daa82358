/* layout.c - order of the particles: rows along the longer direction of the body, so that the
 * neighbours of consecutive particles are consecutive; wide bodies in strips, so that a block of
 * rows is compact and few of its pairs leave it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "layout.h"

#include <stdlib.h>

typedef struct place {
  int64_t strip, row, along; /* lattice cells; strip is past the last one for columns */
  int64_t old;
} place;

static int compare(const void *left, const void *right) {
  const place *a = left, *b = right;
  if (a->strip != b->strip) return a->strip < b->strip ? -1 : 1;
  if (a->row != b->row) return a->row < b->row ? -1 : 1;
  if (a->along != b->along) return a->along < b->along ? -1 : 1;
  return a->old < b->old ? -1 : a->old > b->old;
}

bool mpsi_dynamics_layout_order(mps_context *context, const mpsi_dynamics_geometry *g,
                                int64_t *order) {
  place *places = mpsi_alloc(context, g->count, sizeof *places);
  if (!places) return false;
  double lo[2] = {INFINITY, INFINITY}, hi[2] = {-INFINITY, -INFINITY};
  for (int64_t k = 0; k < g->count; k++) {
    if (g->side && g->side[k]) continue;
    lo[0] = fmin(lo[0], g->x[k]), hi[0] = fmax(hi[0], g->x[k]);
    lo[1] = fmin(lo[1], g->y[k]), hi[1] = fmax(hi[1], g->y[k]);
  }
  const int fast = hi[1] - lo[1] > hi[0] - lo[0]; /* 1: rows run along y */
  const int64_t length = (int64_t)((hi[fast] - lo[fast]) / g->spacing + 1.5);
  /* rows of up to two strips stay whole: a strip edge costs scattered pairs */
  const int64_t strips = length <= 2 * MPSI_DYN_STRIP ? 1 : length / MPSI_DYN_STRIP;
  const int64_t width = (length + strips - 1) / strips;
  for (int64_t k = 0; k < g->count; k++) {
    const double at[2] = {g->x[k], g->y[k]};
    const int64_t along = (int64_t)floor((at[fast] - lo[fast]) / g->spacing + 0.5);
    const int64_t across = (int64_t)floor((at[!fast] - lo[!fast]) / g->spacing + 0.5);
    places[k] = (place){.strip = along / width, .row = across, .along = along, .old = k};
    if (g->side && g->side[k])
      places[k] = (place){.strip = strips + g->side[k],
                          .along = (int64_t)floor((at[1] - lo[1]) / g->spacing + 0.5),
                          .old = k};
  }
  qsort(places, (size_t)g->count, sizeof *places, compare);
  for (int64_t k = 0; k < g->count; k++) order[k] = places[k].old;
  mpsi_free(context, places);
  return true;
}
