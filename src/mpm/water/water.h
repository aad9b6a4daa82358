/* water.h - water in the pores (mps/pore_water.h): pressures of cells, the flow between them, and
 * what the particles carry. A cell is the box above its node of the grid, and has the node's
 * number. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_WATER_H
#define MPSI_MPM_WATER_H

#include "mpm/base/mpm_solver.h"

#include <mps/pore_water.h>

#define MPSI_PORE_FASTEST 1.0 /* m/s, of permeabilities */

/* What is beyond a face of a cell. */
enum { MPSI_PORE_CELL, MPSI_PORE_CLOSED, MPSI_PORE_DRAINED };

enum { MPSI_PORE_BITS = 3, MPSI_PORE_BLOCK = 1 << (3 * MPSI_PORE_BITS) };
_Static_assert(1 << MPSI_PORE_BITS == MPSI_SIDE, "digits of a cell's number in its block");

/* Sums over the particles of a cell, and the means that follow; amounts are of the measure, the
 * rest of 1 m or 1 rad. */
typedef struct mpsi_pore_cell {
  double volume;    /* sum V, m3; 0: there is nothing here */
  double change;    /* sum of dV of the step, m3 */
  double p, g[3];   /* Pa, at the centre of the cell's box; Pa/m */
  double n, k;      /* porosity; m/s */
  double now, gain; /* Pa, at the end of the step; m3/s of water that flows in */
  uint8_t free;     /* bit d: nothing lies beyond face d, but perhaps a body */
  bool inside;      /* there are cells on all its faces; never in axisymmetry */
  bool thin;        /* less than half full at a drained surface: stores nothing */
} mpsi_pore_cell;

/* What a cell that is not inside has besides. */
typedef struct mpsi_pore_edge {
  double fill[3], shift[3]; /* part of the box that is filled along each axis; m, from the box's
                               centre to that of the filled part */
  double space;             /* m3, of the filled part */
  int8_t beyond[6];         /* MPSI_PORE_... of each face */
  int8_t face[6];           /* number of the definition, -1: none */
} mpsi_pore_edge;

enum { MPSI_PORE_FACES = MPS_PORE_MAX_FACES + 1 }; /* the last: the free surface without one */

struct mpsi_water {
  mps_pore_water_def def;
  bool flows;
  mps_pore_face_def face[MPS_PORE_MAX_FACES];
  int64_t faces;
  double start;                       /* kg, of the measure */
  double drained[MPSI_PORE_FACES];    /* kg */
  double rate[MPSI_PORE_FACES];       /* kg/s, of the last step */
  mpsi_pore_cell *cell;               /* by nodes of the grid */
  mpsi_pore_edge *edge;               /* the same: few are in use */
  int32_t *beside;                    /* by blocks of nodes: the 6 beside, or -1 */
  double (*outflow)[MPSI_PORE_FACES]; /* m3/s, by blocks of nodes */
  double *former;                     /* m3, volumes at the beginning of the step */
  uint16_t *place;                    /* the cell of each particle: mpsi_pore_cell_at */
  double *seepage[3];                 /* of the set, or NULL */
  mpsi_room cell_room, edge_room, beside_room, outflow_room, former_room, place_room;
};

/* The cell at `place` of a block of cells: the block of nodes under its tile, times the
 * nodes of one, and the number in that. Its centre to centre[3] (m). */
static inline mpsi_pore_cell *mpsi_pore_cell_at(const mpsi_grid *grid, mpsi_water *water,
                                                const mpsi_cell_block *cells, int place,
                                                double *centre) {
  const int corner = place / MPSI_PORE_BLOCK, local = place % MPSI_PORE_BLOCK;
  int at[3];
  mpsi_unravel(local, MPSI_SIDE, at);
  for (int c = 0; c < grid->dim; c++) {
    const int64_t cell = ((int64_t)cells->at[c] + (corner >> c & 1)) * MPSI_SIDE + at[c];
    centre[c] = grid->origin[c] + grid->cell * ((double)cell + 0.5);
  }
  return water->cell + mpsi_first_node(grid, cells->to[corner]) + local;
}

static inline bool mpsi_pore_empty(const mpsi_pore_cell *cell) {
  return !cell || !(cell->volume > 0.0);
}
/* Radius (m) that volumes and faces are multiplied by at grid coordinate X; 1 but in axisymmetry.
 */
static inline double mpsi_pore_radius(const mpsi_grid *grid, double X) {
  if (grid->geometry != MPS_MPM_GEOMETRY_AXISYMMETRIC) return 1.0;
  return grid->origin[0] + X * grid->cell;
}

/* Of a cell that is inside: one that is filled, with cells on all faces. */
static inline const mpsi_pore_edge *mpsi_pore_edge_of(mpsi_water *water,
                                                      const mpsi_pore_cell *cell) {
  static const mpsi_pore_edge whole = {.fill = {1.0, 1.0, 1.0}, .face = {-1, -1, -1, -1, -1, -1}};
  return cell->inside ? &whole : water->edge + (cell - water->cell);
}
/* The one beside cell k of block g, or NULL. */
static inline mpsi_pore_cell *mpsi_pore_beside(const mpsi_grid *grid, mpsi_water *water, int64_t g,
                                               int k, int direction) {
  const int digit = MPSI_PORE_BITS * (direction / 2), stride = 1 << digit;
  const int place = k >> digit & (MPSI_SIDE - 1), last = direction & 1 ? MPSI_SIDE - 1 : 0;
  const int step = direction & 1 ? stride : -stride;
  if (place != last) return water->cell + mpsi_first_node(grid, g) + k + step;
  const int32_t block = water->beside[6 * g + direction];
  if (block < 0) return NULL;
  return water->cell + mpsi_first_node(grid, block) + k - (MPSI_SIDE - 1) * step;
}
/* What the pressure of a cell grows by in the step without flow, Pa. */
static inline double mpsi_pore_squeeze(mpsi_water *water, const mpsi_pore_cell *cell) {
  return -water->def.bulk / cell->n * (cell->change / (cell->volume - cell->change));
}
/* cells.c: sums of the particles, then faces and the filled part of each cell, and without flow its
 * pressure at the end of the step. */
void mpsi_pore_find_cells(mps_mpm *mpm);
/* flow.c: pressures at the end of the step; then their slopes, and what the particles take. */
void mpsi_pore_flow(mps_mpm *mpm);

/* update.c: before the scatter of a step: room, and the stress with the water's part. */
mps_status mpsi_pore_begin(mps_mpm *mpm, const char *function);
/* update.c: after a step whose values are numbers. */
void mpsi_pore_update(mps_mpm *mpm);
/* state.c: values that the caller has written: MPS_ERROR_ARGUMENT names the particle. */
mps_status mpsi_pore_check(mps_context *context, const mpsi_columns *p, mpsi_water *water,
                           const char *function);
/* state.c: of the water in the particles' pores, kg of the measure. */
double mpsi_pore_mass(const mpsi_columns *p, mpsi_water *water);
/* state.c: the state besides the fields; what is freed with the solver. */
void mpsi_pore_list_state(mpsi_state *state, mpsi_water *water);
void mpsi_pore_free(mps_mpm *mpm);

#endif
