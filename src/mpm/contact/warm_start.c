/* warm_start.c - impulses of the last step, from which the sweeps start, and rest gaps, by particle
 * and body. On several ranks each has, after a step, those of its own particles and of its contact
 * partners' (partners.h). SPDX-License-Identifier: BSD-3-Clause */
#include "exchange.h"
#include "mpm/ranks/partition.h"

#include "core/base/room_array.h"
#include "pairs.h"

#include "core/particles/particles_internal.h"
#include "domain/domain_internal.h"

#include <stdlib.h>
#include <string.h>

static uint64_t slot_of(const mpsi_impulses *all, int64_t id, int64_t body) {
  const uint64_t key = ((uint64_t)id * 64u + (uint64_t)body) * UINT64_C(0x9E3779B97F4A7C15);
  return (key >> 20) & all->lookup_mask;
}

/* Hash table with at least twice as many slots as impulses. */
bool mpsi_mpm_index_impulses(mps_context *context, mpsi_contacts *contacts) {
  mpsi_impulses *all = &contacts->impulses;
  int64_t slots = 16;
  while (slots < 2 * all->warm_count) slots *= 2;
  if (!MPSI_ENSURE(context, all, lookup, slots)) return false;
  all->lookup = all->lookup_room.item;
  all->lookup_mask = (uint64_t)slots - 1;
  for (int64_t k = 0; k < slots; k++) all->lookup[k] = -1;
  for (int64_t k = 0; k < all->warm_count; k++) {
    uint64_t at = slot_of(all, all->warm[k].id, all->warm[k].body);
    while (all->lookup[at] >= 0) at = (at + 1) & all->lookup_mask;
    all->lookup[at] = (int32_t)k;
  }
  return true;
}

const mpsi_warm_impulse *mpsi_mpm_warm_impulse(const mpsi_contacts *contacts, int64_t id,
                                               int32_t body, int32_t point) {
  const mpsi_impulses *all = &contacts->impulses;
  for (uint64_t at = slot_of(all, id, body); all->lookup[at] >= 0;
       at = (at + 1) & all->lookup_mask) {
    const mpsi_warm_impulse *warm = &all->warm[all->lookup[at]];
    if (warm->id == id && warm->body == body && warm->point == point) return warm;
  }
  return NULL;
}

void mpsi_mpm_forget_impulses(mpsi_contacts *contacts, int32_t body) {
  mpsi_impulses *all = &contacts->impulses;
  int64_t to = 0;
  for (int64_t k = 0; k < all->warm_count; k++) {
    mpsi_warm_impulse warm = all->warm[k];
    if (warm.body == body) continue;
    warm.body -= warm.body > body;
    all->warm[to++] = warm;
  }
  all->warm_count = to;
}

/* ---- several ranks --------------------------------------------------------------------------- */

/* Keeps the impulses of this rank's particles; returns their number. */
static int64_t keep_local(mpsi_impulses *all, const mps_particles *particles) {
  int64_t count = 0;
  for (int64_t k = 0; k < all->warm_count; k++)
    if (mps_particles_index(particles, all->warm[k].id) >= 0) all->warm[count++] = all->warm[k];
  return all->warm_count = count;
}

static mps_status append_received(mpsi_impulses *all, const char *function,
                                  const mpsi_mailbox *box) {
  const int64_t size = (int64_t)sizeof *all->warm;
  int64_t count = all->warm_count;
  for (int32_t k = 0; k < box->count; k++) count += box->mail[k].bytes / size;
  if (count > all->warm_room.capacity) {
    if (!mpsi_grow(box->context, &all->warm_room.item, all->warm_count, count, sizeof *all->warm))
      return mpsi_fail_memory(box->context, function, (size_t)(count * size));
    all->warm_room.capacity = count;
    all->warm = all->warm_room.item;
  }
  for (int32_t k = 0; k < box->count; k++) {
    memcpy(all->warm + all->warm_count, box->mail[k].data, (size_t)box->mail[k].bytes);
    all->warm_count += box->mail[k].bytes / size;
  }
  return MPS_OK;
}

mps_status mpsi_mpm_share_warm_start(mpsi_impulses *all, const mps_particles *particles,
                                     mps_domain *domain, const char *function, mps_status status) {
  mps_context *context = mpsi_particles_context(particles);
  const int32_t ranks = mps_domain_size(domain), rank = mps_domain_rank(domain);
  mpsi_mailbox box = {.context = context};
  double any = (double)keep_local(all, particles);
  mps_domain_message *list = mpsi_alloc(context, ranks, sizeof *list);
  if (!list && status == MPS_OK)
    status = mpsi_fail_memory(context, function, (size_t)ranks * sizeof *list);
  status = mpsi_domain_agree_max(domain, function, status, 1, &any);
  if (status == MPS_OK && any > 0.0) {
    const int64_t bytes = all->warm_count * (int64_t)sizeof *all->warm;
    int32_t count = 0;
    for (int32_t r = 0; r < ranks && bytes > 0; r++)
      if (r != rank)
        list[count++] = (mps_domain_message){.rank = r, .bytes = bytes, .data = all->warm};
    status = mpsi_domain_exchange(domain, function, count, list, &box);
    if (status == MPS_OK)
      status = mpsi_domain_agree(domain, function, append_received(all, function, &box));
  }
  mpsi_domain_free_mail(&box);
  mpsi_free(context, list);
  return status;
}

static int by_owner(const void *left, const void *right) {
  const mpsi_warm_impulse *a = left, *b = right;
  if (a->id != b->id) return a->id < b->id ? -1 : 1;
  if (a->body != b->body) return a->body < b->body ? -1 : 1;
  return (a->point > b->point) - (a->point < b->point);
}

void mpsi_mpm_order_warm_start(mpsi_impulses *all) {
  if (all->warm_count > 1) qsort(all->warm, (size_t)all->warm_count, sizeof *all->warm, by_owner);
}
