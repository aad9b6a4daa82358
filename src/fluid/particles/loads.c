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
#include "core/base/order.h"
#include "fluid/base/access.h"
#include "fluid/ranks/partition.h"
#include "signal/signal_internal.h"

#include <stdlib.h>

#define MOST_LOADS 1024

/* ---- definitions ----------------------------------------------------------------------------- */

static mps_status check(void *solver, const char *function, int32_t number, const void *known) {
  const mps_fluid *f = solver;
  const mps_fluid_load_def *d = known;
  if (d->kind == MPS_FLUID_LOAD_PRESSURE && f->classical.gamma > 0.0)
    return mpsi_fail(
        f->context, function, MPS_ERROR_UNSUPPORTED,
        "a pressure load acts on the surface, which the classical scheme does not have");
  return MPS_OK;
}

/* The particles of a box are those that are in it in each step. */
static bool keeps(const void *def, mpsi_selected by) { return true; }

static bool counts(const void *solver, int64_t id) {
  return mps_particles_index(((const mps_fluid *)solver)->particles, id) >= 0;
}

static mps_status make(void *solver, const char *function, int32_t number, void *known, void *own) {
  const mps_fluid_load_def *def = known;
  mpsi_fluid_given *g = own;
  const double scalar = def->kind == MPS_FLUID_LOAD_PRESSURE ? def->pressure : def->rate;
  g->def = def;
  if (def->ids) qsort((void *)def->ids, (size_t)def->id_count, sizeof *def->ids, mpsi_ascending);
  for (int c = 0; c < 2; c++) {
    g->lower[c] = isnan(def->lower[c]) ? -INFINITY : def->lower[c];
    g->upper[c] = isnan(def->upper[c]) ? INFINITY : def->upper[c];
    g->amount[c] = def->kind == MPS_FLUID_LOAD_BODY ? def->acceleration[c] : c == 0 ? scalar : 0.0;
  }
  return MPS_OK;
}

const mpsi_condition_kind mpsi_fluid_loads = {
    MPSI_CONDITION_OF(FLUID, fluid, LOAD, load),
    .role = MPSI_SIGNAL_NUMBER,
    .list = {{"ids", "id_count", 1}},
    .most = MOST_LOADS,
    .size = sizeof(mpsi_fluid_given),
    .check = check,
    .selects = true,
    .keeps = keeps,
    .counts = counts,
    .some = true,
    .make = make,
};

/* ---- in a step ------------------------------------------------------------------------------- */

static bool chosen(const mps_fluid *f, const mpsi_fluid_given *g, const int64_t *id, int64_t i) {
  if (g->def->ids)
    return bsearch(&id[i], g->def->ids, (size_t)g->def->id_count, sizeof *id, mpsi_ascending) !=
           NULL;
  for (int c = 0; c < 2; c++)
    if (!(f->x[c][i] >= g->lower[c] && f->x[c][i] <= g->upper[c])) return false;
  return true;
}

/* z^2 of a damping zone, z the part of its length; 1 without a rise. */
static double profile(const mpsi_fluid_given *g, double x) {
  if (g->def->rise == 0) return 1.0;
  const double part = (x - g->lower[0]) / (g->upper[0] - g->lower[0]);
  const double z = g->def->rise > 0 ? part : 1.0 - part;
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
  if (g->def->kind == MPS_FLUID_LOAD_DAMPING) {
    add_damping(f, g);
    return;
  }
  const int64_t *id = mpsi_particles_integers(f->particles, "id");
  const double a[2] = {g->amount[0] * g->now[0], g->amount[1] * g->now[1]};
  for (int64_t i = 0; i < f->count; i++) {
    if (!chosen(f, g, id, i)) continue;
    if (g->def->kind == MPS_FLUID_LOAD_PRESSURE)
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

/* Which loads there are. */
typedef struct kinds {
  bool any, pressure;
} kinds;

static mps_status evaluate_signals(const mps_fluid *f, const char *function, double t,
                                   kinds *found) {
  for (int32_t k = 0; k < mpsi_fluid_load_count(f); k++) {
    mpsi_fluid_given *g = mpsi_fluid_load_of(f, k);
    if (!g) continue;
    found->any = true;
    if (g->def->kind == MPS_FLUID_LOAD_PRESSURE) found->pressure = true;
    for (int c = 0; c < 2; c++) {
      const bool driven = c == 0 || g->def->kind == MPS_FLUID_LOAD_BODY;
      const mps_signal *signal = driven ? g->def->signal[c] : NULL;
      double factor;
      const mpsi_signal_use use = {f->context, function, "load", k, c};
      MPSI_TRY(mpsi_signal_factor(signal, use, t, &factor));
      g->now[c] = g->def->factor[c] * factor;
    }
  }
  return MPS_OK;
}

mps_status mpsi_fluid_find_loads(mps_fluid *f, const char *function, double t) {
  kinds found = {.any = mpsi_particles_column(f->particles, "external_force", 0) != NULL};
  f->push[0] = f->push[1] = f->over = NULL;
  const mps_status status = evaluate_signals(f, function, t, &found);
  if (status != MPS_OK || !found.any) return status;
  if (!mpsi_room_ensure(f->context, &f->push_room, 3 * f->count, sizeof(double)))
    return mpsi_fail_memory(f->context, function, (size_t)f->count * 24);
  double *const scratch = f->push_room.item;
  for (int64_t k = 0; k < 3 * f->count; k++) scratch[k] = 0.0;
  f->push[0] = scratch, f->push[1] = scratch + f->count;
  f->over = found.pressure ? scratch + 2 * f->count : NULL;
  add_forces(f);
  for (int32_t k = 0; k < mpsi_fluid_load_count(f); k++)
    if (mpsi_fluid_load_of(f, k)) add_load(f, mpsi_fluid_load_of(f, k));
  return MPS_OK;
}

/* Part c of load k at the solver's time; 0 where it follows a caller's function, unless `call`, or
 * fails: what fails here fails in the step. */
static double factor_now(const mps_fluid *f, int32_t k, int c, bool call) {
  const mpsi_fluid_given *g = mpsi_fluid_load_of(f, k);
  const mpsi_signal_use use = {f->context, __func__, "load", k, c};
  double factor = 0.0;
  if (!call && mpsi_signal_may_fail(g->def->signal[c])) return 0.0;
  return mpsi_signal_factor(g->def->signal[c], use, f->time, &factor) == MPS_OK
             ? g->def->factor[c] * factor
             : 0.0;
}

double mpsi_fluid_pushed(const mps_fluid *f, bool call) {
  const double mass = f->def.density * f->l0 * f->l0 * f->def.measure;
  const double *force[2];
  double sum = 0.0, most2 = 0.0;
  for (int32_t k = 0; k < mpsi_fluid_load_count(f); k++) {
    const mpsi_fluid_given *g = mpsi_fluid_load_of(f, k);
    if (g && g->def->kind == MPS_FLUID_LOAD_BODY)
      sum +=
          hypot(g->amount[0] * factor_now(f, k, 0, call), g->amount[1] * factor_now(f, k, 1, call));
  }
  for (int c = 0; c < 2; c++) force[c] = mpsi_particles_column(f->particles, "external_force", c);
  for (int64_t i = 0; force[0] && i < f->count; i++)
    most2 = fmax(most2, force[0][i] * force[0][i] + force[1][i] * force[1][i]);
  return sum + sqrt(most2) / mass;
}

double mpsi_fluid_work_of_loads(const mps_fluid *f) {
  const double volume = f->l0 * f->l0 * f->def.measure, mass = f->def.density * volume;
  const double area = volume / f->weight.square;
  double sum = 0.0;
  for (int c = 0; f->push[0] && c < 2; c++) {
    const double *before = mpsi_particles_column(f->particles, "velocity", c);
    for (int64_t i = 0; i < f->count; i++) {
      const double m = f->state[i] == MPSI_FLUID_APART ? 0.0 : f->local[i].m[c];
      const double force = mass * f->push[c][i] + (f->over ? f->over[i] * area * m : 0.0);
      sum += 0.5 * f->dt * force * (before[i] + f->u[c][i]);
    }
  }
  return sum;
}
