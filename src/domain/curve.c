/* curve.c - Hilbert's curve through the blocks of a grid, and its cut into intervals of equal
 * weight.
 *
 * A cube of 2^n blocks a side is halved in each direction n times. At each halving the curve passes
 * through the 2^dim parts in the order of Gray's code, in which neighbours differ in one bit, so
 * that it leaves a part at a corner beside the next one. The corner of entry and the axis of exit
 * determine the orientation of the code within a part.
 *
 * With W(k) the weight of all keys below k, over all ranks, the first key of rank r is the least k
 * with (W(k) + W(k + 1))/2 >= r W/ranks: the middle of the block k lies in the part of rank r or
 * behind. That grows with k, so all cuts are found at once by bisection, whose sums over ranks are
 * of integers: every rank finds the same. SPDX-License-Identifier: BSD-3-Clause */
#include "curve.h"
#include "core/base/order.h"
#include "domain_private.h"

/* ---- the curve ------------------------------------------------------------------------------- */

/* Orientation of the curve in the present cube. */
typedef struct turn {
  int32_t dim;
  uint32_t corner; /* of entry: a bit for each axis */
  int32_t axis;    /* along which it leaves */
} turn;

static uint32_t rotate_left(const turn *t, uint32_t bits, int32_t by) {
  by %= t->dim;
  return (bits << by | bits >> (t->dim - by)) & ((1u << t->dim) - 1);
}

/* Its orientation in part number `part`: the corner is that of Gray's code of the even number
 * before, the axis that in which the code changes next. */
static void enter_part(turn *t, uint32_t part) {
  const uint32_t even = part > 0 ? (part - 1) & ~1u : 0;
  uint32_t ones = part == 0 ? 0 : part & 1 ? part : part - 1;
  int32_t axis = 0;
  for (; ones & 1; ones >>= 1) axis++;
  t->corner ^= rotate_left(t, even ^ even >> 1, t->axis + 1);
  t->axis = (t->axis + axis + 1) % t->dim;
}

int64_t mpsi_curve_key(int32_t dim, const int32_t *block) {
  turn t = {.dim = dim};
  int64_t key = 0;
  for (int32_t bit = MPSI_CURVE_BITS(dim) - 1; bit >= 0; bit--) {
    uint32_t code = 0;
    for (int32_t d = 0; d < dim; d++) code |= ((uint32_t)block[d] >> bit & 1) << d;
    code = rotate_left(&t, code ^ t.corner, 2 * dim - t.axis - 1);
    const uint32_t part = code ^ code >> 1 ^ code >> 2; /* back from Gray's code, of 3 bits */
    key = key << dim | part;
    enter_part(&t, part);
  }
  return key;
}

void mpsi_curve_block(int32_t dim, int64_t key, int32_t *block) {
  turn t = {.dim = dim};
  for (int32_t d = 0; d < dim; d++) block[d] = 0;
  for (int32_t bit = MPSI_CURVE_BITS(dim) - 1; bit >= 0; bit--) {
    const uint32_t part = (uint32_t)(key >> bit * dim) & ((1u << dim) - 1);
    const uint32_t code = rotate_left(&t, part ^ part >> 1, t.axis + 1) ^ t.corner;
    for (int32_t d = 0; d < dim; d++) block[d] = block[d] << 1 | (int32_t)(code >> d & 1);
    enter_part(&t, part);
  }
}

/* ---- the cut --------------------------------------------------------------------------------- */

#define MOST_WEIGHT (INT64_C(1) << 61) /* of all ranks: twice that is an int64 too */
#define PROBES 4096                    /* numbers in one reduction, or as many as ranks */

/* One rank's keys. */
typedef struct curve_cut {
  mps_domain *domain;
  const char *function;
  int64_t count;
  const int64_t *key, *weight;
  int32_t ranks;
  int64_t *below; /* [count + 1] weight of the keys before each */
  int64_t *least; /* by cut: the largest key known to be too low */
  int64_t *most;  /* by cut: the smallest key known to be high enough */
  int64_t *probe; /* [cut][probes] */
  int32_t probes; /* for each cut and reduction */
  int64_t all;    /* weight over all ranks */
} curve_cut;

static mps_status check_keys(const curve_cut *c) {
  mps_context *context = c->domain->context;
  int64_t left = MOST_WEIGHT / c->ranks;
  for (int64_t k = 0; k < c->count; k++) {
    if (c->key[k] < (k > 0 ? c->key[k - 1] : 0) || c->key[k] >= MPSI_CURVE_END)
      return mpsi_fail(context, c->function, MPS_ERROR_ARGUMENT,
                       "key %lld of the curve is %lld, must not be below the one before nor 0, "
                       "nor beyond %lld",
                       (long long)k, (long long)c->key[k], (long long)MPSI_CURVE_END - 1);
    if (c->weight[k] < 0 || c->weight[k] > left)
      return mpsi_fail(context, c->function, MPS_ERROR_ARGUMENT,
                       "weight %lld is %lld, must be >= 0 and all of a rank at most %lld",
                       (long long)k, (long long)c->weight[k], (long long)(MOST_WEIGHT / c->ranks));
    left -= c->weight[k];
  }
  return MPS_OK;
}

static mps_status prepare(curve_cut *c) {
  mps_context *context = c->domain->context;
  const int64_t cuts = c->ranks - 1;
  c->probes = cuts < PROBES ? PROBES / (int32_t)cuts : 1;
  if (c->probes > 255) c->probes = 255;
  c->below = mpsi_alloc(context, c->count + 1, sizeof *c->below);
  c->least = mpsi_alloc(context, cuts, sizeof *c->least);
  c->most = mpsi_alloc(context, cuts, sizeof *c->most);
  c->probe = mpsi_alloc(context, cuts * c->probes, sizeof *c->probe);
  if (!c->below || !c->least || !c->most || !c->probe)
    return mpsi_fail_memory(context, c->function, (size_t)(c->count + cuts * c->probes) * 8);
  c->below[0] = 0;
  for (int64_t k = 0; k < c->count; k++) c->below[k + 1] = c->below[k] + c->weight[k];
  return MPS_OK;
}

/* Weight here of the keys below `key`. */
static int64_t weight_below(const curve_cut *c, int64_t key) {
  int64_t low;
  MPSI_BISECT(low, c->count, middle, c->key[middle] < key);
  return c->below[low];
}

/* Probe number p of a cut: from just above `least` to `most`. */
static int64_t probe_at(const curve_cut *c, int32_t cut, int32_t p) {
  const int64_t width = c->most[cut] - c->least[cut], parts = c->probes + 1;
  const int64_t step = (width + parts - 1) / parts, at = (p + 1) * step;
  return at < width ? c->least[cut] + at : c->most[cut];
}

/* One reduction narrows all cuts; *open: whether any is still to be narrowed. */
static mps_status narrow(curve_cut *c, bool *open) {
  const int32_t cuts = c->ranks - 1;
  for (int32_t k = 0; k < cuts; k++)
    for (int32_t p = 0; p < c->probes; p++) {
      const int64_t at = probe_at(c, k, p);
      c->probe[k * c->probes + p] = weight_below(c, at) + weight_below(c, at + 1);
    }
  MPSI_TRY(mpsi_domain_sum(c->domain, c->function, cuts * c->probes, c->probe));
  *open = false;
  for (int32_t k = 0; k < cuts; k++) {
    const int64_t part = k + 1, rest = c->all % c->ranks;
    const int64_t wanted = 2 * (c->all / c->ranks * part + rest * part / c->ranks);
    const int64_t *sum = c->probe + (int64_t)k * c->probes;
    int32_t p = 0;
    while (p < c->probes && sum[p] < wanted) p++;
    const int64_t least = p > 0 ? probe_at(c, k, p - 1) : c->least[k];
    c->most[k] = p < c->probes ? probe_at(c, k, p) : c->most[k];
    c->least[k] = least;
    *open = *open || c->most[k] - c->least[k] > 1;
  }
  return MPS_OK;
}

/* Bits of the greatest key of all ranks, and the weight of all. */
static mps_status measure(curve_cut *c, mps_status status) {
  double bits = 0.0;
  if (status == MPS_OK && c->count > 0)
    for (int64_t key = c->key[c->count - 1]; key > 0; key >>= 1) bits += 1.0;
  status = mpsi_domain_agree_max(c->domain, c->function, status, 1, &bits);
  if (status != MPS_OK) return status;
  for (int32_t k = 0; k < c->ranks - 1; k++) c->least[k] = -1, c->most[k] = INT64_C(1) << (int)bits;
  c->all = c->below[c->count];
  return mpsi_domain_sum(c->domain, c->function, 1, &c->all);
}

mps_status mpsi_curve_cut(mps_domain *domain, const char *function, int64_t count,
                          const int64_t *key, const int64_t *weight, int64_t *first) {
  curve_cut c = {.domain = domain,
                 .function = function,
                 .count = count,
                 .key = key,
                 .weight = weight,
                 .ranks = mpsi_domain_many(domain) ? mps_domain_size(domain) : 1};
  first[0] = 0;
  first[c.ranks] = MPSI_CURVE_END;
  if (c.ranks == 1) return MPS_OK;
  mps_status status = check_keys(&c);
  if (status == MPS_OK) status = prepare(&c);
  status = measure(&c, status);
  for (bool open = true; status == MPS_OK && open;) status = narrow(&c, &open);
  for (int32_t k = 1; status == MPS_OK && k < c.ranks; k++) first[k] = c.most[k - 1];
  MPSI_FREE(domain->context, c.below, c.least, c.most, c.probe);
  return status;
}

int32_t mpsi_curve_owner(int32_t ranks, const int64_t *first, int64_t key) {
  int32_t low = 0, high = ranks - 1; /* the last rank whose first key is not beyond */
  while (low < high) {
    const int32_t middle = low + (high - low + 1) / 2;
    if (first[middle] <= key)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}
