/* same.c - whether ranks have been given the same: definitions and particles by a hash of theirs.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_internal.h"

#include <string.h>

uint64_t mpsi_domain_hash(uint64_t hash, const void *data, size_t bytes) {
  return mpsi_hash(hash, data, bytes);
}

uint64_t mpsi_domain_hash_numbers(uint64_t hash, int32_t count, const double *numbers) {
  for (int32_t k = 0; k < count; k++) {
    const double none = NAN, *number = isnan(numbers[k]) ? &none : &numbers[k];
    hash = mpsi_hash(hash, number, sizeof *number);
  }
  return hash;
}

double mpsi_domain_short(uint64_t hash) { return (double)(hash >> 12); }

mps_status mpsi_domain_settle_numbers(mps_domain *domain, const char *function, mps_status status,
                                      const char *name, int32_t count, const double *numbers) {
  const uint64_t hash = mpsi_domain_hash_numbers(MPSI_DOMAIN_HASH, count, numbers);
  return mpsi_domain_settle_same(domain, function, status, name, mpsi_domain_short(hash));
}

mps_status mpsi_domain_settle_particles(mps_domain *domain, const char *function, mps_status status,
                                        mps_particles *particles) {
  uint64_t hash = MPSI_DOMAIN_HASH;
  for (int32_t f = 0; status == MPS_OK && f < mps_particles_field_count(particles); f++) {
    mps_field_info info;
    mps_view view;
    if (mps_particles_field(particles, f, &info) != MPS_OK ||
        mps_particles_view(particles, info.name, &view) != MPS_OK)
      continue;
    hash = mpsi_domain_hash(hash, info.name, strlen(info.name));
    for (int32_t c = 0; c < info.components; c++)
      hash = mpsi_domain_hash(hash, (const char *)view.data + 8 * c * view.stride[1],
                              (size_t)view.shape[0] * 8);
  }
  return mpsi_domain_settle_same(domain, function, status, "a hash of the set's particles",
                                 mpsi_domain_short(hash));
}
