/* removal.c - bodies that take away the particles which they find inside: when the contact is made,
 * and before each step those that lie deeper than its depth.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/mpm_solver.h"

#include <string.h>

static bool takes_away(const mps_contact *contact) {
  return contact->def.inside == MPS_CONTACT_INSIDE_REMOVE;
}

bool mpsi_mpm_some_take_away(const mpsi_contacts *all) {
  bool any = false;
  for (int32_t b = 0; b < all->bodies; b++) any = any || takes_away(all->handle[b]);
  return any;
}

static double *place_of(const mps_mpm *mpm, int64_t k, double *x) {
  for (int c = 0; c < 3; c++) x[c] = c < mpm->dim ? mpm->p.x[c][k] : 0.0;
  return x;
}

/* Marks particles [begin, end) that lie deeper than `depth` below the surface. */
static int64_t into_body(const mps_mpm *mpm, const mps_contact *contact, double depth,
                         int64_t begin, int64_t end, uint8_t *gone, uint8_t mark) {
  int64_t count = 0;
  for (int64_t k = begin; k < end; k++) {
    double x[3];
    if (gone[k] || !mpsi_body_reaches(contact->body, place_of(mpm, k, x), 0.0)) continue;
    if (!(mpsi_body_foot(contact->body, x).distance < -depth)) continue;
    gone[k] = mark;
    count++;
  }
  return count;
}

/* What the body has taken away, on all ranks. */
static mps_status count_out(mps_mpm *mpm, const char *function, mps_contact *contact,
                            const uint8_t *gone, uint8_t mark) {
  mpsi_exact mass[MPS_BODY_MAX_PARTS];
  int64_t count[MPS_BODY_MAX_PARTS] = {0};
  const int32_t parts = contact->body->parts;
  mps_status status = MPS_OK;
  memset(mass, 0, sizeof mass);
  for (int64_t k = 0; k < mpm->p.count; k++) {
    double x[3];
    if (gone[k] != mark) continue;
    const mpsi_foot foot = mpsi_body_foot(contact->body, place_of(mpm, k, x));
    const int32_t part = contact->body->part_of[foot.face];
    mpsi_exact_add(&mass[part], mpm->p.m[k]);
    count[part]++;
  }
  if (mpm->partition) status = mpsi_domain_sum(mpm->partition->domain, function, parts, count);
  if (mpm->partition && status == MPS_OK)
    status = mpsi_domain_sum_exact(mpm->partition->domain, function, parts, mass);
  for (int32_t part = 0; status == MPS_OK && part < parts; part++) {
    contact->source.reaction[part].removed += count[part];
    contact->source.reaction[part].removed_mass += mpsi_exact_value(&mass[part]);
  }
  return status;
}

/* Marks of particles in bodies: the number of the contact and 1. */
static int64_t mark_inside(mps_mpm *mpm) {
  uint8_t *gone = mpm->rooms.gone.item;
  int64_t count = 0;
  if (mpm->p.count > 0) memset(gone, 0, (size_t)mpm->p.count);
  for (int64_t t = 0; t < mpm->contact.cell_pair_count; t++) {
    const mpsi_cell_pair *pair = &mpm->contact.cell_pair[t];
    const mps_contact *contact = mpm->contact.handle[pair->body];
    const mpsi_cell_block *cells = &mpm->grid.cells[pair->cells];
    if (!takes_away(contact)) continue;
    count += into_body(mpm, contact, contact->def.depth, cells->begin, cells->end, gone,
                       (uint8_t)(pair->body + 1));
  }
  return count;
}

mps_status mpsi_mpm_clear_bodies(mps_mpm *mpm, const char *function, mps_status status,
                                 bool *cleared) {
  if (!mpsi_mpm_some_take_away(&mpm->contact)) return status;
  const int64_t count = status == MPS_OK ? mark_inside(mpm) : 0;
  double any = (double)count;
  if (mpm->partition)
    status = mpsi_domain_agree_max(mpm->partition->domain, function, status, 1, &any);
  if (status != MPS_OK || any == 0.0) return status;
  for (int32_t b = 0; b < mpm->contact.bodies && status == MPS_OK; b++)
    if (takes_away(mpm->contact.handle[b]))
      status =
          count_out(mpm, function, mpm->contact.handle[b], mpm->rooms.gone.item, (uint8_t)(b + 1));
  if (status == MPS_OK && count > 0) mpsi_particles_take_out(mpm->particles, mpm->rooms.gone.item);
  *cleared = status == MPS_OK;
  return status;
}

mps_status mpsi_mpm_clear_body(mps_mpm *mpm, const char *function, mps_contact *contact) {
  if (!takes_away(contact)) return MPS_OK;
  uint8_t *gone = mpsi_alloc(mpm->context, mpm->p.count, 1);
  mps_status status = MPS_OK;
  if (!gone) status = mpsi_fail_memory(mpm->context, function, (size_t)mpm->p.count);
  status = mpsi_mpm_agree(mpm, function, status);
  int64_t count = 0;
  if (status == MPS_OK) {
    count = into_body(mpm, contact, 0.0, 0, mpm->p.count, gone, 1);
    status = count_out(mpm, function, contact, gone, 1);
  }
  if (status == MPS_OK && count > 0) mpsi_particles_take_out(mpm->particles, gone);
  mpsi_free(mpm->context, gone);
  return status;
}
