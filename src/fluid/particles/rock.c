/* rock.c - permeable regions: their definitions, and what follows from them. What they are to
 * particles and pairs is in pores.c.
 *
 * The radius of the weights in rock is 2.4 spacings l0/e^.5 of its particles, at most 3.6 l0 and at
 * least that in water: with the 3.1 l0 of water they have too few neighbours there, and forces on
 * what stands on the rock are noise. SPDX-License-Identifier: BSD-3-Clause */
#include "rock.h"
#include "fluid/base/access.h"
#include "core/base/digits.h"
#include "fluid/particles/near.h"
#include "fluid/ranks/partition.h"

#include <string.h>

#define MOST_CORNERS 10000
#define WIDE 2.4   /* spacings of rock: radius of weights in it */
#define WIDEST 3.6 /* l0 */

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
  const double spacing = f->l0 / sqrt(e);
  rock->weight = mpsi_fluid_make_weight(
      spacing, fmax(fmin(WIDE * spacing, WIDEST * f->l0), f->weight.re), f->weight.re);
  rock->used = true;
}

static void find_reach(mps_fluid *f) {
  f->reach = f->weight.re;
  for (int32_t k = 0; f->rocks && k < f->rocks->room; k++)
    if (f->rocks->rock[k].used) f->reach = fmax(f->reach, f->rocks->rock[k].weight.re);
  if (!f->rocks) return;
  f->rocks->spacing = f->l0 / sqrt(mpsi_fluid_least_porosity(f));
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
  find_reach(f);
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
  find_reach(f);
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
  mpsi_free(f->context, rocks->region_room.item);
  mpsi_free(f->context, rocks->start_room.item);
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
