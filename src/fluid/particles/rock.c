/* rock.c - permeable regions. The velocity of a particle is the discharge velocity U = e v, so that
 * the sums of the step, divergence, smoothing and images, are those of a continuous field. Where
 * the spacing changes at a face, neighbours count with e_i/e_j: as if they had the spacing of
 * particle i. With k = e/(lambda (1 + Cm)), lambda = 1 + dt e (a + b |U|)/(1 + Cm), the pressure
 * equation is
 *
 *   sum w e_i/e_j 2 k_i k_j/(k_i + k_j) (q_j - q_i) + k_i c (q_s - q_i) = S (rho/dt) div(U/lambda),
 *
 * over e_i^2, which makes it symmetric. SPDX-License-Identifier: BSD-3-Clause */
#include "fluid/base/access.h"
#include "fluid/particles/rock.h"
#include "core/base/digits.h"
#include "fluid/ranks/partition.h"

#include <string.h>

#define MOST_CORNERS 10000

static const mps_fluid_rock_def defaults = {.struct_size = sizeof(mps_fluid_rock_def),
                                            .porosity = NAN,
                                            .diameter = NAN,
                                            .alpha = 1000.0,
                                            .beta = 1.1,
                                            .KC = NAN,
                                            .gamma = 0.34,
                                            .viscosity = 1e-6};

mps_status mps_fluid_rock_def_init(mps_fluid_rock_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_fluid_rock_def, def, size, &defaults);
}

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

static const mpsi_fluid_rock *rock_at(const mps_fluid *f, double x, double y) {
  for (int32_t k = 0; k < f->rocks->room; k++)
    if (f->rocks->rock[k].used && contains(&f->rocks->rock[k], x, y)) return &f->rocks->rock[k];
  return NULL;
}

/* Whether all particles of a chunk are farther than re from all rock. */
static bool is_free(const mps_fluid *f, int64_t begin, int64_t end) {
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  const double reach = f->weight.re * (1.0 + 1e-9);
  bool apart = true;
  for (int64_t i = begin; i < end; i++)
    for (int c = 0; c < 2; c++) {
      low[c] = f->x[c][i] < low[c] ? f->x[c][i] : low[c];
      high[c] = f->x[c][i] > high[c] ? f->x[c][i] : high[c];
    }
  for (int32_t k = 0; k < f->rocks->room; k++) {
    const mpsi_fluid_rock *rock = &f->rocks->rock[k];
    bool near = rock->used;
    for (int c = 0; c < 2; c++)
      near = near && low[c] <= rock->high[c] + reach && high[c] >= rock->low[c] - reach;
    apart = apart && !near;
  }
  return apart;
}

static void find_pores(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  ((bool *)f->rocks->free_room.item)[chunk] = is_free(f, begin, end);
  for (int64_t i = begin; i < end; i++) {
    const mpsi_fluid_rock *rock = rock_at(f, f->x[0][i], f->x[1][i]);
    const double e = rock ? rock->def.porosity : 1.0, mass = rock ? rock->mass : 1.0;
    const double U = sqrt(f->u[0][i] * f->u[0][i] + f->u[1][i] * f->u[1][i]);
    const double lambda = rock ? 1.0 + f->dt * e * (rock->a + rock->b * U) / mass : 1.0;
    *mpsi_fluid_pore_of(f, i) = (mpsi_fluid_pore){.porosity = e,
                                                  .ease = e / (lambda * mass),
                                                  .weight = rock ? &rock->weight : &f->weight,
                                                  .spacing = f->l0 / sqrt(e)};
    for (int c = 0; c < 2; c++) f->u[c][i] /= lambda;
  }
}

mps_status mpsi_fluid_find_pores(mps_fluid *f, const char *function, double dt) {
  if (!f->rocks) return MPS_OK;
  const int64_t chunks = (f->count + MPSI_FLUID_CHUNK - 1) / MPSI_FLUID_CHUNK;
  if (!mpsi_room_ensure(f->context, &f->rocks->part_room, f->count, sizeof(mpsi_fluid_pore)) ||
      !mpsi_room_ensure(f->context, &f->rocks->free_room, chunks, sizeof(bool)))
    return mpsi_fail_memory(f->context, function, (size_t)f->count * sizeof(mpsi_fluid_pore));
  const double step = f->dt;
  f->dt = dt;
  mpsi_fluid_for_all(f, f->count, MPSI_FLUID_CHUNK, find_pores);
  f->dt = step;
  return MPS_OK;
}

static double porosity_of(const mps_fluid *f, int64_t j) {
  return mpsi_fluid_pore_of(f, j < f->count ? j : f->parent[j - f->count])->porosity;
}

/* Whether all neighbours of particle i have its porosity: the sums are right as they are. */
static bool alike(const mps_fluid *f, int64_t i) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const double own = mpsi_fluid_pore_of(f, i)->porosity;
  for (int32_t k = 0; k < f->near[i]; k++)
    if (porosity_of(f, index[k]) != own) return false;
  return true;
}

void mpsi_fluid_sum_pores(const mps_fluid *f, int64_t i, mpsi_fluid_sums *s) {
  const int32_t *index = f->index + mpsi_fluid_pairs(f, i);
  const float *w = f->w + mpsi_fluid_pairs(f, i);
  mpsi_fluid_pore *own = mpsi_fluid_pore_of(f, i);
  double n = 0.0, m[2] = {0.0, 0.0}, square = 0.0, shift[2] = {0.0, 0.0};
  own->fill = s->n;
  if (alike(f, i)) return;
  for (int32_t k = 0; k < f->near[i]; k++) {
    const int64_t j = index[k];
    const double part = w[k] * own->porosity / porosity_of(f, j);
    const double d[2] = {f->x[0][j] - f->x[0][i], f->x[1][j] - f->x[1][i]};
    const double r2 = fmax(d[0] * d[0] + d[1] * d[1], 0.0025 * f->l0 * f->l0);
    n += part, square += part * r2;
    for (int c = 0; c < 2; c++) m[c] += part * d[c], shift[c] += part * d[c] / sqrt(r2);
  }
  own->fill = n;
  s->r2 = square;
  for (int c = 0; c < 2; c++) s->m[c] = m[c], s->shift[c] = shift[c];
}

/* ---- of pairs -------------------------------------------------------------------------------- */

static void weigh_flow(mps_fluid *f, int64_t begin, int64_t end, int64_t chunk) {
  float *flow = f->rocks->flow_room.item;
  if (!mpsi_fluid_near_rock(f, chunk)) { /* w itself */
    const int64_t first = mpsi_fluid_pairs(f, begin);
    const int64_t last = mpsi_fluid_pairs(f, end - 1) + mpsi_fluid_padded(f->near[end - 1]);
    memcpy(flow + first, f->w + first, (size_t)(last - first) * sizeof *flow);
    return;
  }
  for (int64_t i = begin; i < end; i++) {
    const int64_t first = mpsi_fluid_pairs(f, i);
    const mpsi_fluid_pore *a = mpsi_fluid_pore_of(f, i);
    for (int32_t k = 0; k < mpsi_fluid_padded(f->near[i]); k++) {
      const int64_t j = f->index[first + k];
      const mpsi_fluid_pore *b = mpsi_fluid_pore_of(f, j < f->count ? j : f->parent[j - f->count]);
      const double ease = 2.0 * a->ease * b->ease / (a->ease + b->ease);
      flow[first + k] = (float)(f->w[first + k] * (ease / (a->porosity * b->porosity)));
    }
  }
}

mps_status mpsi_fluid_weigh_flow(mps_fluid *f, const char *function) {
  const int64_t pairs = f->w_room.capacity;
  if (!f->rocks) return MPS_OK;
  if (!mpsi_room_fit(f->context, &f->rocks->flow_room, pairs, sizeof(float)))
    return mpsi_fail_memory(f->context, function, (size_t)pairs * sizeof(float));
  mpsi_fluid_for(f, f->count, MPSI_FLUID_CHUNK, weigh_flow);
  return MPS_OK;
}

void mpsi_fluid_use_flow(mps_fluid *f, bool flow) {
  if (f->rocks) f->w = flow ? f->rocks->flow_room.item : f->w_room.item;
}

/* ---- regions --------------------------------------------------------------------------------- */

static mps_status check_number(mps_fluid *f, const char *name, double value, double least,
                               double most) {
  if (value >= least && value <= most) return MPS_OK;
  return mpsi_fail(f->context, "mps_fluid_add_rock", MPS_ERROR_ARGUMENT,
                   "%s of the rock is %s, must be %g to %g", name,
                   mpsi_outside(value, least, most).text, least, most);
}

static mps_status check(mps_fluid *f, const mps_fluid_rock_def *d) {
  mps_status status = check_number(f, "porosity", d->porosity, 0.1, 1.0);
  if (status == MPS_OK) status = check_number(f, "diameter", d->diameter, 1e-6, 100.0);
  if (status == MPS_OK) status = check_number(f, "alpha", d->alpha, 0.0, 1e6);
  if (status == MPS_OK) status = check_number(f, "beta", d->beta, 0.0, 1e3);
  if (status == MPS_OK) status = check_number(f, "gamma", d->gamma, 0.0, 10.0);
  if (status == MPS_OK) status = check_number(f, "viscosity", d->viscosity, 0.0, 1.0);
  if (status == MPS_OK && !isnan(d->KC)) status = check_number(f, "KC", d->KC, 1e-6, 1e300);
  if (status != MPS_OK) return status;
  if (d->corner_count < 3 || d->corner_count > MOST_CORNERS || !d->corners)
    return mpsi_fail(f->context, "mps_fluid_add_rock", MPS_ERROR_ARGUMENT,
                     "corner_count of the rock is %d with corners %s: allowed are 3 to %d corners, "
                     "given",
                     d->corner_count, d->corners ? "given" : "NULL", MOST_CORNERS);
  for (int32_t k = 0; k < 3 * d->corner_count; k++)
    if (!(fabs(d->corners[k]) <= 1e12) || (k % 3 == 2 && d->corners[k] != 0.0))
      return mpsi_fail(
          f->context, "mps_fluid_add_rock", MPS_ERROR_ARGUMENT,
          "corners: number %d of the rock has the coordinate %g m: must be within 1e12 m, z 0",
          k / 3, d->corners[k]);
  return MPS_OK;
}

/* A place for a region: a free one, or one more; -1: no memory. */
static int32_t find_room(mps_fluid *f) {
  if (!f->rocks) {
    mpsi_fluid_rocks *rocks = mpsi_alloc(f->context, 1, sizeof *rocks);
    if (!rocks) return -1;
    memset(rocks, 0, sizeof *rocks);
    f->rocks = rocks;
  }
  int32_t k = 0;
  while (k < f->rocks->room && f->rocks->rock[k].used) k++;
  if (k < f->rocks->room) return k;
  mpsi_fluid_rock *more = mpsi_alloc(f->context, k + 1, sizeof *more);
  if (!more) return -1;
  if (k > 0) memcpy(more, f->rocks->rock, (size_t)k * sizeof *more);
  memset(more + k, 0, sizeof *more);
  mpsi_free(f->context, f->rocks->rock);
  f->rocks->rock = more, f->rocks->room = k + 1;
  return k;
}

static void fill_in(mps_fluid *f, mpsi_fluid_rock *rock, const mps_fluid_rock_def *d) {
  const double e = d->porosity, D = d->diameter, solid = 1.0 - e;
  for (int32_t k = 0; k < d->corner_count; k++)
    rock->xy[2 * k] = d->corners[3 * k], rock->xy[2 * k + 1] = d->corners[3 * k + 1];
  for (int c = 0; c < 2; c++) {
    rock->low[c] = INFINITY, rock->high[c] = -INFINITY;
    for (int32_t k = 0; k < d->corner_count; k++) {
      rock->low[c] = fmin(rock->low[c], rock->xy[2 * k + c]);
      rock->high[c] = fmax(rock->high[c], rock->xy[2 * k + c]);
    }
  }
  rock->count = d->corner_count;
  rock->def = *d;
  rock->def.corners = NULL;
  rock->a = d->alpha * solid * solid / (e * e * e) * d->viscosity / (D * D);
  rock->b = d->beta * (1.0 + (isnan(d->KC) ? 0.0 : 7.5 / d->KC)) * solid / (e * e * e * D);
  rock->mass = 1.0 + d->gamma * solid / e;
  rock->weight = mpsi_fluid_make_weight(f->l0 / sqrt(e), f->weight.re);
  rock->used = true;
}

/* Without regions there is nothing to look at in a step. */
static void drop_if_none(mps_fluid *f) {
  for (int32_t k = 0; k < f->rocks->room; k++)
    if (f->rocks->rock[k].used) return;
  mpsi_fluid_drop_rocks(f);
}

/* Status of all ranks, and a check that all have the same rock of this number. */
static mps_status agree_on_rock(mps_fluid *f, const char *function, mps_status status,
                                int32_t number, const mps_fluid_rock_def *def) {
  mpsi_given given;
  if (!f->partition) return status;
  mpsi_given_begin(&given);
  mpsi_give(&given, "the number of the rock", number);
  MPSI_GIVE(&given, def, porosity);
  MPSI_GIVE(&given, def, diameter);
  MPSI_GIVE(&given, def, alpha);
  MPSI_GIVE(&given, def, beta);
  MPSI_GIVE(&given, def, KC);
  MPSI_GIVE(&given, def, gamma);
  MPSI_GIVE(&given, def, viscosity);
  MPSI_GIVE(&given, def, corner_count);
  if (status == MPS_OK)
    mpsi_give_bytes(&given, "a hash of corners", def->corners,
                    3 * (size_t)def->corner_count * sizeof *def->corners);
  return mpsi_domain_agree_given(f->def.domain, function, status, &given);
}

static mps_status read_rock(mps_fluid *f, const char *function, const mps_fluid_rock_def *user,
                            mps_fluid_rock_def *def) {
  if (!user) return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  const mps_status status = MPSI_DEF_READ(f->context, function, mps_fluid_rock_def, user, def);
  if (status != MPS_OK) return status;
  if (f->classical.gamma > 0.0)
    return mpsi_fail(f->context, function, MPS_ERROR_UNSUPPORTED, "rock with the classical scheme");
  return check(f, def);
}

mps_status mps_fluid_add_rock(mps_fluid *f, const mps_fluid_rock_def *user, int32_t *number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_fluid_rock_def def = defaults;
  double *xy = NULL;
  int32_t k = -1;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  status = read_rock(f, __func__, user, &def);
  if (status == MPS_OK) {
    const size_t size = 2 * (size_t)def.corner_count * sizeof *xy;
    xy = mpsi_alloc(f->context, 2 * (int64_t)def.corner_count, sizeof *xy);
    k = xy ? find_room(f) : -1;
    if (k < 0) status = mpsi_fail_memory(f->context, __func__, size);
  }
  status = agree_on_rock(f, __func__, status, k, &def);
  if (status != MPS_OK) {
    mpsi_free(f->context, xy);
    if (f->rocks) drop_if_none(f);
    return status;
  }
  f->rocks->rock[k].xy = xy;
  fill_in(f, &f->rocks->rock[k], &def);
  f->stale = true, f->unknown = 1;
  if (number) *number = k;
  return MPS_OK;
}

static mps_status check_rock(mps_fluid *f, const char *function, int32_t number) {
  if (number < 0 || !f->rocks || number >= f->rocks->room || !f->rocks->rock[number].used)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "the fluid has no rock of number %d",
                     number);
  return MPS_OK;
}

mps_status mps_fluid_remove_rock(mps_fluid *f, int32_t number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_same(f->def.domain, __func__, check_rock(f, __func__, number),
                                  "number", number);
  if (status != MPS_OK) return status;
  mpsi_free(f->context, f->rocks->rock[number].xy);
  f->rocks->rock[number] = (mpsi_fluid_rock){.used = false};
  drop_if_none(f);
  f->stale = true, f->unknown = 1;
  return MPS_OK;
}

void mpsi_fluid_drop_rocks(mps_fluid *f) {
  mpsi_fluid_rocks *rocks = f->rocks;
  if (!rocks) return;
  for (int32_t k = 0; k < rocks->room; k++) mpsi_free(f->context, rocks->rock[k].xy);
  mpsi_free(f->context, rocks->rock);
  mpsi_free(f->context, rocks->part_room.item);
  mpsi_free(f->context, rocks->flow_room.item);
  mpsi_free(f->context, rocks->free_room.item);
  mpsi_free(f->context, rocks);
  f->rocks = NULL;
}

double mpsi_fluid_least_porosity(const mps_fluid *f) {
  double least = 1.0;
  for (int32_t k = 0; f->rocks && k < f->rocks->room; k++)
    if (f->rocks->rock[k].used) least = fmin(least, f->rocks->rock[k].def.porosity);
  return least;
}

void mpsi_fluid_list_rocks(mpsi_state *s, const mps_fluid *f) {
  mpsi_state_agree_integer(s, "rocks", f->rocks ? f->rocks->room : 0);
  for (int32_t k = 0; f->rocks && k < f->rocks->room; k++) {
    const mpsi_fluid_rock *rock = &f->rocks->rock[k];
    mpsi_state_enter(s, "rock%d", k);
    mpsi_state_agree_number(s, "porosity", rock->def.porosity);
    mpsi_state_agree_number(s, "diameter", rock->def.diameter);
    mpsi_state_agree_number(s, "darcy", rock->a);
    mpsi_state_agree_number(s, "forchheimer", rock->b);
    mpsi_state_agree_number(s, "added_mass", rock->mass);
    mpsi_state_agree_integer(s, "corners", rock->count);
    for (int64_t c = 0; c < rock->count; c++) {
      mpsi_state_enter(s, "corner%d", (int)c);
      mpsi_state_agree_number(s, "x", rock->xy[2 * c]);
      mpsi_state_agree_number(s, "y", rock->xy[2 * c + 1]);
      mpsi_state_leave(s);
    }
    mpsi_state_leave(s);
  }
}
