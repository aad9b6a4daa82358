/* beam.h - the cantilever as a problem, without particles: dimensions, material, exact solution.
 *
 * x runs from the loaded end (0) to the wall (length), y from the axis upwards. The end carries the
 * parabolic shear of resultant `load`, downwards, a metre of thickness.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef EXAMPLES_BEAM_H
#define EXAMPLES_BEAM_H

#include <stdbool.h>

typedef struct beam {
  double length, height; /* m */
  double young, poisson; /* Pa, - */
  double load;           /* N/m */
  bool plane_strain;
  bool clamped; /* the wall does not move; otherwise it moves as the exact solution */
} beam;

/* Displacements of Chikazawa (11) and of the u that belongs to it: u = v = du/dy = 0 at (length,
 * 0).
 */
void beam_displacement(const beam *b, double x, double y, double *u);
/* Its stresses xx, yy, xy (Pa). */
void beam_stress(const beam *b, double x, double y, double *stress);
/* Traction on the loaded end at height y (Pa). */
void beam_traction(const beam *b, double y, double *traction);
/* Displacement that is prescribed at the wall. */
void beam_wall(const beam *b, double y, double *u);
/* Lame's constants of the plane state. */
void beam_lame(const beam *b, double *lambda, double *mu);

#endif
