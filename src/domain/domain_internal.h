/* domain_internal.h - the interface of a domain for solvers. Every function takes NULL for a domain
 * of one rank, and is collective unless it says otherwise. The first collective call of every
 * public function is a vote (settle, settle_max, settle_same, settle_given), so that ranks in
 * different functions detect that: vote.c. A failure that ranks have agreed upon has the same
 * record on all of them, and may be agreed upon again without harm.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/exact.h"
#include "core/base/given.h"
#include "core/internal.h"
#include "core/state/row_source.h"
#include "core/state/state.h"

#include <mps/experimental/domain.h>

mps_domain *mpsi_domain_retain(mps_domain *domain); /* not collective */
/* MPS_ERROR_ARGUMENT for a domain of another context. Not collective. */
mps_status mpsi_domain_check(mps_context *context, const char *function, const mps_domain *domain);
mps_context *mpsi_domain_context(const mps_domain *domain); /* not collective */
/* Whether there are other ranks to agree with. Not collective. */
static inline bool mpsi_domain_many(const mps_domain *domain) {
  return mps_domain_size(domain) > 1;
}

/* Status of all ranks: MPS_OK where all have that, else the worst status, with the record of the
 * lowest rank that has it. `status` is this rank's, its record the last of the context. */
mps_status mpsi_domain_agree(mps_domain *domain, const char *function, mps_status status);
/* The same, and in the same message the greatest of each value: at most MPSI_DOMAIN_ALONG. On an
 * error the values are not to be used. */
#define MPSI_DOMAIN_ALONG 11
mps_status mpsi_domain_agree_max(mps_domain *domain, const char *function, mps_status status,
                                 int32_t count, double *values);
/* mpsi_domain_agree_max in two parts, between which ranks may compute and exchange halos, but
 * neither agree nor reduce: no rank waits for one slightly behind. One is under way at a time. The
 * first part returns `status` in one process, and of several an error where the transport fails. */
mps_status mpsi_domain_vote_begin(mps_domain *domain, const char *function, mps_status status,
                                  int32_t count, const double *values);
mps_status mpsi_domain_vote_end(mps_domain *domain, const char *function, int32_t count,
                                double *values);
/* The same, and MPS_ERROR_ARGUMENT where ranks have different values of `name`. */
mps_status mpsi_domain_agree_same(mps_domain *domain, const char *function, mps_status status,
                                  const char *name, double value);

/* same.c: the same for a list, with the name of the first number that differs, and for the fields
 * of a set. */
mps_status mpsi_domain_agree_given(mps_domain *domain, const char *function, mps_status status,
                                   const mpsi_given *list);
/* The same, and the greatest of each value: at most MPSI_DOMAIN_ALONG - 2. */
mps_status mpsi_domain_agree_given_max(mps_domain *domain, const char *function, mps_status status,
                                       const mpsi_given *list, int32_t count, double *values);
mps_status mpsi_domain_agree_particles(mps_domain *domain, const char *function, mps_status status,
                                       mps_particles *particles);

/* parts.c: whether the set is in parts on all ranks or on none, with the same fields and constants.
 */
mps_status mpsi_domain_agree_parts(mps_domain *domain, const char *function, mps_status status,
                                   const mps_particles *particles);

/* parts.c: each particle with all its fields to rank to[k], which may be this one. The same fields
 * on all ranks. `status` is that of making the list; on an error nothing has changed. */
mps_status mpsi_domain_move(mps_domain *domain, const char *function, mps_status status,
                            mps_particles *particles, const int32_t *to);

mps_status mpsi_domain_max(mps_domain *domain, const char *function, int32_t count, double *values);
mps_status mpsi_domain_sum(mps_domain *domain, const char *function, int32_t count,
                           int64_t *values);
/* vote.c: how many items ranks have: those of all ranks, and from *first on this rank's `own`. */
mps_status mpsi_domain_count(mps_domain *domain, const char *function, int64_t own, int64_t *first,
                             int64_t *all);
/* Sums whose terms lie on all ranks. */
mps_status mpsi_domain_sum_exact(mps_domain *domain, const char *function, int32_t count,
                                 mpsi_exact *sums);

/* Sparse exchange of messages: received ones are the context's memory, freed with
 * mpsi_domain_free_mail. */
typedef struct mpsi_mail {
  int32_t rank;
  int64_t bytes;
  void *data;
} mpsi_mail;
typedef struct mpsi_mailbox {
  mps_context *context;
  mpsi_mail *mail; /* in order of rank */
  int32_t count, room;
} mpsi_mailbox;
mps_status mpsi_domain_exchange(mps_domain *domain, const char *function, int32_t count,
                                const mps_domain_message *messages, mpsi_mailbox *box);
/* The same where the caller agrees on its status afterwards. */
mps_status mpsi_domain_post(mps_domain *domain, const char *function, int32_t count,
                            const mps_domain_message *messages, mpsi_mailbox *box);
void mpsi_domain_free_mail(mpsi_mailbox *box); /* not collective */

/* gather.c: the first `rows` of a value's rows on each rank, one behind the other, on rank 0. */
mps_status mpsi_domain_gather_rows(mps_domain *domain, const char *function, int64_t rows,
                                   mpsi_value *value);

/* rows.c: calls `take` on rank 0 with the particles of all ranks in the order of the whole set,
 * which come in pieces: no rank has memory for all of them. Status of all ranks. `take` calls
 * source->begin, and returns source->status where that is an error. */
typedef mps_status mpsi_take_rows_fn(void *user, mpsi_row_source *source);
mps_status mpsi_domain_write_rows(mps_domain *domain, const char *function,
                                  mps_particles *particles, mpsi_take_rows_fn *take, void *user);
