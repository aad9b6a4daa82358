/* parts.c - sets of particles in parts: each rank is given the same fills and keeps its part of
 * them (core/deal.c).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles_internal.h"
#include "domain_private.h"

#include <string.h>

static mps_status agree_added(void *self, const char *function, mps_status status, int64_t count,
                              uint64_t hash) {
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "the number of particles that are added", (double)count);
  mpsi_give(&given, "a hash of the places of what is added", mpsi_hash_short(hash));
  return mpsi_domain_settle_given(self, function, status, &given);
}

static mps_status settle(void *self, const char *function, mps_status status) {
  return mpsi_domain_settle(self, function, status);
}

static void release(void *self) {
  mps_domain *domain = self;
  mps_domain_destroy(&domain);
}

static mps_status create(mps_domain *domain, const char *function, const mps_particles_def *def,
                         mps_particles **out) {
  mps_context *context = domain->context;
  mps_status status = MPS_OK;
  if (!out) return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "out is NULL");
  status = mpsi_as(context, function, mps_particles_create(context, def, out));
  if (status != MPS_OK || !mpsi_domain_many(domain)) return status;
  const mpsi_deal deal = {.self = domain,
                          .rank = domain->def.rank,
                          .size = domain->def.size,
                          .agree = agree_added,
                          .settle = settle,
                          .release = release};
  status = mpsi_particles_deal_out(*out, function, &deal);
  if (status == MPS_OK)
    (void)mpsi_domain_retain(domain);
  else
    mps_particles_destroy(out);
  return status;
}

mps_status mps_domain_create_particles(mps_domain *domain, const mps_particles_def *def,
                                       mps_particles **out) {
  if (!domain) return MPS_ERROR_ARGUMENT;
  mps_particles *made = NULL;
  mpsi_given given;
  if (out) *out = NULL;
  mps_status status = create(domain, __func__, def, out ? &made : NULL);
  mps_particles_def known = mps_particles_defaults();
  if (status == MPS_OK)
    status = MPSI_DEF_READ(domain->context, __func__, mps_particles_def, def, &known);
  mpsi_given_begin(&given);
  MPSI_GIVE(&given, &known, dim);
  MPSI_GIVE(&given, &known, spacing);
  MPSI_GIVE_VECTOR(&given, &known, origin, 3);
  status = mpsi_domain_settle_given(domain, __func__, status, &given);
  if (status != MPS_OK)
    mps_particles_destroy(&made);
  else
    *out = made;
  return status;
}

mps_status mpsi_domain_settle_parts(mps_domain *domain, const char *function, mps_status status,
                                    const mps_particles *particles) {
  const mpsi_deal *deal = mpsi_particles_deal(particles);
  mpsi_given given;
  mpsi_given_begin(&given);
  mpsi_give(&given, "whether the set is in parts (mps_domain_create_particles)", deal != NULL);
  if (deal) {
    uint64_t fields = MPSI_HASH;
    for (int32_t f = 0; f < mps_particles_field_count(particles); f++) {
      mps_field_info info = {.name = ""};
      if (mps_particles_field(particles, f, &info) != MPS_OK) continue;
      fields = mpsi_hash(fields, info.name, strlen(info.name) + 1);
      fields = mpsi_hash(fields, &info.components, sizeof info.components);
    }
    mpsi_give(&given, "the number of fields of the set", mps_particles_field_count(particles));
    mpsi_give(&given, "a hash of the fields' names", mpsi_hash_short(fields));
    mpsi_give(&given, "a hash of the constants given by mps_particles_set",
              mpsi_hash_short(deal->constants));
  }
  return mpsi_domain_settle_given(domain, function, status, &given);
}
