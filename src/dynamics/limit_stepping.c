/* limit_stepping.c - the stability limit by bisection over whole runs, Yoshida 3.3.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dynamics_private.h"

#define WIDENINGS 40 /* tries to move a first bound outwards */

static const mps_bisection_def bisection_defaults = {
    .struct_size = sizeof(mps_bisection_def), .criterion = 1e15, .accuracy = 1.2, .duration = 2.5};

mps_status mps_bisection_def_init(mps_bisection_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_bisection_def, def, size, &bisection_defaults);
}

static mps_status check(mps_context *context, const mps_bisection_def *def) {
  static const char *const function = "mps_dynamics_limit_stepping";
  if (!isfinite(def->criterion) || def->criterion <= 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "criterion is %g m/s2, must be finite and > 0", def->criterion);
  if (!(def->accuracy > 1.0) || def->accuracy > 100.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "accuracy is %g, must be a ratio in (1, 100]", def->accuracy);
  if (!isfinite(def->duration) || def->duration <= 0.0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "duration is %g s, must be finite and > 0", def->duration);
  if (def->lower < 0.0 || def->upper < 0.0 || !isfinite(def->lower) || !isfinite(def->upper) ||
      (def->lower > 0.0 && def->upper > 0.0 && def->lower >= def->upper))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "lower is %g s and upper %g s: must be 0 (chosen by the library) or positive "
                     "with lower < upper",
                     def->lower, def->upper);
  return MPS_OK;
}

/* A run in progress of the search. */
typedef struct search {
  mps_dynamics *dynamics;
  const mps_bisection_def *def;
  mps_bisection *result;
} search;

/* Runs from the initial state with `dt`; `stable` tells whether no acceleration passed the
 * criterion. */
static mps_status try_dt(search *s, double dt, bool *stable) {
  static const char *const function = "mps_dynamics_limit_stepping";
  mps_dynamics *dynamics = s->dynamics;
  dynamics->dt = dt;
  mpsi_dynamics_rewind(dynamics);
  const double steps = ceil(s->def->duration / dt - 1e-9);
  if (steps > 1e10)
    return mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                     "a run of %g s with dt = %g s takes %g steps: too many", s->def->duration, dt,
                     steps);
  const int64_t total = (int64_t)steps, part = total / 20 + 1;
  s->result->runs++;
  mps_status status = MPS_OK;
  for (int64_t done = 0; status == MPS_OK && done < total; done += part) {
    status =
        mpsi_dynamics_advance(dynamics, function, part < total - done ? part : total - done, false);
    if (status == MPS_OK && mpsi_cancelled(dynamics->context))
      return mpsi_fail(dynamics->context, function, MPS_ERROR_CANCELLED,
                       "stopped by the cancel hook in run %lld", (long long)s->result->runs);
  }
  s->result->steps += dynamics->steps;
  *stable = status == MPS_OK;
  if (status != MPS_OK) mps_context_clear_error(dynamics->context); /* a divergence is an answer */
  mpsi_progress(dynamics->context, "bisection", s->result->runs, (double)s->result->runs, 0.0);
  return MPS_OK;
}

/* Finds one stable and one unstable time step, starting from `lower` and `upper`. */
static mps_status bracket(search *s, double lower, double upper) {
  bool stable = false;
  mps_status status = try_dt(s, lower, &stable);
  for (int k = 0; status == MPS_OK && !stable && k < WIDENINGS; k++) {
    upper = lower;
    lower /= 2.0;
    status = try_dt(s, lower, &stable);
  }
  if (status != MPS_OK) return status;
  if (!stable)
    return mpsi_fail(s->dynamics->context, "mps_dynamics_limit_stepping", MPS_ERROR_NUMERIC,
                     "even dt = %g s passes the criterion %g m/s2: is the response itself larger?",
                     lower, s->def->criterion);
  s->result->stable = lower;
  status = try_dt(s, upper, &stable);
  /* beyond the duration a run is one step, which shows nothing */
  for (int k = 0; status == MPS_OK && stable && upper < s->def->duration && k < WIDENINGS; k++) {
    s->result->stable = upper;
    upper *= 2.0;
    status = try_dt(s, upper, &stable);
  }
  if (status == MPS_OK && stable)
    return mpsi_fail(s->dynamics->context, "mps_dynamics_limit_stepping", MPS_ERROR_NUMERIC,
                     "even dt = %g s stays below the criterion within %g s: no limit was found",
                     upper, s->def->duration);
  s->result->unstable = upper;
  return status;
}

/* Steps 2 to 4 of the paper's algorithm: the geometric mean replaces one of the bounds. */
static mps_status bisect(search *s, double lower, double upper) {
  mps_status status = bracket(s, lower, upper);
  while (status == MPS_OK && s->result->unstable > s->def->accuracy * s->result->stable) {
    const double middle = sqrt(s->result->stable * s->result->unstable);
    bool stable = false;
    if (!(middle > s->result->stable && middle < s->result->unstable)) break; /* neighbours */
    status = try_dt(s, middle, &stable);
    if (stable)
      s->result->stable = middle;
    else
      s->result->unstable = middle;
  }
  return status;
}

mps_status mps_dynamics_limit_stepping(mps_dynamics *dynamics, const mps_bisection_def *user_def,
                                       mps_bisection *out) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_context *context = dynamics->context;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  mps_bisection_def def = bisection_defaults;
  mps_status status = MPS_OK;
  if (user_def) status = MPSI_DEF_READ(context, __func__, mps_bisection_def, user_def, &def);
  if (status == MPS_OK) status = check(context, &def);
  double lower = def.lower, upper = def.upper;
  if (status == MPS_OK && (lower == 0.0 || upper == 0.0)) {
    mps_linear_limit limit;
    status = mps_dynamics_limit_linear(dynamics, def.duration, &limit);
    const double guess =
        status == MPS_OK && limit.dt > 0.0 && isfinite(limit.dt) ? limit.dt : def.duration / 1000.0;
    if (lower == 0.0) lower = fmin(0.98 * guess, upper > 0.0 ? 0.5 * upper : INFINITY);
    if (upper == 0.0) upper = fmax(1.2 * guess, 2.0 * def.lower);
  }
  if (status != MPS_OK) return status;
  const double dt = dynamics->dt, divergence = dynamics->def.divergence;
  mps_bisection result = {0};
  search s = {.dynamics = dynamics, .def = &def, .result = &result};
  dynamics->def.divergence = def.criterion;
  status = bisect(&s, lower, upper);
  dynamics->def.divergence = divergence;
  dynamics->dt = dt;
  mpsi_dynamics_rewind(dynamics);
  if (status == MPS_OK) *out = result;
  return status;
}
