/* partition.h - the part of a body that one rank computes, where its particles lie on several
 * ranks.
 *
 * A rank has whole blocks of cells with their particles, and a list of ghosts: blocks of other
 * ranks beside its own, whose tiles cover nodes that its own ones cover. In each step a rank sums
 * its own particles into tiles and sends those of its border, the blocks that are ghosts elsewhere;
 * every rank that has a block of nodes adds the same tiles to it in the same order, that of the
 * colours (blocks.h), and updates it by itself. So one message a step is enough, and every node has
 * the bits that it has on one rank. Blocks of nodes that only ghosts cover would have part of their
 * sums: they are left alone.
 *
 * Sums over blocks of nodes count each on the rank of the first block of cells that covers it.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PARTITION_H
#define MPSI_MPM_PARTITION_H

#include "mpm/base/parts.h"
#include "core/particles/particles_internal.h"
#include "domain/halo.h"
#include "core/base/room.h"
#include "curve_orientation.h"

#include <mps/mpm.h>

typedef struct mpsi_partition {
  mps_domain *domain;
  mpsi_halo *halo;         /* of tiles; NULL: none yet */
  bool outdated;           /* the ghosts are not those of the present blocks */
  int64_t searches;        /* for ghosts that have been made */
  bool ready;              /* all ranks passed the checks of the last step; no field edited since */
  int64_t borders, ghosts; /* own blocks that others have copies of; copies here */
  int32_t *border;         /* numbers of the blocks of cells */
  int32_t *ghost_rank;     /* of each copy */
  int32_t most;            /* nodes of the widest part of a tile in use, on all ranks */
  bool apart, thin; /* some tile that is sent has forces, is parted, in the step being made; */
  int32_t penalty_bodies; /* most tiles of penalty contact, one a body, that go with a tile */
  int32_t item;           /* bytes of a parcel: a tile on its way, or other sums */
  double *out, *in;       /* parcels */
  int64_t *first;         /* of each rank: the first key on the curve of its blocks (curve.h) */
  mpsi_curve_orientation orientation; /* how the curve lies over the blocks */
  double heaviest;                    /* particles of the rank that had most, after the last cut */
  bool cancel;                        /* a hook has cancelled the run, on any rank */
  mps_status lost;                    /* of a message in the step being made */
  mpsi_room border_room, rank_room, out_room, in_room;
} mpsi_partition;

/* partition.c: leaves a solver that is made, with the whole set on each rank, this rank's share.
 * `status`: of the call so far on this rank. Collective, as all of the following but where they
 * say so. */
mps_status mpsi_mpm_partition_create(mps_mpm *mpm, const char *function, mps_status status,
                                     mpsi_storage **former);
/* The first part of that: whether all ranks take part. */
mps_status mpsi_mpm_share_begin(mps_mpm *mpm, const char *function, mps_status status);
/* deal.c: the same of a set in parts, before the solver has added its fields: particles go to the
 * ranks of their blocks; partition.c: once it has, and blocks are found. */
mps_status mpsi_mpm_share_deal(mps_mpm *mpm, const char *function, mps_status status);
mps_status mpsi_mpm_share_take_part(mps_mpm *mpm, const char *function, mps_status status);
/* Not collective. */
void mpsi_mpm_partition_free(mps_mpm *mpm);
/* owners.c: cuts the curve again for blocks in grid.cells, which all ranks or (`whole`) each has
 * all of; the owner of a block (not collective). */
mps_status mpsi_mpm_partition_cut(mps_context *context, const mpsi_grid *grid,
                                  mpsi_partition *partition, const char *function, bool whole);
int32_t mpsi_mpm_block_owner(const mpsi_grid *grid, mpsi_partition *partition, const int32_t *at);
/* owners.c: particles of blocks of cells that are not this rank's go to their owners; `moved` where
 * particles were sent or received. */
mps_status mpsi_mpm_partition_migrate(mps_mpm *mpm, const char *function, mps_status status,
                                      bool *moved);
/* partition.c: sorts, and finds the ghosts; the latter alone, where they are outdated. */
mps_status mpsi_mpm_partition_sort(mps_mpm *mpm, const char *function);
mps_status mpsi_mpm_partition_find_ghosts(mps_mpm *mpm, const char *function);
/* collective_status.c: the worst status of all ranks. */
mps_status mpsi_mpm_agree(mpsi_partition *partition, const char *function, mps_status status);
/* collective_status.c: the same, and whether all have the same time and bodies; with the greatest
 * of `count` values. In a step also whether signals have given all the same. */
mps_status mpsi_mpm_agree_alike(const mpsi_contacts *contacts, mpsi_partition *partition,
                                const mpsi_run *run, const mps_mpm_def *def, const char *function,
                                mps_status status, int32_t count, double *values);
mps_status mpsi_mpm_agree_in_step(mps_mpm *mpm, const char *function, mps_status status,
                                  int32_t count, double *values);
/* collective_status.c: MPS_ERROR_ARGUMENT unless these are particles of the set, on whatever rank;
 * first all agree on `status`, that of this rank. */
mps_status mpsi_mpm_check_ids(mps_context *context, const mpsi_columns *p,
                              mpsi_partition *partition, const char *function, mps_status status,
                              int64_t count, const int64_t *ids);
/* collective_status.c: whether a sum over blocks of nodes counts g here. Not collective. */
bool mpsi_mpm_counts_node_block(const mpsi_grid *grid, int64_t g);
/* collective_status.c: whether all that reaches g is known here, its own or as a ghost. Not
 * collective. */
bool mpsi_mpm_node_block_complete(const mpsi_grid *grid, int64_t g);

/* row_order.c: as the holder of the set (mpsi_holder): rows by blocks, in the order of one rank;
 * before particles leave the set, on one rank too, the blocks follow. Not collective. */
int64_t mpsi_mpm_row_runs(const void *mpm, mpsi_row_run *out);
void mpsi_mpm_thin_out(void *mpm, const uint8_t *gone);
/* collective_status.c: as the holder of the set, what the caller adds and removes. */
mps_status mpsi_mpm_agree_on_insertion(void *mpm, const char *function, mps_status status,
                                       int64_t first);
mps_status mpsi_mpm_find_removed(void *mpm, const char *function, mps_status status, int64_t count,
                                 const int64_t *ids, int64_t known, int64_t *all);
/* owners.c: of the particles from `first` on, which all ranks have, those stay that are this
 * rank's. */
mps_status mpsi_mpm_keep_own_inserted(mps_context *context, const mpsi_grid *grid, mpsi_columns *p,
                                      mpsi_water *water, mpsi_partition *partition,
                                      const char *function, mps_status status, int64_t first);

/* partition.c: before the blocks are used: sorted or not, ghosts are those of the present ones. */
mps_status mpsi_mpm_partition_update(mps_mpm *mpm, const char *function, mps_status status);
/* collective_status.c: whether some rank has it. */
mps_status mpsi_mpm_any_rank(mpsi_partition *partition, const char *function, bool *any);
/* collective_status.c: what the callers of all ranks have edited. */
mps_status mpsi_mpm_compare_edits(const mpsi_contacts *contacts, mpsi_partition *partition,
                                  mpsi_run *run, const mps_mpm_def *def, const char *function,
                                  mps_status status);

#endif
