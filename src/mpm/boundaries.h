/* boundaries.h - nodes that are not free: walls of the domain, boxes of nodes with a prescribed
 * velocity, dashpots of absorbing walls.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_BOUNDARIES_H
#define MPSI_MPM_BOUNDARIES_H

#include "restart.h"
#include "room.h"

enum { MPSI_HOLD_NONE = -1, MPSI_HOLD_BOX = -2 }; /* besides mps_wall */

/* Nodes that are not free: those of a wall, or in a box. */
typedef struct mpsi_hold {
  int32_t kind;              /* mps_wall, or MPSI_HOLD_... */
  int32_t axis;              /* across the wall; component that a box holds */
  int64_t first[3], last[3]; /* nodes */
  double friction;
  mps_signal *signal[3];
  double factor[3];
  double v[3];     /* m/s, of the step being made */
  double force[3]; /* N, on the particles, mean over the last step */
  bool finds;      /* absorbing: still looks for the forces at rest */
  double found;    /* s, how long it has looked, with the step being made */
} mpsi_hold;

/* The nodes of a block that a hold holds. */
typedef struct mpsi_held {
  int32_t hold, at[3]; /* at: of the block */
  int64_t dash;        /* absorbing: first of its plane's dashpots, else -1 */
  double impulse[3];   /* N s, of the step being made */
} mpsi_held;

typedef struct mpsi_boundaries {
  mpsi_hold hold[MPSI_HOLDS];
  mpsi_held *held;
  mpsi_dash *dash;
  int64_t held_count, dash_count;
  mpsi_room held_room, dash_room, old_held_room, old_dash_room;
} mpsi_boundaries;

/* walls.c: which blocks of nodes are held, after a sort; what holds them in a step of dt; the held
 * nodes of a block; the forces of the step. */
mps_status mpsi_mpm_list_holds(mps_mpm *mpm, const char *function);
/* walls.c: the same with dashpots as they were at an earlier sort. */
mps_status mpsi_mpm_put_dashes(mps_mpm *mpm, const char *function, int64_t count,
                               const mpsi_dash *dash);
void mpsi_mpm_begin_holds(mps_mpm *mpm, double dt);
void mpsi_mpm_hold_nodes(mps_mpm *mpm, int64_t g);
void mpsi_mpm_sum_holds(mps_mpm *mpm);
/* Puts a wall of a definition that has been checked in its place. */
void mpsi_mpm_place_wall(mps_mpm *mpm, int32_t number, int32_t kind, double friction);
mps_status mpsi_mpm_check_wall(mps_context *context, const char *function, int32_t axis, bool upper,
                               int32_t kind, double friction, bool on_axis, bool standard);
/* absorb.c: dashpots of the absorbing walls, after a sort, taking over the forces at rest from the
 * list before; one of them at work: the velocity of its node across and along. */
void mpsi_mpm_place_dashes(mps_mpm *mpm, const mpsi_held *old, int64_t old_count,
                           const mpsi_dash *old_dash);
void mpsi_mpm_dash(const mps_mpm *mpm, const mpsi_hold *hold, mpsi_dash *dash, const double *node,
                   const double *before, double *velocity);

#endif
