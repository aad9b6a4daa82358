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
 * The solver works in the fields of the set (zero copy) and sorts it now and then: views taken
 * before are then stale (their epoch). It reads `velocity` at creation where the set has it,
 * `external_force` (N) at every step if the set has it by then, and writes `position`, `velocity`,
 * `pressure`, `reduced_pressure`, `reduced_pressure_old`, `free_surface` and `surface_rise`.
 *
 * Between steps particles may be edited, added (at rest, at least .3 l0 inside of all walls) and
 * removed (not the last one), and pass open sides; the energy that they add or remove is no work.
 *
 * Ranks (mps/domain.h; docs/cluster.md) each make the same whole fluid, with the same boundaries,
 * bodies, loads and edits, and keep all of it; the work of a step on each particle is divided among
 * them. All functions are collective except the queries limit, dt, time, steps, particles,
 * definition, totals, report and reactions, and set_wall_motion, whose values steps compare. Rank 0
 * writes files.
 *
 * Fluid that fills a closed space, a box under a lid, has no free surface: its pressure is known up
 * to a constant, chosen such that the least of all particles is rho g l0/2. Steps whose walls or
 * bodies change the volume of that space, or leave less of it than there is fluid, return
 * MPS_ERROR_STATE.
 *
 * Resolution: at least 5 spacings of water and 3 of wave height. Water that strikes water or a wall
 * keeps its energy to 3 % of pressure-impulse theory with 15 spacings or more across the striking
 * water, with 10 spacings to 6 %.
 *
 * Thread rule: one thread at a time per context; a step itself runs on the context's executor, and
 * its results are the same bit for bit for every number of threads and ranks.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_FLUID_H
#define LIBMPS_FLUID_H

#include "contact.h"
#include "domain.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "particles.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_fluid mps_fluid;

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
                          the largest by mps_fluid_limit, with MPS_ERROR_DIVERGED below 1e-4 of that at rest
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

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_fluid_def_init(mps_fluid_def *def, size_t size);
static inline mps_fluid_def mps_fluid_defaults(void) {
  mps_fluid_def def;
  memset(&def, 0, sizeof def);
  if (mps_fluid_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the 2D set `particles` (at least one; all of them are fluid), which it
 *  holds until it is destroyed. `def` NULL: the defaults. On an error nothing has changed.
 *  MPS_ERROR_ARGUMENT: a member of `def`, a position or a velocity out of range; MPS_ERROR_STATE:
 *  another solver holds the set; MPS_ERROR_UNSUPPORTED: a set that is not 2D; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_fluid_create(mps_context *context, mps_particles *particles,
                                                  const mps_fluid_def *def, mps_fluid **out);
/** Destroys and nulls; accepts NULL. Releases the set, bodies and signals. */
MPS_API void mps_fluid_destroy(mps_fluid **fluid);

/** The definition of the solver, with the computed level and the present dt. MPS_ERROR_ARGUMENT:
 *  NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_def_sized(const mps_fluid *fluid, mps_fluid_def *out,
                                                         size_t size);
static inline mps_status mps_fluid_get_def(const mps_fluid *fluid, mps_fluid_def *out) {
  return mps_fluid_get_def_sized(fluid, out, sizeof *out);
}

/** Sets the viscosity, from the next step on, to that of a Newtonian `material`, as the member of
 *  the definition does. All particles have the same: `ids` NULL with `count` 0, or a list of all.
 *  The density stays that of creation. MPS_ERROR_UNSUPPORTED: another law, or a list of some of the
 *  particles; MPS_ERROR_ARGUMENT: no material, a viscosity beyond 1e6 Pa s, an id that the set
 *  lacks; MPS_ERROR_STATE: not between steps. On an error nothing has changed.
 */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_material(mps_fluid *fluid,
                                                        const mps_material *material, int64_t count,
                                                        const int64_t *ids);

/* ---- running --------------------------------------------------------------------------------- */

/** Takes `count` (>= 0) steps. A step that fails is undone: MPS_ERROR_NUMERIC, the pressure
 *  solution did not converge; MPS_ERROR_DIVERGED, a particle would pass a wall or its velocity
 *  exceeds 1e100 m/s, a boundary or body moves more than 1.5 l0 in the step or a boundary bends to
 *  a slope of more than 1 (a warning is logged above l0/2 and a slope of .1, once), or the
 *  library's step would be too short (see dt); MPS_ERROR_STATE, walls change the volume of fluid
 *  without a free surface, or a body comes nearer than re to a polyline; MPS_ERROR_CANCELLED. */
MPS_API MPS_NODISCARD mps_status mps_fluid_step(mps_fluid *fluid, int64_t count);

/* A step in parts, for two-way coupling of the water and another system:
 *
 *   mps_fluid_begin_step(fluid, dt);                  neighbour lists, matrix of the pressure
 *                                                     equation and its preconditioner, which stay
 *   do {
 *     mps_fluid_set_wall_motion(fluid, wall, s, v);   at the end of the step: a guess
 *     mps_fluid_solve_pressure(fluid);                only the right side changes
 *     mps_fluid_get_reaction(fluid, wall, &reaction); forces and pressures at mid step
 *   } while (v does not agree with these forces);
 *   mps_fluid_end_step(fluid);                        velocities and positions
 *
 * The pressure acts throughout the step: it is to be used as that at its middle. With one solution
 * a step in parts is mps_fluid_step bit for bit. In between, the set's fields and the time are
 * those before the step, and only mps_fluid_set_wall_motion and queries may be called: other
 * functions return MPS_ERROR_STATE, as do the parts in another order. */

/** Begins a step of `dt` (s; NaN: mps_fluid_dt). After an error no step is open.
 *  MPS_ERROR_ARGUMENT: `dt` out of range; MPS_ERROR_STATE: a step is open, a field is being edited,
 *  or the classical scheme; MPS_ERROR_DIVERGED, MPS_ERROR_NUMERIC, MPS_ERROR_CANCELLED and
 *  MPS_ERROR_MEMORY as mps_fluid_step. */
MPS_API MPS_NODISCARD mps_status mps_fluid_begin_step(mps_fluid *fluid, double dt);
/** Solves for the pressure with the walls' present motions; MPS_ERROR_NUMERIC: it did not converge;
 *  the step stays open. MPS_ERROR_STATE: no step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_solve_pressure(mps_fluid *fluid);
/** Ends the step with the last solution. A motion set since the last solution has to be solved for
 *  first (MPS_ERROR_STATE). After MPS_ERROR_DIVERGED or MPS_ERROR_MEMORY the step is undone and no
 *  step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_end_step(mps_fluid *fluid);
/** Discards the open step: the state is that before it. MPS_ERROR_STATE: no step is open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_abandon_step(mps_fluid *fluid);

/** Called at the start of a run, then every `every` steps and at the end. Any status but MPS_OK
 *  ends the run, which returns it. It may query the solver, not step or destroy it. */
typedef mps_status (*mps_fluid_fn)(void *user, mps_fluid *fluid);

/** Steps to t_end (s, not before the present time); the last 32 steps, or all of fewer, are equal
 *  and slightly shorter to end there. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range;
 *  otherwise errors as mps_fluid_step, or the status of `callback`. */
MPS_API MPS_NODISCARD mps_status mps_fluid_run(mps_fluid *fluid, double t_end, int64_t every,
                                               mps_fluid_fn callback, void *user);

/* Queries; 0 or NULL for NULL. */

/** Time (s). */
MPS_API double mps_fluid_time(const mps_fluid *fluid);
/** Number of steps taken. */
MPS_API int64_t mps_fluid_steps(const mps_fluid *fluid);
/** Size (s) of the next step. */
MPS_API double mps_fluid_dt(const mps_fluid *fluid);
/** Recommended largest step (s): min(.1 (l0/g)^1/2, .25 l0/|u|, .2 l0/|wall velocity|). */
MPS_API double mps_fluid_limit(const mps_fluid *fluid);
/** Sets `dt` of the definition (s; NaN: each step by mps_fluid_limit). MPS_ERROR_ARGUMENT: out of
 *  range; MPS_ERROR_STATE: a step is open, or a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_fluid_set_dt(mps_fluid *fluid, double dt);

/** The set of the solver; lent. */
MPS_API mps_particles *mps_fluid_particles(const mps_fluid *fluid);
/** The context of the solver; lent. */
MPS_API mps_context *mps_fluid_context(const mps_fluid *fluid);

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
 *  steep, and shifts, limited velocities and smoothing of gentle flow are not. It is some
 *  hundredths of the terms (5 % in a dam break with 15 particles over the height of the column, 1.5
 *  % with 30). MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_fluid_get_totals_sized(const mps_fluid *fluid, mps_totals *out,
                                                            size_t size);
static inline mps_status mps_fluid_get_totals(const mps_fluid *fluid, mps_totals *out) {
  return mps_fluid_get_totals_sized(fluid, out, sizeof *out);
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
MPS_API MPS_NODISCARD mps_status mps_fluid_snapshot(mps_fluid *fluid, mps_snapshot **snapshot);
/** Restores a snapshot, bit for bit, as mps_mpm_rollback. Walls must be those of the snapshot
 *  (MPS_ERROR_STATE); dt, viscosity, loads and signals are not in it. MPS_ERROR_ARGUMENT: a
 *  snapshot of another solver. */
MPS_API MPS_NODISCARD mps_status mps_fluid_rollback(mps_fluid *fluid, const mps_snapshot *snapshot);
/** Writes the state to a file, as mps_mpm_save. MPS_ERROR_IO: the file cannot be written;
 *  MPS_ERROR_STATE: a step is open or running; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_API MPS_NODISCARD mps_status mps_fluid_save(mps_fluid *fluid, const char *path,
                                                const mps_checkpoint *info);
/** Restores a file of mps_fluid_save, as mps_mpm_restore, into a fluid with the same particles,
 *  density, level and walls. MPS_ERROR_IO: cannot be read; MPS_ERROR_FORMAT: no checkpoint of a
 *  fluid; MPS_ERROR_ARGUMENT: of a fluid that was built in another way; MPS_ERROR_STATE: a step is
 *  open. */
MPS_API MPS_NODISCARD mps_status mps_fluid_restore(mps_fluid *fluid, const char *path,
                                                   mps_checkpoint *info);

MPS_EXTERN_C_END

#include "fluid_boundary.h"
#include "fluid_contact.h"
#include "fluid_load.h"

#endif
