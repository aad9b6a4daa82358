/* mps/fluid_boundary.h - boundaries of a fluid: plane, bending and polyline walls, wave makers,
 * open sides; forces and pressures on them.
 *
 * Thread rule: as mps/fluid.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_BOUNDARY_H
#define LIBMPS_FLUID_BOUNDARY_H

#include "fluid.h"

MPS_EXTERN_C_BEGIN

/* Kinds (mps_boundary_kind) of a wall and of a body's surface:
 *
 *   HELD    no flow across; no slip where the fluid has a viscosity; the wall does not move along
 *           itself
 *   DRIVEN  the same, moved along the normal by a signal
 *   ROLLER  no flow across, no shear: slip; at rest or moved along the normal by a signal
 *   OPEN    no wall: particles that have passed it are removed at the end of a step and counted in
 *           its reaction; the pressure there is that of the air, as where water falls over an edge.
 *           It does not move */

#define MPS_FLUID_MAX_BOUNDARIES 10000 /* of a fluid */

/** A plane wall: the fluid is where (x - point) . normal > 0. It moves with a signal (piston), or
 *  as prescribed by mps_fluid_set_wall_motion; then it may bend slightly: a displacement along the
 *  normal at each of its nodes, linear between them, with local mirror images. The fluid's angle
 *  between two walls is 90 degrees or more; of a bed and a slope, add the bed first.
 *
 *  Or a polyline at rest, HELD or ROLLER: segments of at least l0 with 15 to 345 degrees of fluid
 *  at each corner, as of bed, slope, berm and crest, of the tip of a wedge, or closed of an island.
 *  An open one continues straight beyond its first and last corner without limit. Where it passes a
 *  plane wall (a piston) it does so at a right angle, with corners at least re away. It has one
 *  number: reactions are sums over its segments, pressures those along all of them. Bodies keep re
 *  away from it: one that is nearer is refused, and so is a step in which one comes nearer. */
typedef struct mps_fluid_boundary_def {
  uint32_t struct_size;
  int32_t kind;       /* mps_boundary_kind: HELD (default), DRIVEN, ROLLER, OPEN */
  double point[3];    /* m, of the wall at time 0; its pressures are sampled from here on, every
                         l0: choose the corner */
  double normal[3];   /* into the fluid, any length > 0; [2] must be 0; no default */
  mps_signal *signal; /* displacement along the normal: factor times that of the signal, from its
                         value at the time when the boundary is added; NULL (default): at rest.
                         Not of HELD. Kept alive */
  double factor;      /* default 1 */
  const double
      *nodes; /* of a bending wall: points along it (3 values each, m, in any order; projected onto
                 the plane), copied; NULL (default): it stays plane, and moves as one node */
  int64_t node_count;    /* default 0; at most 1 with a signal */
  const double *corners; /* of a polyline: its corners in order, the fluid to the left of the way
                            along them (3 values each, m, z 0), copied; NULL (default): a plane
                            wall. `point`, `normal` and `factor` are not read then */
  int64_t corner_count;  /* 2 to 10000, default 0. The first again as the last: it is closed */
} mps_fluid_boundary_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_fluid_boundary_def_init(mps_fluid_boundary_def *def, size_t size);
static inline mps_fluid_boundary_def mps_fluid_boundary_defaults(void) {
  mps_fluid_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_fluid_boundary_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a wall, between steps; `number` (may be NULL) receives the lowest free number.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range; a particle lies outside or closer than .3 l0
 *  to it; two walls that enclose less than 90 degrees, unless that corner lies more than re behind
 *  a third one; a polyline that crosses itself, joins a plane wall otherwise than above, or is
 *  nearer than re to a body; more than MPS_FLUID_MAX_BOUNDARIES.
 * MPS_ERROR_STATE: a step is open, or a callback of the solver is running. MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_add_boundary(mps_fluid *fluid,
                                                        const mps_fluid_boundary_def *def,
                                                        int32_t *number);
/** Gives a wall another definition: its present position is `point`, its velocity is kept, and so
 *  are its impulse and work. MPS_ERROR_ARGUMENT: no wall `number`; otherwise errors as
 *  mps_fluid_add_boundary. On an error it is unchanged. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_boundary(mps_fluid *fluid, int32_t number,
                                                        const mps_fluid_boundary_def *def);
/** Removes a wall: the fluid may flow out there. MPS_ERROR_ARGUMENT: no wall `number`;
 *  MPS_ERROR_STATE: a step is open, or a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_remove_boundary(mps_fluid *fluid, int32_t number);

/** Motion of a wall without a signal: `velocity` (m/s) at the end of the next step, or of the open
 *  one, and `displacement` (m) there from where the wall was added, both along the normal (into the
 *  fluid), one value a node (mps_fluid_boundary_def.nodes; else one). `displacement` NULL: the mean
 *  of the velocities before and after takes it there. It is used for one step; afterwards the wall
 *  continues at its velocity. The acceleration of the wall is the change of velocity over dt.
 *  MPS_ERROR_ARGUMENT: no wall `number`, one with a signal, or a value beyond 1e6 m/s or 1e12 m;
 *  MPS_ERROR_STATE: a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_wall_motion(mps_fluid *fluid, int32_t number,
                                                           const double *displacement,
                                                           const double *velocity);

/** Force, impulse and work of a wall on the fluid. Force and moment are those of its pressures,
 *  summed over the points of mps_fluid_get_wall. Impulse, moment_impulse and work include
 *  collisions with the wall and the smoothing of velocities at it: in breakers some hundredths of
 *  the impulse. MPS_ERROR_ARGUMENT: no wall `number`, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_reaction_sized(const mps_fluid *fluid,
                                                              int32_t number, mps_reaction *out,
                                                              size_t size);
static inline mps_status mps_fluid_get_reaction(const mps_fluid *fluid, int32_t number,
                                                mps_reaction *out) {
  return mps_fluid_get_reaction_sized(fluid, number, out, sizeof *out);
}

/** Pressure along a wall after the last step (within an open step: of the last solution), at its
 *  wetted points every l0. Writes at most `capacity` points: `x` (3 values a point, m) and
 *  `pressure` (Pa), each may be NULL; `count` receives their number. Each point has the area l0
 *  times `measure`. MPS_ERROR_ARGUMENT: no wall `number`, or `capacity` below 0; MPS_ERROR_STATE:
 *  the open step's pressure has not been solved; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_wall(const mps_fluid *fluid, int32_t number,
                                                    int64_t capacity, int64_t *count, double *x,
                                                    double *pressure);
/** Pressure (Pa) at `count` points of a wall, likewise: x[3 * k], ... in m, within 0.01 l0 of the
 *  wall's present or initial position; 0 where there is no water. MPS_ERROR_ARGUMENT: no wall
 *  `number`, `count` below 0, or a point off the wall; MPS_ERROR_STATE: the open step's pressure
 *  has not been solved; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_pressure(const mps_fluid *fluid, int32_t number,
                                                        int64_t count, const double *x,
                                                        double *pressure);
/** Forces on the fluid by the segments of a polyline (N, 3 values each), in the order of its
 * corners, and their moments about the origin (N m, one value each), as in its reaction: writes at
 * most `capacity` segments, either may be NULL; `count` receives their number. MPS_ERROR_ARGUMENT:
 * no polyline `number`, `count` NULL, or `capacity` below 0. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_segments(const mps_fluid *fluid, int32_t number,
                                                        int64_t capacity, int64_t *count,
                                                        double *force, double *moment);

MPS_EXTERN_C_END
#endif
