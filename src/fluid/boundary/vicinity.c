/* vicinity.c - the segments of polylines near a place, so that a particle looks at those around it
 * however many there are. Segments that follow each other lie near each other: boxes of some
 * segments one after the other are looked at first.
 *
 * In a step each chunk of particles has a list of the segments near its box; elsewhere, where one
 * place after the other is near the last one, there is a window with the segments near it. Lists
 * are in the order of the segments, and what is in them beyond a distance changes no result.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/boundary/vicinity.h"

#include <string.h>

#define WINDOW 4.0   /* re: from its middle to its sides */
#define LEAST_RUN 16 /* segments */

struct mpsi_fluid_lines {
  bool known;                       /* the boxes are of the present polylines */
  int64_t run;                      /* segments of a box */
  mpsi_room box_room;               /* of each run: low x, y, high x, y, m */
  mpsi_room near_room;              /* int32_t: segments of a chunk after those of another */
  mpsi_room first_room;             /* int64_t: where those of a chunk begin, chunks + 1 */
  mpsi_room chunk_room, start_room; /* int32_t: chunks near a segment; int64_t: where they begin */
  double window[4];
  mpsi_room window_room; /* int32_t, of all segments */
  mpsi_room all_room;    /* int32_t: their numbers */
  int64_t in_window;     /* -1: there is none */
};

/* ---- boxes ----------------------------------------------------------------------------------- */

/* Of a segment, infinite where that is. */
static void box_of(const mpsi_fluid_segment *s, double *box) {
  const double walk[2] = {s->wall.normal[1], -s->wall.normal[0]};
  for (int c = 0; c < 2; c++) {
    box[c] = fmin(s->end[0][c], s->end[1][c]), box[2 + c] = fmax(s->end[0][c], s->end[1][c]);
    if (s->infinite[0]) {
      if (walk[c] > 0.0) box[c] = -INFINITY;
      if (walk[c] < 0.0) box[2 + c] = INFINITY;
    }
    if (s->infinite[1]) {
      if (walk[c] < 0.0) box[c] = -INFINITY;
      if (walk[c] > 0.0) box[2 + c] = INFINITY;
    }
  }
}

static bool apart(const double *a, const double *b, double reach) {
  return a[0] > b[2] + reach || a[1] > b[3] + reach || b[0] > a[2] + reach || b[1] > a[3] + reach;
}

/* Whether all of a box is farther than `reach` from a segment's line. */
static bool beside_line(const mpsi_fluid_segment *s, const double *box, double reach) {
  const double middle[2] = {0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])};
  const double half = 0.5 * (fabs(s->wall.normal[0]) * (box[2] - box[0]) +
                             fabs(s->wall.normal[1]) * (box[3] - box[1]));
  return fabs(mpsi_fluid_before_segment(s, middle)) > half + reach;
}

static bool make_boxes(mps_fluid *f, mpsi_fluid_lines *l) {
  l->run = (int64_t)sqrt((double)f->segments);
  if (l->run < LEAST_RUN) l->run = LEAST_RUN;
  const int64_t runs = (f->segments + l->run - 1) / l->run;
  if (!mpsi_room_ensure(f->context, &l->box_room, 4 * runs, sizeof(double)) ||
      !mpsi_room_ensure(f->context, &l->all_room, f->segments, sizeof(int32_t)) ||
      !mpsi_room_ensure(f->context, &l->window_room, f->segments, sizeof(int32_t)))
    return false;
  for (int64_t k = 0; k < f->segments; k++) ((int32_t *)l->all_room.item)[k] = (int32_t)k;
  for (int64_t r = 0; r < runs; r++) {
    double *all = (double *)l->box_room.item + 4 * r, box[4];
    const int64_t end = (r + 1) * l->run < f->segments ? (r + 1) * l->run : f->segments;
    box_of(mpsi_fluid_segment_of(f, r * l->run), all);
    for (int64_t k = r * l->run + 1; k < end; k++) {
      box_of(mpsi_fluid_segment_of(f, k), box);
      for (int c = 0; c < 2; c++)
        all[c] = fmin(all[c], box[c]), all[2 + c] = fmax(all[2 + c], box[2 + c]);
    }
  }
  l->in_window = -1;
  l->known = true;
  return true;
}

/* Writes the segments within `reach` of a box to `out`, which has room for all; their number. */
static int64_t list_near(const mps_fluid *f, const double *box, double reach, int32_t *out) {
  const mpsi_fluid_lines *l = f->lines;
  const double *of = l->box_room.item;
  int64_t found = 0;
  for (int64_t first = 0; first < f->segments; first += l->run, of += 4) {
    if (apart(of, box, reach)) continue;
    const int64_t end = first + l->run < f->segments ? first + l->run : f->segments;
    for (int64_t k = first; k < end; k++) {
      const mpsi_fluid_segment *s = mpsi_fluid_segment_of(f, k);
      double own[4];
      box_of(s, own);
      if (!apart(own, box, reach) && !beside_line(s, box, reach)) out[found++] = (int32_t)k;
    }
  }
  return found;
}

/* ---- all segments ---------------------------------------------------------------------------- */

bool mpsi_fluid_list_segments(mps_fluid *f) {
  int64_t count = 0;
  if (f->lines && f->lines->known) return true;
  for (int b = 0; b < f->boundaries; b++)
    if (f->wall[b].line) count += f->wall[b].line->count;
  f->segments = 0;
  if (count == 0) return true;
  if (!f->lines && !(f->lines = mpsi_alloc(f->context, 1, sizeof *f->lines))) return false;
  if (!mpsi_room_ensure(f->context, &f->segment_room, count, sizeof(mpsi_fluid_segment *)))
    return false;
  mpsi_fluid_segment **all = f->segment_room.item;
  f->segments = count;
  for (int b = 0; b < f->boundaries; b++)
    for (int64_t k = 0; f->wall[b].line && k < f->wall[b].line->count; k++) {
      mpsi_fluid_segment *s = &f->wall[b].line->segment[k];
      s->all = (int32_t)(f->segments - count--);
      all[s->all] = s;
    }
  return make_boxes(f, f->lines);
}

void mpsi_fluid_forget_segments(mps_fluid *f) {
  if (f->lines) f->lines->known = false, f->lines->in_window = -1;
}

void mpsi_fluid_drop_lines(mps_fluid *f) {
  mpsi_fluid_lines *l = f->lines;
  if (!l) return;
  MPSI_FREE(f->context, l->box_room.item, l->near_room.item, l->first_room.item, l->chunk_room.item,
            l->start_room.item, l->window_room.item, l->all_room.item);
  mpsi_free(f->context, l);
  f->lines = NULL;
}

/* ---- chunks ---------------------------------------------------------------------------------- */

double mpsi_fluid_listed_reach(const mps_fluid *f) { return f->reach * (1.0 + 1e-9) + f->l0; }

/* The chunks near each segment, ascending, from the segments near each chunk. */
static bool turn_round(mps_fluid *f, mpsi_fluid_lines *l, int64_t chunks) {
  const int64_t *first = l->first_room.item;
  const int32_t *near = l->near_room.item;
  if (!mpsi_room_ensure(f->context, &l->start_room, f->segments + 2, sizeof(int64_t)) ||
      !mpsi_room_ensure(f->context, &l->chunk_room, first[chunks] + 1, sizeof(int32_t)))
    return false;
  int64_t *start = l->start_room.item;
  int32_t *chunk = l->chunk_room.item;
  memset(start, 0, (size_t)(f->segments + 2) * sizeof *start);
  for (int64_t n = 0; n < first[chunks]; n++) start[near[n] + 2]++;
  for (int64_t k = 0; k < f->segments; k++) start[k + 2] += start[k + 1];
  for (int64_t c = 0; c < chunks; c++)
    for (int64_t n = first[c]; n < first[c + 1]; n++) chunk[start[near[n] + 1]++] = (int32_t)c;
  return true;
}

bool mpsi_fluid_find_vicinities(mps_fluid *f) {
  mpsi_fluid_lines *l = f->lines;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  const double reach = mpsi_fluid_listed_reach(f), *box = f->box_room.item;
  if (!mpsi_room_ensure(f->context, &l->first_room, chunks + 1, sizeof(int64_t))) return false;
  int64_t *first = l->first_room.item;
  first[0] = 0;
  for (int64_t c = 0; c < chunks; c++) {
    const int32_t *near = l->window_room.item; /* room for all: used as scratch */
    const int64_t found = list_near(f, box + 4 * c, reach, l->window_room.item);
    first[c + 1] = first[c] + found;
    if (!mpsi_room_keep(f->context, &l->near_room, first[c + 1] + 1, sizeof *near)) return false;
    memcpy((int32_t *)l->near_room.item + first[c], near, (size_t)found * sizeof *near);
  }
  l->in_window = -1;
  return turn_round(f, l, chunks);
}

mpsi_fluid_listed mpsi_fluid_near_chunk(const mps_fluid *f, int64_t chunk) {
  const mpsi_fluid_lines *l = f->lines;
  const int64_t *first = (const int64_t *)l->first_room.item + chunk;
  return (mpsi_fluid_listed){(const int32_t *)l->near_room.item + first[0], first[1] - first[0]};
}

mpsi_fluid_listed mpsi_fluid_all_segments(const mps_fluid *f) {
  return (mpsi_fluid_listed){f->lines->all_room.item, f->segments};
}

mpsi_fluid_listed mpsi_fluid_chunks_near(const mps_fluid *f, int64_t segment) {
  const mpsi_fluid_lines *l = f->lines;
  const int64_t *start = (const int64_t *)l->start_room.item + segment;
  return (mpsi_fluid_listed){(const int32_t *)l->chunk_room.item + start[0], start[1] - start[0]};
}

/* ---- places one after the other ---------------------------------------------------------------
 */

mpsi_fluid_listed mpsi_fluid_near_place(const mps_fluid *f, const double *x) {
  mpsi_fluid_lines *l = f->lines;
  const double size = WINDOW * f->reach, *w = l->window;
  const bool inside =
      l->in_window >= 0 && x[0] >= w[0] && x[1] >= w[1] && x[0] <= w[2] && x[1] <= w[3];
  if (!inside) {
    for (int c = 0; c < 2; c++) l->window[c] = x[c] - size, l->window[2 + c] = x[c] + size;
    l->in_window = list_near(f, l->window, mpsi_fluid_listed_reach(f), l->window_room.item);
  }
  return (mpsi_fluid_listed){l->window_room.item, l->in_window};
}
