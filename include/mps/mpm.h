/* mps/mpm.h - the WLS-MPM grid solver (Nakamura): large deformation of particles that move through
 * a grid of nodes, with frictional contact against rigid bodies. Plane strain, axisymmetry (x is
 * the radius, y the axis) or space.
 *
 * Shape functions come from a weighted least-squares fit of a linear function over the nodes that a
 * particle may use: those of the domain, and not those inside a body or behind it. Nodes exist only
 * in blocks of 8 x 8 (x 8) around particles, so memory grows with the particles: 32 bytes a node,
 * 64 near bodies and walls.
 *
 * The solver works in the fields of the particle set itself (zero copy), and sorts the set by
 * blocks whenever a particle has gone a cell beyond its block: views taken before are then stale
 * (their epoch).
 * It reads `density` (kg/m3, > 0) at creation, and `volume` (per unit thickness or per radian;
 * where 0, the spacing to the power of the dimension, in axisymmetry times the radius), `velocity`,
 * `velocity_gradient` and `stress` where the set has them; it writes these and `mass` and
 * `position`. A field `body_acceleration` (m/s2) that the set has at creation is read in each step
 * and adds to gravity. Laws that need them bring the fields `volume_ratio`, `deformation_gradient`
 * and their history.
 *
 * Thread rule: one thread at a time per context; a step itself runs on the context's executor, and
 * its results are the same bit for bit for every number of threads.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPM_H
#define LIBMPS_MPM_H

#include "body.h"
#include "io.h"
#include "material.h"
#include "particles.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_mpm mps_mpm;

typedef enum mps_geometry {
  MPS_PLANE_STRAIN = 0, /* forces and masses per unit thickness */
  MPS_AXISYMMETRIC = 1, /* x = r >= 0, y = z; forces and masses per radian */
  MPS_SPACE = 2         /* three dimensions */
} mps_geometry;

/** What weighs the particles' velocities on their way to the nodes. */
typedef enum mps_transfer {
  MPS_TRANSFER_SHAPE = 0, /* the shape functions: momentum is kept everywhere */
  MPS_TRANSFER_WEIGHT = 1 /* the weights, Nakamura (12), (39): near bodies and edges the momentum
                             drifts; for comparison */
} mps_transfer;

/** A wall acts on its nodes, and so on particles nearer than the spline reaches (1.5 or 2 cells).
 *  The velocities below are those relative to the wall, which mps_mpm_drive_wall may move. */
typedef enum mps_wall {
  MPS_WALL_ROLLER = 0,     /* no velocity across the wall */
  MPS_WALL_FIXED = 1,      /* no velocity at all */
  MPS_WALL_FRICTIONAL = 2, /* no velocity into the wall, and Coulomb's friction along it; it pushes
                              but never pulls, so that material may leave */
  MPS_WALL_ABSORBING = 3   /* dashpots (Lysmer): traction R - rho c_p v across and R - rho c_s v
                              along the wall, with rho, c_p and c_s of the particles in the cells at
                              the wall (elastic; under a user's law c_s = c_p/sqrt(3)). The constant
                              R carries the stress at rest: see settle below. Material that comes to
                              new nodes finds no R. Stable for every dt. Particles at the wall move
                              with the waves: one that passes the wall has left the domain */
} mps_wall;

/** How particles and nodes exchange what they hold: Nakamura Table 1. */
typedef enum mps_scheme {
  MPS_SCHEME_WLS = 0,     /* the paper's: fitted shape functions; particles carry L to the nodes */
  MPS_SCHEME_STANDARD = 1 /* the original material point method, for comparison: the B-splines and
                             their own derivatives are the shape functions, also at bodies and
                             walls, and particles carry no L. Nodes beyond a wall are held as those
                             on it. Slower: its loops are not tuned */
} mps_scheme;

/** What the laws take for the change of volume: a cure for volumetric locking and for pressures
 * that oscillate in nearly incompressible material. */
typedef enum mps_volumetric {
  MPS_VOLUMETRIC_POINT = 0, /* each particle's own tr(d), in axisymmetry with the hoop */
  MPS_VOLUMETRIC_CELL = 1   /* F-bar: the mean of tr(d), weighted by volumes, over the particles of
                               the cell (quadratic: of the cell-sized box about a node); the part of
                               d without trace, the spin and `velocity_gradient` stay. Volumes,
                               `volume_ratio` and `deformation_gradient` follow the mean */
} mps_volumetric;

typedef struct mps_mpm_def {
  uint32_t struct_size;
  int32_t geometry; /* mps_geometry, default PLANE_STRAIN; of as many dimensions as the set.
                       In 2D the third value of each array below is not read */
  int32_t spline;   /* degree of the B-spline weights: 3 (default, Nakamura (36)) or 2 */
  int32_t transfer; /* mps_transfer, default SHAPE */
  double cell;      /* h, m, > 0; no default. Usually 2 spacings */
  double origin[3]; /* m: a node lies here; default 0 */
  double lower[3], upper[3]; /* m: walls of the domain, on nodes; default: none (infinite). In
                                axisymmetry lower[0] is at least 0, and 0 by default */
  int32_t wall_lower[3], wall_upper[3]; /* mps_wall of each, default ROLLER; on the axis
                                           r = 0 ROLLER or FIXED */
  double gravity[3];                    /* m/s2, default 0 */
  double dt;      /* s, > 0, or 0 (default): each step the largest by Nakamura (49), (50), and by
                     rho h^2/(4 dim viscosity) of viscous laws. At most that
                     limit at creation; a warning tells when it gets above the fraction below */
  double courant; /* fraction of that limit, in (0, 1]; default 0.5 */
  int32_t volumetric; /* mps_volumetric, default POINT */
  int32_t scheme;     /* mps_scheme, default WLS */
  double flip; /* with STANDARD, in [0, 1]: the particle's velocity becomes flip (v_p + dt a) + (1 -
                  flip) v, with the nodes' acceleration a and velocity v at its place; it moves with
                  v. 1 (default): FLIP, Table 1; 0: PIC. WLS, which always takes v, allows only the
                  default */
  double wall_friction_lower[3], wall_friction_upper[3]; /* Coulomb's mu of frictional walls, >= 0,
                                                            default 0 */
  double settle; /* s, >= 0: so long an absorbing wall begins as a fixed one, and R is the mean of
                    the traction then. 0 (default): R balances the other forces at the wall's nodes
                    in the first step. A stress that balances gravity on paper does so on the grid
                    within a percent or so: without settling the wall yields to the rest, as a
                    dashpot does */
} mps_mpm_def;

MPS_API mps_status mps_mpm_def_init(mps_mpm_def *def, size_t size);
static inline mps_mpm_def mps_mpm_defaults(void) {
  mps_mpm_def def;
  memset(&def, 0, sizeof def);
  if (mps_mpm_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the set `particles` (at least one, inside the domain), sorting it and
 *  pinning it: until the solver is destroyed no particle can be added. All particles are of the one
 *  `material`, which is kept alive, until mps_mpm_set_material; its history columns become fields
 * of the set, by their names.
 */
MPS_API MPS_NODISCARD mps_status mps_mpm_create(mps_context *context, mps_particles *particles,
                                                mps_material *material, const mps_mpm_def *def,
                                                mps_mpm **out);
MPS_API void mps_mpm_destroy(mps_mpm **mpm);

#define MPS_MPM_MAX_MATERIALS 16

/** Gives the `count` (>= 0) particles of `ids` another law, before the first step or between steps;
 *  at most 16 different materials in a solver, that of creation with them. The material is kept
 *  alive. Its history begins anew in these particles, by the law's initial values; stress, volume,
 *  `volume_ratio` and `deformation_gradient` stay as they are (0: 1, and all 0: no deformation).
 *  Fields that only this law needs are added, so the set's number of fields grows; `material`
 *  tells each particle's law. The limit (49) follows at once; bodies without a penalty of their own
 *  press each particle by the modulus of its law. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_material(mps_mpm *mpm, mps_material *material,
                                                      int64_t count, const int64_t *ids);

#define MPS_MPM_MAX_BODIES 32

/** Lets the particles touch `body`, which the solver from now on moves and tells its reaction. The
 *  body's own clock goes on from where it is. At most 32; a body belongs to one solver, and may not
 *  overlap another one of it by more than 0.1 cells. The log hook is warned of walls thinner than
 *  two cells and, in the steps, of a contact stiffness k dt^2/m > 6, which chatters. Where bodies
 * touch the same nodes, friction is found in the order they were added, after all normal forces. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_body(mps_mpm *mpm, mps_body *body);

/* ---- walls and moving nodes ------------------------------------------------------------------
 * Nodes keep their place; what moves is their velocity. A signal gives them `factor` times its
 * velocity at the middle of the step; NULL holds them at rest. Signals are kept alive. Where
 * several hold one node, fixed walls come after the others, then boxes in the order of their
 * numbers: the last decides. `upper` is 0 or 1; a wall that the domain does not have is
 * MPS_ERROR_ARGUMENT. Forces are on the particles, N (2D: per unit thickness or per radian), means
 * over the last step; they, gravity and all other forces together change the particles' momentum.
 */

/** Makes the wall across `axis` one of kind `wall` (mps_wall) with `friction` (>= 0; 0 for other
 *  than frictional ones). An absorbing wall finds its R anew, from the next step on. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_wall(mps_mpm *mpm, int32_t axis, int32_t upper,
                                                  int32_t wall, double friction);
/** Moves the wall in `component`: of a roller the one across it, else any. An absorbing wall's
 *  dashpots stand on what moves: it sends a wave of half that velocity in. */
MPS_API MPS_NODISCARD mps_status mps_mpm_drive_wall(mps_mpm *mpm, int32_t axis, int32_t upper,
                                                    int32_t component, mps_signal *signal,
                                                    double factor);
/** Force[3] of a wall; 0 before the first step. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_wall_force(mps_mpm *mpm, int32_t axis, int32_t upper,
                                                        double *force);

#define MPS_MPM_MAX_BOXES 32

/** Prescribes velocity `component` of the nodes in the box [lower, upper] (m, dim values each,
 *  infinities allowed; at most 32 boxes). `box` receives its number, the lowest that is free. */
MPS_API MPS_NODISCARD mps_status mps_mpm_drive_nodes(mps_mpm *mpm, const double *lower,
                                                     const double *upper, int32_t component,
                                                     mps_signal *signal, double factor,
                                                     int32_t *box);
/** Lets the nodes of a box go. */
MPS_API MPS_NODISCARD mps_status mps_mpm_free_nodes(mps_mpm *mpm, int32_t box);
/** Force[3] of what moves the nodes of a box. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_nodes_force(mps_mpm *mpm, int32_t box, double *force);

/* ---- loads ----------------------------------------------------------------------------------- */

/** Dead load on `count` (>= 1) particles, by their ids: each gets the force area * traction, times
 *  the value (displacement) of `signal` at the beginning of the step, 1 where NULL. `area` (m2; 2D:
 *  per unit thickness or per radian; finite, copied) NULL: the spacing to the power dim - 1, in
 *  axisymmetry times the particle's present radius. `traction` (Pa, dim values, finite). `load`
 *  receives a number. The signal is kept alive. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_load(mps_mpm *mpm, int64_t count, const int64_t *ids,
                                                  const double *area, const double *traction,
                                                  mps_signal *signal, int32_t *load);
/** Gives a load another traction and signal. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t load,
                                                  const double *traction, mps_signal *signal);
/** Takes a load away; its number may be given to another one. */
MPS_API MPS_NODISCARD mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t load);

/* ---- running --------------------------------------------------------------------------------- */

/** Takes `count` (>= 0) steps. A particle that passes a wall by less than 0.1 cells is put back on
 * it. MPS_ERROR_DIVERGED: one has left the domain, or has a velocity or a volume that is not
 * finite; the record names step and particle, the fields show the state. */
MPS_API MPS_NODISCARD mps_status mps_mpm_step(mps_mpm *mpm, int64_t count);

/** Called at the start of a run, then every `every` steps and at the end. Return MPS_OK to go on.
 */
typedef mps_status (*mps_mpm_fn)(void *user, mps_mpm *mpm);

/** Steps to t_end (s), the last step shortened to end there; `callback` may be NULL, `every` >= 1.
 *  The context's progress hook is told about 100 times, the cancel hook asked after each step. */
MPS_API MPS_NODISCARD mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every,
                                             mps_mpm_fn callback, void *user);

MPS_API double mps_mpm_time(const mps_mpm *mpm); /* s */
MPS_API int64_t mps_mpm_steps(const mps_mpm *mpm);
/** The step (s) that would come next. */
MPS_API double mps_mpm_dt(const mps_mpm *mpm);
/** The limit (49), or that of viscosity, of the present state (s), the Courant fraction not
 * applied.
 */
MPS_API double mps_mpm_limit(const mps_mpm *mpm);

/** Sums over the particles (bodies not counted), in 2D per unit thickness or per radian. */
typedef struct mps_mpm_totals {
  double mass, volume;   /* kg, m3 */
  double linear[3];      /* kg m/s; in 2D [2] is 0 */
  double angular[3];     /* kg m2/s about the origin of space, with the spin that the particles'
                            velocity gradients carry: conserved with full supports. In 2D [2] */
  double kinetic;        /* J, of the particles' velocities */
  int64_t blocks, nodes; /* blocks of cells that hold particles; nodes that exist */
  int64_t bytes;         /* memory of the grid, the particles' fields not counted */
} mps_mpm_totals;
MPS_API MPS_NODISCARD mps_status mps_mpm_get_totals(mps_mpm *mpm, mps_mpm_totals *out);

/* ---- state ----------------------------------------------------------------------------------- */

/** Keeps the state of the solver, its set (fields, order) and its bodies in memory. *snapshot is
 * NULL at first and receives a new one, or one of this solver to be filled again, whose memory is
 * then reused. Needs as much memory as the fields. Between steps only, as in the callback of
 *  mps_mpm_run. On an error *snapshot is as before. MPS_ERROR_ARGUMENT: a snapshot of another
 *  solver; MPS_ERROR_STATE: a step has failed. */
MPS_API MPS_NODISCARD mps_status mps_mpm_snapshot(mps_mpm *mpm, mps_snapshot **snapshot);
/** Goes back to a snapshot, bit for bit; a step that failed is forgotten. Not in the snapshot, and
 *  so as they are now: gravity, dt, courant, constants of materials and bodies, signals, loads. On
 * an error nothing has changed. MPS_ERROR_ARGUMENT: of another solver; MPS_ERROR_STATE: bodies,
 *  boundaries, loads or materials are not those of the snapshot, the message says which. */
MPS_API MPS_NODISCARD mps_status mps_mpm_rollback(mps_mpm *mpm, const mps_snapshot *snapshot);

/** Writes a checkpoint of the solver's set (see mps_checkpoint_write, also for errors) with all
 *  that the solver needs to go on: time, steps, order and blocks of the particles, forces of the
 *  walls; of its bodies motion, load, reactions and impulses. Of `info` (NULL: the defaults) only
 *  user_key and the user_data are read. The run is not touched: it goes on as if it had not been
 *  saved. Between steps only, such as in the callback of mps_mpm_run. MPS_ERROR_STATE: a step has
 *  failed. */
MPS_API MPS_NODISCARD mps_status mps_mpm_save(mps_mpm *mpm, const char *path,
                                              const mps_checkpoint *info);

/** Puts the state of mps_mpm_save into a solver that was built in the same way. What must agree:
 *  the particles, spacing, geometry, scheme, spline, cell, origin, places and kinds of walls and
 *  boxes, number of loads, whether there are body accelerations, names and order of materials, and
 *  the shapes, motions and numbers of parts of the bodies in their order. Where the solver is now
 *  does not matter; a step that failed is forgotten. From there it goes on bit for bit as the run
 *  that never stopped, for every number of threads. All else is the caller's to set up
 *  again, and may be other than it was: constants of materials, gravity, dt, courant, signals,
 *  loads on particles, friction, masses of bodies.
 *
 *  The set takes the order of the file: views taken before are stale. On an error nothing has
 *  changed. `info` (NULL: not wanted) is as for mps_checkpoint_info. Statuses are
 *  those of mps_checkpoint_read; MPS_ERROR_FORMAT: written without a solver; MPS_ERROR_ARGUMENT: by
 *  a solver that was built in another way, the message says in what; MPS_ERROR_STATE: another
 *  solver uses the set. */
MPS_API MPS_NODISCARD mps_status mps_mpm_restore(mps_mpm *mpm, const char *path,
                                                 mps_checkpoint *info);

MPS_EXTERN_C_END
#endif
