/* insertion.c - particles that the caller adds and removes between steps.
 *
 *   caller                      set                       solver
 *   mps_particles_append, fill  new ones, with places --> insert: inside the domain? volume, law
 *   edit, commit                density, volume       --> commit: mass of those that changed
 *   mps_particles_remove        closes the gaps       --> renew: columns, number
 *   step                                              --> all have a mass? sort, blocks, limit
 *
 * On several ranks each is given all that is added, and keeps what lies in its blocks (owners.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/particles/mpm_particles.h"

static mps_status add_particles(mps_mpm *mpm, const char *function, int64_t first, int64_t count) {
  mps_status status = mpsi_mpm_usable(mpm, function);
  if (status != MPS_OK) return status;
  if (first + count > MPSI_MPM_MOST_PARTICLES)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "%lld particles to add to %lld, a WLS-MPM solver has at most %d",
                     (long long)count, (long long)first, MPSI_MPM_MOST_PARTICLES);
  if (!mpsi_mpm_make_room(mpm, first + count))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(first + count) * 2 * sizeof *mpm->grid.radix);
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
  status = mpsi_mpm_check_places(mpm->context, &mpm->grid, &mpm->p, &mpm->def, function, first,
                                 first + count);
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    status = mpsi_mpm_check_inside(mpm->context, &mpm->grid, &mpm->p, function,
                                   mpm->contact.handle[b], first);
  if (status == MPS_OK)
    status =
        mpsi_mpm_check_states(mpm->context, &mpm->grid, &mpm->p, function, first, first + count);
  for (int64_t k = first; k < first + count && status == MPS_OK; k++) {
    mpm->p.V[k] = mpsi_mpm_lattice_volume(&mpm->grid, &mpm->p, k);
    mpsi_mpm_begin_law(&mpm->grid, &mpm->p, &mpm->p.laws.law[0], k);
  }
  return status;
}

mps_status mpsi_mpm_insert(void *self, const char *function, int64_t first, int64_t count) {
  mps_mpm *mpm = self;
  const mps_status status = add_particles(mpm, function, first, count);
  return mpm->partition ? mpsi_mpm_keep_own_inserted(mpm->context, &mpm->grid, &mpm->p, mpm->water,
                                                     mpm->partition, function, status, first)
                        : status;
}

mps_status mpsi_mpm_remove(void *self, const char *function, int64_t count, const int64_t *ids) {
  (void)count, (void)ids; /* lists of ids skip removed particles */
  mps_mpm *mpm = self;
  return mpsi_mpm_agree(mpm->partition, function, mpsi_mpm_usable(mpm, function));
}

void mpsi_mpm_renew(void *self) {
  mps_mpm *mpm = self;
  const mpsi_grid *grid = &mpm->grid;
  const int64_t sorted = grid->cell_count > 0 ? grid->cells[grid->cell_count - 1].end : 0;
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
  if (mpm->p.count == sorted && !mpm->run.edited) return; /* another holder has refused */
  mpm->run.edited = mpm->run.stale = true;
}
