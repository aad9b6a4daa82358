/* kink.h - gradients of q beside a face of rock: see kink.c. SPDX-License-Identifier: BSD-3-Clause
 */
#pragma once

#include "fluid/particles/pores.h"

/* Divergence (1/s) of what the resistance takes of particle i and its neighbours beyond the face.
 */
double mpsi_fluid_jump(const mps_fluid *fluid, int64_t i);
/* grad q (Pa/m) of a particle that has neighbours in another region; false: no face is near. */
bool mpsi_fluid_kinked_gradient(const mps_fluid *fluid, int64_t i, double *gradient);
