/* step.c - one step of WLS-MPM: the order of its stages (Nakamura 6), and what goes wrong in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/kernels.h"
#include "mpm/particles/particles.h"

#include "core/particles/particles_internal.h"

#include <string.h>

#define CHATTER 6.0 /* k dt^2/m above which a contact does not settle */

static mps_status report_refusal(mps_mpm *mpm, const char *function) {
  mpsi_refusal *r = &mpm->laws.refusal;
  r->cells = NULL;
  return mpsi_material_refused(mpm->context, function, r->material, r->status, r->message,
                               r->particle >= 0 ? mpm->laws.ids[r->particle] : -1, mpm->run.steps);
}

/* Tells the log, once each, of a step too large for the present state. */
static void warn_about_step(mps_mpm *mpm, double dt) {
  const double limit = mps_mpm_limit(mpm), courant = mpm->def.courant;
  if (!mpm->run.warned_about_dt && dt > courant * limit * (1.0 + 1e-9)) {
    mpm->run.warned_about_dt = true;
    mpsi_log(mpm->context, MPS_LOG_WARNING,
             "step %lld: dt is %.4g s, %.3g of the Courant limit h/(c + v), above the fraction "
             "courant = %g: "
             "choose a smaller dt, or NaN for a step that follows the limit",
             (long long)mpm->run.steps, dt, dt / limit, courant);
  }
  double stiffest = 0.0;
  for (int32_t k = 0; k < mpm->laws.count; k++) stiffest = fmax(stiffest, mpm->laws.law[k].modulus);
  for (int32_t b = 0; b < mpm->contact.bodies; b++) {
    if (mpsi_by_impulses(mpm->contact.handle[b])) continue;
    const double k = mpm->def.measure * mpsi_contact_penalty(mpm->contact.handle[b], stiffest,
                                                             mps_particles_spacing(mpm->particles),
                                                             mpm->def.cell, mpm->def.courant);
    const double ratio = k * dt * dt / mpm->contact.least_mass;
    if (!(ratio > CHATTER) || (mpm->run.warned_about_chatter >> b & 1)) continue;
    mpm->run.warned_about_chatter |= UINT32_C(1) << b;
    mpsi_log(mpm->context, MPS_LOG_WARNING,
             "contact with body %d will chatter: k dt^2/m = %.3g, above %g; use a penalty k of at "
             "most %.4g or a dt of at most %.4g s",
             b, ratio, CHATTER, k * CHATTER / ratio, dt * sqrt(CHATTER / ratio));
  }
}

/* Before anything moves: the particles in order where some have left their blocks, and what is near
 * them. An error loses nothing but, on several ranks, the tractions at rest of absorbing sides.
 * `status`: status of the call so far here; collective. */
static mps_status prepare(mps_mpm *mpm, const char *function, mps_status status) {
  const bool renewed = mpm->run.stale || (mpm->partition && mpm->partition->outdated);
  if (mpm->partition) status = mpsi_mpm_partition_update(mpm, function, status);
  if (status == MPS_OK && mpm->run.stale) {
    status = mpsi_mpm_sort(mpm, function);
    mpm->boundaries.outdated = true;
  }
  if (status != MPS_OK && renewed) return status;                         /* on all ranks */
  if (status == MPS_OK) status = mpsi_mpm_prepare_outflow(mpm, function); /* for those here now */
  const bool dashpots = mpm->boundaries.dashpot_count > 0;
  const mps_status before = status;
  status = mpsi_mpm_update_boundaries(mpm, function, status);
  if (before == MPS_OK && status != MPS_OK) mpm->run.broken = dashpots && mpm->partition;
  status = mpsi_mpm_find_near(mpm, function, status);
  bool cleared = false;
  status = mpsi_mpm_clear_bodies(mpm, function, status, &cleared);
  if (cleared) {
    status = mpsi_mpm_apply_edits(mpm, function);
    return status == MPS_OK ? prepare(mpm, function, status) : status;
  }
  if (status == MPS_OK) status = mpsi_mpm_find_forces(mpm, function);
  if (status == MPS_OK) status = mpsi_mpm_energy_begin(mpm, function);
  if (status == MPS_OK) status = mpsi_mpm_begin_balance(mpm, function);
  return status;
}

static void keep_and_gather(mps_mpm *mpm, int64_t b, int32_t worker) {
  if (mpm->undo.on) mpsi_mpm_keep_block(mpm, b);
  mpm->kernels->g2p[mpm->def.geometry][mpm->def.spline - 2](mpm, b, worker);
}

/* What happens between the nodes and the bodies in a step, on the way of its pass or by itself. */
typedef struct exchange {
  const char *function;
  mps_status status; /* of the search for touches, and then of all */
  double dt;
} exchange;

static bool find_masses(mps_mpm *mpm, void *data) {
  (void)data;
  mpsi_mpm_find_contact_mass(mpm);
  return true;
}

/* No particle moves before all depths are known. */
static bool solve_contacts(mps_mpm *mpm, void *data) {
  exchange *m = data;
  mpsi_mpm_fit_constraints(mpm);
  if (m->status == MPS_OK) m->status = mpsi_mpm_check_depth(mpm, m->function);
  if (mpm->partition) m->status = mpsi_mpm_exchange_contacts(mpm, m->function, m->status);
  if (m->status != MPS_OK) return false;
  mpsi_mpm_apply_impulses(mpm);
  if (mpm->partition) mpsi_mpm_end_contact_exchange(mpm);
  mpsi_mpm_begin_boundaries(mpm, m->dt);
  return true;
}

/* One thread can let the blocks near bodies give first, and then go over all in one wave. Springs
 * and areas of contact ask for nodes anywhere near a body. */
static bool can_meet_on_the_way(const mps_mpm *mpm) {
  bool can = !mpm->partition && mpsi_mpm_passes_alone(mpm) && mpm->contact.penalty_bodies == 0;
  for (int32_t b = 0; b < mpm->contact.bodies; b++)
    can = can && mpsi_by_impulses(mpm->contact.handle[b]) &&
          !mpsi_has_strength(mpm->contact.handle[b]);
  return can;
}

/* The nodes of all touches are to be updated before the bodies are met. */
static void wait_for_constraints(mps_mpm *mpm) {
  const mpsi_impulses *all = &mpm->contact.impulses;
  for (int64_t k = 0; k < all->block_count; k++)
    for (int q = 0; q < 1 << mpm->dim; q++)
      mpm->grid.nodes[mpm->grid.cells[all->block[k].cells].to[q]].waits = true;
}

/* From the particles to the nodes and back (pass.h), Nakamura 6 and Table 2:
 *   clear    the nodes of a block
 *   scatter  x, v, L, sigma, V, m --> mass, momentum, forces and contact at the nodes: p2g.c
 *            (23)-(25), (39), least_squares.c (28)-(30)
 *   update   velocities before and after the forces: node_update.c (26); the springs' normal forces:
 *            penalty_friction.c
 *   between  masses in contact with each free rough body
 *            then the impulses of contacts, where there are any: constraints.c, impulses.c
 *   finish   friction with bodies by springs: penalty_friction.c, contact/friction.c (31)-(34); walls, boxes
 *   gather   velocities of the nodes --> v, L, x (41)-(44); then the laws, L --> sigma, V and their
 *            histories (45)-(48), and c + |v| for the next step (49), (50): g2p.c, laws.c
 * `found`: what has become of the search for touches here, of which all ranks are told on the way.
 */
static mps_status move(mps_mpm *mpm, const char *function, double dt, mps_status found) {
  const bool contacts =
      mpm->contact.cell_pair_count > 0 || (mpm->partition && mpm->contact.bodies > 0);
  const int32_t geometry = mpm->def.geometry, spline = mpm->def.spline - 2;
  exchange shared = {function, found, dt};
  mpsi_pass pass = {.clear = mpsi_mpm_clear_nodes,
                    .scatter = mpm->contact.penalty_bodies > 0
                                   ? mpsi_mpm_scatter_penalty
                                   : mpm->kernels->p2g[geometry][spline],
                    .update = mpsi_mpm_update_nodes,
                    .between = mpm->contact.bodies > 0 && !mpm->partition ? find_masses : NULL,
                    .data = &shared};
  if (mpm->partition) {
    const mps_status status = mpsi_mpm_send_tiles(mpm, function);
    if (status != MPS_OK) return status;
    pass.scatter = mpsi_mpm_scatter_tile;
    pass.arrive = mpsi_mpm_receive_tiles;
  }
  if (contacts && can_meet_on_the_way(mpm)) {
    wait_for_constraints(mpm);
    pass.between = solve_contacts;
  } else if (contacts) {
    mpsi_mpm_run_pass(mpm, &pass);
    if (mpm->partition) mpsi_mpm_find_contact_mass(mpm); /* of all ranks */
    if (!solve_contacts(mpm, &shared)) return shared.status;
    pass = (mpsi_pass){.clear = NULL};
  } else {
    mpm->contact.impulses.warm_count = mpm->contact.impulses.sweeps = 0;
    mpm->contact.impulses.left = 0.0;
    mpsi_mpm_begin_boundaries(mpm, dt);
  }
  pass.finish = mpsi_mpm_finish_nodes;
  pass.gather = mpm->undo.on ? keep_and_gather : mpm->kernels->g2p[geometry][spline];
  mpsi_mpm_run_pass(mpm, &pass);
  return shared.status;
}

mps_status mpsi_mpm_take_step(mps_mpm *mpm, const char *function, double dt) {
  const bool goes_on = mpm->partition && mpsi_mpm_partition_unchanged(mpm);
  mps_status status = mpsi_mpm_evaluate_signals(mpm, function, dt, true);
  if (mpm->partition && mpsi_mpm_signals_may_refuse(mpm))
    status = mpsi_mpm_agree_in_step(mpm, function, status, 0, NULL);
  if (status != MPS_OK && !(mpm->partition && mpm->contact.bodies > 0)) return status;
  status = prepare(mpm, function, status); /* where ranks agree on the signals of bodies */
  if (status == MPS_OK) status = mpsi_mpm_prepare_undo(mpm, function);
  if (mpm->partition && !goes_on) status = mpsi_mpm_agree_before_step(mpm, function, status);
  if (status != MPS_OK) return status;
  mpm->run.dt = dt;
  warn_about_step(mpm, dt);
  status = mpsi_mpm_find_constraints(mpm, function);
  if (status != MPS_OK && !mpm->partition) return status;
  if (mpm->partition && mpm->contact.bodies > 0) mpsi_mpm_mark_contact_blocks(mpm);
  status = move(mpm, function, dt, status); /* particles --> nodes --> particles */
  if (status != MPS_OK) return status;
  mpsi_mpm_sum_boundaries(mpm);    /* impulses of nodes --> forces of walls */
  mpsi_mpm_drive_particles(mpm);   /* held particles: v, x */
  mpsi_mpm_find_impulse_loss(mpm); /* before means take the nodes' places */
  if (mpm->def.volumetric != MPS_MPM_VOLUMETRIC_POINT)
    mpsi_mpm_apply_laws_by_cell(mpm);             /* L, V --> sigma by means of cells */
  bool refused = mpm->laws.refusal.cells != NULL; /* by a law of the caller's */
  if (mpm->partition && mpm->undo.on &&
      (status = mpsi_mpm_any_rank(mpm, function, &refused)) != MPS_OK)
    return status;
  if (refused) {
    mpsi_mpm_undo(mpm);
    status = mpm->laws.refusal.cells ? report_refusal(mpm, function) : MPS_OK;
    return mpm->partition ? mpsi_domain_agree(mpm->partition->domain, function, status) : status;
  }
  if (mpm->contact.bodies > 0) mpsi_mpm_update_bodies(mpm); /* contact --> reactions, poses */
  mpsi_mpm_energy_end(mpm);
  mpm->run.moments = true;
  mpm->run.time += dt;
  mpm->run.steps++;
  status = mpsi_mpm_collect_block_results(mpm, function); /* bad particles, c + |v|, stale or not */
  if (!mpm->run.broken && !mpm->partition) mpsi_mpm_remove_leaving(mpm); /* through open sides */
  return status;
}
