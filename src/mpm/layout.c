/* layout.c - the grid that follows the particles: particles sorted by blocks of cells, and the list
 * of blocks of nodes that their tiles need. Both lists ascend in z, then y,
 * then x.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include "core/particles_internal.h"

#include <string.h>

#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)
#define LEAST_ROOM 16 /* items */

bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  /* exact at first, then a little more than asked for: a body that moves needs no more */
  int64_t capacity = room->capacity > 0 ? count + count / 4 : count;
  if (capacity < LEAST_ROOM) capacity = LEAST_ROOM;
  void *item = mpsi_alloc(context, capacity, size);
  if (!item) return false;
  mpsi_free(context, room->item);
  room->item = item;
  room->capacity = capacity;
  return true;
}

/* ---- order of the particles ------------------------------------------------------------------ */

static int bits_of(uint64_t range) {
  int bits = 0;
  while (range >> bits) bits++;
  return bits;
}

/* First and last block of each axis. */
typedef struct range {
  int64_t low[3];
  int bits[3]; /* of the blocks along each axis */
} range;

static int64_t base_of(const mps_mpm *mpm, int c, int64_t particle) {
  const double X = mpsi_grid_coordinate(mpm, c, mpm->p.x[c][particle]);
  return (int64_t)mpsi_base(mpm->def.spline, X);
}

static range find_range(const mps_mpm *mpm) {
  range out = {{0}, {0}};
  for (int c = 0; c < mpm->dim; c++) {
    int64_t low = INT64_MAX, high = INT64_MIN;
    for (int64_t k = 0; k < mpm->p.count; k++) {
      const int64_t block = mpsi_block_of(base_of(mpm, c, k));
      if (block < low) low = block;
      if (block > high) high = block;
    }
    out.low[c] = low;
    out.bits[c] = bits_of((uint64_t)(high - low));
  }
  return out;
}

/* Key: block (z, y, x from the top), then the stencil's place within the block, row by row. */
static void make_keys(mps_mpm *mpm, const range *r) {
  for (int64_t k = 0; k < mpm->p.count; k++) {
    uint64_t whole = 0, within = 0;
    for (int c = mpm->dim - 1; c >= 0; c--) {
      const int64_t base = base_of(mpm, c, k), block = mpsi_block_of(base);
      whole = whole << r->bits[c] | (uint64_t)(block - r->low[c]);
      within = within * MPSI_SIDE + (uint64_t)(base - 1 - block * MPSI_SIDE);
    }
    mpm->grid.radix[k] = (mpsi_radix){whole * (uint64_t)mpm->grid.block_nodes + within, k};
  }
}

/* Stable, from the lowest digit up; returns the sorted half of `radix`. */
static const mpsi_radix *sort_keys(mps_mpm *mpm, int bits) {
  mpsi_radix *from = mpm->grid.radix, *to = mpm->grid.radix + mpm->p.count;
  for (int shift = 0; shift < bits; shift += DIGIT_BITS) {
    int64_t place[DIGITS] = {0};
    for (int64_t k = 0; k < mpm->p.count; k++) place[from[k].key >> shift & (DIGITS - 1)]++;
    for (int64_t digit = 0, sum = 0; digit < DIGITS; digit++) {
      const int64_t here = place[digit];
      place[digit] = sum;
      sum += here;
    }
    for (int64_t k = 0; k < mpm->p.count; k++)
      to[place[from[k].key >> shift & (DIGITS - 1)]++] = from[k];
    mpsi_radix *swap = from;
    from = to;
    to = swap;
  }
  return from;
}

/* ---- blocks ---------------------------------------------------------------------------------- */

static void find_edge(const mps_mpm *mpm, mpsi_cell_block *cells) {
  for (int c = 0; c < mpm->dim; c++) {
    const int64_t first = (int64_t)cells->at[c] * MPSI_SIDE;
    if (first < mpm->grid.low[c] || first + MPSI_TILE_SIDE - 1 > mpm->grid.high[c])
      cells->edge = true;
  }
}

static void place_block(const mps_mpm *mpm, const range *r, uint64_t block,
                        mpsi_cell_block *cells) {
  for (int c = 0; c < mpm->dim; c++) {
    cells->at[c] = (int32_t)((int64_t)(block & ((UINT64_C(1) << r->bits[c]) - 1)) + r->low[c]);
    block >>= r->bits[c];
  }
  find_edge(mpm, cells);
}

/* Widens the part of the tile in use by a stencil, and by a cell to either side. */
static void widen_use(const mps_mpm *mpm, uint64_t within, mpsi_cell_block *cells) {
  for (int c = 0; c < mpm->dim; c++, within /= MPSI_SIDE) {
    const int32_t low = (int32_t)(within % MPSI_SIDE);
    const int32_t high = low + 3 + mpsi_reach(mpm, c);
    if (low < cells->low[c]) cells->low[c] = low;
    if (high > cells->high[c]) cells->high[c] = high;
  }
}

/* Blocks of the sorted keys; the count alone where `cells` is NULL. */
static int64_t make_cells(const mps_mpm *mpm, const mpsi_radix *key, const range *r,
                          mpsi_cell_block *cells) {
  const uint64_t own = (uint64_t)mpm->grid.block_nodes;
  int64_t count = 0;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    const uint64_t block = key[k].key / own;
    if (k == 0 || block != key[k - 1].key / own) {
      if (cells) {
        if (count > 0) cells[count - 1].end = k;
        cells[count] = (mpsi_cell_block){.begin = k, .end = mpm->p.count, .bad = -1};
        for (int c = 0; c < 3; c++)
          cells[count].low[c] = c < mpm->dim ? MPSI_TILE_SIDE : 0, cells[count].high[c] = 1;
        place_block(mpm, r, block, &cells[count]);
      }
      count++;
    }
    if (cells) widen_use(mpm, key[k].key % own, &cells[count - 1]);
  }
  return count;
}

static bool before(const int32_t *a, const int32_t *b) {
  for (int c = 2; c > 0; c--)
    if (a[c] != b[c]) return a[c] < b[c];
  return a[0] < b[0];
}

/* The sorted list of blocks shifted to each corner of a tile gives sorted lists; merging them gives
 * the blocks of nodes, and tells which tiles cover which. The count alone where `nodes` is NULL. */
static int64_t make_nodes(mps_mpm *mpm, mpsi_node_block *nodes) {
  mpsi_cell_block *cells = mpm->grid.cells;
  const int corners = 1 << mpm->dim;
  int64_t head[MPSI_CORNERS] = {0}, count = 0;
  for (;;) {
    int32_t at[MPSI_CORNERS][3], least[3];
    bool any = false;
    for (int q = 0; q < corners; q++) {
      if (head[q] == mpm->grid.cell_count) continue;
      for (int c = 0; c < 3; c++) at[q][c] = cells[head[q]].at[c] + (q >> c & 1);
      if (!any || before(at[q], least)) memcpy(least, at[q], sizeof least);
      any = true;
    }
    if (!any) return count;
    if (nodes) {
      nodes[count] = (mpsi_node_block){.side = -1, .near = -1};
      memcpy(nodes[count].at, least, sizeof least);
    }
    for (int q = 0; q < corners; q++) {
      if (head[q] == mpm->grid.cell_count || before(least, at[q])) continue;
      cells[head[q]].to[q] = (int32_t)count;
      head[q]++;
    }
    count++;
  }
}

/* Same colour: the same parities of the block coordinates. */
static void sort_colours(mps_mpm *mpm) {
  int64_t count = 0;
  for (int colour = 0; colour < MPSI_CORNERS; colour++) {
    mpm->grid.colour[colour] = count;
    for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
      const int32_t *at = mpm->grid.cells[b].at;
      if (((at[0] & 1) | (at[1] & 1) << 1 | (at[2] & 1) << 2) == colour)
        mpm->grid.coloured[count++] = (int32_t)b;
    }
  }
  mpm->grid.colour[MPSI_CORNERS] = count;
}

static bool ensure_cells(mps_mpm *mpm, int64_t cells) {
  const bool good =
      mpsi_room_ensure(mpm->context, &mpm->grid.cells_room, cells, sizeof *mpm->grid.cells) &&
      mpsi_room_ensure(mpm->context, &mpm->grid.coloured_room, cells, sizeof *mpm->grid.coloured);
  mpm->grid.cell_count = mpm->grid.node_count = 0;
  mpm->grid.cells = mpm->grid.cells_room.item;
  mpm->grid.coloured = mpm->grid.coloured_room.item;
  return good;
}

/* What follows from the blocks of cells. */
static bool build_nodes(mps_mpm *mpm, int64_t cells) {
  mpm->grid.cell_count = cells;
  sort_colours(mpm);
  const int64_t nodes = make_nodes(mpm, NULL);
  if (!mpsi_room_ensure(mpm->context, &mpm->grid.nodes_room, nodes, sizeof *mpm->grid.nodes) ||
      !mpsi_room_ensure(mpm->context, &mpm->grid.node_room, nodes * mpm->grid.block_nodes,
                        sizeof *mpm->grid.node)) {
    mpm->grid.cell_count = 0;
    return false;
  }
  mpm->grid.node_count = nodes;
  mpm->grid.nodes = mpm->grid.nodes_room.item;
  mpm->grid.node = mpm->grid.node_room.item;
  make_nodes(mpm, mpm->grid.nodes);
  return true;
}

static mps_status no_room(mps_mpm *mpm, const char *function, int64_t cells) {
  return mpsi_fail_memory(mpm->context, function,
                          (size_t)(cells * mpm->grid.block_nodes) * sizeof *mpm->grid.node);
}

static mps_status build_blocks(mps_mpm *mpm, const char *function, const mpsi_radix *key,
                               const range *r) {
  const int64_t cells = make_cells(mpm, key, r, NULL);
  if (!ensure_cells(mpm, cells)) return no_room(mpm, function, cells);
  make_cells(mpm, key, r, mpm->grid.cells);
  return build_nodes(mpm, cells) ? MPS_OK : no_room(mpm, function, cells);
}

mps_status mpsi_mpm_place_blocks(mps_mpm *mpm, const char *function, int64_t count,
                                 const mpsi_block *block) {
  if (!ensure_cells(mpm, count)) return no_room(mpm, function, count);
  for (int64_t k = 0; k < count; k++) {
    const int64_t end = k + 1 < count ? block[k + 1][0] : mpm->p.count;
    mpm->grid.cells[k] = (mpsi_cell_block){.begin = block[k][0], .end = end, .bad = -1};
    for (int c = 0; c < 3; c++) {
      mpm->grid.cells[k].at[c] = (int32_t)block[k][MPSI_BLOCK_AT + c];
      mpm->grid.cells[k].low[c] = (int32_t)block[k][MPSI_BLOCK_LOW + c];
      mpm->grid.cells[k].high[c] = (int32_t)block[k][MPSI_BLOCK_HIGH + c];
    }
    find_edge(mpm, &mpm->grid.cells[k]);
  }
  return build_nodes(mpm, count) ? MPS_OK : no_room(mpm, function, count);
}

mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function) {
  const range r = find_range(mpm);
  make_keys(mpm, &r);
  const mpsi_radix *key = sort_keys(mpm, r.bits[0] + r.bits[1] + r.bits[2] +
                                             bits_of((uint64_t)mpm->grid.block_nodes - 1));
  const mps_status status = build_blocks(mpm, function, key, &r);
  if (status != MPS_OK) return status;
  /* The other half of `radix` is free now: for the order, and room to permute. */
  int64_t *order =
      (int64_t *)(key == mpm->grid.radix ? mpm->grid.radix + mpm->p.count : mpm->grid.radix);
  bool sorted = true;
  for (int64_t k = 0; k < mpm->p.count; k++) {
    order[k] = key[k].index;
    sorted = sorted && key[k].index == k;
  }
  mpm->run.stale = false;
  return sorted ? MPS_OK
                : mpsi_particles_permute_in(mpm->particles, function, order, order + mpm->p.count);
}
