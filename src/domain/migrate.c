/* migrate.c - migration of rows of columns to other ranks, one message to each; and the census of
 * ids that checks that all have arrived.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "migrate.h"

#include "domain_private.h"

#include <string.h>

/* ---- sending --------------------------------------------------------------------------------- */

static mps_status check_leaving(mps_domain *domain, const char *function, const mpsi_leaving *l) {
  const int32_t ranks = domain->def.size, own = domain->def.rank;
  if (l->columns < 1)
    return mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                     "particles leave with %d columns, must be at least 1, their ids", l->columns);
  for (int64_t k = 0; k < l->count; k++)
    if (l->to[k] < 0 || l->to[k] >= ranks || l->to[k] == own)
      return mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                       "particle %lld leaves rank %d for rank %d, allowed are the others of 0 to "
                       "%d",
                       (long long)((const int64_t *)l->column[0])[l->row[k]], (int)own,
                       (int)l->to[k], (int)ranks - 1);
  return MPS_OK;
}

/* Messages under construction. */
typedef struct parcel {
  int64_t *begin; /* [ranks + 1] first record for each rank */
  int64_t *record;
  mps_domain_message *message;
  int32_t messages;
} parcel;

static void free_parcel(mps_context *context, parcel *p) {
  MPSI_FREE(context, p->begin, p->record, p->message);
}

/* Records of `columns` words each, by rank and then in the order given. */
static mps_status pack(mps_domain *domain, const char *function, const mpsi_leaving *l, parcel *p) {
  mps_context *context = domain->context;
  const int32_t ranks = domain->def.size;
  const int64_t partners = l->count < ranks ? l->count : ranks;
  p->begin = mpsi_alloc(context, (int64_t)ranks + 2, sizeof *p->begin);
  p->record = mpsi_alloc(context, l->count * l->columns, sizeof *p->record);
  p->message = mpsi_alloc(context, partners, sizeof *p->message);
  if (!p->begin || !p->record || !p->message)
    return mpsi_fail_memory(context, function, (size_t)(l->count * l->columns + ranks) * 8);
  memset(p->begin, 0, ((size_t)ranks + 2) * sizeof *p->begin);
  for (int64_t k = 0; k < l->count; k++) p->begin[l->to[k] + 2]++;
  for (int32_t r = 2; r <= ranks + 1; r++) p->begin[r] += p->begin[r - 1];
  for (int64_t k = 0; k < l->count; k++) { /* begin[to + 1] runs to the end of its rank's records */
    int64_t *to = p->record + p->begin[l->to[k] + 1]++ * l->columns;
    for (int32_t c = 0; c < l->columns; c++)
      memcpy(to + c, (const char *)l->column[c] + 8 * l->row[k], 8);
  }
  for (int32_t r = 0; r < ranks; r++) {
    const int64_t records = p->begin[r + 1] - p->begin[r];
    if (records > 0)
      p->message[p->messages++] =
          (mps_domain_message){.rank = r,
                               .bytes = records * l->columns * 8,
                               .data = p->record + p->begin[r] * l->columns};
  }
  return MPS_OK;
}

mps_status mpsi_migrate(mps_domain *domain, const char *function, const mpsi_leaving *leaving,
                        mpsi_mailbox *box, int64_t *arriving) {
  parcel p = {.messages = 0};
  *box = (mpsi_mailbox){.context = NULL};
  *arriving = 0;
  if (!mpsi_domain_many(domain)) return MPS_OK;
  mps_context *context = box->context = domain->context;
  mps_status status = check_leaving(domain, function, leaving);
  if (status == MPS_OK) status = pack(domain, function, leaving, &p);
  status = mpsi_domain_agree_same(domain, function, status, "the number of columns of a particle",
                                  leaving->columns);
  if (status == MPS_OK) status = mpsi_domain_exchange(domain, function, p.messages, p.message, box);
  for (int32_t k = 0; k < box->count; k++) *arriving += box->mail[k].bytes / (8 * leaving->columns);
  free_parcel(context, &p);
  return status;
}

void mpsi_migrate_unpack(const mpsi_mailbox *box, int32_t columns, void *const *column,
                         int64_t first) {
  for (int32_t m = 0; m < box->count; m++) {
    const int64_t *record = box->mail[m].data, records = box->mail[m].bytes / (8 * columns);
    for (int64_t k = 0; k < records; k++, record += columns, first++)
      for (int32_t c = 0; c < columns; c++) memcpy((char *)column[c] + 8 * first, record + c, 8);
  }
}

/* ---- counting -------------------------------------------------------------------------------- */

/* Every bit of the id changes half of the bits. */
static uint64_t mix(uint64_t id) {
  id ^= id >> 29;
  id *= UINT64_C(0x9e3779b97f4a7c15);
  id ^= id >> 32;
  id *= UINT64_C(0xd6e8feb86659fd93);
  return id ^ id >> 31;
}

mps_status mpsi_census_take(mps_domain *domain, const char *function, int64_t count,
                            const int64_t *id, mpsi_census *out) {
  uint64_t sum = 0, mixed = 0;
  for (int64_t k = 0; k < count; k++) {
    sum += (uint64_t)id[k];
    mixed += mix((uint64_t)id[k]);
  }
  int64_t values[3] = {count, (int64_t)sum, (int64_t)mixed};
  const mps_status status = mpsi_domain_sum(domain, function, 3, values);
  *out = (mpsi_census){.count = values[0], .sum = values[1], .mixed = values[2]};
  return status;
}

mps_status mpsi_census_check(mps_domain *domain, const char *function, int64_t count,
                             const int64_t *id, const mpsi_census *before) {
  mpsi_census now;
  MPSI_TRY(mpsi_census_take(domain, function, count, id, &now));
  if (now.count == before->count && now.sum == before->sum && now.mixed == before->mixed)
    return MPS_OK;
  /* the sums are the same everywhere, and so is this, without a message */
  return mpsi_fail(domain ? domain->context : NULL, function, MPS_ERROR_INTERNAL,
                   "there are %lld particles on all ranks, and were %lld%s", (long long)now.count,
                   (long long)before->count,
                   now.count == before->count ? ": one is there twice and another is lost" : "");
}
