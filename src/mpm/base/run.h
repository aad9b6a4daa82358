/* run.h - progress of the run: time, steps, and state between steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_RUN_H
#define MPSI_MPM_RUN_H

#include "parts.h"
#include "core/context/guard.h"

#include <mps/mpm.h>

#define MPSI_MPM_LEAST_DT 1e-18 /* s */

typedef struct mpsi_run {
  double time;  /* s */
  double dt;    /* s, of the step being made */
  double speed; /* largest c + |v| of the particles, m/s */
  int64_t steps;
  mpsi_guard guard; /* in a callback of the caller, where only queries are allowed */
  bool stale;       /* particles must be sorted before the next step */
  bool edited;      /* the caller has written fields since the last step */
  bool moments; /* beside bodies the spin of L represents angular momentum (spin.h), as steps leave
                   it; false: the caller has written the velocity gradient */
  bool broken;  /* a step has given values that are not finite */
  bool lost;    /* a particle has left the domain in the last step, which is complete otherwise */
  bool warned_about_dt; /* the log has a warning that dt is above the Courant limit */
} mpsi_run;

/* step_on_ranks.c: one step of dt, in one process (step.c) or on several ranks. On an error nothing
 * has changed, unless a particle has left the domain (run.lost: the step is complete) or has values
 * that are not finite (run.broken). */
mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt);
/* signals.c: evaluates the signals of loads and boundaries, and of bodies (`moves`) at the end of
 * the step of dt. Not collective: `function` continues with the status until all ranks agree on
 * one. */
mps_status mpsi_mpm_evaluate_signals(mps_mpm *mpm, const char *function, double dt, bool moves);
/* signals.c: whether a signal of a load or boundary can refuse, on all ranks alike; not of
 * bodies. */
bool mpsi_mpm_signals_may_refuse(const mpsi_grid *grid, const mpsi_loads *loads,
                                 const mpsi_boundaries *boundaries);
/* access.c: MPS_ERROR_STATE in a callback of the solver; after a step that has failed, or while a
 * field is edited; in any of these cases. */
mps_status mpsi_mpm_between_steps(mps_context *context, const mpsi_run *run, const char *function);
mps_status mpsi_mpm_check_whole(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                                const char *function);
mps_status mpsi_mpm_usable(mps_mpm *mpm, const char *function);
/* ready.c: applies the caller's edits, additions and removals: masses, blocks of the present
 * positions, the Courant limit of the present velocities. */
mps_status mpsi_mpm_apply_edits(mps_mpm *mpm, const char *function);
/* ready.c: mpsi_mpm_apply_edits, refused in a callback of the solver. */
mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function);
/* ready.c: MPS_ERROR_STATE unless the next step changes the time in double precision. */
mps_status mpsi_mpm_check_advance(mps_mpm *mpm, const char *function);
/* ready.c: likewise for a step outside a run; without particles dt must be given. */
mps_status mpsi_mpm_check_bounded(mps_mpm *mpm, const char *function);
/* ready.c: sorts the particles by blocks and rebuilds the lists of blocks. */
mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function);
/* cut.c: before a step, pairs of blocks and bodies, nodes inside bodies, and which blocks are cut
 * and split (contact/pairs.h). `status`: of the step so far on this rank; collective where there
 * are bodies. */
mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function, mps_status status);
/* ready.c: the largest c + |v| of each block of cells, and its first bad particle. */
void mpsi_mpm_find_speeds(mps_mpm *mpm);
/* block_results.c: results of all blocks: the largest speed, or the error of a bad particle. */
mps_status mpsi_mpm_collect_block_results(mps_mpm *mpm, const char *function);

#endif
