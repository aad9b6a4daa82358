/* boundaries.h - what is not free: sides of the domain, boxes of nodes and particles with a
 * prescribed velocity, dashpots of absorbing sides. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_BOUNDARIES_H
#define MPSI_MPM_BOUNDARIES_H

#include "mpm/base/parts.h"
#include "core/base/exact.h"
#include "core/state/state.h"
#include "mpm/life/restart.h"
#include "core/base/room.h"

enum { MPSI_BOUNDARY_NONE = -1 }; /* besides mps_boundary_kind */

/* What a boundary has given, of this rank's share, exactly: no sum depends on order or ranks. */
enum {
  MPSI_BOUNDARY_IMPULSE = 0,
  MPSI_BOUNDARY_MOMENT = 3,
  MPSI_BOUNDARY_WORK = 6,
  MPSI_BOUNDARY_MASS = 7
};
typedef struct mpsi_boundary_sums {
  mpsi_exact step[MPSI_BOUNDARY_MASS]; /* N s, N m s, J, in the last step; */
  mpsi_exact
      all[MPSI_BOUNDARY_MASS + 1]; /* before it; and kg, of particles that it has taken out */
} mpsi_boundary_sums;

/* A boundary: nodes first to last, or the particles `ids`. */
typedef struct mpsi_boundary {
  int32_t kind;              /* mps_boundary_kind, or MPSI_BOUNDARY_NONE; a FREE side is NONE */
  int32_t axis;              /* across a side */
  int64_t first[3], last[3]; /* nodes */
  int64_t *ids;              /* NULL: nodes */
  int64_t id_count;
  uint32_t dofs; /* bit c: component c is prescribed */
  double friction, settle;
  mps_signal *signal[3];
  double factor[3];
  double v[3];              /* m/s, of the step being made */
  mpsi_boundary_sums *sums; /* there with every boundary, and as long as its number */
  int64_t count, removed;   /* as in mps_reaction, of this rank's share */
  bool finds;               /* absorbing: still looks for the forces at rest */
  double found;             /* s, how long it has looked, with the step being made */
} mpsi_boundary;

/* Nodes of a block that a side or box holds, from low to high. */
typedef struct mpsi_range {
  int low[3], high[3];
} mpsi_range;

/* Of the block at `at`; false: none. */
static inline bool mpsi_find_range(int dim, const int32_t *at, const mpsi_boundary *hold,
                                   mpsi_range *out) {
  for (int c = 0; c < 3; c++) {
    const int64_t first = (int64_t)at[c] * MPSI_SIDE;
    const int64_t last = first + (c < dim ? MPSI_SIDE - 1 : 0);
    if (hold->first[c] > last || hold->last[c] < first) return false;
    out->low[c] = hold->first[c] > first ? (int)(hold->first[c] - first) : 0;
    out->high[c] = (int)((hold->last[c] < last ? hold->last[c] : last) - first);
  }
  return true;
}

/* What a hold holds of a block. */
typedef struct mpsi_held {
  int32_t hold, at[3];          /* at: of the block */
  int64_t dashpot;              /* absorbing: first of its plane's dashpots, else -1 */
  double impulse[3], moment[3]; /* N s, N m s, of the step being made */
  double work;                  /* J, likewise */
  int64_t count;                /* nodes with mass */
  bool counted;                 /* in sums: on other ranks it may be there too, but not counted */
  bool whole;                   /* all particles that reach the nodes are known to this rank */
} mpsi_held;

typedef struct mpsi_boundaries {
  mpsi_boundary *hold; /* by number: the sides, then those added */
  int32_t holds;       /* numbers in use, with those of boundaries that are no more */
  mpsi_room hold_room;
  mpsi_held *held;
  mpsi_dashpot *dashpot;
  int64_t held_count, dashpot_count;
  uint32_t open;   /* bit k: side k is open, in the step being made */
  bool outdated;   /* the lists are not of the present boundaries and laws */
  double dt;       /* s, of the step whose sums are kept */
  mpsi_exact work; /* J, of boundaries that are no more */
  mpsi_room held_room, dashpot_room, old_held_room, old_dashpot_room;
  mpsi_room warm_room; /* dashpots of a state to restore, until ranks have its blocks */
  int64_t warm;
} mpsi_boundaries;

/* Sums of the dashpots of blocks, of each side a plane of the tile: across and along. */
#define MPSI_DASH_PLANE (MPSI_TILE_SIDE * MPSI_TILE_SIDE)
typedef struct mpsi_dashpot_parcels {
  double *out, *in;
  int64_t doubles; /* of a plane */
} mpsi_dashpot_parcels;

/* walls.c: which blocks of nodes are held, after a sort. `status`: of the call so
 * far here; collective where sides absorb. */
mps_status mpsi_mpm_list_boundaries(mps_mpm *mpm, const char *function, mps_status status);
/* walls.c: the same where they are outdated. */
mps_status mpsi_mpm_update_boundaries(mps_mpm *mpm, const char *function, mps_status status);
/* walls.c: the same with dashpots as they were at an earlier sort. */
mps_status mpsi_mpm_put_dashpots(mps_mpm *mpm, const char *function, int64_t count,
                                 const mpsi_dashpot *dashpot);
/* walls.c: on several ranks the ghosts must be found before: the dashpots are kept till then, in
 * warm_room, which has room for them; then, collective, both. */
void mpsi_mpm_keep_dashpots(mpsi_boundaries *boundaries, int64_t count,
                            const mpsi_dashpot *dashpot);
mps_status mpsi_mpm_regain_share(mps_mpm *mpm, const char *function);
/* walls.c: the time at rest of absorbing walls grows by dt. */
void mpsi_mpm_begin_boundaries(const mpsi_boundaries *boundaries, double dt);
void mpsi_mpm_boundary_add_impulse(mpsi_boundary *hold, const double *impulse, const double *moment,
                                   double work, int64_t count);
/* boundaries.c: J, all that boundaries have done. */
void mpsi_mpm_boundary_add_works(const mpsi_boundaries *boundaries, mpsi_exact *sum);
/* walls.c: before all others: no impulses yet on the held nodes of a block. */
void mpsi_mpm_begin_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int64_t g);
/* walls.c: mirrored sides alone, also before the forces: for friction with bodies, which must see
 * nodes on a mirror as their own images. */
void mpsi_mpm_prescribe_mirrors(mps_mpm *mpm, int64_t g);
/* `fixed`: of each node, bit c where a boundary alone moves component c; left where none acts. */
void mpsi_mpm_prescribe_nodes(mps_mpm *mpm, int64_t g, uint8_t *fixed);
void mpsi_mpm_sum_boundaries(const mpsi_grid *grid, mpsi_boundaries *boundaries,
                             const mpsi_mirrors *mirrors, mpsi_energy *energy, double dt);
/* walls.c: after G2P, the particles of the lists. */
void mpsi_mpm_drive_particles(const mpsi_grid *grid, const mpsi_columns *p,
                              const mpsi_boundaries *boundaries, mpsi_energy *energy, double dt);
/* boundaries.c: rollers on the sides of a new solver; frees all. */
bool mpsi_mpm_begin_sides(mps_context *context, const mpsi_grid *grid,
                          mpsi_boundaries *boundaries); /* hold_room has room; false: no memory */
void mpsi_mpm_drop_boundaries(mps_context *context, const mpsi_boundaries *boundaries);
/* boundaries.c: sides hold the nodes beyond them too, where the standard method has some. */
mps_status mpsi_mpm_widen_sides(mps_context *context, const mpsi_grid *grid,
                                mpsi_boundaries *boundaries, const char *function);
/* absorb.c: dashpots of the absorbing sides, after a sort, taking over the forces at rest from the
 * list before (`parcels`: of other ranks, or NULL); one of them at work: the velocity of its node
 * across and along; what a block gives to those of a side, false: nothing; order of the list;
 * whether a side absorbs. */
void mpsi_mpm_place_dashpots(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, const mpsi_dashpot_parcels *parcels,
                             const mpsi_held *old, int64_t old_count,
                             const mpsi_dashpot *old_dashpot);
bool mpsi_mpm_sum_dashpots(const mpsi_grid *grid, const mpsi_columns *p,
                           const mpsi_boundaries *boundaries, const mpsi_cell_block *cells,
                           int32_t side, double (*tile)[2]);
int mpsi_mpm_compare_held(const mpsi_held *a, const mpsi_held *b);
bool mpsi_mpm_absorbs(const mpsi_boundaries *boundaries);
/* dashpots.c: the same for all ranks, collective. */
mps_status mpsi_mpm_exchange_dashpots(mps_context *context, const mpsi_grid *grid,
                                      const mpsi_columns *p, const mpsi_boundaries *boundaries,
                                      mpsi_partition *partition, const char *function,
                                      const mpsi_held *old, int64_t old_count,
                                      const mpsi_dashpot *old_dashpot);
/* The dashpots of a file: those of all ranks in its order, on rank 0; and back, those of the blocks
 * of nodes that this rank knows, of a file with these blocks of cells. `status` as ever. */
mps_status mpsi_mpm_gather_dashpots(mps_context *context, const mpsi_grid *grid,
                                    const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                    const char *function, mpsi_value *dashpots);
mps_status mpsi_mpm_take_dashpots(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                  const char *function, const mpsi_value *blocks,
                                  mpsi_value *dashpots);
void mpsi_mpm_apply_dashpot(const mpsi_grid *grid, double dt, const mpsi_boundary *hold,
                            mpsi_dashpot *dashpot, const double *node, const double *before,
                            double *velocity);

#endif
