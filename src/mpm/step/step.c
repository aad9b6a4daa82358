/* step.c - one step of WLS-MPM: its stages in order, Nakamura 6 and Table 2.
 *
 *   prepare    order of the particles, active nodes, pairs of blocks and bodies; nothing moves
 *   scatter    x, v, L, sigma, V, m --> mass, momentum and forces at the nodes: transfer/p2g.c
 *              (23)-(25), (39), cut_contact.h (28)-(30)
 *   update     velocities without and with the forces: node_update.c (26)
 *   contact    impulses between nodes and bodies: contact/constraints.c, impulses.c; or the penalty
 *              forces and friction of penalty_friction.c, src/contact/friction.c (31)-(34)
 *   predict    pressures of pore water that are implicit correct the velocities: water/flow.c
 *   finish     boundaries: boundary/walls.c
 *   gather     velocities of the nodes --> v, L, x (41)-(44); then the laws, L --> sigma, V and
 *              their histories (45)-(48), and c + |v| for the next step (49), (50): g2p.c, laws.c
 *   complete   reactions, poses of bodies, energy budget, pressures of pore water, outflow
 *
 * On an error nothing has moved, but where a particle has left the domain (run.lost: the step is
 * whole) or has got values that are no numbers (run.broken).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "stages.h"

#include "mpm/boundary/free_field.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/water.h"

static mps_status prepare(mps_mpm *mpm, const char *function) {
  const mpsi_boundary_setup boundaries = mpsi_boundary_setup_of(mpm);
  const mpsi_contact_setup contacts = mpsi_contact_setup_of(mpm);
  mps_status status = MPS_OK;
  bool removed = true; /* particles have been removed by bodies */
  while (status == MPS_OK && removed) {
    removed = false;
    if (mpm->run.stale) {
      status = mpsi_mpm_sort(mpm, function);
      mpm->boundaries.outdated = true;
    }
    if (status == MPS_OK)
      status = mpsi_mpm_prepare_outflow(mpm->context, &mpm->p, &mpm->boundaries, &mpm->rooms,
                                        mpsi_mpm_any_body_removes(&mpm->contact), function);
    if (status == MPS_OK) status = mpsi_mpm_update_boundaries(&boundaries, function, status);
    if (status == MPS_OK) status = mpsi_mpm_find_near(mpm, function, status);
    if (status == MPS_OK) status = mpsi_mpm_clear_bodies(&contacts, function, status, &removed);
    if (removed) status = mpsi_mpm_apply_edits(mpm, function);
  }
  return status == MPS_OK ? mpsi_step_begin_sums(mpm, function) : status;
}

static bool find_masses(void *data) {
  const mps_mpm *mpm = ((const mpsi_step *)data)->mpm;
  mpsi_mpm_find_contact_mass(&mpm->grid, &mpm->contact, mpm->partition);
  return true;
}

/* Constraints and their impulses. No particle moves before all depths are known. */
static bool solve_contacts(void *data) {
  mpsi_step *step = data;
  mps_mpm *mpm = step->mpm;
  const mpsi_contact_stage stage = mpsi_contact_stage_of(mpm);
  mpsi_mpm_fit_constraints(&stage);
  step->status =
      mpsi_mpm_check_depth(mpm->context, &mpm->p, &mpm->contact, &mpm->run, step->function);
  if (step->status != MPS_OK) return false;
  mpsi_mpm_apply_impulses(&stage);
  step->status = mpsi_step_predict(mpm, step->function);
  mpsi_mpm_end_impulses(&stage);
  mpsi_mpm_begin_boundaries(&mpm->boundaries, step->dt);
  return step->status == MPS_OK;
}

/* One thread can scatter the blocks near bodies first, solve the contacts, and then go over all
 * others in one wave. Penalty contact and contact areas need nodes anywhere near a body. */
static bool can_solve_in_one_wave(const mpsi_grid *grid, const mpsi_columns *p,
                                  const mpsi_contacts *contacts) {
  bool can = mpsi_mpm_passes_alone(grid, p) && contacts->penalty_bodies == 0;
  for (int32_t b = 0; b < contacts->bodies; b++)
    can = can && mpsi_by_impulses(contacts->handle[b]) && !mpsi_has_strength(contacts->handle[b]);
  return can;
}

/* Marks the nodes of all constraints, which are updated before the contacts are solved. */
static void wait_for_constraints(const mpsi_grid *grid, const mpsi_contacts *contacts) {
  const mpsi_impulses *all = &contacts->impulses;
  for (int64_t k = 0; k < all->block_count; k++)
    for (int q = 0; q < 1 << grid->dim; q++)
      grid->nodes[grid->cells[all->block[k].cells].to[q]].waits = true;
}

/* Particles --> nodes --> particles (grid/pass.h). */
static mps_status transfer(mps_mpm *mpm, const char *function, double dt) {
  mpsi_step step = {mpm, function, dt, MPS_OK};
  mpsi_pass pass = mpsi_step_scatter_pass(mpm);
  pass.between = mpm->contact.bodies > 0 ? find_masses : NULL;
  pass.step = &step;
  const bool contacts = mpm->contact.cell_pair_count > 0, predicts = mpsi_pore_predicts(mpm);
  if (predicts && !contacts) {
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
    mpsi_step_without_contact(&mpm->boundaries, &mpm->contact, dt);
    step.status = mpsi_step_predict(mpm, function);
    if (step.status != MPS_OK) return step.status;
    pass = (mpsi_pass){.data = mpm};
  } else if (!contacts) {
    mpsi_step_without_contact(&mpm->boundaries, &mpm->contact, dt);
  } else if (!predicts && can_solve_in_one_wave(&mpm->grid, &mpm->p, &mpm->contact)) {
    wait_for_constraints(&mpm->grid, &mpm->contact);
    pass.between = solve_contacts;
  } else {
    mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
    if (!solve_contacts(&step)) return step.status;
    pass = (mpsi_pass){.data = mpm};
  }
  mpsi_step_gather_pass(&pass);
  mpsi_mpm_run_pass(mpm->context, &mpm->grid, &mpm->p, &pass);
  return step.status;
}

mps_status mpsi_mpm_step_alone(mps_mpm *mpm, const char *function, double dt) {
  mps_status status = mpsi_mpm_evaluate_signals(mpm, function, dt, true);
  if (status == MPS_OK) status = prepare(mpm, function);
  if (status == MPS_OK) status = mpsi_mpm_prepare_undo(mpm, function);
  if (status == MPS_OK) status = mpsi_pore_begin(mpm, function, status);
  if (status != MPS_OK) return status;
  mpsi_step_begin(mpm, dt);
  const mpsi_contact_stage stage = mpsi_contact_stage_of(mpm);
  const mpsi_boundary_setup setup = mpsi_boundary_setup_of(mpm);
  status = mpsi_mpm_find_constraints(&stage, function);
  if (status == MPS_OK) status = mpsi_mpm_move_free_fields(&setup, function);
  if (status != MPS_OK) return status;
  status = transfer(mpm, function, dt);
  if (status == MPS_OK) mpsi_step_after_gather(mpm);
  const bool refused = status == MPS_OK && mpm->p.laws.refusal.cells;
  if (status != MPS_OK || refused) mpsi_mpm_return_free_fields(&mpm->boundaries);
  if (refused) return mpsi_step_refuse(mpm, function);
  if (status != MPS_OK) return status;
  mpsi_step_complete(mpm);
  status = mpsi_mpm_collect_block_results(mpm, function);
  if (mpm->run.broken) return status;
  mpsi_pore_update(mpm);
  mpsi_mpm_remove_leaving(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->energy, &mpm->rooms);
  return status;
}
