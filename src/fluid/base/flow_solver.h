/* flow_solver.h - the incompressible fluid solver, put together from its parts: each has a header
 * of its own. Indices below `count` are particles, those from `count` on are ghosts. A step works
 * on copies of positions and velocities and writes the particles' fields only on success.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "body/body_internal.h"
#include "core/base/exact.h"
#include "core/base/room.h"
#include "core/context/guard.h"
#include "core/context/retain.h"
#include "core/internal.h"
#include "core/particles/particles_internal.h"
#include "core/state/state.h"
#include "fluid/boundary/bodies.h"
#include "fluid/boundary/wall.h"
#include "fluid/particles/loads.h"
#include "fluid/particles/moments.h"
#include "fluid/particles/near.h"
#include "fluid/pressure/classical.h"
#include "fluid/pressure/pressure.h"
#include "fluid/pressure/outside.h"
#include "solver/solver_base.h"

#include <mps/fluid.h>

#define MPSI_FLUID_CHUNK 256   /* particles in a unit of work: sums are made in this order */
#define MPSI_FLUID_COPIED 1024 /* in one that only copies */

/* Sums of momentum that is exchanged in a step: a row of values for each chunk of particles, see
 * exchange.c; and since creation the impulse of gravity and loads, and the momentum error of the
 * scheme, N s. */
typedef struct mpsi_fluid_exchange {
  mpsi_room rows, sums; /* double, mpsi_exact */
  int64_t width;        /* values of a row */
  double gain[2];       /* N s: of the water in the step */
  double loads[2], scheme[2];
} mpsi_fluid_exchange;

typedef struct mpsi_fluid_lines mpsi_fluid_lines;

/* Whether boundary `number` exists. */
#define MPSI_FLUID_IS_BOUNDARY(f, number)                                                          \
  ((number) >= 0 && (number) < (f)->boundaries &&                                                  \
   ((f)->wall[number].used || (f)->wall[number].open || (f)->wall[number].line))

/* How far the step is. */
typedef enum mpsi_fluid_stage {
  MPSI_FLUID_BETWEEN = 0, /* no step is open */
  MPSI_FLUID_BEGUN,       /* the pressure is that of the step before */
  MPSI_FLUID_SOLVED,
  MPSI_FLUID_MOVED /* the cloud is at the end of the step, the fields are not */
} mpsi_fluid_stage;

/* Origin of added or removed particles. */
typedef enum mpsi_fluid_change {
  MPSI_FLUID_UNCHANGED = 0,
  MPSI_FLUID_CHANGED_BY_CALLER,
  MPSI_FLUID_CHANGED_BY_STEP
} mpsi_fluid_change;

typedef struct mpsi_fluid_loops mpsi_fluid_loops;         /* loops.h */
typedef struct mpsi_fluid_partition mpsi_fluid_partition; /* partition.h */
typedef struct mpsi_fluid_coarse mpsi_fluid_coarse;       /* coarse.h */
typedef struct mpsi_fluid_rocks mpsi_fluid_rocks;         /* rock.h */

#define MPSI_FLUID_CROWD 4096 /* most candidates in the cells around a particle */

/* A worker's list of the neighbours of one particle: too large for the stack of a host's thread. */
typedef struct mpsi_fluid_crowd {
  _Alignas(64) double value[MPSI_FLUID_CROWD + MPSI_FLUID_WIDE];
  int32_t index[MPSI_FLUID_CROWD + MPSI_FLUID_WIDE];
  int32_t count;
} mpsi_fluid_crowd;

struct mps_fluid {
  MPSI_SOLVER_BASE;
  mps_fluid_def def;
  const mpsi_fluid_loops *loops;
  mpsi_fluid_weight weight; /* of water without rock near */
  double reach;             /* m, the largest radius of weights: in rock it may be more (rock.c) */
  double l0, g, up[2], level; /* m, m/s2, unit vector against gravity, m */
  double rest; /* m: the level, where that is within the water; else the water's top at creation */
  mpsi_fluid_wall *wall; /* boundaries by number, from `boundaries` on the faces of bodies */
  mpsi_fluid_body *body; /* by number */
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
  int32_t rough;                        /* of walls, faces and polylines with friction */
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
  uint16_t *near;               /* pairs of each particle, at most MPSI_FLUID_CROWD */
  int64_t most_near;            /* room for pairs, a particle on average over a chunk */
  mpsi_room index_room, w_room; /* int32_t, float: pairs */
  mpsi_room crowd_room;         /* mpsi_fluid_crowd, of each worker */
  int32_t *index;               /* of the pairs' other ends, ghosts too */
  float *w;                     /* of the pairs: the weight, rounded, wherever it is used */
  mpsi_room fit_room;           /* sums of fits, see probe.c */
  mpsi_room near_wall_room;     /* of a wall, see probe.c */
  int32_t *slot; /* cloud sorted by cells during the neighbour search: in lower_room */
  double *slot_x[2];
  float *flux[5];         /* of the cloud: b and G of smooth.c, once q is known; in lower_room */
  bool paired;            /* some b are not 0 */
  mpsi_room push_room;    /* of the following */
  double *push[2], *over; /* of each particle: acceleration by loads and forces, m/s2; pressure on
                             its surface, Pa; NULL: none has any */
  bool driven;            /* u of the cloud has dt times push already */
  double load_time, load_time_before; /* s: when the loads were read, for this step and before it */
  mpsi_fluid_system system;
  mpsi_fluid_coarse *coarse;
  mpsi_room lower_col_room, lower_room; /* the sort by cells too, while there is no factor */
  int64_t most_lower;                   /* room for entries of L, of eight rows on average */
  void *slab;                           /* of all arrays of fixed size */
  void *cloud;
  double time, dt, speed; /* s; s, of the step being made; largest |u|, m/s */
  double stir;            /* m/s, largest |u| in the frame of the walls, else of the water's mean */
  double travel;          /* m: of particles, and of walls, since the images were made, at most */
  double last_dt;         /* s, of the last step; 0 before the first */
  int64_t steps;
  mpsi_fluid_stage stage;
  mpsi_fluid_classical classical;
  mpsi_fluid_outside outside;
  mpsi_fluid_change change; /* of the set, that is under way; energy_before is that of before */
  bool stale;               /* the cloud is not that of the fields */
  bool shortens, too_long;  /* the step is tried again where a particle goes too far; it did */
  bool edited;              /* the caller has written fields, which ranks have not compared */
  int64_t unknown; /* 1: free_surface and surface_rise are not of the present set and walls */
  uint32_t warned; /* logged already: mpsi_fluid_warning, bits */
  mps_fluid_report report, before;     /* before: as the step being made began */
  mps_fluid_report report_before_look; /* of mpsi_fluid_refresh, until mpsi_fluid_show_surface */
  double energy_before;                /* J, before particles are added or removed */
  double energy;                       /* J, kinetic and potential at creation */
  double work_boundaries, work_loads;  /* J, since creation */
  bool renewed; /* the caller has changed positions or velocities since given_energy was found */
  double given_energy; /* J, put in so: step/bound.h */
  mpsi_fluid_exchange exchange;
  mpsi_fluid_rocks *rocks; /* NULL: none */
};

static inline double mpsi_fluid_larger(double a, double b) { return a > b ? a : b; }

static inline double mpsi_fluid_w(const mpsi_fluid_weight *weight, double r) {
  const double a = 1.0 - r * weight->inverse;
  return weight->scale * (a * a * a * a * (5.0 - 4.0 * a));
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

/* Share in which G gives the stress across the surface at a particle beside it: 0 in
 * spray and at the tip of a jet, 1 from the surface row of a lattice on. */
static inline double mpsi_fluid_stressed(const mps_fluid *f, const mpsi_fluid_local *local) {
  return local->h > 0.0 ? fmin(fmax((local->n / f->weight.n0 - 0.4) / 0.15, 0.0), 1.0) : 0.0;
}

/* 2 mu e G e, e the normal of the surface at a particle beside it: the viscous stress (Pa) across
 * the surface, which its pressure balances. */
static inline double mpsi_fluid_surface_stress(const mps_fluid *f, const mpsi_fluid_local *local) {
  const double *m = local->m, square = m[0] * m[0] + m[1] * m[1];
  if (!(f->def.viscosity > 0.0 && local->h > 0.0 && square > 0.0)) return 0.0;
  double G[4];
  mpsi_fluid_gradient(local, G);
  return 2.0 * f->def.viscosity * mpsi_fluid_stressed(f, local) *
         (G[0] * m[0] * m[0] + (G[1] + G[2]) * m[0] * m[1] + G[3] * m[1] * m[1]) / square;
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
  return f->g > 0.0 ? sqrt(f->g / f->l0) : f->stir / f->l0;
}

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

/* Least pressure of particle i: 0, or the suction on its surface, Pa. */
static inline double mpsi_fluid_least(const mps_fluid *f, int64_t i) {
  return f->over && f->over[i] < 0.0 ? f->over[i] : 0.0;
}

/* Whether x is within `reach` of the box of a body. */
static inline bool mpsi_fluid_beside(const mpsi_fluid_body *body, const double *x, double reach) {
  return body->body && x[0] > body->low[0] - reach && x[0] < body->high[0] + reach &&
         x[1] > body->low[1] - reach && x[1] < body->high[1] + reach;
}

/* Whether the boxes around two bodies are nearer than `reach` (m). */
static inline bool mpsi_fluid_boxes_near(const mpsi_fluid_body *one, const mpsi_fluid_body *other,
                                         double reach) {
  for (int c = 0; c < 2; c++)
    if (!(one->low[c] < other->high[c] + reach && other->low[c] < one->high[c] + reach))
      return false;
  return true;
}

MPSI_CONDITION_ACCESS(mpsi_fluid_load, mps_fluid, MPSI_LOADS, mpsi_fluid_given)
