/* pores.c - flow in permeable regions. The velocity of a particle is the discharge velocity U = e
 * v, so that the sums of the step, divergence, smoothing and images, are those of a continuous
 * field. Where the spacing changes at a face, neighbours count with e_i/e_j: as if they had the
 * spacing of particle i. With k = e/(lambda (1 + Cm)), lambda = 1 + dt e (a + b |U|)/(1 + Cm), the
 * pressure equation is
 *
 *   sum w e_i/e_j 2 k_i k_j/(k_i + k_j) (q_j - q_i) + k_i c (q_s - q_i) = S (rho/dt) div(U/lambda),
 *
 * over e_i^2, which makes it symmetric.
 *
 * The radius re of the weights is larger in rock (rock.c), that of a pair is the mean of
 * its particles' radii. Weights are multiplied by 1/re^4, over that of water: the second moment S
 * is then that of any radius, so that fluxes between pairs of different radii fit together. The
 * zeroth and first moments of such a pair are multiplied by re^2 and re, over those of particle i.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "pores.h"
#include "fluid/base/access.h"

#include <string.h>

#define WATER 0 /* the region without rock */

/* ---- of particles ---------------------------------------------------------------------------- */

/* By the parity of the edges that the ray along x crosses. */
static bool contains(const mpsi_fluid_rock *rock, double x, double y) {
  bool inside = false;
  if (!(x >= rock->low[0] && x <= rock->high[0] && y >= rock->low[1] && y <= rock->high[1]))
    return false;
  for (int64_t k = 0, last = rock->count - 1; k < rock->count; last = k++) {
    const double *p = rock->xy + 2 * k, *q = rock->xy + 2 * last;
    if ((p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
      inside = !inside;
  }
  return inside;
}

/* The region at (x, y): its number + 1, or WATER. */
static int32_t region_at(const mps_fluid *f, double x, double y) {
  for (int32_t k = 0; k < f->rocks->capacity; k++)
    if (f->rocks->rock[k].used && contains(&f->rocks->rock[k], x, y)) return k + 1;
  return WATER;
}

/* Whether all particles of a chunk, and their neighbours, are in WATER. */
static bool is_free(const mps_fluid *f, int64_t begin, int64_t end) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  const double reach = f->reach * (1.0 + 1e-9);
  bool apart = true;
  for (int64_t i = begin; i < end; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = f->x[c][i] < low[c] ? f->x[c][i] : low[c];
      high[c] = f->x[c][i] > high[c] ? f->x[c][i] : high[c];
    }
  for (int32_t k = 0; k < f->rocks->capacity; k++) {
    const mpsi_fluid_rock *rock = &f->rocks->rock[k];
    bool near = rock->used;
    for (int c = 0; c < 2; c++)
      near = near && low[c] <= rock->high[c] + reach && high[c] >= rock->low[c] - reach;
    apart = apart && !near;
  }
  return apart;
}

static void find_pores(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  const bool apart = is_free(f, begin, end);
  const mpsi_fluid_pore water = {
      .porosity = 1.0, .ease = 1.0, .lambda = 1.0, .weight = &f->weight, .spacing = f->l0};
  int32_t *region = f->rocks->region_room.item;
  ((bool *)f->rocks->free_room.item)[chunk] = apart;
  for (int64_t i = begin; i < end; i++) {
    region[i] = apart ? WATER : region_at(f, f->x[0][i], f->x[1][i]);
    *mpsi_fluid_pore_of(f, i) = water;
    if (region[i] == WATER) continue;
    const mpsi_fluid_rock *rock = &f->rocks->rock[region[i] - 1];
    const double e = rock->def.porosity;
    const double U = sqrt(f->u[0][i] * f->u[0][i] + f->u[1][i] * f->u[1][i]);
    const double lambda = 1.0 + f->dt * e * (rock->a + rock->b * U) / rock->mass;
    *mpsi_fluid_pore_of(f, i) = (mpsi_fluid_pore){.porosity = e,
                                                  .ease = e / (lambda * rock->mass),
                                                  .lambda = lambda,
                                                  .weight = &rock->weight,
                                                  .spacing = f->l0 / sqrt(e)};
    for (int c = 0; c < 2; c++) f->u[c][i] /= lambda;
  }
}

mps_status mpsi_fluid_find_pores(mps_fluid *f, const char *function, double dt) {
  if (!f->rocks) return MPS_OK;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  if (!mpsi_room_ensure(f->context, &f->rocks->part_room, f->count, sizeof(mpsi_fluid_pore)) ||
      !mpsi_room_ensure(f->context, &f->rocks->region_room, f->count, sizeof(int32_t)) ||
      !mpsi_room_ensure(f->context, &f->rocks->free_room, chunks, sizeof(bool)))
    return mpsi_fail_memory(f->context, function, (size_t)f->count * sizeof(mpsi_fluid_pore));
  const double step = f->dt;
  f->dt = dt;
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_CHUNK, find_pores);
  f->dt = step;
  return MPS_OK;
}

mps_status mpsi_fluid_mark_regions(mps_fluid *f, const char *function) {
  const int64_t all = f->count + f->ghosts;
  if (!f->rocks) return MPS_OK;
  if (!mpsi_room_keep(f->context, &f->rocks->region_room, all, sizeof(int32_t)))
    return mpsi_fail_memory(f->context, function, (size_t)all * sizeof(int32_t));
  int32_t *region = f->rocks->region_room.item;
  for (int64_t g = 0; g < f->ghosts; g++) region[f->count + g] = region[f->parent[g]];
  return MPS_OK;
}

/* ---- pairs ----------------------------------------------------------------------------------- */

static int64_t own_of(const mps_fluid *f, int64_t j) {
  return j < f->count ? j : f->parent[j - f->count];
}

double mpsi_fluid_pair_w(const mps_fluid *f, int64_t i, int64_t j, double r) {
  const double re = mpsi_fluid_pair_radius(f, i, j), ratio = f->weight.re / re;
  const mpsi_fluid_weight pair = {.inverse = 1.0 / re, .scale = ratio * ratio * ratio * ratio};
  return r < re ? mpsi_fluid_w(&pair, r) : 0.0;
}

double mpsi_fluid_search_radius(const mps_fluid *f, int64_t chunk, int64_t i) {
  return mpsi_fluid_near_rock(f, chunk) ? 0.5 * (mpsi_fluid_weight_of(f, i)->re + f->reach)
                                        : f->weight.re;
}

int64_t mpsi_fluid_keep_in_pores(mps_fluid *f, int64_t i, int64_t count, int32_t *index,
                                 double *r2) {
  const int32_t *region = f->rocks->region_room.item;
  const double own2 = mpsi_fluid_weight_of(f, i)->re * mpsi_fluid_weight_of(f, i)->re;
  int64_t kept = 0;
  int32_t differs = 0;
  for (int64_t k = 0; k < count; k++) {
    const int32_t j = index[k], other = region[j] ^ region[i];
    const double re = other ? mpsi_fluid_pair_radius(f, i, own_of(f, j)) : 0.0;
    const bool near = r2[k] < (other ? re * re : own2);
    differs |= near ? other : 0;
    index[kept] = j, r2[kept] = r2[k];
    kept += near;
  }
  mpsi_fluid_pore_of(f, i)->mixed = differs != 0;
  return kept;
}

void mpsi_fluid_weigh_mixed(const mps_fluid *f, int64_t i, int64_t count, const int32_t *index,
                            const double *r2, float *w) {
  const int32_t *region = f->rocks->region_room.item;
  const double least = 0.0025 * f->l0 * f->l0;
  for (int64_t k = 0; k < count; k++)
    if (region[index[k]] != region[i])
      w[k] = (float)mpsi_fluid_pair_w(f, i, own_of(f, index[k]), sqrt(fmax(r2[k], least)));
}

/* Pair i, j of different regions, which the resistance slows differently: velocities are compared
 * as if both were slowed as i is; what that leaves out of the flux is the jump of kink.c. */
static void across_face(const mps_fluid *f, int64_t i, int64_t j, double w, const double *d,
                        double r2, mpsi_fluid_sums *s) {
  mpsi_fluid_pore *a = mpsi_fluid_pore_of(f, i);
  const mpsi_fluid_pore *b = mpsi_fluid_pore_of(f, own_of(f, j));
  const double other = b->lambda / a->lambda - 1.0;
  for (int c = 0; c < 2; c++) {
    const double du = other * f->u[c][j];
    s->G[2 * c] += w * du * d[0] / r2, s->G[2 * c + 1] += w * du * d[1] / r2;
    s->du[c] += w * du;
  }
}

void mpsi_fluid_sum_pores(const mps_fluid *f, int64_t i, mpsi_fluid_sums *s) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  mpsi_fluid_pore *own = mpsi_fluid_pore_of(f, i);
  const int32_t *region = f->rocks->region_room.item;
  double n = 0.0, m[2] = {0.0, 0.0}, square = 0.0, shift[2] = {0.0, 0.0};
  own->fill = s->n;
  if (!own->mixed) return;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    const mpsi_fluid_pore *other = mpsi_fluid_pore_of(f, own_of(f, j));
    const double part = w[k] * own->porosity / other->porosity;
    const double wider = 0.5 * (1.0 + other->weight->re * own->weight->inverse);
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double r2 = fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    n += part * wider * wider, square += part * r2;
    if (region[j] != region[i]) across_face(f, i, j, w[k], d, r2, s);
    for (int c = 0; c < 2; c++) {
      m[c] += part * wider * d[c];
      shift[c] += part * wider * wider * d[c] / sqrt(r2);
    }
  }
  own->fill = n;
  s->r2 = square;
  for (int c = 0; c < 2; c++) s->m[c] = m[c], s->shift[c] = shift[c];
}

/* ---- weights of flow ------------------------------------------------------------------------- */

/* The chunk's pairs: the first, and how many there is room for. */
static int64_t stretch(const mps_fluid *f, int64_t chunk, int64_t *first) {
  const int64_t begin = chunk * MPSI_FLUID_CHUNK, next = begin + MPSI_FLUID_CHUNK;
  const int64_t last = (next < f->count ? next : f->count) - 1;
  *first = mpsi_fluid_pairs(f, begin);
  return mpsi_fluid_pairs(f, last) + mpsi_fluid_padded(f->near[last]) - *first;
}

static float *flow_of(const mps_fluid *f, int64_t chunk) {
  const int64_t *start = f->rocks->start_room.item;
  return (float *)f->rocks->flow_room.item + start[chunk];
}

static void weigh_flow(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  if (!mpsi_fluid_near_rock(f, chunk)) return;
  int64_t start;
  const int64_t count = stretch(f, chunk, &start);
  float *flow = flow_of(f, chunk);
  if (count > 0) memcpy(flow, f->w + start, (size_t)count * sizeof *flow);
  for (int64_t i = begin; i < end; i++) {
    const int64_t first = mpsi_fluid_pairs(f, i);
    const mpsi_fluid_pore *a = mpsi_fluid_pore_of(f, i);
    if (a->porosity == 1.0 && !a->mixed) continue; /* w itself */
    for (int32_t k = 0; k < f->near[i]; k++) {
      const mpsi_fluid_pore *b = mpsi_fluid_pore_of(f, own_of(f, f->index[first + k]));
      const double ease = 2.0 * a->ease * b->ease / (a->ease + b->ease);
      flow[first - start + k] = (float)(f->w[first + k] * (ease / (a->porosity * b->porosity)));
    }
  }
}

mps_status mpsi_fluid_weigh_flow(mps_fluid *f, const char *function) {
  mpsi_fluid_rocks *rocks = f->rocks;
  if (!rocks) return MPS_OK;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  if (!mpsi_room_ensure(f->context, &rocks->start_room, chunks, sizeof(int64_t)))
    return mpsi_fail_memory(f->context, function, (size_t)chunks * sizeof(int64_t));
  int64_t *at = rocks->start_room.item, pairs = 0, first;
  for (int64_t chunk = f->own[0] / MPSI_FLUID_CHUNK; chunk * MPSI_FLUID_CHUNK < f->own[1];
       chunk++) {
    at[chunk] = pairs;
    if (mpsi_fluid_near_rock(f, chunk)) pairs += stretch(f, chunk, &first);
  }
  if (!mpsi_room_fit(f->context, &rocks->flow_room, pairs, sizeof(float)))
    return mpsi_fail_memory(f->context, function, (size_t)pairs * sizeof(float));
  rocks->flowing = false;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, weigh_flow);
  return MPS_OK;
}

static void exchange_weights(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  if (!mpsi_fluid_near_rock(f, chunk)) return;
  int64_t first;
  const int64_t count = stretch(f, chunk, &first);
  float *flow = flow_of(f, chunk), *w = f->w + first;
  for (int64_t k = 0; k < count; k++) {
    const float before = w[k];
    w[k] = flow[k], flow[k] = before;
  }
}

void mpsi_fluid_use_flow(mps_fluid *f, bool flow) {
  if (!f->rocks || f->rocks->flowing == flow) return;
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, exchange_weights);
  f->rocks->flowing = flow;
}
