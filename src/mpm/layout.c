/* layout.c - the grid that follows the particles: particles sorted by blocks of cells, and the list
 * of blocks of nodes that their tiles need. Both lists ascend in y, then x.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include "core/particles_internal.h"

#include <string.h>

#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)
#define LEAST_ROOM 16 /* items: a small body that moves about needs no more */

bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size) {
  if (count <= room->capacity) return true;
  const int64_t capacity = count < LEAST_ROOM ? LEAST_ROOM : count + count / 2;
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

/* Lowest nodes of all stencils: the first and last block of each axis. */
static void find_range(const mps_mpm *mpm, int64_t low[2], int64_t high[2]) {
  for (int c = 0; c < 2; c++) {
    low[c] = INT64_MAX, high[c] = INT64_MIN;
    for (int64_t k = 0; k < mpm->count; k++) {
      const int64_t block =
          mpsi_block_of(mpsi_base(mpm->def.spline, mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k])));
      if (block < low[c]) low[c] = block;
      if (block > high[c]) high[c] = block;
    }
  }
}

/* Key: block row, block column, then the node within the block, row by row. */
static void make_keys(mps_mpm *mpm, const int64_t low[2], int bits_x) {
  for (int64_t k = 0; k < mpm->count; k++) {
    uint64_t block[2], node[2];
    for (int c = 0; c < 2; c++) {
      const int64_t base = mpsi_base(mpm->def.spline, mpsi_grid_coordinate(mpm, c, mpm->p.x[c][k]));
      const int64_t b = mpsi_block_of(base);
      block[c] = (uint64_t)(b - low[c]);
      node[c] = (uint64_t)(base - b * MPSI_SIDE);
    }
    const uint64_t whole = block[1] << bits_x | block[0];
    mpm->radix[k] = (mpsi_radix){whole * MPSI_OWN + node[1] * MPSI_SIDE + node[0], k};
  }
}

/* Stable, from the lowest digit up; returns the sorted half of `radix`. */
static const mpsi_radix *sort_keys(mps_mpm *mpm, int bits) {
  mpsi_radix *from = mpm->radix, *to = mpm->radix + mpm->count;
  for (int shift = 0; shift < bits; shift += DIGIT_BITS) {
    int64_t place[DIGITS] = {0};
    for (int64_t k = 0; k < mpm->count; k++) place[from[k].key >> shift & (DIGITS - 1)]++;
    for (int64_t digit = 0, sum = 0; digit < DIGITS; digit++) {
      const int64_t here = place[digit];
      place[digit] = sum;
      sum += here;
    }
    for (int64_t k = 0; k < mpm->count; k++)
      to[place[from[k].key >> shift & (DIGITS - 1)]++] = from[k];
    mpsi_radix *swap = from;
    from = to;
    to = swap;
  }
  return from;
}

/* ---- blocks ---------------------------------------------------------------------------------- */

/* Blocks of the sorted keys; the count alone where `cells` is NULL. */
static int64_t make_cells(const mps_mpm *mpm, const mpsi_radix *key, const int64_t low[2],
                          int bits_x, mpsi_cells *cells) {
  int64_t count = 0;
  for (int64_t k = 0; k < mpm->count; k++) {
    const uint64_t block = key[k].key / MPSI_OWN;
    if (k > 0 && block == key[k - 1].key / MPSI_OWN) continue;
    if (cells) {
      if (count > 0) cells[count - 1].end = k;
      const uint64_t column = block & ((UINT64_C(1) << bits_x) - 1);
      cells[count] = (mpsi_cells){.begin = k,
                                  .end = mpm->count,
                                  .at = {(int32_t)((int64_t)column + low[0]),
                                         (int32_t)((int64_t)(block >> bits_x) + low[1])},
                                  .near = -1,
                                  .bad = -1};
      for (int c = 0; c < 2; c++) {
        const int64_t first = (int64_t)cells[count].at[c] * MPSI_SIDE;
        if (first < mpm->low[c] || first + MPSI_TILE_SIDE - 1 > mpm->high[c])
          cells[count].edge = true;
      }
    }
    count++;
  }
  return count;
}

static bool before(const int32_t *a, const int32_t *b) {
  return a[1] != b[1] ? a[1] < b[1] : a[0] < b[0];
}

/* The sorted list of blocks shifted by (0,0), (1,0), (0,1), (1,1) gives four sorted lists; merging
 * them gives the blocks of nodes, and tells which tiles cover which. The count alone where `nodes`
 * is NULL. */
static int64_t make_nodes(mpsi_cells *cells, int64_t cell_count, mpsi_nodes *nodes) {
  int64_t head[4] = {0}, count = 0;
  for (;;) {
    int32_t at[4][2], least[2];
    bool any = false;
    for (int q = 0; q < 4; q++) {
      if (head[q] == cell_count) continue;
      at[q][0] = cells[head[q]].at[0] + (q & 1);
      at[q][1] = cells[head[q]].at[1] + (q >> 1);
      if (!any || before(at[q], least)) memcpy(least, at[q], sizeof least);
      any = true;
    }
    if (!any) return count;
    if (nodes) nodes[count] = (mpsi_nodes){{least[0], least[1]}, {-1, -1, -1, -1}};
    for (int q = 0; q < 4; q++) {
      if (head[q] == cell_count || before(least, at[q])) continue;
      if (nodes) {
        nodes[count].from[q] = (int32_t)head[q];
        cells[head[q]].to[q] = (int32_t)count;
      }
      head[q]++;
    }
    count++;
  }
}

static mps_status build_blocks(mps_mpm *mpm, const char *function, const mpsi_radix *key,
                               const int64_t low[2], int bits_x) {
  mps_context *context = mpm->context;
  const int64_t cells = make_cells(mpm, key, low, bits_x, NULL);
  bool good = mpsi_room_ensure(context, &mpm->cells_room, cells, sizeof *mpm->cells) &&
              mpsi_room_ensure(context, &mpm->tile_room, cells, sizeof *mpm->tile);
  if (good) {
    mpm->cells = mpm->cells_room.item;
    mpm->tile = mpm->tile_room.item;
    mpm->cell_count = make_cells(mpm, key, low, bits_x, mpm->cells);
    mpm->node_count = make_nodes(mpm->cells, cells, NULL);
    good = mpsi_room_ensure(context, &mpm->nodes_room, mpm->node_count, sizeof *mpm->nodes) &&
           mpsi_room_ensure(context, &mpm->node_room, mpm->node_count, sizeof *mpm->node);
  }
  if (!good) {
    mpm->cell_count = mpm->node_count = 0;
    return mpsi_fail_memory(context, function, (size_t)cells * sizeof *mpm->tile);
  }
  mpm->nodes = mpm->nodes_room.item;
  mpm->node = mpm->node_room.item;
  make_nodes(mpm->cells, cells, mpm->nodes);
  return MPS_OK;
}

mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function) {
  int64_t low[2], high[2];
  find_range(mpm, low, high);
  const int bits_x = bits_of((uint64_t)(high[0] - low[0]));
  const int bits = bits_x + bits_of((uint64_t)(high[1] - low[1])) + bits_of(MPSI_OWN - 1);
  make_keys(mpm, low, bits_x);
  const mpsi_radix *key = sort_keys(mpm, bits);
  const mps_status status = build_blocks(mpm, function, key, low, bits_x);
  if (status != MPS_OK) return status;
  bool sorted = true;
  for (int64_t k = 0; k < mpm->count; k++) {
    mpm->order[k] = key[k].index;
    sorted = sorted && key[k].index == k;
  }
  mpm->stale = false;
  return sorted ? MPS_OK
                : mpsi_particles_permute_in(mpm->particles, function, mpm->order, mpm->scratch);
}
