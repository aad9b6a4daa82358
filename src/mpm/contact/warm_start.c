/* warm_start.c - the impulses of the last step, with which contacts begin the next one, on several ranks:
 * after a step each rank has those of its own particles and of its mates' (partners.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/solver.h"

#include <stdlib.h>
#include <string.h>

/* Those of particles that are here; returns how many. */
static int64_t keep_own(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  int64_t count = 0;
  for (int64_t k = 0; k < all->kept_count; k++)
    if (mps_particles_index(mpm->particles, all->kept[k].id) >= 0)
      all->kept[count++] = all->kept[k];
  return all->kept_count = count;
}

static mps_status take(mps_mpm *mpm, const char *function, const mpsi_mailbox *box) {
  mpsi_impulses *all = &mpm->contact.impulses;
  const int64_t size = (int64_t)sizeof *all->kept;
  int64_t count = all->kept_count;
  for (int32_t k = 0; k < box->count; k++) count += box->mail[k].bytes / size;
  if (count > all->kept_room.capacity) {
    if (!mpsi_grow(mpm->context, &all->kept_room.item, all->kept_count, count, sizeof *all->kept))
      return mpsi_fail_memory(mpm->context, function, (size_t)(count * size));
    all->kept_room.capacity = count;
    all->kept = all->kept_room.item;
  }
  for (int32_t k = 0; k < box->count; k++) {
    memcpy(all->kept + all->kept_count, box->mail[k].data, (size_t)box->mail[k].bytes);
    all->kept_count += box->mail[k].bytes / size;
  }
  return MPS_OK;
}

mps_status mpsi_mpm_share_kept(mps_mpm *mpm, const char *function, mps_status status) {
  if (mpm->contact.bodies == 0) return status;
  mps_domain *domain = mpm->share->domain;
  const int32_t ranks = mps_domain_size(domain), rank = mps_domain_rank(domain);
  mpsi_mailbox box = {.context = mpm->context};
  double any = (double)keep_own(mpm);
  mps_domain_message *list = mpsi_alloc(mpm->context, ranks, sizeof *list);
  if (!list && status == MPS_OK)
    status = mpsi_fail_memory(mpm->context, function, (size_t)ranks * sizeof *list);
  status = mpsi_domain_settle_max(domain, function, status, 1, &any);
  if (status == MPS_OK && any > 0.0) {
    const mpsi_impulses *all = &mpm->contact.impulses;
    const int64_t bytes = all->kept_count * (int64_t)sizeof *all->kept;
    int32_t count = 0;
    for (int32_t r = 0; r < ranks && bytes > 0; r++)
      if (r != rank)
        list[count++] = (mps_domain_message){.rank = r, .bytes = bytes, .data = all->kept};
    status = mpsi_domain_exchange(domain, function, count, list, &box);
    if (status == MPS_OK) status = mpsi_domain_settle(domain, function, take(mpm, function, &box));
  }
  mpsi_domain_free_mail(&box);
  mpsi_free(mpm->context, list);
  return status;
}

static int by_owner(const void *left, const void *right) {
  const mpsi_kept_impulse *a = left, *b = right;
  if (a->id != b->id) return a->id < b->id ? -1 : 1;
  return (a->body > b->body) - (a->body < b->body);
}

void mpsi_mpm_order_kept(mps_mpm *mpm) {
  mpsi_impulses *all = &mpm->contact.impulses;
  if (all->kept_count > 1) qsort(all->kept, (size_t)all->kept_count, sizeof *all->kept, by_owner);
}
