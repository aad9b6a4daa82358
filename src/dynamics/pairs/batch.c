/* batch.c - see batch.h. The pairs of a batch are searched among its own particles and particles of
 * other blocks within reach, found by bounds of pieces of blocks. Additional particles change
 * nothing: pairs are closer than re.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "batch.h"

#include <stdlib.h>

#define LEAST_BLOCKS 8  /* a batch */
#define MOST_BATCHES 64 /* so that going through all bounds for each costs little */

typedef mpsi_dynamics_piece piece;

static int64_t number(const mpsi_dynamics_source *s, int64_t k) { return s->near ? s->near[k] : k; }

static bool columns(const mpsi_dynamics_source *s) { return s->body < s->g.count; }

/* ---- bounds ---------------------------------------------------------------------------------- */

static piece empty(int64_t block, int64_t begin) {
  return (piece){.block = block,
                 .begin = begin,
                 .end = begin,
                 .lo = {INFINITY, INFINITY},
                 .hi = {-INFINITY, -INFINITY}};
}

static piece widened(piece p, double x, double y) {
  p.lo[0] = fmin(p.lo[0], x), p.hi[0] = fmax(p.hi[0], x);
  p.lo[1] = fmin(p.lo[1], y), p.hi[1] = fmax(p.hi[1], y);
  p.end++;
  return p;
}

/* Where a block continues in another strip, its bounds would span both strips. */
static bool too_wide(const mpsi_dynamics_source *s, const piece *p) {
  const double D = s->g.spacing, area = (p->hi[0] - p->lo[0] + D) * (p->hi[1] - p->lo[1] + D);
  return area > (4.0 * (double)(p->end - p->begin) + 2.0 * MPSI_DYN_BLOCK) * D * D;
}

/* `out` NULL: how many. */
static int64_t list_pieces(const mpsi_dynamics_source *s, piece *out) {
  int64_t pieces = 0;
  piece p = empty(-1, 0);
  for (int64_t k = 0; k < s->nears; k++) {
    const int64_t at = number(s, k), block = mpsi_dynamics_block_of(s->body, at);
    const piece wider = widened(p, s->g.x[at], s->g.y[at]);
    if (block == p.block && !too_wide(s, &wider)) {
      p = wider;
    } else {
      p = widened(empty(block, k), s->g.x[at], s->g.y[at]);
      pieces++;
    }
    if (out) out[pieces - 1] = p;
  }
  return pieces;
}

mps_status mpsi_dynamics_source_open(mpsi_dynamics_source *s) {
  const int64_t blocks = mpsi_dynamics_block_of(s->body, s->g.count) + 1;
  s->pieces = columns(s) ? 0 : list_pieces(s, NULL);
  s->piece = mpsi_alloc(s->context, s->pieces, sizeof *s->piece);
  s->taken = mpsi_alloc(s->context, blocks, 1);
  if (!s->piece || !s->taken)
    return mpsi_fail_memory(s->context, s->function, (size_t)s->pieces * sizeof *s->piece);
  if (s->pieces > 0) list_pieces(s, s->piece);
  return MPS_OK;
}

void mpsi_dynamics_source_close(mpsi_dynamics_source *s) {
  MPSI_FREE(s->context, s->piece, s->taken);
  s->piece = NULL, s->taken = NULL;
}

int64_t mpsi_dynamics_batch_size(const mpsi_dynamics_source *s, int64_t blocks) {
  const int64_t size = (blocks + MOST_BATCHES - 1) / MOST_BATCHES;
  return columns(s) ? blocks : size > LEAST_BLOCKS ? size : LEAST_BLOCKS;
}

/* ---- what is near a batch -------------------------------------------------------------------- */

/* Whether points of both, or of a copy a period away, may be closer than re. */
static bool within_reach(const mpsi_dynamics_source *s, const piece *a, const piece *b) {
  const double reach = s->g.radius * (1.0 + 1e-6);
  const int copies = s->g.period_x > 0.0;
  if (a->lo[1] - b->hi[1] > reach || b->lo[1] - a->hi[1] > reach) return false;
  for (int copy = -copies; copy <= copies; copy++) {
    const double shift = copy * s->g.period_x;
    if (a->lo[0] + shift - b->hi[0] <= reach && b->lo[0] - a->hi[0] - shift <= reach) return true;
  }
  return false;
}

/* Own pieces of the batch within reach of `p`. */
static int64_t list_near(const mpsi_dynamics_source *s, int64_t own, const piece *batch,
                         const piece *all, const piece *p, int64_t *near) {
  int64_t count = 0;
  if (!within_reach(s, all, p)) return 0;
  for (int64_t q = 0; q < own; q++)
    if (within_reach(s, &batch[q], p)) near[count++] = q;
  return count;
}

typedef struct selection {
  int64_t count;
  int64_t *number;
  double *x, *y;
} selection;

static void select_particle(const mpsi_dynamics_source *s, int64_t at, selection *out) {
  if (out->number)
    out->number[out->count] = at, out->x[out->count] = s->g.x[at], out->y[out->count] = s->g.y[at];
  out->count++;
}

/* Particles of the batch and those within reach, ascending; without room only counts. */
static void select_near(const mpsi_dynamics_source *s, int64_t own, const piece *batch,
                        const piece *all, int64_t *near, selection *out) {
  out->count = 0;
  for (int64_t c = 0; c < s->pieces; c++) {
    const piece *p = &s->piece[c];
    const bool taken = s->taken[p->block];
    const int64_t nears = taken ? 0 : list_near(s, own, batch, all, p, near);
    for (int64_t k = p->begin; (taken || nears > 0) && k < p->end; k++) {
      const int64_t at = number(s, k);
      const piece point = widened(empty(0, 0), s->g.x[at], s->g.y[at]);
      bool any = taken;
      for (int64_t q = 0; q < nears && !any; q++) any = within_reach(s, &point, &batch[near[q]]);
      if (any) select_particle(s, at, out);
    }
  }
}

static void free_selection(const mpsi_dynamics_source *s, selection *out) {
  MPSI_FREE(s->context, out->number, out->x);
  *out = (selection){0};
}

static mps_status make_selection(const mpsi_dynamics_source *s, selection *out) {
  int64_t own = 0, used = 0;
  piece all = empty(-1, 0);
  for (int64_t c = 0; c < s->pieces; c++) own += s->taken[s->piece[c].block];
  piece *batch = mpsi_alloc(s->context, own, sizeof *batch);
  int64_t *near = mpsi_alloc(s->context, own, sizeof *near);
  bool ok = batch && near;
  for (int64_t c = 0; ok && c < s->pieces; c++)
    if (s->taken[s->piece[c].block]) {
      batch[used++] = s->piece[c];
      all = widened(all, s->piece[c].lo[0], s->piece[c].lo[1]);
      all = widened(all, s->piece[c].hi[0], s->piece[c].hi[1]);
    }
  if (ok) {
    select_near(s, own, batch, &all, near, out);
    const int64_t count = out->count;
    out->number = mpsi_alloc(s->context, count, sizeof *out->number);
    out->x = mpsi_alloc(s->context, 2 * count, sizeof *out->x);
    ok = out->number && out->x;
    if (ok) {
      out->y = out->x + count;
      select_near(s, own, batch, &all, near, out);
    }
  }
  const mps_status status =
      ok ? MPS_OK : mpsi_fail_memory(s->context, s->function, (size_t)out->count * 24);
  MPSI_FREE(s->context, batch, near);
  return status;
}

/* All particles that are here, with columns. */
static mps_status select_all(const mpsi_dynamics_source *s, selection *out, int64_t **side) {
  out->number = mpsi_alloc(s->context, s->nears, sizeof *out->number);
  out->x = mpsi_alloc(s->context, 2 * s->nears, sizeof *out->x);
  *side = mpsi_alloc(s->context, s->nears, sizeof **side);
  if (!out->number || !out->x || !*side)
    return mpsi_fail_memory(s->context, s->function, (size_t)s->nears * 32);
  out->y = out->x + s->nears;
  for (int64_t k = 0; k < s->nears; k++) {
    select_particle(s, number(s, k), out);
    (*side)[k] = s->g.side[number(s, k)];
  }
  return MPS_OK;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

bool mpsi_dynamics_on_lattice(double spacing, int64_t count, const mpsi_dynamics_pair *pair) {
  for (int64_t k = 0; k < count; k++)
    if (pair[k].r0x != nearbyint(pair[k].r0x / spacing) * spacing ||
        pair[k].r0y != nearbyint(pair[k].r0y / spacing) * spacing)
      return false;
  return true;
}

mps_status mpsi_dynamics_source_pairs(mpsi_dynamics_source *s, int64_t blocks, const int32_t *block,
                                      int64_t *count, mpsi_dynamics_pair **pairs,
                                      int64_t *distinct) {
  selection near = {0};
  int64_t *side = NULL;
  uint8_t *keep = NULL;
  for (int64_t b = 0; b < blocks; b++) s->taken[block[b]] = 1;
  mps_status status = columns(s) ? select_all(s, &near, &side) : make_selection(s, &near);
  if (status == MPS_OK && !columns(s)) {
    keep = mpsi_alloc(s->context, near.count, 1);
    if (!keep) status = mpsi_fail_memory(s->context, s->function, (size_t)near.count);
    for (int64_t k = 0; keep && k < near.count; k++)
      keep[k] = s->taken[mpsi_dynamics_block_of(s->body, near.number[k])];
  }
  for (int64_t b = 0; b < blocks; b++) s->taken[block[b]] = 0;
  mpsi_dynamics_geometry g = s->g;
  g.count = near.count, g.x = near.x, g.y = near.y, g.side = side;
  if (status == MPS_OK)
    status = mpsi_dynamics_layout_pairs(s->context, s->function, &g, keep, count, pairs, distinct);
  for (int64_t k = 0; status == MPS_OK && k < *count; k++) {
    mpsi_dynamics_pair *p = &(*pairs)[k];
    int32_t *const end[4] = {&p->i, &p->j, &p->ti, &p->tj};
    for (int e = 0; e < 4; e++)
      if (*end[e] >= 0) *end[e] = (int32_t)near.number[*end[e]];
  }
  free_selection(s, &near);
  MPSI_FREE(s->context, side, keep);
  return status;
}
