/* boundary.h - boundaries: definitions, lists of prescribed degrees of freedom and dashpots,
 * reactions. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/exact.h"
#include "dynamics/base/selection.h"
#include "solver/conditions.h"

#include <mps/dynamics.h>

#include <stdbool.h>

typedef struct mpsi_dynamics_boundary {
  const mps_dynamics_boundary_def *def;
  mpsi_dynamics_part part;
  int32_t kind;
  uint32_t dofs; /* held or driven */
  /* At the end of the step under way, driven: factor times displacement and velocity of the signal;
   * at its start: factor times acceleration; viscous: factor times velocity. 0 without signal. */
  double reach[3], speed[3], gain[3], incoming[3];
  /* Sums: of the last step (N s, N m s), and since it was made, the latter with the work (J). Terms
   * are summed within a block of particles, and blocks exactly, on any number of ranks. */
  mpsi_exact pushed[3], impulse[3]; /* x, y, moment about the origin */
  mpsi_exact work;
  double kick;                     /* s that the last step's forces acted for, 0: no step yet */
  double block_sum[3], block_work; /* of one block, on their way into the sums */
  int64_t block;
} mpsi_dynamics_boundary;

/* A prescribed (held or driven) degree of freedom. */
typedef struct mpsi_dynamics_bound {
  int32_t particle, component; /* 0 x, 1 y, 2 rotation */
  int32_t boundary;
  double rest;   /* its displacement (m, rad) less `reach` of the boundary */
  double at;     /* its displacement before the step, m, rad */
  double before; /* its velocity before the step, m/s, rad/s */
  double force;  /* on the particle in the last step, N, N m */
  double c, s;   /* rotation: its trigonometry (mpsi_dynamics_state) */
} mpsi_dynamics_bound;

/* A dashpot on one component of one particle: acceleration c (target - v). */
typedef struct mpsi_dynamics_dashpot {
  int32_t particle, component;
  int32_t boundary;              /* or -1: between the body and a free-field column */
  int32_t partner;               /* free-field particle whose velocity is the target, or -1 */
  bool idle;                     /* the degree of freedom is prescribed */
  double c;                      /* 1/s */
  double before, partner_before; /* velocities before the step, m/s */
  double force;                  /* on the particle in the last step, N */
} mpsi_dynamics_dashpot;

/* Prescribed degrees of freedom and dashpots of all boundaries. */
typedef struct mpsi_dynamics_lists {
  mpsi_dynamics_bound *bound;
  mpsi_dynamics_dashpot *dashpot;
  int64_t bounds, dashpots;
  int32_t *owner; /* 1 + the boundary that has each degree of freedom, component by component */
} mpsi_dynamics_lists;

/* Lists prescribed degrees of freedom and dashpots, without changes of the state. */
mps_status mpsi_dynamics_list_boundaries(mps_dynamics *dynamics, const char *function);
/* Sets the present state as the initial one of prescribed degrees of freedom. */
mps_status mpsi_dynamics_take_bounds(mps_dynamics *dynamics, const char *function);
void mpsi_dynamics_free_boundaries(mps_dynamics *dynamics);
/* Room for the lists of the present boundaries on a body of `particles` and so many dashpots of
 * free-field columns; then, when nothing can fail any more, the lists themselves. */
mps_status mpsi_dynamics_reserve_lists(mps_dynamics *dynamics, const char *function,
                                       int64_t particles, int64_t column_dashpots,
                                       mpsi_dynamics_lists *out);
void mpsi_dynamics_use_lists(mps_dynamics *dynamics, mpsi_dynamics_lists *out);
void mpsi_dynamics_free_lists(mps_dynamics *dynamics, mpsi_dynamics_lists *lists);
/* Rates of all dashpots, from the fields. */
void mpsi_dynamics_renew_dashpots(mps_dynamics *dynamics);

extern const mpsi_condition_kind mpsi_dynamics_boundaries;
mps_status mpsi_dynamics_get_reaction(void *dynamics, const char *function, mps_status status,
                                      int32_t number, mps_reaction *out);
