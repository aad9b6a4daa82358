/* system.h - the system of pressures that are implicit in time (implicit.c): its memory, which
 * nodes and cells are in reach of which, and loops and sums over its blocks.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "water.h"

typedef struct mpsi_pore_wide_halo mpsi_pore_wide_halo; /* wide_halo.h */
typedef struct mpsi_pore_coarse mpsi_pore_coarse;       /* solve/coarse.h */

enum { MPSI_PORE_AROUND = 27, MPSI_PORE_SPAN = 4 }; /* blocks; nodes of a cell along each axis */
enum { MPSI_PORE_MOST_SPAN = MPSI_PORE_SPAN * MPSI_PORE_SPAN * MPSI_PORE_SPAN };

/* The box of nodes or cells in reach of a block's own: from BEFORE places before it on. */
enum { MPSI_PORE_BEFORE = MPSI_PORE_SPAN - 2, MPSI_PORE_BOX = MPSI_SIDE + 2 * MPSI_PORE_BEFORE };

/* A contact that bears in the step, with entries [first, first + entries) (contacts.c). */
typedef struct mpsi_pore_contact {
  double normal[3]; /* outward unit vector of the surface */
  double yield[3]; /* kg, 1 over the mobility of the ground's side, along the normal or each axis */
  double left[3];  /* N s/kg, what it has taken of a correction, */
  double now[3], past[3]; /* in the last iterates */
  double at[3];           /* m, where it acts */
  int32_t body;           /* number of its mover */
  int64_t constraint, first;
  int32_t entries;
  bool sticks; /* all components are held, else the normal one */
} mpsi_pore_contact;

typedef struct mpsi_pore_contact_entry {
  double psi[3]; /* of each component of the node's velocity, 0 where that is prescribed */
  int32_t node;
} mpsi_pore_contact_entry;

typedef struct mpsi_pore_contact_node {
  double mass, v[3];      /* kg, with what damping opposes; correction, m/s per s, */
  double now[3], past[3]; /* in the last iterates */
  int64_t number;         /* in the system, -1: not of this rank */
  int32_t at[3];          /* on several ranks: in the whole grid, in cells */
  int32_t slot;           /* and its place in their sums, -1: none */
  uint8_t held;           /* bit c: component c is prescribed */
  bool counted;           /* by this rank */
} mpsi_pore_contact_node;

/* A body, with the correction of its velocities (m/s and rad/s per s). */
typedef struct mpsi_pore_mover {
  mpsi_impulse_body by;
  double now[2][3], past[2][3]; /* of v and spin, in the last iterates */
} mpsi_pore_mover;

typedef struct mpsi_pore_contacts {
  mpsi_pore_mover *mover; /* by contacts of the solver */
  int32_t movers;
  mpsi_pore_contact *contact;
  mpsi_pore_contact_entry *entry;
  mpsi_pore_contact_node *node;
  int32_t *index; /* of the nodes of the grid, or of the replicas: number among `node`, or -1 */
  int64_t count, entries, nodes, indices, slots;
  bool any; /* on some rank */
  mpsi_room contact_room, entry_room, node_room, index_room, word_room, known_room, mover_room;
} mpsi_pore_contacts;

/* What forces need of a particle. */
typedef struct mpsi_pore_particle {
  double x[3], V;
  int32_t place;      /* as in mpsi_water */
  bool fitted, light; /* a body or two sides cut its support: by `fit`; see mpsi_cell_block.light */
  mpsi_kept_fit fit;
} mpsi_pore_particle;

/* Arrays by nodes of the grid are vectors of the system: values of cells. On several ranks those
 * of the wide halo follow (wide_halo.h), and its blocks those of the grid. */
struct mpsi_pore_system {
  int32_t (*around)[MPSI_PORE_AROUND]; /* by blocks: those around it, itself in the middle, or -1 */
  int32_t *reach; /* by blocks: numbers of the nodes (and cells) in reach of its own, or -1 */
  double (
      *inertia)[3]; /* kg, by nodes and components: the mass, with what dashpots and damping oppose;
                       INFINITY where the component is prescribed; 0 of nodes without mass */
  double (*velocity)[3];        /* by nodes */
  uint8_t *held;                /* by nodes: bit c, component c is prescribed */
  int32_t *row;                 /* by cells: where its forces are, -1: has no unknown */
  double (*turned)[MPSI_SIDES]; /* m2, by cells: force of mirrors on it, along their axes, per Pa */
  double *force;                /* of each filled cell [dim][span^dim]: sum V grad phi, m3/m */
  double (*conductance)[6];     /* m3/(s Pa), by cells: to those beside */
  double *diagonal;             /* m3/Pa of storage and drained faces */
  double *ahead;                /* Pa, by cells: pressures above those that P2G has the forces of */
  double *change, *residual, *direction, *product; /* Pa; m3 */
  double *inverse;                                 /* of the matrix's diagonal */
  double *space;                                   /* m3, that stores water */
  double *carried; /* m3/s, by cells: G^T v of the images of moving sides */
  double *squeeze; /* m3: what the predicted motion takes of a cell; then that over its space */
  double *part;    /* of sums, by blocks */
  int64_t unknowns, iterations; /* of all ranks; of the last step */
  mpsi_pore_contacts contacts;
  mpsi_pore_wide_halo *wide_halo; /* on several ranks, else NULL */
  mpsi_pore_coarse *coarse;  /* NULL: before the first step */
  mpsi_room around_room, inertia_room, velocity_room, held_room, row_room, force_room;
  mpsi_room turned_room, conductance_room, vector_room, reach_room, part_room;
};

static inline int mpsi_pore_box_places(const mpsi_grid *grid) {
  return grid->dim == 3 ? MPSI_PORE_BOX * MPSI_PORE_BOX * MPSI_PORE_BOX
                        : MPSI_PORE_BOX * MPSI_PORE_BOX;
}

static inline int mpsi_pore_span_nodes(const mpsi_grid *grid) {
  return grid->dim == 3 ? MPSI_PORE_MOST_SPAN : MPSI_PORE_SPAN * MPSI_PORE_SPAN;
}

/* How far places q of a span lie from the first in what is in reach of a block. */
static inline void mpsi_pore_list_shifts(const mpsi_grid *grid, int *shift) {
  for (int q = 0; q < mpsi_pore_span_nodes(grid); q++) {
    int i[3];
    mpsi_unravel(q, MPSI_PORE_SPAN, i);
    shift[q] = (i[2] * MPSI_PORE_BOX + i[1]) * MPSI_PORE_BOX + i[0];
  }
}

/* The place in `reach` of what is `before` places before place k of the block along each axis. */
static inline int mpsi_pore_place(const mpsi_grid *grid, int k, int before) {
  int at[3];
  mpsi_unravel(k, MPSI_SIDE, at);
  for (int c = 0; c < grid->dim; c++) at[c] += MPSI_PORE_BEFORE - before;
  return (at[2] * MPSI_PORE_BOX + at[1]) * MPSI_PORE_BOX + at[0];
}

/* Numbers of a cell's forces, and where they begin. */
static inline int64_t mpsi_pore_row_numbers(const mpsi_grid *grid) {
  return (int64_t)grid->dim * mpsi_pore_span_nodes(grid);
}
static inline double *mpsi_pore_row(const mpsi_grid *grid, const mpsi_pore_system *s,
                                    int64_t cell) {
  return s->force + s->row[cell] * mpsi_pore_row_numbers(grid);
}

/* Whether cell k of a block has particles, and so an unknown. */
static inline bool mpsi_pore_is_unknown(const mpsi_water *water, int64_t g, int k) {
  return mpsi_pore_marked(water->block[g].filled, k);
}

/* Particle k of a block of cells, after the scatter. */
static inline mpsi_pore_particle mpsi_pore_particle_of(const mps_mpm *mpm,
                                                       const mpsi_cell_block *cells, int64_t k) {
  const mpsi_columns *p = &mpm->p;
  mpsi_pore_particle out = {.x = {p->x[0][k], p->x[1][k], mpm->grid.dim == 3 ? p->x[2][k] : 0.0},
                            .V = p->V[k],
                            .place = mpm->water->place[k]};
  for (int q = 0; q < 1 << mpm->grid.dim; q++)
    out.light = out.light || mpm->grid.nodes[cells->to[q]].light;
  const int64_t slot = cells->first_fit < 0 ? -1 : cells->first_fit + (k - cells->begin);
  out.fitted = slot >= 0 && mpm->grid.fitted[slot] == MPSI_FITTED_CUT;
  if (out.fitted) out.fit = mpm->grid.fit[slot];
  return out;
}

/* Room for the present blocks. `status`: of the step so far on this rank; on several ranks
 * collective where the blocks are others than in the last step. MPS_ERROR_MEMORY. */
mps_status mpsi_pore_make_system(mps_mpm *mpm, const char *function, mps_status status);
void mpsi_pore_free_system(mps_context *context, mpsi_pore_system **system);

/* Node or cell `local` of block g of the grid or, behind those, of the wide halo; -1 where the wide
 * halo has none. */
int64_t mpsi_pore_number(const mpsi_grid *grid, const mpsi_pore_system *s, int64_t g, int local);
/* The node or cell at `offset` from the first of block g, in that block or one around it; or -1. */
int64_t mpsi_pore_at(const mpsi_grid *grid, const mpsi_pore_system *s, int64_t g,
                     const int *offset);
/* Number of the node at `at` (in the whole grid, in cells), -1: not known here; whether this rank
 * counts it. */
int64_t mpsi_pore_node_at(const mpsi_grid *grid, const mpsi_pore_system *s, const int32_t *at,
                          bool *counted);
/* What is in reach of each block, once a step: iterations look nothing up. */
void mpsi_pore_find_reach(mps_mpm *mpm);

/* Blocks that a loop works on. */
typedef enum mpsi_pore_blocks {
  MPSI_PORE_COUNTED,  /* those that this rank counts */
  MPSI_PORE_NEAR,     /* and those of the wide halo */
  MPSI_PORE_COMPUTED, /* those whose cells this rank computes */
  MPSI_PORE_ALL       /* all of the grid, and those of the wide halo */
} mpsi_pore_blocks;

/* Work on blocks, each by itself. */
typedef void (*mpsi_pore_task)(mps_mpm *mpm, mpsi_pore_system *s, int64_t g, double factor);
void mpsi_pore_for_blocks(mps_mpm *mpm, mpsi_pore_blocks which, mpsi_pore_task task, double factor);
/* Work on the blocks that this rank counts, and the sum over all ranks of what it leaves in `part`:
 * exact, so that it does not depend on their number. Collective. */
mps_status mpsi_pore_sum_blocks(mps_mpm *mpm, const char *function, mpsi_pore_task task,
                                double factor, double *out);
