/* run.c - running the WLS-MPM solver: the size of its steps, and how many.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_private.h"

#include "kernels.h"

mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function) {
  if (mpm->run.broken)
    return mpsi_fail(
        mpm->context, function, MPS_ERROR_STATE,
        "an earlier step has failed: the state is kept for a look; make a new solver or "
        "restore a checkpoint");
  mps_status status = mpsi_particles_ready(mpm->particles, function);
  if (status != MPS_OK || !mpm->run.edited) return status;
  /* Blocks of the new positions, and the Courant limit of the new velocities. */
  status = mpsi_mpm_sort(mpm, function);
  if (status == MPS_OK) status = mpsi_mpm_list_holds(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_mpm_for_cells(mpm, mpm->kernels->speed);
  mpm->run.edited = false;
  return mpsi_mpm_collect_block_results(mpm, function);
}

double mps_mpm_limit(const mps_mpm *mpm) { return mpm ? mpm->def.cell / mpm->run.speed : 0.0; }

double mps_mpm_dt(const mps_mpm *mpm) {
  if (!mpm) return 0.0;
  return mpm->def.dt > 0.0 ? mpm->def.dt : mpm->def.courant * mps_mpm_limit(mpm);
}

double mps_mpm_time(const mps_mpm *mpm) { return mpm ? mpm->run.time : 0.0; }

int64_t mps_mpm_steps(const mps_mpm *mpm) { return mpm ? mpm->run.steps : 0; }

mps_status mps_mpm_step(mps_mpm *mpm, int64_t count) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (count < 0)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  mps_status status = mpsi_mpm_ready(mpm, __func__);
  for (int64_t k = 0; k < count && status == MPS_OK; k++)
    status = mpsi_mpm_take_step(mpm, __func__, mps_mpm_dt(mpm));
  return status;
}

mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every, mps_mpm_fn callback, void *user) {
  if (!mpm) return MPS_ERROR_ARGUMENT;
  if (!isfinite(t_end) || every < 1)
    return mpsi_fail(mpm->context, __func__, MPS_ERROR_ARGUMENT,
                     "t_end is %g s and every %lld: must be finite and >= 1", t_end,
                     (long long)every);
  mps_status status = mpsi_mpm_ready(mpm, __func__);
  const double start = mpm->run.time, slice = 0.01 * (t_end - start);
  int64_t done = 0, reported = 0;
  if (status == MPS_OK && callback) status = callback(user, mpm);
  while (status == MPS_OK && mpm->run.time < t_end) {
    if ((status = mpsi_mpm_ready(mpm, __func__)) != MPS_OK)
      break; /* the callback may have edited */
    double dt = mps_mpm_dt(mpm);
    const double rest = t_end - mpm->run.time;
    const bool last = rest <= dt * (1.0 + 1e-9);
    if (last) dt = rest;
    status = mpsi_mpm_take_step(mpm, __func__, dt);
    if (last) mpm->run.time = t_end;
    done++;
    if (status == MPS_OK && callback && (done % every == 0 || last)) status = callback(user, mpm);
    if (last || mpm->run.time >= start + slice * (double)(reported + 1)) {
      reported = last ? 100 : (int64_t)((mpm->run.time - start) / slice);
      mpsi_progress(mpm->context, "mpm", mpm->run.steps, mpm->run.time - start, t_end - start);
    }
    if (status == MPS_OK && !last && mpsi_cancelled(mpm->context))
      status = mpsi_fail(mpm->context, __func__, MPS_ERROR_CANCELLED,
                         "stopped by the cancel hook at step %lld, t = %g s",
                         (long long)mpm->run.steps, mpm->run.time);
  }
  return status;
}
