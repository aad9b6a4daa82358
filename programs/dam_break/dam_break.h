/* dam_break.h - common declarations of mps-dam-break: settings, records, and the water by moving
 * particles (mps_fluid) in place of the grid.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "common/mpm_course.h"
#include "common/mpm_method.h"

#include <mps/fluid.h>

#include <math.h>

#define PI 3.14159265358979323846
#define G 9.81         /* m/s2 */
#define DENSITY 1000.0 /* kg/m3 */

enum { SAMPLES = 300, FRAMES = 6, SLIP = 0, NO_SLIP, METHOD_MPM = 0, METHOD_MPS };

typedef struct settings {
  double courant;
  double h, base, viscosity, sound, duration, tank, disturb, tolerance;
  double roughness; /* friction factor of the bed */
  int64_t n2, ppc, threads;
  int method, state, tension, spline, volumetric, bed, solver;
  mpm_method variant;
  bool paper;
  bool rest, impact;
  mpm_course_options course;
  const char *out;
} settings;

typedef struct simulation {
  settings s;
  mpm_model m;
  int rows;
  double t[SAMPLES + 1], Z[SAMPLES + 1], H[SAMPLES + 1]; /* s, -, - */
  mpm_heap heap[SAMPLES + 1];
  mpm_snapshot shot[FRAMES];
  double *gauge_t, *gauge_p; /* s, Pa: of --impact, after each step */
  int64_t gauges, gauge_room;
  mpm_course course;
} simulation;

static inline double column_height(const settings *s) {
  return s->impact ? 0.5 * s->base : s->base * (double)s->n2;
}
/* run.c: parts of a run, for mpm_model_run; dam_march leaves a checkpoint at Ctrl-C. */
mps_status dam_build(mps_context *context, void *user);
mps_status dam_march(void *user);
/* mps-dam-break.c: the water on the grid. */
mps_status dam_mpm_build(mps_context *context, simulation *sim);
/* mps.c: the water by moving particles; dam_mps_advance steps until the time t (s) is reached. */
mps_status dam_mps_build(mps_context *context, simulation *sim);
mps_status dam_mps_advance(simulation *sim, double t);
/* Makes room for more values of the gauge; false when out of memory. */
bool dam_grow_gauge(simulation *sim);
/* How often the guards of the moving particles acted, to a summary. */
bool dam_guards_write(app *a, const simulation *sim, output *f);
/* Results of --impact: pressure.csv, summary.json, pictures but the water's. */
bool dam_impact_write(app *a, simulation *sim);
