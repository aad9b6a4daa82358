/* domain_private.h - the members of a domain.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "domain_internal.h"

/* Numbers of a vote: a status, a tag and its negative, values. */
#define MPSI_DOMAIN_VOTE (3 + MPSI_DOMAIN_ALONG)

struct mps_domain {
  mps_context *context;
  mps_domain_def def;
  mps_status lost;               /* error of the transport, which is then not used any more */
  int64_t settled;               /* number of the last record that the ranks have agreed upon */
  int64_t calls;                 /* collective ones so far: reductions, rendezvous, copies */
  int64_t voted;                 /* number of the vote under way, or of the last one */
  bool apart;                    /* the last vote found ranks in different functions */
  double vote[MPSI_DOMAIN_VOTE]; /* under way */
  int32_t references;            /* one thread at a time: no atomics */
};

/* Records that the transport has failed; returns its status, or MPS_OK. Not collective. */
mps_status mpsi_domain_note(mps_domain *domain, const char *function, const char *callback,
                            mps_status status);
/* The transport's failure so far. Not collective. */
mps_status mpsi_domain_alive(mps_domain *domain, const char *function);
/* vote.c: this rank leaves, which the others learn from their next vote. */
void mpsi_domain_leave(mps_domain *domain);
