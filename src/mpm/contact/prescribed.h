/* prescribed.h - lists of particles with a prescribed velocity, imposed on the grid. The mean
 * velocity that the nodes give a group of listed particles is constrained to the prescribed one, by
 * impulses that act on the nodes through the particles' shape functions: bilateral constraints,
 * solved by the sweeps of contact (impulses.c) after all boundaries have acted on the nodes.
 *
 * A group is the listed particles of one cell. With a constraint for each particle the smooth
 * functions of the grid could only be constant over the list and up to two cells beyond it, which
 * stiffens the body there. At the ends of a list a cell is divided in two along each axis that
 * crosses the end, so that the place of the end counts, and a list of one cell bears moments.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "pairs.h"
#include "mpm/boundary/boundaries.h"
#include "mpm/grid/blocks.h"

/* A listed particle of this rank. */
typedef struct mpsi_listed {
  int64_t particle, id; /* its index, its id */
  int32_t list;         /* number of the boundary */
  int32_t block;        /* block of cells */
  int32_t cell[3];      /* lowest node of its stencil */
  int32_t part;         /* part of a divided cell: bit c, in the upper half along axis c */
  double x[3];          /* m, before the step */
} mpsi_listed;

/* Listed particles under one constraint, consecutive in `listed`. */
typedef struct mpsi_listed_group {
  int64_t first, count;
  double mass;    /* kg, of its particles */
  double lost[3]; /* part of the impulse on components of nodes that a side or box prescribes, or of
                     nodes without mass, */
  double lost_at[3][3]; /* times the places of these nodes, m: [component of impulse][axis] */
} mpsi_listed_group;

/* A cell of a block that has listed particles, on any rank. */
typedef struct mpsi_listed_cell {
  int32_t cell[3], block[3]; /* coordinates of the cell, of the block of cells */
  int32_t list;              /* -1: of several boundaries */
} mpsi_listed_cell;

typedef struct mpsi_prescribed {
  bool on;                   /* some boundary is a list of particles */
  mpsi_contacts constraints; /* without bodies: constraints, exchange and warm-start impulses, the
                                latter as forces (N) on each particle, of the body -1 - list */
  mpsi_listed *listed;       /* by block, group and id */
  mpsi_listed_group *group;  /* by block */
  mpsi_listed_cell *cell;    /* sorted */
  int64_t *first_group;      /* first group of each block of cells, and their number */
  uint8_t *fixed;            /* of each node, bit c: a side or box prescribes component c */
  mpsi_node *before;         /* of each node, values before the boundaries, where they are needed */
  int64_t listed_count, group_count, cell_count;
  int64_t sweeps; /* of the last step */
  mpsi_room listed_room, group_room, cell_room, first_room, key_room, fixed_room, before_room;
} mpsi_prescribed;

/* Before anything of a step moves: the listed particles and their groups, and memory for their
 * constraints. `before`: the nodes' values before the boundaries are needed. Collective where some
 * boundary is a list. `stage`: that of mpsi_mpm_prescribed_stage. */
mps_status mpsi_mpm_find_prescribed(const mpsi_contact_stage *stage, const char *function,
                                    bool before, mps_status status);
static inline bool mpsi_is_list(const mpsi_boundary *boundary) {
  return boundary->kind != MPSI_BOUNDARY_NONE && boundary->ids != NULL;
}
/* groups.c: lists the particles that this rank has (`key`: of all entries, each with its cell, its
 * block and 1 + its boundary, or NULL on one rank), then, with the keys of all ranks, the groups.
 */
enum { MPSI_LISTED_KEY = 7 };
void mpsi_mpm_list_particles(const mpsi_transfer *work, mpsi_prescribed *all, int64_t *key);
void mpsi_mpm_list_groups(const mpsi_transfer *work, mpsi_prescribed *all, int64_t entries,
                          const int64_t *key);
/* Number of groups of a block of cells. */
static inline int64_t mpsi_groups_of(const mpsi_prescribed *prescribed, int64_t block) {
  return prescribed ? prescribed->first_group[block + 1] - prescribed->first_group[block] : 0;
}
/* groups.c: weights and warm start of the constraints of a block's groups; the mirrors' part of
 * their impulses, added to the walls. */
void mpsi_mpm_fit_prescribed(const mpsi_contact_stage *stage, const mpsi_transfer *work,
                             const mpsi_constraint_block *block);
void mpsi_mpm_mirror_prescribed(const mpsi_contact_stage *stage,
                                const mpsi_constraint_block *block);
/* Solves the constraints on the nodes as all boundaries have left them. Collective. */
mps_status mpsi_mpm_solve_prescribed(const mpsi_contact_stage *stage, const char *function);
/* After G2P: the listed particles get the prescribed velocity, and move by it; reactions, energies
 * and warm-start impulses. */
void mpsi_mpm_end_prescribed(const mpsi_contact_stage *stage, mpsi_energy *energy);
void mpsi_mpm_free_prescribed(mps_context *context, mpsi_prescribed *prescribed);
