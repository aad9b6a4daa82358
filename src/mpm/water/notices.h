/* notices.h - which blocks of cells are near those of this rank and counted by another one: what
 * layers.c and rim.c begin with. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_WATER_NOTICES_H
#define MPSI_MPM_WATER_NOTICES_H

#include "domain/domain_internal.h"
#include "water.h"

/* A block of nodes as the rank that counts it announces it: its number there. */
typedef struct mpsi_pore_notice {
  int32_t number, at[3];
} mpsi_pore_notice;

typedef struct mpsi_pore_notices {
  int64_t *range; /* of the blocks that each rank computes (block_range.h) */
  mpsi_pore_notice *sent;
  mps_domain_message *message;
  mpsi_mailbox box; /* lists of notices, in order of rank */
} mpsi_pore_notices;

/* Fills `out`, which is to be freed whatever is returned. Collective. */
mps_status mpsi_pore_find_notices(const mps_mpm *mpm, const char *function, mpsi_pore_notices *out);
/* The number of notices of all ranks. Neither is collective. */
int64_t mpsi_pore_count_notices(const mpsi_pore_notices *notices);
void mpsi_pore_free_notices(mps_context *context, mpsi_pore_notices *notices);

#endif
