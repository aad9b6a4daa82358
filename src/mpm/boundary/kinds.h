/* kinds.h - what each kind of boundary does, one row a kind: to the nodes of the domain's sides and
 * of boxes (walls.c), to mirrors (mirror.c) and so to friction with bodies there, to the forces and
 * velocities of pore water (water/forces.c, foresee.c), to free-field columns between such sides
 * (free_field_step.c), to particles that pass. A new kind is a row and, where no other kind does
 * the same to a node, a function of walls.c with its line in the order there.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "boundaries.h"

#include <mps/solver.h>

/* Components of the velocity of a node on a side that are prescribed, and that a mirror there
 * turns. */
typedef enum mpsi_prescribes {
  MPSI_PRESCRIBES_NONE,
  MPSI_PRESCRIBES_ACROSS,
  MPSI_PRESCRIBES_ALL /* in a box: those of `dofs` */
} mpsi_prescribes;

/* Whether a side is a mirror: with `walls` of the definition, or whatever these are. */
typedef enum mpsi_mirrored {
  MPSI_MIRROR_NEVER,
  MPSI_MIRROR_WALLS,
  MPSI_MIRROR_ALWAYS
} mpsi_mirrored;

/* When a kind acts on a node: those that act normal to walls come before friction, as where two
 * walls join friction along one must not move a node into the other. */
typedef enum mpsi_boundary_turn {
  MPSI_TURN_NEVER,
  MPSI_TURN_ACROSS,
  MPSI_TURN_DASHPOTS,
  MPSI_TURN_COLUMN,
  MPSI_TURN_FRICTION,
  MPSI_TURN_SIDES,
  MPSI_TURN_BOXES,
  MPSI_TURNS
} mpsi_boundary_turn;

typedef struct mpsi_boundary_kind {
  mpsi_boundary_turn turn;
  mpsi_prescribes prescribes;
  mpsi_mirrored mirror;
  bool absorbs;  /* by dashpots at its nodes, after it has found its forces at rest */
  bool friction; /* bears a velocity into it, with Coulomb's friction along it */
  bool column;   /* a column of soil moves beside it (free_field.h) */
  bool open;     /* particles that pass it are removed */
} mpsi_boundary_kind;

/* kinds.c: by mps_boundary_kind. */
extern const mpsi_boundary_kind mpsi_boundary_kinds[];

/* What a boundary does: nothing where it is removed. */
static inline const mpsi_boundary_kind *mpsi_kind_of(const mpsi_boundary *boundary) {
  return &mpsi_boundary_kinds[boundary->kind < 0 ? MPS_BOUNDARY_FREE : boundary->kind];
}

/* Whether the side across `axis` prescribes component c, or as a mirror turns it. */
static inline bool mpsi_side_turns(const mpsi_boundary *boundary, int axis, int c) {
  const mpsi_prescribes which = mpsi_kind_of(boundary)->prescribes;
  return which == MPSI_PRESCRIBES_ALL || (which == MPSI_PRESCRIBES_ACROSS && c == axis);
}
