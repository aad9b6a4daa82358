/* run.c - running the WLS-MPM solver: the size of its steps, and how many.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "core/base/digits.h"

/* Checks that all ranks have the same argument. */
static mps_status same_on_ranks(mpsi_partition *partition, const char *function, mps_status status,
                                const char *name, double value) {
  if (!partition) return status;
  return mpsi_domain_agree_same(partition->domain, function, status, name, value);
}

/* ---- the time step --------------------------------------------------------------------------- */

mps_status mps_mpm_set_dt(mps_mpm *mpm, double dt) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_status status = mpsi_mpm_between_steps(mpm->context, &mpm->run, __func__);
  const double limit = mps_mpm_limit(mpm);
  if (status == MPS_OK && !isnan(dt) && !(dt >= MPSI_MPM_LEAST_DT && dt <= limit))
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "dt is %s s, must be %g s to the Courant limit of the present state, %g s, "
                       "or NaN for a step that follows the limit",
                       mpsi_outside(dt, MPSI_MPM_LEAST_DT, limit).text, MPSI_MPM_LEAST_DT, limit);
  status = same_on_ranks(mpm->partition, __func__, status, "dt", dt);
  if (status == MPS_OK) mpm->def.dt = dt;
  return status;
}

/* ---- many steps ------------------------------------------------------------------------------ */

static mps_status check_cancel(mps_context *context, mpsi_partition *partition, const mpsi_run *run,
                               const char *function) {
  if (partition ? !partition->cancel : !mpsi_cancelled(context)) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_CANCELLED,
                   "stopped by the cancel hook at step %lld, t = %g s", (long long)run->steps,
                   run->time);
}

mps_status mps_mpm_step(mps_mpm *mpm, int64_t count) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  const mpsi_edit_state before = mpsi_mpm_edit_state(&mpm->run);
  const int64_t steps = mpm->run.steps;
  mps_status status = MPS_OK;
  if (count < 0)
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                       (long long)count);
  status = same_on_ranks(mpm->partition, __func__, status, "count", (double)count);
  if (status == MPS_OK) status = mpsi_mpm_ready(mpm, __func__);
  if (status != MPS_OK) return status;
  mpsi_guard_enter(&mpm->run.guard, mpm->context, __func__);
  for (int64_t k = 0; k < count && status == MPS_OK; k++) {
    if (mpm->run.edited) status = mpsi_mpm_apply_edits(mpm, __func__); /* particles have left */
    if (status == MPS_OK) status = mpsi_mpm_check_bounded(mpm, __func__);
    if (status == MPS_OK) status = mpsi_mpm_step_from_settling(mpm, __func__, mps_mpm_dt(mpm));
    if (status == MPS_OK && k + 1 < count)
      status = check_cancel(mpm->context, mpm->partition, &mpm->run, __func__);
  }
  if (status != MPS_OK && mpm->run.steps == steps) mpsi_mpm_restore_edit_state(&mpm->run, &before);
  mpsi_guard_end(&mpm->run.guard);
  return status;
}

static mps_status call(mps_mpm *mpm, const char *function, mps_mpm_fn callback, void *user) {
  mpsi_guard_enter(&mpm->run.guard, mpm->context, "the callback of mps_mpm_run");
  const mps_status status =
      mpsi_guard_leave(&mpm->run.guard, mpm->context, function, callback(user, mpm));
  return mpm->partition ? mpsi_mpm_agree_alike(&mpm->contact, mpm->partition, &mpm->run, &mpm->def,
                                               function, status, 0, NULL)
                        : status;
}

/* Arguments of a run. */
typedef struct run {
  double start, t_end;
  int64_t every;
  mps_mpm_fn callback;
  void *user;
} run;

/* Size (s) of the next step, at most to t_end. The last two steps are equal, because a very short
 * one has irregular forces. */
static double next_step(const mps_mpm *mpm, double t_end, bool *last) {
  const double dt = mps_mpm_dt(mpm), rest = t_end - mpm->run.time;
  *last = rest <= dt * (1.0 + 1e-9);
  if (*last) return rest;
  return rest < 2.0 * dt * (1.0 - 1e-9) ? 0.5 * rest : dt;
}

static mps_status march(mps_mpm *mpm, const char *function, const run *r) {
  const double slice = 0.01 * (r->t_end - r->start);
  int64_t done = 0, reported = 0;
  mps_status status = MPS_OK;
  bool called = r->callback != NULL, last = false;
  if (called) status = call(mpm, function, r->callback, r->user);
  while (status == MPS_OK && mpm->run.time < r->t_end) {
    if (called || mpm->run.edited)
      status = mpsi_mpm_apply_edits(mpm, function); /* particles have left */
    if (status == MPS_OK) status = mpsi_mpm_check_advance(mpm, function);
    if (status != MPS_OK) break;
    const int64_t steps = mpm->run.steps;
    status = mpsi_mpm_step_from_settling(mpm, function, next_step(mpm, r->t_end, &last));
    if (last && mpm->run.steps > steps) mpm->run.time = r->t_end; /* a refused step took no time */
    done++;
    called = r->callback && (done % r->every == 0 || last);
    if (status == MPS_OK && called) status = call(mpm, function, r->callback, r->user);
    if (last || mpm->run.time >= r->start + slice * (double)(reported + 1)) {
      reported = last ? 100 : (int64_t)((mpm->run.time - r->start) / slice);
      mpsi_progress(mpm->context, "mpm", mpm->run.steps, mpm->run.time - r->start,
                    r->t_end - r->start);
    }
    if (status == MPS_OK && !last)
      status = check_cancel(mpm->context, mpm->partition, &mpm->run, function);
  }
  return status;
}

mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every, mps_mpm_fn callback, void *user) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  mps_status status = MPS_OK;
  if (!isfinite(t_end) || every < 1)
    status =
        mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                  "t_end is %g s and every %lld: must be finite and >= 1", t_end, (long long)every);
  else if (t_end < mpm->run.time)
    status = mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                       "t_end is %.9g s, must not be before the solver's time %.9g s", t_end,
                       mpm->run.time);
  status = same_on_ranks(mpm->partition, __func__, status, "t_end", t_end);
  if (status == MPS_OK)
    status = same_on_ranks(mpm->partition, __func__, status, "every", (double)every);
  if (status == MPS_OK)
    status = same_on_ranks(mpm->partition, __func__, status, "having a callback", callback != NULL);
  const mpsi_edit_state before = mpsi_mpm_edit_state(&mpm->run);
  const int64_t steps = mpm->run.steps;
  if (status == MPS_OK) status = mpsi_mpm_ready(mpm, __func__);
  if (status != MPS_OK) return status;
  const run r = {mpm->run.time, t_end, every, callback, user};
  mpsi_guard_enter(&mpm->run.guard, mpm->context, __func__);
  status = march(mpm, __func__, &r);
  if (status != MPS_OK && mpm->run.steps == steps) mpsi_mpm_restore_edit_state(&mpm->run, &before);
  mpsi_guard_end(&mpm->run.guard);
  return status;
}
