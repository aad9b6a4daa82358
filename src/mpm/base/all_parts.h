/* all_parts.h - all parts of the solver, each from the header of its room, and short queries of
 * them. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_ALL_PARTS_H
#define MPSI_MPM_ALL_PARTS_H

#include "core/particles/particles_internal.h"
#include "mpm/grid/blocks.h"
#include "mpm/contact/thin_bodies.h"
#include "mpm/boundary/boundaries.h"
#include "columns.h"
#include "mpm/step/damping.h"
#include "energy.h"
#include "mpm/particles/loads.h"
#include "mpm/boundary/mirror.h"
#include "mpm/contact/pairs.h"
#include "run.h"
#include "mpm/ranks/partition.h"
#include "mpm/step/undo.h"
#include "mpm/particles/rooms.h"

/* Whether each node needs its velocity before the forces, so that all blocks are split. */
static inline bool mpsi_forces_apart(const mpsi_energy *energy, const mpsi_settling *settling,
                                     const mps_mpm_def *def) {
  return energy->counts || settling->on || def->local_damping > 0.0 || def->flip_time > 0.0;
}

/* Fraction of the velocity that the nodes do not represent that particles keep in a step of dt. */
static inline double mpsi_kept_fraction(const mps_mpm_def *def, double dt) {
  return def->flip_time > 0.0 ? exp(-dt / def->flip_time) : 0.0;
}

static inline const mpsi_law_use *mpsi_law_of(const mpsi_columns *p, int64_t particle) {
  return &p->laws.law[p->law ? p->law[particle] : 0];
}

/* Factor of the elastic moduli of a particle's law. */
static inline double mpsi_mpm_stiffness(const mpsi_columns *p, int64_t particle) {
  const double *factor = mpsi_law_of(p, particle)->stiffness;
  return factor && factor[particle] > 0.0 ? factor[particle] : 1.0;
}

/* K + 4G/3 and G (Pa) of a particle's material at zero strain. */
static inline void mpsi_mpm_elastic(const mpsi_columns *p, int64_t particle, double *wave,
                                    double *shear) {
  const mps_material *material = mpsi_law_of(p, particle)->material;
  const double factor = mpsi_mpm_stiffness(p, particle);
  *wave = factor * mpsi_material_rest_modulus(material);
  *shear = factor * mpsi_material_shear(material);
}

/* K + 4G/3 and G (Pa) of dashpots: waves go through the water of saturated ground too. Where it
 * flows as well: it hardly does within a wave of several cells, whose period is far below (a wave
 * length)^2/c_v. */
static inline void mpsi_mpm_saturated(const mpsi_columns *p, int64_t particle, double *wave,
                                      double *shear) {
  mpsi_mpm_elastic(p, particle, wave, shear);
  if (p->n) *wave += p->K_w / p->n[particle];
}

/* Cell of a particle at grid coordinate X; on the upper wall, the last cell. */
static inline int64_t mpsi_own_cell(const mpsi_grid *grid, int c, double X) {
  const int64_t cell = (int64_t)floor(X);
  return cell < grid->high[c] ? cell : grid->high[c] - 1;
}

/* Whether X, outside the domain along axis c, lies beyond a side that is open. */
static inline bool mpsi_mpm_passes(const mpsi_grid *grid, const mpsi_boundaries *boundaries, int c,
                                   double X) {
  const bool upper = X > (double)grid->high[c];
  return (upper || X < (double)grid->low[c]) &&
         (boundaries->open >> (2 * c + (upper ? 1 : 0)) & 1) != 0;
}

/* Number of nodes of a stencil beyond its lowest along axis c, as the loops read and write them:
 * four nodes along x whatever the spline. */
static inline int32_t mpsi_reach(const mpsi_grid *grid, int c) { return c == 0 ? 3 : grid->spline; }

/* Bytes of scratch memory of one worker. */
static inline size_t mpsi_worker_bytes(const mpsi_grid *grid) {
  return (size_t)grid->tile_nodes * (3 * sizeof(mpsi_node) + 1) + sizeof(uint64_t);
}

static inline int64_t mpsi_first_node(const mpsi_grid *grid, int64_t g) {
  return mpsi_grid_first_node(grid, g);
}

/* Position x[3] (m) of the node with the coordinates `local` in the block at `at`. */
static inline void mpsi_node_position(const mpsi_grid *grid, const int32_t *at, const double *local,
                                      double *x) {
  for (int c = 0; c < 3; c++)
    x[c] =
        c < grid->dim ? grid->origin[c] + grid->cell * ((double)at[c] * MPSI_SIDE + local[c]) : 0.0;
}

/* Position x[3] (m) of node k of the block of nodes at `at`. */
static inline void mpsi_node_place(const mpsi_grid *grid, const int32_t *at, int k, double *x) {
  int place[3];
  mpsi_unravel(k, MPSI_SIDE, place);
  const double local[3] = {place[0], place[1], place[2]};
  mpsi_node_position(grid, at, local, x);
}

/* Block of nodes under the node (i, j, k) of a tile; number of the node in it. */
static inline int32_t mpsi_block_under(const mpsi_cell_block *cells, int i, int j, int k) {
  return cells->to[(i >= MPSI_SIDE) + 2 * (j >= MPSI_SIDE) + 4 * (k >= MPSI_SIDE)];
}

static inline int mpsi_local_under(int i, int j, int k) {
  return ((k % MPSI_SIDE) * MPSI_SIDE + j % MPSI_SIDE) * MPSI_SIDE + i % MPSI_SIDE;
}

/* Node of the grid under the node (i, j, k) of a tile. */
static inline int64_t mpsi_node_under(const mpsi_grid *grid, const mpsi_cell_block *cells, int i,
                                      int j, int k) {
  return mpsi_first_node(grid, mpsi_block_under(cells, i, j, k)) + mpsi_local_under(i, j, k);
}

/* Number in grid->side of what a split node, or that across thin bodies, under the node (i, j, k)
 * of a tile had before the forces. */
static inline int64_t mpsi_side_under(const mpsi_grid *grid, const mpsi_cell_block *cells,
                                      bool across, int i, int j, int k) {
  const int32_t own = mpsi_block_under(cells, i, j, k);
  const mpsi_node_block *nodes = &grid->nodes[across ? grid->nodes[own].across : own];
  return mpsi_first_node(grid, nodes->side) + mpsi_local_under(i, j, k);
}

/* Node of the grid with the values across thin bodies under the node (i, j, k) of a tile. */
static inline int64_t mpsi_node_across(const mpsi_grid *grid, const mpsi_cell_block *cells, int i,
                                       int j, int k) {
  const int32_t across = grid->nodes[mpsi_block_under(cells, i, j, k)].across;
  return mpsi_first_node(grid, across) + mpsi_local_under(i, j, k);
}

#endif
