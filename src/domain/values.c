/* values.c - values of a few particles of any rank, for all ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "domain_private.h"

#include <string.h>

enum { PORTION = 65536 }; /* values in a reduction */

/* Ranks request the same particles of the same field. */
static mps_status check(mps_domain *domain, const char *function, mps_particles *particles,
                        const char *name, int64_t count, const int64_t *ids, const double *values,
                        mps_view *view) {
  mps_status status = MPS_OK;
  uint64_t hash = mpsi_hash(MPSI_HASH, &count, sizeof count);
  if (!particles)
    status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT, "particles is NULL");
  else if (count < 0)
    status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                       (long long)count);
  else if (count > 0 && (!ids || !values))
    status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                       ids ? "values" : "ids");
  else if (mpsi_particles_context(particles) != domain->context)
    status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                       "the particle set was made from another context than the domain");
  else
    status = mpsi_as(domain->context, function, mps_particles_view(particles, name, view));
  if (status == MPS_OK) {
    hash = mpsi_hash(hash, ids, (size_t)count * sizeof *ids);
    hash = mpsi_hash(hash, name, strlen(name));
  }
  return mpsi_domain_agree_same(domain, function, status, "a hash of the field's name and the ids",
                                mpsi_hash_short(hash));
}

/* The highest rank that has each particle, which sends its value. */
static mps_status find_tellers(mps_domain *domain, const char *function,
                               const mps_particles *particles, int64_t count, const int64_t *ids,
                               double *teller) {
  for (int64_t k = 0; k < count; k++)
    teller[k] = mps_particles_index(particles, ids[k]) >= 0 ? domain->def.rank : -1.0;
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < count && status == MPS_OK; k += PORTION)
    status = mpsi_domain_max(domain, function, (int32_t)(count - k < PORTION ? count - k : PORTION),
                             teller + k);
  for (int64_t k = 0; k < count && status == MPS_OK; k++)
    if (teller[k] < 0.0) {
      status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                         "ids[%lld] is %lld: the set has no such particle on any rank",
                         (long long)k, (long long)ids[k]);
      mpsi_fail_where(domain->context, -1, ids[k]);
    }
  return status;
}

/* The bits of a value of one rank are those of the sum. */
static mps_status share_values(mps_domain *domain, const char *function,
                               const mps_particles *particles, const mps_view *view, int64_t count,
                               const int64_t *ids, const double *teller, double *values) {
  const int64_t columns = view->shape[1], all = count * columns;
  int64_t bits[256];
  const int64_t most = (int64_t)(sizeof bits / sizeof *bits);
  mps_status status = MPS_OK;
  for (int64_t first = 0; first < all && status == MPS_OK; first += most) {
    const int64_t some = all - first < most ? all - first : most;
    for (int64_t i = 0; i < some; i++) {
      const int64_t k = (first + i) / columns, c = (first + i) % columns;
      bits[i] = 0;
      if (teller[k] != (double)domain->def.rank) continue;
      const int64_t at = mps_particles_index(particles, ids[k]);
      double value;
      if (view->dtype.code == 0)
        value = (double)*mps_view_i64(view, at, c);
      else
        value = *mps_view_f64(view, at, c);
      memcpy(&bits[i], &value, sizeof value);
    }
    status = mpsi_domain_sum(domain, function, (int32_t)some, bits);
    if (status == MPS_OK) memcpy(values + first, bits, (size_t)some * sizeof *bits);
  }
  return status;
}

mps_status mps_domain_get_field(mps_domain *domain, mps_particles *particles, const char *name,
                                const int64_t *ids, int64_t count, double *values) {
  if (!domain) return mpsi_null(__func__, "domain");
  mps_view view = {.data = NULL};
  double *teller = NULL;
  mps_status status = check(domain, __func__, particles, name, count, ids, values, &view);
  if (status != MPS_OK) return status;
  teller = mpsi_alloc(domain->context, count, sizeof *teller);
  if (!teller) status = mpsi_fail_memory(domain->context, __func__, (size_t)count * sizeof *teller);
  status = mpsi_domain_agree(domain, __func__, status);
  if (status == MPS_OK) status = find_tellers(domain, __func__, particles, count, ids, teller);
  if (status == MPS_OK)
    status = share_values(domain, __func__, particles, &view, count, ids, teller, values);
  mpsi_free(domain->context, teller);
  return status;
}
