/* turn.h - the flow around a corner of a body or a polyline, which no linear field is: see turn.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

typedef struct mpsi_fluid_turn {
  const mpsi_fluid_wall *face; /* or segment, that begins at the corner; NULL: none is near */
  double power;                /* of the distance from the corner, of the potential */
  double own[2];               /* of the field, at the particle */
  double strength;             /* m/s: A, of the field with lengths over l0 */
  double G[4];                 /* of the linear fit to the field, 1/m */
  double rest[2];              /* m/s: what that leaves of it, times A */
} mpsi_fluid_turn;

/* False: no corner is near particle i, or too few particles to know. */
bool mpsi_fluid_fit_turn(const mps_fluid *fluid, int64_t i, mpsi_fluid_turn *turn);
/* Adds to v (m/s) what the field has at neighbour j of particle i beyond a linear one. */
void mpsi_fluid_add_turn(const mps_fluid *fluid, const mpsi_fluid_turn *turn, int64_t i, int64_t j,
                         double *v);
