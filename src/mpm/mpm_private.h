/* mpm_private.h - the members of the WLS-MPM solver.
 *
 * The grid is cut into blocks of 8 nodes along each axis; only those that particles reach exist. A
 * particle is sorted into a block of cells by the lowest node of its stencil, so that the stencils
 * of a block lie in a tile of 13 nodes along each axis, which begins at the block's first node: 1
 * node that only a particle which has left to the lower side uses, 8, 1 for one that has left to
 * the upper side, and the other 3 of a cubic stencil. So the particles are sorted anew only when
 * one has moved a whole cell beyond its block, or beyond the cells of it that had particles: the
 * rest of the tile is not worked on. The tile lies over the block's own nodes and its
 * neighbours at +x, +y, +x+y (and so on at +z).
 *
 * Each task sums the particles of one block of cells into a tile of its own and adds that to the
 * nodes. Blocks of one colour (2 along each axis) share no nodes: they work at once, colour after
 * colour. No two tasks write the same memory, and no sum depends on the number of threads.
 *
 * Arrays of three hold x, y, z; in 2D the last is 0 (one node thick).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PRIVATE_H
#define MPSI_MPM_PRIVATE_H

#include "body/body.h"
#include "core/internal.h"
#include "material/material_internal.h"
#include "restart.h"

#include <mps/mpm.h>

#define MPSI_SIDE 8
#define MPSI_TILE_SIDE (MPSI_SIDE + 5)
#define MPSI_CORNERS 8        /* blocks of nodes under a tile: 4 in 2D */
#define MPSI_MAX_CELLS 0x1p30 /* from the origin: nodes are counted exactly */
#define MPSI_NO_WALL (INT64_C(1) << 30)

/* A block of cells with particles. */
typedef struct mpsi_cells {
  int64_t begin, end;              /* particles */
  int32_t at[3];                   /* block coordinates: its first node is at * MPSI_SIDE */
  int32_t low[3], high[3];         /* its stencils use tile nodes low to high - 1 of each axis */
  int32_t to[MPSI_CORNERS];        /* blocks of nodes under the tile: own, +x, +y, +x+y, ... */
  bool edge;                       /* some node of the tile is outside the domain */
  bool inside;                     /* some node that its stencils may use is in a body */
  bool cut;                        /* one of both: some particle may have a cut support */
  bool split;                      /* forces are summed apart from momenta: see mpsi_nodes */
  bool apart;                      /* the tile of forces is in use: split, or at an edge */
  bool left;                       /* a particle is more than a cell outside the block */
  int32_t first_meeting, meetings; /* by body */
  const mps_material *refused;     /* a law that has refused particles of the block, or NULL */
  int64_t bad;                     /* first particle not finite or outside the domain, or -1 */
  double speed;                    /* largest c + |v|, m/s */
} mpsi_cells;

/* A block of nodes. Its nodes are node[mpsi_first_node(g)] and on, x fastest. */
typedef struct mpsi_nodes {
  int32_t at[3];
  int32_t side; /* slot of its side sums, or -1: only particles with full supports reach it */
  int32_t near; /* slot of its inside masks, or -1: no body near */
  bool split;   /* side has the forces: the velocity before them is needed */
  bool inside;  /* some node is in a body: */
  int32_t low[3], high[3]; /* they are within low to high - 1 */
  uint32_t bodies;         /* bit b: a block of cells whose tile covers it may meet body b */
  int32_t first_touch, touches;
  int32_t first_held, holds; /* of the list of mpsi_held */
} mpsi_nodes;

/* A node, four doubles: particles to nodes sums mass and momentum; then lane 0 is the mass and the
 * others the velocity. The momentum has dt times the force with it, but in split blocks.
 * Its side, where the block has one: EXCESS is sum (w - phi) m, mass by weights less mass by shape
 * functions, then in split blocks the force; later the velocity v_i^n before the forces. */
typedef double mpsi_node[4];
enum { MPSI_MASS = 0, MPSI_EXCESS = 0, MPSI_VECTOR = 1 };

/* A block of cells may meet a body. */
typedef struct mpsi_meeting {
  int32_t cells, body;
  bool touched; /* some particle is in contact */
  mpsi_load load[MPS_BODY_MAX_PARTS];
  int64_t contacts[MPS_BODY_MAX_PARTS];
} mpsi_meeting;

/* A block of nodes and a body that may touch it; its nodes are touch_node[k * own]. */
typedef struct mpsi_touch {
  int32_t nodes, body;
  double mass; /* of the nodes in contact */
} mpsi_touch;

typedef struct mpsi_touch_node {
  double normal[3]; /* of the surface at a node inside the body, else 0 */
  double mass;      /* W: sum phi m of the particles in contact, Nakamura (30) */
  double slip[3];   /* S: sum phi m slip; then the tangential force over W */
  double force[3];  /* normal force fn, (29) */
} mpsi_touch_node;

/* ---- walls, moving nodes, loads ---------------------------------------------------------------
 */

enum { MPSI_HOLD_NONE = -1, MPSI_HOLD_BOX = -2 }; /* besides mps_wall */

/* Nodes that are not free: those of a wall, or in a box. */
typedef struct mpsi_hold {
  int32_t kind;              /* mps_wall, or MPSI_HOLD_... */
  int32_t axis;              /* across the wall; component that a box holds */
  int64_t first[3], last[3]; /* nodes */
  double friction;
  mps_signal *signal[3];
  double factor[3];
  double v[3];     /* m/s, of the step being made */
  double force[3]; /* N, on the particles, mean over the last step */
  bool finds;      /* absorbing: still looks for the forces at rest */
  double found;    /* s, how long it has looked, with the step being made */
} mpsi_hold;

/* The nodes of a block that a hold holds. */
typedef struct mpsi_held {
  int32_t hold, at[3]; /* at: of the block */
  int64_t dash;        /* absorbing: first of own/MPSI_SIDE dashpots, else -1 */
  double impulse[3];   /* N s, of the step being made */
} mpsi_held;

/* A load: force area * traction on each particle. */
typedef struct mpsi_traction {
  int64_t count; /* 0: none */
  int64_t *id;
  double *area; /* NULL: by the spacing */
  double traction[3];
  mps_signal *signal;
} mpsi_traction;

/* A law that particles obey. */
typedef struct mpsi_law_use {
  mps_material *material;
  double modulus; /* K + 4G/3 at zero strain, Pa */
  bool reads_volume, needs_deformation;
  double *history[MPS_MATERIAL_HISTORY_MAX]; /* columns over all particles */
} mpsi_law_use;

/* Arrays over the particles, in sorted order. Tensors by rows. */
typedef struct mpsi_columns {
  double *x[3], *v[3];
  double *L[9]; /* 2D: xx, xy, yx, yy, hoop */
  double *s[6]; /* xx, yy, zz, xy, zx, yz; 2D: the first four */
  double *V, *m;
  double *J;    /* V/V0 where some law reads it, else NULL */
  double *F[9]; /* as L; NULL where all laws do without */
  double *f[3]; /* N, body accelerations and loads of the step; NULL where there are none */
  int64_t *law; /* number of each particle's law; NULL: one law */
} mpsi_columns;

typedef struct mpsi_radix {
  uint64_t key;
  int64_t index;
} mpsi_radix;

/* A growing array. */
typedef struct mpsi_room {
  void *item;
  int64_t capacity;
} mpsi_room;

/* What a worker needs for the block it works on: tiles of MPSI_TILE_SIDE^dim. */
typedef struct mpsi_worker {
  void *memory;
  mpsi_node *tile, *force; /* force, and excess mass: where they are apart */
  uint32_t *inside;        /* bit b: in body b */
  uint8_t *state;          /* MPSI_... bits, 0: free */
} mpsi_worker;

/* Bits of a state. */
#define MPSI_OUTSIDE 1u /* not in the domain */
#define MPSI_INSIDE 2u  /* in a body */
#define MPSI_REACHED 4u /* in a body, and corner of a cell that holds a particle */
#define MPSI_PLAIN 8u   /* any node with MPS_SCHEME_STANDARD: no particle takes the closed form */

struct mpsi_kernels;

struct mps_mpm {
  mps_context *context;
  mps_particles *particles;
  mps_mpm_def def;
  int32_t dim, own, tile; /* nodes of a block, of a tile */
  int64_t count;
  mpsi_columns p;
  double inverse; /* 1/h */
  bool standard;  /* MPS_SCHEME_STANDARD; then `flip` is that of the definition, else 0 */
  double flip;
  int64_t low[3], high[3];                 /* first and last node of the domain */
  double gap;                              /* l_p = d0, m */
  mpsi_law_use law[MPS_MPM_MAX_MATERIALS]; /* 0: of creation */
  int32_t laws;
  bool one_modulus; /* law[0].modulus holds for all particles, whatever their state */
  int64_t *flags;   /* of the laws, by sorted index */
  int32_t *stencil; /* lowest node in its block's tile, of each particle in the step being made;
                       NULL but with VOLUMETRIC_CELL */
  mps_body *body[MPS_MPM_MAX_BODIES];
  int32_t bodies;
  const struct mpsi_kernels *kernels;
  mpsi_worker *workers;
  int32_t worker_count;
  /* the grid: see layout.c */
  mpsi_cells *cells;
  mpsi_nodes *nodes;
  mpsi_node *node, *side;
  int64_t cell_count, node_count, side_count;
  int32_t *coloured;                /* numbers of blocks of cells, colour by colour */
  int64_t colour[MPSI_CORNERS + 1]; /* first of each in `coloured` */
  mpsi_room cells_room, nodes_room, node_room, side_room, coloured_room;
  mpsi_radix *radix; /* 2 count */
  /* contact: see near.c */
  mpsi_meeting *meeting;
  mpsi_touch *touch;
  mpsi_touch_node *touch_node;
  uint32_t *inside; /* bit b: in body b; near_count * own */
  uint8_t *reached; /* corner of a cell that holds a particle */
  int64_t near_count, meeting_count, touch_count;
  mpsi_room meeting_room, touch_room, touch_node_room, inside_room, reached_room;
  /* walls, moving nodes: see walls.c, absorb.c; loads: see loads.c */
  mpsi_hold hold[MPSI_HOLDS];
  mpsi_held *held;
  mpsi_dash *dash;
  int64_t held_count, dash_count;
  mpsi_room held_room, dash_room, old_held_room, old_dash_room;
  mpsi_traction *traction;
  int32_t tractions;
  double *body_acceleration[3]; /* NULL where the set has no such field */
  double *force_memory;         /* of p.f */
  double least_mass;            /* kg, of a particle; in axisymmetry over its radius, kg/m */
  uint32_t told_of_chatter;     /* bit b: the log knows that body b's contact is too stiff */
  bool told_of_dt;              /* ... that dt is above the limit */
  bool stale;                   /* particles must be sorted before the next step */
  bool broken;
  double time, dt, speed; /* s; s, of the step being made; largest c + |v| of the particles, m/s */
  double contact_mass[MPS_MPM_MAX_BODIES]; /* kg, of the nodes in contact with each body */
  int64_t steps;
};

static inline const mpsi_law_use *mpsi_law_of(const mps_mpm *mpm, int64_t particle) {
  return &mpm->law[mpm->p.law ? mpm->p.law[particle] : 0];
}

/* Coordinate of x in cells from the origin along axis c. */
static inline double mpsi_grid_coordinate(const mps_mpm *mpm, int c, double x) {
  return (x - mpm->def.origin[c]) * mpm->inverse;
}

/* Lowest node of the stencil of a particle at grid coordinate X. */
static inline double mpsi_base(int32_t spline, double X) {
  return spline == 3 ? floor(X) - 1.0 : floor(X - 0.5);
}

/* Cell of a particle at grid coordinate X; on the upper wall, the last cell. */
static inline int64_t mpsi_own_cell(const mps_mpm *mpm, int c, double X) {
  const int64_t cell = (int64_t)floor(X);
  return cell < mpm->high[c] ? cell : mpm->high[c] - 1;
}

/* Nodes of a stencil beyond its lowest, as the loops take them: rows along x are read and written
 * four nodes at a time whatever the spline. */
static inline int32_t mpsi_reach(const mps_mpm *mpm, int c) { return c == 0 ? 3 : mpm->def.spline; }

/* The block that a particle is sorted to, by the lowest node of its stencil. */
static inline int64_t mpsi_block_of(int64_t base) {
  const int64_t n = base - 1;
  return n >= 0 ? n / MPSI_SIDE : -((MPSI_SIDE - 1 - n) / MPSI_SIDE);
}

/* Memory of one worker. */
static inline size_t mpsi_worker_bytes(const mps_mpm *mpm) {
  return (size_t)mpm->tile * (2 * sizeof(mpsi_node) + sizeof(uint32_t) + 1) + sizeof(uint64_t);
}

static inline int64_t mpsi_first_node(const mps_mpm *mpm, int64_t g) { return g * mpm->own; }

/* Coordinates within a block or tile of `side` nodes an axis. */
static inline void mpsi_unravel(int k, int side, int *at) {
  at[0] = k % side, at[1] = k / side % side, at[2] = k / side / side;
}

/* Node k of a block within the plane of nodes across `axis`. */
static inline int mpsi_plane_index(int axis, int k) {
  const int plane = MPSI_SIDE * MPSI_SIDE;
  return axis == 0 ? k / MPSI_SIDE : axis == 1 ? k / plane * MPSI_SIDE + k % MPSI_SIDE : k % plane;
}

/* Position x[3] of the node `local` of the block at `at`. */
static inline void mpsi_node_position(const mps_mpm *mpm, const int32_t *at, const double *local,
                                      double *x) {
  for (int c = 0; c < 3; c++)
    x[c] = c < mpm->dim
               ? mpm->def.origin[c] + mpm->def.cell * ((double)at[c] * MPSI_SIDE + local[c])
               : 0.0;
}

/* Runs task(mpm, index, worker) for all blocks on the executor, in units of several where that
 * pays: blocks of nodes; of cells; of cells, those of one colour at once. */
typedef void (*mpsi_mpm_task)(mps_mpm *mpm, int64_t index, int32_t worker);
void mpsi_mpm_for_nodes(mps_mpm *mpm, mpsi_mpm_task task);
void mpsi_mpm_for_cells(mps_mpm *mpm, mpsi_mpm_task task);
void mpsi_mpm_for_colours(mps_mpm *mpm, mpsi_mpm_task task);

/* Ensures room for `count` items, keeping none of the contents; false when out of memory. */
bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size);

/* layout.c: sorts the particles by blocks and builds the lists of blocks. */
mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function);
/* layout.c: builds the lists of blocks for particles that are in order, as at an earlier sort. */
mps_status mpsi_mpm_place_blocks(mps_mpm *mpm, const char *function, int64_t count,
                                 mpsi_block *block);
/* near.c: finds which blocks are near which bodies, and which blocks are cut and split. */
mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function);
/* grid.c: one block of nodes: emptied; velocities, normal contact forces; friction and walls. */
void mpsi_mpm_clear_nodes(mps_mpm *mpm, int64_t g, int32_t worker);
void mpsi_mpm_update_nodes(mps_mpm *mpm, int64_t g, int32_t worker);
void mpsi_mpm_finish_nodes(mps_mpm *mpm, int64_t g, int32_t worker);
/* friction.c: normal forces of all bodies on a block of nodes; friction; what the bodies are told.
 */
void mpsi_mpm_touch(mps_mpm *mpm, int64_t g);
void mpsi_mpm_rub(mps_mpm *mpm, int64_t g);
void mpsi_mpm_react(mps_mpm *mpm);
/* walls.c: which blocks of nodes are held, after a sort; what holds them in a step of dt; the held
 * nodes of a block; the forces of the step. */
mps_status mpsi_mpm_list_holds(mps_mpm *mpm, const char *function);
/* walls.c: the same with dashpots as they were at an earlier sort. */
mps_status mpsi_mpm_put_dashes(mps_mpm *mpm, const char *function, int64_t count,
                               const mpsi_dash *dash);
void mpsi_mpm_begin_holds(mps_mpm *mpm, double dt);
void mpsi_mpm_hold_nodes(mps_mpm *mpm, int64_t g);
void mpsi_mpm_sum_holds(mps_mpm *mpm);
/* Puts a wall of a definition that has been checked in its place. */
void mpsi_mpm_place_wall(mps_mpm *mpm, int32_t number, int32_t kind, double friction);
mps_status mpsi_mpm_check_wall(mps_context *context, const char *function, int32_t axis, bool upper,
                               int32_t kind, double friction, bool on_axis, bool standard);
/* absorb.c: dashpots of the absorbing walls, after a sort, taking over the forces at rest from the
 * list before; one of them at work: the velocity of its node across and along. */
void mpsi_mpm_place_dashes(mps_mpm *mpm, const mpsi_held *old, int64_t old_count,
                           const mpsi_dash *old_dash);
void mpsi_mpm_dash(const mps_mpm *mpm, const mpsi_hold *hold, mpsi_dash *dash, const double *node,
                   const double *before, double *velocity);
/* loads.c: body accelerations and loads of the step to p.f. */
mps_status mpsi_mpm_make_forces(mps_mpm *mpm, const char *function);
void mpsi_mpm_find_forces(mps_mpm *mpm);
void mpsi_mpm_drop_loads(mps_mpm *mpm);
/* law.c: K + 4G/3 and G (Pa) of a particle's material at zero strain. */
void mpsi_mpm_elastic(const mps_mpm *mpm, int64_t particle, double *wave, double *shear);
/* materials.c: puts the law at the end of the list, with the fields it works on; nothing has
 * changed on an error. Gives the particle (an index) the state in which the law begins. */
mps_status mpsi_mpm_add_law(mps_mpm *mpm, const char *function, mps_material *material);
void mpsi_mpm_begin_law(mps_mpm *mpm, const mpsi_law_use *law, int64_t particle);
/* volumetric.c: the laws after the step's G2P, where they wait for the means of the cells. */
void mpsi_mpm_apply_laws_by_cell(mps_mpm *mpm);
/* law.c: their laws on particles [begin, end) of a block. */
void mpsi_mpm_apply_law(mps_mpm *mpm, mpsi_cells *cells, int64_t begin, int64_t end);
/* step.c: MPS_ERROR_STATE after a step that has failed. */
mps_status mpsi_mpm_ready(mps_mpm *mpm, const char *function);
/* step.c: what the blocks have told: the largest speed, or the error of a bad particle. */
mps_status mpsi_mpm_take_stock(mps_mpm *mpm, const char *function);

#endif
