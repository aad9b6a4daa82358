/* partners.h - which ranks meet (exchange.h): those whose touches move nodes of one another, directly or
 * by touches of third ones. Two blocks of cells have nodes in common where they are neighbours. A
 * rank knows its own blocks and, as ghosts, the neighbours of these, and is told with their tiles
 * whether they have touches; who is linked to whom goes round in one sum. Touches that no other
 * rank's reach, and no other rank's blocks, stay at home. A free body is touched by all at once:
 * then all ranks with touches meet, with all of them. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARTNERS_H
#define MPSI_MPM_PARTNERS_H

#include "core/base/room.h"

#include <mps/mpm.h>

#define MPSI_MOST_PARTNERS 256 /* ranks up to which it is known who is linked to whom */

typedef struct mpsi_contact_partners {
  int64_t *words; /* what goes round: see partners.c */
  uint64_t *own;  /* bit r: rank r is to know of this one's touches, or it itself */
  bool any;       /* some rank has a mate */
  mpsi_room words_room, own_room;
} mpsi_contact_partners;

/* For the ranks of the solver's domain; false: memory refused. Not collective, nor is the next. */
bool mpsi_mpm_begin_partners(mps_mpm *mpm);
/* Marks this rank's blocks of cells that have touches or areas, before their tiles go out. */
void mpsi_mpm_mark_contact_blocks(mps_mpm *mpm);
/* Finds the mates, and which of the blocks they are to be told of (mpsi_cell_block.told).
 * `touches`: of all ranks. What has become of them, `status` here, comes first. Collective. */
mps_status mpsi_mpm_find_partners(mps_mpm *mpm, const char *function, mps_status status,
                                  int64_t *constraints);
/* Whether it is to be told of this one's touches, or it itself. */
bool mpsi_mpm_is_partner(const mps_mpm *mpm, int32_t rank);
void mpsi_mpm_free_partners(mps_mpm *mpm);

#endif
