/* same.c - comparison of arguments between ranks: definitions by lists of numbers, particles by a
 * hash.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_internal.h"

#include <string.h>

/* The first number of the list that differs between ranks, by a hash of each. */
static mps_status find_other(mps_domain *domain, const char *function, const mpsi_given *list,
                             int32_t *which) {
  double range[2 * MPSI_GIVEN_MOST];
  for (int32_t k = 0; k < MPSI_GIVEN_MOST; k++) {
    const bool there = k < list->count;
    range[2 * k] = there ? mpsi_hash_short(mpsi_hash_number(MPSI_HASH, list->value[k])) : 0.0;
    range[2 * k + 1] = -range[2 * k];
  }
  *which = 0;
  const mps_status status = mpsi_domain_max(domain, function, 2 * MPSI_GIVEN_MOST, range);
  while (*which < list->count && range[2 * *which] == -range[2 * *which + 1]) ++*which;
  return status;
}

mps_status mpsi_domain_agree_given(mps_domain *domain, const char *function, mps_status status,
                                   const mpsi_given *list) {
  return mpsi_domain_agree_given_max(domain, function, status, list, 0, NULL);
}

mps_status mpsi_domain_agree_given_max(mps_domain *domain, const char *function, mps_status status,
                                       const mpsi_given *list, int32_t count, double *values) {
  if (!mpsi_domain_many(domain)) return status;
  const double hash = mpsi_hash_short(mpsi_given_hash(list));
  double range[MPSI_DOMAIN_ALONG] = {hash, -hash};
  int32_t k = 0;
  for (int32_t v = 0; v < count; v++) range[2 + v] = values[v];
  status = mpsi_domain_agree_max(domain, function, status, 2 + count, range);
  for (int32_t v = 0; v < count; v++) values[v] = range[2 + v];
  if (status != MPS_OK || range[0] == -range[1]) return status;
  status = find_other(domain, function, list, &k);
  if (status != MPS_OK) return status;
  const bool found = k < list->count;
  const mpsi_name value =
      mpsi_member_text(found ? list->member[k] : NULL, found ? list->value[k] : hash);
  status = mpsi_fail(mpsi_domain_context(domain), function, MPS_ERROR_ARGUMENT,
                     "%s is %s on rank %d and another value on others: all ranks must give the "
                     "same",
                     found ? list->name[k] : "a hash of the last numbers given", value.text,
                     mps_domain_rank(domain));
  return mpsi_domain_agree(domain, function, status);
}

mps_status mpsi_domain_agree_particles(mps_domain *domain, const char *function, mps_status status,
                                       mps_particles *particles) {
  uint64_t hash = MPSI_HASH;
  for (int32_t f = 0; status == MPS_OK && f < mps_particles_field_count(particles); f++) {
    mps_particles_field_info info;
    mps_view view;
    if (mps_particles_get_field_info(particles, f, &info) != MPS_OK ||
        mps_particles_view(particles, info.name, &view) != MPS_OK)
      continue;
    hash = mpsi_hash(hash, info.name, strlen(info.name));
    for (int32_t c = 0; c < info.components; c++)
      hash = mpsi_hash(hash, (const char *)view.data + 8 * c * view.stride[1],
                       (size_t)view.shape[0] * 8);
  }
  return mpsi_domain_agree_same(domain, function, status, "a hash of the set's particles",
                                mpsi_hash_short(hash));
}
