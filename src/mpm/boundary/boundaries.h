/* boundaries.h - boundary conditions: sides of the domain, boxes of nodes and lists of particles
 * with a prescribed velocity, dashpots of absorbing sides. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/grid/blocks.h"
#include "core/base/exact.h"
#include "core/state/state.h"
#include "core/base/room.h"

#define MPSI_SIDES 6              /* 2 axis + upper */
enum { MPSI_BOUNDARY_NONE = -1 }; /* besides mps_boundary_kind */

/* Dashpot at a node of an absorbing wall. */
typedef struct mpsi_dashpot {
  double across, along; /* rho c A, kg/s */
  double rest[3];       /* N, force of the wall at rest */
} mpsi_dashpot;
enum { MPSI_DASH = 5 }; /* doubles */

/* Impulse, moment and work of a boundary on this rank, as exact sums: they do not depend on the
 * order of addition or on the ranks. */
enum {
  MPSI_BOUNDARY_IMPULSE = 0,
  MPSI_BOUNDARY_MOMENT = 3,
  MPSI_BOUNDARY_WORK = 6,
  MPSI_BOUNDARY_MASS = 7
};
typedef struct mpsi_boundary_sums {
  mpsi_exact step[MPSI_BOUNDARY_MASS]; /* N s, N m s, J, in the last step; */
  mpsi_exact
      all[MPSI_BOUNDARY_MASS + 1]; /* before the last step; and kg, mass of removed particles */
} mpsi_boundary_sums;

/* A boundary condition: on the nodes `first` to `last`, or on the particles `ids`. */
typedef struct mpsi_boundary {
  int32_t kind;              /* mps_boundary_kind, or MPSI_BOUNDARY_NONE; a FREE side is NONE */
  int32_t axis;              /* normal to a side */
  int64_t first[3], last[3]; /* range of nodes, by axis */
  const int64_t *ids;        /* ids of particles, of the kept definition; NULL: acts on nodes */
  int64_t id_count;
  uint32_t dofs; /* bit c: component c is prescribed */
  double friction, settle;
  mps_signal *signal[3];
  double factor[3];
  double v[3];                   /* m/s, of the step being made */
  mpsi_boundary_sums *sums;      /* allocated with the first boundary of this number, and reused */
  int64_t count, removed;        /* as in mps_reaction, on this rank */
  struct mpsi_free_field *field; /* FREE_FIELD: its column (free_field.h), else NULL */
  bool finds;                    /* absorbing: the forces at rest are still being determined */
  double found;                  /* s, duration of that, with the step being made */
} mpsi_boundary;

/* Range of the nodes of a block that belong to a side or box, from low to high. */
typedef struct mpsi_range {
  int low[3], high[3];
} mpsi_range;

/* Range in the block at `at`; false: none of its nodes. */
static inline bool mpsi_find_range(int dim, const int32_t *at, const mpsi_boundary *boundary,
                                   mpsi_range *out) {
  for (int c = 0; c < 3; c++) {
    const int64_t first = (int64_t)at[c] * MPSI_SIDE;
    const int64_t last = first + (c < dim ? MPSI_SIDE - 1 : 0);
    if (boundary->first[c] > last || boundary->last[c] < first) return false;
    out->low[c] = boundary->first[c] > first ? (int)(boundary->first[c] - first) : 0;
    out->high[c] = (int)((boundary->last[c] < last ? boundary->last[c] : last) - first);
  }
  return true;
}

/* A boundary condition on the nodes of one block. */
typedef struct mpsi_held {
  int32_t boundary, at[3];      /* at: coordinates of the block */
  int64_t dashpot;              /* absorbing: first of its plane's dashpots, else -1 */
  int64_t borne;                /* frictional: likewise in `borne` */
  double impulse[3], moment[3]; /* N s, N m s, of the step being made */
  double work;                  /* J, likewise */
  int64_t count;                /* nodes with mass */
  bool counted; /* counted in sums; on other ranks it may exist too, but is not counted */
  bool whole;   /* this rank has all particles that reach the nodes, its own or as ghosts */
} mpsi_held;

typedef struct mpsi_boundaries {
  mpsi_boundary *boundary; /* by number: the sides, then added boundaries */
  int32_t count;           /* numbers in use, with those of removed boundaries */
  mpsi_room boundary_room;
  mpsi_held *held;
  mpsi_dashpot *dashpot;
  mpsi_borne *borne; /* Pa m3, sums over the particles in the cells at a frictional side; with
                        water, of the step being made */
  int64_t held_count, dashpot_count, borne_count;
  uint32_t open;   /* bit k: side k is open, in the step being made */
  bool outdated;   /* the lists are not those of the present blocks and boundaries */
  bool renew;      /* the coefficients of dashpots are out of date */
  mpsi_exact work; /* J, of removed boundaries */
  mpsi_room held_room, dashpot_room, borne_room, old_held_room, old_dashpot_room;
  mpsi_room warm_room; /* dashpots of a state to restore, until the blocks of this rank are known */
  int64_t warm;
} mpsi_boundaries;

/* Boundary conditions of an earlier sort, with their dashpots. */
typedef struct mpsi_held_list {
  const mpsi_held *held;
  int64_t count;
  const mpsi_dashpot *dashpot;
} mpsi_held_list;

/* What changing boundaries and listing them work on. */
struct mpsi_boundary_setup {
  mps_context *context;
  mpsi_grid *grid;
  const mpsi_columns *p;
  mpsi_boundaries *boundaries;
  mpsi_mirrors *mirrors;
  mpsi_partition *partition; /* NULL: one rank */
  mpsi_run *run;
  const mps_mpm_def *def;
  const struct mpsi_water *water; /* or NULL */
  bool has_relaxation; /* mps_mpm_settle was cancelled: particles have velocities of relaxation */
};

/* boundaries.c: boundaries by number, for life/conditions.c: whether the domain has a side; rules
 * that the table of the definition does not have; nodes of a box, and memory; then, collective, the
 * change itself, of all ranks or none; what it exerts, `status` being whether it is there. */
bool mpsi_mpm_has_side(const mpsi_grid *grid, int32_t number);
mps_status mpsi_mpm_check_boundary(const mpsi_boundary_setup *setup, const char *function,
                                   int32_t number, const mps_mpm_boundary_def *def);
mps_status mpsi_mpm_make_boundary(const mpsi_boundary_setup *setup, const char *function,
                                  int32_t number, const mps_mpm_boundary_def *def,
                                  mpsi_boundary *made);
mps_status mpsi_mpm_set_boundary(const mpsi_boundary_setup *setup, const char *function,
                                 int32_t number, const mps_mpm_boundary_def *def,
                                 const mpsi_boundary *made);
mps_status mpsi_mpm_remove_boundary(const mpsi_boundary_setup *setup, const char *function,
                                    int32_t number);
mps_status mpsi_mpm_find_reaction(const mpsi_boundary_setup *setup, const char *function,
                                  mps_status status, int32_t number, mps_reaction *out);
/* Nodes of a plane of a tile, for sums of dashpot coefficients across and along a side. */
#define MPSI_DASH_PLANE (MPSI_TILE_SIDE * MPSI_TILE_SIDE)

/* walls.c: lists the boundary conditions of each block of nodes, with the dashpots of the list
 * before, and finds the coefficients of dashpots. `status`: of the call so far on this rank;
 * collective where sides absorb. */
mps_status mpsi_mpm_list_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                    mps_status status);
/* walls.c: in a step: whether coefficients are rebuilt, every eighth step: not with a sort,
 * which depends on the blocks. */
void mpsi_mpm_plan_dashpots(mpsi_boundaries *boundaries, int64_t steps);
/* walls.c: the same where lists are outdated or coefficients out of date. */
mps_status mpsi_mpm_update_boundaries(const mpsi_boundary_setup *setup, const char *function,
                                      mps_status status);
/* walls.c: lists them, with the dashpots of an earlier sort. */
mps_status mpsi_mpm_put_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                 int64_t count, const mpsi_dashpot *dashpot);
/* walls.c: on several ranks, where ghosts must be found first: saves dashpots in warm_room, which
 * has memory for them, until mpsi_mpm_put_dashpots. */
void mpsi_mpm_keep_dashpots(mpsi_boundaries *boundaries, int64_t count,
                            const mpsi_dashpot *dashpot);
/* walls.c: adds dt to the time at rest of absorbing sides. */
void mpsi_mpm_begin_boundaries(const mpsi_boundaries *boundaries, double dt);
void mpsi_mpm_boundary_add_impulse(mpsi_boundary *boundary, const double *impulse,
                                   const double *moment, double work, int64_t count);
/* boundaries.c: adds the work (J) of all boundaries. */
void mpsi_mpm_boundary_add_works(const mpsi_boundaries *boundaries, mpsi_exact *sum);
/* walls.c: sets the impulses on the nodes of a block to zero, before the boundaries act. */
void mpsi_mpm_begin_held(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int64_t g);
/* walls.c: applies the mirrors alone, before friction with bodies, which must use nodes on a mirror
 * as their own images; to the velocities before the forces too. */
void mpsi_mpm_prescribe_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                                const mpsi_mirrors *mirrors, double dt, int64_t g);
/* Normal impulses (N s) of frictional sides at the nodes of a block. */
typedef double mpsi_side_impulses[MPSI_SIDES][MPSI_SIDE * MPSI_SIDE * MPSI_SIDE];
/* walls.c: applies all boundaries to the nodes of a block. `scratch`: for its use, with any
 * contents. `fixed`: of each node, bit c where a boundary alone determines component c; not written
 * where none acts. */
void mpsi_mpm_prescribe_nodes(const mpsi_grid *grid, const mpsi_boundaries *boundaries, double dt,
                              int64_t g, mpsi_side_impulses scratch, uint8_t *fixed);
void mpsi_mpm_sum_boundaries(const mpsi_grid *grid, mpsi_boundaries *boundaries,
                             const mpsi_mirrors *mirrors, mpsi_energy *energy);
/* boundaries.c: rollers on the sides of a new solver; frees all boundaries. */
bool mpsi_mpm_begin_sides(
    mps_context *context, const mpsi_grid *grid,
    mpsi_boundaries *boundaries); /* boundary_room has memory for them; false: no memory */
void mpsi_mpm_drop_boundaries(mps_context *context, const mpsi_boundaries *boundaries);
/* boundaries.c: extends the sides to the nodes beyond them, which the standard method has. */
mps_status mpsi_mpm_widen_sides(mps_context *context, const mpsi_grid *grid,
                                mpsi_boundaries *boundaries, const char *function);
/* absorb.c: dashpots of the list before; coefficients of the dashpots of absorbing sides, and what
 * is borne at frictional ones (`ranks`: with the messages of dashpots.c, or NULL); contribution of
 * a block to those of a side, false: none; order of the list; whether a side absorbs, or has
 * friction; velocity of a node with a dashpot. */
void mpsi_mpm_carry_dashpots(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                             const mpsi_held_list *old);
void mpsi_mpm_find_dashpots(const mpsi_grid *grid, const mpsi_columns *p,
                            const mpsi_boundaries *boundaries, const mpsi_partition *ranks);
void mpsi_mpm_sum_borne(const mpsi_grid *grid, const mpsi_columns *p,
                        const mpsi_boundaries *boundaries, const mpsi_partition *ranks);
bool mpsi_mpm_sum_at_side(const mpsi_grid *grid, const mpsi_columns *p,
                          const mpsi_boundaries *boundaries, const mpsi_cell_block *cells,
                          int32_t side, double (*tile)[2]);
int mpsi_mpm_compare_held(const mpsi_held *a, const mpsi_held *b);
bool mpsi_mpm_absorbs(const mpsi_boundaries *boundaries);
bool mpsi_mpm_has_friction(const mpsi_boundaries *boundaries);
/* dashpots.c: the two of absorb.c on several ranks. Collective. */
mps_status mpsi_mpm_send_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                  const mpsi_held_list *old);
mps_status mpsi_mpm_exchange_dashpots(const mpsi_boundary_setup *setup, const char *function,
                                      mps_status status);
/* dashpots.c: what ground and water bear at frictional sides, in a step with water, on one rank or
 * several. Collective. */
mps_status mpsi_mpm_find_borne(const mpsi_boundary_setup *setup, const char *function,
                               mps_status status);
/* The part of the normal impulse at node k of a block by which its friction is limited. */
static inline double mpsi_side_share(const mpsi_boundaries *boundaries, const mpsi_held *held,
                                     int k) {
  const int axis = boundaries->boundary[held->boundary].axis;
  return boundaries->borne_count > 0 && held->borne >= 0
             ? mpsi_ground_share(boundaries->borne[held->borne + mpsi_plane_index(axis, k)])
             : 1.0;
}
/* dashpots.c: dashpots of a checkpoint: gathers those of all ranks, in the order of the file, on
 * rank 0; keeps those of a file with these blocks of cells that lie on blocks of nodes of this
 * rank. `status` as above. */
mps_status mpsi_mpm_gather_dashpots(mps_context *context, const mpsi_grid *grid,
                                    const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                    const char *function, mpsi_value *dashpots);
mps_status mpsi_mpm_take_dashpots(mps_context *context, const mpsi_grid *grid,
                                  const mpsi_boundaries *boundaries, mpsi_partition *partition,
                                  const char *function, const mpsi_value *blocks,
                                  mpsi_value *dashpots);
void mpsi_mpm_apply_dashpot(const mpsi_grid *grid, double dt, const mpsi_boundary *boundary,
                            mpsi_dashpot *dashpot, const double *node, const double *before,
                            double *velocity);
/* outflow.c: memory for the marks of removed particles, where sides are open or bodies remove
 * particles (`bodies`); removes those that have passed open sides in the step. */
mps_status mpsi_mpm_prepare_outflow(mps_context *context, const mpsi_columns *p, mpsi_boundaries *b,
                                    mpsi_rooms *rooms, bool bodies, const char *function);
void mpsi_mpm_remove_leaving(const mpsi_grid *grid, const mpsi_columns *p,
                             const mpsi_boundaries *boundaries, mpsi_energy *energy,
                             const mpsi_rooms *rooms);

/* Whether X lies beyond a side along axis c that is open, by more than round-off. */
static inline bool mpsi_mpm_passes(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int c,
                                   double X) {
  const bool upper = X > (double)grid->high[c] + MPSI_ON_BORDER;
  return (upper || X < (double)grid->low[c] - MPSI_ON_BORDER) &&
         (boundaries->open >> (2 * c + (upper ? 1 : 0)) & 1) != 0;
}
