/* block_results.c - results of the blocks of a step, on this rank and all others: the largest
 * speed, and a particle that ends the step. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/contact/sweeps.h"

#include "core/particles/particles_internal.h"

/* Reports the particle that ends the step; `what` is wrong with it. */
static mps_status report_bad(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_run *run, const char *function, int64_t k,
                             const char *what) {
  const long long id = (long long)mpsi_particles_integers(p->set, "id")[k];
  const bool space = grid->dim == 3;
  const double z = space ? p->x[2][k] : 0.0, vz = space ? p->v[2][k] : 0.0;
  const mps_status status = mpsi_fail(
      context, function, MPS_ERROR_DIVERGED,
      "step %lld, t = %.6g s: particle %lld at (%.6g, %.6g, %.6g) m with velocity (%.4g, %.4g, "
      "%.4g) m/s and volume %.4g m3 %s; dt was %.4g s, %.3g of the Courant limit: check dt, the "
      "contact stiffness and the initial stress",
      (long long)run->steps, run->time, id, p->x[0][k], p->x[1][k], z, p->v[0][k], p->v[1][k], vz,
      p->V[k], what, run->dt, run->dt * run->speed * grid->inverse);
  mpsi_fail_where(context, run->steps, id);
  return status;
}

/* Reduces the results over all ranks. An error of one is that of all. */
static mps_status collect_ranks(mps_mpm *mpm, const char *function, double speed, double flow,
                                int64_t bad, int64_t lost) {
  mpsi_partition *partition = mpm->partition;
  enum { SPEED, STALE, BAD, LOST, EDITED, CANCEL, CHANGED, IMPULSES, FLOW, FOUND };
  double most[MPSI_SWEEP_SUMS];
  mpsi_mpm_sweep_sums(&mpm->contact, most);
  mps_status own = MPS_OK, status = partition->lost;
  if (bad >= 0)
    own = report_bad(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function, bad,
                     "is not finite, is beyond 1e100 m/s or has no volume");
  else if (lost >= 0)
    own = report_bad(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function, lost,
                     "has left the domain");
  if (bad < 0)
    mpsi_mpm_remove_leaving(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->energy, &mpm->rooms);
  double found[FOUND] = {speed,
                         mpm->run.stale,
                         bad >= 0,
                         lost >= 0,
                         mpm->run.edited,
                         mpsi_cancelled(mpm->context),
                         most[MPSI_SWEEP_CHANGED],
                         most[MPSI_SWEEP_IMPULSES],
                         flow};
  status = mpsi_domain_agree_max(partition->domain, function, status, FOUND, found);
  mpm->run.broken = status != MPS_OK || found[BAD] > 0.0;
  if (status != MPS_OK) return status;
  mpm->run.stale = found[STALE] > 0.0;
  mpm->run.edited = found[EDITED] > 0.0;
  partition->cancel = found[CANCEL] > 0.0;
  mpm->contact.impulses.left = mpsi_mpm_relative_change(found + CHANGED);
  if (!mpm->run.broken) mpm->run.speed = found[SPEED], mpm->run.flow = found[FLOW];
  mpm->run.lost = mpm->run.lost || (!mpm->run.broken && found[LOST] > 0.0);
  if (mpm->run.lost) mpm->run.stale = true;
  if (!mpm->run.broken && found[LOST] == 0.0) return MPS_OK;
  if (mpm->run.broken && bad < 0) own = MPS_OK; /* another rank reports a broken particle */
  return mpsi_domain_agree(partition->domain, function, own);
}

mps_status mpsi_mpm_collect_block_results(mps_mpm *mpm, const char *function) {
  double speed = 0.0, flow = 0.0;
  int64_t bad = -1, lost = -1;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    int64_t *which = cells->lost ? &lost : &bad;
    if (cells->bad >= 0 && *which < 0) *which = cells->bad;
    if (cells->left) mpm->run.stale = true;
    if (cells->speed > speed) speed = cells->speed;
    if (cells->flow > flow) flow = cells->flow;
  }
  if (mpm->partition) return collect_ranks(mpm, function, speed, flow, bad, lost);
  mpm->run.broken = bad >= 0;
  if (bad >= 0)
    return report_bad(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function, bad,
                      "is not finite, is beyond 1e100 m/s or has no volume");
  mpm->run.speed = speed;
  mpm->run.flow = flow;
  if (lost < 0) return MPS_OK;
  mpm->run.lost = mpm->run.stale = true;
  return report_bad(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function, lost,
                    "has left the domain");
}
