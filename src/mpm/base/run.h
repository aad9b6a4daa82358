/* run.h - where the run is, and how the work of a step is shared out.
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
  mpsi_guard guard;     /* in a callback of the caller's: only questions are allowed */
  bool stale;           /* particles must be sorted before the next step */
  bool edited;          /* the caller has written fields since the last step */
  bool moments;         /* beside bodies the spin of L is that of a moment (spin.h), as steps leave
                           it; false: the caller has written the slope */
  bool broken;          /* a step has given values that are no numbers */
  bool lost;            /* a particle has left the domain in the last step, which is whole */
  bool warned_about_dt; /* the log knows that dt is above the Courant limit */
} mpsi_run;

/* step_on_ranks.c: one step of dt, in one process (step.c) or on several ranks. On an error nothing
 * has moved, but where a particle has left the domain (run.lost: the step is whole) or got values
 * that are no numbers (run.broken). */
mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt);
/* signals.c: of loads and boundaries, and of bodies where they `move` at the end of the step of dt.
 * Not collective: `function` continues with the status where all ranks agree on one. */
mps_status mpsi_mpm_evaluate_signals(mps_mpm *mpm, const char *function, double dt, bool moves);
/* signals.c: whether one of a load or boundary may, which all ranks know alike; not of bodies. */
bool mpsi_mpm_signals_may_refuse(const mpsi_grid *grid, const mpsi_loads *loads,
                                 const mpsi_boundaries *boundaries);
/* access.c: MPS_ERROR_STATE in a callback of the solver; or after a step that has failed or while a
 * field is edited; or any of these. */
mps_status mpsi_mpm_between_steps(mps_context *context, const mpsi_run *run, const char *function);
mps_status mpsi_mpm_check_whole(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                                const char *function);
mps_status mpsi_mpm_usable(mps_mpm *mpm, const char *function);
/* ready.c: what the caller has written, added or removed is taken up: masses, blocks of the present
 * positions, the Courant limit of the present velocities. */
mps_status mpsi_mpm_apply_edits(mps_mpm *mpm, const char *function);
/* ready.c: that, but not in a callback of the solver. */
mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function);
/* ready.c: the next step must change the time, in double precision. */
mps_status mpsi_mpm_check_advance(mps_mpm *mpm, const char *function);
/* ready.c: so must one that is not a run's, and where it follows the limit have particles. */
mps_status mpsi_mpm_check_bounded(mps_mpm *mpm, const char *function);
/* block_results.c: what the blocks have found: the largest speed, or the error of a bad
 * particle. */
mps_status mpsi_mpm_collect_block_results(mps_mpm *mpm, const char *function);

#endif
