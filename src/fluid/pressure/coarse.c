/* coarse.c - see coarse.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "coarse.h"
#include "fluid/base/loops.h"
#include "fluid/ranks/partition.h"

#include <string.h>

#define LEAST 5000    /* particles: below, the solution is faster without */
#define TILE 8.0      /* l0, side of an aggregate */
#define COARSER 1.5   /* of the side, where there are too many aggregates */
#define MOST_WORK 300 /* additions of a factorisation, a particle */
#define CLOSED 1e-6   /* tolerance of a fluid without surface, at least */
#define NOTHING 1e-8  /* of the diagonal: a row sum below is taken as 0 */

/* ---- aggregates ------------------------------------------------------------------------------ */

typedef struct box {
  double low[2], high[2];
} box;

static box bounds(const mps_fluid *f, int64_t begin, int64_t end) {
  box b = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
  for (int64_t i = begin; i < end; i++) {
    if (f->state[i] == MPSI_FLUID_APART) continue;
    for (int c = 0; c < 2; c++) {
      b.low[c] = f->x[c][i] < b.low[c] ? f->x[c][i] : b.low[c];
      b.high[c] = f->x[c][i] > b.high[c] ? f->x[c][i] : b.high[c];
    }
  }
  return b;
}

/* Sorts a block's particles into nx by ny tiles of its bounds: numbers from 1 on of the tiles that
 * have any, in `of`; returns how many these are. `number` has room for all tiles. */
static int32_t fill_tiles(mps_fluid *f, int64_t begin, int64_t end, const box *b, int64_t nx,
                          int64_t ny, int32_t *number) {
  int32_t *of = f->coarse->of, count = 0;
  const double width = b->high[0] - b->low[0], height = b->high[1] - b->low[1];
  const double by_x = (double)nx * (1.0 - 1e-12) / fmax(width, 1e-3 * f->l0),
               by_y = (double)ny * (1.0 - 1e-12) / fmax(height, 1e-3 * f->l0);
  memset(number, 0, (size_t)(nx * ny) * sizeof *number);
  for (int64_t i = begin; i < end; i++) {
    of[i] = -1;
    if (f->state[i] == MPSI_FLUID_APART) continue;
    const int64_t at = (int64_t)((f->x[0][i] - b->low[0]) * by_x),
                  up = (int64_t)((f->x[1][i] - b->low[1]) * by_y);
    of[i] = (int32_t)(at * ny + up);
    number[of[i]] = 1;
  }
  for (int64_t k = 0; k < nx * ny; k++)
    if (number[k]) number[k] = ++count;
  for (int64_t i = begin; i < end; i++) of[i] = of[i] < 0 ? 0 : number[of[i]];
  return count;
}

/* Tiles that are larger where the block is scattered. */
static void tile_block(mps_fluid *f, int64_t begin, int64_t end, int64_t block) {
  mpsi_fluid_coarse *c = f->coarse;
  const box b = bounds(f, begin, end);
  const double tiles = (double)(end - begin) * f->l0 * f->l0 / (c->side * c->side);
  int32_t *const number = (int32_t *)(f->system.p + begin); /* free as the step begins */
  c->own[block + 1] = 0;
  if (!(b.high[0] >= b.low[0])) {
    memset(c->of + begin, 0, (size_t)(end - begin) * sizeof *c->of);
    return;
  }
  for (double side = c->side;; side *= COARSER) {
    const double nx = fmax(1.0, rint((b.high[0] - b.low[0]) / side)),
                 ny = fmax(1.0, rint((b.high[1] - b.low[1]) / side));
    if (!(nx * ny <= 2.0 * (double)(end - begin))) continue;
    const int32_t count = fill_tiles(f, begin, end, &b, (int64_t)nx, (int64_t)ny, number);
    c->own[block + 1] = count;
    if (count <= 2.0 * tiles + 8.0) return;
  }
}

static void number_ghosts(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  for (int64_t g = begin; g < end; g++) f->coarse->of[f->count + g] = f->coarse->of[f->parent[g]];
}

static void number_block(mps_fluid *f, int64_t begin, int64_t end, int64_t block) {
  int32_t *of = f->coarse->of;
  const int32_t before = (int32_t)f->coarse->own[block];
  for (int64_t i = begin; i < end; i++)
    if (of[i] > 0) of[i] += before;
}

/* ---- A Z ------------------------------------------------------------------------------------- */

/* Weights of row i by the aggregates of its neighbours, of which there are no more than neighbours;
 * returns that of its own. */
static double split_row(const mps_fluid *f, int64_t i, mpsi_fluid_crowd *b) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i), *of = f->coarse->of, here = of[i];
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  double inside = 0.0;
  b->count = 0;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int32_t there = of[index[k]];
    if (there == here) inside += w[k];
    if (there == here || there == 0) continue;
    int32_t at = 0;
    while (at < b->count && b->index[at] != there) at++;
    if (at == b->count) b->index[at] = there, b->value[b->count++] = 0.0;
    b->value[at] += w[k];
  }
  return f->system.diagonal[i] - inside;
}

typedef struct row_pass {
  mps_fluid *fluid;
  atomic_bool full, crowded; /* of entries; of slots */
} row_pass;

/* The rows of a block as they are found. */
typedef struct block_rows {
  mpsi_fluid_coarse *coarse;
  double *entry;
  mpsi_fluid_coarse_at *at;
  int32_t *map, *list, slots;
  int64_t first, count;
} block_rows;

static void add_entry(block_rows *r, int64_t i, int32_t aggregate, double value) {
  if (r->map[aggregate] == 0) r->list[r->slots] = aggregate, r->map[aggregate] = ++r->slots;
  r->entry[r->count] = value;
  r->at[r->count++] =
      (mpsi_fluid_coarse_at){(uint16_t)(i - r->first), (uint16_t)(r->map[aggregate] - 1)};
}

static block_rows begin_rows(mpsi_fluid_coarse *c, int64_t b) {
  block_rows r = {.coarse = c,
                  .entry = c->entry + b * c->capacity,
                  .at = c->at + b * c->capacity,
                  .map = c->map + b * (c->aggregates + 1),
                  .list = c->list + b * (c->aggregates + 1),
                  .first = b * c->block};
  memset(r.map, 0, (size_t)(c->aggregates + 1) * sizeof *r.map);
  for (int64_t a = c->own[b] + 1; a <= c->own[b + 1]; a++)
    r.list[r.slots] = (int32_t)a, r.map[a] = ++r.slots;
  return r;
}

static void find_rows(void *data, int64_t b, int32_t worker) {
  row_pass *p = data;
  mps_fluid *f = p->fluid;
  mpsi_fluid_crowd *row = (mpsi_fluid_crowd *)f->crowd_room.item + worker;
  mpsi_fluid_coarse *c = f->coarse;
  const int64_t first = b * c->block,
                end = first + c->block < f->count ? first + c->block : f->count;
  const bool alone = !f->any_apart && f->classical.gamma == 0.0;
  block_rows r = begin_rows(c, b);
  for (int64_t i = first; i < end; i++) {
    const int32_t here = c->of[i];
    if (here == 0) continue;
    if (alone && f->local[i].h == 0.0 && !f->loops->mixed(f, i, c->of)) continue;
    const double own = split_row(f, i, row);
    if (row->count == 0 && own <= NOTHING * f->system.diagonal[i]) continue;
    const bool full = r.count + row->count + 1 > c->capacity,
               crowded = r.slots + row->count > UINT16_MAX;
    if (full) atomic_store(&p->full, true);
    if (crowded) atomic_store(&p->crowded, true);
    if (full || crowded) return;
    add_entry(&r, i, here, own);
    for (int32_t k = 0; k < row->count; k++) {
      const int32_t a = row->index[k];
      add_entry(&r, i, a, -row->value[k]);
      if (a < c->matrix.first[here - 1] + 1) c->matrix.first[here - 1] = a - 1;
    }
  }
  c->count[b] = r.count;
  f->system.sums[2 * b] = r.slots, f->system.sums[2 * b + 1] = 0.0;
}

static void add_rows(void *data, int64_t b, int32_t worker) {
  mps_fluid *f = data;
  mpsi_fluid_coarse *c = f->coarse;
  const mpsi_fluid_coarse_at *at = c->at + b * c->capacity;
  const double *entry = c->entry + b * c->capacity;
  const int32_t *slot = c->slot + c->slots[b], *of = c->of + b * c->block;
  for (int64_t k = 0; k < c->count[b]; k++) {
    const int32_t row = of[at[k].row] - 1, column = slot[at[k].slot] - 1;
    if (column <= row) *mpsi_envelope_at(&c->matrix, row, column) += entry[k];
  }
}

/* ---- the coarse equation --------------------------------------------------------------------- */

/* This rank's blocks. */
static int64_t first_block(const mps_fluid *f) { return f->own[0] / f->coarse->block; }
static int64_t end_block(const mps_fluid *f) {
  return (f->own[1] + f->coarse->block - 1) / f->coarse->block;
}

/* Sends this rank's values [first, end) of `count` to all. */
static void send_values(mps_fluid *f, int64_t count, double *values, int64_t first, int64_t end) {
  if (!f->partition) return;
  for (int64_t k = 0; k < count; k++)
    if (k < first || k >= end) values[k] = -INFINITY;
  mpsi_fluid_reduce_max(f, count, values);
}

static bool fit(mps_fluid *f, mpsi_room *memory, int64_t count, size_t size) {
  return mpsi_room_ensure(f->context, memory, count, size);
}

static mps_status make_aggregates(mps_fluid *f, const char *function) {
  mpsi_fluid_coarse *c = f->coarse;
  mps_status status = MPS_OK;
  if (!fit(f, &c->block_room, 3 * (c->blocks + 1), sizeof *c->own) ||
      !fit(f, &c->of_room, f->count + f->ghosts, sizeof *c->of))
    status = mpsi_fail_memory(f->context, function, (size_t)(f->count + f->ghosts) * sizeof *c->of);
  status = mpsi_fluid_agree(f, function, status);
  if (status != MPS_OK) return status;
  c->of = c->of_room.item;
  c->own = c->block_room.item, c->slots = c->own + c->blocks + 1;
  c->count = c->slots + c->blocks + 1;
  mpsi_fluid_for_all(f, f->count, c->block, tile_block);
  c->own[0] = 0;
  for (int64_t b = 0; b < c->blocks; b++) c->own[b + 1] += c->own[b];
  c->aggregates = c->own[c->blocks];
  mpsi_fluid_for_all(f, f->count, c->block, number_block);
  mpsi_fluid_for_all(f, f->ghosts, MPSI_FLUID_COPIED, number_ghosts);
  const int64_t maps = c->blocks * (c->aggregates + 1);
  if (!fit(f, &c->map_room, maps, sizeof *c->map) ||
      !fit(f, &c->list_room, maps, sizeof *c->list) ||
      !fit(f, &c->value_room, c->aggregates + 1, sizeof *c->value))
    status = mpsi_fail_memory(f->context, function, (size_t)maps * sizeof *c->map);
  c->map = c->map_room.item, c->list = c->list_room.item, c->value = c->value_room.item;
  return mpsi_fluid_agree(f, function, status);
}

/* *crowded: a block has more slots than its entries can index. */
static mps_status make_rows(mps_fluid *f, const char *function, bool *crowded) {
  mpsi_fluid_coarse *c = f->coarse;
  row_pass p = {.fluid = f};
  for (;;) {
    mps_status status = MPS_OK;
    c->capacity = c->block * c->most / 16;
    const int64_t all = c->capacity * c->blocks;
    if (!mpsi_room_fit(f->context, &c->entry_room, all, sizeof *c->entry) ||
        !mpsi_room_fit(f->context, &c->at_room, all, sizeof *c->at) ||
        !mpsi_envelope_begin(f->context, &c->matrix, c->aggregates))
      status = mpsi_fail_memory(f->context, function, (size_t)all * 12);
    c->entry = c->entry_room.item, c->at = c->at_room.item;
    atomic_store(&p.full, false), atomic_store(&p.crowded, false);
    if (status == MPS_OK) mpsi_fluid_units(f, c->block, find_rows, &p);
    double flag[2] = {atomic_load(&p.full), atomic_load(&p.crowded)};
    status = mpsi_fluid_agree_max(f, function, status, 2, flag);
    *crowded = flag[1] > 0.0;
    if (status != MPS_OK || flag[0] == 0.0) return status;
    c->most += 1 + c->most / 32;
  }
}

/* The slots of all blocks one after the other, and where the rows of E begin. */
static mps_status join_slots(mps_fluid *f, const char *function) {
  mpsi_fluid_coarse *c = f->coarse;
  mps_status status = MPS_OK;
  mpsi_fluid_send_sums(f, c->block);
  c->slots[0] = 0;
  for (int64_t b = 0; b < c->blocks; b++)
    c->slots[b + 1] = c->slots[b] + (int64_t)f->system.sums[2 * b];
  const int64_t all = c->slots[c->blocks];
  if (!fit(f, &c->slot_room, all, sizeof *c->slot) || !fit(f, &c->part_room, all, sizeof *c->part))
    status = mpsi_fail_memory(f->context, function, (size_t)all * 12);
  status = mpsi_fluid_agree(f, function, status);
  if (status != MPS_OK) return status;
  c->slot = c->slot_room.item, c->part = c->part_room.item;
  for (int64_t b = first_block(f); b < end_block(f); b++)
    for (int64_t k = c->slots[b]; k < c->slots[b + 1]; k++)
      c->part[k] = c->list[b * (c->aggregates + 1) + k - c->slots[b]];
  send_values(f, all, c->part, c->slots[first_block(f)], c->slots[end_block(f)]);
  for (int64_t k = 0; k < all; k++) c->slot[k] = (int32_t)c->part[k];
  for (int64_t a = 0; a < c->aggregates; a++) c->value[a] = -c->matrix.first[a];
  send_values(f, c->aggregates, c->value, c->own[first_block(f)], c->own[end_block(f)]);
  for (int64_t a = 0; a < c->aggregates; a++) c->matrix.first[a] = (int32_t)-c->value[a];
  return mpsi_fluid_lost(f, function);
}

static mps_status make_matrix(mps_fluid *f, const char *function) {
  mpsi_fluid_coarse *c = f->coarse;
  mpsi_envelope *e = &c->matrix;
  mps_status status = MPS_OK;
  if (!mpsi_envelope_make(f->context, e))
    status = mpsi_fail_memory(f->context, function, (size_t)e->entries * sizeof *e->value);
  MPSI_TRY(mpsi_fluid_agree(f, function, status));
  mpsi_fluid_units(f, c->block, add_rows, f);
  const int64_t low = c->own[first_block(f)], high = c->own[end_block(f)];
  send_values(f, e->entries, e->value, low < e->rows ? e->start[low] : e->entries,
              high < e->rows ? e->start[high] : e->entries);
  send_values(f, e->rows, e->diagonal, low, high);
  mpsi_envelope_factor(e);
  return mpsi_fluid_lost(f, function);
}

/* Without a surface A is singular but for 1e-10 of its diagonal, and so is E: its solutions add
 * some 1e-7 of the right side to the residual. */
bool mpsi_fluid_has_coarse(const mps_fluid *f) {
  return f->count >= LEAST && (f->report.surface > 0 || f->def.tolerance >= CLOSED);
}

mps_status mpsi_fluid_coarsen(mps_fluid *f, const char *function, int64_t block, int64_t blocks) {
  mpsi_fluid_coarse *c = f->coarse;
  mps_status status = MPS_OK;
  c->used = false;
  if (!mpsi_fluid_has_coarse(f)) return MPS_OK;
  c->block = block, c->blocks = blocks;
  c->side = TILE * f->l0;
  for (bool small = false; status == MPS_OK && !small; c->side *= COARSER) {
    bool crowded = false;
    status = make_aggregates(f, function);
    if (status == MPS_OK) status = make_rows(f, function, &crowded);
    if (crowded) continue;
    if (status == MPS_OK) status = join_slots(f, function);
    small =
        c->aggregates <= blocks || mpsi_envelope_work(&c->matrix) <= MOST_WORK * (double)f->count;
  }
  if (status == MPS_OK) status = make_matrix(f, function);
  c->used = status == MPS_OK;
  return status;
}

/* ---- deflation ------------------------------------------------------------------------------- */

void mpsi_fluid_coarse_restrict(mps_fluid *f, int64_t b, const double *v) {
  mpsi_fluid_coarse *c = f->coarse;
  const mpsi_fluid_coarse_at *at = c->at + b * c->capacity;
  const double *entry = c->entry + b * c->capacity, *own = v + b * c->block;
  double *part = c->part + c->slots[b];
  memset(part, 0, (size_t)(c->slots[b + 1] - c->slots[b]) * sizeof *part);
  for (int64_t k = 0; k < c->count[b]; k++) part[at[k].slot] += entry[k] * own[at[k].row];
}

void mpsi_fluid_coarse_solve(mps_fluid *f) {
  mpsi_fluid_coarse *c = f->coarse;
  const int64_t all = c->slots[c->blocks];
  send_values(f, all, c->part, c->slots[first_block(f)], c->slots[end_block(f)]);
  memset(c->value, 0, (size_t)(c->aggregates + 1) * sizeof *c->value);
  for (int64_t k = 0; k < all; k++) c->value[c->slot[k]] += c->part[k];
  mpsi_envelope_solve(&c->matrix, c->value + 1);
}

static void sum_residual(void *data, int64_t b, int32_t worker) {
  mps_fluid *f = data;
  mpsi_fluid_coarse *c = f->coarse;
  const int64_t end = (b + 1) * c->block < f->count ? (b + 1) * c->block : f->count;
  double *part = c->part + c->slots[b];
  memset(part, 0, (size_t)(c->slots[b + 1] - c->slots[b]) * sizeof *part);
  for (int64_t i = b * c->block; i < end; i++)
    if (c->of[i] > 0) part[c->of[i] - 1 - c->own[b]] += f->system.r[i];
}

static void correct(void *data, int64_t b, int32_t worker) {
  mps_fluid *f = data;
  const mpsi_fluid_coarse *c = f->coarse;
  const int64_t end = (b + 1) * c->block < f->count ? (b + 1) * c->block : f->count;
  double *r = f->system.r, rr = 0.0;
  mpsi_fluid_coarse_subtract(c, b, r);
  for (int64_t i = b * c->block; i < end; i++) {
    f->system.x[i] += c->value[c->of[i]];
    rr += r[i] * r[i];
  }
  f->system.sums[2 * b] = rr, f->system.sums[2 * b + 1] = 0.0;
}

double mpsi_fluid_coarse_start(mps_fluid *f) {
  mpsi_fluid_coarse *c = f->coarse;
  double rr = 0.0;
  mpsi_fluid_units(f, c->block, sum_residual, f);
  mpsi_fluid_coarse_solve(f);
  mpsi_fluid_units(f, c->block, correct, f);
  mpsi_fluid_send_sums(f, c->block);
  for (int64_t b = 0; b < c->blocks; b++) rr += f->system.sums[2 * b];
  return rr;
}

/* ---- life ------------------------------------------------------------------------------------ */

bool mpsi_fluid_coarse_create(mps_fluid *f) {
  f->coarse = mpsi_alloc(f->context, 1, sizeof *f->coarse);
  if (f->coarse) f->coarse->most = 24;
  return f->coarse != NULL;
}

void mpsi_fluid_coarse_drop(mps_fluid *f) {
  mpsi_fluid_coarse *c = f->coarse;
  if (!c) return;
  MPSI_FREE(f->context, c->block_room.item, c->of_room.item, c->map_room.item, c->list_room.item,
            c->at_room.item, c->entry_room.item, c->slot_room.item, c->part_room.item,
            c->value_room.item);
  mpsi_envelope_drop(f->context, &c->matrix);
  mpsi_free(f->context, c);
  f->coarse = NULL;
}

int64_t mpsi_fluid_coarse_bytes(const mps_fluid *f) {
  const mpsi_fluid_coarse *c = f->coarse;
  return (c->of_room.capacity + c->map_room.capacity + c->list_room.capacity +
          c->slot_room.capacity + c->matrix.first_room.capacity) *
             4 +
         (c->part_room.capacity + c->value_room.capacity + c->matrix.start_room.capacity +
          c->matrix.value_room.capacity) *
             8 +
         c->at_room.capacity * 4 + c->entry_room.capacity * 8;
}
