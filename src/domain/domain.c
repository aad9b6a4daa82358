/* domain.c - the domain object: ranks that compute one model, its transport, its reductions.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"

#include <string.h>

#define MOST_RANKS 1000000

static const mps_domain_def domain_defaults = {.struct_size = sizeof(mps_domain_def), .size = 1};

mps_status mps_domain_def_init(mps_domain_def *def, size_t size) {
  return MPSI_DEF_INIT(mps_domain_def, def, size, &domain_defaults);
}

/* ---- the transport --------------------------------------------------------------------------- */

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
  const mps_status status = mpsi_domain_alive(domain, function);
  if (status != MPS_OK) return status;
  domain->calls++;
  return mpsi_domain_note(domain, function, "reduce_max",
                          domain->def.reduce_max(domain->def.user, count, values));
}

mps_status mpsi_domain_sum(mps_domain *domain, const char *function, int32_t count,
                           int64_t *values) {
  if (!mpsi_domain_many(domain)) return MPS_OK;
  const mps_status status = mpsi_domain_alive(domain, function);
  if (status != MPS_OK) return status;
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

mps_status mps_domain_agree(mps_domain *domain, mps_status status) {
  if (!domain) return MPS_ERROR_ARGUMENT;
  return mpsi_domain_settle(domain, __func__, status);
}

mps_status mps_domain_max(mps_domain *domain, int32_t count, double *values) {
  if (!domain) return MPS_ERROR_ARGUMENT;
  mps_status status = MPS_OK;
  if (count < 0 || (count > 0 && !values))
    status = mpsi_fail(domain->context, __func__, MPS_ERROR_ARGUMENT,
                       "count is %d with values %s, must be >= 0, and 0 where values is NULL",
                       count, values ? "given" : "NULL");
  for (int32_t k = 0; status == MPS_OK && k < count; k++)
    if (isnan(values[k]))
      status = mpsi_fail(domain->context, __func__, MPS_ERROR_ARGUMENT,
                         "values[%d] is NaN, must be a number", k);
  status = mpsi_domain_settle_same(domain, __func__, status, "count", count);
  return status == MPS_OK ? mpsi_domain_max(domain, __func__, count, values) : status;
}

/* ---- messages -------------------------------------------------------------------------------- */

void mpsi_domain_free_mail(mpsi_mailbox *box) {
  for (int32_t k = 0; k < box->count; k++) mpsi_free(box->context, box->mail[k].data);
  if (box->mail) mpsi_free(box->context, box->mail);
  box->mail = NULL;
  box->count = box->room = 0;
}

static void *make_room(void *user, int32_t rank, int64_t bytes) {
  mpsi_mailbox *box = user;
  if (box->count == box->room) {
    void *list = box->mail;
    if (!mpsi_grow(box->context, &list, box->count, box->room + 16, sizeof *box->mail)) return NULL;
    box->mail = list;
    box->room += 16;
  }
  void *data = mpsi_alloc(box->context, bytes, 1);
  if (!data) return NULL;
  int32_t at = box->count++;
  for (; at > 0 && box->mail[at - 1].rank > rank; at--) box->mail[at] = box->mail[at - 1];
  box->mail[at] = (mpsi_mail){rank, bytes, data};
  return data;
}

mps_status mpsi_domain_post(mps_domain *domain, const char *function, int32_t count,
                            const mps_domain_message *messages, mpsi_mailbox *box) {
  *box = (mpsi_mailbox){.context = domain->context};
  mps_status status = mpsi_domain_alive(domain, function);
  if (status != MPS_OK) return status;
  domain->calls++;
  status = domain->def.rendezvous(domain->def.user, count, messages, make_room, box);
  if (status == MPS_ERROR_MEMORY) /* a message had no room: the others are well */
    return mpsi_fail(domain->context, function, MPS_ERROR_MEMORY,
                     "could not allocate what other ranks send");
  return mpsi_domain_note(domain, function, "rendezvous", status);
}

mps_status mpsi_domain_exchange(mps_domain *domain, const char *function, int32_t count,
                                const mps_domain_message *messages, mpsi_mailbox *box) {
  mps_status status = mpsi_domain_post(domain, function, count, messages, box);
  status = mpsi_domain_settle(domain, function, status);
  if (status != MPS_OK) mpsi_domain_free_mail(box);
  return status;
}

/* ---- life ------------------------------------------------------------------------------------ */

static mps_status check_def(mps_context *context, const mps_domain_def *def) {
  static const char *const function = "mps_domain_create";
  if (def->size < 1 || def->size > MOST_RANKS)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "size is %d ranks, allowed are 1 to %d",
                     def->size, MOST_RANKS);
  if (def->rank < 0 || def->rank >= def->size)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "rank is %d, allowed are 0 to %d",
                     def->rank, def->size - 1);
  if (def->reserved != 0)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "reserved is %d, must be 0",
                     def->reserved);
  const char *missing = !def->rendezvous     ? "rendezvous"
                        : !def->star_create  ? "star_create"
                        : !def->star_begin   ? "star_begin"
                        : !def->star_end     ? "star_end"
                        : !def->star_destroy ? "star_destroy"
                        : !def->reduce_max   ? "reduce_max"
                        : !def->reduce_sum   ? "reduce_sum"
                                             : NULL;
  if (!missing && !def->max_begin != !def->max_end)
    missing = def->max_begin ? "max_end" : "max_begin";
  if (!missing) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "the callback %s is NULL", missing);
}

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
  status = mpsi_domain_settle_same(domain, function, status, "the library's version",
                                   mps_version_number());
  if (status == MPS_OK)
    status = mpsi_domain_settle_same(domain, function, status, "instruction_level",
                                     mpsi_context_level(domain->context));
  return status;
}

mps_status mps_domain_create(mps_context *context, const mps_domain_def *user_def,
                             mps_domain **out) {
  if (!context) return MPS_ERROR_ARGUMENT;
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_domain_def def = domain_defaults;
  mps_status status = MPSI_DEF_READ(context, __func__, mps_domain_def, user_def, &def);
  if (status == MPS_OK) status = check_def(context, &def);
  if (status != MPS_OK) return status;
  mps_domain *domain = mpsi_alloc(context, 1, sizeof *domain);
  if (!domain) return mpsi_fail_memory(context, __func__, sizeof *domain);
  *domain = (mps_domain){.context = mpsi_context_retain(context), .def = def, .references = 1};
  domain->settled = -1;
  status = try_transport(domain);
  if (status != MPS_OK) {
    domain->def.destroy = NULL;
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
  if (domain->def.destroy) domain->def.destroy(domain->def.user);
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
