/* removal.c - bodies that remove particles from their inside: when the contact is made, and before
 * each step those deeper than the contact's `depth`. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/contact/pairs.h"
#include "mpm/particles/rooms.h"
#include "mpm/ranks/partition.h"

#include <string.h>

enum { REMOVED = 1, REMOVED_BY_THIS }; /* marks of particles */

static bool removes_particles(const mps_contact *contact) {
  return contact->def.inside == MPS_CONTACT_INSIDE_REMOVE;
}

bool mpsi_mpm_any_body_removes(const mpsi_contacts *all) {
  bool any = false;
  for (int32_t b = 0; b < all->bodies; b++) any = any || removes_particles(all->handle[b]);
  return any;
}

static double *place_of(const mpsi_grid *grid, const mpsi_columns *p, int64_t k, double *x) {
  for (int c = 0; c < 3; c++) x[c] = c < grid->dim ? p->x[c][k] : 0.0;
  return x;
}

/* Marks particles [begin, end) that lie deeper than `depth` (m) below the surface; returns their
 * number. */
static int64_t mark_deeper(const mpsi_grid *grid, const mpsi_columns *p, const mps_contact *contact,
                           double depth, int64_t begin, int64_t end, uint8_t *gone, uint8_t mark) {
  int64_t count = 0;
  for (int64_t k = begin; k < end; k++) {
    double x[3];
    if (gone[k] || !mpsi_body_reaches(contact->body, place_of(grid, p, k, x), 0.0)) continue;
    if (!(mpsi_body_foot(contact->body, x).distance < -depth)) continue;
    gone[k] = mark;
    count++;
  }
  return count;
}

enum { MASS, COUNT, AMOUNTS };
typedef mpsi_exact amounts[AMOUNTS];

/* Adds number and mass of the particles that a body removes on all ranks to its reactions. */
static mps_status add_removed(const mpsi_contact_setup *setup, const char *function,
                              mps_contact *contact, const uint8_t *gone, uint8_t mark) {
  const mpsi_columns *p = setup->p;
  amounts *sum = setup->contact->sum_room.item;
  const int32_t parts = contact->body->parts;
  mps_status status = MPS_OK;
  memset(sum, 0, (size_t)parts * sizeof *sum);
  for (int64_t k = 0; k < p->count; k++) {
    double x[3];
    if (gone[k] != mark) continue;
    const mpsi_foot foot = mpsi_body_foot(contact->body, place_of(setup->grid, p, k, x));
    const int32_t part = contact->body->part_of[foot.face];
    mpsi_exact_add(&sum[part][MASS], p->m[k]);
    mpsi_exact_add(&sum[part][COUNT], 1.0);
  }
  if (setup->partition)
    status = mpsi_domain_sum_exact(setup->partition->domain, function, parts * AMOUNTS, sum[0]);
  for (int32_t part = 0; status == MPS_OK && part < parts; part++) {
    mps_reaction *r = &contact->source.reaction[part];
    r->removed += (int64_t)mpsi_exact_value(&sum[part][COUNT]);
    r->removed_mass += mpsi_exact_value(&sum[part][MASS]);
  }
  return status;
}

/* Memory for the sums of a contact, which the solver need not have yet. */
static mps_status ensure_amounts(mps_context *context, mpsi_contacts *contacts,
                                 const char *function, const mps_contact *contact) {
  const int32_t parts = contact->body->parts;
  return mpsi_room_ensure(context, &contacts->sum_room, parts, sizeof(amounts))
             ? MPS_OK
             : mpsi_fail_memory(context, function, (size_t)parts * sizeof(amounts));
}

/* Marks particles in the body that no earlier body has marked; returns their number. */
static int64_t mark_inside(const mpsi_grid *grid, const mpsi_columns *p,
                           const mpsi_contacts *contacts, const mpsi_rooms *rooms, int32_t body,
                           uint8_t mark) {
  const mps_contact *contact = contacts->handle[body];
  int64_t count = 0;
  for (int64_t t = 0; t < contacts->cell_pair_count; t++) {
    const mpsi_cell_pair *pair = &contacts->cell_pair[t];
    const mpsi_cell_block *cells = &grid->cells[pair->cells];
    if (pair->body == body)
      count += mark_deeper(grid, p, contact, contact->def.depth, cells->begin, cells->end,
                           rooms->gone.item, mark);
  }
  return count;
}

/* Marks the particles in all bodies that remove them, with one mark; returns their number. */
static int64_t mark_all(const mpsi_grid *grid, const mpsi_columns *p, const mpsi_contacts *contacts,
                        const mpsi_rooms *rooms) {
  int64_t count = 0;
  if (p->count > 0) memset(rooms->gone.item, 0, (size_t)p->count);
  for (int32_t b = 0; b < contacts->bodies; b++)
    if (removes_particles(contacts->handle[b]))
      count += mark_inside(grid, p, contacts, rooms, b, REMOVED);
  return count;
}

/* Adds what each body removes, on all ranks, to its reactions; where bodies overlap the first
 * removes. */
static mps_status add_removed_by_body(const mpsi_contact_setup *setup, const char *function) {
  const mpsi_contacts *contacts = setup->contact;
  const int64_t particles = setup->p->count;
  uint8_t *gone = setup->rooms->gone.item;
  mps_status status = MPS_OK;
  if (particles > 0) memset(gone, 0, (size_t)particles);
  for (int32_t b = 0; b < contacts->bodies && status == MPS_OK; b++) {
    if (!removes_particles(contacts->handle[b])) continue;
    mark_inside(setup->grid, setup->p, contacts, setup->rooms, b, REMOVED_BY_THIS);
    status = add_removed(setup, function, contacts->handle[b], gone, REMOVED_BY_THIS);
    for (int64_t k = 0; k < particles; k++)
      if (gone[k]) gone[k] = REMOVED;
  }
  return status;
}

mps_status mpsi_mpm_clear_bodies(const mpsi_contact_setup *setup, const char *function,
                                 mps_status status, bool *cleared) {
  if (!mpsi_mpm_any_body_removes(setup->contact)) return status;
  for (int32_t b = 0; b < setup->contact->bodies && status == MPS_OK; b++)
    status = ensure_amounts(setup->context, setup->contact, function, setup->contact->handle[b]);
  const int64_t count =
      status == MPS_OK ? mark_all(setup->grid, setup->p, setup->contact, setup->rooms) : 0;
  double any = (double)count;
  if (setup->partition)
    status = mpsi_domain_agree_max(setup->partition->domain, function, status, 1, &any);
  if (status != MPS_OK || any == 0.0) return status;
  status = add_removed_by_body(setup, function);
  if (status == MPS_OK && count > 0)
    mpsi_particles_take_out(setup->p->set, setup->rooms->gone.item);
  *cleared = status == MPS_OK;
  return status;
}

mps_status mpsi_mpm_clear_body(const mpsi_contact_setup *setup, const char *function,
                               mps_contact *contact) {
  if (!removes_particles(contact)) return MPS_OK;
  const mpsi_columns *p = setup->p;
  uint8_t *gone = mpsi_alloc(setup->context, p->count, 1);
  mps_status status = MPS_OK;
  if (!gone) status = mpsi_fail_memory(setup->context, function, (size_t)p->count);
  if (status == MPS_OK) status = ensure_amounts(setup->context, setup->contact, function, contact);
  status = mpsi_mpm_agree(setup->partition, function, status);
  int64_t count = 0;
  if (status == MPS_OK) {
    count = mark_deeper(setup->grid, p, contact, 0.0, 0, p->count, gone, REMOVED);
    status = add_removed(setup, function, contact, gone, REMOVED);
  }
  if (status == MPS_OK && count > 0) mpsi_particles_take_out(p->set, gone);
  mpsi_free(setup->context, gone);
  return status;
}
