/* fluid_readings.h - all readings of a fluid without a step, as numbers: levels, pressures along
 * walls and at points, reactions, totals, the report (but for memory), the next step's size.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_FLUID_READINGS_H
#define MPS_FLUID_READINGS_H

#include "fluid_tank.h"

enum { READINGS = 4000 };

typedef struct readings {
  int64_t count;
  double value[READINGS];
} readings;

static inline void reading(readings *r, double value) {
  assert_true(r->count < READINGS);
  r->value[r->count++] = value;
}

static inline void read_reaction(readings *r, const mps_reaction *force) {
  reading(r, (double)force->count), reading(r, (double)force->removed);
  reading(r, force->work), reading(r, force->removed_mass);
  for (int c = 0; c < 3; c++) {
    reading(r, force->force[c]), reading(r, force->moment[c]);
    reading(r, force->impulse[c]), reading(r, force->moment_impulse[c]);
  }
}

/* Of wall `number`; points along its whole length from `point` on, half a spacing apart. */
static inline void read_wall(mps_fluid *fluid, int32_t number, const double *point, readings *r) {
  enum { MOST = 300 };
  const double half = 0.5 * mps_particles_spacing(mps_fluid_particles(fluid));
  double x[3 * MOST], p[MOST];
  int64_t count = 0;
  OK(mps_fluid_get_boundary_points(fluid, number, MOST, &count, x, p));
  assert_true(count <= MOST);
  reading(r, (double)count);
  for (int64_t k = 0; k < count; k++)
    reading(r, x[3 * k]), reading(r, x[3 * k + 1]), reading(r, p[k]);
  for (int k = 0; k < 60; k++)
    for (int e = 0; e < 3; e++)
      x[3 * k + e] =
          point[e] + (e == (point[2] > 0.0) ? k * half : 0.0) - (e == 2 ? point[2] : 0.0);
  OK(mps_fluid_get_pressure(fluid, number, 60, x, p));
  for (int k = 0; k < 60; k++) reading(r, p[k]);
}

/* `right`: x of the right wall, which is boundary 2; NAN: there is none. `contact`: with a body, or
 * NULL. */
static inline void read_all(mps_fluid *fluid, double right, const mps_contact *contact,
                            readings *r) {
  const double points[3][3] = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {right, 0.0, 1.0}};
  double station[60], level[60];
  mps_reaction force;
  mps_totals totals;
  mps_fluid_report report;
  memset(r, 0, sizeof *r);
  for (int k = 0; k < 60; k++) station[k] = 0.0237 * k;
  OK(mps_fluid_get_levels(fluid, 60, station, level));
  for (int k = 0; k < 60; k++) reading(r, level[k]);
  for (int32_t b = 0; b < 3; b++) {
    OK(mps_fluid_get_reaction(fluid, b, &force));
    read_reaction(r, &force);
    if (b < 2 || !isnan(right)) read_wall(fluid, b, points[b], r);
  }
  if (contact) {
    OK(mps_contact_get_reaction(contact, -1, &force));
    read_reaction(r, &force);
  }
  OK(mps_fluid_get_totals(fluid, &totals));
  const double sums[] = {totals.kinetic, totals.strain,     totals.work_boundaries,
                         totals.mass,    totals.work_loads, totals.dissipated};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++) reading(r, sums[k]);
  OK(mps_fluid_get_report(fluid, &report));
  report.bytes = 0;
  const int64_t counts[] = {report.ghosts,         report.pairs,      report.surface,
                            report.apart,          report.iterations, report.all_iterations,
                            report.collisions,     report.limited,    report.pushed,
                            mps_fluid_steps(fluid)};
  for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) reading(r, (double)counts[k]);
  reading(r, mps_fluid_limit(fluid)), reading(r, mps_fluid_dt(fluid)),
      reading(r, mps_fluid_time(fluid));
}

/* The same bits. */
static inline void same_readings(const readings *a, const readings *b) {
  assert_int_equal(a->count, b->count);
  for (int64_t k = 0; k < a->count; k++)
    if (memcmp(&a->value[k], &b->value[k], sizeof *a->value) != 0)
      fail_msg("reading %lld of %lld: %.17g, then %.17g", (long long)k, (long long)a->count,
               a->value[k], b->value[k]);
}

#endif
