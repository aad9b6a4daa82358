/* tank.h - what the parts of mps-tank share: the settings, the model, the records of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_TANK_H
#define EXAMPLES_TANK_H

#include "common/output.h"
#include "common/waves.h"

#include <mps/fluid.h>
#include <mps/io.h>

enum { TANK_STILL = 0, TANK_SLOSHING, TANK_PISTON, TANK_DROP };
enum { TANK_GAUGES = 8, TANK_BED = 0, TANK_LEFT = 1, TANK_RIGHT = 2 };

typedef struct tank_settings {
  int kind; /* TANK_... */
  double length, depth, spacing, amplitude, period, ramp, duration, sample, dt, viscosity, disturb;
  double gauge[TANK_GAUGES]; /* m, NaN where there is none */
  double window[2];          /* s: of the harmonics and means */
  int64_t threads, frames;
  const char *out;
} tank_settings;

/* A moment of the run; of a drop only the last three. */
typedef struct tank_sample {
  double t, left, right, level[TANK_GAUGES + 1]; /* s, N, N, m above the water at rest; the last
                                                    gauge stands at the right wall */
  double a, b, centre;                           /* m, m, Pa */
  double kinetic, potential;                     /* J */
} tank_sample;

typedef struct tank_model {
  tank_settings s;
  mps_particles *water;
  waves_piston motion;
  mps_signal *piston;
  mps_fluid *fluid;
  mps_recorder *series;
  tank_sample *sample;
  int64_t samples;
  mps_fluid_report report;
} tank_model;

/* model.c: water, walls, fluid; a run that fills `sample`. */
mps_status tank_build(mps_context *context, tank_model *m);
mps_status tank_run(app *a, tank_model *m);
void tank_free(tank_model *m);

/* theory.c */
/* Semi-axes (m) and pressure in the middle (Pa) of the drop of radius R at time t. */
void tank_drop(double radius, double t, double *a, double *b, double *centre);

/* results.c: tables, summary, pictures, the last lines on stdout. */
bool tank_write(app *a, tank_model *m);

#endif
