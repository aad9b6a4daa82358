/* fluid_private.h - the members of the incompressible fluid solver, by the stages of its step:
 *
 *   walls.c     positions and motions of walls (wall.c: one); the particles' images (ghosts)
 *   slots.c     the numbers of boundaries, bodies and their faces
 *   polyline.c  boundaries of several segments; vicinity.c: which are near a place; mirrors.c: the
 *               images in them
 *   bodies.c    rigid bodies, whose faces are walls too; afloat.c moves floating ones
 *   look.c      copies of the particles, their order and neighbours
 *   near.c      neighbour lists, and the weights w; sight.c: visibility past finite walls
 *   rock.c      permeable regions
 *   moments.c   sums over the neighbours: density, moments, velocity gradient, free surface
 *   closed.c    fluid without a free surface
 *   pressure.c  rows of the pressure equation; pcg.c solves it with the coarse space of coarse.c,
 *               whose equation envelope.c solves; solver.c: a solver of the caller
 *   classical.c the classical scheme's own parts of these
 *   move.c      pressure gradient, velocity, guards, positions; smooth.c: smoothing, viscosity
 *   exchange.c  momentum of walls besides the pressure's, and the momentum error
 *   loads.c     forces on particles and pressures on the surface
 *   probe.c     pressure at walls, level of the surface
 *   warn.c      assumptions of the model
 *   step.c      the stages of a step in order
 *   partition.c  ranks of a domain that compute a fluid together
 *
 * Indices below `count` are particles, those from `count` on are ghosts. A step works on copies of
 * positions and velocities and writes the particles' fields only on success.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_FLUID_PRIVATE_H
#define MPSI_FLUID_PRIVATE_H

#include "body/body_internal.h"
#include "core/context/guard.h"
#include "core/internal.h"
#include "core/particles/particles_internal.h"
#include "core/context/retain.h"
#include "core/base/exact.h"
#include "core/base/room.h"
#include "core/state/state.h"

#include <mps/fluid.h>

#define MPSI_FLUID_CHUNK 256   /* particles in a unit of work: sums are made in this order */
#define MPSI_FLUID_WIDE 8      /* lists of neighbours are filled up to a multiple of this */
#define MPSI_FLUID_COPIED 1024 /* in one that only copies */

/* How a wall moves along its normal, at its nodes: linear between them, constant beyond the ends.
 * A wall that stays plane has one node. */
typedef struct mpsi_fluid_motion {
  double *s, *u, *a; /* m, m/s, m/s2; a is the mean over the step that ends there */
} mpsi_fluid_motion;

/* Force, moment and power of a wall on the fluid. */
typedef struct mpsi_fluid_load {
  double force[2], moment, power; /* N; N m about the origin; W */
  int64_t wetted;                 /* points with water */
} mpsi_fluid_load;

/* Impulse, moment and work of a wall by collisions and smoothing in a step, see exchange.c. */
typedef struct mpsi_fluid_struck {
  double impulse[2], moment, work; /* N s; N m s about the origin; J */
} mpsi_fluid_struck;

/* Sums of momentum that is exchanged in a step: a row of values for each chunk of particles, see
 * exchange.c; and since creation the impulse of gravity and loads, and the momentum error of the
 * scheme, N s. */
typedef struct mpsi_fluid_exchange {
  mpsi_room rows, sums; /* double, mpsi_exact */
  int64_t width;        /* values of a row */
  double gain[2];       /* N s: of the water in the step */
  double loads[2], scheme[2];
} mpsi_fluid_exchange;

typedef struct mpsi_fluid_polyline mpsi_fluid_polyline; /* polyline.h */
typedef struct mpsi_fluid_lines mpsi_fluid_lines;

/* A wall: a boundary of the caller, the face of a body, or the segment of a polyline. */
typedef struct mpsi_fluid_wall {
  bool used;                 /* as a wall */
  bool open;                 /* an open side instead */
  int32_t of_body;           /* 0: a boundary; number of the body + 1 */
  int32_t of_line;           /* of a segment of a polyline: number of the boundary + 1 */
  mpsi_fluid_polyline *line; /* of a boundary that is a polyline, and no plane wall; owned */
  double from, to, length;   /* of a face or segment, m along it: its end, or its extension behind a
                                boundary */
  double tip[2];             /* m, of a face: its end, where that is `length` */
  bool limited, stood_on;    /* it ends; a body stands on it: see sight.c */
  bool bent, sticky;         /* it has several nodes; no slip */
  bool given, placed;        /* next.u, and next.s, are prescribed by the caller */
  int32_t kind;
  double at[2], normal[2]; /* m, of the wall without displacement; unit, into the fluid */
  mps_signal *signal;
  double factor, origin; /* origin: the signal's displacement that counts as 0, m */
  double rate;           /* m/s: factor times the signal's velocity now */
  double ahead[2];       /* m, m/s: displacement and rate at the end of the step being made */
  int64_t nodes;
  double *node;                 /* m along the wall from `at`, ascending */
  int64_t *order;               /* order[k]: the caller's number of node k */
  mpsi_fluid_motion now, next;  /* at the beginning and at the end of the step being made */
  double *mean;                 /* m/s, over the step being made */
  double *motion;               /* the memory of all these */
  int64_t first_image, images;  /* ghosts: images of particles here alone, in their order */
  mpsi_fluid_load load, before; /* of the last step or solution; before the step being made */
  mpsi_fluid_load former;       /* of the solution before the one being made */
  mpsi_fluid_struck struck;     /* of the step being made */
  double impulse[2], moment_impulse, work;
  int64_t first_sum; /* of its values in a row of mpsi_fluid_exchange */
  int64_t removed;   /* particles through an open side */
  double removed_mass;
} mpsi_fluid_wall;

/* Pose and motion of a body. */
typedef struct mpsi_fluid_pose {
  double x[2], R[4], v[2], spin;
} mpsi_fluid_pose;

typedef struct mpsi_fluid_body {
  struct mps_body *body;  /* NULL: none */
  int first, faces;       /* walls */
  double low[2], high[2]; /* m: a box that has all its faces; infinite where one extends behind a
                             boundary */
  mpsi_fluid_pose pose, next;
  struct mps_contact *contact; /* the caller's handle of it */
  mpsi_body_source *source; /* a member of that: by parts, forces of the water and its points, and
                               impulses of collisions, to be applied in the next step */
  bool floats;              /* see afloat.c */
  bool leaves; /* its handle was destroyed in the open step: it leaves the water when that ends */
  double rate[3], mass[9]; /* accelerations (m/s2); masses with the added ones (kg), 0: unknown */
  double rate_before[3], mass_before[9]; /* before the step being made */
  double tried[3], missed[3]; /* accelerations of the last trial, and what was out of balance */
  bool warned;                /* of its angle with a boundary */
} mpsi_fluid_body;

/* Whether boundary `number` exists. */
#define MPSI_FLUID_IS_BOUNDARY(f, number)                                                          \
  ((number) >= 0 && (number) < (f)->boundaries &&                                                  \
   ((f)->wall[number].used || (f)->wall[number].open || (f)->wall[number].line))

#define MPSI_FLUID_MOST_FACES 50000 /* of all bodies; numbers of walls have 16 bits */
#define MPSI_FLUID_NO_WALL UINT16_MAX

/* The walls that an image is mirrored at, by ascending number, then MPSI_FLUID_NO_WALL. Those of
 * one image are at right angles: more than two there cannot be. */
typedef struct mpsi_fluid_flips {
  uint16_t wall[2];
} mpsi_fluid_flips;

/* for (k of the walls of `flips`) */
#define MPSI_FLUID_FLIPS(k, flips)                                                                 \
  for (int k = 0; k < 2 && (flips).wall[k] != MPSI_FLUID_NO_WALL; k++)

/* The weight (1-z)^4 (1+4z), z = r/re, and its sums over the full lattice. */
typedef struct mpsi_fluid_weight {
  double re, inverse; /* m, 1/m */
  double n0;          /* sum w over the lattice */
  double half;        /* ... over the rows at and below a particle of a level surface */
  double slope;       /* growth of sum w with a surface that rises by l0 */
  double square;      /* sum w r^2/4 over the lattice, m2 */
} mpsi_fluid_weight;

/* Moments of a particle's neighbourhood; tensors xx, xy, yx, yy, symmetric ones xx, xy, yy.
 * Inputs of the pressure equation are exact to round-off; single precision is enough for the rest.
 */
typedef struct mpsi_fluid_local {
  double n, m[2];    /* sum w, sum w dx */
  double inverse[3]; /* of M = sum w dx dx^T/r^2, at the surface of M + c e e^T, c = |m|/h */
  double divergence; /* of velocity, 1/s */
  double h, qs;      /* distance of the surface (m), 0 farther inside; reduced pressure there, Pa */
  float S;           /* sum w r^2/4 */
  float shear[3];    /* of the velocity's gradient xx, xy, yx, 1/s */
  float rest[2];     /* sum w (du - G dx)/n: deviation from a linear velocity field, m/s */
  float shift[2];    /* sum w dx/(r n0) */
} mpsi_fluid_local;

/* Whether a particle has images among its neighbours, neighbours within .7 l0, a body's corner
 * within 1.5 l0, neighbours in other blocks of the matrix, and an acute corner of the water,
 * between a face and a boundary, within 3.1 l0. */
enum {
  MPSI_FLUID_NEAR_IMAGES = 1,
  MPSI_FLUID_NEAR_CLOSE = 2,
  MPSI_FLUID_NEAR_CORNER = 4,
  MPSI_FLUID_NEAR_OTHERS = 8,
  MPSI_FLUID_NEAR_WEDGE = 16
};
#define MPSI_FLUID_CLOSE 0.7 /* l0 */

enum { MPSI_FLUID_INSIDE = 0, MPSI_FLUID_SURFACE = 1, MPSI_FLUID_APART = 2 };

/* Rows of the pressure equation and vectors of its solution; see pcg.c. */
typedef struct mpsi_fluid_system {
  double *diagonal, *right; /* count */
  double *x;                /* count + ghosts; in the place of q, which a solution becomes */
  double *p, *r, *z, *q;    /* count */
  int32_t *lower_end;       /* of row i, in its block's stretch of lower_col and lower */
  uint16_t *lower_col;      /* from the first row of the block */
  float *lower;             /* of L */
  double *inverse;          /* of D */
  double *sums;             /* by chunk or block, two values each */
  double mean;              /* of the right side, or the shift of the solution; see closed.c */
} mpsi_fluid_system;

/* A solver of the caller, and its matrix; see solver.c. */
typedef struct mpsi_fluid_outside {
  void *user;
  mps_status (*matrix)(void *user, int64_t rows, const int64_t *start, const int32_t *column,
                       const double *value);
  mps_status (*solve)(void *user, const double *b, double tolerance, double *x,
                      int64_t *iterations);
  mps_status (*forget)(void *user);
  mps_status (*rows_of_rank)(void *user, int64_t all, int64_t first, int64_t rows,
                             const int64_t *start, const int32_t *column, const double *value);
  int64_t least, rows; /* rows: room of start */
  int64_t *start;
  mpsi_room column_room, value_room; /* int32_t, double */
} mpsi_fluid_outside;

/* The classical scheme, see classical.c; gamma 0: the library's own. */
typedef struct mpsi_fluid_classical {
  double gamma, n0, n_wide, lambda; /* sums over the lattice; lambda: mean of r^2, m2 */
} mpsi_fluid_classical;

/* How far the step is. */
typedef enum mpsi_fluid_stage {
  MPSI_FLUID_BETWEEN = 0, /* no step is open */
  MPSI_FLUID_BEGUN,       /* the pressure is that of the step before */
  MPSI_FLUID_SOLVED,
  MPSI_FLUID_MOVED /* the cloud is at the end of the step, the fields are not */
} mpsi_fluid_stage;

/* Warnings that are logged once per solver. */
typedef enum mpsi_fluid_warning {
  MPSI_FLUID_WARNED_GUARDS = 1, /* act often */
  MPSI_FLUID_WARNED_TRAVEL = 2, /* of a wall in a step */
  MPSI_FLUID_WARNED_SLOPE = 4   /* of a bent wall */
} mpsi_fluid_warning;

/* Origin of added or removed particles. */
typedef enum mpsi_fluid_change {
  MPSI_FLUID_UNCHANGED = 0,
  MPSI_FLUID_CHANGED_BY_CALLER,
  MPSI_FLUID_CHANGED_BY_STEP
} mpsi_fluid_change;

/* A load of the caller, loads.c. */
typedef struct mpsi_fluid_given {
  int32_t kind;
  int64_t count; /* of ids, 0: no list */
  int64_t *ids;  /* ascending */
  double lower[2], upper[2];
  double amount[2]; /* m/s2, or Pa, or 1/s */
  int32_t side;
  double factor[2], now[2];
  mps_signal *signal[2];
} mpsi_fluid_given;

typedef struct mpsi_fluid_loops mpsi_fluid_loops;         /* loops.h */
typedef struct mpsi_fluid_partition mpsi_fluid_partition; /* partition.h */
typedef struct mpsi_fluid_coarse mpsi_fluid_coarse;       /* coarse.h */
typedef struct mpsi_fluid_rocks mpsi_fluid_rocks;         /* rock.h */

struct mps_fluid {
  mps_context *context;
  mps_particles *particles;
  mpsi_holder holder; /* of the particles */
  mps_fluid_def def;
  const mpsi_fluid_loops *loops;
  mpsi_fluid_weight weight;
  double l0, g, up[2], level; /* m, m/s2, unit vector against gravity, m */
  mpsi_fluid_wall *wall;      /* boundaries by number, from `boundaries` on the faces of bodies */
  mpsi_fluid_body *body;      /* by number */
  int32_t boundaries, walls, bodies;
  mpsi_room wall_room, body_room;
  mpsi_room wedge_room, clip_room; /* see sight.c and closed.c: for so many walls */
  int64_t count, ghosts, capacity; /* capacity: of the arrays over particles */
  int64_t own[2];                  /* first, end: the particles that this rank computes */
  mpsi_fluid_partition *partition; /* NULL: all */
  /* positions, velocities: particles, then ghosts */
  double *x[2], *u[2], *q, *offset;     /* offset: of a ghost's q from its parent's, Pa */
  int32_t *parent;                      /* of a ghost, by index - count */
  mpsi_fluid_flips *flips;              /* of a ghost */
  int64_t segments;                     /* of all polylines; 0: there are none */
  mpsi_room segment_room, path_room;    /* mpsi_fluid_segment *; mpsi_fluid_path of each ghost */
  mpsi_room near_line_room;             /* bool of each segment: scratch of mirrors.c */
  mpsi_fluid_lines *lines;              /* where segments are, see vicinity.c */
  mpsi_room box_room;                   /* of each chunk's particles: low x, y, high x, y, m */
  int32_t limited, faces, bent, sticky; /* numbers of such walls, and of used faces of bodies */
  double (*wedge)[2];                   /* m, edges of acute corners between faces and boundaries */
  int wedges;
  int64_t cloud_capacity, ghost_capacity; /* of particles and ghosts together; of ghosts */
  double *u_new[2], *pressure;            /* count; pressure is in the place of system.right */
  uint8_t *state;                         /* MPSI_FLUID_..., count */
  bool any_apart;                         /* some are MPSI_FLUID_APART */
  atomic_uchar *zone;                     /* at the surface or within 1.6 l0 of it */
  uint8_t *company;                       /* MPSI_FLUID_NEAR_..., bits */
  float *zone_normal[2];
  mpsi_fluid_local *local;
  /* neighbours */
  int32_t *start;               /* first pair of each particle over MPSI_FLUID_WIDE */
  uint16_t *near;               /* pairs of each particle, at most CROWD of near.c */
  int64_t most_near;            /* room for pairs, a particle on average over a chunk */
  mpsi_room index_room, w_room; /* int32_t, float: pairs */
  int32_t *index;               /* of the pairs' other ends, ghosts too */
  float *w;                     /* of the pairs: the weight, rounded, wherever it is used */
  mpsi_room fit_room;           /* sums of fits, see probe.c */
  mpsi_room near_wall_room;     /* of a wall, see probe.c */
  int32_t *slot; /* cloud sorted by cells during the neighbour search: in lower_room */
  double *slot_x[2];
  float *flux[5];           /* of the cloud: b and G of smooth.c, once q is known; in lower_room */
  bool paired;              /* some b are not 0 */
  mpsi_fluid_given **given; /* loads by number, NULL: none */
  int32_t given_room;
  mpsi_room push_room;    /* of the following */
  double *push[2], *over; /* of each particle: acceleration by loads and forces, m/s2; pressure on
                             its surface, Pa; NULL: none has any */
  bool driven;            /* u of the cloud has dt times push already */
  double load_time, load_time_before; /* s: when the loads were read, for this step and before it */
  mpsi_fluid_system system;
  mpsi_fluid_coarse *coarse;
  mpsi_room lower_col_room, lower_room; /* the sort by cells too, while there is no factor */
  int64_t most_lower;                   /* room for entries of L, a row on average */
  void *slab;                           /* of all arrays of fixed size */
  void *cloud;
  double time, dt, speed; /* s; s, of the step being made; largest |u|, m/s */
  double travel;          /* m: of particles, and of walls, since the images were made, at most */
  double last_dt;         /* s, of the last step; 0 before the first */
  int64_t steps;
  mpsi_fluid_stage stage;
  mpsi_fluid_classical classical;
  mpsi_fluid_outside *outside; /* NULL: none */
  mpsi_guard guard;            /* of the callbacks of the run and of the solver */
  mpsi_fluid_change change;    /* of the set, that is under way; energy_before is that of before */
  bool stale;                  /* the cloud is not that of the fields */
  bool edited;                 /* the caller has written fields, which ranks have not compared */
  int64_t unknown; /* 1: free_surface and surface_rise are not of the present set and walls */
  uint32_t warned; /* logged already: mpsi_fluid_warning, bits */
  mpsi_identity *identity;
  mps_fluid_report report, before;     /* before: as the step being made began */
  mps_fluid_report report_before_look; /* of mpsi_fluid_refresh, until mpsi_fluid_show_surface */
  double energy_before;                /* J, before particles are added or removed */
  double energy;                       /* J, kinetic and potential at creation */
  double work_boundaries, work_loads;  /* J, since creation */
  mpsi_fluid_exchange exchange;
  mpsi_fluid_rocks *rocks; /* NULL: none */
};

/* Runs task(fluid, chunk) for this rank's chunks of `items` items on the executor. */
typedef void (*mpsi_fluid_task)(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_for(mps_fluid *fluid, int64_t items, int64_t chunk, mpsi_fluid_task task);
/* Runs task(data, unit, worker) for this rank's units of `size` particles on the executor. */
void mpsi_fluid_units(mps_fluid *fluid, int64_t size, void (*task)(void *, int64_t, int32_t),
                      void *data);
/* The same of all, on every rank. */
void mpsi_fluid_for_all(mps_fluid *fluid, int64_t items, int64_t chunk, mpsi_fluid_task task);

static inline double mpsi_fluid_larger(double a, double b) { return a > b ? a : b; }

static inline double mpsi_fluid_w(const mpsi_fluid_weight *weight, double r) {
  const double a = 1.0 - r * weight->inverse;
  return a * a * a * a * (5.0 - 4.0 * a);
}

/* The first of particle i's pairs. */
static inline int64_t mpsi_fluid_pairs(const mps_fluid *f, int64_t i) {
  return (int64_t)f->start[i] * MPSI_FLUID_WIDE;
}

/* c = |m|/h, the weight of a particle's surface point; 0 where it has none. */
static inline double mpsi_fluid_surface_weight(const mpsi_fluid_local *local) {
  const double *m = local->m;
  return local->h > 0.0 ? sqrt(m[0] * m[0] + m[1] * m[1]) / local->h : 0.0;
}

/* G, the gradient of velocity, 1/s. */
static inline void mpsi_fluid_gradient(const mpsi_fluid_local *local, double *G) {
  for (int k = 0; k < 3; k++) G[k] = local->shear[k];
  G[3] = local->divergence - G[0];
}

/* Heights of the surface above the particles, from their move to the fields: where the pressure's
 * search direction was, which is free then. */
static inline double *mpsi_fluid_rises(const mps_fluid *f) { return f->system.p; }

/* rho g (height - level), Pa: reduced pressure less pressure. */
static inline double mpsi_fluid_head(const mps_fluid *f, double x, double y) {
  return f->def.density * f->g * (f->up[0] * x + f->up[1] * y - f->level);
}

/* The rate (g/l0)^1/2, 1/s, of smoothing, shifting and the density's source; without gravity that
 * of the largest velocity. */
static inline double mpsi_fluid_rate(const mps_fluid *f) {
  return f->g > 0.0 ? sqrt(f->g / f->l0) : f->speed / f->l0;
}

mpsi_fluid_weight mpsi_fluid_make_weight(double l0, double re);

/* wall.c: drop_wall, make_motion, mirror_point, between; walls.c: the rest */
mps_status mpsi_fluid_make_motion(mps_fluid *fluid, const char *function, mpsi_fluid_wall *wall,
                                  int64_t nodes, const double *points);
void mpsi_fluid_drop_wall(mps_fluid *fluid, mpsi_fluid_wall *wall);
/* Evaluates the signals of walls for the end of a step of dt; not collective; on an error nothing
 * has changed. */
mps_status mpsi_fluid_look_ahead(mps_fluid *fluid, const char *function, double dt);
void mpsi_fluid_begin_walls(mps_fluid *fluid, double dt); /* next, from signals and callers */
void mpsi_fluid_end_walls(mps_fluid *fluid);              /* now = next */
void mpsi_fluid_add_impulses(mps_fluid *fluid);
/* Room for so many particles and ghosts; false: none. */
bool mpsi_fluid_grow_cloud(mps_fluid *fluid, int64_t particles, int64_t ghosts);
mps_status mpsi_fluid_make_ghosts(mps_fluid *fluid, const char *function);
void mpsi_fluid_mirror_point(const mps_fluid *fluid, mpsi_fluid_flips flips,
                             double *x);       /* at these walls */
void mpsi_fluid_move_ghosts(mps_fluid *fluid); /* their velocities */
void mpsi_fluid_press_ghosts(
    mps_fluid *fluid); /* their pressure offsets, by walls' new velocities */
/* Coordinate along a wall, m. */
static inline double mpsi_fluid_along(const mpsi_fluid_wall *w, double x, double y) {
  return -(x - w->at[0]) * w->normal[1] + (y - w->at[1]) * w->normal[0];
}
/* Positions and accelerations of walls in the state of the cloud. */
static inline const double *mpsi_fluid_places(const mps_fluid *f, const mpsi_fluid_wall *w) {
  return f->stage == MPSI_FLUID_MOVED ? w->next.s : w->now.s;
}
static inline const double *mpsi_fluid_accelerations(const mps_fluid *f, const mpsi_fluid_wall *w) {
  return f->stage >= MPSI_FLUID_SOLVED ? w->next.a : w->now.a;
}
double mpsi_fluid_between(const mpsi_fluid_wall *wall, const double *values, double along);
/* Displacement, velocity or acceleration of the wall at the foot of (x, y). */
static inline double mpsi_fluid_of_wall(const mpsi_fluid_wall *w, const double *values, double x,
                                        double y) {
  return w->nodes == 1 ? values[0] : mpsi_fluid_between(w, values, mpsi_fluid_along(w, x, y));
}
/* Distance (m) from a wall displaced by s, > 0 in the fluid. */
static inline double mpsi_fluid_distance(const mpsi_fluid_wall *w, const double *s, double x,
                                         double y) {
  const double across = (x - w->at[0]) * w->normal[0] + (y - w->at[1]) * w->normal[1];
  return across - mpsi_fluid_of_wall(w, s, x, y);
}

/* slots.c. A boundary of this number, faces of a body (first: that of them), a body of this number;
 * false, or -1: no memory. */
bool mpsi_fluid_make_boundary(mps_fluid *fluid, int32_t number);
int mpsi_fluid_make_faces(mps_fluid *fluid, int faces);
bool mpsi_fluid_make_body(mps_fluid *fluid, int32_t number);
/* Boundaries and bodies without members at the end of the lists, and `faces` walls from `first` on,
 * leave them. */
void mpsi_fluid_drop_slots(mps_fluid *fluid, int first, int faces);

/* loads.c */
void mpsi_fluid_drop_loads(mps_fluid *fluid);
/* push and over as of time t, of the particles in their present order. */
mps_status mpsi_fluid_find_loads(mps_fluid *fluid, const char *function, double t);
double mpsi_fluid_work_of_loads(const mps_fluid *fluid); /* J, of the step being made */
/* Least pressure of particle i: 0, or the suction on its surface, Pa. */
static inline double mpsi_fluid_least(const mps_fluid *f, int64_t i) {
  return f->over && f->over[i] < 0.0 ? f->over[i] : 0.0;
}

/* bodies.c */
void mpsi_fluid_place_bodies(mps_fluid *fluid);            /* faces as of the pose */
void mpsi_fluid_drive_bodies(mps_fluid *fluid, double dt); /* next of the faces */
void mpsi_fluid_load_body(const mps_fluid *fluid, mpsi_fluid_body *body, const double *about);
void mpsi_fluid_end_bodies(mps_fluid *fluid);
/* m: rotations count as displacements at this radius. */
double mpsi_fluid_body_length(const mpsi_fluid_body *body, const mps_fluid *fluid);
void mpsi_fluid_drop_body(mps_fluid *fluid, mpsi_fluid_body *body);
void mpsi_fluid_drop_leaving(mps_fluid *fluid); /* once no step is open */
/* Of the body that a contact is with; -1: none of this fluid's, or it has ended. */
int32_t mpsi_fluid_body_number(const mps_fluid *fluid, const mps_contact *contact);
/* Whether the fluid may move a body (`contact`: that with it, NULL before there is one). */
mps_status mpsi_fluid_check_floats(mps_fluid *fluid, const char *function, const mps_body *body,
                                   const mps_contact *contact, int32_t floats);
void mpsi_fluid_let_float(mps_fluid *fluid, int32_t number, int32_t floats);
#define MPSI_FLUID_LEAST_ANGLE 15.0 /* degrees of fluid between a face and what it stands on */
/* Whether the beginning (0) or the end (1) of a face stands on boundary number b. */
bool mpsi_fluid_stands_on(const mps_fluid *fluid, const mpsi_fluid_wall *face, int end, int b);
/* Degrees of fluid between a face and boundary number b; 180 where it does not stand there. */
double mpsi_fluid_angle(const mps_fluid *fluid, const mpsi_fluid_wall *face, int b);
/* Whether x is within `reach` of the box of a body. */
static inline bool mpsi_fluid_beside(const mpsi_fluid_body *body, const double *x, double reach) {
  return body->body && x[0] > body->low[0] - reach && x[0] < body->high[0] + reach &&
         x[1] > body->low[1] - reach && x[1] < body->high[1] + reach;
}
/* The face nearest to x, in the body's order, and the distance, negative inside. */
int mpsi_fluid_face_of(const mps_fluid *fluid, const mpsi_fluid_body *body, bool moved,
                       const double *x, double *distance);
/* Whether x is inside a body other than number `besides` - 1. */
bool mpsi_fluid_inside_body(const mps_fluid *fluid, int besides, const double *x);
/* afloat.c */
bool mpsi_fluid_any_afloat(const mps_fluid *fluid);
mps_status mpsi_fluid_solve_afloat(mps_fluid *fluid, const char *function);
/* sight.c */
void mpsi_fluid_find_limits(mps_fluid *fluid);
int64_t mpsi_fluid_keep_visible(const mps_fluid *fluid, int64_t i, int64_t count, int32_t *index,
                                double *r2);
/* Whether a corner of a body, in the water, is within 1.5 l0 of particle i. */
bool mpsi_fluid_near_corner(const mps_fluid *fluid, int64_t i);
/* Whether an acute corner of the water is within 3.1 l0 of particle i, and within 60 degrees of the
 * direction e, unless that is NULL. */
bool mpsi_fluid_near_wedge(const mps_fluid *fluid, int64_t i, const double *e);
/* Whether a face other than `wall` (-1: none) is between two points. */
bool mpsi_fluid_hidden(const mps_fluid *fluid, int wall, const double *a, const double *b);
/* near.c; room for a sorted cloud of so many: five values of 4 bytes each lie in lower_room. */
int64_t mpsi_fluid_sorted_room(int64_t all);
mps_status mpsi_fluid_find_neighbours(mps_fluid *fluid, const char *function);
/* moments.c; rise: height of the surface above particle i against gravity, m; 0: none. */
void mpsi_fluid_find_moments(mps_fluid *fluid);
void mpsi_fluid_count(mps_fluid *fluid); /* to the report: neighbours, particles at the surface */
double mpsi_fluid_rise(const mps_fluid *fluid, int64_t i);
/* closed.c: MPS_ERROR_STATE for a step that changes the volume of a space that the fluid fills. */
mps_status mpsi_fluid_check_space(mps_fluid *fluid, const char *function);
/* For a fluid without surface: subtracts the mean of the right side; sets the solution's constant.
 */
void mpsi_fluid_balance(mps_fluid *fluid);
void mpsi_fluid_set_level(mps_fluid *fluid);
/* pressure.c */
mps_status mpsi_fluid_prepare_pressure(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_solve_pressure(mps_fluid *fluid, const char *function);
/* pcg.c: solves for system.x, starting from what it holds; the number of iterations, or -1. */
mps_status mpsi_fluid_factor(mps_fluid *fluid, const char *function);
int64_t mpsi_fluid_pcg(mps_fluid *fluid);
/* solver.c */
bool mpsi_fluid_solved_outside(const mps_fluid *fluid);
mps_status mpsi_fluid_hand_matrix(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_solve_outside(mps_fluid *fluid, const char *function);
void mpsi_fluid_drop_solver(mps_fluid *fluid);
/* Lets a solver of the caller discard its data of former equations. */
mps_status mpsi_fluid_forget(mps_fluid *fluid, const char *function);
/* warn.c: MPS_ERROR_DIVERGED for a step whose walls move or bend too far; warnings to the log. */
mps_status mpsi_fluid_check_walls(mps_fluid *fluid, const char *function);
void mpsi_fluid_warn_of_guards(mps_fluid *fluid);
void mpsi_fluid_warn_of_angles(mps_fluid *fluid);
/* move.c */
void mpsi_fluid_find_velocities(mps_fluid *fluid);
int64_t mpsi_fluid_advance(mps_fluid *fluid); /* first particle that failed, or -1 */
#define MPSI_FLUID_OFF_WALL 0.1               /* l0: no particle comes closer to a wall */
/* keep_off.c: takes particle i, which has moved to x with the velocity u, back to the fluid's side
 * of polylines; whether it had to. */
bool mpsi_fluid_keep_off_lines(const mps_fluid *fluid, int64_t i, double *x, double *u);
/* exchange.c: memory of a step's sums; their values, on all ranks; finally the momentum error. */
mps_status mpsi_fluid_begin_exchange(mps_fluid *fluid, const char *function);
void mpsi_fluid_end_exchange(mps_fluid *fluid);
void mpsi_fluid_book_momentum(mps_fluid *fluid);
void mpsi_fluid_drop_exchange(mps_fluid *fluid);
/* classical.c */
mps_status mpsi_fluid_classical_look(mps_fluid *fluid, const char *function, mps_status status);
void mpsi_fluid_classical_rows(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_classical_solution(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
void mpsi_fluid_classical_accelerate(mps_fluid *fluid, int64_t begin, int64_t end, int64_t chunk);
/* particles.c */
void mpsi_fluid_remove_outflow(
    mps_fluid *fluid); /* removes particles beyond an open side, at the end of a step */
#define MPSI_FLUID_MOST_PARTICLES (INT32_MAX / 4)
bool mpsi_fluid_reserve(mps_fluid *fluid, int64_t count);
void mpsi_fluid_find_speed(mps_fluid *fluid);
mps_status mpsi_fluid_commit(void *fluid, const char *function, const char *field,
                             const double *former);
mps_status mpsi_fluid_insert(void *fluid, const char *function, int64_t first, int64_t count);
mps_status mpsi_fluid_remove(void *fluid, const char *function, int64_t count, const int64_t *ids);
void mpsi_fluid_renew(void *fluid);
/* access.c: kinetic energy, and with that of gravity, J */
double mpsi_fluid_energy(const mps_fluid *fluid, double *kinetic);
/* probe.c */
mps_status mpsi_fluid_load_walls(mps_fluid *fluid, const char *function);
/* look.c: copies of positions, velocities and the last reduced pressure; their surroundings; and
 * both with the loads. */
void mpsi_fluid_load_cloud(mps_fluid *fluid);
mps_status mpsi_fluid_look_around(mps_fluid *fluid, const char *function, mps_status status);
mps_status mpsi_fluid_look(mps_fluid *fluid, const char *function);
/* look.c: data of readings between steps, which follow from the state alone: the fields of the
 * surface (know); and with them the cloud, its loads and walls (refresh). After the latter
 * mpsi_fluid_show_surface writes the fields if the whole reading has succeeded, and otherwise
 * changes nothing; it returns `status`. */
mps_status mpsi_fluid_ensure_surface(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_refresh(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_show_surface(mps_fluid *fluid, mps_status status);
/* look.c: sorts the particles by position. */
mps_status mpsi_fluid_sort(mps_fluid *fluid, const char *function);
/* access.c: MPS_ERROR_STATE within a callback of the run (free), while a step is open (closed), or
 * both (ready). */
mps_status mpsi_fluid_free(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_closed(mps_fluid *fluid, const char *function);
mps_status mpsi_fluid_ready(mps_fluid *fluid, const char *function);
/* access.c: checks `dt` (s; NaN: chosen by the library). */
mps_status mpsi_fluid_check_dt(const mps_fluid *f, const char *function, double dt);
mps_status mpsi_fluid_check_viscosity(mps_context *context, const char *function, double viscosity);
/* material.c: density and viscosity of a definition where it leaves them to the set's field and a
 * material. */
mps_status mpsi_fluid_read_material(mps_context *context, const char *function,
                                    const mps_particles *particles, mps_fluid_def *def);

#endif
