/* partition.h - the part of a body that one rank computes, where its particles lie on several
 * ranks.
 *
 * A rank has whole blocks of cells with their particles, and a list of ghosts: blocks of other
 * ranks beside its own, whose tiles cover nodes that its own ones cover. In each step a rank sums
 * its own particles into tiles and sends those of its border, the blocks that are ghosts elsewhere;
 * every rank that has a block of nodes adds the same tiles to it in the same order, that of the
 * colours (blocks.h), and updates its replica. So one message a step is enough, and every node has
 * the bits that it has on one rank. Blocks of nodes that only ghosts cover would have incomplete
 * sums: they are not updated.
 *
 * In sums over blocks of nodes each is counted on the rank of the first block of cells that covers
 * it. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include "core/particles/particles_internal.h"
#include "domain/halo.h"
#include "core/base/room.h"
#include "curve_orientation.h"

#include <mps/mpm.h>

typedef struct mpsi_partition {
  mps_domain *domain;
  mpsi_halo *halo;         /* exchange of tiles; NULL: none yet */
  bool outdated;           /* the ghosts are not those of the present blocks */
  int64_t searches;        /* for ghosts that have been made */
  bool ready;              /* all ranks passed the checks of the last step; no field edited since */
  int64_t borders, ghosts; /* own blocks that are ghosts elsewhere; ghosts here */
  int32_t *border;         /* indices of the former in grid.cells */
  int32_t *ghost_rank;     /* owner of each ghost */
  int32_t most;            /* nodes of the widest part of a tile in use, on all ranks */
  bool apart, thin; /* some tile that is sent has forces, values across thin bodies, in the step
                       being made */
  int32_t penalty_bodies; /* most tiles of penalty contact, one a body, that are sent with a tile */
  int64_t doubles;        /* length of the messages under way (messages.h), */
  const char *function;   /* and the function of the caller that sends them */
  int64_t *first;         /* for each rank, the first key of its blocks on the curve (curve.h) */
  mpsi_curve_orientation orientation; /* orientation of the curve over the blocks */
  double heaviest;                    /* largest number of particles of a rank after the last cut */
  bool cancel;                        /* a hook of any rank has cancelled the run */
  mps_status lost;                    /* status of the messages in the step being made */
  mpsi_room border_room, rank_room, out_room, in_room; /* out, in: messages */
} mpsi_partition;

/* What the functions of this room work on: the particles of this rank, their blocks of cells and
 * the partition. */
struct mpsi_rank_part {
  mps_context *context;
  mpsi_grid *grid;
  mpsi_columns *p;
  mpsi_rooms *rooms;
  mpsi_water *water; /* NULL: none */
  const mpsi_contacts *contact;
  mpsi_run *run;
  const mps_mpm_def *def;
  mpsi_partition *partition;
};

/* partition.c: a new partition, which has no blocks yet. `status`: of the call so far on this rank.
 * Collective, as all of the following unless noted. */
mps_status mpsi_mpm_share_begin(mps_context *context, const mpsi_columns *p, mps_domain *domain,
                                const char *function, mps_status status, mpsi_partition **out);
/* partition.c: reduces a solver made with the whole set on each rank to this rank's part. */
mps_status mpsi_mpm_partition_create(const mpsi_rank_part *part, const char *function,
                                     mpsi_storage **former);
/* deal.c: for a set in parts, before the solver has added its fields: sends particles to the ranks
 * of their blocks; partition.c: the rest, with the fields added and the blocks found. */
mps_status mpsi_mpm_share_deal(const mpsi_rank_part *part, const char *function);
mps_status mpsi_mpm_share_take_part(const mpsi_rank_part *part, const char *function,
                                    mps_status status);
/* Not collective. */
void mpsi_mpm_partition_free(mps_context *context, mpsi_partition **partition);
/* owners.c: cuts the curve again for the blocks in grid.cells, which are parts on each rank or
 * (`whole`) the same on all; owner of a block (not collective). */
mps_status mpsi_mpm_partition_cut(mps_context *context, const mpsi_grid *grid,
                                  mpsi_partition *partition, const char *function, bool whole);
int32_t mpsi_mpm_block_owner(const mpsi_grid *grid, mpsi_partition *partition, const int32_t *at);
/* owners.c: sends particles in blocks of other ranks to these; `moved`: particles were sent or
 * received. */
mps_status mpsi_mpm_partition_migrate(const mpsi_rank_part *part, const char *function,
                                      mps_status status, bool *moved);
/* partition.c: sorts and finds the ghosts; finds the ghosts alone, where they are outdated. */
mps_status mpsi_mpm_partition_sort(const mpsi_rank_part *part, const char *function);
mps_status mpsi_mpm_partition_find_ghosts(const mpsi_rank_part *part, const char *function);
/* collective_status.c: the worst status of all ranks. */
mps_status mpsi_mpm_agree(mpsi_partition *partition, const char *function, mps_status status);
/* collective_status.c: the worst status, whether all ranks have the same time and bodies, and the
 * largest of `count` values. */
mps_status mpsi_mpm_agree_alike(const mpsi_contacts *contacts, mpsi_partition *partition,
                                const mpsi_run *run, const mps_mpm_def *def, const char *function,
                                mps_status status, int32_t count, double *values);
/* collective_status.c: state that is equal on all ranks: time, step, positions of bodies. */
void mpsi_mpm_give_state(const mpsi_contacts *contacts, const mpsi_run *run, const mps_mpm_def *def,
                         mpsi_given *list);
/* collective_status.c: whether sums over blocks of nodes count block g on this rank. Not
 * collective. */
bool mpsi_mpm_counts_node_block(const mpsi_grid *grid, int64_t g);
/* collective_status.c: whether this rank has all blocks of cells that cover block g, its own or as
 * ghosts. Not collective. */
bool mpsi_mpm_node_block_complete(const mpsi_grid *grid, int64_t g);

/* row_order.c: order of this rank's rows in the whole set (mpsi_holder), by blocks, as on one rank,
 * to `out` unless it is NULL; returns the number of runs. Updates the blocks before particles
 * marked in `gone` are removed, on one rank too. Neither is collective. */
int64_t mpsi_mpm_list_rows(const mpsi_grid *grid, const mpsi_columns *p, mpsi_row_run *out);
void mpsi_mpm_close_gaps(mpsi_grid *grid, const uint8_t *gone);
/* collective_status.c: whether all ranks add the same particles, from `first` on; number of the
 * particles on all ranks that a list names, of which this rank knows `known`: each rank lists
 * particles that it has, or all ranks the same list. */
mps_status mpsi_mpm_compare_added(const mpsi_grid *grid, const mpsi_columns *p,
                                  mpsi_partition *partition, const char *function,
                                  mps_status status, int64_t first);
mps_status mpsi_mpm_count_listed(mps_context *context, mpsi_partition *partition,
                                 const char *function, mps_status status, int64_t count,
                                 const int64_t *ids, int64_t known, int64_t *all);
/* owners.c: keeps, of the particles from `first` on, which all ranks have, those in blocks of this
 * rank. */
mps_status mpsi_mpm_keep_own_inserted(const mpsi_rank_part *part, const char *function,
                                      mps_status status, int64_t first);

/* collective_status.c: whether `any` is true on some rank. */
mps_status mpsi_mpm_any_rank(mpsi_partition *partition, const char *function, bool *any);
/* collective_status.c: agreement on what the callers of all ranks have edited. */
mps_status mpsi_mpm_compare_edits(const mpsi_contacts *contacts, mpsi_partition *partition,
                                  mpsi_run *run, const mps_mpm_def *def, const char *function,
                                  mps_status status);
