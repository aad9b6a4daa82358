/* tank.h - what the parts of mps-tank share: the settings, the model, the records of a run.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_TANK_H
#define EXAMPLES_TANK_H

#include "common/output.h"

#include <mps/fluid.h>
#include <mps/io.h>

#define TANK_PI 3.14159265358979323846
#define TANK_G 9.81         /* m/s2 */
#define TANK_DENSITY 1000.0 /* kg/m3 */

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
/* Wave number (1/m) of the period (s) in water of the depth (m): (2 pi/T)^2 = g k tanh(k d). */
double tank_wave_number(double period, double depth);
/* Wave height over stroke of a piston (Havelock): 2 (cosh 2kd - 1)/(sinh 2kd + 2kd). */
double tank_havelock(double k, double depth);
/* Sainflou's force (N/m) on a vertical wall under the crest (sign 1) or trough (-1) of a standing
 * wave whose incident height is H. */
double tank_sainflou(double k, double depth, double H, int sign);
/* Period (s) of the first mode of a closed tank. */
double tank_sloshing_period(double length, double depth);
/* Semi-axes (m) and pressure in the middle (Pa) of the drop of radius R at time t. */
void tank_drop(double radius, double t, double *a, double *b, double *centre);

/* results.c: tables, summary, pictures, the last lines on stdout. */
bool tank_write(app *a, tank_model *m);

#endif
