/* blocks.h - the background grid, which exists only where particles are, in blocks.
 *
 * A block has 8 nodes along each axis; only blocks with nodes in the support of a particle exist. A
 * particle belongs to the block of cells that has the lowest node of its stencil, so that the
 * stencils of a block lie in a tile of 13 nodes along each axis, which begins at the block's first
 * node: 1 node for particles that have moved out of the block on the lower side, 8, 1 for those on
 * the upper side, and the other 3 of a cubic stencil. So the particles are sorted again only when
 * one has moved a whole cell beyond its block, or beyond the cells of it that had particles: the
 * rest of the tile is not processed. The tile lies over the block's own nodes and those of its
 * neighbours at +x, +y, +x+y (and so on at +z).
 *
 * A task sums the particles of one block of cells into a tile of its own and adds that to the
 * nodes. Blocks of one colour (2 along each axis) share no nodes; blocks that share some add to
 * them one after the other, in the order of their colours (pass.h). No two tasks write the same
 * memory, and no sum depends on the number of threads.
 *
 * Arrays of three are x, y, z; in 2D the last is 0 (one node thick).
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "pass.h"
#include "mpm/base/columns.h"
#include "core/base/room.h"

#define MPSI_SIDE 8
#define MPSI_TILE_SIDE (MPSI_SIDE + 5)
#define MPSI_CORNERS 8        /* blocks of nodes under a tile: 4 in 2D */
#define MPSI_MAX_CELLS 0x1p30 /* from the origin: below, node coordinates are exact */
#define MPSI_NO_WALL (INT64_C(1) << 30)

/* A block of cells in a snapshot or file: index of its first particle, coordinates (3), and the
 * part of its tile in use (low 3, high 3). They are of the last sort: the present positions do not
 * determine them. */
enum { MPSI_BLOCK_AT = 1, MPSI_BLOCK_LOW = 4, MPSI_BLOCK_HIGH = 7, MPSI_BLOCK = 10 };
typedef int64_t mpsi_block[MPSI_BLOCK];

/* A block of cells with particles. */
typedef struct mpsi_cell_block {
  int64_t begin, end;       /* range of its particles */
  int32_t at[3];            /* block coordinates: its first node is at * MPSI_SIDE */
  int32_t low[3], high[3];  /* its stencils use tile nodes low to high - 1 of each axis */
  int32_t to[MPSI_CORNERS]; /* blocks of nodes under the tile: own, +x, +y, +x+y, ... */
  /* Special cases of the block. Most blocks have none of these, and then full supports only.
   *   edge    some node of the tile is outside the domain, beyond a side that is no mirror
   *   inside  some node that its stencils may use is in a body
   *   cut     edge, inside, thin, or the standard scheme: support may be cut, states are found
   *   split   some block of nodes under it is split: forces are summed apart from momenta there
   *   thin    a thin body may separate nodes of its stencils from particles (thin_bodies.h)
   *   apart   cut or split: the tile of forces is in use */
  bool edge, inside, cut, split, thin, apart;
  uint8_t mirrors; /* bit k: its stencils may have nodes on side k or beyond, a mirror (mirror.h) */
  int32_t first_mirror; /* first of these in mirrors.mirror */
  bool light; /* some block of nodes under it is light: retained momentum is returned (cut_gather.c)
               */
  bool gone;  /* a particle has passed an open side */
  bool left;  /* a particle is more than a cell outside the block */
  int32_t first_pair, pairs;  /* bodies near it: range of contact.cell_pair */
  int64_t first_fit;          /* index of its first particle in grid.fit; -1: no fits are stored */
  int32_t next[MPSI_CORNERS]; /* the block of cells that adds to the block of nodes to[q] after this
                                 one, in the order of colours; -1: this is the last */
  int32_t waits;              /* number of to[q] to which others add before */
  uint8_t first;              /* bit q: this is the first to add to to[q] */
  int64_t bad;                /* first particle not finite or outside the domain, or -1 */
  bool lost;                  /* that particle is outside the domain; all are finite */
  bool tight;                 /* its water is within a step of the bounds of water/bounds.c */
  double speed;               /* largest c + |v|, m/s */
  double vis_viva;            /* twice the kinetic energy of its particles, J */
  double flow;                /* the same of the flow of pore water (laws.h) */
  double wave;                /* largest c without that water, m/s; 0: no water flows (laws.h) */
  /* On several ranks (partition.h): */
  bool ghost;      /* block of another rank, without particles here */
  bool late;       /* it is a ghost, or a ghost adds before it */
  bool in_contact; /* it has constraints in the step, or areas (area.c) */
  bool sent;       /* these are sent to partner ranks: partners.h */
  int64_t parcel;  /* index of its tile among received (ghosts) or sent ones; -1: none */
} mpsi_cell_block;

/* A block of nodes. Its nodes are node[mpsi_first_node(g)] and on, x fastest. */
typedef struct mpsi_node_block {
  int32_t at[3];
  int32_t side;   /* slot of its side values in grid.side, or -1: all particles near it have full
                     supports */
  int32_t near;   /* slot of its nodes in contact.inside, or -1: no body is near */
  bool split;     /* forces are summed apart, in side: the velocity before them is needed */
  int32_t across; /* block of nodes with the values across thin bodies, or -1 (thin_bodies.h) */
  bool thin;      /* some node is beside a thin body */
  bool light;  /* some node's own mass is less than the mass that forces accelerate: MPSI_LEAST_MASS
                */
  bool inside; /* some node is in a body: */
  int32_t low[3], high[3];   /* range low to high - 1 of these nodes */
  int32_t first_pair, pairs; /* bodies near it, or near a block of cells whose tile covers it: range
                                of contact.node_pair */
  int32_t first_held, held_count; /* range of boundaries.held */
  int32_t from[MPSI_CORNERS]; /* blocks of cells whose tiles cover it, as corner q; -1: none */
  bool late;    /* a ghost, or a block that adds after one, adds to it (partition.h) */
  bool foreign; /* only ghosts cover it: its sums are not complete */
  bool waits;   /* its friction needs the mass of all nodes in contact with a body */
} mpsi_node_block;

/* Values of a node. In P2G these are mass and momentum, after the update mass and velocity. The
 * momentum includes dt times the force, except in split blocks. Side values, where the block has
 * them: in P2G the excess mass sum (w - phi) m, mass by weights less mass by shape functions, and
 * in split blocks the force; after the update the velocity v_i^n before the forces. */
typedef double mpsi_node[4];
enum { MPSI_MASS = 0, MPSI_EXCESS = 0, MPSI_VECTOR = 1 };

/* Scratch memory of a worker for its present block: tiles of MPSI_TILE_SIDE^dim nodes. */
typedef struct mpsi_worker {
  void *memory;
  mpsi_node *tile, *force; /* force and excess mass, in blocks that are `apart` */
  mpsi_node *strain;       /* sums of pore water while `force` is in use for velocities
                              before the forces (water/cell_loops.c) */
  mpsi_node *across_tile, *across_force; /* values across thin bodies (thin_bodies.h) */
  struct mpsi_penalty_node *penalty;     /* one tile for each pair of the block: see penalty.c */
  uint8_t *state;                        /* states of the tile's nodes, MPSI_... bits; 0: free */
  void *scratch; /* MPSI_WORKER_SCRATCH bytes, aligned to 64: arrays of one call of P2G, G2P or the
                 update of nodes, too large for the stack of a host's thread */
} mpsi_worker;
enum { MPSI_WORKER_SCRATCH = 104 << 10 };

/* Least-squares fit of a particle beside bodies, stored by the scatter of a step for its gather
 * (least_squares.h). */
typedef struct mpsi_kept_fit {
  double q[12];    /* the upper half of the inverse of M by rows, q00, q01, q02, ... (shape.h) */
  uint64_t active; /* bit 16 k + 4 j + i: this node of the stencil is active */
} mpsi_kept_fit;
enum { MPSI_FITTED_CUT = 1, MPSI_FITTED_FULL = 2 };

/* Bits of a state. */
#define MPSI_OUTSIDE 1u  /* not in the domain */
#define MPSI_INSIDE 2u   /* in a body */
#define MPSI_REACHED 4u  /* in a body, and corner of a cell with a particle */
#define MPSI_PLAIN 8u    /* any node with the standard method, whose supports are cut everywhere */
#define MPSI_THIN 16u    /* beside or in a thin body (thin_bodies.h) */
#define MPSI_IMPULSE 32u /* in a body with contact by impulses, */
#define MPSI_PENALTY 64u /* or with penalty contact; besides MPSI_INSIDE */

/* Sort key and index of a particle. */
typedef struct mpsi_radix {
  uint64_t key;
  int64_t index;
} mpsi_radix;

/* Shape functions of a fit can be negative, so that a node with hardly any particle, between two
 * bodies above all, could get a tiny or negative mass. Forces accelerate at least this fraction of
 * its mass by weights, which is positive. */
#define MPSI_LEAST_MASS 0.02
static inline double mpsi_node_mass(double mass, double weight) {
  return fmax(mass, MPSI_LEAST_MASS * weight);
}
/* Mass by which a node's momentum is divided: its own mass, unless that is near zero or slightly
 * negative, within the fraction. With another mass a node of negative mass would move against its
 * particles. */
static inline double mpsi_carried_mass(double mass, double weight) {
  return mass < -MPSI_LEAST_MASS * weight ? mass : mpsi_node_mass(mass, weight);
}
/* Own mass of a node, from its mass after the update and the excess mass. */
static inline double mpsi_own_mass(double mass, double excess) {
  return fmin(mass, mass / MPSI_LEAST_MASS - excess);
}

typedef struct mpsi_grid {
  int32_t dim, spline; /* from the definition, as the next four */
  mps_mpm_geometry geometry;
  double measure;         /* thickness, m, or sector angle, rad */
  double origin[3], cell; /* m */
  /* For comparison (mps/experimental/papers.h): */
  bool by_weight;     /* momentum is transferred to the nodes by weights */
  bool strain_by_fit; /* the laws see the slopes of the fit */
  bool standard;      /* the original material point method: no support is fitted */
  double flip;        /* FLIP fraction of that method, else 0 */
  bool apart;         /* forces are summed apart from momenta everywhere, for reading/nodes.c */
  int32_t block_nodes, tile_nodes; /* number of nodes of a block, of a tile */
  double inverse;                  /* 1/m, 1/h */
  int64_t low[3], high[3];         /* first and last node of the domain */
  int64_t use_low[3], use_high[3]; /* first and last node that stencils may use: as low, high, but
                                      without a limit at mirrors */
  mpsi_cell_block *cells;
  mpsi_node_block *nodes;
  mpsi_node *node, *side;
  int64_t cell_count, node_count, side_count; /* number of blocks; of slots of `side` */
  int64_t across_count; /* number of blocks of nodes for values across thin bodies, behind the first
                           node_count */
  int32_t *coloured;    /* numbers of blocks of cells, colour by colour */
  int64_t colour[MPSI_CORNERS + 1]; /* index of the first of each colour in `coloured` */
  mpsi_room cells_room, nodes_room, node_room, side_room, coloured_room;
  mpsi_radix *radix;  /* 2 items a particle */
  mpsi_radix *sorted; /* the half of `radix` with the order, while the blocks are made */
  int32_t own_bits;   /* lower bits of a sorted key: the stencil's place within its block */
  mpsi_room digits_room, pass_room;
  mpsi_worker *workers;
  mpsi_room across_room; /* second tiles of the workers */
  int32_t worker_count;
  mpsi_kept_fit *fit; /* of particles of blocks beside bodies: see mpsi_cell_block.first_fit */
  uint8_t *fitted;    /* whether the fit is of the present step: MPSI_FITTED_... or 0 */
  mpsi_room fit_room, fitted_room;
} mpsi_grid;

/* A particle nearer than this (cells: more than round-off, less than any distance that matters) to
 * a border between two cells belongs to both: of which one, round-off would decide, and differently
 * in a mirror image. A side of the domain is no border. */
#define MPSI_ON_BORDER 0x1p-30
/* Weight along an axis from which on a node is seen by a particle. The stencil of a particle on a
 * border has a node without weight on one side, and not the same one in a mirror image. */
#define MPSI_SEEN 0x1p-60

/* Coordinates within a block or tile of `side` nodes an axis. */
static inline void mpsi_unravel(int k, int side, int *at) {
  at[0] = k % side, at[1] = k / side % side, at[2] = k / side / side;
}

/* All blocks of nodes, with those across thin bodies. */
static inline int64_t mpsi_all_nodes(const mpsi_grid *grid) {
  return grid->node_count + grid->across_count;
}

static inline int mpsi_tile_index(int i, int j, int k) {
  return (k * MPSI_TILE_SIDE + j) * MPSI_TILE_SIDE + i;
}

/* Node k of a block within the plane of nodes across `axis`. */
static inline int mpsi_plane_index(int axis, int k) {
  const int plane = MPSI_SIDE * MPSI_SIDE;
  return axis == 0 ? k / MPSI_SIDE : axis == 1 ? k / plane * MPSI_SIDE + k % MPSI_SIDE : k % plane;
}

/* Lowest node of the stencil of a particle at grid coordinate X. */
static inline double mpsi_base(int32_t spline, double X) {
  return spline == 3 ? floor(X) - 1.0 : floor(X - 0.5);
}

/* The block of node n of an axis, which may be negative. */
static inline int64_t mpsi_block_with(int64_t n) {
  return n >= 0 ? n / MPSI_SIDE : -((MPSI_SIDE - 1 - n) / MPSI_SIDE);
}

/* The block that a particle is sorted to, by the lowest node of its stencil. */
static inline int64_t mpsi_block_of(int64_t base) { return mpsi_block_with(base - 1); }

/* The order of blocks in lists: in z, then y, then x. */
static inline bool mpsi_block_before(const int32_t *a, const int32_t *b) {
  for (int c = 2; c > 0; c--)
    if (a[c] != b[c]) return a[c] < b[c];
  return a[0] < b[0];
}

/* The same for qsort: of items that are or begin with the place of a block. */
static inline int mpsi_compare_blocks(const void *left, const void *right) {
  const int32_t *a = left, *b = right;
  return mpsi_block_before(a, b) ? -1 : mpsi_block_before(b, a) ? 1 : 0;
}

/* Coordinate of x in cells from the origin along axis c. */
static inline double mpsi_grid_at(const mpsi_grid *grid, int c, double x) {
  return (x - grid->origin[c]) * grid->inverse;
}

static inline int64_t mpsi_first_node(const mpsi_grid *grid, int64_t g) {
  return g * grid->block_nodes;
}

/* Cell of a particle at grid coordinate X; on the upper wall, the last cell. */
static inline int64_t mpsi_own_cell(const mpsi_grid *grid, int c, double X) {
  const int64_t cell = (int64_t)floor(X);
  return cell < grid->high[c] ? cell : grid->high[c] - 1;
}

/* Number of nodes of a stencil beyond its lowest along axis c, as the loops read and write them:
 * four nodes along x whatever the spline. */
static inline int32_t mpsi_reach(const mpsi_grid *grid, int c) { return c == 0 ? 3 : grid->spline; }

/* Bytes of scratch memory of one worker. */
static inline size_t mpsi_worker_bytes(const mpsi_grid *grid) {
  return MPSI_WORKER_SCRATCH + (size_t)grid->tile_nodes * (3 * sizeof(mpsi_node) + 1) +
         sizeof(uint64_t);
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

/* order.c: sorted keys and indices of the particles, with the block above the lower `own_bits`
 * bits; NULL when out of memory. */
mpsi_radix *mpsi_mpm_find_order(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                                int32_t *own_bits);
/* layout.c: sorts the particles by blocks and rebuilds the lists of blocks, on one rank. */
mps_status mpsi_mpm_sort_alone(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                               mpsi_run *run, const char *function);
/* layout.c, parts of that: sorts the particles and lists the blocks of cells; memory for blocks of
 * cells; colours and blocks of nodes for the blocks of cells in grid.cells. */
mps_status mpsi_mpm_sort_cells(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                               mpsi_run *run, const char *function);
bool mpsi_mpm_ensure_cells(mps_context *context, mpsi_grid *grid, int64_t cells);
bool mpsi_mpm_build_nodes(mps_context *context, mpsi_grid *grid, int64_t cells);
/* layout.c: builds the lists of blocks from those of an earlier sort, in whose order the particles
 * are. */
mps_status mpsi_mpm_place_blocks(mps_context *context, mpsi_grid *grid, const mpsi_columns *p,
                                 mpsi_partition *partition, const char *function, int64_t count,
                                 const mpsi_block *block);
/* node_update.c, of one block of nodes: sets its sums to zero; velocities and normal penalty
 * forces; friction, boundaries, and, unless lists of particles follow, damping; damping after
 * these. */
void mpsi_mpm_clear_nodes(void *solver, int64_t g, int32_t worker);
void mpsi_mpm_update_nodes(void *solver, int64_t g, int32_t worker);
void mpsi_mpm_finish_nodes(void *solver, int64_t g, int32_t worker);
void mpsi_mpm_damp_after_lists(void *solver, int64_t g, int32_t worker);
