/* step_on_ranks.c - one step of WLS-MPM on several ranks: the stages of step.c with the exchanges
 * between them. A call that can fail on one rank is followed by one in which all agree on a status;
 * where nothing can fail that did not in the last step, one reduction at the end serves all.
 *
 *   prepare    statuses of signals and particles; ghosts of the present blocks
 *   scatter    border blocks are summed and sent, the interior meanwhile (tiles.c)
 *   contact    constraints of partner ranks, on which each sweeps alike (contact/exchange.c)
 *   gather     each rank its own blocks
 *   complete   largest speed, lost and bad particles in one reduction (block_results.c)
 * SPDX-License-Identifier: BSD-3-Clause */
#include "stages.h"

#include "mpm/particles/mpm_particles.h"
#include "means.h"
#include "mpm/ranks/parcels.h"
#include "mpm/water/water.h"
#include "tiles.h"

/* Preparation as in step.c. After an error only the tractions at rest of absorbing sides are lost.
 * `status`: of the call so far on this rank; collective. */
static mps_status prepare(mps_mpm *mpm, const char *function, mps_status status) {
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(mpm);
  const mpsi_contact_setup contacts = mpsi_contact_setup_of(mpm);
  bool removed = true;
  while (removed) {
    removed = false;
    const bool renewed = mpm->run.stale || mpm->partition->outdated;
    status = mpsi_mpm_partition_update(mpm, function, status);
    if (status == MPS_OK && mpm->run.stale) {
      status = mpsi_mpm_sort(mpm, function);
      mpm->boundaries.outdated = true;
    }
    if (status != MPS_OK && renewed) return status; /* on all ranks */
    if (status == MPS_OK)
      status = mpsi_mpm_prepare_outflow(mpm->context, &mpm->p, &mpm->boundaries, &mpm->rooms,
                                        mpsi_mpm_any_body_removes(&mpm->contact), function);
    const bool dashpots = mpm->boundaries.dashpot_count > 0, well = status == MPS_OK;
    status = mpsi_mpm_update_boundaries(&boundaries, function, status);
    if (well && status != MPS_OK) mpm->run.broken = dashpots;
    status = mpsi_mpm_find_near(mpm, function, status);
    status = mpsi_mpm_clear_bodies(&contacts, function, status, &removed);
    if (removed) status = mpsi_mpm_apply_edits(mpm, function);
    if (removed && status != MPS_OK) return status;
  }
  return status == MPS_OK ? mpsi_step_begin_sums(mpm, function) : status;
}

/* Constraints of partner ranks are exchanged with the statuses of all; no particle moves before all
 * depths are known. */
static mps_status solve_contacts(mps_mpm *mpm, const char *function, double dt, mps_status status) {
  mpsi_mpm_find_contact_mass(&mpm->grid, &mpm->contact, mpm->partition); /* mass over all ranks */
  const mpsi_contact_stage stage = mpsi_contact_stage_of(mpm);
  mpsi_mpm_fit_constraints(&stage);
  if (status == MPS_OK)
    status = mpsi_mpm_check_depth(mpm->context, &mpm->p, &mpm->contact, &mpm->run, function);
  status = mpsi_mpm_exchange_contacts(&stage, function, status);
  if (status != MPS_OK) return status;
  mpsi_mpm_apply_impulses(&stage);
  mpsi_mpm_end_contact_exchange(&mpm->contact);
  status = mpsi_step_predict(mpm, function);
  mpsi_mpm_end_impulses(&stage);
  mpsi_mpm_begin_boundaries(&mpm->boundaries, dt);
  return status;
}

/* P2G, contact and G2P. `status`: of the search for constraints on this rank, on which ranks agree
 * when they exchange these. */
static mps_status transfer(mps_mpm *mpm, const char *function, double dt, mps_status status) {
  mpsi_pass pass = mpsi_step_scatter_pass(mpm);
  const mps_status sent = mpsi_mpm_send_tiles(mpm, function);
  if (sent != MPS_OK) return sent;
  pass.scatter = mpsi_mpm_scatter_tile;
  pass.arrive = mpsi_step_receive_parcels;
  if (mpm->contact.cell_pair_count > 0 || mpm->contact.bodies > 0) {
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
    status = solve_contacts(mpm, function, dt, status);
    if (status != MPS_OK) return status;
    pass = (mpsi_pass){.data = mpm};
  } else if (mpsi_pore_predicts(mpm)) {
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
    mpsi_step_without_contact(&mpm->boundaries, &mpm->contact, dt);
    status = mpsi_step_predict(mpm, function);
    if (status != MPS_OK) return status;
    pass = (mpsi_pass){.data = mpm};
  } else {
    mpsi_step_without_contact(&mpm->boundaries, &mpm->contact, dt);
  }
  mpsi_step_gather_pass(&pass);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  return status;
}

static mps_status step_on_ranks(mps_mpm *mpm, const char *function, double dt) {
  const bool unchanged = mpsi_mpm_partition_unchanged(&mpm->boundaries, &mpm->contact,
                                                      mpm->partition, &mpm->settling, &mpm->run);
  mps_status status = mpsi_mpm_evaluate_signals(mpm, function, dt, true);
  if (mpsi_mpm_signals_may_refuse(&mpm->grid, &mpm->loads, &mpm->boundaries))
    status = mpsi_mpm_agree_in_step(mpm, function, status, 0, NULL);
  if (status != MPS_OK && mpm->contact.bodies == 0) return status;
  status = prepare(mpm, function, status); /* in which ranks agree on the signals of bodies */
  if (status == MPS_OK) status = mpsi_mpm_prepare_undo(mpm, function);
  status = mpsi_pore_begin(mpm, function, status);
  if (!unchanged) status = mpsi_mpm_agree_before_step(mpm, function, status);
  if (status != MPS_OK) return status;
  mpsi_step_begin(mpm, dt);
  const mpsi_contact_stage stage = mpsi_contact_stage_of(mpm);
  status = mpsi_mpm_find_constraints(&stage, function);
  if (mpm->contact.bodies > 0) mpsi_mpm_mark_contact_blocks(&mpm->contact, &mpm->grid);
  status = transfer(mpm, function, dt, status);
  if (status != MPS_OK) return status;
  mpsi_step_after_gather(mpm);
  bool refused = mpm->p.laws.refusal.cells != NULL;
  if (mpm->undo.on) status = mpsi_mpm_any_rank(mpm->partition, function, &refused);
  if (status != MPS_OK) return status;
  if (refused)
    return mpsi_domain_agree(mpm->partition->domain, function, mpsi_step_refuse(mpm, function));
  mpsi_step_complete(mpm);
  if (mpm->water && !mpsi_any_failed(&mpm->grid, mpm->partition)) mpsi_pore_update(mpm);
  return mpsi_mpm_collect_block_results(mpm, function);
}

mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt) {
  return mpm->partition ? step_on_ranks(mpm, function, dt) : mpsi_mpm_step_alone(mpm, function, dt);
}
