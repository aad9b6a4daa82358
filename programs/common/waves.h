/* waves.h - common parts of programs with waves: the water's constants, a piston wave maker, and
 * wave theory; docs/references.md has the sources.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "app.h"

#include <mps/fluid.h>
#include <mps/signal.h>

#define WAVES_PI 3.14159265358979323846
#define WAVES_G 9.81         /* m/s2 */
#define WAVES_DENSITY 1000.0 /* kg/m3 */

/* amplitude sin(2 pi t/period), risen by 3 s^2 - 2 s^3 over the ramp (0: from the first instant).
 */
typedef struct waves_piston {
  double amplitude, period, ramp; /* m, s, s */
} waves_piston;
/* A mps_signal_fn, `user` a waves_piston. */
mps_status waves_move_piston(void *user, double t, double motion[3]);

/* A set of water at rest, whole columns and rows of the spacing from the origin. */
mps_status waves_fill(mps_context *context, double length, double depth, double spacing,
                      mps_particles **out);
/* The next of a row of random numbers in [-1, 1), the same in every run; begin with any state. */
double waves_noise(uint64_t *state);
/* Moves each particle by up to `by` (m) along x and y; every seed is another disturbance. */
mps_status waves_disturb(mps_particles *water, double by, uint64_t seed);
/* A plane wall through (x, y) with the normal (nx, ny) into the water. `signal` may be NULL. */
mps_status waves_add_wall(mps_fluid *fluid, const double *point, double nx, double ny,
                          mps_signal *signal, int32_t *number);

/* Solver of the pressure equation, and its tolerance: rows of a table of options, and what the
 * first requires. False: the reason in `why`. Collective. */
#define WAVES_SOLVER(solver, tolerance)                                                            \
  OPTION_CHOICE("solver", solver, NULL),                                                           \
      OPTION_NUMBER("tolerance", tolerance, NULL, WAVES_TOLERANCE)
#define WAVES_TOLERANCE 1e-5 /* default, as mps_fluid_def */
bool waves_choose_solver(app *a, int choice, mps_fluid *fluid, char *why, size_t size);

/* Wave number (1/m) of the period (s) in water of the depth (m): (2 pi/T)^2 = g k tanh(k d). */
double waves_number(double period, double depth);
/* Wave height over stroke of a piston (Havelock): 2 (cosh 2kd - 1)/(sinh 2kd + 2kd). */
double waves_havelock(double k, double depth);
/* A warning where the waves of a piston are lower than 2 spacings, and one where they are higher
 * than .8 of breaking waves, .142 L tanh(kd) (Miche). False, after an error line, where they are
 * higher than those, or the piston would leave the tank of `length` (m). */
bool waves_check(app *a, double period, double depth, double amplitude, double spacing,
                 double length);
/* A warning where omega dt > .3, omega (rad/s) that of a structure in the water: the coupled motion
 * then has a wrong period and is damped by the scheme. */
void waves_warn_of_step(app *a, double omega, double dt);
/* Sainflou's standing wave at a vertical wall, the incident height H: rise of the mean level (m),
 * amplitude of the pressure at the bed (Pa), and force (N/m) under the crest (sign 1) or the trough
 * (-1). The pressure is linear from the crest to the bed. */
double waves_sainflou_rise(double k, double depth, double H);
double waves_sainflou_bed(double k, double depth, double H);
double waves_sainflou(double k, double depth, double H, int sign);
/* The incident height whose crest stands `level` (m, >= 0) above the water at rest. */
double waves_sainflou_height(double k, double depth, double level);
/* Period (s) of the first mode of a closed tank. */
double waves_sloshing_period(double length, double depth);
