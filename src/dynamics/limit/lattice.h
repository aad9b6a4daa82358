/* lattice.h - the stability limit on the infinite lattice.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

/* Square of the highest eigenfrequency (rad/s)^2 of the infinite square lattice; `torque` as above;
 * `kernel` NULL: re/r - 1. */
double mpsi_dynamics_lattice_omega2(const mps_kernel *kernel, double spacing, double radius_ratio,
                                    double vs, double vp, double torque);
/* Largest stable dt of Verlet and leapfrog for a mode of frequency^2 omega2 (rad/s)^2. */
double mpsi_dynamics_damped_limit(double omega2, double alpha, double beta);

/* Bound of the limit (s) from the infinite lattice of the stiffest and lightest material in the
 * set. */
double mpsi_dynamics_lattice_bound(const mps_dynamics *dynamics);
