/* loads.c - loads of the caller: accelerations of particles (a shaken tank), forces that another
 * code writes into the field `external_force`, pressures on the free surface.
 *
 * An acceleration b changes the velocity before the pressure solution, of a particle and of its
 * images at walls; q of these images then differs by rho b . (x_image - x), so that a linear
 * pressure balances a uniform b exactly, as in a tank that moves with -b. A pressure adds to that
 * of the surface point. Its work is taken with the area vector of each particle, -V m/S0: sum w dx
 * adds up to the area of a plane surface exactly, and vanishes inside.
 *
 * Damping, -r z^2 u, z from 0 to 1 along a zone, makes waves fade without a reflection of its own.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "loads.h"
#include "fluid/base/access.h"
#include "core/base/digits.h"
#include "fluid/ranks/partition.h"
#include "signal/signal_internal.h"

#include <stdlib.h>

#define MOST_LOADS 1024

static const mps_fluid_load_def load_defaults = {
    .struct_size = sizeof(mps_fluid_load_def),
    .lower = {NAN, NAN, NAN},
    .upper = {NAN, NAN, NAN},
    .factor = {1.0, 1.0, 1.0},
};

mps_status mps_fluid_load_def_init(mps_fluid_load_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_fluid_load_def, def, size, &load_defaults);
}

/* ---- definitions ----------------------------------------------------------------------------- */

static mps_status check_load(mps_fluid *f, const char *function, const mps_fluid_load_def *d) {
  if (d->kind < MPS_FLUID_LOAD_BODY || d->kind > MPS_FLUID_LOAD_DAMPING)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "kind of the load is %d, allowed are 0 (body), 1 (pressure) and 2 (damping)",
                     d->kind);
  if (d->kind == MPS_FLUID_LOAD_PRESSURE && f->classical.gamma > 0.0)
    return mpsi_fail(
        f->context, function, MPS_ERROR_UNSUPPORTED,
        "a pressure load acts on the surface, which the classical scheme does not have");
  if (d->id_count < 0 || (d->id_count > 0) != (d->ids != NULL))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "id_count of the load is %lld with ids %s: give both or neither",
                     (long long)d->id_count, d->ids ? "given" : "NULL");
  for (int c = 0; c < 3; c++) {
    const double most = c == 2 ? 0.0 : 1e6;
    if (!(fabs(d->acceleration[c]) <= most))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "acceleration[%d] of the load is %s m/s2, allowed is %g at most", c,
                       mpsi_outside(d->acceleration[c], -most, most).text, most);
    if (!isfinite(d->factor[c]))
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "factor[%d] of the load is %g, must be finite", c, d->factor[c]);
    if (d->lower[c] > d->upper[c])
      return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                       "lower and upper of the load are %g and %g m along %c: empty", d->lower[c],
                       d->upper[c], "xyz"[c]);
  }
  if (!(d->rate >= 0.0 && d->rate <= 1e6))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "rate of the load is %s 1/s, allowed is 0 to 1e6",
                     mpsi_outside(d->rate, 0.0, 1e6).text);
  if (d->side < -1 || d->side > 1)
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "side of the load is %d, allowed are -1, 0 and 1", d->side);
  if (d->kind == MPS_FLUID_LOAD_DAMPING && d->side != 0 &&
      !(isfinite(d->lower[0]) && isfinite(d->upper[0]) && d->upper[0] > d->lower[0]))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "lower[0] and upper[0] of the load are %g and %g m: with a side both must be "
                     "finite and ascending",
                     d->lower[0], d->upper[0]);
  if (!(fabs(d->pressure) <= 1e12))
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                     "pressure of the load is %g Pa, allowed is 1e12 at most", d->pressure);
  return MPS_OK;
}

static int ascending(const void *a, const void *b) {
  const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
  return (x > y) - (x < y);
}

static void drop(mps_fluid *f, mpsi_fluid_given *g) {
  if (!g) return;
  for (int c = 0; c < 2; c++) mps_signal_destroy(&g->signal[c]);
  mpsi_free(f->context, g->ids);
  mpsi_free(f->context, g);
}

static mps_status make_load(mps_fluid *f, const char *function, const mps_fluid_load_def *user_def,
                            mpsi_fluid_given **out) {
  if (!user_def) return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "def is NULL");
  mps_fluid_load_def d = load_defaults;
  mps_status status = MPSI_DEF_READ(f->context, function, mps_fluid_load_def, user_def, &d);
  if (status == MPS_OK) status = check_load(f, function, &d);
  if (status != MPS_OK) return status;
  mpsi_fluid_given *g = mpsi_alloc(f->context, 1, sizeof *g);
  if (!g) return mpsi_fail_memory(f->context, function, sizeof *g);
  *g = (mpsi_fluid_given){.kind = d.kind, .count = d.id_count, .side = d.side};
  if (g->count > 0 && !(g->ids = mpsi_alloc(f->context, g->count, sizeof *g->ids))) {
    drop(f, g);
    return mpsi_fail_memory(f->context, function, (size_t)d.id_count * sizeof *d.ids);
  }
  for (int64_t k = 0; k < g->count; k++) g->ids[k] = d.ids[k];
  if (g->count > 0) qsort(g->ids, (size_t)g->count, sizeof *g->ids, ascending);
  const bool pushes = d.kind == MPS_FLUID_LOAD_BODY;
  const double scalar = d.kind == MPS_FLUID_LOAD_PRESSURE ? d.pressure : d.rate;
  for (int c = 0; c < 2; c++) {
    g->lower[c] = isnan(d.lower[c]) ? -INFINITY : d.lower[c];
    g->upper[c] = isnan(d.upper[c]) ? INFINITY : d.upper[c];
    g->amount[c] = pushes ? d.acceleration[c] : c == 0 ? scalar : 0.0;
    g->factor[c] = d.factor[c];
    if (d.signal[c] && (pushes || c == 0)) g->signal[c] = mpsi_signal_retain(d.signal[c]);
  }
  *out = g;
  return MPS_OK;
}

/* Status of all ranks, and a check that all have the same load (`g`, NULL: none) of this number. */
static mps_status settle(mps_fluid *f, const char *function, mps_status status, int32_t number,
                         const mpsi_fluid_given *g) {
  if (!f->partition) return status;
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "number", number);
  if (status == MPS_OK && g) {
    MPSI_GIVE(&given, g, kind);
    MPSI_GIVE(&given, g, side);
    MPSI_GIVE_VECTOR(&given, g, lower, 2);
    MPSI_GIVE_VECTOR(&given, g, upper, 2);
    MPSI_GIVE_VECTOR(&given, g, amount, 2);
    MPSI_GIVE_VECTOR(&given, g, factor, 2);
    mpsi_give(&given, "id_count", (double)g->count);
    mpsi_give_bytes(&given, "a hash of ids", g->ids, (size_t)g->count * sizeof *g->ids);
    for (int c = 0; c < 2; c++) mpsi_signal_give(&given, "a hash of signal", g->signal[c]);
  }
  return mpsi_domain_agree_given(f->def.domain, function, status, &given);
}

mps_status mps_fluid_add_load(mps_fluid *f, const mps_fluid_load_def *def, int32_t *number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  int32_t at = 0;
  while (at < f->given_room && f->given[at]) at++;
  if (at == MOST_LOADS)
    status = mpsi_fail(f->context, __func__, MPS_ERROR_ARGUMENT,
                       "the fluid has %d loads, the most there can be", at);
  mpsi_fluid_given *g = NULL;
  if (status == MPS_OK) status = make_load(f, __func__, def, &g);
  if (status == MPS_OK && at == f->given_room) {
    void *array = f->given;
    if (mpsi_grow(f->context, &array, at, at + 8, sizeof *f->given))
      f->given = array, f->given_room = at + 8;
    else
      status = mpsi_fail_memory(f->context, __func__, (size_t)(at + 8) * sizeof *f->given);
  }
  status = settle(f, __func__, status, at, g);
  if (status != MPS_OK) {
    drop(f, g);
    return status;
  }
  f->given[at] = g;
  if (number) *number = at;
  return MPS_OK;
}

static mps_status check_number(mps_fluid *f, const char *function, int32_t number) {
  if (number < 0 || number >= f->given_room || !f->given[number])
    return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT, "the fluid has no load of number %d",
                     number);
  return MPS_OK;
}

mps_status mps_fluid_set_load(mps_fluid *f, int32_t number, const mps_fluid_load_def *def) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  mpsi_fluid_given *g = NULL;
  status = check_number(f, __func__, number);
  if (status == MPS_OK) status = make_load(f, __func__, def, &g);
  status = settle(f, __func__, status, number, g);
  if (status != MPS_OK) {
    drop(f, g);
    return status;
  }
  drop(f, f->given[number]);
  f->given[number] = g;
  return MPS_OK;
}

mps_status mps_fluid_remove_load(mps_fluid *f, int32_t number) {
  if (!f) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_fluid_ready(f, __func__);
  if (status != MPS_OK) return status;
  status = mpsi_domain_agree_same(f->def.domain, __func__, check_number(f, __func__, number),
                                  "number", number);
  if (status != MPS_OK) return status;
  drop(f, f->given[number]);
  f->given[number] = NULL;
  return MPS_OK;
}

void mpsi_fluid_drop_loads(mps_fluid *f) {
  for (int32_t k = 0; k < f->given_room; k++) drop(f, f->given[k]);
  mpsi_free(f->context, f->given);
  mpsi_free(f->context, f->push_room.item);
}

/* ---- in a step ------------------------------------------------------------------------------- */

static bool chosen(const mps_fluid *f, const mpsi_fluid_given *g, const int64_t *id, int64_t i) {
  if (g->count > 0) return bsearch(&id[i], g->ids, (size_t)g->count, sizeof *id, ascending) != NULL;
  for (int c = 0; c < 2; c++)
    if (!(f->x[c][i] >= g->lower[c] && f->x[c][i] <= g->upper[c])) return false;
  return true;
}

/* z^2 of a damping zone, z the part of its length; 1 without a side. */
static double profile(const mpsi_fluid_given *g, double x) {
  if (g->side == 0) return 1.0;
  const double part = (x - g->lower[0]) / (g->upper[0] - g->lower[0]);
  const double z = g->side > 0 ? part : 1.0 - part;
  return z * z;
}

/* A particle loses at most its velocity in a step. */
static void add_damping(mps_fluid *f, const mpsi_fluid_given *g) {
  const int64_t *id = mpsi_particles_integers(f->particles, "id");
  const double rate = g->amount[0] * g->now[0], most = f->dt > 0.0 ? 1.0 / f->dt : INFINITY;
  for (int c = 0; c < 2; c++) {
    const double *u = mpsi_particles_column(f->particles, "velocity", c);
    for (int64_t i = 0; i < f->count; i++)
      if (chosen(f, g, id, i))
        f->push[c][i] -= fmin(fmax(rate * profile(g, f->x[0][i]), 0.0), most) * u[i];
  }
}

static void add_load(mps_fluid *f, const mpsi_fluid_given *g) {
  if (g->kind == MPS_FLUID_LOAD_DAMPING) {
    add_damping(f, g);
    return;
  }
  const int64_t *id = mpsi_particles_integers(f->particles, "id");
  const double a[2] = {g->amount[0] * g->now[0], g->amount[1] * g->now[1]};
  for (int64_t i = 0; i < f->count; i++) {
    if (!chosen(f, g, id, i)) continue;
    if (g->kind == MPS_FLUID_LOAD_PRESSURE)
      f->over[i] += a[0];
    else
      f->push[0][i] += a[0], f->push[1][i] += a[1];
  }
}

static void add_forces(mps_fluid *f) {
  const double mass = f->def.density * f->l0 * f->l0 * f->def.measure;
  for (int c = 0; c < 2; c++) {
    const double *force = mpsi_particles_column(f->particles, "external_force", c);
    for (int64_t i = 0; force && i < f->count; i++) f->push[c][i] += force[i] / mass;
  }
}

static mps_status evaluate_signals(mps_fluid *f, const char *function, double t, bool *any) {
  for (int32_t k = 0; k < f->given_room; k++) {
    mpsi_fluid_given *g = f->given[k];
    if (!g) continue;
    *any = true;
    for (int c = 0; c < 2; c++) {
      mpsi_signal_motion at = {.u = 1.0};
      const mpsi_signal_use use = {f->context, function, "load", k, c};
      const mps_status status =
          g->signal[c] ? mpsi_signal_evaluate(g->signal[c], use, t, &at) : MPS_OK;
      if (status != MPS_OK) return status;
      g->now[c] = g->factor[c] * at.u;
    }
  }
  return MPS_OK;
}

mps_status mpsi_fluid_find_loads(mps_fluid *f, const char *function, double t) {
  bool any = mpsi_particles_column(f->particles, "external_force", 0) != NULL;
  f->push[0] = f->push[1] = f->over = NULL;
  const mps_status status = evaluate_signals(f, function, t, &any);
  if (status != MPS_OK || !any) return status;
  if (!mpsi_room_ensure(f->context, &f->push_room, 3 * f->count, sizeof(double)))
    return mpsi_fail_memory(f->context, function, (size_t)f->count * 24);
  double *const room = f->push_room.item;
  for (int64_t k = 0; k < 3 * f->count; k++) room[k] = 0.0;
  f->push[0] = room, f->push[1] = room + f->count, f->over = room + 2 * f->count;
  add_forces(f);
  for (int32_t k = 0; k < f->given_room; k++)
    if (f->given[k]) add_load(f, f->given[k]);
  return MPS_OK;
}

double mpsi_fluid_work_of_loads(const mps_fluid *f) {
  const double volume = f->l0 * f->l0 * f->def.measure, mass = f->def.density * volume;
  const double area = volume / f->weight.square;
  double sum = 0.0;
  for (int c = 0; f->push[0] && c < 2; c++) {
    const double *before = mpsi_particles_column(f->particles, "velocity", c);
    for (int64_t i = 0; i < f->count; i++) {
      const double m = f->state[i] == MPSI_FLUID_APART ? 0.0 : f->local[i].m[c];
      const double force = mass * f->push[c][i] + f->over[i] * area * m;
      sum += 0.5 * f->dt * force * (before[i] + f->u[c][i]);
    }
  }
  return sum;
}
