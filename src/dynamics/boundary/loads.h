/* loads.h - loads: definitions, and the forces of a step.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "dynamics/base/selection.h"
#include "dynamics/step/kernels.h"
#include "solver/conditions.h"

#include <mps/dynamics.h>

#include <stdbool.h>

typedef struct mpsi_dynamics_load {
  mpsi_dynamics_part part;
  int32_t kind;
  double amount[2]; /* traction: N a particle; body: m/s2 */
  double now[2];    /* factor times signal at the start of the step under way */
} mpsi_dynamics_load;

/* Columns for the sum of all loads and gravity, at the first of them. */
mps_status mpsi_dynamics_reserve_forces(mps_dynamics *dynamics, const char *function);
mps_status mpsi_dynamics_evaluate_loads(mps_dynamics *dynamics, const char *function, double now);

/* Forces (N) on the particles in the coming step, component 0 or 1: a sum of up to two columns. */
typedef struct mpsi_dynamics_forces {
  const double *load[2], *external[2]; /* NULL: none */
  bool any;
} mpsi_dynamics_forces;

mpsi_dynamics_forces mpsi_dynamics_find_forces(mps_dynamics *dynamics);
/* Adds the contribution of loads to the step that block b has just taken. */
void mpsi_dynamics_apply_forces(mps_dynamics *dynamics, const mpsi_dynamics_forces *forces,
                                int64_t b, const mpsi_dynamics_step *step);
void mpsi_dynamics_free_loads(mps_dynamics *dynamics);

extern const mpsi_condition_kind mpsi_dynamics_loads;
