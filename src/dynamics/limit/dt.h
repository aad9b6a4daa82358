/* dt.h - the length of the time step.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

/* Chooses dt where the definition does not give it, and warns of one above the limit. */
mps_status mpsi_dynamics_choose_dt(mps_dynamics *dynamics, const char *function);

double mpsi_dynamics_limit(const void *dynamics); /* limit.c */
double mpsi_dynamics_dt(void *dynamics, const char *function);
mps_status mpsi_dynamics_check_dt(void *dynamics, const char *function, double dt);
mps_status mpsi_dynamics_use_dt(void *dynamics, const char *function, double dt);
