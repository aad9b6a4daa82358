/* rock.c - permeable regions: their definitions, and what follows from them. What they are to
 * particles and pairs is in pores.c.
 *
 * The radius of the weights in rock is 2.4 spacings l0/e^.5 of its particles, at most 3.6 l0 and at
 * least that in water: with the 3.1 l0 of water they have too few neighbours there, and forces on
 * what stands on the rock are noise. SPDX-License-Identifier: BSD-3-Clause */
#include "rock.h"
#include "fluid/base/access.h"
#include "fluid/boundary/clearance.h"
#include "fluid/particles/near.h"
#include "fluid/ranks/partition.h"

#include <string.h>

#define WIDE 2.4   /* spacings of rock: radius of weights in it */
#define WIDEST 3.6 /* l0 */

/* ---- regions --------------------------------------------------------------------------------- */

static mps_status check(mps_fluid *f, const mps_fluid_rock_def *d) {
  for (int64_t k = 0; k < d->corner_count; k++)
    if (d->corners[3 * k + 2] != 0.0)
      return mpsi_fail(f->context, "mps_fluid_add_rock", MPS_ERROR_ARGUMENT,
                       "corners: number %lld of the rock has z %g m, must be 0", (long long)k,
                       d->corners[3 * k + 2]);
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
  while (k < f->rocks->capacity && f->rocks->rock[k].used) k++;
  if (k < f->rocks->capacity) return k;
  mpsi_fluid_rock *more = mpsi_alloc(f->context, k + 1, sizeof *more);
  if (!more) return -1;
  if (k > 0) memcpy(more, f->rocks->rock, (size_t)k * sizeof *more);
  memset(more + k, 0, sizeof *more);
  mpsi_free(f->context, f->rocks->rock);
  f->rocks->rock = more, f->rocks->capacity = k + 1;
  return k;
}

/* Radius of the weights in rock of a porosity, m. */
static double radius_in(const mps_fluid *f, double porosity) {
  return fmax(fmin(WIDE * f->l0 / sqrt(porosity), WIDEST * f->l0), f->weight.re);
}

static void fill_in(mps_fluid *f, mpsi_fluid_rock *rock, const mps_fluid_rock_def *d) {
  const double e = d->porosity, D = d->diameter, solid = 1.0 - e;
  for (int64_t k = 0; k < d->corner_count; k++)
    rock->xy[2 * k] = d->corners[3 * k], rock->xy[2 * k + 1] = d->corners[3 * k + 1];
  for (int c = 0; c < 2; c++) {
    rock->low[c] = INFINITY, rock->high[c] = -INFINITY;
    for (int64_t k = 0; k < d->corner_count; k++) {
      rock->low[c] = fmin(rock->low[c], rock->xy[2 * k + c]);
      rock->high[c] = fmax(rock->high[c], rock->xy[2 * k + c]);
    }
  }
  rock->count = (int32_t)d->corner_count;
  rock->def = *d;
  rock->def.corners = NULL;
  rock->a = d->alpha * solid * solid / (e * e * e) * d->viscosity / (D * D);
  rock->b = d->beta * (1.0 + (isnan(d->KC) ? 0.0 : 7.5 / d->KC)) * solid / (e * e * e * D);
  rock->mass = 1.0 + d->gamma * solid / e;
  rock->weight = mpsi_fluid_make_weight(f->l0 / sqrt(e), radius_in(f, e), f->weight.re);
  rock->used = true;
}

static void find_reach(mps_fluid *f) {
  f->reach = f->weight.re;
  for (int32_t k = 0; f->rocks && k < f->rocks->capacity; k++)
    if (f->rocks->rock[k].used) f->reach = fmax(f->reach, f->rocks->rock[k].weight.re);
  if (!f->rocks) return;
  f->rocks->spacing = f->l0 / sqrt(mpsi_fluid_least_porosity(f));
}

/* Without regions there is nothing to look at in a step. */
static void drop_if_none(mps_fluid *f) {
  for (int32_t k = 0; k < f->rocks->capacity; k++)
    if (f->rocks->rock[k].used) return;
  mpsi_fluid_drop_rocks(f);
}

/* Status of all ranks, and a check that all have the same rock of this number. */
static mps_status agree_on_rock(mps_fluid *f, const char *function, mps_status status,
                                int32_t number, const mps_fluid_rock_def *def) {
  mpsi_given given = MPSI_GIVEN;
  if (!f->partition) return status;
  mpsi_give(&given, "the number of the rock", number);
  MPSI_GIVE_DEF(&given, mps_fluid_rock_def, def);
  if (status == MPS_OK)
    mpsi_give_bytes(&given, "a hash of corners", def->corners,
                    3 * (size_t)def->corner_count * sizeof *def->corners);
  return mpsi_domain_agree_given(f->domain, function, status, &given);
}

static mps_status read_rock(mps_fluid *f, const char *function, const mps_fluid_rock_def *user,
                            mps_fluid_rock_def *def) {
  if (!user) return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  MPSI_TRY(MPSI_DEF_READ(f->context, function, mps_fluid_rock_def, user, def));
  if (f->classical.gamma > 0.0)
    return mpsi_fail(f->context, function, MPS_ERROR_UNSUPPORTED, "rock with the classical scheme");
  const mps_status wrong = check(f, def);
  const double reach = radius_in(f, def->porosity);
  return wrong == MPS_OK && reach > f->reach ? mpsi_fluid_check_reach(f, function, reach) : wrong;
}

mps_status mps_fluid_add_rock(mps_fluid *f, const mps_fluid_rock_def *user, int32_t *number) {
  if (!f) return mpsi_null(__func__, "fluid");
  mps_fluid_rock_def def = mps_fluid_rock_defaults();
  double *xy = NULL;
  int32_t k = -1;
  MPSI_TRY(mpsi_fluid_ready(f, __func__));
  mps_status status = read_rock(f, __func__, user, &def);
  if (status == MPS_OK) {
    const size_t size = 2 * (size_t)def.corner_count * sizeof *xy;
    xy = mpsi_alloc(f->context, 2 * def.corner_count, sizeof *xy);
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
  find_reach(f);
  f->stale = true, f->unknown = 1;
  if (number) *number = k;
  return MPS_OK;
}

static mps_status check_rock(mps_fluid *f, const char *function, int32_t number) {
  if (number < 0 || !f->rocks || number >= f->rocks->capacity || !f->rocks->rock[number].used)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "number is %d: there is no rock of this number", number);
  return MPS_OK;
}

mps_status mps_fluid_remove_rock(mps_fluid *f, int32_t number) {
  if (!f) return mpsi_null(__func__, "fluid");
  MPSI_TRY(mpsi_fluid_ready(f, __func__));
  MPSI_TRY(mpsi_domain_agree_same(f->domain, __func__, check_rock(f, __func__, number), "number",
                                  number));
  mpsi_free(f->context, f->rocks->rock[number].xy);
  f->rocks->rock[number] = (mpsi_fluid_rock){.used = false};
  drop_if_none(f);
  find_reach(f);
  f->stale = true, f->unknown = 1;
  return MPS_OK;
}

void mpsi_fluid_drop_rocks(mps_fluid *f) {
  mpsi_fluid_rocks *rocks = f->rocks;
  if (!rocks) return;
  for (int32_t k = 0; k < rocks->capacity; k++) mpsi_free(f->context, rocks->rock[k].xy);
  MPSI_FREE(f->context, rocks->rock, rocks->part_room.item, rocks->flow_room.item,
            rocks->free_room.item, rocks->region_room.item, rocks->start_room.item, rocks);
  f->rocks = NULL;
}

double mpsi_fluid_least_porosity(const mps_fluid *f) {
  double least = 1.0;
  for (int32_t k = 0; f->rocks && k < f->rocks->capacity; k++)
    if (f->rocks->rock[k].used) least = fmin(least, f->rocks->rock[k].def.porosity);
  return least;
}

void mpsi_fluid_list_rocks(mpsi_state *s, const mps_fluid *f) {
  mpsi_state_agree_integer(s, "rocks", f->rocks ? f->rocks->capacity : 0);
  for (int32_t k = 0; f->rocks && k < f->rocks->capacity; k++) {
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
