/* constrain.h - dashpots and prescribed degrees of freedom around a step.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>

/* Evaluates the signals for a step from `now` to `then`: the only part of a step that can fail. */
mps_status mpsi_dynamics_evaluate_signals(mps_dynamics *dynamics, const char *function, double now,
                                          double then);
/* Status of all ranks, and MPS_ERROR_ARGUMENT where signals of boundaries or loads have given them
 * different values; in the same reduction the greatest of each of `values`, at most
 * MPSI_DOMAIN_ALONG - 2. Collective. */
mps_status mpsi_dynamics_agree_signals(mps_dynamics *dynamics, const char *function,
                                       mps_status status, int32_t count, double *values);
void mpsi_dynamics_dashpots_before(mps_dynamics *dynamics);
/* Begin and end of the sums of the boundaries' forces in a step. */
void mpsi_dynamics_begin_counting(mps_dynamics *dynamics);
void mpsi_dynamics_end_counting(mps_dynamics *dynamics, double kick);
void mpsi_dynamics_dashpots_after(mps_dynamics *dynamics, double kick, bool output);
void mpsi_dynamics_prescribe_bounds(mps_dynamics *dynamics, double kick, bool output);
