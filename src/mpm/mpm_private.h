/* mpm_private.h - the members of the WLS-MPM solver.
 *
 * The grid is cut into blocks of 8 x 8 nodes. A particle belongs to the block of the lowest node of
 * its stencil, so that all its nodes lie in a tile of 11 x 11: the block and one row of its
 * neighbours at +x, +y and +x+y. Each block sums its particles into a tile of its own; then each
 * block of nodes adds the up to four tiles that cover it, in a fixed order. No two tasks write the
 * same memory, and no sum depends on the number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_MPM_PRIVATE_H
#define MPSI_MPM_PRIVATE_H

#include "contact/body.h"
#include "core/internal.h"
#include "material/material_internal.h"

#include <mps/mpm.h>

#define MPSI_SIDE 8
#define MPSI_OWN (MPSI_SIDE * MPSI_SIDE)
#define MPSI_TILE_SIDE (MPSI_SIDE + 3)
#define MPSI_TILE (MPSI_TILE_SIDE * MPSI_TILE_SIDE)

/* What a tile sums. EXCESS is sum (w - phi) m: mass by weights less mass by shape functions. */
enum { MPSI_M, MPSI_PX, MPSI_PY, MPSI_FX, MPSI_FY, MPSI_EXCESS, MPSI_SUMS };
/* What a node keeps: mass, velocity before (v_i^n) and after the forces. */
enum { MPSI_NM, MPSI_NX, MPSI_NY, MPSI_VX, MPSI_VY, MPSI_NODE };
/* Contact with one body: mass in contact W, slip sums S, normal force fn; at nodes also the
 * tangential force by mass in contact. */
enum {
  MPSI_W,
  MPSI_SX,
  MPSI_SY,
  MPSI_CX,
  MPSI_CY,
  MPSI_TOUCH,
  MPSI_TX = MPSI_TOUCH,
  MPSI_TY,
  MPSI_TOUCH_NODE
};

/* Bits of a tile's node state. */
#define MPSI_OUTSIDE 1u /* not in the domain */
#define MPSI_INSIDE 2u  /* in a body */
#define MPSI_REACHED 4u /* corner of a cell that holds a particle */

/* A block with particles. */
typedef struct mpsi_cells {
  int64_t begin, end;              /* particles */
  int32_t at[2];                   /* block coordinates: its first node is at * MPSI_SIDE */
  int32_t to[4];                   /* blocks of nodes of the tile: own, +x, +y, +x+y */
  int32_t near;                    /* slot of mpsi_near, or -1: no body near */
  int32_t first_meeting, meetings; /* by body */
  bool edge;                       /* some node of the tile is outside the domain */
  bool left;                       /* a particle has left the block */
  bool refused;                    /* the law has refused the block */
  int64_t bad;                     /* first particle not finite or outside the domain, or -1 */
  double speed;                    /* largest c + |v|, m/s */
} mpsi_cells;

/* A block of nodes. */
typedef struct mpsi_nodes {
  int32_t at[2];
  int32_t from[4]; /* blocks with particles whose tile covers it: own, -x, -y, -x-y; or -1 */
} mpsi_nodes;

/* A block with particles meets a body that is near it. */
typedef struct mpsi_meeting {
  int32_t cells, body;
  bool touched;                /* some particle is in contact */
  double normal[2][MPSI_TILE]; /* outward normal at nodes inside the body, else 0 */
  double sum[MPSI_TOUCH][MPSI_TILE];
  mpsi_load load[MPS_BODY_MAX_PARTS];
  int64_t contacts[MPS_BODY_MAX_PARTS];
} mpsi_meeting;

/* A block with particles near any body. */
typedef struct mpsi_near {
  uint8_t reached[MPSI_TILE]; /* by the block's own particles */
  uint8_t state[MPSI_TILE];   /* MPSI_... bits */
} mpsi_near;

/* A block of nodes and a body that touches it. */
typedef struct mpsi_touch {
  int32_t nodes, body;
  int32_t from[4]; /* pairs, as mpsi_nodes.from; or -1 */
  double sum[MPSI_TOUCH_NODE][MPSI_OWN];
  double mass; /* of the nodes in contact */
} mpsi_touch;

/* Arrays over the particles, in sorted order. */
typedef struct mpsi_columns {
  double *x[2], *v[2];
  double *L[5]; /* xx, xy, yx, yy, hoop */
  double *s[4]; /* xx, yy, zz, xy */
  double *V, *m;
  double *J;    /* V/V0 where the law reads it, else NULL */
  double *F[5]; /* as L; NULL where the law does without */
  double *history[MPS_MATERIAL_HISTORY_MAX];
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

struct mps_mpm {
  mps_context *context;
  mps_particles *particles;
  mps_mpm_def def;
  int64_t count;
  mpsi_columns p;
  double inverse;          /* 1/h */
  int64_t low[2], high[2]; /* first and last node of the domain */
  double gap;              /* l_p = d0, m */
  mps_material *material;
  double modulus; /* K + 4G/3 at zero strain, Pa */
  int32_t histories;
  int64_t *flags; /* of the law, by sorted index */
  mps_body *body[MPS_MPM_MAX_BODIES];
  int32_t bodies;
  /* the grid: see layout.c */
  mpsi_cells *cells;
  mpsi_nodes *nodes;
  double (*tile)[MPSI_SUMS][MPSI_TILE];
  double (*node)[MPSI_NODE][MPSI_OWN];
  int64_t cell_count, node_count;
  mpsi_room cells_room, nodes_room, tile_room, node_room;
  mpsi_radix *radix; /* 2 count */
  int64_t *order;
  double *scratch; /* count */
  /* contact: see near.c */
  mpsi_near *near;
  mpsi_meeting *meeting;
  mpsi_touch *touch;
  int32_t *meeting_of;  /* cells * bodies + body: meeting or -1 */
  int32_t *touch_first; /* first touch of a block of nodes; node_count + 1 */
  int64_t near_count, meeting_count, touch_count;
  mpsi_room near_room, meeting_room, touch_room, meeting_of_room, touch_first_room;
  bool stale; /* particles must be sorted before the next step */
  bool broken;
  double time, dt, speed; /* s; s, of the step being made; largest c + |v| of the particles, m/s */
  double contact_mass[MPS_MPM_MAX_BODIES]; /* kg, of the nodes in contact with each body */
  int64_t steps;
};

/* Coordinate of x in cells from the origin along axis c. */
static inline double mpsi_grid_coordinate(const mps_mpm *mpm, int c, double x) {
  return (x - mpm->def.origin[c]) * mpm->inverse;
}

/* Lowest node of the stencil of a particle at grid coordinate X. */
static inline int64_t mpsi_base(int32_t spline, double X) {
  return spline == 3 ? (int64_t)floor(X) - 1 : (int64_t)floor(X - 0.5);
}

/* Cell of a particle at grid coordinate X; on the upper wall, the last cell. */
static inline int64_t mpsi_own_cell(const mps_mpm *mpm, int c, double X) {
  const int64_t cell = (int64_t)floor(X);
  return cell < mpm->high[c] ? cell : mpm->high[c] - 1;
}

/* Node index n belongs to block floor(n / MPSI_SIDE). */
static inline int64_t mpsi_block_of(int64_t n) {
  return n >= 0 ? n / MPSI_SIDE : -((MPSI_SIDE - 1 - n) / MPSI_SIDE);
}

/* Runs task(mpm, index) for [0, count) on the executor, in units of several where that pays. */
typedef void (*mpsi_mpm_task)(mps_mpm *mpm, int64_t index);
void mpsi_mpm_for(mps_mpm *mpm, int64_t count, mpsi_mpm_task task);

/* Ensures room for `count` items, keeping none of the contents; false when out of memory. */
bool mpsi_room_ensure(mps_context *context, mpsi_room *room, int64_t count, size_t size);

/* layout.c: sorts the particles by blocks and builds the lists of blocks. */
mps_status mpsi_mpm_sort(mps_mpm *mpm, const char *function);
/* near.c: finds which blocks are near which bodies, and the state of their nodes. */
mps_status mpsi_mpm_find_near(mps_mpm *mpm, const char *function);
/* shape.c, transfer.c: one block of particles to its tile, and back from the nodes. */
void mpsi_mpm_p2g(mps_mpm *mpm, int64_t block);
void mpsi_mpm_g2p(mps_mpm *mpm, int64_t block);
/* grid.c: one block of nodes: sums, forces, normal contact forces; friction and walls. */
void mpsi_mpm_update_nodes(mps_mpm *mpm, int64_t block);
void mpsi_mpm_finish_nodes(mps_mpm *mpm, int64_t block);
/* friction.c: normal forces of all bodies on a block of nodes; friction; what the bodies are told.
 */
void mpsi_mpm_touch(mps_mpm *mpm, int64_t block);
void mpsi_mpm_rub(mps_mpm *mpm, int64_t block);
void mpsi_mpm_react(mps_mpm *mpm);
/* law.c: the law on the particles of a block; the block's largest speed. */
void mpsi_mpm_apply_law(mps_mpm *mpm, mpsi_cells *cells);
void mpsi_mpm_find_speed(mps_mpm *mpm, int64_t block);
/* step.c: stress and motion of one state: the largest speed of all blocks, or the error of a bad
 * particle. */
mps_status mpsi_mpm_take_stock(mps_mpm *mpm, const char *function);

#endif
