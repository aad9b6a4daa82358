/* domain.c - the domain object: ranks that compute one model, and its public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"

/* ---- for the program ------------------------------------------------------------------------- */

mps_status mps_domain_agree(mps_domain *domain, mps_status status) {
  if (!domain) return mpsi_null(__func__, "domain");
  return mpsi_domain_agree(domain, __func__, status);
}

mps_status mps_domain_max(mps_domain *domain, int32_t count, double *values) {
  if (!domain) return mpsi_null(__func__, "domain");
  mps_status status = MPS_OK;
  if (count < 0 || (count > 0 && !values))
    status = mpsi_fail(domain->context, __func__, MPS_ERROR_ARGUMENT,
                       "count is %d with values %s, must be >= 0, and 0 where values is NULL",
                       count, values ? "given" : "NULL");
  for (int32_t k = 0; status == MPS_OK && k < count; k++)
    if (isnan(values[k]))
      status = mpsi_fail(domain->context, __func__, MPS_ERROR_ARGUMENT,
                         "values[%d] is NaN, must be a number", k);
  status = mpsi_domain_agree_same(domain, __func__, status, "count", count);
  return status == MPS_OK ? mpsi_domain_max(domain, __func__, count, values) : status;
}

/* ---- life ------------------------------------------------------------------------------------ */

/* Are these ranks 0 to size - 1 of the same library at the same instruction level? */
static mps_status try_transport(mps_domain *domain) {
  static const char *const function = "mps_domain_create";
  int64_t ranks[2] = {1, domain->def.rank};
  mps_status status = mpsi_domain_sum(domain, function, 2, ranks);
  if (status != MPS_OK) return status;
  const int64_t n = domain->def.size;
  if (n > 1 && (ranks[0] != n || ranks[1] != n * (n - 1) / 2))
    status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                       "the sum over ranks of 1 is %lld and that of the rank's number %lld, "
                       "expected of %lld ranks are %lld and %lld",
                       (long long)ranks[0], (long long)ranks[1], (long long)n, (long long)n,
                       (long long)(n * (n - 1) / 2));
  status = mpsi_domain_agree_same(domain, function, status, "the library's version",
                                  mps_version_number());
  if (status == MPS_OK)
    status = mpsi_domain_agree_same(domain, function, status, "instruction_level",
                                    mpsi_context_level(domain->context));
  return status;
}

mps_status mps_domain_create(mps_context *context, const mps_domain_def *user_def,
                             mps_domain **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_domain_def def;
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_domain_def, user_def, &def));
  mps_domain *domain = mpsi_alloc(context, 1, sizeof *domain);
  if (!domain) return mpsi_fail_memory(context, __func__, sizeof *domain);
  *domain = (mps_domain){.context = mpsi_context_retain(context), .def = def, .references = 1};
  domain->settled = -1;
  mps_status status = try_transport(domain);
  if (status != MPS_OK) {
    domain->def.release = NULL;
    domain->def.max_leave = NULL; /* all ranks are here */
    mps_domain_destroy(&domain);
  }
  *out = domain;
  return status;
}

mps_context *mpsi_domain_context(const mps_domain *domain) { return domain->context; }

mps_domain *mpsi_domain_retain(mps_domain *domain) {
  if (domain) domain->references++;
  return domain;
}

void mps_domain_destroy(mps_domain **pointer) {
  if (!pointer || !*pointer) return;
  mps_domain *domain = *pointer;
  *pointer = NULL;
  if (--domain->references > 0) return;
  mps_context *context = domain->context;
  mpsi_domain_leave(domain);
  mpsi_release(domain->def.release, domain->def.user);
  mpsi_free(context, domain);
  mpsi_context_release(context);
}

mps_status mpsi_domain_check(mps_context *context, const char *function, const mps_domain *domain) {
  if (!domain || domain->context == context) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "the domain was made from another context");
}

int32_t mps_domain_rank(const mps_domain *domain) { return domain ? domain->def.rank : -1; }
int32_t mps_domain_size(const mps_domain *domain) { return domain ? domain->def.size : 0; }
