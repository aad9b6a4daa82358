/* neighbours.c - fixed-radius neighbour lists by sorted cells.
 *
 * Particles are sorted by the cell of side `radius` they lie in (row by row, x fastest). The cells
 * around one then are 3 (2D) or 9 (3D) stretches of three cells in the sorted order, and when the
 * cell moves on each stretch only moves on too. Nothing depends on the bounding box.
 *
 * Work is cut into blocks whose number depends on the particles only; each writes its own rows,
 * and rows are sorted, so the result is the same for every number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/base/order.h"
#include "core/internal.h"

#include <mps/experimental/neighbours.h>

#include <string.h>

#define MAX_BLOCKS 128
#define MIN_BLOCK 2048 /* particles */
#define MAX_COUNT UINT32_MAX

/* Cells are counted from a particle in the middle of the others. Up to 2^30 cells away, rounding
 * moves a quotient by less than 2^-20, so a cell 2^-18 larger than the radius keeps neighbours in
 * adjoining cells. Particles farther away are in the last cell: monotone, thus still correct, and
 * slow only for many such particles. */
#define CELL_MARGIN 0x1p-18
#define LAST_CELL 0x1p30

#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)

/* A particle and its cell, counted from 1 at the lowest cell of each axis. */
typedef struct cell_item {
  uint32_t cell[3];
  uint32_t index;
} cell_item;

typedef struct csr {
  int64_t *offsets, *indices; /* n + 1, and offsets[n] */
  int64_t offsets_capacity, indices_capacity;
  int64_t count;
} csr;

struct mps_neighbours {
  mps_context *context;
  mps_neighbours_def def;
  csr lists, spare; /* shown to the caller; the next build's */
  cell_item *items, *sorted;
  double *x; /* positions in sorted order: all x, then y, then z */
  uint32_t *histogram;
  int64_t items_capacity, sorted_capacity, x_capacity, histogram_capacity;
};

/* Shared data of the tasks of one build. */
typedef struct build {
  const mps_neighbours *owner;
  const mps_view *position;
  int64_t n, blocks;
  double reference[3], side;
  cell_item *items, *sorted;
  int32_t axis, shift;     /* of the sorting pass */
  int64_t bad[MAX_BLOCKS]; /* first particle of the block with a position not finite, or -1 */
  uint32_t low[MAX_BLOCKS][3], high[MAX_BLOCKS][3]; /* cells of the block */
  csr *out;
  bool fill; /* second pass: write indices; first: count */
} build;

static int64_t block_begin(const build *b, int64_t block) { return b->n * block / b->blocks; }
static int64_t block_end(const build *b, int64_t block) { return block_begin(b, block + 1); }

/* ---- cells ----------------------------------------------------------------------------------- */

static double median(double a, double b, double c) { return fmax(fmin(a, b), fmin(fmax(a, b), c)); }

static uint32_t cell_of(double x, double reference, double side) {
  const double cell = floor((x - reference) / side);
  return (uint32_t)(fmin(fmax(cell, -LAST_CELL), LAST_CELL) + LAST_CELL);
}

static void find_cells(void *data, int64_t block, int32_t worker) {
  build *b = data;
  const int32_t dim = b->owner->def.dim;
  uint32_t low[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX}, high[3] = {0};
  int64_t bad = -1;
  for (int64_t i = block_begin(b, block); i < block_end(b, block); i++) {
    cell_item *item = &b->items[i];
    *item = (cell_item){.index = (uint32_t)i};
    for (int32_t c = 0; c < dim; c++) {
      const double x = *mps_view_f64(b->position, i, c);
      if (!isfinite(x)) {
        if (bad < 0) bad = i;
        continue;
      }
      const uint32_t cell = cell_of(x, b->reference[c], b->side);
      item->cell[c] = cell;
      if (cell < low[c]) low[c] = cell;
      if (cell > high[c]) high[c] = cell;
    }
  }
  b->bad[block] = bad;
  memcpy(b->low[block], low, sizeof low);
  memcpy(b->high[block], high, sizeof high);
}

static void shift_cells(void *data, int64_t block, int32_t worker) {
  build *b = data;
  for (int64_t i = block_begin(b, block); i < block_end(b, block); i++)
    for (int32_t c = 0; c < b->owner->def.dim; c++) b->items[i].cell[c] -= b->low[0][c] - 1;
}

/* Cells of all particles, from 1; `most` receives the highest of each axis. */
static mps_status make_cells(build *b, const char *function, uint32_t *most) {
  const int32_t dim = b->owner->def.dim;
  for (int32_t c = 0; c < dim; c++)
    b->reference[c] =
        median(*mps_view_f64(b->position, 0, c), *mps_view_f64(b->position, b->n / 2, c),
               *mps_view_f64(b->position, b->n - 1, c));
  b->side = b->owner->def.radius * (1.0 + CELL_MARGIN);
  mpsi_parallel_for(b->owner->context, b->blocks, find_cells, b);
  for (int64_t block = 0; block < b->blocks; block++) {
    const int64_t i = b->bad[block];
    for (int32_t c = 0; c < dim && i >= 0; c++) {
      const double x = *mps_view_f64(b->position, i, c);
      if (!isfinite(x))
        return mpsi_fail(b->owner->context, function, MPS_ERROR_ARGUMENT,
                         "position %lld has %c = %g m, must be finite", (long long)i, "xyz"[c], x);
    }
    for (int32_t c = 0; c < dim; c++) {
      if (b->low[block][c] < b->low[0][c]) b->low[0][c] = b->low[block][c];
      if (b->high[block][c] > b->high[0][c]) b->high[0][c] = b->high[block][c];
    }
  }
  for (int32_t c = 0; c < dim; c++) most[c] = b->high[0][c] - b->low[0][c] + 1;
  mpsi_parallel_for(b->owner->context, b->blocks, shift_cells, b);
  return MPS_OK;
}

/* ---- sorting: a stable radix sort, from the lowest digit of x to the highest of z ------------ */

static uint32_t digit_of(const build *b, const cell_item *item) {
  return item->cell[b->axis] >> b->shift & (DIGITS - 1);
}

static void count_digits(void *data, int64_t block, int32_t worker) {
  const build *b = data;
  uint32_t *count = b->owner->histogram + block * DIGITS;
  memset(count, 0, DIGITS * sizeof *count);
  for (int64_t i = block_begin(b, block); i < block_end(b, block); i++)
    count[digit_of(b, &b->items[i])]++;
}

static void move_items(void *data, int64_t block, int32_t worker) {
  const build *b = data;
  uint32_t *place = b->owner->histogram + block * DIGITS;
  for (int64_t i = block_begin(b, block); i < block_end(b, block); i++)
    b->sorted[place[digit_of(b, &b->items[i])]++] = b->items[i];
}

static void sort_items(build *b, const uint32_t *most) {
  mps_context *context = b->owner->context;
  for (b->axis = 0; b->axis < b->owner->def.dim; b->axis++)
    for (b->shift = 0; b->shift < 32 && most[b->axis] >> b->shift != 0; b->shift += DIGIT_BITS) {
      mpsi_parallel_for(context, b->blocks, count_digits, b);
      uint32_t place = 0;
      for (int32_t digit = 0; digit < DIGITS; digit++)
        for (int64_t block = 0; block < b->blocks; block++) {
          uint32_t *entry = b->owner->histogram + block * DIGITS + digit;
          const uint32_t count = *entry;
          *entry = place;
          place += count;
        }
      mpsi_parallel_for(context, b->blocks, move_items, b);
      cell_item *swap = b->items;
      b->items = b->sorted;
      b->sorted = swap;
    }
}

static void gather_positions(void *data, int64_t block, int32_t worker) {
  const build *b = data;
  for (int32_t c = 0; c < b->owner->def.dim; c++)
    for (int64_t s = block_begin(b, block); s < block_end(b, block); s++)
      b->owner->x[c * b->n + s] = *mps_view_f64(b->position, b->items[s].index, c);
}

/* ---- pairs ----------------------------------------------------------------------------------- */

/* Items of three cells in a row: those at (x - 1, x, x + 1) of the row (y + dy, z + dz). */
typedef struct stretch {
  int64_t begin, end;
} stretch;

/* Whether the item lies before the cell (x, y, z) in the sorted order. */
MPSI_INLINE bool before(const cell_item *item, uint32_t x, uint32_t y, uint32_t z) {
  if (item->cell[2] != z) return item->cell[2] < z;
  if (item->cell[1] != y) return item->cell[1] < y;
  return item->cell[0] < x;
}

static int64_t first_item(const build *b, uint32_t x, uint32_t y, uint32_t z) {
  int64_t low;
  MPSI_BISECT(low, b->n, middle, before(&b->items[middle], x, y, z));
  return low;
}

/* Ascending; rows are a few ascending stretches. Shell's sort: short rows take its last pass only,
 * long ones stay far from a quadratic time. */
static void sort_row(int64_t *row, int64_t n) {
  int64_t gap = 1;
  while (gap < n / 9) gap = 3 * gap + 1;
  for (; gap > 0; gap /= 3)
    for (int64_t i = gap; i < n; i++) {
      const int64_t value = row[i];
      int64_t place = i;
      for (; place >= gap && row[place - gap] > value; place -= gap) row[place] = row[place - gap];
      row[place] = value;
    }
}

/* Neighbours of the sorted item s among the stretches, written to `row` unless it is NULL. */
MPSI_INLINE int64_t scan(const build *b, int32_t dim, bool half, const stretch *around, int64_t s,
                         int64_t *row) {
  const double *x = b->owner->x, *y = x + b->n, *z = y + (dim == 3 ? b->n : 0);
  const double square = b->owner->def.radius * b->owner->def.radius;
  const cell_item *items = b->items;
  const uint32_t self = items[s].index;
  int64_t found = 0;
  for (int32_t r = 0; r < (dim == 3 ? 9 : 3); r++)
    for (int64_t t = around[r].begin; t < around[r].end; t++) {
      const double dx = x[t] - x[s], dy = y[t] - y[s], dz = dim == 3 ? z[t] - z[s] : 0.0;
      const uint32_t other = items[t].index;
      const bool near = dx * dx + dy * dy + dz * dz < square;
      const bool wanted = half ? other > self : other != self;
      if (row && near && wanted) row[found] = other;
      found += near && wanted;
    }
  return found;
}

/* Moves the stretches on to those around the cell of item s. Whole cells follow one another in
 * ascending order, so the ends only ever move up. */
MPSI_INLINE void advance(const build *b, int32_t dim, const cell_item *at, stretch *around) {
  for (int32_t r = 0; r < (dim == 3 ? 9 : 3); r++) {
    const uint32_t x = at->cell[0], y = at->cell[1] + (uint32_t)(r % 3) - 1;
    const uint32_t z = dim == 3 ? at->cell[2] + (uint32_t)(r / 3) - 1 : 0;
    stretch *a = &around[r];
    while (a->begin < b->n && before(&b->items[a->begin], x - 1, y, z)) a->begin++;
    if (a->end < a->begin) a->end = a->begin;
    while (a->end < b->n && before(&b->items[a->end], x + 2, y, z)) a->end++;
  }
}

MPSI_INLINE void pairs_body(const build *b, int32_t dim, bool half, int64_t block) {
  stretch around[9];
  const int64_t begin = block_begin(b, block), end = block_end(b, block);
  int64_t *offsets = b->out->offsets;
  for (int32_t r = 0; r < (dim == 3 ? 9 : 3); r++) {
    const cell_item *at = &b->items[begin];
    const uint32_t z = dim == 3 ? at->cell[2] + (uint32_t)(r / 3) - 1 : 0;
    around[r].begin = around[r].end =
        first_item(b, at->cell[0] - 1, at->cell[1] + (uint32_t)(r % 3) - 1, z);
  }
  for (int64_t s = begin; s < end; s++) {
    const cell_item *item = &b->items[s];
    if (s == begin || memcmp(item->cell, item[-1].cell, sizeof item->cell) != 0)
      advance(b, dim, item, around);
    if (b->fill) {
      int64_t *row = b->out->indices + offsets[item->index];
      sort_row(row, scan(b, dim, half, around, s, row));
    } else {
      offsets[item->index + INT64_C(1)] = scan(b, dim, half, around, s, NULL);
    }
  }
}

static void find_pairs(void *data, int64_t block, int32_t worker) {
  const build *b = data;
  const bool half = b->owner->def.half != 0;
  if (b->owner->def.dim == 2)
    half ? pairs_body(b, 2, true, block) : pairs_body(b, 2, false, block);
  else
    half ? pairs_body(b, 3, true, block) : pairs_body(b, 3, false, block);
}

/* ---- the object ------------------------------------------------------------------------------ */

/* Memory for `count` items without the former contents, in place of `memory`, or NULL; with an
 * eighth to spare, so that lists which change a little from step to step do not allocate at each.
 */
static void *enlarge(mps_context *context, void *memory, int64_t *capacity, int64_t count,
                     size_t size) {
  if (memory && count <= *capacity) return memory;
  mpsi_free(context, memory);
  *capacity = count + count / 8;
  memory = mpsi_alloc(context, *capacity, size);
  if (!memory) *capacity = 0;
  return memory;
}

mps_status mps_neighbours_create(mps_context *context, const mps_neighbours_def *def,
                                 mps_neighbours **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_neighbours_def known;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_neighbours_def, def, &known));
  mps_neighbours *nb = mpsi_alloc(context, 1, sizeof *nb);
  void *offsets = mpsi_alloc(context, 1, sizeof(int64_t));
  if (!nb || !offsets) {
    MPSI_FREE(context, nb, offsets);
    return mpsi_fail_memory(context, __func__, sizeof *nb + sizeof(int64_t));
  }
  nb->context = mpsi_context_retain(context);
  nb->def = known;
  nb->lists.offsets = offsets;
  nb->lists.offsets_capacity = 1;
  *out = nb;
  return MPS_OK;
}

void mps_neighbours_destroy(mps_neighbours **neighbours) {
  if (!neighbours || !*neighbours) return;
  mps_neighbours *nb = *neighbours;
  *neighbours = NULL;
  mps_context *context = nb->context;
  MPSI_FREE(context, nb->lists.offsets, nb->lists.indices, nb->spare.offsets, nb->spare.indices,
            nb->items, nb->sorted, nb->x, nb->histogram, nb);
  mpsi_context_release(context);
}

static mps_status check_view(const mps_neighbours *nb, const char *function,
                             const mps_view *position) {
  if (!position) return mpsi_fail(nb->context, function, MPS_ERROR_ARGUMENT, "position is NULL");
  const mps_dtype t = position->dtype;
  if (t.code != 2 || t.bits != 64 || t.lanes != 1)
    return mpsi_fail(nb->context, function, MPS_ERROR_FIELD,
                     "position has type code %d of %d bits, must be float64 (code 2, 64 bits)",
                     t.code, t.bits);
  if (position->shape[1] != nb->def.dim || position->shape[0] < 0 ||
      position->shape[0] > (int64_t)MAX_COUNT)
    return mpsi_fail(nb->context, function, MPS_ERROR_FIELD,
                     "position has the shape (%lld, %lld), must be (n, %d) with 0 <= n < 2^32",
                     (long long)position->shape[0], (long long)position->shape[1], nb->def.dim);
  if (position->shape[0] > 0 && !position->data)
    return mpsi_fail(nb->context, function, MPS_ERROR_ARGUMENT, "position has data NULL");
  return MPS_OK;
}

/* Memory for the sort and for the rows' offsets. */
static bool make_scratch(mps_neighbours *nb, int64_t n, int64_t blocks) {
  mps_context *context = nb->context;
  csr *out = &nb->spare;
  nb->items = enlarge(context, nb->items, &nb->items_capacity, n, sizeof *nb->items);
  nb->sorted = enlarge(context, nb->sorted, &nb->sorted_capacity, n, sizeof *nb->sorted);
  nb->x = enlarge(context, nb->x, &nb->x_capacity, n * nb->def.dim, sizeof *nb->x);
  nb->histogram = enlarge(context, nb->histogram, &nb->histogram_capacity, blocks * DIGITS,
                          sizeof *nb->histogram);
  out->offsets =
      enlarge(context, out->offsets, &out->offsets_capacity, n + 1, sizeof *out->offsets);
  return nb->items && nb->sorted && nb->x && nb->histogram && out->offsets;
}

mps_status mps_neighbours_build(mps_neighbours *neighbours, const mps_view *position) {
  if (!neighbours) return mpsi_null(__func__, "neighbours");
  mps_neighbours *nb = neighbours;
  mps_status status = check_view(nb, __func__, position);
  if (status != MPS_OK) return status;
  const int64_t n = position->shape[0];
  const int64_t blocks = n / MIN_BLOCK < 1            ? 1
                         : n / MIN_BLOCK > MAX_BLOCKS ? MAX_BLOCKS
                                                      : n / MIN_BLOCK;
  if (!make_scratch(nb, n, blocks))
    return mpsi_fail(nb->context, __func__, MPS_ERROR_MEMORY,
                     "could not allocate the cells of %lld particles", (long long)n);
  csr *out = &nb->spare;
  out->count = n;
  out->offsets[0] = 0;
  build b = {.owner = nb, .position = position, .n = n, .blocks = blocks, .out = out};
  b.items = nb->items;
  b.sorted = nb->sorted;
  if (n > 0) {
    uint32_t most[3];
    if ((status = make_cells(&b, __func__, most)) != MPS_OK) return status;
    sort_items(&b, most);
    mpsi_parallel_for(nb->context, blocks, gather_positions, &b);
    mpsi_parallel_for(nb->context, blocks, find_pairs, &b);
    for (int64_t i = 0; i < n; i++) out->offsets[i + 1] += out->offsets[i];
  }
  out->indices = enlarge(nb->context, out->indices, &out->indices_capacity, out->offsets[n],
                         sizeof *out->indices);
  if (!out->indices)
    return mpsi_fail(nb->context, __func__, MPS_ERROR_MEMORY, "could not allocate %lld neighbours",
                     (long long)out->offsets[n]);
  b.fill = true;
  if (n > 0) mpsi_parallel_for(nb->context, blocks, find_pairs, &b);
  const csr shown = nb->lists;
  nb->lists = nb->spare;
  nb->spare = shown;
  return MPS_OK;
}

mps_status mps_neighbours_lists(const mps_neighbours *neighbours, int64_t *count,
                                const int64_t **offsets, const int64_t **indices) {
  if (!neighbours) return mpsi_null(__func__, "neighbours");
  if (count) *count = neighbours->lists.count;
  if (offsets) *offsets = neighbours->lists.offsets;
  if (indices) *indices = neighbours->lists.indices;
  return MPS_OK;
}
