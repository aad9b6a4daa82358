/* migrate.h - migration of particles to the ranks that own them.
 *
 * A sender passes its columns, of 8 bytes a particle, and the rows that leave; a receiver allocates
 * memory for `arriving` rows and unpacks them:
 *
 *   mpsi_census before;
 *   status = mpsi_census_take(domain, f, count, id, &before);           in debug builds
 *   status = mpsi_migrate(domain, f, &leaving, &box, &arriving);
 *   close the gaps of the rows that left, make room for `arriving` more behind, then
 *   mpsi_migrate_unpack(&box, columns, column, first);
 *   mpsi_domain_free_mail(&box);
 *   status = mpsi_census_check(domain, f, count, id, &before);          in debug builds
 *
 * Rows arrive in the order of their senders, and of each in its own order: sort them by block and
 * id, not by arrival. SPDX-License-Identifier: BSD-3-Clause
 * */
#pragma once

#include "domain_internal.h"

typedef struct mpsi_leaving {
  int64_t count;
  const int64_t *row; /* in the columns, of each that leaves */
  const int32_t *to;  /* receiving rank: another one */
  int32_t columns;    /* the same on all ranks; the first has the ids */
  const void *const *column;
} mpsi_leaving;

/* Sends them. Collective. On an error, which all ranks get alike (MPS_ERROR_ARGUMENT: a rank that
 * there is not, or this one; columns not the same on all; MPS_ERROR_MEMORY), nothing has changed on
 * any rank and `box` is empty. Nothing is copied but into messages: the columns stay the caller's.
 */
mps_status mpsi_migrate(mps_domain *domain, const char *function, const mpsi_leaving *leaving,
                        mpsi_mailbox *box, int64_t *arriving);
/* Writes the received rows to rows first, first + 1 ... of columns with memory for them. Not
 * collective, no errors. */
void mpsi_migrate_unpack(const mpsi_mailbox *box, int32_t columns, void *const *column,
                         int64_t first);

/* Census of the ids on all ranks: their number, and two sums that change when one is lost, doubled
 * or changed. */
typedef struct mpsi_census {
  int64_t count, sum, mixed;
} mpsi_census;

/* Collective, one reduction. */
mps_status mpsi_census_take(mps_domain *domain, const char *function, int64_t count,
                            const int64_t *id, mpsi_census *out);
/* MPS_ERROR_INTERNAL on all ranks, with both counts, where the ids are not those of `before`. */
mps_status mpsi_census_check(mps_domain *domain, const char *function, int64_t count,
                             const int64_t *id, const mpsi_census *before);
