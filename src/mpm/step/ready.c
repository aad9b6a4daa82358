/* ready.c - updates before a step where the caller, the ranks or the particles have changed
 * something: blocks of the present positions, masses, boundaries, the Courant limit.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/water.h"

mps_status mpsi_mpm_usable(mps_mpm *mpm, const char *function) {
  const mps_status status = mpsi_mpm_between_steps(mpm->context, &mpm->run, function);
  mpm->run.renewed = mpm->run.renewed || status == MPS_OK;
  return status == MPS_OK ? mpsi_mpm_check_whole(mpm->context, &mpm->p, &mpm->run, function)
                          : status;
}

mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function) {
  if (!mpm->partition)
    return mpsi_mpm_sort_alone(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function);
  mps_status status = MPS_OK;
  if (mpm->contact.bodies > 0)
    status = mpsi_mpm_share_warm_start(&mpm->contact.impulses, mpm->p.set, mpm->domain,
                                       function, status);
  if (mpm->prescribed.on)
    status = mpsi_mpm_share_warm_start(&mpm->prescribed.constraints.impulses, mpm->p.set,
                                       mpm->domain, function, status);
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  if (status == MPS_OK) return mpsi_mpm_partition_sort(&part, function);
  mpm->run.stale = true;
  return status;
}

mps_status mpsi_mpm_partition_update(mps_mpm *mpm, const char *function, mps_status status) {
  if (!mpm->run.stale && !mpm->partition->outdated) return status;
  status = mpsi_domain_agree(mpm->domain, function, status);
  if (status != MPS_OK || mpm->run.stale) return status;
  mpm->boundaries.outdated = true;
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  return mpsi_mpm_partition_find_ghosts(&part, function);
}

static void find_speed(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  mpm->kernels->speed(&work);
}

void mpsi_mpm_find_speeds(mps_mpm *mpm) {
  mpsi_mpm_for_cells(mpm->context, &mpm->grid, &mpm->p, find_speed, mpm);
}

/* What was given before the first step for a state that might have been restored. */
static mps_status check_first_state(mps_mpm *mpm, const char *function) {
  mps_status status = MPS_OK;
  for (int32_t l = 0; l < mpm->p.laws.count && status == MPS_OK; l++)
    status = mpsi_mpm_check_states(mpm->context, &mpm->grid, &mpm->p, function, l, 0, mpm->p.count);
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    if (mpm->contact.handle[b]->def.inside != MPS_CONTACT_INSIDE_REMOVE)
      status = mpsi_mpm_check_inside(mpm->context, &mpm->grid, &mpm->p, function,
                                     mpm->contact.handle[b], 0);
  return status == MPS_OK
             ? mpsi_mpm_check_overlaps(mpm->context, &mpm->grid, &mpm->contact, function)
             : status;
}

mps_status mpsi_mpm_apply_edits(mps_mpm *mpm, const char *function) {
  mps_status status = mpsi_mpm_check_whole(mpm->context, &mpm->p, &mpm->run, function);
  if (status == MPS_OK)
    status = mpsi_mpm_check_lost(mpm->context, &mpm->grid, &mpm->p, &mpm->run, &mpm->def, function);
  if (mpm->partition)
    status = mpsi_mpm_compare_edits(&mpm->contact, mpm->partition, &mpm->run, &mpm->def, function,
                                    status);
  if (status != MPS_OK) return status;
  /* no rank has a lost particle any more */
  if (mpm->run.lost) mpm->run.lost = false, mpm->run.edited = true;
  if (!mpm->run.edited && !mpm->run.unchecked) return status;
  mpm->run.changed = mpm->run.renewed = true;
  status = mpsi_mpm_check_masses(mpm->context, &mpm->p, function);
  if (status == MPS_OK && mpm->run.unchecked) status = check_first_state(mpm, function);
  if (status == MPS_OK)
    status = mpsi_mpm_check_deformations(mpm->context, &mpm->grid, &mpm->p, function);
  if (status == MPS_OK) status = mpsi_pore_check(mpm->context, &mpm->p, mpm->water, function);
  if (mpm->partition) status = mpsi_mpm_partition_update(mpm, function, status);
  if (status == MPS_OK && mpm->run.stale) status = mpsi_mpm_sort(mpm, function);
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(mpm);
  status = mpsi_mpm_list_boundaries(&boundaries, function, status);
  MPSI_TRY(mpsi_domain_agree(mpm->domain, function, status));
  mpsi_mpm_find_speeds(mpm);
  mpm->run.edited = mpm->run.unchecked = false;
  return mpsi_mpm_collect_block_results(mpm, function);
}

mpsi_edit_state mpsi_mpm_edit_state(const mpsi_run *run) {
  return (mpsi_edit_state){run->speed, run->flow, run->wave, run->edited};
}

void mpsi_mpm_restore_edit_state(mpsi_run *run, const mpsi_edit_state *before) {
  if (!before->edited) return;
  run->speed = before->speed;
  run->flow = before->flow;
  run->wave = before->wave;
  run->edited = true;
}

mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function) {
  MPSI_TRY(mpsi_guard_check(&mpm->guard, mpm->context, function));
  return mpsi_mpm_apply_edits(mpm, function);
}

mps_status mpsi_mpm_check_advance(mps_mpm *mpm, const char *function) {
  const double dt = mpsi_mpm_dt(mpm), time = mpm->run.time;
  if (time + dt > time) return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                   "dt = %g s, courant = %g times the limit %g s, does not advance the time %g s: "
                   "set dt",
                   dt, mpm->def.courant, mpsi_mpm_limit(mpm), time);
}

mps_status mpsi_mpm_check_bounded(mps_mpm *mpm, const char *function) {
  if (isfinite(mpsi_mpm_dt(mpm))) return mpsi_mpm_check_advance(mpm, function);
  return mpsi_fail(mpm->context, function, MPS_ERROR_STATE,
                   "the solver has no particles, and nothing bounds dt: set it, or run to a time");
}
