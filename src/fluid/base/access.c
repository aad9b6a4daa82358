/* access.c - access to the solver object: its guard, checks of a step size, its energy; and loops
 * over its particles by all threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "access.h"
#include "fluid/ranks/partition.h"

mps_status mpsi_fluid_free(mps_fluid *f, const char *function) {
  return mpsi_guard_check(&f->guard, f->context, function);
}

mps_status mpsi_fluid_ready(mps_fluid *f, const char *function) {
  return mpsi_solver_enter(&f->base, function);
}

mps_status mpsi_fluid_closed(void *solver, const char *function) {
  mps_fluid *f = solver;
  if (f->stage == MPSI_FLUID_BETWEEN) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_STATE,
                   "a step is open: end or abandon it first");
}

mps_status mpsi_fluid_check_dt(void *solver, const char *function, double dt) {
  const mps_fluid *f = solver;
  const double longest = f->g > 0.0 ? 0.5 * sqrt(f->l0 / f->g) : INFINITY;
  if (isnan(dt) || (dt > 0.0 && dt <= longest && isfinite(dt))) return MPS_OK;
  return mpsi_fail(f->context, function, MPS_ERROR_ARGUMENT,
                   "dt is %g s, must be NaN or > 0 and at most half of (l0/g)^1/2, %g s", dt,
                   longest);
}

double mpsi_fluid_energy(const mps_fluid *f, double *kinetic) {
  const double *x = mpsi_particles_column(f->particles, "position", 0);
  const double *y = mpsi_particles_column(f->particles, "position", 1);
  const double *u = mpsi_particles_column(f->particles, "velocity", 0);
  const double *v = mpsi_particles_column(f->particles, "velocity", 1);
  const double volume = f->l0 * f->l0 * f->def.measure;
  double square = 0.0, head = 0.0;
  for (int64_t i = 0; i < f->count; i++) {
    square += u[i] * u[i] + v[i] * v[i];
    head += mpsi_fluid_head(f, x[i], y[i]);
  }
  *kinetic = 0.5 * f->def.density * volume * square;
  return *kinetic + volume * head;
}

typedef struct work {
  mps_fluid *fluid;
  mpsi_fluid_task task;
  int64_t items, chunk;
} work;

static void unit_of_work(void *data, int64_t unit, int32_t worker) {
  const work *w = data;
  const int64_t begin = unit * w->chunk, end = begin + w->chunk;
  w->task(w->fluid, begin, end < w->items ? end : w->items, unit);
}

void mpsi_fluid_for(mps_fluid *f, int64_t items, int64_t chunk, mpsi_fluid_task task) {
  work w = {f, task, items, chunk};
  mpsi_fluid_units(f, chunk, unit_of_work, &w);
}

void mpsi_fluid_for_all(mps_fluid *f, int64_t items, int64_t chunk, mpsi_fluid_task task) {
  work w = {f, task, items, chunk};
  mpsi_parallel_for(f->context, (items + chunk - 1) / chunk, unit_of_work, &w);
}

typedef struct shifted {
  int64_t first;
  void (*task)(void *, int64_t, int32_t);
  void *data;
} shifted;

static void run_shifted(void *data, int64_t unit, int32_t worker) {
  const shifted *s = data;
  s->task(s->data, s->first + unit, worker);
}

void mpsi_fluid_units(mps_fluid *f, int64_t size, void (*task)(void *, int64_t, int32_t),
                      void *data) {
  shifted s = {f->own[0] / size, task, data};
  const int64_t count = (f->own[1] + size - 1) / size - s.first;
  if (s.first == 0)
    mpsi_parallel_for(f->context, count, task, data);
  else if (count > 0)
    mpsi_parallel_for(f->context, count, run_shifted, &s);
}
