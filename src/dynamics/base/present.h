/* present.h - the present state as every subfolder reads it: time, velocity, mass.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>

/* MPS_ERROR_STATE when a call of the solver is under way. */
mps_status mpsi_dynamics_enter(mps_dynamics *dynamics, const char *function);
/* Column of a field that the solver has added itself: never NULL. */
double *mpsi_dynamics_column(const mps_dynamics *dynamics, const char *name, int32_t component);
/* Velocity of a degree of freedom (component 0, 1, 2) half a step before the present state (Euler:
 * of it). */
double mpsi_dynamics_velocity(const mps_dynamics *dynamics, int32_t component, int64_t k);
/* Mass (kg) or moment of inertia (kg m2) of a degree of freedom. */
double mpsi_dynamics_mass(const mps_dynamics *dynamics, int32_t component, int64_t k);
/* Body or material have changed: the limit and the dt derived from it are invalid. */
void mpsi_dynamics_forget_limit(mps_dynamics *dynamics);
/* Allocates the arrays of the energy budget, once. False: out of memory. */
bool mpsi_dynamics_reserve_accounts(mps_dynamics *dynamics);
/* Arrays for the dissipation of Rayleigh damping. */
mps_status mpsi_dynamics_reserve_watch(mps_dynamics *dynamics, const char *function);

double mpsi_dynamics_time(const void *dynamics); /* s */
int64_t mpsi_dynamics_steps(const void *dynamics);
