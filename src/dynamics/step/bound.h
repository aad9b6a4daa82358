/* bound.h - what energy allows the body, and the state before a step that may have to be undone.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/dynamics.h>

#include <stdbool.h>
#include <stdint.h>

typedef struct mpsi_dynamics_bound_state {
  mps_snapshot *before; /* the state before step `saved`; NULL until one was saved */
  int64_t saved;        /* number of steps that it had; -1: it is of no use */
  bool bounded;         /* by energy: the caller has given no criterion of divergence */
  bool changed;         /* by the caller since the last step */
  bool alarmed;         /* accelerations of the last step were near their limit, on some rank, */
  bool near;            /* or the energy was near its bound: the next step is saved */
  double works;         /* J, largest sum of works so far */
  double factor;        /* of the energy in the bound */
  double excess;        /* J, kinetic energy of a step beyond the bound, else 0 */
  bool accepts;    /* a dt was given after such a step: the caller continues from what there is */
  double accepted; /* J, energy of that state */
  double most;     /* J, that bound */
} mpsi_dynamics_bound_state;

/* Keeps and restores the state, for a step. */
typedef struct mpsi_dynamics_keeper {
  mps_status (*save)(mps_dynamics *dynamics, const char *function, mps_snapshot **snapshot);
  mps_status (*restore)(mps_dynamics *dynamics, const char *function, const mps_snapshot *snapshot);
} mpsi_dynamics_keeper;

/* How a step ended. */
enum { MPSI_DYNAMICS_CALM = 0, MPSI_DYNAMICS_ALARMED = 1, MPSI_DYNAMICS_DIVERGED = 2 };

/* m/s2: accelerations beyond it are none of a body, where the caller gives no criterion. */
#define MPSI_DYN_DIVERGENCE 1e15
/* Part of the limit of accelerations from which steps are saved. */
#define MPSI_DYNAMICS_ALARM 1e-3

/* Before a step: saves the state, if the step may have to be undone. */
mps_status mpsi_dynamics_save_before(mps_dynamics *dynamics, const char *function);
/* After every so many steps, and after each where the last one was near the bound: `excess`, where
 * the kinetic energy is beyond it and the state before the step was saved. Collective. */
mps_status mpsi_dynamics_find_excess(mps_dynamics *dynamics, const char *function);
/* After the last step has diverged on some rank: restores the state before it, or where that was
 * not saved, leaves the one after it, and the run has diverged. Collective. */
mps_status mpsi_dynamics_undo(mps_dynamics *dynamics, const char *function, mps_status status);
