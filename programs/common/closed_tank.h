/* closed_tank.h - linear potential flow in a closed tank: water at rest that a piston at x = 0
 * moves, before a wall at the other end that stands or moves on a spring.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "waves.h"

#define CLOSED_TANK_MODES 120

typedef struct closed_tank {
  double length, depth;   /* m */
  double mass, stiffness; /* kg and N/m of the wall; mass NAN: it stands */
  waves_piston piston;
  double t, wall; /* s; displacement of the wall into the water, m */
  /* closed_tank.c */
  double b[CLOSED_TANK_MODES + 1], rate[CLOSED_TANK_MODES + 1];
  double swing[CLOSED_TANK_MODES], push[CLOSED_TANK_MODES], share[CLOSED_TANK_MODES];
  double m_x, m_y, longest; /* kg; s, of a step */
} closed_tank;

/* From the first five members: at rest at t = 0, when the piston may jump to its velocity. */
void closed_tank_begin(closed_tank *c);
/* On to the time t. */
mps_status closed_tank_advance(closed_tank *c, double t);
/* N/m: of the water on the wall, above that of water at rest. */
double closed_tank_force(const closed_tank *c);
/* m: of the surface at x, above the water at rest. */
double closed_tank_level(const closed_tank *c, double x);
