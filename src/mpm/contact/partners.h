/* partners.h - contact partners: ranks whose constraints change nodes of one another, directly or
 * by constraints of third ranks (exchange.h). Two blocks of cells have nodes in common where they
 * are neighbours. A rank knows its own blocks and, as ghosts, the neighbours of these, and receives
 * with their tiles whether they have constraints; which ranks are linked is one reduction.
 * Constraints that reach neither constraints nor blocks of another rank are not sent. A free body
 * couples all of its constraints: then all ranks with constraints are partners.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "core/base/room.h"

#include <mps/experimental/domain.h>
#include <mps/mpm.h>

struct mpsi_contacts;
struct mpsi_grid;
struct mpsi_partition;

#define MPSI_MOST_PARTNERS 256 /* most ranks for which the matrix of links is kept */

typedef struct mpsi_contact_partners {
  int64_t *words; /* the sums that ranks reduce: partners.c */
  uint64_t *own;  /* bit r: rank r is a partner, or this rank */
  bool any;       /* some rank has a partner */
  mpsi_room words_room, own_room;
} mpsi_contact_partners;

/* Allocates for the ranks of a domain, before the first contact. Not collective. */
mps_status mpsi_mpm_begin_partners(mpsi_contact_partners *partners, mps_domain *domain,
                                   const char *function);
/* Marks this rank's blocks of cells that have constraints or areas, before their tiles are sent. */
void mpsi_mpm_mark_contact_blocks(const struct mpsi_contacts *contacts, struct mpsi_grid *grid);
/* Finds the partner ranks, and the blocks whose constraints are sent to them
 * (mpsi_cell_block.sent). `constraints`: number on all ranks. All ranks first agree on `status`.
 * Collective. */
mps_status mpsi_mpm_find_partners(struct mpsi_contacts *contacts, const struct mpsi_grid *grid,
                                  const struct mpsi_partition *partition, const char *function,
                                  mps_status status, int64_t *constraints);
/* Whether a rank is a partner, or this rank. */
bool mpsi_mpm_is_partner(const mpsi_contact_partners *partners, int32_t rank);
void mpsi_mpm_free_partners(mpsi_contact_partners *partners, mps_context *context);
