/* curve_orientation.c - see curve_orientation.h. The bounds of the blocks fill either a cube whose
 * side is a power of two or, stretched, each axis of that cube: then halves of the curve are halves
 * of the body. The axes of the curve may be any permutation of those of the grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "curve_orientation.h"
#include "core/base/order.h"
#include "mpm/grid/blocks.h"

#include "domain/curve.h"
#include "mpm/ranks/partition.h"

#include <stdlib.h>
#include <string.h>

int64_t mpsi_mpm_curve_key(int32_t dim, const mpsi_curve_orientation *p, const int32_t *at) {
  const int64_t last = MPSI_CURVE_SIDE(dim) - 1;
  int32_t place[3];
  for (int d = 0; d < dim; d++) {
    const int c = p->axis[d];
    const int64_t along = ((int64_t)at[c] - p->low[c]) * p->side, rest = along % p->extent[c];
    const int64_t to = p->base + along / p->extent[c] - (rest < 0);
    place[d] = (int32_t)(to < 0 ? 0 : to > last ? last : to);
  }
  return mpsi_curve_key(dim, place);
}

/* A block's key along the curve. And a trial: an orientation, and the owners that follow from
 * it. */
typedef struct weighed {
  int64_t key, cells;
} weighed;
typedef struct trial {
  int32_t dim;
  int64_t blocks, particles;
  const mpsi_placed *block;
  mpsi_curve_orientation orientation;
  int32_t ranks;
  weighed *list;
  int32_t *owner;   /* owner of each block */
  int64_t *foreign; /* for each rank, pairs of one of its blocks and a neighbour on another rank */
} trial;

/* Owners as by mpsi_curve_cut: the middle of a block's weight determines its part of the whole. */
static void find_owners(trial *t) {
  int64_t below = 0;
  for (int64_t b = 0; b < t->blocks; b++)
    t->list[b] = (weighed){mpsi_mpm_curve_key(t->dim, &t->orientation, t->block[b].at), b};
  qsort(t->list, (size_t)t->blocks, sizeof *t->list, mpsi_ascending);
  for (int64_t k = 0; k < t->blocks; k++) {
    const int64_t weight = t->block[t->list[k].cells].particles;
    t->owner[t->list[k].cells] = (int32_t)((2 * below + weight) * t->ranks / (2 * t->particles));
    below += weight;
  }
}

/* Counts neighbours in the direction `to` with different owners. */
static void count_along(trial *t, const int32_t *to) {
  const mpsi_placed *cells = t->block;
  const int64_t count = t->blocks;
  for (int64_t b = 0, other = 0; b < count; b++) {
    int32_t at[3];
    for (int c = 0; c < 3; c++) at[c] = cells[b].at[c] + to[c];
    while (other < count && mpsi_block_before(cells[other].at, at)) other++;
    if (other == count) return;
    if (mpsi_block_before(at, cells[other].at) || t->owner[b] == t->owner[other]) continue;
    t->foreign[t->owner[b]]++;
    t->foreign[t->owner[other]]++;
  }
}

/* Largest number of such pairs on any rank; each pair of opposite directions is counted once. */
static int64_t count_foreign(trial *t) {
  static const int32_t none[3] = {0};
  const int32_t depth = t->dim == 3;
  int64_t most = 0;
  memset(t->foreign, 0, (size_t)t->ranks * sizeof *t->foreign);
  for (int32_t k = 0; k <= depth; k++)
    for (int32_t j = -1; j <= 1; j++)
      for (int32_t i = -1; i <= 1; i++) {
        const int32_t to[3] = {i, j, k};
        if (mpsi_block_before(none, to)) count_along(t, to);
      }
  for (int32_t r = 0; r < t->ranks; r++)
    if (t->foreign[r] > most) most = t->foreign[r];
  return most;
}

/* Bounds of the blocks: the first, and the number along each axis. Returns the largest number. */
static int64_t find_bounds(const trial *t, int32_t *low, int64_t *extent) {
  int64_t most = 1;
  for (int c = 0; c < 3; c++) {
    int32_t high = 0;
    low[c] = 0;
    for (int64_t b = 0; b < t->blocks; b++) {
      const int32_t at = t->block[b].at[c];
      if (b == 0 || at < low[c]) low[c] = at;
      if (b == 0 || at > high) high = at;
    }
    extent[c] = (int64_t)high - low[c] + 1;
    if (extent[c] > most) most = extent[c];
  }
  return most;
}

/* An orientation in which no two blocks have the same place, with some margin around them. */
static mpsi_curve_orientation make_orientation(const trial *t, int first, bool stretched) {
  mpsi_curve_orientation p = {.side = 2};
  int64_t extent[3];
  const int64_t most = find_bounds(t, p.low, extent);
  while (p.side < 2 * most && p.side < MPSI_CURVE_SIDE(t->dim) / 4) p.side *= 2;
  p.base = p.side;
  for (int c = 0; c < t->dim; c++) {
    p.axis[c] = (c + first) % t->dim;
    p.extent[c] = stretched ? extent[c] : most > p.side / 2 ? most : p.side / 2;
  }
  return p;
}

bool mpsi_mpm_choose_orientation(mps_context *context, int32_t dim, int32_t ranks, int64_t blocks,
                                 const mpsi_placed *block, mpsi_curve_orientation *out) {
  trial t = {.dim = dim, .blocks = blocks, .block = block, .ranks = ranks};
  int64_t least = -1;
  for (int64_t b = 0; b < blocks; b++) t.particles += block[b].particles;
  t.list = mpsi_alloc(context, blocks, sizeof *t.list);
  t.owner = mpsi_alloc(context, blocks, sizeof *t.owner);
  t.foreign = mpsi_alloc(context, ranks, sizeof *t.foreign);
  const bool good = t.list && t.owner && t.foreign;
  for (int way = 0; good && way < 2 * dim; way++) {
    t.orientation = make_orientation(&t, way / 2, way % 2 != 0);
    if (blocks > 0) find_owners(&t);
    const int64_t foreign = blocks > 0 ? count_foreign(&t) : 0;
    if (least >= 0 && foreign >= least) continue;
    least = foreign;
    *out = t.orientation;
  }
  MPSI_FREE(context, t.list, t.owner, t.foreign);
  return good;
}
