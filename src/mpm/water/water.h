/* water.h - water in the pores (mps/experimental/pore_water.h): pressures of cells, the flow
 * between them, and what the particles carry. A cell is the box above its node of the grid, and has
 * the node's number. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/order.h"
#include "core/base/exact.h"
#include "mpm/base/mpm_solver.h"

#include <mps/experimental/pore_water.h>

typedef struct mpsi_pore_halo mpsi_pore_halo;       /* halo.h */
typedef struct mpsi_pore_system mpsi_pore_system;   /* system.h */
typedef struct mpsi_pore_outside mpsi_pore_outside; /* solve/outside.h */

#define MPSI_PORE_FASTEST 1.0 /* m/s, of permeabilities */

/* What is beyond a face of a cell. */
enum { MPSI_PORE_CELL, MPSI_PORE_CLOSED, MPSI_PORE_DRAINED };

enum { MPSI_PORE_BITS = 3, MPSI_PORE_WORDS = MPSI_SIDE };
_Static_assert(1 << MPSI_PORE_BITS == MPSI_SIDE, "digits of a cell's number in its block");
_Static_assert(MPSI_SIDE *MPSI_SIDE == 64, "a word of marks is a plane of cells");

/* Sums over the particles of a cell, and the means that follow; amounts are of the measure, the
 * rest of 1 m or 1 rad. Defined where the cell is filled. */
typedef struct mpsi_pore_cell {
  double volume;    /* sum V, m3 */
  double change;    /* sum of dV of the step, m3 */
  double p, n;      /* Pa, at the centre of the cell's box; porosity */
  double k, g[3];   /* m/s; Pa/m */
  double now, gain; /* Pa, at the end of the step; m3/s of water that flows in */
  uint8_t free;     /* bit d: nothing lies beyond face d, but perhaps a body */
  bool inside;      /* there are cells on all its faces; never in axisymmetry */
  bool thin;        /* less than half full at a drained surface: stores nothing */
} mpsi_pore_cell;

/* A block of cells of the water: those above a block of nodes. Marks are bits by the cells'
 * numbers, a word for each plane along z. */
typedef struct mpsi_pore_block {
  uint64_t filled[MPSI_PORE_WORDS]; /* there are particles */
  uint64_t full[MPSI_PORE_WORDS];   /* and no face is free */
  uint64_t inside[MPSI_PORE_WORDS]; /* cells that are `inside`; only of the rank's own blocks */
  int32_t beside[6];                /* numbers of the blocks beside it, or -1 */
} mpsi_pore_block;

/* What a cell that is not inside has besides. */
typedef struct mpsi_pore_faces {
  double fill[3], shift[3]; /* part of the box that is filled along each axis; m, from the box's
                               centre to that of the filled part */
  double space;             /* m3, of the filled part */
  int8_t beyond[6];         /* MPSI_PORE_... of each face */
  int8_t face[6];           /* number of the definition, -1: none */
} mpsi_pore_faces;

/* Of a cell at a side while it has what the column of a free-field side has there. */
typedef struct mpsi_pore_column_cell {
  double volume, p, g;  /* sums over the column's particles */
  mpsi_pore_cell *cell; /* NULL: none */
  mpsi_pore_cell was;
  int64_t block;
  int place;
} mpsi_pore_column_cell;

enum {
  MPSI_PORE_FACES = MPS_PORE_MAX_FACES + 1, /* the last: the free surface without one */
  MPSI_PORE_RATES
};

#define MPSI_PORE_PLACES (MPSI_TILE_SIDE * MPSI_TILE_SIDE * MPSI_TILE_SIDE)

struct mpsi_water {
  mps_pore_water_def def;
  bool expecting; /* sums of particles, and what they take of their cells, are before the motion of
                     a step with implicit pressures (flow.c) */
  bool noted;     /* `rest` is what the motion has made besides (cells.c) */
  bool flows;
  double viscosity; /* Pa s, of the change of volume, in the forces (README.md) */
  double share;     /* of the slopes between cells, which particles take in this exchange */
  mps_pore_face_def face[MPS_PORE_MAX_FACES];
  int64_t face_count;
  mpsi_exact start; /* kg, of the measure; on several ranks, as the next two, of what this counts */
  mpsi_exact drained[MPSI_PORE_FACES]; /* kg */
  mpsi_exact rate[MPSI_PORE_FACES];    /* kg/s, of the last step */
  mpsi_exact entered;                  /* kg, through all faces */
  mpsi_pore_cell *cell;               /* by nodes of the grid, then those of other ranks (halo.h) */
  mpsi_pore_faces *faces;             /* the same: few are in use */
  mpsi_pore_block *block;             /* by blocks of nodes, then those of other ranks */
  double (*outflow)[MPSI_PORE_RATES]; /* m3/s, by blocks of nodes: of each face, and what enters */
  double *former; /* m3, volumes at the beginning of the step; where pressures are implicit */
  double *rest;   /* of particles, what cells have sums of, where pressures are implicit: before the
                     motion V (u - slow), Pa m3; after it the change of volume, m3, that the pressures
                     did not expect (cells.c), between them the volume that they did */
  uint16_t *place; /* of each particle, in the tile of its block: the lowest node of its stencil in
                      the step, and MPSI_PORE_PLACES times the borders of its cell that it lies on
                      (digits of base 3 by axis: 0 none, 1 above, 2 below); then, for implicit.c,
                      its cell */
  int64_t steps;   /* since the last exchange between cells */
  double elapsed;  /* s, the same; in an exchange the time that it is for */
  bool due;        /* this step has one */
  double *seepage[3];            /* of the set, or NULL */
  int64_t linked;                /* blocks of nodes for which `beside` was found, */
  int32_t (*linked_at)[3];       /* and where they were */
  mpsi_pore_column_cell *column; /* by nodes of a column */
  mpsi_room column_room, cell_room, faces_room, block_room, outflow_room, former_room, rest_room,
      place_room, linked_room;
  mpsi_pore_halo *halo;       /* on several ranks, else NULL */
  mpsi_pore_system *system;   /* where pressures are implicit, else NULL */
  mpsi_pore_outside *outside; /* memory of their rows for a linear solver of the caller, or NULL */
};

/* Number of the rank's own block of nodes at `at`, or -1: the list is in order. */
static inline int32_t mpsi_pore_own_block(const mpsi_grid *grid, const int32_t *at) {
  int64_t low;
  MPSI_BISECT(low, grid->node_count, middle, mpsi_block_before(grid->nodes[middle].at, at));
  const bool found = low < grid->node_count && !mpsi_block_before(at, grid->nodes[low].at);
  return found && !grid->nodes[low].foreign ? (int32_t)low : -1;
}

/* The part of a tile that its particles may be in after a step: a cell more on each side than
 * before it. A particle's cell is that above the lowest node of its stencil or, of quadratic
 * weights, that or the one before; along x, stencils have four nodes (g2p.c). */
static inline void mpsi_pore_region(const mpsi_grid *grid, const mpsi_cell_block *cells, int *low,
                                    int *high) {
  for (int c = 0; c < 3; c++) {
    const int before = grid->spline == 2 && cells->low[c] > 0 ? 1 : 0;
    const int behind = grid->spline == 3 || c == 0 ? 1 : 0;
    low[c] = c < grid->dim ? cells->low[c] - before : 0;
    high[c] = c < grid->dim ? cells->high[c] - behind : 1;
  }
}

static inline bool mpsi_pore_marked(const uint64_t *marks, int k) {
  return (marks[k >> 6] >> (k & 63) & 1) != 0;
}
static inline void mpsi_pore_mark(uint64_t *marks, int k) {
  marks[k >> 6] |= UINT64_C(1) << (k & 63);
}
/* Number of the lowest of the bits that are set, of which there is one. */
static inline int mpsi_pore_lowest(uint64_t bits) { return __builtin_ctzll(bits); }

/* Radius (m) that volumes and faces are multiplied by at grid coordinate X; 1 but in axisymmetry.
 */
static inline double mpsi_pore_radius(const mpsi_grid *grid, double X) {
  if (grid->geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC) return 1.0;
  return grid->origin[0] + X * grid->cell;
}

/* Of a cell that is inside: one that is filled, with cells on all faces. */
static inline const mpsi_pore_faces *mpsi_pore_faces_of(mpsi_water *water,
                                                        const mpsi_pore_cell *cell) {
  static const mpsi_pore_faces inner = {.fill = {1.0, 1.0, 1.0}, .face = {-1, -1, -1, -1, -1, -1}};
  return cell->inside ? &inner : water->faces + (cell - water->cell);
}
/* The block beside cell k of block g, or -1, and the place there: *k. */
static inline int32_t mpsi_pore_step(const mpsi_water *water, int64_t g, int *k, int direction) {
  const int digit = MPSI_PORE_BITS * (direction / 2), stride = 1 << digit;
  const int place = *k >> digit & (MPSI_SIDE - 1), last = direction & 1 ? MPSI_SIDE - 1 : 0;
  const int step = direction & 1 ? stride : -stride;
  *k += place != last ? step : -(MPSI_SIDE - 1) * step;
  return place != last ? (int32_t)g : water->block[g].beside[direction];
}
/* The filled cell beside cell k of block g, or NULL. */
static inline mpsi_pore_cell *mpsi_pore_beside(const mpsi_grid *grid, mpsi_water *water, int64_t g,
                                               int k, int direction) {
  const int32_t block = mpsi_pore_step(water, g, &k, direction);
  if (block < 0 || !mpsi_pore_marked(water->block[block].filled, k)) return NULL;
  return water->cell + mpsi_first_node(grid, block) + k;
}
/* faces.c: cells of a block with `filled` or `full` cells on all faces, to out[MPSI_PORE_WORDS]. */
void mpsi_pore_surrounded(const mpsi_grid *grid, const mpsi_water *water, int64_t g, bool full,
                          uint64_t *out);
/* What the pressure of a cell grows by in the step without flow, Pa. */
static inline double mpsi_pore_squeeze(mpsi_water *water, const mpsi_pore_cell *cell) {
  return -(water->def.bulk * cell->change) / (cell->n * (cell->volume - cell->change));
}
/* Whether the pressures of particles follow their volumes in each step, and cells exchange water
 * and smooth pressures every few steps. */
static inline bool mpsi_pore_responds(const mpsi_water *water) {
  return water && water->def.scheme == MPS_PORE_SCHEME_EXPLICIT;
}
/* flow.c: porosity, permeability and pressure of a particle, after a volume of `former` (m3). */
void mpsi_pore_follow(const mpsi_columns *p, const mpsi_water *water, int64_t k, double former);
/* update.c: at the beginning of a step of run.dt: whether cells exchange after it. */
void mpsi_pore_plan(mps_mpm *mpm);
/* cells.c: before the G2P of block of cells b, where pressures are implicit: keeps the volumes of
 * its particles, which are in the cache then. */
void mpsi_pore_keep_volumes(mps_mpm *mpm, int64_t b);
/* cells.c: to `rest` before the motion, and after that the pressures `slow` go on. */
void mpsi_pore_find_ahead(mps_mpm *mpm);
void mpsi_pore_follow_means(mps_mpm *mpm);
/* cells.c: after the laws, before the filter of their mean stresses, which changes volumes without
 * a motion: what the motion has taken of the volumes besides what the implicit pressures expected.
 */
void mpsi_pore_note_rest(mps_mpm *mpm);
/* cells.c: the pressures that P2G has are the present ones from here on: at the beginning, and
 * where the caller has written pressures. */
void mpsi_pore_begin_means(const mpsi_columns *p);
/* cells.c: sums of the particles and their means: which cells are filled, and with what. */
void mpsi_pore_find_cells(mps_mpm *mpm);
/* faces.c: what lies beyond the faces of the cells, their filled parts, and without flow their
 * pressures at the end of the step. */
void mpsi_pore_find_faces(mps_mpm *mpm);
/* flow.c: after the step, and after mpsi_pore_flow where cells exchange: the columns of free-field
 * sides do so too. */
void mpsi_pore_update_columns(mps_mpm *mpm);
/* flow.c: pressures at the end of the step; then their slopes, and what the particles take. */
void mpsi_pore_flow(mps_mpm *mpm);
/* Whether pressures are found before the particles move. */
static inline bool mpsi_pore_predicts(const mps_mpm *mpm) {
  return mpm->water && mpm->water->def.scheme == MPS_PORE_SCHEME_IMPLICIT;
}
/* flow.c: after the scatter, before contacts: what implicit pressures are above those that P2G had,
 * to the velocities of the nodes. Changes no particle. Collective. */
mps_status mpsi_pore_press(mps_mpm *mpm, const char *function);
/* contacts.c: before the sweeps of contacts with implicit pressures: the velocities that contacts
 * aim at are those before viscous damping, which acts on the nodes after them. Else the ground
 * below a body that pushes it would be slower than the body, and the matrix would have that in the
 * pressures. */
void mpsi_pore_aim_contacts(mps_mpm *mpm);
/* flow.c: after contacts, before the particles move: implicit pressures, and the velocities that
 * they correct. Collective. */
mps_status mpsi_pore_predict(mps_mpm *mpm, const char *function);
/* implicit.c: after the motion: the forces of mirrors on what these pressures push beyond them. */
void mpsi_pore_add_reactions(mps_mpm *mpm);

/* update.c: before the scatter of a step: room for its cells. On several ranks collective where the
 * blocks are others than in the last step; `status`: of the step so far on this rank. */
mps_status mpsi_pore_begin(mps_mpm *mpm, const char *function, mps_status status);
/* update.c: how the pressures are advanced from now on, with the wave speeds of the blocks. */
void mpsi_pore_set_scheme(mps_mpm *mpm, int32_t scheme);
/* update.c: after a step whose values are numbers. On several ranks a failure of the transport
 * stays in the partition. */
void mpsi_pore_update(mps_mpm *mpm);
/* bounds.c: after the laws: marks particles with values that no step can make as bad in their
 * blocks of cells. */
void mpsi_pore_check_step(mps_mpm *mpm);
/* bounds.c: what of particle k is not possible, or false: nothing. */
bool mpsi_pore_describe(const mps_mpm *mpm, int64_t k, char *out, size_t size);
/* state.c: values that the caller has written: MPS_ERROR_ARGUMENT names the particle. */
mps_status mpsi_pore_check(mps_context *context, const mpsi_columns *p, mpsi_water *water,
                           const char *function);
/* state.c: adds the water in the pores of this rank's particles, kg of the measure. */
void mpsi_pore_mass(const mpsi_columns *p, mpsi_water *water, mpsi_exact *sum);
/* state.c: the state besides the fields; what is freed with the solver. */
void mpsi_pore_list_state(mpsi_state *state, mpsi_water *water);
void mpsi_pore_free(mps_mpm *mpm);
