/* coefficients.h - what the forces need of the ground, particle by particle.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>

/* Extremes over all particles, of all ranks. */
typedef struct mpsi_dynamics_extremes {
  double mu, lambda, lightest; /* most, most (Pa), least density (kg/m3) */
  double alpha[2], beta[2];    /* least and most */
} mpsi_dynamics_extremes;

/* Coefficients of each particle, from its fields; returns whether one has changed. */
bool mpsi_dynamics_set_coefficients(mps_dynamics *dynamics);
void mpsi_dynamics_choose_damping(mps_dynamics *dynamics); /* from the extremes */
