/* near.c - neighbour lists: all particles and ghosts closer than re to each particle, found by
 * cells of half that size, and the weights w of the pairs.
 *
 * Cells ascend in y first, so that the cells of a search are contiguous in each column of cells.
 * Particles are sorted in the same order now and then (step.c), so that indices of neighbours are
 * near each other too.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "near.h"
#include "fluid/base/access.h"
#include "fluid/boundary/sight.h"
#include "fluid/base/loops.h"
#include "fluid/boundary/polyline.h"
#include "fluid/particles/pores.h"
#include "fluid/ranks/partition.h"

#include <string.h>

#define REACH 2 /* cells that re spans */
#define MOST_CELLS 0x1p26
#define MOST_NEAR 2000 /* neighbours a particle, on average over a chunk */

mpsi_fluid_weight mpsi_fluid_make_weight(double l0, double re, double water) {
  const double ratio = water / re;
  mpsi_fluid_weight w = {.re = re, .inverse = 1.0 / re, .scale = ratio * ratio * ratio * ratio};
  const int reach = (int)(re / l0) + 1, samples = 2000;
  for (int a = -reach; a <= reach; a++)
    for (int b = -reach; b <= reach; b++) {
      const double r = l0 * sqrt((double)(a * a + b * b));
      if ((a == 0 && b == 0) || r >= re) continue;
      const double weight = (float)mpsi_fluid_w(&w, r); /* as those of the pairs are */
      w.n0 += weight;
      w.square += 0.25 * r * r * weight;
      if (b <= 0) w.half += weight;
    }
  /* integral of w over a row half a spacing above, by midpoints */
  for (int k = 0; k < samples; k++) {
    const double x = (k + 0.5) * re / samples, r = sqrt(x * x + 0.25 * l0 * l0);
    if (r < re) w.slope += 2.0 * mpsi_fluid_w(&w, r) * re / samples / l0;
  }
  return w;
}

/* ---- cells ----------------------------------------------------------------------------------- */

typedef struct cells {
  double low[2], inverse;
  int64_t n[2];
  const int32_t *first; /* n[0] n[1] + 1: of the slots of each cell */
} cells;

static int64_t cell_along(const cells *c, int axis, double x) {
  return (int64_t)((x - c->low[axis]) * c->inverse);
}

/* Length of the sorted cloud, padded to whole vectors. */
int64_t mpsi_fluid_sorted_room(int64_t all) { return (all + 7) / 8 * 8 + 24; }

static mps_status make_cells(mps_fluid *f, const char *function, cells *c) {
  const int64_t all = f->count + f->ghosts;
  double high[2];
  c->inverse = REACH * f->weight.inverse;
  for (int k = 0; k < 2; k++) {
    c->low[k] = INFINITY, high[k] = -INFINITY;
    for (int64_t i = 0; i < all; i++) {
      const double x = f->x[k][i];
      c->low[k] = x < c->low[k] ? x : c->low[k];
      high[k] = x > high[k] ? x : high[k];
    }
    const double cells_along = (high[k] - c->low[k]) * c->inverse + 1.0;
    if (!(cells_along < MOST_CELLS))
      return mpsi_fail(f->context, function, MPS_ERROR_DIVERGED,
                       "the fluid reaches from %g m to %g m along %c, more than %g radii re",
                       c->low[k], high[k], k ? 'y' : 'x', MOST_CELLS / REACH);
    c->n[k] = (int64_t)cells_along;
  }
  if (!((double)c->n[0] * (double)c->n[1] < 64.0 * (double)all + MOST_CELLS))
    return mpsi_fail(f->context, function, MPS_ERROR_DIVERGED,
                     "the fluid is strewn over %lld x %lld cells of %g m", (long long)c->n[0],
                     (long long)c->n[1], 1.0 / c->inverse);
  const int64_t number = c->n[0] * c->n[1];
  if (!mpsi_room_fit(f->context, &f->lower_col_room, 2 * (number + 1 + all), sizeof(uint16_t)) ||
      !mpsi_room_fit(f->context, &f->lower_room, 5 * mpsi_fluid_sorted_room(all), sizeof(float)))
    return mpsi_fail_memory(f->context, function, (size_t)(number + 6 * all) * sizeof(int32_t));
  f->slot_x[0] = f->lower_room.item;
  f->slot_x[1] = f->slot_x[0] + mpsi_fluid_sorted_room(all);
  f->slot = (int32_t *)(f->slot_x[1] + mpsi_fluid_sorted_room(all));
  return MPS_OK;
}

/* Sorts the cloud by cells: slot[] has the index at each place, slot_x its position. */
static void sort_cloud(mps_fluid *f, cells *c) {
  const int64_t all = f->count + f->ghosts, number = c->n[0] * c->n[1];
  int32_t *first = f->lower_col_room.item, *cell = first + number + 1;
  memset(first, 0, (size_t)(number + 1) * sizeof *first);
  for (int64_t i = 0; i < all; i++) {
    cell[i] = (int32_t)(cell_along(c, 0, f->x[0][i]) * c->n[1] + cell_along(c, 1, f->x[1][i]));
    first[cell[i]]++;
  }
  for (int64_t k = 0, sum = 0; k <= number; k++) {
    const int32_t here = first[k];
    first[k] = (int32_t)sum;
    sum += here;
  }
  for (int64_t i = 0; i < all; i++) {
    const int32_t at = first[cell[i]]++;
    f->slot[at] = (int32_t)i;
    f->slot_x[0][at] = f->x[0][i], f->slot_x[1][at] = f->x[1][i];
  }
  for (int64_t k = number; k > 0; k--) first[k] = first[k - 1];
  first[0] = 0;
  c->first = first;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

/* Slots [begin, end) of the cells within `reach` of y in one column of cells. */
static void column_range(const cells *c, int64_t column, int64_t reach, double y, int64_t *begin,
                         int64_t *end) {
  const int64_t at = cell_along(c, 1, y), last = c->n[1] - 1;
  const int64_t low = at > reach ? at - reach : 0, high = at + reach < last ? at + reach : last;
  *begin = c->first[column * c->n[1] + low];
  *end = c->first[column * c->n[1] + high + 1];
}

/* Neighbours of particle i within `radius` and the squares of their distances; at most `capacity` -
 * 1 are written, and one that is not counted. Returns their number. */
static int64_t search(const mps_fluid *f, const cells *c, int64_t i, double radius,
                      int64_t capacity, int32_t *index, double *r2) {
  const double y = f->x[1][i];
  const int64_t at = cell_along(c, 0, f->x[0][i]);
  const int64_t reach = radius > f->weight.re ? (int64_t)ceil(radius * c->inverse) : REACH;
  const int64_t low = at > reach ? at - reach : 0;
  const int64_t high = at + reach < c->n[0] - 1 ? at + reach : c->n[0] - 1;
  int64_t found = 0;
  for (int64_t column = low; column <= high; column++) {
    int64_t begin, end;
    column_range(c, column, reach, y, &begin, &end);
    if (found + end - begin >= capacity) return capacity;
    found = f->loops->search(f, i, radius, begin, end, found, index, r2);
  }
  return found;
}

static bool mirrored_bent(const mps_fluid *f, int64_t ghost) {
  MPSI_FLUID_FLIPS(k, f->flips[ghost])
  if (f->wall[f->flips[ghost].wall[k]].bent) return true;
  return false;
}

/* At a bent wall particle i may be at another distance from the image of j than j from that of i:
 * the mean of both weights keeps the matrix symmetric. */
static void average_weights(const mps_fluid *f, int64_t i, int64_t count, const int32_t *index,
                            float *w) {
  for (int64_t k = 0; k < count; k++) {
    const int64_t ghost = index[k] - f->count;
    if (ghost < 0 || !mirrored_bent(f, ghost)) continue;
    const int64_t own = f->parent[ghost];
    double x[2] = {f->x[0][i], f->x[1][i]};
    mpsi_fluid_mirror_point(f, f->flips[ghost], x);
    const double r = hypot(x[0] - f->x[0][own], x[1] - f->x[1][own]);
    const float back = (float)mpsi_fluid_pair_w(f, i, own, r);
    w[k] = 0.5f * (w[k] + back);
  }
}

typedef struct pass {
  mps_fluid *fluid;
  const cells *cells;
  int64_t per_chunk, pairs; /* room for pairs; the last chunk may have less */
  atomic_bool full, crowded;
} pass;

/* MPSI_FLUID_NEAR_CORNER and _WEDGE. */
static int32_t corners_near(const mps_fluid *f, int64_t i) {
  const bool corner = (f->faces > 0 && mpsi_fluid_near_corner(f, i)) ||
                      (f->segments > 0 && mpsi_fluid_near_turn(f, i));
  const bool wedge = f->wedges > 0 && mpsi_fluid_near_wedge(f, i, NULL);
  return (corner ? MPSI_FLUID_NEAR_CORNER : 0) | (wedge ? MPSI_FLUID_NEAR_WEDGE : 0);
}

/* MPSI_FLUID_NEAR_ROUGH. */
static int32_t rough_near(const mps_fluid *f, int64_t count, const int32_t *index) {
  for (int64_t k = 0; k < count; k++) {
    const int64_t ghost = index[k] - f->count;
    if (ghost < 0) continue;
    const mpsi_fluid_path *path = mpsi_fluid_path_of(f, ghost);
    if (path && mpsi_fluid_segment_of(f, path->segment[0])->wall.friction > 0.0)
      return MPSI_FLUID_NEAR_ROUGH;
    MPSI_FLUID_FLIPS(n, f->flips[ghost])
    if (f->wall[f->flips[ghost].wall[n]].friction > 0.0) return MPSI_FLUID_NEAR_ROUGH;
  }
  return 0;
}

/* The pairs of a chunk of particles, one after the other in the chunk's stretch. */
static void find_chunk(void *data, int64_t chunk, int32_t worker) {
  pass *p = data;
  mps_fluid *f = p->fluid;
  mpsi_fluid_crowd *crowd = (mpsi_fluid_crowd *)f->crowd_room.item + worker;
  double *r2 = crowd->value;
  int32_t *apart = crowd->index; /* where the chunk's memory is too small for all candidates */
  const int64_t last = (chunk + 1) * MPSI_FLUID_CHUNK, full = (chunk + 1) * p->per_chunk;
  const int64_t limit = full < p->pairs ? full : p->pairs;
  const bool cornered = f->faces > 0 || f->segments > 0; /* bodies and polylines have corners */
  int64_t at = chunk * p->per_chunk;
  for (int64_t i = chunk * MPSI_FLUID_CHUNK; i < last && i < f->count; i++) {
    const int64_t left = limit - at;
    int32_t *index = left >= MPSI_FLUID_CROWD + MPSI_FLUID_WIDE ? f->index + at : apart;
    float *w = f->w + at;
    int64_t found =
        search(f, p->cells, i, mpsi_fluid_search_radius(f, chunk, i), MPSI_FLUID_CROWD, index, r2);
    const bool crowded = found >= MPSI_FLUID_CROWD;
    if (crowded || mpsi_fluid_padded((int32_t)found) > left) {
      atomic_store(crowded ? &p->crowded : &p->full, true);
      return;
    }
    if (index == apart) index = memcpy(f->index + at, apart, (size_t)found * sizeof *index);
    if (f->limited) found = mpsi_fluid_keep_visible(f, i, found, index, r2);
    if (f->segments > 0) found = mpsi_fluid_keep_seen(f, i, found, index, r2);
    if (f->rocks && (cornered || f->limited || mpsi_fluid_near_rock(f, chunk)))
      found = mpsi_fluid_keep_in_pores(f, i, found, index, r2);
    int32_t company = f->loops->weigh(f, mpsi_fluid_weight_of(f, i), i, found, index, r2, w);
    if (mpsi_fluid_is_mixed(f, i)) mpsi_fluid_weigh_mixed(f, i, found, index, r2, w);
    if (f->bent) average_weights(f, i, found, index, w);
    if (cornered) company |= corners_near(f, i);
    if (f->rough && (company & MPSI_FLUID_NEAR_IMAGES)) company |= rough_near(f, found, index);
    f->company[i] = (uint8_t)company;
    f->start[i] = (int32_t)(at / MPSI_FLUID_WIDE);
    f->near[i] = (uint16_t)found;
    at += mpsi_fluid_padded((int32_t)found);
  }
}

mps_status mpsi_fluid_find_neighbours(mps_fluid *f, const char *function) {
  cells c;
  mps_status status = make_cells(f, function, &c);
  if (status == MPS_OK) status = mpsi_fluid_mark_regions(f, function);
  if (status == MPS_OK) sort_cloud(f, &c);
  for (;;) {
    const int64_t per_chunk = f->most_near * MPSI_FLUID_CHUNK,
                  pairs = f->most_near * f->count + MPSI_FLUID_CHUNK;
    const bool good = mpsi_room_fit(f->context, &f->index_room, pairs, sizeof *f->index) &&
                      mpsi_room_fit(f->context, &f->w_room, pairs, sizeof *f->w) &&
                      mpsi_room_fit(f->context, &f->crowd_room, mps_context_threads(f->context),
                                    sizeof(mpsi_fluid_crowd));
    if (status == MPS_OK && !good)
      status =
          mpsi_fail_memory(f->context, function, (size_t)pairs * (sizeof *f->index + sizeof *f->w));
    f->index = f->index_room.item;
    f->w = f->w_room.item;
    pass p = {.fluid = f, .cells = &c, .per_chunk = per_chunk, .pairs = pairs};
    if (status == MPS_OK) mpsi_fluid_units(f, MPSI_FLUID_CHUNK, find_chunk, &p);
    double full[2] = {atomic_load(&p.full), atomic_load(&p.crowded)};
    status = mpsi_fluid_agree_max(f, function, status, 2, full);
    if (status != MPS_OK || (full[0] == 0.0 && full[1] == 0.0)) return status;
    if (full[1] > 0.0)
      return mpsi_fail(f->context, function, MPS_ERROR_DIVERGED,
                       "a particle has more than %d others near it: the fluid has collapsed",
                       MPSI_FLUID_CROWD);
    if (f->most_near > MOST_NEAR)
      return mpsi_fail(f->context, function, MPS_ERROR_DIVERGED,
                       "more than %d neighbours a particle: the fluid has collapsed", MOST_NEAR);
    f->most_near += 1 + f->most_near / 32;
  }
}
