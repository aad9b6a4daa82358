/* mirror.h - plane walls without friction, and the axis, as mirrors. The stencils of particles near
 * a wall stay whole: they reach to ghosts, nodes beyond it, which are images of their partners, the
 * nodes as far inside. A tile (blocks.h) holds both, so that the particles of one block of cells
 * are folded and mirrored back by themselves, axis by axis: after P2G mass m_g, momentum q_g and
 * force f_g of a ghost go to its partner,
 *
 *   m_j += m_g,  q_j += R q_g + m_g (I - R) v_w,  f_j += R f_g,
 *
 * and before G2P, in the opposite order of axes, v_g = R v_j + (I - R) v_w. R = I - 2 n n^T at a
 * roller and the axis, -I at a fixed wall; v_w is the velocity of the wall. The nodes on the wall
 * are held by walls.c. docs/theory/walls.md has the derivation.
 *
 * What folding adds to the momenta, and what mirroring back adds to what the particles get, is the
 * rest of the wall's impulse. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_MIRROR_H
#define MPSI_MPM_MIRROR_H

#include "mpm/grid/blocks.h"

/* A mirrored side under the tile of a block of cells, in the step being made. */
typedef struct mpsi_mirror {
  double impulse[3], moment[3]; /* N s, N m s, on the particles */
  double passed; /* J, dt f_g . (I - R) v_w: work of the particles' forces that no node has */
} mpsi_mirror;

typedef struct mpsi_mirrors {
  uint32_t sides; /* bit k: side k is a mirror */
  mpsi_mirror *mirror;
  double *mass; /* kg, of the ghosts next to the wall: a plane of a tile for each mirror, and those
                   of the second tiles (thin_bodies.h) behind all these */
  int64_t count;
  mpsi_room mirror_room, mass_room;
} mpsi_mirrors;

#define mpsi_is_mirror(mpm, k) ((k) < MPSI_SIDES && ((mpm)->mirrors.sides >> (k)&1) != 0)

/* Nodes of a plane across a tile. */
static inline int64_t mpsi_mirror_plane(int32_t tile_nodes) { return tile_nodes / MPSI_TILE_SIDE; }

/* Which sides are mirrors, which blocks of cells have one, or a node outside that none mirrors. */
mps_status mpsi_mpm_list_mirrors(mps_context *context, mpsi_grid *grid,
                                 const mpsi_boundaries *boundaries, mpsi_mirrors *all,
                                 const mps_mpm_def *def, const char *function);
/* Before the particles of a block give: no impulses yet. */
void mpsi_mpm_begin_mirrors(const mpsi_mirrors *mirrors, const mpsi_cell_block *cells);
/* The tile of a block, after its particles have given; before they take. */
void mpsi_mpm_fold(mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker);
void mpsi_mpm_unfold(mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker);
/* Ghosts are in the bodies that their partners are in. */
void mpsi_mpm_mirror_states(const mps_mpm *mpm, const mpsi_cell_block *cells, mpsi_worker *worker);
/* After the step: the impulses of the mirrors to the reactions of their sides. */
void mpsi_mpm_sum_mirrors(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                          const mpsi_mirrors *mirrors, mpsi_energy *energy);

/* Node of the tile along axis c, or its partner where it is beyond a mirror. */
int mpsi_mpm_mirror_partner(const mpsi_grid *grid, const mpsi_cell_block *cells, int c, int node);
/* A momentum or force that a block's particle has at tile node `at`, a ghost or on a wall, as its
 * partner gets it; `at` becomes that. `impulse` times what changes is the wall's. */
void mpsi_mpm_reflect(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                      const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                      double *vector, double impulse);

/* The same for an impulse, with its work. */
void mpsi_mpm_reflect_impulse(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                              const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                              const double *impulse);
/* Velocity at tile node `at`, which becomes its partner: `keeps` (by component) times that of the
 * partner and `carried`. Whether it is a ghost or on a wall. */
bool mpsi_mpm_find_image(const mpsi_grid *grid, const mpsi_boundaries *boundaries,
                         const mpsi_mirrors *mirrors, const mpsi_cell_block *cells, int *at,
                         double *keeps, double *carried);

#endif
