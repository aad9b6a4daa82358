/* block_results.c - results of the blocks of a step, on this rank and all others: the largest
 * speed, and a particle that ends the step. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"
#include "mpm/water/water.h"

#include "core/particles/particles_internal.h"

#define NOT_FINITE "is not finite, is beyond 1e100 m/s or has no volume"

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

mps_status mpsi_mpm_report_undone(mps_mpm *mpm, const char *function) {
  int64_t bad = -1;
  char what[256];
  for (int64_t b = 0; b < mpm->grid.cell_count && bad < 0; b++)
    if (!mpm->grid.cells[b].lost) bad = mpm->grid.cells[b].bad;
  const bool fast = bad < 0 && mpm->bound.beyond >= 0;
  if (fast) bad = mpm->bound.beyond;
  if (bad < 0) return MPS_OK; /* that of another rank */
  if (fast) mpsi_bound_describe(mpm, what, sizeof what);
  const bool described = fast || mpsi_pore_describe(mpm, bad, what, sizeof what);
  return report_bad(mpm->context, &mpm->grid, &mpm->p, &mpm->run, function, bad,
                    described ? what : NOT_FINITE);
}

/* The first bad and the first lost particle of this rank, or -1; its largest speeds (m/s). */
static void read_blocks(mps_mpm *mpm, int64_t *bad, int64_t *lost, double *speed, double *flow,
                        double *wave) {
  *bad = *lost = -1;
  *speed = *flow = *wave = 0.0;
  for (int64_t b = 0; b < mpm->grid.cell_count; b++) {
    const mpsi_cell_block *cells = &mpm->grid.cells[b];
    int64_t *which = cells->lost ? lost : bad;
    if (cells->bad >= 0 && *which < 0) *which = cells->bad;
    if (cells->left) mpm->run.stale = true;
    if (cells->speed > *speed) *speed = cells->speed;
    if (cells->flow > *flow) *flow = cells->flow;
    if (cells->wave > *wave) *wave = cells->wave;
  }
}

/* On several ranks an error of one is that of all; particles leave before ranks compare. */
mps_status mpsi_mpm_collect_block_results(mps_mpm *mpm, const char *function) {
  mpsi_partition *partition = mpm->partition;
  mpsi_run *run = &mpm->run;
  enum { SPEED, STALE, BAD, LOST, EDITED, CANCEL, CHANGED, IMPULSES, FLOW, WAVE, FASTEST, FOUND };
  _Static_assert(FOUND <= MPSI_DOMAIN_ALONG, "values of one message");
  int64_t bad, lost;
  double speed, flow, wave, most[MPSI_SWEEP_SUMS];
  mps_status own = MPS_OK, status = MPS_OK;
  read_blocks(mpm, &bad, &lost, &speed, &flow, &wave);
  char what[256];
  if (bad >= 0 || lost >= 0)
    own = report_bad(mpm->context, &mpm->grid, &mpm->p, run, function, bad >= 0 ? bad : lost,
                     bad < 0                                           ? "has left the domain"
                     : mpsi_pore_describe(mpm, bad, what, sizeof what) ? what
                                                                       : NOT_FINITE);
  if (bad < 0)
    mpsi_mpm_remove_leaving(&mpm->grid, &mpm->p, &mpm->boundaries, &mpm->energy, &mpm->rooms);
  mpsi_mpm_sweep_sums(&mpm->contact, most);
  double found[FOUND] = {speed,
                         run->stale,
                         bad >= 0,
                         lost >= 0,
                         run->edited,
                         partition && mpsi_cancelled(mpm->context),
                         most[MPSI_SWEEP_CHANGED],
                         most[MPSI_SWEEP_IMPULSES],
                         flow,
                         wave,
                         mpsi_bound_fastest(mpm)};
  if (partition)
    status = mpsi_domain_agree_max(partition->domain, function, partition->lost, FOUND, found);
  run->broken = status != MPS_OK || found[BAD] > 0.0;
  if (status != MPS_OK) return status;
  run->stale = found[STALE] > 0.0;
  run->edited = found[EDITED] > 0.0;
  if (partition) {
    partition->cancel = found[CANCEL] > 0.0;
    mpm->contact.impulses.left = mpsi_mpm_relative_change(found + CHANGED);
  }
  if (!run->broken) run->speed = found[SPEED], run->flow = found[FLOW], run->wave = found[WAVE];
  mpm->bound.fastest = found[FASTEST];
  run->lost = run->lost || (!run->broken && found[LOST] > 0.0);
  if (run->lost) run->stale = true;
  if (!run->broken && found[LOST] == 0.0) return MPS_OK;
  if (run->broken && bad < 0) own = MPS_OK; /* another rank reports a broken particle */
  return mpsi_mpm_agree(partition, function, own);
}
