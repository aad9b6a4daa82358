/* order.c - the order of the particles: by blocks of cells (z, y, x from the top), within a block
 * by the lowest nodes of their stencils, row by row, and those of one stencil (layout.c) by their
 * ids: so the order follows from the positions, whatever it was before. A radix sort from the
 * lowest digit up, divided into chunks: it is stable, so that the order does not depend on the
 * chunks.
 *
 * Where the blocks are so far apart that their coordinates do not fit one word, the particles are
 * sorted by two words, the lower first, and the blocks are then numbered.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "blocks.h"
#include "core/internal.h"

#include <string.h>

#define DIGIT_BITS 11
#define DIGITS (1 << DIGIT_BITS)
#define CHUNK 8192 /* particles at least in a unit of work */
#define MOST_CHUNKS 64

/* ---- chunks ---------------------------------------------------------------------------------- */

typedef struct sorter {
  mps_context *context;
  const mpsi_grid *grid;
  const mpsi_columns *p;
  int64_t chunk; /* particles in a unit of work */
  int32_t chunks;
  int64_t low[3];   /* first block of each axis */
  int32_t bits[3];  /* bits of the block number along each axis */
  int32_t own_bits; /* bits of a stencil's place within its block */
  bool upper;       /* keys are the upper words: blocks along z and y */
  bool two_words;
  int32_t shift; /* of the present digit */
  mpsi_radix *from, *to;
  int32_t (*place)[DIGITS]; /* position of the next item of each chunk and digit */
  double least[MOST_CHUNKS][3], most[MOST_CHUNKS][3]; /* m, of each chunk's particles */
} sorter;

typedef void (*chunk_fn)(sorter *s, int32_t chunk, int64_t begin, int64_t end);

typedef struct chunk_task {
  sorter *sorter;
  chunk_fn work;
} chunk_task;

static void run_chunk(void *data, int64_t chunk, int32_t worker) {
  const chunk_task *t = data;
  const int64_t begin = chunk * t->sorter->chunk, end = begin + t->sorter->chunk;
  t->work(t->sorter, (int32_t)chunk, begin, end < t->sorter->p->count ? end : t->sorter->p->count);
}

static void for_chunks(sorter *s, chunk_fn work) {
  chunk_task task = {s, work};
  mpsi_parallel_for(s->context, s->chunks, run_chunk, &task);
}

/* ---- keys ------------------------------------------------------------------------------------ */

static void find_extent(sorter *s, int32_t chunk, int64_t begin, int64_t end) {
  for (int c = 0; c < s->grid->dim; c++) {
    const double *x = s->p->x[c];
    double least = x[begin], most = x[begin];
    for (int64_t k = begin + 1; k < end; k++) {
      least = x[k] < least ? x[k] : least;
      most = x[k] > most ? x[k] : most;
    }
    s->least[chunk][c] = least, s->most[chunk][c] = most;
  }
}

static int32_t bits_of(uint64_t range) {
  int32_t bits = 0;
  while (bits < 64 && range >> bits) bits++;
  return bits;
}

static int64_t block_at(const mpsi_grid *grid, int c, double x) {
  return mpsi_block_of((int64_t)mpsi_base(grid->spline, mpsi_grid_at(grid, c, x)));
}

/* First block and number of bits of each axis, and whether they fit in one word. */
static void find_range(sorter *s) {
  for_chunks(s, find_extent);
  int32_t bits = s->own_bits;
  for (int c = 0; c < s->grid->dim; c++) {
    double least = s->least[0][c], most = s->most[0][c];
    for (int32_t k = 1; k < s->chunks; k++) {
      least = s->least[k][c] < least ? s->least[k][c] : least;
      most = s->most[k][c] > most ? s->most[k][c] : most;
    }
    s->low[c] = block_at(s->grid, c, least);
    s->bits[c] = bits_of((uint64_t)(block_at(s->grid, c, most) - s->low[c]));
    bits += s->bits[c];
  }
  s->two_words = bits > 64;
}

/* As floor, which is a call where the processor is not known to have it. */
static inline int64_t whole(double x) {
  const int64_t n = (int64_t)x;
  return n - (x < (double)n);
}

/* Block number of a particle along each axis, from the first; returns the place of its stencil
 * within the block. */
static inline uint64_t block_of_particle(const sorter *s, int64_t k, uint64_t *block) {
  const mpsi_grid *grid = s->grid;
  uint64_t within = 0;
  for (int c = grid->dim - 1; c >= 0; c--) {
    const double X = mpsi_grid_at(grid, c, s->p->x[c][k]);
    const int64_t n = grid->spline == 3 ? whole(X) - 2 : whole(X - 0.5) - 1;
    const int64_t from = n - s->low[c] * MPSI_SIDE; /* not negative */
    block[c] = (uint64_t)from / MPSI_SIDE;
    within = within * MPSI_SIDE + (uint64_t)from % MPSI_SIDE;
  }
  return within;
}

static inline uint64_t key_of(const sorter *s, int64_t k) {
  uint64_t block[3] = {0};
  const uint64_t within = block_of_particle(s, k, block);
  const uint64_t across = block[2] << s->bits[1] | block[1];
  if (s->upper) return across;
  const uint64_t along = block[0] << s->own_bits | within;
  return s->two_words ? along : across << (s->bits[0] + s->own_bits) | along;
}

static void make_keys(sorter *s, int32_t chunk, int64_t begin, int64_t end) {
  for (int64_t k = begin; k < end; k++) s->from[k] = (mpsi_radix){key_of(s, k), k};
}

/* Other keys for items that have been moved. */
static void change_keys(sorter *s, int32_t chunk, int64_t begin, int64_t end) {
  for (int64_t k = begin; k < end; k++) s->from[k].key = key_of(s, s->from[k].index);
}

/* ---- sort ------------------------------------------------------------------------------------ */

static void count_digits(sorter *s, int32_t chunk, int64_t begin, int64_t end) {
  int32_t *place = s->place[chunk];
  memset(place, 0, sizeof s->place[chunk]);
  for (int64_t k = begin; k < end; k++) place[s->from[k].key >> s->shift & (DIGITS - 1)]++;
}

static void move_items(sorter *s, int32_t chunk, int64_t begin, int64_t end) {
  int32_t *place = s->place[chunk];
  for (int64_t k = begin; k < end; k++)
    s->to[place[s->from[k].key >> s->shift & (DIGITS - 1)]++] = s->from[k];
}

/* Sorts `from`, whose keys have so many bits; the result is in `from`. */
static void sort_word(sorter *s, int32_t bits) {
  for (s->shift = 0; s->shift < bits; s->shift += DIGIT_BITS) {
    for_chunks(s, count_digits);
    int32_t sum = 0;
    for (int32_t digit = 0; digit < DIGITS; digit++)
      for (int32_t chunk = 0; chunk < s->chunks; chunk++) {
        const int32_t here = s->place[chunk][digit];
        s->place[chunk][digit] = sum;
        sum += here;
      }
    for_chunks(s, move_items);
    mpsi_radix *swap = s->from;
    s->from = s->to;
    s->to = swap;
  }
}

/* Replaces keys of two words by one: the number of the block in the order, in place of its
 * coordinates. */
static void number_blocks(sorter *s) {
  uint64_t before[3] = {0}, number = 0;
  for (int64_t k = 0; k < s->p->count; k++) {
    uint64_t block[3] = {0};
    const uint64_t within = block_of_particle(s, s->from[k].index, block);
    if (k > 0 && memcmp(block, before, sizeof block) != 0) number++;
    memcpy(before, block, sizeof block);
    s->from[k].key = number << s->own_bits | within;
  }
}

mpsi_radix *mpsi_mpm_find_order(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                                int32_t *own_bits) {
  sorter s = {.context = context, .grid = grid, .p = p, .own_bits = grid->dim == 3 ? 9 : 6};
  s.chunk = (p->count + MOST_CHUNKS - 1) / MOST_CHUNKS;
  if (s.chunk < CHUNK) s.chunk = CHUNK;
  s.chunks = (int32_t)((p->count + s.chunk - 1) / s.chunk);
  if (!mpsi_room_ensure(context, &grid->digits_room, (int64_t)s.chunks * DIGITS, sizeof(int32_t)))
    return NULL;
  s.place = grid->digits_room.item;
  s.from = grid->radix, s.to = grid->radix + p->count;
  find_range(&s);
  for_chunks(&s, make_keys);
  const int32_t along = s.bits[0] + s.own_bits, across = s.bits[1] + s.bits[2];
  sort_word(&s, s.two_words ? along : along + across);
  if (s.two_words) {
    s.upper = true;
    for_chunks(&s, change_keys);
    sort_word(&s, across);
    number_blocks(&s);
  }
  *own_bits = s.own_bits;
  return s.from;
}
