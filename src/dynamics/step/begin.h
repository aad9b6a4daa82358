/* begin.h - the initial state, and what the fields show of the present one.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

/* Begins a new history from displacement, rotation, velocity and spin. */
mps_status mpsi_dynamics_begin(mps_dynamics *dynamics, const char *function, double time);

#define MPSI_DYNAMICS_FASTEST                                                                      \
  1e100 /* m/s, also of the spin times the spacing: of no greater speed                            \
           is the kinetic energy a number */

/* Brings position, velocity, spin and reaction up to date. */
void mpsi_dynamics_publish(mps_dynamics *dynamics);
