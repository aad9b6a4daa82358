/* mps/fluid.h - incompressible free-surface flow by moving particles (MPS), in the plane: waves,
 * wave makers, impact of water on walls.
 *
 * The pressure follows from a symmetric Poisson equation for the reduced pressure q = p + rho g
 * (height - reference level): in water at rest q is 0 exactly, gravity drops out of the equations,
 * and walls are plain Neumann boundaries, made of mirror images of the particles. The free surface
 * is a line a short way outside the outer particles, at a distance that each of them finds from its
 * neighbours (docs/fluid.md has the equations).
 *
 * The set's spacing l0 is the particles' distance: each stands for l0^2 times `measure` of water.
 * The radius re, `radius_ratio` times l0, is how far a particle sees its neighbours. A step is open
 * between the calls of mps/experimental/fluid_parts.h that begin and end it; programs that do not
 * use that header have no open steps.
 * The solver works in the fields of the set (zero copy) and sorts it now and then: views taken
 * before are then stale (their epoch). It reads `velocity` at creation where the set has it,
 * `external_force` (N) at every step if the set has it by then, and writes `position`, `velocity`,
 * `pressure`, `reduced_pressure`, `reduced_pressure_old`, `free_surface` and `surface_rise`.
 *
 * Between steps particles may be edited, added (at rest, at least .3 l0 inside of all walls) and
 * removed (not the last one), and pass open sides; the energy that they add or remove is no work.
 *
 * Ranks (mps/experimental/domain.h; docs/cluster.md) each make the same whole fluid, with the same
 * boundaries, bodies, loads and edits, and keep all of it; the work of a step on each particle is
 * divided among them. All functions are collective except the queries limit, dt, time, steps,
 * particles, definition, totals, report and reactions, and set_boundary_motion, whose values steps
 * compare. Rank 0 writes files.
 *
 * Fluid that fills a closed space, a box under a lid, has no free surface: its pressure is known up
 * to a constant, chosen such that the least of all particles is rho g l0/2. Steps whose walls or
 * bodies change the volume of that space, or leave less of it than there is fluid, return
 * MPS_ERROR_STATE.
 *
 * Resolution: at least 5 spacings of water and 3 of wave height, and 15 spacings across water that
 * strikes water or a wall. docs/limits.md says how large the errors are.
 *
 * Thread rule: one thread at a time per context; a step itself runs on the context's executor, and
 * its results are the same bit for bit for every number of threads and ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_H
#define LIBMPS_FLUID_H

#include "contact.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "particles.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_fluid mps_fluid;
/** The solver as one of all kinds (mps/solver.h), for the functions that all have; NULL for NULL.
 * It is the same object: `fluid` or this is destroyed, not both. */
MPS_API mps_solver *mps_fluid_solver(const mps_fluid *fluid);

typedef struct mps_fluid_def {
  uint32_t struct_size;
  int32_t iterations;  /* most iterations of the pressure solution, >= 1; default 2000 */
  double density;      /* rho, kg/m3, 1e-3 to 1e6; NaN (default): that of the field `density`, which
                          must be one value then; 1000 where the set has none */
  double viscosity;    /* Pa s, dynamic, 0 to 1e6; NaN (default): 0. Not read with a material */
  double gravity[3];   /* m/s2; [2] must be 0; default 0, -9.81, 0 */
  double level;        /* m, height (against gravity, from the origin) at which q = p: the level of
                          the water at rest. NaN (default): half a spacing above the highest
                          particle */
  double measure;      /* m, thickness of the slab, > 0; default 1 */
  double dt;           /* s, > 0: at most the limit at rest, .5 (l0/g)^1/2; NaN (default): each step
                          the largest by mps_fluid_limit, halved up to three times where a particle
                          goes more than l0/2 in it, with MPS_ERROR_DIVERGED below 1e-4 of that at rest
                          (without gravity: 1e-7 of a run) */
  double radius_ratio; /* re/l0, in [2.6, 4]; default 3.1. Not read with a kernel */
  double tolerance;    /* of the pressure solution, |residual|/|right side|, in [1e-14, 1e-2];
                          default 1e-5 */
  mps_domain *domain;  /* ranks that share the work; NULL (default): none. Kept alive */
  mps_kernel *kernel;  /* weight function, MPS_KERNEL_SMOOTH, its radius in [2.6, 4] spacings; NULL
                          (default): that of radius_ratio. Kept alive */
  mps_material *material; /* Newtonian: its viscosity is copied, its bulk modulus not read, as the
                             fluid is incompressible; NULL (default): the `viscosity`.
                             mps_fluid_get_def gives the viscosity, and NULL here */
} mps_fluid_def;

static inline mps_fluid_def mps_fluid_defaults(void) {
  mps_fluid_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_FLUID, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the 2D set `particles` (at least one; all of them are fluid), which it
 *  holds until it is destroyed. `def` NULL: the defaults. On an error nothing has changed.
 *  MPS_ERROR_ARGUMENT: a member of `def`, a position or a velocity out of range; MPS_ERROR_STATE:
 *  another solver holds the set; MPS_ERROR_UNSUPPORTED: a set that is not 2D; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_create(mps_context *context, mps_particles *particles,
                                                  const mps_fluid_def *def, mps_fluid **out);
/** Destroys and nulls; accepts NULL. Releases the set, bodies and signals. */
static inline void mps_fluid_destroy(mps_fluid **fluid) {
  mps_solver *solver = fluid ? mps_fluid_solver(*fluid) : NULL;
  mps_solver_destroy(&solver);
  if (fluid && !solver) *fluid = NULL;
}

/** The definition of the solver, with the computed level and the present dt. MPS_ERROR_ARGUMENT:
 *  NULL, or a `size` unknown to this library. */
static inline mps_status mps_fluid_get_def(const mps_fluid *fluid, mps_fluid_def *out) {
  return mps_solver_get_def(mps_fluid_solver(fluid), MPS_DEF_FLUID, out, sizeof *out);
}

/* ---- running --------------------------------------------------------------------------------- */

/** Takes `count` (>= 0) steps. A step that fails is undone: MPS_ERROR_NUMERIC, the pressure
 *  solution did not converge; MPS_ERROR_DIVERGED, a particle would pass a wall, its velocity
 *  exceeds 1e100 m/s, all have more kinetic energy than gravity, walls and loads have given, or
 *  one of connected fluid moves more than l0/2 besides the walls'
 *  displacement, a boundary or body moves more than 1.5 l0 in the step or a boundary bends to
 *  a slope of more than 1 (a warning is logged above l0/2 and a slope of .1, once), or the
 *  library's step would be too short (see dt); MPS_ERROR_STATE, walls change the volume of fluid
 *  without a free surface, or a body comes nearer than re to a polyline; MPS_ERROR_CANCELLED. */
MPS_NODISCARD static inline mps_status mps_fluid_step(mps_fluid *fluid, int64_t count) {
  return mps_solver_step(mps_fluid_solver(fluid), count);
}

/** Called at the start of a run, then every `every` steps and at the end. Any status but MPS_OK
 *  ends the run, which returns it. It may query the solver, not step or destroy it. */
typedef mps_status (*mps_fluid_fn)(void *user, mps_fluid *fluid);
/* A run's callback with its solver, as mps_solver_run calls it. */
typedef struct mps_fluid_call {
  mps_fluid *solver;
  mps_fluid_fn callback;
  void *user;
} mps_fluid_call;
static inline mps_status mps_fluid_call_back(void *user, mps_solver *solver) {
  const mps_fluid_call *call = (const mps_fluid_call *)user;
  (void)solver;
  return call->callback(call->user, call->solver);
}

/** Steps to t_end (s, not before the present time); the last 32 steps, or all of fewer, are equal
 *  and slightly shorter to end there. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range;
 *  otherwise errors as mps_fluid_step, or the status of `callback`. */
MPS_NODISCARD static inline mps_status mps_fluid_run(mps_fluid *fluid, double t_end, int64_t every,
                                                     mps_fluid_fn callback, void *user) {
  mps_fluid_call call = {fluid, callback, user};
  return mps_solver_run(mps_fluid_solver(fluid), t_end, every,
                        callback ? mps_fluid_call_back : NULL, &call);
}

/* Queries; 0 or NULL for NULL. */

/** Time (s). */
static inline double mps_fluid_time(const mps_fluid *fluid) {
  return mps_solver_time(mps_fluid_solver(fluid));
}
/** Number of steps taken. */
static inline int64_t mps_fluid_steps(const mps_fluid *fluid) {
  return mps_solver_steps(mps_fluid_solver(fluid));
}
/** Size (s) of the next step. */
static inline double mps_fluid_dt(const mps_fluid *fluid) {
  return mps_solver_dt(mps_fluid_solver(fluid));
}
/** Recommended largest step (s): min(.1 (l0/g)^1/2, .25 l0/|u|, .2 l0/|wall velocity|); without
 *  gravity g is the acceleration of BODY loads and `external_force`. A step calls a caller's
 *  function that a load follows, and takes its value too; this and mps_fluid_dt do not. */
static inline double mps_fluid_limit(const mps_fluid *fluid) {
  return mps_solver_limit(mps_fluid_solver(fluid));
}
/** Sets `dt` of the definition (s; NaN: each step by mps_fluid_limit). MPS_ERROR_ARGUMENT: out of
 *  range; MPS_ERROR_STATE: a step is open, or a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_fluid_set_dt(mps_fluid *fluid, double dt) {
  return mps_solver_set_dt(mps_fluid_solver(fluid), dt);
}

/** The set of the solver; lent. */
static inline mps_particles *mps_fluid_particles(const mps_fluid *fluid) {
  return mps_solver_particles(mps_fluid_solver(fluid));
}
/** The context of the solver; lent. */
static inline mps_context *mps_fluid_context(const mps_fluid *fluid) {
  return mps_solver_context(mps_fluid_solver(fluid));
}

/** Level of the surface (m, height against gravity from the origin) at `count` stations: `station`
 *  is the distance (m) from the origin along the horizontal (x where gravity is along -y). NaN
 *  where there is no surface. It follows from the fields `position` and `surface_rise`; in an open
 *  step these are of its beginning. MPS_ERROR_ARGUMENT: `count` below 0, or a station that is not
 *  finite. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_levels(const mps_fluid *fluid, int64_t count,
                                                      const double *station, double *level);

/** Sums over the fluid. `strain` is the potential energy in the field of gravity, above the level
 *  of the definition; `work_loads` that of loads and `external_force`, with the mean velocity of
 *  each step; `dissipated` (by the scheme and the viscosity) is the remainder of the budget. From
 *  creation on, except for particles that the caller edits, adds or removes,
 *
 *    change of linear = impulse_loads + impulses of the boundaries - of the bodies + impulse_scheme
 *
 *  to round-off, with mps_fluid_get_reaction and mps_contact_get_reaction. impulse_scheme is the
 *  momentum error of the scheme: pressures along walls are fits, which differ slightly from the sum
 *  of the gradients that move the particles; smoothing is symmetric in a pair where the flow is
 *  steep, and shifts, limited velocities and smoothing of gentle flow are not. docs/limits.md says
 *  how large it is. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
static inline mps_status mps_fluid_get_totals(const mps_fluid *fluid, mps_totals *out) {
  return mps_solver_get_totals(mps_fluid_solver(fluid), out);
}

/** Statistics of the steps; counts since creation. */
typedef struct mps_fluid_report {
  int64_t ghosts, pairs;  /* of the last step: wall images; neighbours, each from both sides */
  int64_t surface, apart; /* particles at the surface; isolated ones, in free fall */
  int64_t iterations;     /* of the last pressure solution */
  int64_t all_iterations; /* of all */
  int64_t collisions;     /* collisions of pairs closer than l0/2, and of particles with a wall */
  int64_t limited;        /* velocities limited to the range of the neighbours' */
  int64_t pushed;         /* particles moved back to a wall's inner side (within .1 l0) */
  int64_t bytes;          /* memory besides the fields */
} mps_fluid_report;
/** Statistics of the last step and of all steps. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to
 *  this library. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_report_sized(const mps_fluid *fluid,
                                                            mps_fluid_report *out, size_t size);
static inline mps_status mps_fluid_get_report(const mps_fluid *fluid, mps_fluid_report *out) {
  return mps_fluid_get_report_sized(fluid, out, sizeof *out);
}

/* ---- state ----------------------------------------------------------------------------------- */

/** Keeps the state of the solver and its set in memory, as mps_mpm_snapshot. MPS_ERROR_ARGUMENT: a
 *  snapshot of another solver; MPS_ERROR_STATE: a step is open or running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_fluid_snapshot(mps_fluid *fluid,
                                                          mps_snapshot **snapshot) {
  return mps_solver_snapshot(mps_fluid_solver(fluid), snapshot);
}
/** Restores a snapshot, bit for bit, as mps_mpm_rollback. Walls must be those of the snapshot
 *  (MPS_ERROR_STATE); dt, viscosity, loads and signals are not in it. MPS_ERROR_ARGUMENT: a
 *  snapshot of another solver. */
MPS_NODISCARD static inline mps_status mps_fluid_rollback(mps_fluid *fluid,
                                                          const mps_snapshot *snapshot) {
  return mps_solver_rollback(mps_fluid_solver(fluid), snapshot);
}
/** Writes the state to a file, as mps_mpm_save. MPS_ERROR_IO: the file cannot be written;
 *  MPS_ERROR_STATE: a step is open or running; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_NODISCARD static inline mps_status mps_fluid_save(mps_fluid *fluid, const char *path,
                                                      const mps_checkpoint *info) {
  return mps_solver_save(mps_fluid_solver(fluid), path, info);
}
/** Restores a file of mps_fluid_save, as mps_mpm_restore, into a fluid with the same particles,
 *  density, level and walls. MPS_ERROR_IO: cannot be read; MPS_ERROR_FORMAT: no checkpoint of a
 *  fluid; MPS_ERROR_ARGUMENT: of a fluid that was built in another way; MPS_ERROR_STATE: a step is
 *  open. */
MPS_NODISCARD static inline mps_status mps_fluid_restore(mps_fluid *fluid, const char *path,
                                                         mps_checkpoint *info) {
  return mps_solver_restore(mps_fluid_solver(fluid), path, info);
}

/* ---- boundaries ------------------------------------------------------------------------------ */

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
 *  as prescribed by mps_fluid_set_boundary_motion; then it may bend slightly: a displacement along
 * the normal at each of its nodes, linear between them, with local mirror images. The fluid's angle
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
  int64_t node_count;     /* default 0; at most 1 with a signal */
  const double *corners;  /* of a polyline: its corners in order, the fluid to the left of the way
                             along them (3 values each, m, z 0), copied; NULL (default): a plane
                             wall. `point`, `normal` and `factor` are not read then */
  int64_t corner_count;   /* 2 to 10000, default 0. The first again as the last: it is closed */
  double friction_factor; /* f, 0 to 1e6, default 0: the stress 1/2 rho f |v| v along the wall, v
                             the velocity of the particles beside it along it. Fanning's f, a
                             quarter of Darcy's; in waves Jonsson's. Not of OPEN */
} mps_fluid_boundary_def;

static inline mps_fluid_boundary_def mps_fluid_boundary_defaults(void) {
  mps_fluid_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_FLUID_BOUNDARY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a wall, between steps; `number` (may be NULL) receives the lowest free number.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range; a particle lies outside or closer than .3 l0
 *  to it; two walls that enclose less than 90 degrees, unless that corner lies more than re behind
 *  a third one; a polyline that crosses itself, joins a plane wall otherwise than above, or is
 *  nearer than re to a body; more than MPS_FLUID_MAX_BOUNDARIES.
 * MPS_ERROR_STATE: a step is open, or a callback of the solver is running. MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_fluid_add_boundary(mps_fluid *fluid, const mps_fluid_boundary_def *def, int32_t *number) {
  return mps_solver_add(mps_fluid_solver(fluid), MPS_DEF_FLUID_BOUNDARY, def, number);
}
/** Gives a wall another definition: its present position is `point`, its velocity is kept, and so
 *  are its impulse and work. MPS_ERROR_ARGUMENT: no wall `number`; otherwise errors as
 *  mps_fluid_add_boundary. On an error it is unchanged. */
MPS_NODISCARD static inline mps_status mps_fluid_set_boundary(mps_fluid *fluid, int32_t number,
                                                              const mps_fluid_boundary_def *def) {
  return mps_solver_set(mps_fluid_solver(fluid), MPS_DEF_FLUID_BOUNDARY, number, def);
}
/** Removes a wall: the fluid may flow out there. MPS_ERROR_ARGUMENT: no wall `number`;
 *  MPS_ERROR_STATE: a step is open, or a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_fluid_remove_boundary(mps_fluid *fluid, int32_t number) {
  return mps_solver_remove(mps_fluid_solver(fluid), MPS_DEF_FLUID_BOUNDARY, number);
}
/** The definition of boundary `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_fluid_get_boundary(const mps_fluid *fluid, int32_t number,
                                                mps_fluid_boundary_def *out) {
  return mps_solver_get(mps_fluid_solver(fluid), MPS_DEF_FLUID_BOUNDARY, number, out, sizeof *out);
}

/** Motion of a wall without a signal: `velocity` (m/s) at the end of the next step, or of the open
 *  one, and `displacement` (m) there from where the wall was added, both along the normal (into the
 *  fluid), one value a node (mps_fluid_boundary_def.nodes; else one). `displacement` NULL: the mean
 *  of the velocities before and after takes it there. It is used for one step; afterwards the wall
 *  continues at its velocity. The acceleration of the wall is the change of velocity over dt.
 *  MPS_ERROR_ARGUMENT: no wall `number`, one with a signal, or a value beyond 1e6 m/s or 1e12 m;
 *  MPS_ERROR_STATE: a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_boundary_motion(mps_fluid *fluid, int32_t number,
                                                               const double *displacement,
                                                               const double *velocity);

/** Force, impulse and work of a wall on the fluid. Force and moment are those of its pressures,
 *  summed over the points of mps_fluid_get_boundary_points, and, but in an open step, of its
 *  friction. Impulse, moment_impulse and work include collisions with the wall and the smoothing of
 *  velocities at it, which of a wall of no slip is the viscous drag along it. MPS_ERROR_ARGUMENT:
 * no wall `number`, NULL, or a `size` unknown to this library. */
static inline mps_status mps_fluid_get_reaction(const mps_fluid *fluid, int32_t number,
                                                mps_reaction *out) {
  return mps_solver_get_reaction(mps_fluid_solver(fluid), number, out);
}

/** Pressure along a wall after the last step (within an open step: of the last solution), at its
 *  wetted points every l0. Writes at most `capacity` points: `x` (3 values a point, m) and
 *  `pressure` (Pa), each may be NULL; `count` receives their number. Each point has the area l0
 *  times `measure`. MPS_ERROR_ARGUMENT: no wall `number`, or `capacity` below 0; MPS_ERROR_STATE:
 *  the open step's pressure has not been solved; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_boundary_points(const mps_fluid *fluid,
                                                               int32_t number, int64_t capacity,
                                                               int64_t *count, double *x,
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

/* ---- rigid bodies ---------------------------------------------------------------------------- */

typedef struct mps_fluid_contact_def {
  uint32_t struct_size;
  int32_t kind;  /* mps_boundary_kind of the body's surface: HELD (no slip, default) or ROLLER */
  int32_t mover; /* mps_contact_mover, default SOLVER: the fluid moves the body */
  int32_t reserved;
  double friction_factor; /* of all edges, as that of a boundary; default 0 */
} mps_fluid_contact_def;

static inline mps_fluid_contact_def mps_fluid_contact_defaults(void) {
  mps_fluid_contact_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_FLUID_CONTACT, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a rigid body to the fluid: a convex polygon (mps_body_create_box, _polygon) with edges of
 *  at least l0, standing on a boundary, through the surface or all in the water; all bodies
 *  together may have 50 000 edges. Bodies side by side make a face of several parts, with concave
 *  corners between them too. `def` NULL: the defaults. At the end of each step it receives the
 *  water's forces (mps_body_get_reaction), in addition to those of other solvers that it is in
 *  contact with. It is kept alive.
 *
 *  A free body with the mover SOLVER floats: in each step the water's pressure, the body's mass,
 *  gravity and load (mps_body_set_load), and the impulses of other solvers since its last step are
 *  in balance, however light it is. No boundary and no other body acts on it, and it goes through
 *  one with a warning in the log: keep it off the ground. A driven body with the mover SOLVER
 *  follows its signals, or the velocity of mps_body_set_motion. With OTHER the caller
 *  (mps_body_advance, mps_body_set_motion) or another solver moves the body: its pose and velocity
 *  when a step is made, or solved for in parts, are those of the end of that step. By the forces of
 *  the last step that is unstable where a free body is lighter than the water that it accelerates.
 *
 *  `out` (may be NULL) receives the handle (mps/contact.h): mps_contact_destroy removes the body
 *  from the water, in an open step at the end of that step; mps_contact_get_reaction gives the
 * water's action on it, by parts, in an open step of the last solution: moments about its reference
 * point, moment_impulse about its present position; `count` is that of wetted points. Force and
 * moment are those of the pressures and friction, impulses include collisions and smoothing, as
 * those of mps_body_get_reaction. All but the pressures act on a floating body one step later.
 * mps_contact_get_particles is MPS_ERROR_UNSUPPORTED.
 *
 *  MPS_ERROR_ARGUMENT: another shape; a particle inside or closer than .3 l0; less than 15 degrees
 *  of fluid between an edge and the boundary that it stands on (a body that rolls there later has a
 *  warning in the log, once); nearer than re to a polyline; too many edges. MPS_ERROR_STATE: the
 * fluid has the body already, or another solver moves it and `mover` is SOLVER. */
MPS_API MPS_NODISCARD mps_status mps_fluid_add_contact(mps_fluid *fluid, mps_body *body,
                                                       const mps_fluid_contact_def *def,
                                                       mps_contact **out);
/** Pressure (Pa) at `count` points of a body (3 values each, m), within 0.01 l0 of its present
 *  surface, as mps_fluid_get_pressure. MPS_ERROR_ARGUMENT: the contact is none of this fluid's,
 *  `count` below 0, or a point off the body; MPS_ERROR_STATE: the open step's pressure has not been
 *  solved; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_body_pressure(const mps_fluid *fluid,
                                                             const mps_contact *contact,
                                                             int64_t count, const double *x,
                                                             double *pressure);

/* ---- loads ----------------------------------------------------------------------------------- */

typedef enum mps_fluid_load_kind {
  MPS_FLUID_LOAD_BODY = 0,     /* `acceleration` on the particles chosen: a shaken tank, wind */
  MPS_FLUID_LOAD_PRESSURE = 1, /* `pressure` on the free surface that the chosen particles make: a
                                 squall, the air in a chamber; on no dry face of a wall or body. Not
                                with the classical scheme */
  MPS_FLUID_LOAD_DAMPING = 2   /* -`rate` u: a zone in which waves fade */
} mps_fluid_load_kind;

/** A load, times factor times signal in each component, on the particles of a list, those in a box
 *  at the beginning of each step (none at present is allowed), or all (mps/solver.h). Loads add up.
 *  Forces that another code computes go into the field `external_force` instead. */
typedef struct mps_fluid_load_def {
  uint32_t struct_size;
  int32_t kind;       /* mps_fluid_load_kind, default BODY */
  const int64_t *ids; /* copied; ids that are not in the set are ignored, one at least is in it */
  int64_t id_count;
  double lower[3], upper[3]; /* m, bounds included; NaN (default): no bound */
  double acceleration[3];    /* m/s2, |a| at most 1e6; [2] must be 0; default 0 */
  double pressure;           /* Pa, |p| at most 1e12, above the air's elsewhere; default 0. Where it
                                is negative the water below may have as much suction: let the box
                                reach three spacings into it */
  mps_signal *signal[3];     /* of PRESSURE [0]: a number in time (mps/signal.h), at the time
                                that a step begins with; NULL (default): 1. Kept alive */
  double factor[3];          /* finite; of PRESSURE and DAMPING [0]; default 1 */
  double rate;  /* 1/s, DAMPING: 0 to 1e6, where factor and signal are 1; more than 1/dt counts
                   as that; default 0. A zone in which waves of the period T fade is one wave length
                   long, with a rate that rises to 10/T (docs/waves.md) */
  int32_t rise; /* DAMPING: 1: the rate rises from 0 at lower[0] with the square of the distance to
                   `rate` at upper[0], -1: from 0 at upper[0]; both are finite then. 0 (default):
                   it is the same in all the box */
  int32_t all;  /* 1: all particles; default 0 */
} mps_fluid_load_def;

static inline mps_fluid_load_def mps_fluid_load_defaults(void) {
  mps_fluid_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_FLUID_LOAD, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load, between steps; `number` (may be NULL) receives the lowest free number, from 0.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range, or too many loads; MPS_ERROR_STATE: a step
 *  is open, or a callback of the solver is running; MPS_ERROR_UNSUPPORTED: a pressure with the
 *  classical scheme; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_fluid_add_load(mps_fluid *fluid, const mps_fluid_load_def *def, int32_t *number) {
  return mps_solver_add(mps_fluid_solver(fluid), MPS_DEF_FLUID_LOAD, def, number);
}
/** Gives load `number` another definition. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors
 *  as mps_fluid_add_load. */
MPS_NODISCARD static inline mps_status mps_fluid_set_load(mps_fluid *fluid, int32_t number,
                                                          const mps_fluid_load_def *def) {
  return mps_solver_set(mps_fluid_solver(fluid), MPS_DEF_FLUID_LOAD, number, def);
}
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: a step is
 *  open, or a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_fluid_remove_load(mps_fluid *fluid, int32_t number) {
  return mps_solver_remove(mps_fluid_solver(fluid), MPS_DEF_FLUID_LOAD, number);
}
/** The definition of load `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_fluid_get_load(const mps_fluid *fluid, int32_t number,
                                            mps_fluid_load_def *out) {
  return mps_solver_get(mps_fluid_solver(fluid), MPS_DEF_FLUID_LOAD, number, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
