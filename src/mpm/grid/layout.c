/* layout.c - the blocks of cells with particles, and the blocks of nodes that their tiles
 * need. Both lists ascend in z, then y, then x. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/run.h"
#include "mpm/grid/blocks.h"
#include "mpm/contact/thin_bodies.h"
#include "mpm/ranks/partition.h"
#include "core/base/room_array.h"
#include "core/particles/particles_internal.h"

#include <string.h>

/* ---- blocks ---------------------------------------------------------------------------------- */

/* Extends the part of the tile in use to a stencil, with one more cell on either side. */
static void widen_use(const mpsi_grid *grid, uint64_t within, mpsi_cell_block *cells) {
  for (int c = 0; c < grid->dim; c++, within /= MPSI_SIDE) {
    const int32_t low = (int32_t)(within % MPSI_SIDE);
    const int32_t high = low + 3 + mpsi_reach(grid, c);
    if (low < cells->low[c]) cells->low[c] = low;
    if (high > cells->high[c]) cells->high[c] = high;
  }
}

/* ---- the sorted keys, in chunks -------------------------------------------------------------- */

#define CHUNKS 64
#define LEAST_CHUNK 4096 /* particles */

typedef struct key_chunks {
  mps_context *context;
  const mpsi_grid *grid;
  const mpsi_columns *p;
  int64_t length;        /* particles in a chunk */
  int64_t first[CHUNKS]; /* number of blocks that begin in the chunk; then the index of the first of
                            them */
  mpsi_cell_block *cells; /* NULL: they are only counted */
  int64_t *order;         /* result of list_order */
  bool in_order[CHUNKS];  /* its particles are in order already */
} key_chunks;

static int32_t for_chunks(key_chunks *c, void (*work)(void *data, int64_t chunk, int32_t worker)) {
  c->length = (c->p->count + CHUNKS - 1) / CHUNKS;
  if (c->length < LEAST_CHUNK) c->length = LEAST_CHUNK;
  const int64_t chunks = (c->p->count + c->length - 1) / c->length;
  mpsi_parallel_for(c->context, chunks, work, c);
  return (int32_t)chunks;
}

static int64_t end_of_chunk(const key_chunks *c, int64_t chunk) {
  const int64_t end = (chunk + 1) * c->length;
  return end < c->p->count ? end : c->p->count;
}

/* Counts the blocks that begin in a chunk, or lists them. */
static void find_begins(void *data, int64_t chunk, int32_t worker) {
  key_chunks *c = data;
  const mpsi_grid *grid = c->grid;
  const mpsi_radix *key = grid->sorted;
  const int64_t end = end_of_chunk(c, chunk);
  int64_t number = c->cells ? c->first[chunk] : 0;
  for (int64_t k = chunk * c->length; k < end; k++) {
    if (k > 0 && key[k].key >> grid->own_bits == key[k - 1].key >> grid->own_bits) continue;
    if (c->cells) c->cells[number] = (mpsi_cell_block){.begin = k, .bad = -1};
    number++;
  }
  if (!c->cells) c->first[chunk] = number;
}

/* Number of blocks of cells in the sorted keys. */
static int64_t count_cells(key_chunks *c) {
  int64_t sum = 0;
  const int32_t chunks = for_chunks(c, find_begins);
  for (int32_t k = 0; k < chunks; k++) {
    const int64_t here = c->first[k];
    c->first[k] = sum;
    sum += here;
  }
  return sum;
}

static void make_cells(key_chunks *c, int64_t count, mpsi_cell_block *cells) {
  c->cells = cells;
  for_chunks(c, find_begins);
  for (int64_t b = 0; b < count; b++)
    cells[b].end = b + 1 < count ? cells[b + 1].begin : c->p->count;
}

/* Lists a chunk of the order for mpsi_particles_permute_in. */
static void list_chunk(void *data, int64_t chunk, int32_t worker) {
  key_chunks *c = data;
  const int64_t end = end_of_chunk(c, chunk);
  c->in_order[chunk] = true;
  for (int64_t k = chunk * c->length; k < end; k++) {
    c->order[k] = c->grid->sorted[k].index;
    if (c->order[k] != k) c->in_order[chunk] = false;
  }
}

/* Lists the order; returns whether the particles are in it already. */
static bool list_order(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                       int64_t *order) {
  key_chunks c = {.context = context, .grid = grid, .p = p, .order = order};
  bool in_order = true;
  const int32_t chunks = for_chunks(&c, list_chunk);
  for (int32_t k = 0; k < chunks; k++) in_order = in_order && c.in_order[k];
  return in_order;
}

/* Orders particles [begin, end) of one stencil by their ids, so that the result does not depend on
 * former sorts. Shell sort: few steps where they are nearly in order. */
static void order_by_id(mpsi_radix *key, const int64_t *id, int64_t begin, int64_t end) {
  static const int64_t gap[] = {701, 301, 132, 57, 23, 10, 4, 1};
  for (size_t g = 0; g < sizeof gap / sizeof *gap; g++)
    for (int64_t k = begin + gap[g]; k < end; k++) {
      const int64_t index = key[k].index;
      int64_t at = k;
      for (; at - gap[g] >= begin && id[key[at - gap[g]].index] > id[index]; at -= gap[g])
        key[at].index = key[at - gap[g]].index;
      key[at].index = index;
    }
}

/* Position of a block, the part of its tile in use, and the order of the particles of each stencil.
 * `begin` and `end` of the block are known. */
static void place_block(void *data, int64_t b, int32_t worker) {
  const key_chunks *of = data;
  const mpsi_grid *grid = of->grid;
  const mpsi_columns *p = of->p;
  mpsi_cell_block *cells = &grid->cells[b];
  mpsi_radix *key = grid->sorted;
  const uint64_t own = (UINT64_C(1) << grid->own_bits) - 1;
  for (int c = 0; c < 3; c++) {
    const double x = c < grid->dim ? p->x[c][key[cells->begin].index] : 0.0;
    const double X = mpsi_grid_at(grid, c, x);
    cells->at[c] = c < grid->dim ? (int32_t)mpsi_block_of((int64_t)mpsi_base(grid->spline, X)) : 0;
    cells->low[c] = c < grid->dim ? MPSI_TILE_SIDE : 0, cells->high[c] = 1;
  }
  for (int64_t k = cells->begin, end; k < cells->end; k = end) {
    for (end = k + 1; end < cells->end && key[end].key == key[k].key;) end++;
    widen_use(grid, key[k].key & own, cells);
    order_by_id(key, p->laws.ids, k, end);
  }
}

/* Blocks of nodes, and the blocks of cells whose tiles cover each. The sorted list of blocks of
 * cells, shifted to each corner of a tile, gives sorted lists; these are merged. Returns the
 * number; `nodes` NULL: the number alone. */
static int64_t make_nodes(const mpsi_grid *grid, mpsi_node_block *nodes) {
  mpsi_cell_block *cells = grid->cells;
  const int corners = 1 << grid->dim;
  int64_t head[MPSI_CORNERS] = {0}, count = 0;
  for (;;) {
    int32_t at[MPSI_CORNERS][3], least[3];
    bool any = false;
    for (int q = 0; q < corners; q++) {
      if (head[q] == grid->cell_count) continue;
      for (int c = 0; c < 3; c++) at[q][c] = cells[head[q]].at[c] + (q >> c & 1);
      if (!any || mpsi_block_before(at[q], least)) memcpy(least, at[q], sizeof least);
      any = true;
    }
    if (!any) return count;
    if (nodes) {
      nodes[count] = (mpsi_node_block){.side = -1, .near = -1, .across = -1};
      for (int q = 0; q < MPSI_CORNERS; q++) nodes[count].from[q] = -1;
      memcpy(nodes[count].at, least, sizeof least);
    }
    for (int q = 0; q < corners; q++) {
      if (head[q] == grid->cell_count || mpsi_block_before(least, at[q])) continue;
      cells[head[q]].to[q] = (int32_t)count;
      if (nodes) nodes[count].from[q] = (int32_t)head[q];
      head[q]++;
    }
    count++;
  }
}

/* Lists the blocks of cells by colour: the parities of their coordinates. */
static void sort_colours(mpsi_grid *grid) {
  int64_t count = 0;
  for (int colour = 0; colour < MPSI_CORNERS; colour++) {
    grid->colour[colour] = count;
    for (int64_t b = 0; b < grid->cell_count; b++) {
      const int32_t *at = grid->cells[b].at;
      if (((at[0] & 1) | (at[1] & 1) << 1 | (at[2] & 1) << 2) == colour)
        grid->coloured[count++] = (int32_t)b;
    }
  }
  grid->colour[MPSI_CORNERS] = count;
}

bool mpsi_mpm_ensure_cells(mps_context *context, mpsi_grid *grid, int64_t cells) {
  const bool good =
      MPSI_ENSURE(context, grid, cells, cells) && MPSI_ENSURE(context, grid, coloured, cells);
  grid->cell_count = grid->node_count = grid->across_count = 0;
  return good;
}

/* Colours, blocks of nodes and the order of additions for the blocks of cells. */
bool mpsi_mpm_build_nodes(mps_context *context, mpsi_grid *grid, int64_t cells) {
  grid->cell_count = cells;
  sort_colours(grid);
  const int64_t nodes = make_nodes(grid, NULL);
  if (!MPSI_ENSURE(context, grid, nodes, nodes) ||
      !MPSI_ENSURE(context, grid, node, nodes * grid->block_nodes)) {
    grid->cell_count = 0;
    return false;
  }
  grid->node_count = nodes;
  grid->across_count = 0;
  make_nodes(grid, grid->nodes);
  mpsi_mpm_link_blocks(grid);
  return mpsi_mpm_ensure_pass(context, grid);
}

static mps_status no_room(mps_context *context, const mpsi_grid *grid, const char *function,
                          int64_t cells) {
  return mpsi_fail_memory(context, function,
                          (size_t)(cells * grid->block_nodes) * sizeof *grid->node);
}

static mps_status find_cells(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                             const char *function) {
  key_chunks chunks = {.context = context, .grid = grid, .p = p};
  grid->sorted = mpsi_mpm_find_order(context, grid, p, &grid->own_bits);
  if (!grid->sorted) return no_room(context, grid, function, p->count / grid->block_nodes + 1);
  const int64_t cells = count_cells(&chunks);
  if (!mpsi_mpm_ensure_cells(context, grid, cells)) return no_room(context, grid, function, cells);
  make_cells(&chunks, cells, grid->cells);
  grid->cell_count = cells;
  mpsi_mpm_for_cells(context, grid, p, place_block, &chunks);
  return MPS_OK;
}

mps_status mpsi_mpm_place_blocks(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                                 mpsi_partition *partition, const char *function, int64_t count,
                                 const mpsi_block *block) {
  if (!mpsi_mpm_ensure_cells(context, grid, count)) return no_room(context, grid, function, count);
  for (int64_t k = 0; k < count; k++) {
    const int64_t end = k + 1 < count ? block[k + 1][0] : p->count;
    grid->cells[k] = (mpsi_cell_block){.begin = block[k][0], .end = end, .bad = -1};
    for (int c = 0; c < 3; c++) {
      grid->cells[k].at[c] = (int32_t)block[k][MPSI_BLOCK_AT + c];
      grid->cells[k].low[c] = (int32_t)block[k][MPSI_BLOCK_LOW + c];
      grid->cells[k].high[c] = (int32_t)block[k][MPSI_BLOCK_HIGH + c];
    }
  }
  if (partition) { /* ghosts are found before the next step */
    grid->cell_count = count;
    partition->outdated = true;
    return MPS_OK;
  }
  return mpsi_mpm_build_nodes(context, grid, count) ? MPS_OK
                                                    : no_room(context, grid, function, count);
}

/* Puts the particles in the order of the sorted keys. */
static mps_status put_in_order(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const char *function) {
  const int64_t count = p->count;
  mpsi_radix *lower = grid->radix, *upper = lower + count;
  /* The unsorted half of `radix` is free for the order, the sorted half after the order is
   * listed. */
  int64_t *other = (int64_t *)(grid->sorted == lower ? upper : lower), *order = other;
  int64_t *own = (int64_t *)(grid->sorted == lower ? lower : upper);
  if (list_order(context, grid, p, order)) return MPS_OK;
  void *const scratch[MPSI_PERMUTE_COLUMNS] = {other + count, own, own + count};
  return mpsi_particles_permute_in(p->set, function, order, scratch, MPSI_PERMUTE_COLUMNS);
}

mps_status mpsi_mpm_sort_cells(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                               mpsi_run *run, const char *function) {
  run->stale = false;
  if (p->count == 0)
    return mpsi_mpm_ensure_cells(context, grid, 0) ? MPS_OK : no_room(context, grid, function, 0);
  MPSI_TRY(find_cells(context, grid, p, function));
  return put_in_order(context, grid, p, function);
}

mps_status mpsi_mpm_sort_alone(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                               mpsi_run *run, const char *function) {
  if (p->count == 0) {
    run->stale = false;
    const bool good =
        mpsi_mpm_ensure_cells(context, grid, 0) && mpsi_mpm_build_nodes(context, grid, 0);
    return good ? MPS_OK : no_room(context, grid, function, 0);
  }
  MPSI_TRY(find_cells(context, grid, p, function));
  const int64_t cells = grid->cell_count;
  if (!mpsi_mpm_build_nodes(context, grid, cells)) return no_room(context, grid, function, cells);
  run->stale = false;
  return put_in_order(context, grid, p, function);
}
