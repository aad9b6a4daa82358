/* cases.c - the critical time step of one soil column, Yoshida 3.3.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "cases.h"

#include "bisection.h"
#include "common/column.h"
#include "regression.h"

#include <mps/experimental/papers.h>
#include <mps/experimental/domain.h>

#include <math.h>
#include <stdio.h>

static const double WIDTH = 10.0, HEIGHT = 100.0;      /* m */
static const double PEAK_TIME = 0.25, FREQUENCY = 4.0; /* s, Hz: the paper's Ricker pulse */

double method_duration(const method *m, double velocity) {
  if (!isnan(m->duration)) return m->duration;
  return 2.0 * PEAK_TIME + 1.1 * HEIGHT / velocity;
}

int64_t case_particles(double radius) {
  return (int64_t)(round(WIDTH / (2.0 * radius)) * round(HEIGHT / (2.0 * radius)));
}

double case_vs(const stability_case *x) {
  if (x->wave == 'S') return x->velocity;
  return x->other > 0.0 ? x->other : 0.5 * x->velocity;
}

double case_vp(const stability_case *x) {
  if (x->wave == 'P') return x->velocity;
  return x->other > 0.0 ? x->other : 2.0 * x->velocity;
}

/* Context and domain that compute a case; the domain NULL: one process. */
typedef struct machine {
  mps_context *context;
  mps_domain *domain;
} machine;

static mps_status build(const machine *with, const method *m, const stability_case *x, column *c,
                        mps_dynamics **dynamics) {
  mps_context *context = with->context;
  layers ground = {.count = 1};
  ground.layer[0] = (layer){.thickness = HEIGHT,
                            .vs = case_vs(x),
                            .vp = case_vp(x),
                            .unit_weight = 14.7e3,
                            .damping = x->damping};
  const column_def def = {.width = WIDTH, .height = HEIGHT, .radius = x->radius, .ground = &ground};
  mps_dynamics_def solver = mps_dynamics_defaults();
  solver.integrator = x->integrator;
  solver.rotation = m->rotation;
  solver.divergence = m->criterion;
  solver.f1 = m->f1;
  solver.f2 = m->f2;
  solver.domain = with->domain;
  mps_signal *pulse = NULL;
  mps_status status = column_create(context, &def, c);
  if (status == MPS_OK)
    status = mps_signal_create_ricker(context, FREQUENCY, PEAK_TIME, 1.0, &pulse);
  if (with->domain) status = mps_domain_agree(with->domain, status);
  if (status == MPS_OK) status = mps_dynamics_create(context, c->particles, &solver, dynamics);
  if (status == MPS_OK && m->torque == 1)
    status = mps_experimental_dynamics_printed_torque(*dynamics);
  if (status == MPS_OK) status = column_hold_sides(c, *dynamics, x->wave);
  if (status == MPS_OK) status = column_drive_base(c, *dynamics, x->wave, pulse);
  mps_signal_destroy(&pulse);
  return status;
}

static mps_status find_linear(const method *m, mps_dynamics *dynamics, stability_case *x) {
  mps_dynamics_linear_limit limit;
  const mps_status status =
      mps_dynamics_find_limit(dynamics, method_duration(m, x->velocity), &limit);
  if (status == MPS_OK) x->linear = limit.dt;
  return status;
}

static mps_status find_stepping(const machine *with, const method *m, mps_dynamics *dynamics,
                                stability_case *x, mps_context_progress_fn hook, void *user) {
  bisection_def def = bisection_defaults();
  bisection found;
  char why[160];
  def.accuracy = m->accuracy;
  def.duration = method_duration(m, x->velocity);
  def.domain = with->domain;
  def.hook = hook;
  def.user = user;
  const mps_status status = bisection_find(dynamics, &def, &found, why);
  if (status != MPS_OK) {
    snprintf(x->why, sizeof x->why, "%s", why);
    return status;
  }
  x->stepping = found.stable;
  x->unstable = found.unstable;
  x->steps = found.steps;
  return MPS_OK;
}

static void find_printed(stability_case *x) {
  const limit_fit printed = limit_fit_printed(x->wave);
  if (x->damping <= 0.2201 && x->damping > 0.0)
    x->table2 = limit_fit_dt(&printed, x->radius, x->velocity, x->damping);
}

static void find(const machine *with, const method *m, stability_case *x,
                 mps_context_progress_fn hook, void *user) {
  mps_dynamics *dynamics = NULL;
  column c = {0};
  x->linear = x->stepping = x->unstable = x->table2 = NAN;
  x->steps = 0;
  x->why[0] = '\0';
  x->particles = case_particles(x->radius);
  x->status = build(with, m, x, &c, &dynamics);
  find_printed(x);
  if (x->status == MPS_OK && m->kind != METHOD_STEPPING) x->status = find_linear(m, dynamics, x);
  if (x->status == MPS_OK && m->kind != METHOD_LINEAR)
    x->status = find_stepping(with, m, dynamics, x, hook, user);
  if (x->status != MPS_OK) {
    char why[160];
    snprintf(why, sizeof why, "%.150s",
             x->why[0] ? x->why : mps_context_error(with->context)->message);
    snprintf(x->why, sizeof x->why, "%c wave, R = %g m, V = %g m/s, h = %g: %s", x->wave, x->radius,
             x->velocity, x->damping, why);
  }
  mps_dynamics_destroy(&dynamics);
  column_destroy(&c);
}

void case_find(const method *m, stability_case *x) {
  mps_context_def def = mps_context_defaults();
  machine alone = {NULL, NULL};
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  def.threads = 1;
  def.cancel = progress_cancel_hook;
  x->status = mps_context_create(&def, &alone.context, x->why, sizeof x->why);
  if (x->status != MPS_OK) return;
  find(&alone, m, x, NULL, NULL);
  mps_context_destroy(&alone.context);
}

void case_find_together(app *a, const method *m, stability_case *x, mps_context_progress_fn hook,
                        void *user) {
  const machine all = {a->context, a->domain};
  find(&all, m, x, hook, user);
}
