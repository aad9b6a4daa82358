/* column.h - the paper's soil column (Yoshida, Figure 1): a lattice of particles between two
 * vertical sides on a shaken base, in layers, level or with a slope. x to the right from the left
 * side, y upwards from the base. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "layers.h"

#include <mps/experimental/domain.h>
#include <mps/dynamics.h>

typedef struct column_def {
  double width, height; /* m; rounded to whole particles */
  double radius;        /* R, m: spacing D = 2R, cell centred */
  const layers *ground;
  bool sloped;
  double slope[3];    /* m: the surface falls from `height` at slope[0] to slope[2] at slope[1] */
  bool open;          /* the base is to be that of column_viscous_base: the ground ends at y = 0 */
  mps_domain *domain; /* each of its ranks makes a part of the particles; NULL: all of them */
} column_def;

typedef struct column {
  column_def def;
  mps_context *context; /* borrowed */
  mps_particles *particles;
  double spacing;       /* D, m */
  int64_t nx, ny;       /* particles across and up */
  double width, height; /* of the lattice, m */
} column;

/* Makes the particles with density, velocities and damping of their layers. Collective where there
 * is a domain. */
mps_status column_create(mps_context *context, const column_def *def, column *out);
void column_destroy(column *c);

/* Height (m) of the ground surface at x. */
double column_surface(const column *c, double x);
/* Height (m) of the ground whose motion a particle at height y has: on an open base the lowest row
 * has that of the base. */
double column_level(const column *c, double y);

/* The component of motion of a wave 'S' or 'P': 0 x, 1 y. */
int32_t column_component(char wave);
/* Rollers on both sides: an S wave leaves them free to move in x, a P wave in y. */
mps_status column_hold_sides(const column *c, mps_dynamics *dynamics, char wave);
/* Rigid base: moves as `signal` (E+F) in the direction of the wave and not across it. */
mps_status column_drive_base(const column *c, mps_dynamics *dynamics, char wave,
                             mps_signal *signal);
/* Viscous base under an incoming wave `signal` (E), on a half space of the given layer. */
mps_status column_viscous_base(const column *c, mps_dynamics *dynamics, char wave,
                               mps_signal *signal, const layer *half_space);
