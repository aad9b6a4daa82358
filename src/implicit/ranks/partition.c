/* partition.c - a rank's part of the operator where ranks solve together
 * (mps/experimental/linear_solver.h).
 *
 * The particles are ordered by layers of the lattice across the body's longest axis, by id within
 * one; each rank owns an interval of that order. It has neighbours, gradients, stresses, joints and
 * rows of the matrix for its own particles and for the layers around them on which these depend, an
 * interval too: the window. Vectors, moduli and volumes of all particles are on all ranks;
 * `mpsi_elastic_complete` sends the results of a rank's own particles to the others. A solver that
 * is
 * not shared has the whole body as its window, in ascending order of ids.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "partition.h"
#include "implicit/base/implicit_solver.h"

#define MOST_AT_ONCE (1 << 20) /* numbers of one reduction */

/* ---- order and window ------------------------------------------------------------------------ */

/* Layer of a particle, from 0. */
typedef struct layers {
  int axis;
  double lowest;
  int64_t count;
} layers;

static layers find_layers(const mps_elastic *e) {
  layers l = {.axis = 0};
  double longest = -1.0;
  for (int c = 0; c < e->dim; c++) {
    double low = INFINITY, high = -INFINITY;
    for (int64_t i = 0; i < e->n; i++) {
      low = fmin(low, e->x[i * e->dim + c]);
      high = fmax(high, e->x[i * e->dim + c]);
    }
    if (high - low <= longest) continue;
    longest = high - low;
    l = (layers){.axis = c, .lowest = low, .count = 1 + (int64_t)rint(longest / e->spacing)};
  }
  return l;
}

static int64_t layer_of(const mps_elastic *e, const layers *l, int64_t i) {
  return (int64_t)rint((e->x[i * e->dim + l->axis] - l->lowest) / e->spacing);
}

/* By layer, then by rank of the id; end[k] becomes the end of layer k. */
static void order(mps_elastic *e, const layers *l, int64_t *end) {
  for (int64_t k = 0; k <= l->count; k++) end[k] = 0;
  for (int64_t i = 0; i < e->n; i++) end[layer_of(e, l, i) + 1]++;
  for (int64_t k = 0; k < l->count; k++) end[k + 1] += end[k];
  for (int64_t i = 0; i < e->n; i++) {
    const int64_t k = end[layer_of(e, l, i)]++;
    e->at[k] = i;
    e->place[i] = k;
  }
}

/* The intervals of own particles and of 1, 2 ... layers around them. */
static void find_spans(mps_elastic *e, const layers *l, const int64_t *end) {
  const int64_t rank = mps_domain_rank(e->domain), size = mps_domain_size(e->domain);
  const int64_t from = e->n * rank / size, to = e->n * (rank + 1) / size;
  e->span[0] = (mpsi_span){from, to};
  for (int k = 1; k < MPSI_SPANS; k++) {
    e->span[k] = e->span[0];
    if (from == to) continue; /* nothing of its own, nothing around it */
    const int64_t low = layer_of(e, l, e->at[from]) - k, high = layer_of(e, l, e->at[to - 1]) + k;
    e->span[k].from = low > 0 ? end[low - 1] : 0;
    e->span[k].to = high < l->count ? end[high] : e->n;
  }
}

/* The farthest entry of a row is the end of a gradient of a pair's other end: that of a joint of a
 * joint's neighbour (assemble.c). */
static int farthest(const mps_elastic *e) { return (int)e->def.radius_ratio + 4; }

mps_status mpsi_elastic_open_window(mps_elastic *e, const char *function) {
  if (!e->shared) {
    for (int k = 0; k < MPSI_SPANS; k++) e->span[k] = (mpsi_span){0, e->n};
    e->window = e->span[0];
    return MPS_OK;
  }
  const layers l = find_layers(e);
  int64_t *end = mpsi_alloc(e->context, l.count + 1, sizeof *end);
  if (!end || !(e->at = mpsi_alloc(e->context, e->n, sizeof *e->at)) ||
      !(e->place = mpsi_alloc(e->context, e->n, sizeof *e->place))) {
    mpsi_free(e->context, end);
    return mpsi_fail_memory(e->context, function, (size_t)e->n * sizeof *e->at);
  }
  order(e, &l, end);
  find_spans(e, &l, end);
  mpsi_free(e->context, end);
  e->window = e->span[farthest(e)];
  return MPS_OK;
}

/* ---- the other ranks' part ------------------------------------------------------------------- */

mps_status mpsi_elastic_join(mps_elastic *e, const char *function, mps_status status, int64_t count,
                             double *values) {
  status = mpsi_elastic_agree(e, function, status);
  for (int64_t k = 0; status == MPS_OK && k < count; k += MOST_AT_ONCE)
    status =
        mpsi_domain_max(e->domain, function,
                        (int32_t)(count - k < MOST_AT_ONCE ? count - k : MOST_AT_ONCE), values + k);
  return status;
}

mps_status mpsi_elastic_complete(mps_elastic *e, const char *function, double *values) {
  if (!e->shared) return MPS_OK;
  for (int64_t i = 0; i < e->n; i++) {
    const bool own = mpsi_elastic_within(e, e->span[0], i);
    for (int64_t k = i * e->dim; k < (i + 1) * e->dim; k++)
      if (!own)
        values[k] = -INFINITY;
      else if (isnan(values[k]))
        values[k] = INFINITY; /* not finite, but it can be compared */
  }
  return mpsi_elastic_join(e, function, MPS_OK, e->n * e->dim, values);
}
