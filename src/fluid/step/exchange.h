/* exchange.h - exchange of momentum between water and walls besides the pressure: see exchange.c.
 * The loops over particles add to their chunk's sums.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

/* Particle i, of this chunk, gets dv (m/s) from the wall. */
void mpsi_fluid_exchange_wall(const mps_fluid *fluid, int64_t chunk, int wall, int64_t i,
                              const double *dv);
/* Velocity (m/s) along a wall of its point nearest to particle i, at the end of the step: that of a
 * body. */
double mpsi_fluid_moves_along(const mps_fluid *fluid, const mpsi_fluid_wall *wall, int64_t i);
/* Particle i gets dv by viscosity, along the wall. */
void mpsi_fluid_exchange_drag(const mps_fluid *fluid, int64_t chunk, int wall, int64_t i,
                              const double *dv);
/* The same by friction, at the particle's foot on a face that moves along itself with `moves`, m/s.
 */
void mpsi_fluid_exchange_friction(const mps_fluid *fluid, int64_t chunk,
                                  const mpsi_fluid_wall *wall, int64_t i, const double *dv,
                                  double moves);
/* Component of dv, from an image, along the normals of the walls at which it is mirrored. */
void mpsi_fluid_exchange_image(const mps_fluid *fluid, int64_t chunk, int64_t ghost, int64_t i,
                               const double *dv);
/* Of an image in a polyline of no slip: the rest of dv, along its segments. */
void mpsi_fluid_exchange_along_line(const mps_fluid *fluid, int64_t chunk, int64_t ghost, int64_t i,
                                    const double *dv);
/* Sum of the changes of velocity, m/s, of particles of a chunk in the step. */
void mpsi_fluid_gain(const mps_fluid *fluid, int64_t chunk, const double *du);
/* The velocity u that an image has to move with at walls of no slip: against its parent's. */
void mpsi_fluid_stick(const mps_fluid *fluid, int64_t ghost, double *u);

/* Memory of a step's sums; their values, on all ranks; finally the momentum error. */
mps_status mpsi_fluid_begin_exchange(mps_fluid *fluid, const char *function);
void mpsi_fluid_end_exchange(mps_fluid *fluid);
void mpsi_fluid_book_momentum(mps_fluid *fluid);
void mpsi_fluid_drop_exchange(mps_fluid *fluid);
