/* change.h - a new structure for other particles: after a removal, or of a state to restore.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "dynamics/boundary/boundary.h"
#include "dynamics/pairs/structure.h"

#include <mps/dynamics.h>

/* New structure for other particles, made beside the present one, which it then replaces. */
typedef struct mpsi_dynamics_change {
  int32_t *now; /* of a removal: new index of each particle, -1: removed; else NULL */
  mpsi_dynamics_structure structure;
  mpsi_dynamics_lists lists;     /* room */
  double *force, *before, *drag; /* each NULL where the solver has none */
  double energy;                 /* of a removal: J, before */
} mpsi_dynamics_change;

/* Makes dynamics->change for sorted particles. */
mps_status mpsi_dynamics_prepare_change(mps_dynamics *dynamics, const char *function,
                                        const mpsi_dynamics_geometry *geometry);
/* Replaces the present structure, once the set has those particles: cannot fail. */
void mpsi_dynamics_use_change(mps_dynamics *dynamics);
void mpsi_dynamics_drop_change(mps_dynamics *dynamics);
/* state.c: for steps that are undone (step/bound.h). */
extern const struct mpsi_dynamics_keeper mpsi_dynamics_keep;
/* Structure of a former state (core/state.h). */
mps_status mpsi_dynamics_prepare_state(void *solver, const char *function, const mps_snapshot *from,
                                       const char *source, mps_status disagreement);
