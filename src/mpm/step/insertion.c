/* insertion.c - see insertion.h: what changes when the caller writes a field, adds or removes
 * particles between steps.
 *
 *   caller                      set                       solver
 *   mps_particles_append, fill  new ones, with places --> insert: inside the domain? volume, law
 *   edit, commit                density, volume       --> commit: mass of those that changed
 *   mps_particles_remove        closes the gaps       --> renew: columns, number
 *   step                                              --> all have a mass? sort, blocks, limit
 *
 * On several ranks each is given all that is added, and keeps what lies in its blocks (owners.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "insertion.h"

#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "mpm/water/water.h"

#include <string.h>

/* ---- fields ---------------------------------------------------------------------------------- */

bool mpsi_mpm_compares(const void *self, const char *field) {
  return strcmp(field, "density") == 0 || strcmp(field, "volume") == 0;
}

/* Whether steps read the field directly, so that an edit needs no update. */
static bool read_by_steps(const char *field) {
  return strcmp(field, "external_force") == 0 || strcmp(field, "body_acceleration") == 0;
}

/* Updates after an edit of a field, whose values the set has checked to be finite and in range.
 * Positions must be in the domain, and the particles are sorted again; the other fields change the
 * limit of the time step. */
mps_status mpsi_mpm_note_edit(void *self, const char *function, const char *field,
                              const double *former) {
  mps_mpm *mpm = self;
  const bool moved = strcmp(field, "position") == 0;
  mps_status status = MPS_OK;
  mpm->run.changed = true;
  if (read_by_steps(field)) return MPS_OK;
  if (moved)
    status = mpsi_mpm_check_places(mpm->context, &mpm->grid, &mpm->p, &mpm->def, function, 0,
                                   mpm->p.count);
  if (status == MPS_OK && former)
    status = mpsi_mpm_renew_masses(mpm->context, &mpm->grid, &mpm->p, &mpm->contact, function,
                                   field, former);
  if (status != MPS_OK) return status;
  mpm->run.edited = true;
  mpm->run.stale = mpm->run.stale || moved;
  if (strcmp(field, "velocity_gradient") == 0) mpm->run.moments = false;
  /* gradients and means belong to the former pressures */
  if (mpm->water && strcmp(field, "pore_pressure") == 0) {
    for (int c = 0; c < mpm->grid.dim; c++)
      memset(mpm->p.g[c], 0, (size_t)mpm->p.count * sizeof *mpm->p.g[c]);
    mpsi_pore_begin_means(&mpm->p);
  }
  return MPS_OK;
}

/* ---- particles ------------------------------------------------------------------------------- */

bool mpsi_mpm_hold_room(void *self, int64_t particles) {
  mps_mpm *mpm = self;
  return mpsi_mpm_make_room(mpm->context, &mpm->grid, &mpm->p, &mpm->rooms, particles);
}

static mps_status add_particles(mps_mpm *mpm, const char *function, int64_t first, int64_t count) {
  MPSI_TRY(mpsi_mpm_usable(mpm, function));
  if (first + count > MPSI_MPM_MOST_PARTICLES)
    return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                     "%lld particles to add to %lld, a WLS-MPM solver has at most %d",
                     (long long)count, (long long)first, MPSI_MPM_MOST_PARTICLES);
  if (!mpsi_mpm_hold_room(mpm, first + count))
    return mpsi_fail_memory(mpm->context, function,
                            (size_t)(first + count) * 2 * sizeof *mpm->grid.radix);
  mpsi_mpm_bind(&mpm->grid, &mpm->p, mpm->water);
  mps_status status = mpsi_mpm_check_places(mpm->context, &mpm->grid, &mpm->p, &mpm->def, function,
                                            first, first + count);
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    status = mpsi_mpm_check_inside(mpm->context, &mpm->grid, &mpm->p, function,
                                   mpm->contact.handle[b], first);
  if (status == MPS_OK)
    status =
        mpsi_mpm_check_states(mpm->context, &mpm->grid, &mpm->p, function, 0, first, first + count);
  const mpsi_amount amount = {mpm->grid.measure,
                              mpm->grid.geometry == MPS_MPM_GEOMETRY_AXISYMMETRIC};
  if (status == MPS_OK)
    status = mpsi_particles_check_crowding(mpm->p.set, function, first, &amount);
  for (int64_t k = first; k < first + count && status == MPS_OK; k++) {
    mpm->p.V[k] = mpsi_mpm_lattice_volume(&mpm->grid, &mpm->p, k);
    if (mpm->water) mpm->p.slow[k] = mpm->p.u[k];
    mpsi_mpm_begin_law(&mpm->grid, &mpm->p, &mpm->p.laws.law[0], k);
  }
  return status;
}

mps_status mpsi_mpm_insert(void *self, const char *function, int64_t first, int64_t count) {
  mps_mpm *mpm = self;
  const mps_status status = add_particles(mpm, function, first, count);
  if (!mpm->partition) return status;
  const mpsi_rank_part part = mpsi_rank_part_of(mpm);
  return mpsi_mpm_keep_own_inserted(&part, function, status, first);
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

/* ---- ranks ----------------------------------------------------------------------------------- */

int64_t mpsi_mpm_row_runs(const void *self, mpsi_row_run *out) {
  const mps_mpm *mpm = self;
  return mpsi_mpm_list_rows(&mpm->grid, &mpm->p, out);
}

void mpsi_mpm_thin_out(void *self, const uint8_t *gone) {
  mps_mpm *mpm = self;
  mpsi_mpm_close_gaps(&mpm->grid, gone);
  mpm->run.edited = mpm->run.stale = true;
}

mps_status mpsi_mpm_agree_on_insertion(void *self, const char *function, mps_status status,
                                       int64_t first) {
  mps_mpm *mpm = self;
  return mpsi_mpm_compare_added(&mpm->grid, &mpm->p, mpm->partition, function, status, first);
}

mps_status mpsi_mpm_find_removed(void *self, const char *function, mps_status status, int64_t count,
                                 const int64_t *ids, int64_t known, int64_t *all) {
  mps_mpm *mpm = self;
  return mpsi_mpm_count_listed(mpm->context, mpm->partition, function, status, count, ids, known,
                               all);
}
