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

mpsi_dynamics_rows mpsi_dynamics_layout_rows(const double *lo, const double *hi, double spacing) {
  mpsi_dynamics_rows r = {.lo = {lo[0], lo[1]}, .spacing = spacing};
  r.fast = hi[1] - lo[1] > hi[0] - lo[0];
  const int64_t length = (int64_t)((hi[r.fast] - lo[r.fast]) / spacing + 1.5);
  /* rows of up to two strips stay whole: a strip edge costs scattered pairs */
  r.strips = length <= 2 * MPSI_DYN_STRIP ? 1 : length / MPSI_DYN_STRIP;
  r.width = (length + r.strips - 1) / r.strips;
  r.rows = (int64_t)((hi[!r.fast] - lo[!r.fast]) / spacing + 1.5);
  return r;
}

static place place_of(const mpsi_dynamics_rows *r, double x, double y) {
  const double at[2] = {x, y};
  const int64_t along = (int64_t)floor((at[r->fast] - r->lo[r->fast]) / r->spacing + 0.5);
  const int64_t across = (int64_t)floor((at[!r->fast] - r->lo[!r->fast]) / r->spacing + 0.5);
  return (place){.strip = along / r->width, .row = across, .along = along};
}

int64_t mpsi_dynamics_layout_key(const mpsi_dynamics_rows *r, double x, double y) {
  const place p = place_of(r, x, y);
  return (p.strip * r->rows + p.row) * r->width + p.along - p.strip * r->width;
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
  const mpsi_dynamics_rows rows = mpsi_dynamics_layout_rows(lo, hi, g->spacing);
  for (int64_t k = 0; k < g->count; k++) {
    places[k] = place_of(&rows, g->x[k], g->y[k]);
    places[k].old = k;
    if (g->side && g->side[k])
      places[k] = (place){.strip = rows.strips + g->side[k],
                          .along = (int64_t)floor((g->y[k] - lo[1]) / g->spacing + 0.5),
                          .old = k};
  }
  qsort(places, (size_t)g->count, sizeof *places, compare);
  for (int64_t k = 0; k < g->count; k++) order[k] = places[k].old;
  mpsi_free(context, places);
  return true;
}
