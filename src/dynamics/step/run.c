/* run.c - the public functions step, run and refresh; cancel and progress hooks; callbacks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "run.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/limit/dt.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/ground.h"
#include "dynamics/step/step.h"

#include <float.h>
#include <string.h>

#define PROMPT_WORK 5000000 /* particle-steps between calls of the cancel hook: some 0.1 s */

/* Before steps: reads edited material fields and allocates the budget's arrays. */
static mps_status prepare_run(mps_dynamics *dynamics, const char *function) {
  mps_status status = mpsi_particles_ready(dynamics->particles, function);
  if (status == MPS_OK && mpsi_particles_column(dynamics->particles, "external_force", 0) &&
      !mpsi_dynamics_reserve_accounts(dynamics))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  return mpsi_dynamics_reread_ground(dynamics, function, status);
}

/* Before the first step of `length`: reads the edited motion, if the signals of that step succeed.
 */
static mps_status take_motion(mps_dynamics *dynamics, const char *function, double length) {
  if (!dynamics->begins) return MPS_OK;
  const mps_status status = mpsi_dynamics_look_ahead(dynamics, function, length);
  if (status != MPS_OK) return status;
  return mpsi_dynamics_begin(dynamics, function, mps_dynamics_time(dynamics));
}

mps_status mpsi_dynamics_check_diverged(const mps_dynamics *dynamics, const char *function) {
  if (!dynamics->diverged) return MPS_OK; /* on all ranks */
  return mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                   "the run has diverged: mps_dynamics_rollback or mps_dynamics_restore recovers "
                   "it, mps_dynamics_restart begins a new one");
}

mps_status mpsi_dynamics_ready(mps_dynamics *dynamics, const char *function) {
  mps_status status = mpsi_dynamics_enter(dynamics, function);
  if (status != MPS_OK) return status;
  status = mpsi_dynamics_check_diverged(dynamics, function);
  if (status == MPS_OK) status = prepare_run(dynamics, function);
  if (status != MPS_OK) return status;
  return mpsi_dynamics_choose_dt(dynamics, function);
}

/* Steps between calls of the cancel hook. */
static int64_t prompt_steps(const mps_dynamics *dynamics) {
  const int32_t ranks = mps_domain_size(dynamics->domain);
  return PROMPT_WORK / (dynamics->whole / (ranks > 0 ? ranks : 1) + 1) + 1;
}

static mps_status stop(mps_dynamics *dynamics, const char *function) {
  return mpsi_fail(dynamics->context, function, MPS_ERROR_CANCELLED,
                   "stopped by the cancel hook at step %lld, t = %g s", (long long)dynamics->steps,
                   mps_dynamics_time(dynamics));
}

static mps_status cancelled(mps_dynamics *dynamics, const char *function) {
  double asked = mpsi_cancelled(dynamics->context);
  const mps_status status = mpsi_domain_max(dynamics->domain, function, 1, &asked);
  return status == MPS_OK && asked != 0.0 ? stop(dynamics, function) : status;
}

/* Ranks agree on the number of steps and on cancellation. */
static mps_status begin_steps(mps_dynamics *dynamics, const char *function, int64_t count) {
  double all[3] = {(double)count, -(double)count, count > 0 && mpsi_cancelled(dynamics->context)};
  mps_status status = MPS_OK;
  if (count < 0)
    status = mpsi_fail(dynamics->context, function, MPS_ERROR_ARGUMENT,
                       "count is %lld, must be >= 0", (long long)count);
  status = mpsi_domain_agree_max(dynamics->domain, function, status, 3, all);
  if (status == MPS_OK && all[0] != -all[1])
    status = mpsi_domain_agree_same(dynamics->domain, function, status, "count", (double)count);
  return status == MPS_OK && all[2] != 0.0 ? stop(dynamics, function) : status;
}

mps_status mps_dynamics_step(mps_dynamics *dynamics, int64_t count) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_dynamics_ready(dynamics, __func__);
  if (status != MPS_OK) return status;
  const int64_t prompt = prompt_steps(dynamics);
  mpsi_guard_enter(&dynamics->guard, dynamics->context, "mps_dynamics_step");
  status = begin_steps(dynamics, __func__, count);
  if (status == MPS_OK) status = take_motion(dynamics, __func__, dynamics->dt);
  const int64_t before = dynamics->steps;
  for (int64_t done = 0; status == MPS_OK && done < count;) {
    const int64_t n = count - done < prompt ? count - done : prompt;
    if (done > 0) status = cancelled(dynamics, __func__);
    if (status == MPS_OK) status = mpsi_dynamics_advance(dynamics, __func__, n, dynamics->dt, true);
    done += n;
  }
  mpsi_guard_end(&dynamics->guard);
  if (status == MPS_OK || dynamics->steps > before) mpsi_dynamics_publish(dynamics);
  return status;
}

/* Calls the caller's callback and records its error. */
static mps_status ask(mps_dynamics *dynamics, const char *function, mps_dynamics_fn callback,
                      void *user) {
  mpsi_guard_enter(&dynamics->guard, dynamics->context, "the callback of mps_dynamics_run");
  const mps_status own =
      mpsi_guard_leave(&dynamics->guard, dynamics->context, function, callback(user, dynamics));
  const mps_status status = mpsi_domain_agree(dynamics->domain, function, own);
  if (status != MPS_OK) mpsi_fail_where(dynamics->context, dynamics->steps, -1);
  return status;
}

/* Equal steps of at most dt from `start` to `t_end`: their number and length. Where dt, or the
 * length of the last steps, fits to round-off, it is kept bit for bit. */
static double divide(const mps_dynamics *dynamics, double start, double t_end, int64_t *total) {
  const double dt = dynamics->dt, way = t_end - start, exact = way / dt;
  const double round_off = fmax(1e-9, 4.0 * DBL_EPSILON * (exact + fabs(t_end) / dt));
  *total = exact > round_off ? (int64_t)ceil(exact - round_off) : 0;
  const double length = *total > 0 ? way / (double)*total : dt;
  const double kept[2] = {dt, dynamics->length};
  for (int k = 0; k < 2; k++)
    if (fabs(kept[k] - length) * (double)*total <= round_off * dt) return kept[k];
  return length;
}

/* A run under way. */
typedef struct run {
  mps_dynamics *dynamics;
  double start, t_end, length;
  int64_t total, every, report;
  mps_dynamics_fn callback;
  void *user;
} run;

static mps_status march(const run *r) {
  static const char *const function = "mps_dynamics_run";
  mps_dynamics *dynamics = r->dynamics;
  const int64_t before = dynamics->steps;
  mps_status status = MPS_OK;
  for (int64_t done = 0; status == MPS_OK && done < r->total;) {
    int64_t n = r->every - done % r->every, m = r->report - done % r->report;
    n = n < m ? n : m;
    if (n > r->total - done) n = r->total - done;
    const bool last = done + n == r->total,
               call = r->callback && (last || !((done + n) % r->every));
    const bool look = last || (done + n) % r->report == 0;
    done += n;
    if (r->callback) status = prepare_run(dynamics, function); /* it may have edited */
    if (status == MPS_OK)
      status = mpsi_dynamics_advance(dynamics, function, n, r->length, call || last);
    if (last && status == MPS_OK) {
      dynamics->base_time = r->t_end; /* to the last bit */
      dynamics->base_step = dynamics->steps;
    }
    if (status == MPS_OK ? call || last : dynamics->steps > before) mpsi_dynamics_publish(dynamics);
    if (status == MPS_OK && call) status = ask(dynamics, function, r->callback, r->user);
    if (look)
      mpsi_progress(dynamics->context, "dynamics", dynamics->steps,
                    mps_dynamics_time(dynamics) - r->start, r->t_end - r->start);
    if (look && status == MPS_OK) {
      status = cancelled(dynamics, function);
      if (status != MPS_OK) mpsi_dynamics_publish(dynamics);
    }
  }
  return status;
}

static mps_status check_run(const run *r, const char *function) {
  mps_context *context = r->dynamics->context;
  if (!isfinite(r->t_end) || r->t_end < r->start)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "t_end is %.17g s, must be finite and not before the present time %.17g s",
                     r->t_end, r->start);
  if (r->every < 1)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "every is %lld, must be >= 1",
                     (long long)r->every);
  if ((r->t_end - r->start) / r->dynamics->dt > 1e15)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "t_end is %g s, %g steps of dt = %g s from now: must be at most 1e15",
                     r->t_end, (r->t_end - r->start) / r->dynamics->dt, r->dynamics->dt);
  return MPS_OK;
}

mps_status mps_dynamics_run(mps_dynamics *dynamics, double t_end, int64_t every,
                            mps_dynamics_fn callback, void *user) {
  if (!dynamics) return MPS_ERROR_ARGUMENT;
  mps_context *context = dynamics->context;
  mps_status status = mpsi_dynamics_ready(dynamics, __func__);
  if (status != MPS_OK) return status;
  run r = {.dynamics = dynamics,
           .start = mps_dynamics_time(dynamics),
           .t_end = t_end,
           .every = every,
           .callback = callback,
           .user = user};
  status = check_run(&r, __func__);
  status = mpsi_domain_agree_same(dynamics->domain, __func__, status, "t_end", t_end);
  if (status == MPS_OK)
    status = mpsi_domain_agree_same(dynamics->domain, __func__, status, "every", (double)every);
  if (status == MPS_OK)
    status = mpsi_domain_agree_same(dynamics->domain, __func__, status, "having a callback",
                                    callback != NULL);
  if (status != MPS_OK) return status;
  r.length = divide(dynamics, r.start, t_end, &r.total);
  r.report = r.total / 100 > 0 ? r.total / 100 : 1;
  if (r.report > prompt_steps(dynamics)) r.report = prompt_steps(dynamics);
  mpsi_guard_enter(&dynamics->guard, context, "mps_dynamics_run");
  status = take_motion(dynamics, __func__, r.length);
  if (status == MPS_OK && r.total == 0) {
    dynamics->base_time = t_end;
    dynamics->base_step = dynamics->steps;
  }
  if (status == MPS_OK && callback) status = ask(dynamics, __func__, callback, user);
  if (status == MPS_OK) status = march(&r);
  mpsi_guard_end(&dynamics->guard);
  return status;
}
