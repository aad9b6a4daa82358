/* notices.c - see notices.h. SPDX-License-Identifier: BSD-3-Clause */
#include "notices.h"
#include "mpm/ranks/partition.h"

#include "domain/domain_internal.h"

#include <string.h>

void mpsi_mpm_add_to_range(int64_t *range, const int32_t *at) {
  for (int c = 0; c < 3; c++) {
    if (range[6] == 0 || at[c] < range[c]) range[c] = at[c];
    if (range[6] == 0 || at[c] > range[3 + c]) range[3 + c] = at[c];
  }
  range[6]++;
}

/* Whether the block may be beside one of the range, or one of them. */
static bool is_near(const int64_t *range, const mpsi_notice *own) {
  bool near = range[6] > 0;
  for (int c = 0; c < 3; c++)
    near = near && own->at[c] >= range[c] - 1 && own->at[c] <= range[3 + c] + 1;
  return near;
}

typedef struct announcement {
  mps_context *context;
  mps_domain *domain;
  const char *function;
  int64_t count;
  const mpsi_notice *own;
  mpsi_block_range *range; /* of each rank: ranks add up a list of which each has set its own */
  mpsi_notice *sent;       /* rank by rank */
  mps_domain_message *message;
  mpsi_mailbox box;
} announcement;

static bool is_sent(const announcement *a, int32_t rank, int64_t k) {
  return rank != mps_domain_rank(a->domain) && is_near(a->range[rank], &a->own[k]);
}

/* The notices for each rank, one list behind the other; returns the number of lists. */
static int32_t write(const announcement *a) {
  mpsi_notice *to = a->sent;
  int32_t messages = 0;
  for (int32_t r = 0; r < mps_domain_size(a->domain); r++) {
    mpsi_notice *first = to;
    for (int64_t k = 0; k < a->count; k++) {
      if (!is_sent(a, r, k)) continue;
      *to = a->own[k];
      to++->rank = mps_domain_rank(a->domain);
    }
    if (to > first)
      a->message[messages++] = (mps_domain_message){
          .rank = r, .bytes = (to - first) * (int64_t)sizeof *to, .data = first};
  }
  return messages;
}

static mps_status send(announcement *a, mps_status status, const int64_t *range) {
  const int32_t ranks = mps_domain_size(a->domain);
  const size_t bytes = (size_t)ranks * sizeof *a->range;
  int64_t notices = 0;
  a->range = mpsi_alloc(a->context, ranks, sizeof *a->range);
  a->message = mpsi_alloc(a->context, ranks, sizeof *a->message);
  if (status == MPS_OK && !(a->range && a->message))
    status = mpsi_fail_memory(a->context, a->function, bytes);
  status = mpsi_domain_agree(a->domain, a->function, status);
  if (status != MPS_OK) return status;
  memset(a->range, 0, bytes);
  memcpy(a->range[mps_domain_rank(a->domain)], range, sizeof *a->range);
  status = mpsi_domain_sum(a->domain, a->function, MPSI_BLOCK_RANGE * ranks, a->range[0]);
  if (status != MPS_OK) return status;
  for (int32_t r = 0; r < ranks; r++)
    for (int64_t k = 0; k < a->count; k++) notices += is_sent(a, r, k);
  a->sent = mpsi_alloc(a->context, notices, sizeof *a->sent);
  if (!a->sent)
    status = mpsi_fail_memory(a->context, a->function, (size_t)notices * sizeof *a->sent);
  status = mpsi_domain_agree(a->domain, a->function, status);
  if (status != MPS_OK) return status;
  return mpsi_domain_exchange(a->domain, a->function, write(a), a->message, &a->box);
}

static mps_status read(const announcement *a, mpsi_notice **list, int64_t *found) {
  int64_t count = 0;
  for (int32_t m = 0; m < a->box.count; m++)
    count += a->box.mail[m].bytes / (int64_t)sizeof(mpsi_notice);
  *list = mpsi_alloc(a->context, count, sizeof **list);
  if (!*list) return mpsi_fail_memory(a->context, a->function, (size_t)count * sizeof **list);
  *found = count;
  char *to = (char *)*list;
  for (int32_t m = 0; m < a->box.count; to += a->box.mail[m++].bytes)
    memcpy(to, a->box.mail[m].data, (size_t)a->box.mail[m].bytes);
  return MPS_OK;
}

mps_status mpsi_mpm_exchange_notices(mps_context *context, mps_domain *domain, const char *function,
                                     mps_status status, const int64_t *range, int64_t count,
                                     const mpsi_notice *own, mpsi_notice **list, int64_t *found) {
  announcement a = {.context = context,
                    .domain = domain,
                    .function = function,
                    .count = count,
                    .own = own,
                    .box.context = context};
  *list = NULL, *found = 0;
  status = send(&a, status, range);
  if (status == MPS_OK) status = read(&a, list, found);
  mpsi_domain_free_mail(&a.box);
  MPSI_FREE(context, a.range, a.sent, a.message);
  return status;
}
