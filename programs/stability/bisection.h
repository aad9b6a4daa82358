/* bisection.h - the stability limit of the time step by whole runs, Yoshida 3.3.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <mps/experimental/domain.h>
#include <mps/dynamics.h>

#include <math.h>
#include <stdbool.h>

typedef struct bisection_def {
  double accuracy;     /* ratio of the bounds at which to stop, > 1 */
  double duration;     /* s of each run, > 0 */
  double lower, upper; /* s: first bounds, lower < upper; NaN: from the linear limit. They are tried
                          and moved apart until one is stable and the other not */
  mps_domain *domain;  /* of the solver; NULL: one process */
  mps_context_progress_fn hook; /* called at each run, may be NULL */
  void *user;
} bisection_def;

static inline bisection_def bisection_defaults(void) {
  return (bisection_def){.accuracy = 1.2, .duration = 2.5, .lower = NAN, .upper = NAN};
}

typedef struct bisection {
  double stable, unstable; /* s: the final bounds, unstable / stable <= accuracy */
  int64_t runs, steps;     /* what it took */
} bisection;

/* Runs `dynamics`, which has taken no step, from its initial state with the geometric mean of the
 * bounds until their ratio is below the accuracy. A run is unstable when an acceleration exceeds
 * the solver's `divergence`. In the end the solver is in its initial state, with the last dt tried.
 * MPS_ERROR_NUMERIC: no limit was found, `why` says why; other errors are in the context. */
mps_status bisection_find(mps_dynamics *dynamics, const bisection_def *def, bisection *out,
                          char why[160]);
