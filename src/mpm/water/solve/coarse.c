/* coarse.c - see coarse.h. SPDX-License-Identifier: BSD-3-Clause */
#include "coarse.h"

#include "core/base/room_array.h"
#include "outside.h"
#include "mpm/water/wide_halo.h"

#include <stdlib.h>
#include <string.h>

enum { TILE = 4, ROW = MPSI_SIDE / TILE }; /* cells along a tile; tiles along a block */
_Static_assert((int)TILE >= (int)MPSI_PORE_SPAN, "a node is in reach of two tiles along an axis");

#define LEAST_TILES 16 /* full of unknowns: a smaller system is solved faster without */
#define MOST_WORK 8.0  /* of a factorisation, over that of a product with the matrix */

typedef struct mpsi_pore_system system_of;
typedef struct mpsi_pore_coarse coarse_of;

/* ---- tiles ----------------------------------------------------------------------------------- */

static double *row_of(const coarse_of *c, int64_t b, int t) {
  return c->row + (b * c->tiles + t) * c->beside;
}

static int32_t *unknown_of(const coarse_of *c, int64_t b, int t) {
  return c->unknown + b * c->tiles + t;
}

static int tile_of(int k) {
  int at[3];
  mpsi_unravel(k, MPSI_SIDE, at);
  return (at[2] / TILE * ROW + at[1] / TILE) * ROW + at[0] / TILE;
}

/* The tile at `beside` (number of a place of three along each axis) of tile t of block b of the
 * list, to *to; returns its block, or -1. */
static int32_t find_beside(const coarse_of *c, int64_t b, int t, int beside, int *to) {
  int at[3], step[3], block = 0, tile = 0;
  mpsi_unravel(t, ROW, at);
  mpsi_unravel(beside, 3, step);
  for (int a = 2; a >= 0; a--) {
    const int place = a < c->dim ? at[a] + step[a] - 1 : 0;
    block = 3 * block + (place < 0 ? 0 : place < ROW ? 1 : 2);
    tile = ROW * tile + (place + ROW) % ROW;
  }
  *to = tile;
  return c->around[b][block];
}

/* A tile with unknowns: its place, along the longest axis first. */
typedef struct place_of_tile {
  int32_t key[3], block, tile;
} place_of_tile;

/* ---- the list of blocks ---------------------------------------------------------------------- */

static int32_t find_place(const coarse_of *c, const int32_t *at) {
  const int32_t(*found)[3] =
      c->blocks > 0 ? bsearch(at, c->at, (size_t)c->blocks, sizeof *c->at, mpsi_compare_blocks)
                    : NULL;
  return found ? (int32_t)(found - (const int32_t(*)[3])c->at) : -1;
}

/* Blocks of all ranks, from `first` on those of this one. */
static mps_status count_blocks(const mps_mpm *mpm, const char *function, int64_t *first,
                               int64_t *all) {
  int64_t own = 0;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    own += mpsi_mpm_counts_node_block(&mpm->grid, g);
  return mpsi_domain_count(mpm->domain, function, own, first, all);
}

static mps_status make_room(mps_mpm *mpm, const char *function, int64_t blocks) {
  coarse_of *c = mpm->water->system->coarse;
  mps_context *context = mpm->context;
  const int64_t tiles = blocks * c->tiles;
  const bool good =
      MPSI_ENSURE(context, c, at, blocks) && MPSI_ENSURE(context, c, around, blocks) &&
      MPSI_ENSURE(context, c, number, mpm->grid.node_count) &&
      MPSI_ENSURE(context, c, row, tiles * c->beside) && MPSI_ENSURE(context, c, sum, 2 * tiles) &&
      MPSI_ENSURE(context, c, unknown, tiles) && MPSI_ENSURE(context, c, value, 2 * tiles) &&
      mpsi_room_ensure(context, &c->order_room, tiles, sizeof(place_of_tile));
  if (!good) return mpsi_fail_memory(context, function, (size_t)(tiles * c->beside) * 8);
  c->right = c->value_room.item;
  c->value = c->right + tiles;
  return MPS_OK;
}

/* The places of the blocks of all ranks; as numbers they pass through the room of the sums. */
static mps_status send_places(mps_mpm *mpm, const char *function, int64_t first, int64_t blocks) {
  coarse_of *c = mpm->water->system->coarse;
  double *place = c->sum;
  int64_t own = first;
  for (int64_t k = 0; k < 3 * blocks; k++) place[k] = -INFINITY;
  for (int64_t g = 0; g < mpm->grid.node_count; g++) {
    if (!mpsi_mpm_counts_node_block(&mpm->grid, g)) continue;
    for (int a = 0; a < 3; a++) place[3 * own + a] = mpm->grid.nodes[g].at[a];
    own++;
  }
  const mps_status status = mpsi_domain_max(mpm->domain, function, (int32_t)(3 * blocks), place);
  for (int64_t b = 0; status == MPS_OK && b < blocks; b++)
    for (int a = 0; a < 3; a++) c->at[b][a] = (int32_t)place[3 * b + a];
  return status;
}

static void join_list(const mpsi_grid *grid, coarse_of *c) {
  qsort(c->at, (size_t)c->blocks, sizeof *c->at, mpsi_compare_blocks);
  for (int64_t b = 0; b < c->blocks; b++)
    for (int k = 0; k < MPSI_PORE_AROUND; k++) {
      int32_t at[3], step[3];
      mpsi_unravel(k, 3, step);
      for (int a = 0; a < 3; a++) at[a] = c->at[b][a] + step[a] - 1;
      c->around[b][k] = grid->dim == 2 && step[2] != 1 ? -1 : find_place(c, at);
    }
  for (int64_t g = 0; g < grid->node_count; g++)
    c->number[g] = mpsi_mpm_counts_node_block(grid, g) ? find_place(c, grid->nodes[g].at) : -1;
}

static mps_status find_list(mps_mpm *mpm, const char *function) {
  coarse_of *c = mpm->water->system->coarse;
  int64_t first, blocks;
  if (mpm->partition && c->searches == mpm->partition->searches) return MPS_OK;
  c->searches = -1;
  MPSI_TRY(count_blocks(mpm, function, &first, &blocks));
  mps_status status = make_room(mpm, function, blocks);
  status = mpsi_domain_agree(mpm->domain, function, status);
  if (status == MPS_OK) status = send_places(mpm, function, first, blocks);
  if (status != MPS_OK) return status;
  c->blocks = blocks;
  join_list(&mpm->grid, c);
  if (mpm->partition) c->searches = mpm->partition->searches;
  return MPS_OK;
}

/* ---- rows of E ------------------------------------------------------------------------------- */

/* Along one axis the cells in reach of a node at place X of its block are X - 2 to X + 1, in one
 * tile or two: so many of these, from the last one back, are in the second. */
static int count_behind(int X) {
  static const int behind[TILE] = {2, 3, 0, 1};
  return behind[X % TILE];
}

/* Of which of the two tiles along each axis place q of a node's span is, from the last cell in
 * reach back: a bit for each axis. */
static int corner_of(const int *behind, int q) {
  int i[3];
  mpsi_unravel(q, MPSI_PORE_SPAN, i);
  return (i[0] < behind[0]) | (i[1] < behind[1]) << 1 | (i[2] < behind[2]) << 2;
}

/* Velocities of nodes, per dt, under the unit pressure of each tile in reach. */
static void find_velocities(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid), dim = grid->dim, corners = 1 << dim;
  const int32_t *tile = s->reach + g * mpsi_pore_box_places(grid);
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(grid, shift);
  for (int k = 0; k < grid->block_nodes; k++) {
    const int64_t node = mpsi_pore_number(grid, s, g, k);
    if (node < 0) continue;
    double *v = s->coarse->velocity + node * corners * dim;
    memset(v, 0, (size_t)(corners * dim) * sizeof *v);
    if (!(s->inertia[node][0] > 0.0)) continue;
    int at[3], behind[3];
    double ease[3]; /* 1/kg */
    mpsi_unravel(k, MPSI_SIDE, at);
    for (int a = 0; a < dim; a++) ease[a] = 1.0 / s->inertia[node][a];
    for (int a = 0; a < 3; a++) behind[a] = a < dim ? count_behind(at[a]) : 0;
    const int last = mpsi_pore_place(grid, k, MPSI_PORE_SPAN - 2) + shift[nodes - 1];
    for (int q = 0; q < nodes; q++) {
      const int64_t cell = tile[last - shift[q]];
      if (cell < 0 || s->row[cell] < 0) continue;
      const double *force = mpsi_pore_row(grid, s, cell);
      double *to = v + corner_of(behind, q) * dim;
      for (int c = 0; c < dim; c++) to[c] += force[c * nodes + q] * ease[c];
    }
  }
}

/* Adds what the velocities of the nodes of cell k take of it, to the row of its tile. */
static void add_squeeze(const mps_mpm *mpm, const system_of *s, int64_t g, int k, const int *shift,
                        double *row) {
  const mpsi_grid *grid = &mpm->grid;
  const int nodes = mpsi_pore_span_nodes(grid), dim = grid->dim, corners = 1 << dim;
  const int64_t cell = mpsi_first_node(grid, g) + k;
  const double *force = mpsi_pore_row(grid, s, cell), dt = mpm->run.dt;
  const double factor = dt * dt / grid->measure;
  const int32_t *near = s->reach + g * mpsi_pore_box_places(grid) + mpsi_pore_place(grid, k, 1);
  int at[3];
  mpsi_unravel(k, MPSI_SIDE, at);
  for (int q = 0; q < nodes; q++) {
    const int64_t node = near[shift[q]];
    if (node < 0 || !(s->inertia[node][0] > 0.0)) continue;
    int i[3], first = 0, behind = 0, stride = 1; /* of the first tile in reach */
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    for (int a = 0; a < dim; a++, stride *= 3) {
      const int X = at[a] - 1 + i[a] + MPSI_SIDE; /* the node's place, not below 0 */
      first += stride * ((X - 2) / TILE - (at[a] + MPSI_SIDE) / TILE + 1);
      behind |= (count_behind(X) > 0) << a;
    }
    const double *v = s->coarse->velocity + node * corners * dim;
    for (int b = 0; b < corners; b++) {
      if ((b & ~behind) != 0) continue;
      double sum = 0.0;
      for (int c = 0; c < dim; c++) sum += force[c * nodes + q] * v[b * dim + c];
      row[first + (b & 1) + 3 * (b >> 1 & 1) + 9 * (b >> 2)] += factor * sum;
    }
  }
}

/* Storage and flow of cell k. */
static void add_flow(const mps_mpm *mpm, const system_of *s, int64_t g, int k, double *row) {
  static const int stride[3] = {1, 3, 9};
  const int64_t cell = mpsi_first_node(&mpm->grid, g) + k;
  int at[3];
  mpsi_unravel(k, MPSI_SIDE, at);
  double *own = row + s->coarse->beside / 2;
  *own += s->diagonal[cell];
  for (int d = 0; d < 2 * mpm->grid.dim; d++) {
    const double flow = mpm->run.dt * s->conductance[cell][d];
    const int place = at[d / 2] % TILE;
    if (flow == 0.0 || place != (d & 1 ? TILE - 1 : 0)) continue; /* none within a tile */
    *own += flow;
    own[d & 1 ? stride[d / 2] : -stride[d / 2]] -= flow;
  }
}

static void find_rows(mps_mpm *mpm, system_of *s, int64_t g, double factor) {
  const int64_t b = s->coarse->number[g];
  int shift[MPSI_PORE_MOST_SPAN];
  mpsi_pore_list_shifts(&mpm->grid, shift);
  for (int k = 0; k < mpm->grid.block_nodes; k++) {
    if (!mpsi_pore_is_unknown(mpm->water, g, k)) continue;
    add_flow(mpm, s, g, k, row_of(s->coarse, b, tile_of(k)));
    add_squeeze(mpm, s, g, k, shift, row_of(s->coarse, b, tile_of(k)));
  }
}

/* Values of the blocks of this rank to all: [blocks][size]. */
static mps_status send_blocks(mps_mpm *mpm, const char *function, int64_t size, double *values) {
  const coarse_of *c = mpm->water->system->coarse;
  return mpsi_domain_max(mpm->domain, function, (int32_t)(c->blocks * size), values);
}

/* The memory of [blocks][size] values where this rank's are to be written. */
static void clear_blocks(const mps_mpm *mpm, int64_t size, double *values) {
  const coarse_of *c = mpm->water->system->coarse;
  for (int64_t k = 0; k < c->blocks * size; k++) values[k] = -INFINITY;
  for (int64_t g = 0; g < mpm->grid.node_count; g++)
    for (int64_t k = 0; c->number[g] >= 0 && k < size; k++) values[c->number[g] * size + k] = 0.0;
}

static mps_status make_rows(mps_mpm *mpm, const char *function) {
  coarse_of *c = mpm->water->system->coarse;
  const mpsi_grid *grid = &mpm->grid;
  const int64_t nodes = grid->node_count * grid->block_nodes +
                        (mpm->water->system->wide_halo ? mpm->water->system->wide_halo->cells : 0);
  const int64_t numbers = (grid->dim << grid->dim) * nodes;
  mps_status status = MPS_OK;
  if (!MPSI_ENSURE(mpm->context, c, velocity, numbers))
    status = mpsi_fail_memory(mpm->context, function, (size_t)numbers * sizeof *c->velocity);
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, status));
  clear_blocks(mpm, c->tiles * c->beside, c->row);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_NEAR, find_velocities, 0.0);
  mpsi_pore_for_blocks(mpm, MPSI_PORE_COUNTED, find_rows, 0.0);
  return send_blocks(mpm, function, c->tiles * c->beside, c->row);
}

/* ---- the coarse equation --------------------------------------------------------------------- */

static int compare_tiles(const void *left, const void *right) {
  const place_of_tile *a = left, *b = right;
  for (int k = 0; k < 3; k++)
    if (a->key[k] != b->key[k]) return a->key[k] < b->key[k] ? -1 : 1;
  return 0;
}

/* Tiles with unknowns, in the order of the list, with their places from the lowest on. */
static int64_t list_tiles(const coarse_of *c, place_of_tile *list) {
  int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
  int64_t count = 0;
  for (int64_t b = 0; b < c->blocks; b++)
    for (int t = 0; t < c->tiles; t++) {
      if (!(row_of(c, b, t)[c->beside / 2] > 0.0)) continue;
      int at[3];
      mpsi_unravel(t, ROW, at);
      place_of_tile *here = &list[count++];
      here->block = (int32_t)b, here->tile = t;
      for (int a = 0; a < 3; a++) {
        here->key[a] = c->at[b][a] * ROW + at[a];
        low[a] = here->key[a] < low[a] ? here->key[a] : low[a];
        high[a] = here->key[a] > high[a] ? here->key[a] : high[a];
      }
    }
  int axis[3] = {0, 1, 2}; /* the longest first: neighbours along it are farthest in the order */
  for (int i = 0; i < 2; i++)
    for (int j = 0; j < 2; j++)
      if (high[axis[j]] - low[axis[j]] < high[axis[j + 1]] - low[axis[j + 1]]) {
        const int other = axis[j];
        axis[j] = axis[j + 1], axis[j + 1] = other;
      }
  for (int64_t k = 0; k < count; k++) {
    int32_t key[3];
    for (int a = 0; a < 3; a++) key[a] = list[k].key[axis[a]] - low[axis[a]];
    memcpy(list[k].key, key, sizeof key);
  }
  return count;
}

/* Gives numbers to the unknowns, of which tiles with the same place share one. */
static int64_t number_unknowns(coarse_of *c, place_of_tile *list, int64_t count) {
  int64_t unknowns = 0;
  qsort(list, (size_t)count, sizeof *list, compare_tiles);
  for (int64_t b = 0; b < c->blocks; b++)
    for (int t = 0; t < c->tiles; t++) *unknown_of(c, b, t) = -1;
  for (int64_t k = 0; k < count; k++) {
    unknowns += k == 0 || compare_tiles(&list[k - 1], &list[k]) != 0;
    *unknown_of(c, list[k].block, list[k].tile) = (int32_t)(unknowns - 1);
  }
  return unknowns;
}

typedef void entry_task(mpsi_envelope *e, int32_t row, int32_t column, double value);

/* Calls `task` with the entries of E up to the diagonal, in the order of the list. */
static void for_entries(coarse_of *c, entry_task *task) {
  for (int64_t b = 0; b < c->blocks; b++)
    for (int t = 0; t < c->tiles; t++) {
      const double *row = row_of(c, b, t);
      const int32_t own = *unknown_of(c, b, t);
      for (int k = 0; own >= 0 && k < c->beside; k++) {
        int to;
        const int32_t block = row[k] != 0.0 ? find_beside(c, b, t, k, &to) : -1;
        const int32_t column = block < 0 ? -1 : *unknown_of(c, block, to);
        if (column >= 0 && column <= own) task(&c->matrix, own, column, row[k]);
      }
    }
}

static void widen(mpsi_envelope *e, int32_t row, int32_t column, double value) {
  if (column < e->first[row]) e->first[row] = column;
}

static void add(mpsi_envelope *e, int32_t row, int32_t column, double value) {
  *mpsi_envelope_at(e, row, column) += value;
}

static mps_status number_tiles(mps_mpm *mpm, const char *function) {
  coarse_of *c = mpm->water->system->coarse;
  const double product =
      2.0 * (double)(mpm->water->system->unknowns * mpsi_pore_row_numbers(&mpm->grid));
  place_of_tile *list = c->order_room.item;
  const int64_t count = list_tiles(c, list);
  for (;;) {
    const int64_t unknowns = number_unknowns(c, list, count);
    if (!mpsi_envelope_begin(mpm->context, &c->matrix, unknowns))
      return mpsi_fail_memory(mpm->context, function, (size_t)unknowns * 12);
    for_entries(c, widen);
    if (unknowns <= 1 || mpsi_envelope_work(&c->matrix) <= MOST_WORK * product) break;
    for (int64_t k = 0; k < count; k++)
      for (int a = 0; a < 3; a++) list[k].key[a] /= 2;
  }
  if (mpsi_envelope_make(mpm->context, &c->matrix)) return MPS_OK;
  return mpsi_fail_memory(mpm->context, function, (size_t)c->matrix.entries * 8);
}

static mps_status count_unknowns(mps_mpm *mpm, const char *function) {
  const mpsi_grid *grid = &mpm->grid;
  int64_t *unknowns = &mpm->water->system->unknowns;
  *unknowns = 0;
  for (int64_t g = 0; g < grid->node_count; g++)
    for (int k = 0; mpsi_mpm_counts_node_block(grid, g) && k < grid->block_nodes; k++)
      *unknowns += mpsi_pore_is_unknown(mpm->water, g, k);
  return mpsi_domain_sum(mpm->domain, function, 1, unknowns);
}

static mps_status make_first(mps_mpm *mpm, const char *function) {
  system_of *s = mpm->water->system;
  mps_status status = MPS_OK;
  if (!s->coarse) {
    s->coarse = mpsi_alloc(mpm->context, 1, sizeof *s->coarse);
    if (s->coarse)
      *s->coarse = (coarse_of){.dim = mpm->grid.dim,
                               .tiles = mpm->grid.dim == 3 ? ROW * ROW * ROW : ROW * ROW,
                               .beside = mpm->grid.dim == 3 ? 27 : 9,
                               .searches = -1};
    else
      status = mpsi_fail_memory(mpm->context, function, sizeof *s->coarse);
  }
  return mpsi_domain_agree(mpm->domain, function, status);
}

mps_status mpsi_pore_find_coarse(mps_mpm *mpm, const char *function) {
  MPSI_TRY(make_first(mpm, function));
  MPSI_TRY(count_unknowns(mpm, function));
  coarse_of *c = mpm->water->system->coarse;
  c->used = false;
  if (mpsi_pore_solved_outside(mpm)) return MPS_OK;
  if (mpm->water->system->unknowns <
      LEAST_TILES * (mpm->grid.dim == 3 ? TILE * TILE * TILE : TILE * TILE))
    return MPS_OK;
  MPSI_TRY(find_list(mpm, function));
  MPSI_TRY(make_rows(mpm, function));
  mps_status status = number_tiles(mpm, function);
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, status));
  for_entries(c, add);
  mpsi_envelope_factor(&c->matrix);
  if (mpm->partition) clear_blocks(mpm, c->tiles, c->sum);
  c->used = true;
  return MPS_OK;
}

/* ---- in each iteration ----------------------------------------------------------------------- */

void mpsi_pore_coarse_restrict(mps_mpm *mpm, int64_t g) {
  const system_of *s = mpm->water->system;
  const int64_t first = mpsi_first_node(&mpm->grid, g);
  if (!s->coarse->used) return;
  double *sum = s->coarse->sum + s->coarse->number[g] * s->coarse->tiles;
  memset(sum, 0, (size_t)s->coarse->tiles * sizeof *sum);
  for (int k = 0; k < mpm->grid.block_nodes; k++)
    if (mpsi_pore_is_unknown(mpm->water, g, k)) sum[tile_of(k)] += s->residual[first + k];
}

mps_status mpsi_pore_coarse_solve(mps_mpm *mpm, const char *function, double *product) {
  coarse_of *c = mpm->water->system->coarse;
  *product = 0.0;
  if (!c->used) return MPS_OK;
  const int64_t tiles = c->blocks * c->tiles;
  double *sum = c->sum;
  if (mpm->partition) { /* a copy: this rank's places stay those that are to be sent */
    sum = memcpy(c->sum + tiles, c->sum, (size_t)tiles * sizeof *sum);
    MPSI_TRY(send_blocks(mpm, function, c->tiles, sum));
  }
  memset(c->right, 0, (size_t)c->matrix.rows * sizeof *c->right);
  for (int64_t t = 0; t < tiles; t++)
    if (c->unknown[t] >= 0) c->right[c->unknown[t]] += sum[t];
  memcpy(c->value, c->right, (size_t)c->matrix.rows * sizeof *c->value);
  mpsi_envelope_solve(&c->matrix, c->value);
  for (int64_t k = 0; k < c->matrix.rows; k++) *product += c->right[k] * c->value[k];
  return MPS_OK;
}

double mpsi_pore_coarse_at(const mps_mpm *mpm, int64_t g, int k) {
  const coarse_of *c = mpm->water->system->coarse;
  const int32_t unknown = c->used ? *unknown_of(c, c->number[g], tile_of(k)) : -1;
  return unknown < 0 ? 0.0 : c->value[unknown];
}

void mpsi_pore_free_coarse(mps_context *context, mpsi_pore_coarse **pointer) {
  coarse_of *c = *pointer;
  *pointer = NULL;
  if (!c) return;
  MPSI_FREE(context, c->at_room.item, c->around_room.item, c->number_room.item, c->row_room.item,
            c->sum_room.item, c->unknown_room.item, c->velocity_room.item, c->value_room.item,
            c->order_room.item);
  mpsi_envelope_drop(context, &c->matrix);
  mpsi_free(context, c);
}
