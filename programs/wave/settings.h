/* settings.h - the options of mps-wave.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_WAVE_SETTINGS_H
#define EXAMPLES_WAVE_SETTINGS_H

#include "common/column.h"

enum { WAVE_S = 0, WAVE_P = 1 };
enum { BASE_RIGID = 0, BASE_VISCOUS = 1 };
enum { SIDES_ROLLER = 0, SIDES_PERIODIC = 1, SIDES_FREEFIELD = 2 };

typedef struct settings {
  /* ground */
  double spacing, width, height, vs, vp, unit_weight, damping, f1, f2;
  const char *layers_file;
  double slope[3];
  /* input */
  int wave; /* WAVE_... */
  const char *input;
  double frequency, peak_time, amplitude, scale;
  int unit, baseline;
  double step;        /* s, of a record without times; NaN: by the file */
  const char *column; /* of a record; NULL: the only one */
  /* boundaries */
  int base, sides;
  layer half_space; /* members NaN: those of the lowest layer */
  /* method */
  int integrator, rotation, torque, damping_form;
  double dt, courant, duration;
  int64_t receivers, threads;
  int64_t frames;
  double every_checkpoint; /* s; NaN: a tenth of the run */
  const char *checkpoint, *restart, *out;
  /* made from the above */
  bool ricker, sloped, paper;
  layers ground;
} settings;

/* Fills `s` from the command line. Returns -1 to continue, or the exit code. */
int settings_parse(settings *s, int argc, char **argv);
/* Reads the layers file, or makes the one layer that the options describe, and checks it against
 * the height of the model. */
bool settings_ground(app *a, settings *s);
/* Makes the input motion. */
bool settings_signal(app *a, const settings *s, mps_signal **out);
/* Definition of the solver; `width` (m) of the lattice is the period of periodic sides. */
mps_dynamics_def settings_dynamics(const settings *s, double width);
char settings_wave(const settings *s); /* 'S' or 'P' */

#endif
