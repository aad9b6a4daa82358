/* vote.c - agreement of ranks on a status, and the check that all are in the same call.
 *
 * A vote is one reduction (maximum) of the same numbers for all purposes:
 *
 *   status    the worst status with the lowest rank that has it
 *   tag       a hash of the public function and of the number of collective calls so far
 *   - tag     so that the maximum is the least tag
 *   values    the caller's, MPSI_DOMAIN_ALONG at most
 *
 * The first collective call of every public function is a vote. Ranks that are in different
 * functions therefore take part in the same reduction, find two tags in it and return the same
 * error, before either function has changed anything. A rank that has destroyed its domain has left
 * a
 * vote behind that says so. SPDX-License-Identifier: BSD-3-Clause */
#include "domain_private.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { STATUS, TAG, LEAST_TAG, VALUES };
enum { RECORD = (sizeof(mps_error) + 7) / 8 };

#define GONE 255 /* in the place of a status: the rank has left */

/* ---- what is sent ---------------------------------------------------------------------------- */

static double tag_of(const mps_domain *domain, const char *function) {
  const uint64_t hash = mpsi_hash(MPSI_HASH, function, strlen(function));
  return mpsi_hash_short(mpsi_hash(hash, &domain->voted, sizeof domain->voted));
}

/* Of ranks with the same status the lowest has the greatest code. */
static double code_of(const mps_domain *domain, int status) {
  const double ranks = (double)domain->def.size;
  return status == MPS_OK ? 0.0 : (double)status * ranks + (ranks - 1.0 - domain->def.rank);
}

static void write_vote(mps_domain *domain, const char *function, mps_status status, int32_t count,
                       const double *values, double *vote) {
  memset(vote, 0, MPSI_DOMAIN_VOTE * sizeof *vote);
  domain->voted = ++domain->calls;
  vote[STATUS] = code_of(domain, status);
  vote[TAG] = tag_of(domain, function);
  vote[LEAST_TAG] = -vote[TAG];
  for (int32_t k = 0; k < count; k++) vote[VALUES + k] = values[k];
}

void mpsi_domain_leave(mps_domain *domain) {
  double vote[MPSI_DOMAIN_VOTE];
  if (!mpsi_domain_many(domain) || domain->lost != MPS_OK || !domain->def.max_leave) return;
  write_vote(domain, "mps_domain_destroy", MPS_OK, 0, NULL, vote);
  vote[STATUS] = code_of(domain, GONE);
  domain->lost = MPS_ERROR_STATE;
  (void)domain->def.max_leave(domain->def.user, MPSI_DOMAIN_VOTE, vote);
}

/* ---- what is found --------------------------------------------------------------------------- */

/* Every rank copies the record of `winner`. */
static mps_status share_record(mps_domain *domain, const char *function, int32_t winner,
                               mps_status status) {
  int64_t words[RECORD] = {0};
  mps_error record;
  mps_context *context = domain->context;
  if (domain->def.rank == winner) {
    const mps_error *own = mps_context_error(context);
    memset(&record, 0, sizeof record);
    if (own->status == status) {
      record = *own;
    } else {
      record.step = record.particle = -1;
      snprintf(record.message, sizeof record.message, "%s", mps_status_text(status));
      snprintf(record.function, sizeof record.function, "%s", function);
      snprintf(record.object, sizeof record.object, "domain");
    }
    if (own->status != status || mpsi_failures(context) != domain->settled) {
      char text[sizeof record.message];
      memcpy(text, record.message, sizeof text);
      snprintf(record.message, sizeof record.message, "rank %d: %.490s", winner, text);
    }
    memcpy(words, &record, sizeof record);
  }
  MPSI_TRY(mpsi_domain_sum(domain, function, RECORD, words));
  memcpy(&record, words, sizeof record);
  (void)mpsi_fail(context, record.function, status, "%s", record.message);
  mpsi_fail_where(context, record.step, record.particle);
  mpsi_fail_object(context, "%s", record.object);
  domain->settled = mpsi_failures(context);
  return status;
}

/* Another rank has destroyed its domain: no agreement is possible. */
static mps_status report_left(mps_domain *domain, const char *function, int32_t rank) {
  domain->lost = MPS_ERROR_STATE;
  (void)mpsi_fail(domain->context, function, MPS_ERROR_STATE,
                  "rank %d has destroyed its domain, while rank %d has called %s: all ranks must "
                  "call the same functions in the same order",
                  rank, domain->def.rank, function);
  mpsi_fail_object(domain->context, "domain");
  return MPS_ERROR_STATE;
}

/* A rank's call, as sent to others. */
typedef struct call {
  char function[88];
  int64_t number;
} call;
enum { CALL = sizeof(call) / 8 };

/* The lowest rank of those with the greatest tag, of those with the least, the greatest number. */
static mps_status find_ranks(mps_domain *domain, const char *function, const double *vote,
                             double own, double found[3]) {
  const double first = domain->def.size - domain->def.rank;
  found[0] = own == vote[TAG] ? first : 0.0;
  found[1] = own == -vote[LEAST_TAG] ? first : 0.0;
  found[2] = (double)domain->voted;
  return mpsi_domain_max(domain, function, 3, found);
}

/* Ranks are in different calls: names two of these, and continues with the same number. */
static mps_status report_calls(mps_domain *domain, const char *function, const double *vote) {
  const double own = tag_of(domain, function);
  double found[3];
  int64_t words[2 * CALL] = {0};
  call mine = {.number = domain->voted}, seen[2];
  snprintf(mine.function, sizeof mine.function, "%s", function);
  MPSI_TRY(find_ranks(domain, function, vote, own, found));
  const int32_t rank[2] = {domain->def.size - (int32_t)found[0],
                           domain->def.size - (int32_t)found[1]};
  for (int k = 0; k < 2; k++)
    if (rank[k] == domain->def.rank) memcpy(words + k * CALL, &mine, sizeof mine);
  MPSI_TRY(mpsi_domain_sum(domain, function, 2 * CALL, words));
  memcpy(seen, words, sizeof seen);
  domain->calls = (int64_t)found[2]; /* the same on all */
  const int a = rank[0] < rank[1] ? 0 : 1, b = 1 - a;
  const bool same = strcmp(seen[0].function, seen[1].function) == 0;
  (void)mpsi_fail(domain->context, function, MPS_ERROR_STATE,
                  "rank %d has called %s and rank %d %s (collective calls %lld and %lld of the "
                  "domain): all ranks must call the same functions in the same order%s",
                  rank[a], seen[a].function, rank[b], seen[b].function, (long long)seen[a].number,
                  (long long)seen[b].number, same ? ", with the same arguments" : "");
  mpsi_fail_object(domain->context, "domain");
  domain->settled = mpsi_failures(domain->context);
  domain->apart = true;
  return MPS_ERROR_STATE;
}

static mps_status read_vote(mps_domain *domain, const char *function, int32_t count, double *values,
                            const double *vote) {
  const int64_t code = (int64_t)vote[STATUS], worst = code / domain->def.size;
  const int32_t rank = (int32_t)(domain->def.size - 1 - (code - worst * domain->def.size));
  for (int32_t k = 0; k < count; k++) values[k] = vote[VALUES + k];
  if (worst == GONE) return report_left(domain, function, rank);
  if (vote[TAG] != -vote[LEAST_TAG]) return report_calls(domain, function, vote);
  return code == 0 ? MPS_OK : share_record(domain, function, rank, (mps_status)worst);
}

/* ---- votes ----------------------------------------------------------------------------------- */

mps_status mpsi_domain_vote_begin(mps_domain *domain, const char *function, mps_status status,
                                  int32_t count, const double *values) {
  assert(count <= MPSI_DOMAIN_ALONG);
  if (!mpsi_domain_many(domain)) return status;
  if (domain->lost != MPS_OK)
    return status == domain->lost ? status : mpsi_domain_alive(domain, function);
  /* the function ends with the error of its first vote: other ranks end elsewhere */
  if (domain->apart && status != MPS_OK && mpsi_failures(domain->context) == domain->settled)
    return status;
  domain->apart = false;
  write_vote(domain, function, status, count, values, domain->vote);
  if (!domain->def.max_begin) return MPS_OK;
  return mpsi_domain_note(domain, function, "max_begin",
                          domain->def.max_begin(domain->def.user, MPSI_DOMAIN_VOTE, domain->vote));
}

mps_status mpsi_domain_vote_end(mps_domain *domain, const char *function, int32_t count,
                                double *values) {
  if (!mpsi_domain_many(domain)) return MPS_OK;
  mps_status status = mpsi_domain_alive(domain, function);
  if (status != MPS_OK) return status;
  const mps_domain_def *def = &domain->def;
  if (def->max_begin)
    status = mpsi_domain_note(domain, function, "max_end", def->max_end(def->user));
  else
    status = mpsi_domain_note(domain, function, "reduce_max",
                              def->reduce_max(def->user, MPSI_DOMAIN_VOTE, domain->vote));
  return status == MPS_OK ? read_vote(domain, function, count, values, domain->vote) : status;
}

/* The transport has failed in a vote of a rank with an error: its record has both. */
static mps_status report_both(mps_domain *domain, const mps_error *own) {
  const mps_error last = *mps_context_error(domain->context);
  (void)mpsi_fail(domain->context, own->function, domain->lost, "%.300s; %.200s", own->message,
                  last.message);
  mpsi_fail_where(domain->context, own->step, own->particle);
  mpsi_fail_object(domain->context, "%s", own->object);
  return domain->lost;
}

static mps_status agree_max(mps_domain *domain, const char *function, mps_status status,
                            int32_t count, double *values) {
  status = mpsi_domain_vote_begin(domain, function, status, count, values);
  return status == MPS_OK ? mpsi_domain_vote_end(domain, function, count, values) : status;
}

mps_status mpsi_domain_agree_max(mps_domain *domain, const char *function, mps_status status,
                                 int32_t count, double *values) {
  if (!mpsi_domain_many(domain)) return status;
  if (status == MPS_OK || domain->lost != MPS_OK ||
      mps_context_error(domain->context)->status != status)
    return agree_max(domain, function, status, count, values);
  const mps_error own = *mps_context_error(domain->context);
  status = agree_max(domain, function, status, count, values);
  const bool left = status == MPS_ERROR_STATE; /* another rank has left: all report that */
  return domain->lost != MPS_OK && !left ? report_both(domain, &own) : status;
}

mps_status mpsi_domain_agree(mps_domain *domain, const char *function, mps_status status) {
  return mpsi_domain_agree_max(domain, function, status, 0, NULL);
}

mps_status mpsi_domain_count(mps_domain *domain, const char *function, int64_t own, int64_t *first,
                             int64_t *all) {
  *first = 0, *all = own;
  if (!mpsi_domain_many(domain)) return MPS_OK;
  const int32_t ranks = domain->def.size;
  int64_t *count = mpsi_alloc(domain->context, ranks, sizeof *count);
  mps_status status = MPS_OK;
  if (!count) status = mpsi_fail_memory(domain->context, function, (size_t)ranks * sizeof *count);
  status = mpsi_domain_agree(domain, function, status);
  if (status == MPS_OK) {
    count[domain->def.rank] = own;
    status = mpsi_domain_sum(domain, function, ranks, count);
  }
  *all = 0;
  for (int32_t r = 0; status == MPS_OK && r < ranks; r++) {
    if (r < domain->def.rank) *first += count[r];
    *all += count[r];
  }
  mpsi_free(domain->context, count);
  return status;
}

mps_status mpsi_domain_agree_same(mps_domain *domain, const char *function, mps_status status,
                                  const char *name, double value) {
  const bool none = isnan(value); /* unset, equal on all */
  double range[4] = {none ? -INFINITY : value, none ? -INFINITY : -value, none, !none};
  if (!mpsi_domain_many(domain)) return status;
  status = mpsi_domain_agree_max(domain, function, status, 4, range);
  const bool same = range[2] != range[3] && (range[2] == 1.0 || range[0] == -range[1]);
  if (status != MPS_OK || same) return status;
  status = mpsi_fail(domain->context, function, MPS_ERROR_ARGUMENT,
                     "%s is %.17g on rank %d and another value on others: all ranks must give the "
                     "same",
                     name, value, domain->def.rank);
  return mpsi_domain_agree(domain, function, status);
}
