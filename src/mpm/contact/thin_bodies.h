/* thin_bodies.h - thin bodies: those with a wall below two cells. Nodes on one side of such a wall
 * lie within the stencils of particles on the other, and must not pass momentum through it. So a
 * node has two sets of values: its own, of the particles that see it, and those across, of the
 * particles from which a thin body separates it: the straight line from particle to node crosses
 * the body. A node inside the body belongs to the side of its nearest point of the surface. No
 * support is cut there: the nodes in the body take part as all others.
 *
 * The line is tested for each particle and node, not for the whole body: so the rule holds beside
 * the ends and edges of plates and piles, where the ground is connected, and for meshes. Three
 * sides that lie within one stencil are not distinguished: two thin walls within two cells of each
 * other.
 *
 * Values across have blocks of nodes of their own, behind the nodes in the particles' supports
 * (mpsi_all_nodes), and a second tile; they are rebuilt before each step. With penalty contact
 * (MPS_CONTACT_METHOD_PENALTY) no node is two-sided. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_THIN_BODIES_H
#define MPSI_MPM_THIN_BODIES_H

#include "mpm/base/parts.h"

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

/* Nodes of a particle's stencil, bit 16 k + 4 j + i that of node (i, j, k). */
typedef struct mpsi_parted {
  uint64_t across; /* of participating nodes their values across do */
  uint64_t cut;    /* do not take part */
} mpsi_parted;

/* Which bodies part particles in the step being made; room for what is known of nodes. */
bool mpsi_mpm_begin_across(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                           mpsi_contacts *contact);
/* The nodes of block g for its bodies that do; those beside them are marked. */
void mpsi_mpm_find_sight(const mpsi_grid *grid, const mpsi_contacts *contacts, int64_t g);
/* The blocks of cells and nodes concerned being known, those across; false: memory refused. */
bool mpsi_mpm_list_across(mps_context *context, mpsi_grid *grid, mpsi_mirrors *mirrors,
                          const mpsi_contacts *contacts);
/* Which nodes of the stencil from tile node `base` are across for a particle at x[3] (m), and which
 * of them lie too deep to take part, unless they are corners of its own cell. */
mpsi_parted mpsi_mpm_find_parted(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                 const struct mpsi_cell_block *cells, const int *base,
                                 const double *x);

#endif
