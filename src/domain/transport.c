/* transport.c - reductions by the program's transport, with their errors.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"

mps_status mpsi_domain_note(mps_domain *domain, const char *function, const char *callback,
                            mps_status status) {
  if (status == MPS_OK) return MPS_OK;
  const bool known = status > MPS_OK && status <= MPS_ERROR_INTERNAL;
  domain->lost = known ? status : MPS_ERROR_ARGUMENT;
  (void)mpsi_fail(domain->context, function, domain->lost,
                  "%s of the domain's transport returned status %d (%s) on rank %d: the ranks have "
                  "lost one another",
                  callback, (int)status, mps_status_text(status), domain->def.rank);
  mpsi_fail_object(domain->context, "domain");
  return domain->lost;
}

mps_status mpsi_domain_alive(mps_domain *domain, const char *function) {
  if (domain->lost == MPS_OK) return MPS_OK;
  (void)mpsi_fail(domain->context, function, domain->lost,
                  "the domain's transport has failed before (%s): the ranks have lost one another",
                  mps_status_text(domain->lost));
  mpsi_fail_object(domain->context, "domain");
  return domain->lost;
}

mps_status mpsi_domain_max(mps_domain *domain, const char *function, int32_t count,
                           double *values) {
  if (!mpsi_domain_many(domain)) return MPS_OK;
  MPSI_TRY(mpsi_domain_alive(domain, function));
  domain->calls++;
  return mpsi_domain_note(domain, function, "reduce_max",
                          domain->def.reduce_max(domain->def.user, count, values));
}

mps_status mpsi_domain_sum(mps_domain *domain, const char *function, int32_t count,
                           int64_t *values) {
  if (!mpsi_domain_many(domain)) return MPS_OK;
  MPSI_TRY(mpsi_domain_alive(domain, function));
  domain->calls++;
  return mpsi_domain_note(domain, function, "reduce_sum",
                          domain->def.reduce_sum(domain->def.user, count, values));
}

mps_status mpsi_domain_sum_exact(mps_domain *domain, const char *function, int32_t count,
                                 mpsi_exact *sums) {
  for (int32_t k = 0; k < count; k++) mpsi_exact_carry(&sums[k]);
  return mpsi_domain_sum(domain, function, count * MPSI_EXACT_LIMBS, &sums[0].limb[0]);
}

/* ---- what a program calls -------------------------------------------------------------------- */
