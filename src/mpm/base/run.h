/* run.h - progress of the run: time, steps, and state between steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "parts.h"
#include "core/context/guard.h"

#include <mps/mpm.h>

#define MPSI_MPM_LEAST_DT 1e-18 /* s */

/* What reading the caller's edits changes, and an error restores. */
typedef struct mpsi_edit_state {
  double speed, flow, wave;
  bool edited;
} mpsi_edit_state;

typedef struct mpsi_run {
  double time;  /* s */
  double dt;    /* s, of the step being made, or of the last one */
  double speed; /* largest c + |v| of the particles, m/s */
  double flow;  /* m/s, whose Courant limit is that of the flow of pore water; 0: none */
  double wave;  /* m/s, largest c without water that flows; 0: there is none, or it is implicit */
  int64_t steps;
  mpsi_guard *guard; /* the solver's */
  bool stale;        /* particles must be sorted before the next step */
  bool edited;       /* the caller has written fields since the last step */
  bool changed;      /* the caller has changed something since the last step, */
  bool renewed;      /* which changes the energy of the particles (step/bound.c) */
  bool moments; /* beside bodies the spin of L represents angular momentum (spin.h), as steps leave
                   it; false: the caller has written the velocity gradient */
  /* Before the steps under way, and before a state was kept, which read the edits. */
  mpsi_edit_state as_edited, as_kept;
  bool begun;     /* a step has been made, or a state restored */
  bool unchecked; /* a law or body was given before that which the particles' present state does not
                     allow: the first step checks it again, a restored state needs no check */
  bool broken;    /* a step has given values that are not finite */
  bool lost;      /* a particle has left the domain in the last step, which is complete otherwise */
  bool warned_about_dt;     /* the log has a warning that dt is above the Courant limit */
  bool warned_about_volume; /* and one of a particle that has grown too far */
  int64_t steady_since;     /* step since which the first particle's body acceleration is */
  double steady[3];         /* this (m/s2); steady_since -1: the log has a warning of it */
} mpsi_run;

/* s: time in which a wave, and the particles that carry it, cross a cell. Of ground whose water
 * flows it is that of its skeleton: the limit of the flow would depend on `courant`. */
static inline double mpsi_wave_time(const mpsi_run *run, double cell) {
  return cell / (run->wave > 0.0 ? run->wave : run->speed);
}

/* signals.c: whether a signal of a load, boundary or contact can refuse, on all ranks alike; not of
 * bodies. */
bool mpsi_mpm_signals_may_refuse(const mpsi_grid *grid, const mpsi_loads *loads,
                                 const mpsi_boundaries *boundaries, const mpsi_contacts *contacts);
/* access.c: MPS_ERROR_STATE in a callback of the solver; after a step that has failed, or while a
 * field is edited. The first is asked by what changes the solver, and notes that. */
mps_status mpsi_mpm_between_steps(mps_context *context, mpsi_run *run, const char *function);
mps_status mpsi_mpm_check_whole(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                                const char *function);
