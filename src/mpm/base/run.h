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
  double flow;  /* m/s, whose Courant limit is that of the flow of pore water; 0: none */
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

/* signals.c: whether a signal of a load or boundary can refuse, on all ranks alike; not of
 * bodies. */
bool mpsi_mpm_signals_may_refuse(const mpsi_grid *grid, const mpsi_loads *loads,
                                 const mpsi_boundaries *boundaries);
/* access.c: MPS_ERROR_STATE in a callback of the solver; after a step that has failed, or while a
 * field is edited. */
mps_status mpsi_mpm_between_steps(mps_context *context, const mpsi_run *run, const char *function);
mps_status mpsi_mpm_check_whole(mps_context *context, const mpsi_columns *p, const mpsi_run *run,
                                const char *function);

#endif
