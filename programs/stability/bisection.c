/* bisection.c - the stability limit of the time step by bisection over whole runs, Yoshida 3.3.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "bisection.h"

#include <stdio.h>

#define WIDENINGS 40 /* tries to move a first bound outwards */

typedef struct search {
  mps_dynamics *dynamics;
  const bisection_def *def;
  bisection *result;
  double start;           /* s */
  mps_particles *initial; /* the set as it was */
  char *why;
} search;

/* ---- the initial state ----------------------------------------------------------------------- */

/* Work of a single rank fails on all where it fails on one. */
static mps_status agree(const search *s, mps_status status) {
  return s->def->domain ? mps_domain_agree(s->def->domain, status) : status;
}

/* Particles of dynamics keep their order. */
static mps_status put_state(const search *s) {
  static const char *const names[] = {"displacement", "rotation", "velocity", "spin"};
  mps_particles *set = mps_dynamics_particles(s->dynamics);
  mps_status status = MPS_OK;
  for (int f = 0; f < 4 && status == MPS_OK; f++) {
    mps_view kept;
    status = mps_particles_view(s->initial, names[f], &kept);
    for (int32_t c = 0; status == MPS_OK && c < (int32_t)kept.shape[1]; c++)
      status = mps_particles_set_array(set, names[f], c, mps_view_f64(&kept, 0, c), kept.shape[0]);
  }
  return status;
}

static mps_status go_back(const search *s) {
  const mps_status status = agree(s, put_state(s));
  return status == MPS_OK ? mps_dynamics_restart(s->dynamics, s->start) : status;
}

/* ---- the search ------------------------------------------------------------------------------ */

/* Runs from the initial state with `dt`; `stable`: no acceleration passed the criterion. */
static mps_status try_dt(search *s, double dt, bool *stable) {
  mps_context *context = mps_dynamics_context(s->dynamics);
  mps_status status = go_back(s);
  if (status == MPS_OK) status = mps_dynamics_set_dt(s->dynamics, dt);
  if (status != MPS_OK) return status;
  const double steps = ceil(s->def->duration / dt - 1e-9);
  if (steps > 1e10) {
    snprintf(s->why, 160, "a run of %g s with dt = %g s takes %g steps: too many", s->def->duration,
             dt, steps);
    return MPS_ERROR_NUMERIC;
  }
  s->result->runs++;
  status = mps_dynamics_step(s->dynamics, (int64_t)steps);
  s->result->steps += mps_dynamics_steps(s->dynamics);
  *stable = status == MPS_OK;
  if (status == MPS_ERROR_DIVERGED) { /* that is a result */
    mps_context_clear_error(context);
    status = MPS_OK;
  }
  const mps_context_progress progress = {.task = "bisection",
                                         .step = s->result->runs,
                                         .time = (double)s->result->runs,
                                         .fraction = NAN};
  if (s->def->hook) s->def->hook(s->def->user, &progress);
  return status;
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
  if (!stable) {
    snprintf(s->why, 160, "even dt = %g s passes the criterion: is the response itself larger?",
             lower);
    return MPS_ERROR_NUMERIC;
  }
  s->result->stable = lower;
  status = try_dt(s, upper, &stable);
  /* beyond the duration a run is one step, which shows nothing */
  for (int k = 0; status == MPS_OK && stable && upper < s->def->duration && k < WIDENINGS; k++) {
    s->result->stable = upper;
    upper *= 2.0;
    status = try_dt(s, upper, &stable);
  }
  if (status == MPS_OK && stable) {
    snprintf(s->why, 160,
             "even dt = %g s stays below the criterion within %g s: no limit was found", upper,
             s->def->duration);
    return MPS_ERROR_NUMERIC;
  }
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

/* First bounds where none are given. */
static mps_status choose_bounds(const search *s, double *lower, double *upper) {
  const bisection_def *def = s->def;
  *lower = def->lower, *upper = def->upper;
  if (!isnan(*lower) && !isnan(*upper)) return MPS_OK;
  mps_dynamics_linear_limit limit;
  const mps_status status = mps_dynamics_find_limit(s->dynamics, def->duration, &limit);
  const double guess =
      status == MPS_OK && limit.dt > 0.0 && isfinite(limit.dt) ? limit.dt : def->duration / 1000.0;
  if (isnan(*lower)) *lower = fmin(0.98 * guess, isnan(*upper) ? INFINITY : 0.5 * *upper);
  if (isnan(*upper)) *upper = fmax(1.2 * guess, isnan(def->lower) ? 0.0 : 2.0 * def->lower);
  return status;
}

mps_status bisection_find(mps_dynamics *dynamics, const bisection_def *def, bisection *out,
                          char why[160]) {
  bisection result = {0};
  search s = {.dynamics = dynamics,
              .def = def,
              .result = &result,
              .start = mps_dynamics_time(dynamics),
              .why = why};
  double lower, upper;
  why[0] = '\0';
  mps_status status = agree(&s, mps_particles_copy(mps_dynamics_particles(dynamics), &s.initial));
  if (status != MPS_OK) {
    mps_particles_destroy(&s.initial);
    return status;
  }
  status = choose_bounds(&s, &lower, &upper);
  if (status == MPS_OK) status = bisect(&s, lower, upper);
  const mps_status end = go_back(&s);
  mps_particles_destroy(&s.initial);
  if (status == MPS_OK && end == MPS_OK) *out = result;
  return status == MPS_OK ? end : status;
}
