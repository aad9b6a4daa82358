/* smooth.h - smoothing of rough velocities between pairs of particles, see smooth.c.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "fluid/base/flow_solver.h"

/* How steep the flow at particle i is, 1 where it is as in breakers. */
double mpsi_fluid_steepness(const mps_fluid *f, int64_t i);
/* Share of smoothing and shift at particle i: `least` near the surface in gentle waves. */
double mpsi_fluid_near_surface(const mps_fluid *f, int64_t i, double least);
/* The step's rates and gradients of all particles and images, f->flux. */
void mpsi_fluid_prepare_smoothing(mps_fluid *f);
/* du: change of particle i's velocity (m/s) by smoothing and viscosity; what walls exchange with it
 * goes to the sums of its chunk. */
void mpsi_fluid_smooth(const mps_fluid *f, int64_t chunk, int64_t i, double *du);
