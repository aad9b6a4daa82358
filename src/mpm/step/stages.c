/* stages.c - stages of a step common to one process and several ranks: see stages.h.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "stages.h"

#include "core/particles/particles_internal.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/water.h"
#include "means.h"
#include "tiles.h"

#define CHATTER 6.0 /* k dt^2/m above which a penalty contact oscillates */

mps_status mpsi_step_begin_sums(mps_mpm *mpm, const char *function) {
  mps_status status =
      mpsi_mpm_find_forces(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, &mpm->loads, function);
  if (status == MPS_OK)
    status = mpsi_mpm_energy_begin(mpm->context, &mpm->grid, &mpm->p, &mpm->contact, &mpm->energy,
                                   &mpm->def, function);
  if (status == MPS_OK)
    status = mpsi_mpm_begin_balance(mpm->context, &mpm->grid, &mpm->p, &mpm->settling, &mpm->def,
                                    function);
  return status;
}

static void warn_about_courant(mps_mpm *mpm, double dt) {
  const double limit = mps_mpm_limit(mpm), courant = mpm->def.courant;
  if (mpm->run.warned_about_dt || !(dt > courant * limit * (1.0 + 1e-9))) return;
  mpm->run.warned_about_dt = true;
  mpsi_log(mpm->context, MPS_CONTEXT_LOG_WARNING,
           "step %lld: dt is %.4g s, %.3g of the Courant limit h/(c + v), above the fraction "
           "courant = %g: choose a smaller dt, or NaN for a step that follows the limit",
           (long long)mpm->run.steps, dt, dt / limit, courant);
}

static void warn_about_chatter(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                               const mpsi_contacts *contacts, const mps_mpm_def *def, double dt) {
  double stiffest = 0.0;
  for (int32_t k = 0; k < p->laws.count; k++) stiffest = fmax(stiffest, p->laws.law[k].modulus);
  for (int32_t b = 0; b < contacts->bodies; b++) {
    const mps_contact *contact = contacts->handle[b];
    if (mpsi_by_impulses(contact)) continue;
    const double k =
        grid->measure * mpsi_contact_penalty(contact, stiffest, mps_particles_spacing(p->set),
                                             grid->cell, def->courant);
    const double ratio = k * dt * dt / contacts->least_mass;
    if (!(ratio > CHATTER) || contacts->state[b].warned) continue;
    contacts->state[b].warned = true;
    mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
             "contact with body %d will chatter: k dt^2/m = %.3g, above %g; use a penalty k of at "
             "most %.4g or a dt of at most %.4g s",
             b, ratio, CHATTER, k * CHATTER / ratio, dt * sqrt(CHATTER / ratio));
  }
}

void mpsi_step_begin(mps_mpm *mpm, double dt) {
  mpm->run.dt = dt;
  mpsi_pore_plan(mpm);
  warn_about_courant(mpm, dt);
  warn_about_chatter(mpm->context, &mpm->grid, &mpm->p, &mpm->contact, &mpm->def, dt);
}

static void gather(void *solver, int64_t b, int32_t worker) {
  mps_mpm *mpm = solver;
  const mpsi_transfer work = mpsi_transfer_of(mpm, b, worker);
  if (mpm->undo.on && !mpsi_pore_predicts(mpm))
    mpsi_mpm_save_block(&mpm->grid, &mpm->p, &mpm->undo, b);
  mpsi_pore_keep_volumes(mpm, b);
  mpm->kernels->g2p[mpm->grid.geometry][mpm->grid.spline - 2](&work);
}

mps_status mpsi_step_predict(mps_mpm *mpm, const char *function) {
  for (int64_t b = 0; b < mpm->grid.cell_count && mpm->undo.on; b++)
    mpsi_mpm_save_block(&mpm->grid, &mpm->p, &mpm->undo, b);
  const mps_status status = mpsi_pore_predict(mpm, function);
  if (status != MPS_OK) mpm->run.broken = true;
  return status;
}

mpsi_pass mpsi_step_scatter_pass(mps_mpm *mpm) {
  return (mpsi_pass){.data = mpm,
                     .clear = mpsi_mpm_clear_nodes,
                     .scatter = mpsi_step_scatter,
                     .update = mpsi_mpm_update_nodes};
}

void mpsi_step_gather_pass(mpsi_pass *pass) {
  pass->finish = mpsi_mpm_finish_nodes;
  pass->gather = gather;
}

void mpsi_step_without_contact(const mpsi_boundaries *boundaries, mpsi_contacts *contacts,
                               double dt) {
  contacts->impulses.warm_count = contacts->impulses.sweeps = 0;
  contacts->impulses.left = 0.0;
  mpsi_mpm_begin_boundaries(boundaries, dt);
}

void mpsi_step_after_gather(mps_mpm *mpm) {
  mpsi_mpm_sum_boundaries(&mpm->grid, &mpm->boundaries, &mpm->mirrors, &mpm->energy, mpm->run.dt);
  mpsi_mpm_drive_particles(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->energy, mpm->run.dt);
  mpsi_mpm_find_impulse_loss(&mpm->grid, &mpm->contact, &mpm->energy,
                             mpm->kernels); /* before means replace the values of the nodes */
  if (!mpm->p.laws.at_once || mpm->p.laws.some_filtered) mpsi_mpm_apply_laws_by_cell(mpm);
}

mps_status mpsi_step_refuse(mps_mpm *mpm, const char *function) {
  mpsi_refusal *r = &mpm->p.laws.refusal;
  mpsi_mpm_undo(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->contact, &mpm->undo);
  if (!r->cells) return MPS_OK;
  r->cells = NULL;
  return mpsi_material_refused(mpm->context, function, r->material, r->status, r->message,
                               r->particle >= 0 ? mpm->p.laws.ids[r->particle] : -1,
                               mpm->run.steps);
}

void mpsi_step_complete(mps_mpm *mpm) {
  if (mpm->contact.bodies > 0)
    mpsi_mpm_update_bodies(&mpm->grid, &mpm->contact, &mpm->energy, mpm->partition, &mpm->settling,
                           mpm->run.dt);
  mpsi_mpm_energy_end(&mpm->grid, &mpm->p, &mpm->contact, mpm->partition, &mpm->energy, &mpm->def);
  mpm->run.moments = true;
  mpm->run.time += mpm->run.dt;
  mpm->run.steps++;
}
