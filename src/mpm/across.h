/* across.h - thin bodies: those with a wall below two cells. Such a wall has nodes of the grid on
 * its one side within the stencils of particles on the other, and must not pass momentum on through
 * them. So a node has two sets of values: its own, of the particles that see it, and those across,
 * of the particles from which a thin body parts it: the straight way from particle to node leads
 * through the body. A node in such a body stands where its nearest point of the surface is. No
 * support is cut there: the nodes in the body take part as all others.
 *
 * Which is asked for each particle and node, not for the whole body: so it holds beside the ends
 * and edges of plates and piles, where the ground is connected, and of meshes. Three sides that
 * meet within a stencil are not told apart: two thin walls within two cells of each other.
 *
 * Values across have blocks of nodes of their own, behind those that the particles reach
 * (mpsi_all_nodes), and a second tile; they are found anew before each step. By springs
 * (MPS_CONTACT_METHOD_PENALTY) nothing is parted. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_ACROSS_H
#define MPSI_MPM_ACROSS_H

#include <mps/mpm.h>

struct mpsi_cell_block;
struct mpsi_node_block;

#define MPSI_THIN_CELLS 2.0 /* walls below are thin */

/* A node, for a thin body near it. */
typedef struct mpsi_sight {
  double at[3];     /* m, where it stands: itself, or in the body the surface nearest to it */
  double distance;  /* m, from there to the body */
  double normal[3]; /* of the surface at its foot */
} mpsi_sight;

/* Which bodies part particles in the step being made; room for what is known of nodes. */
bool mpsi_mpm_begin_across(mps_mpm *mpm);
/* The nodes of block g for its bodies that do; those beside them are marked. */
void mpsi_mpm_find_sight(mps_mpm *mpm, int64_t g);
/* The blocks of cells and nodes concerned being known, those across; false: memory refused. */
bool mpsi_mpm_list_across(mps_mpm *mpm);
/* Bit 16 k + 4 j + i: node (i, j, k) of the stencil from tile node `base` is across for a particle
 * at x[3] (m). */
uint64_t mpsi_mpm_find_across(const mps_mpm *mpm, const struct mpsi_cell_block *cells,
                              const int *base, const double *x);

#endif
