/* thin_bodies.h - thin bodies: bodies with a wall below two cells. Nodes on one side of such a wall
 * lie within the stencils of particles on the other, and must not transfer momentum through it. So
 * a node is two-sided: it has its own values, of the particles on its side, and values across, of
 * the particles from which a thin body separates it: the straight line from particle to node
 * crosses the body. A node inside the body belongs to the side of its nearest point of the surface.
 * No support is cut: nodes in the body are active as all others.
 *
 * The line is tested for each particle and node, not for the whole body: so the rule is also valid
 * beside the ends and edges of plates and piles, where the ground is connected, and for meshes.
 * Three sides within one stencil, of two thin walls within two cells of each other, are not
 * distinguished.
 *
 * Values across have blocks of nodes of their own, behind the nodes in the particles' supports
 * (mpsi_all_nodes), and a second tile; they are rebuilt before each step. With penalty contact
 * (MPS_CONTACT_METHOD_PENALTY) no node is two-sided. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "mpm/base/parts.h"
#include <stdbool.h>

#include <mps/mpm.h>

struct mpsi_cell_block;
struct mpsi_node_block;

#define MPSI_THIN_CELLS 2.0 /* thinner walls make nodes two-sided */

/* Origin of the lines of sight of a node, for a thin body near it. */
typedef struct mpsi_sight {
  double at[3]; /* m, the node's position; for a node in the body a point off the nearest surface */
  double distance;  /* m, from `at` to the body */
  double normal[3]; /* of the surface at the node's foot */
} mpsi_sight;

/* Nodes of a particle's stencil, bit 16 k + 4 j + i that of node (i, j, k). */
typedef struct mpsi_parted {
  uint64_t across; /* active nodes whose values across are used */
  uint64_t cut;    /* inactive nodes */
} mpsi_parted;

/* Finds the bodies that make nodes two-sided in this step, and allocates for their nodes; false:
 * memory refused. */
bool mpsi_mpm_begin_across(mps_context *context, const mpsi_grid *grid, const mpsi_columns *p,
                           mpsi_contacts *contact);
/* Origins of lines of sight of the nodes of block g for such bodies; marks the nodes beside
 * these. */
void mpsi_mpm_find_sight(const mpsi_grid *grid, const mpsi_contacts *contacts, int64_t g);
/* Lists the blocks of nodes for values across, once the blocks of cells and nodes beside thin
 * bodies are known; false: memory refused. */
bool mpsi_mpm_list_across(mps_context *context, mpsi_grid *grid, mpsi_mirrors *mirrors,
                          const mpsi_contacts *contacts);
/* Nodes of the stencil from tile node `base` that thin bodies separate from a particle at x[3] (m),
 * and those of them that lie too deep to be active, unless they are corners of its own cell. */
mpsi_parted mpsi_mpm_find_parted(const mpsi_grid *grid, const mpsi_contacts *contacts,
                                 const struct mpsi_cell_block *cells, const int *base,
                                 const double *x);
