/* run.c - steps, and runs to a time: the one loop of all solvers, with the caller's callback and
 * the hooks for progress and cancelling. SPDX-License-Identifier: BSD-3-Clause */
#include "solver_base.h"
#include "domain/domain_internal.h"

#include <mps/context.h>

#define MOST_STEPS 1e15 /* of a run */
#define REPORTS 100     /* of a run, to the progress hook */

mps_status mpsi_solver_enter(mps_solver *s, const char *function) {
  const mps_status status = mpsi_guard_check(&s->guard, s->context, function);
  return status == MPS_OK && s->kind->ready ? s->kind->ready(s, function) : status;
}

mps_status mpsi_solver_enter_to_change(mps_solver *s, const char *function) {
  const mps_status status = mpsi_solver_enter(s, function);
  if (status == MPS_OK && s->kind->changing) s->kind->changing(s);
  return status;
}

static mps_status stop(mps_solver *s, const char *function) {
  const long long steps = s->kind->steps(s);
  const mps_status status =
      mpsi_fail(s->context, function, MPS_ERROR_CANCELLED,
                "stopped by the cancel hook at step %lld, t = %g s", steps, s->kind->time(s));
  mpsi_fail_where(s->context, steps, -1);
  return status;
}

mps_status mpsi_solver_check_cancel(mps_solver *s, const char *function) {
  if (s->kind->stopped && mpsi_domain_many(s->domain))
    return s->kind->stopped(s) ? stop(s, function) : MPS_OK;
  return s->kind->agree(s, function, mpsi_cancelled(s->context) ? stop(s, function) : MPS_OK);
}

/* The answer of the hook before the first step, in which it may only read. */
static bool refuses(mps_solver *s, const char *function) {
  mpsi_guard_enter(&s->guard, s->context, function);
  const bool asked = mpsi_cancelled(s->context);
  mpsi_guard_end(&s->guard);
  return asked;
}

/* Have all ranks made the same call, and does no cancel hook object to its first step? */
static mps_status agree_on_call(mps_solver *s, const char *function, mps_status status,
                                const mpsi_given *given, bool steps) {
  const double same = mpsi_hash_short(mpsi_given_hash(given));
  double all[3] = {same, -same, status == MPS_OK && steps && refuses(s, function)};
  status = mpsi_domain_agree_max(s->domain, function, status, 3, all);
  if (status == MPS_OK && all[0] != -all[1])
    status = mpsi_domain_agree_given(s->domain, function, status, given);
  return status == MPS_OK && all[2] != 0.0 ? stop(s, function) : status;
}

static mps_status call(mps_solver *s, const char *function, mpsi_march *m) {
  m->called = true;
  mpsi_guard_enter(&s->guard, s->context, s->kind->name.callback);
  const mps_status own = mpsi_guard_leave(&s->guard, s->context, function, m->callback(m->user, s));
  const mps_status status = s->kind->agree(s, function, own);
  if (status != MPS_OK) mpsi_fail_where(s->context, s->kind->steps(s), -1);
  return status;
}

/* The number of steps to take at once. */
static int64_t next_batch(const mps_solver *s, const mpsi_march *m) {
  if (!s->kind->batch) return 1;
  const int64_t rest = m->total - m->done, prompt = m->prompt - m->done % m->prompt;
  return s->kind->batch(s, m, rest < prompt ? rest : prompt);
}

static void report(mps_solver *s, const mpsi_march *m, int64_t *reported) {
  const double way = m->t_end - m->start, gone = s->kind->time(s) - m->start;
  if (!m->last && gone < way / REPORTS * (double)(*reported + 1)) return;
  *reported = m->last ? REPORTS : (int64_t)(gone / (way / REPORTS));
  mpsi_progress(s->context, s->kind->task, s->kind->steps(s), gone, way);
}

static bool is_over(const mps_solver *s, const mpsi_march *m) {
  return m->total >= 0 ? m->done >= m->total : !(s->kind->time(s) < m->t_end);
}

static mps_status march(mps_solver *s, const char *function, mpsi_march *m) {
  int64_t reported = 0;
  mps_status status = m->callback ? call(s, function, m) : MPS_OK;
  while (status == MPS_OK && !is_over(s, m)) {
    const int64_t count = next_batch(s, m);
    if (m->done > 0 && m->done % m->prompt == 0) status = mpsi_solver_check_cancel(s, function);
    if (status != MPS_OK) break;
    m->last = m->total >= 0 && m->done + count == m->total;
    m->calls = m->callback && (m->last || (m->done + count) % m->every == 0);
    status = s->kind->advance(s, function, m, count);
    m->done += count;
    m->called = false;
    m->calls = m->callback && (m->last || m->done % m->every == 0);
    if (status == MPS_OK && m->calls) status = call(s, function, m);
    if (status == MPS_OK && mpsi_march_is_run(m)) report(s, m, &reported);
  }
  return status;
}

static mps_status go(mps_solver *s, const char *function, mpsi_march *m) {
  m->before = s->kind->steps(s);
  MPSI_TRY(s->kind->begin(s, function, m));
  mpsi_guard_enter(&s->guard, s->context, function);
  mps_status status = march(s, function, m);
  mpsi_guard_end(&s->guard);
  return s->kind->end ? s->kind->end(s, function, m, status) : status;
}

mps_status mps_solver_step(mps_solver *s, int64_t count) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.step;
  mps_status status = mpsi_solver_enter(s, function);
  if (status != MPS_OK) return status;
  if (count < 0)
    status = mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                       (long long)count);
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "count", (double)count);
  status = agree_on_call(s, function, status, &given, count > 0);
  mpsi_march m = {.start = s->kind->time(s), .t_end = NAN, .total = count, .every = 1, .prompt = 1};
  return status == MPS_OK ? go(s, function, &m) : status;
}

static mps_status check_run(mps_solver *s, const char *function, double t_end, int64_t every) {
  const double time = s->kind->time(s);
  if (!isfinite(t_end) || t_end < time)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "t_end is %.9g s, must be finite and not before the solver's time, %.9g s",
                     t_end, time);
  if (every < 1)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT, "every is %lld, must be >= 1",
                     (long long)every);
  return MPS_OK;
}

mps_status mpsi_march_check(const mpsi_march *m, mps_context *context, const char *function,
                            double dt) {
  const double steps = (m->t_end - m->start) / dt;
  if (!(steps > MOST_STEPS)) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "t_end is %g s, %g steps of dt = %g s from now: must be at most %g", m->t_end,
                   steps, dt, MOST_STEPS);
}

mps_status mps_solver_run(mps_solver *s, double t_end, int64_t every, mps_solver_fn callback,
                          void *user) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.run;
  MPSI_TRY(mpsi_solver_enter(s, function));
  mps_status status = check_run(s, function, t_end, every);
  mpsi_given given = MPSI_GIVEN;
  mpsi_give(&given, "t_end", t_end);
  mpsi_give(&given, "every", (double)every);
  mpsi_give(&given, "having a callback", callback != NULL);
  status = agree_on_call(s, function, status, &given, t_end > s->kind->time(s));
  mpsi_march m = {.start = s->kind->time(s),
                  .t_end = t_end,
                  .total = -1,
                  .every = every,
                  .prompt = 1,
                  .callback = callback,
                  .user = user};
  return status == MPS_OK ? go(s, function, &m) : status;
}
