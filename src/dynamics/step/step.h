/* step.h - the step: forces, loads, dashpots, prescribed degrees of freedom, budget.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>

/* Evaluates all signals for the next step, of `length`: an error has changed nothing, and is that
 * of all ranks. */
mps_status mpsi_dynamics_look_ahead(mps_dynamics *dynamics, const char *function, double length);
/* Takes `count` steps of `length`; the last writes accelerations when `output`. On an error of a
 * signal the step is not made. */
mps_status mpsi_dynamics_advance(mps_dynamics *dynamics, const char *function, int64_t count,
                                 double length, bool output);
