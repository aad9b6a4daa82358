/* mirror.h - plane walls without friction, and the axis, as mirrors. The stencils of particles near
 * a wall stay complete: they include ghosts, nodes beyond the wall, which are images of their
 * partners, the nodes as far inside. A tile (blocks.h) contains both, so that the particles of one
 * block of cells are folded and mirrored back independently of other blocks, axis by axis: after
 * P2G mass m_g, momentum q_g and force f_g of a ghost are added to its partner,
 *
 *   m_j += m_g,  q_j += R q_g + m_g (I - R) v_w,  f_j += R f_g,
 *
 * and before G2P, in the opposite order of axes, v_g = R v_j + (I - R) v_w. R = I - 2 n n^T at a
 * roller and the axis, -I at a fixed wall; v_w is the velocity of the wall. Nodes on the wall are
 * prescribed by walls.c. docs/theory/walls.md has the derivation.
 *
 * The changes of momentum by folding, and of the particles' velocities by mirroring back, are the
 * rest of the wall's impulse. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/grid/blocks.h"
#include "boundaries.h"

/* A mirrored side under the tile of a block of cells, in the step being made. */
typedef struct mpsi_mirror {
  double impulse[3], moment[3]; /* N s, N m s, on the particles */
  double passed; /* J, dt f_g . (I - R) v_w: work of the particles' forces at no node */
} mpsi_mirror;

typedef struct mpsi_mirrors {
  uint32_t sides; /* bit k: side k is a mirror */
  mpsi_mirror *mirror;
  double *mass; /* kg, of the ghosts next to the wall: a plane of a tile for each mirror, followed
                   by those of the second tiles (thin_bodies.h) */
  int64_t count;
  mpsi_room mirror_room, mass_room;
} mpsi_mirrors;

/* Whether boundary k is a side that is a mirror. */
static inline bool mpsi_is_mirror(const mpsi_mirrors *mirrors, int32_t k) {
  return k < MPSI_SIDES && (mirrors->sides >> k & 1) != 0;
}

/* Number of nodes of a plane across a tile. */
static inline int64_t mpsi_mirror_plane(int32_t tile_nodes) { return tile_nodes / MPSI_TILE_SIDE; }

/* Finds the sides that are mirrors, the blocks of cells beside one, and those with a node outside
 * that no mirror replaces. */
mps_status mpsi_mpm_list_mirrors(mps_context *context, mpsi_grid *grid,
                                 const mpsi_boundaries *boundaries, mpsi_mirrors *all,
                                 const mps_mpm_def *def, const char *function);
/* Sets the impulses of a block's mirrors to zero, before P2G. */
void mpsi_mpm_begin_mirrors(const mpsi_mirrors *mirrors, const mpsi_cell_block *cells);
/* Folds the tile of a block after P2G; mirrors it back before G2P. */
void mpsi_mpm_fold(const mpsi_transfer *work);
void mpsi_mpm_unfold(const mpsi_transfer *work);
/* Copies the states of partners to ghosts: these are in the same bodies. */
void mpsi_mpm_mirror_states(const mpsi_transfer *work);
/* After the step: adds the impulses of the mirrors to the reactions of their sides. */
void mpsi_mpm_sum_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                          const mpsi_mirrors *mirrors, mpsi_energy *energy);

/* Tile node along axis c, or its partner where it is beyond a mirror. */
int mpsi_mpm_mirror_partner(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int node);
/* Reflects a momentum or force at tile node `at`, a ghost or on a wall, to its partner; `at`
 * becomes the partner. `impulse` times the change is added to the wall's impulse. */
void mpsi_mpm_reflect(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                      double *vector, double impulse);

/* Reflects an impulse likewise, with its work. */
void mpsi_mpm_reflect_impulse(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                              const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                              const double *impulse);
/* Velocity at tile node `at` by that of its partner, which `at` becomes: `keeps` (by component)
 * times the partner's velocity, and `carried`. Returns whether the node is a ghost or on a wall. */
bool mpsi_mpm_find_image(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                         const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                         double *keeps, double *carried);
