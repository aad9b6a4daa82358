/* mps/solver.h - types that all solvers share: degrees of freedom, boundary kinds, reactions,
 * totals, snapshots; and what all solvers do.
 *
 * Every solver mps_S (mpm, dynamics, elastic, fluid) is a mps_solver, which mps_S_solver gives, and
 * the functions mps_solver_... below work on all of them: a program that steps, saves and restores
 * need not know which one it has. mps_S_step(s, count) and its like are the same functions under a
 * name of the solver, and its own header says what is particular to it. Besides, each has
 *
 *   mps_S_create           the set, and what else it is given, are kept alive; a definition NULL is
 *                          the defaults where there is one for all; on an error nothing has changed
 *   mps_S_get_def          the definition as the solver has completed it
 *   mps_S_set_material     (solver, material, count, ids): what particles are made of, NULL with
 *                          count 0 all of them; a law that the solver does not have is
 *                          MPS_ERROR_UNSUPPORTED. Densities are the field `density`
 *   mps_S_add_boundary, mps_S_add_load   copies lists, keeps signals alive, gives a number (into
 *                          `number`, which may be NULL)
 *   selections             a definition that acts on particles, nodes or facets has one of: `ids`
 *                          with `id_count`; a box, `lower` and `upper`, bounds included, NaN for no
 *                          bound; `all` = 1. None, two, or a choice that holds nothing is
 *                          MPS_ERROR_ARGUMENT
 *   mps_S_set_boundary, mps_S_set_load   by that number; MPS_ERROR_ARGUMENT where there is none
 *   mps_S_get_boundary, mps_S_get_load   the definition of that number, with what it selects
 *   mps_S_add_contact      with a rigid body, a handle (mps/contact.h): WLS-MPM and the fluid.
 *                          Explicit dynamics and implicit elasticity have no contact: a body
 *                          drives their particles as a boundary of the kind DRIVEN
 *   mps_S_get_report       figures of its own method, so each has its own struct
 *
 * A field `external_force` (N) of the set acts in each step. Thread rule of all: one thread at a
 * time per context.
 *
 * While a function of a solver runs, its callbacks (of a run, signals, laws, hooks of the context)
 * may only read the solver and its set: functions that step, change, roll back or destroy the
 * solver, or edit, fill or empty the set, return MPS_ERROR_STATE. Snapshots and files may be made
 * in the callback of a run, which is called between two steps, and not within a step. A program
 * that changes fields after each step calls mps_S_step in a loop of its own.
 *
 * Vectors have three components in 2D too; out-of-plane components are then 0. All forces that a 2D
 * solver takes and reports are those of its `measure`: the thickness (m, default 1) in the plane,
 * the sector angle (rad, default 2 pi: the whole ring) in axisymmetry. They are in N, as are those
 * on rigid bodies (mps/body.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_SOLVER_H
#define LIBMPS_SOLVER_H

#include "io.h"

MPS_EXTERN_C_BEGIN

/** Ranks that compute one model (mps/experimental/domain.h). */
typedef struct mps_domain mps_domain;

/** Degrees of freedom of a particle or node, or-ed. */
#define MPS_DOF_X 1u
#define MPS_DOF_Y 2u
#define MPS_DOF_Z 4u
#define MPS_DOF_ROTATION 8u /* about z, where particles have a rotation of their own */

/** Kind of a boundary, with the same values in all solvers. Each solver has the kinds that its
 *  header lists, and returns MPS_ERROR_ARGUMENT, naming the kind, for others. */
typedef enum mps_boundary_kind {
  MPS_BOUNDARY_HELD = 0,   /* at rest: the components `dofs`, where the solver has them (0: all that
                              exist); takes no signal. In a fluid: no flow across, and none along */
  MPS_BOUNDARY_DRIVEN = 1, /* the same, with a motion given by signals or values */
  MPS_BOUNDARY_ROLLER = 2, /* no motion across, free along. In a fluid: slip */
  MPS_BOUNDARY_FRICTIONAL = 3, /* no motion into it, Coulomb's friction along it */
  MPS_BOUNDARY_ABSORBING = 4,  /* Lysmer dashpots: waves leave */
  MPS_BOUNDARY_FREE_FIELD = 5, /* a column of soil beside the model, which moves as level ground
                                  without end: WLS-MPM; explicit dynamics has
                                  mps_dynamics_add_free_field */
  MPS_BOUNDARY_FREE = 6,       /* an edge of the domain without constraint */
  MPS_BOUNDARY_OPEN = 7        /* the same, and particles that pass it are removed from the set */
} mps_boundary_kind;
/** "MPS_BOUNDARY_HELD" and so on; NULL for a number that is no kind. */
static inline const char *mps_boundary_kind_name(int32_t kind) {
  return mps_enumerator_name("mps_boundary_kind", kind);
}

/** Force, impulse and work of a boundary, contact or body. Of a boundary: on its particles. Of a
 *  contact or a body: on the body, by the particles. Forces and moments are means over the last
 *  step; before the first step all is 0. */
typedef struct mps_reaction {
  double force[3];          /* N */
  double moment[3];         /* N m, about the origin; of a body, about its reference point */
  double impulse[3];        /* N s, since the boundary, contact or body was made */
  double moment_impulse[3]; /* N m s, likewise; of a body about its reference point as it moved */
  int64_t count;            /* particles (or nodes) constrained or in contact in the last step */
  double work; /* J, since it was made: done on the particles by this boundary, contact or body */
  int64_t removed; /* particles removed from the set since creation: by an open side, or inside a
                      body that removes them */
  double removed_mass; /* kg, of these */
} mps_reaction;

/** Sums over the particles of a solver. Bodies are not counted: their energy is in mps_body_totals.
 *  Energies are changes of state or work since the solver was made, so that
 *
 *    kinetic + strain + dissipated - work_loads - work_boundaries - work_bodies
 *
 *  keeps its initial value, to the error that the solver's header states. */
typedef struct mps_totals {
  double mass, volume; /* kg, m3 */
  double linear[3];    /* kg m/s; around an axis of symmetry [0] is the sum of m v_r, which hoop
                          stress changes without any force from outside */
  double angular[3];   /* kg m2/s, about the origin, with the particles' own spin */
  double kinetic;      /* J, of the present state, with the particles' own spin */
  double strain;       /* J, recoverable. Explicit and implicit elasticity: of the present state;
                          WLS-MPM: work of the stresses that the laws keep, since creation */
  double dissipated;   /* J, since creation: plasticity, viscosity, damping, friction, and numerical
                          dissipation (`scheme`) */
  double scheme; /* J, since creation: numerical part of `dissipated`, by the time integration, the
                    transfers and equations solved to a tolerance; negative where they add energy */
  double work_loads;        /* J, since creation: gravity, tractions, forces on particles */
  double work_boundaries;   /* J, since creation */
  double work_bodies;       /* J, since creation: by the bodies in contact */
  double impulse_loads[3];  /* N s, since creation; of the fluid, else 0: of gravity, loads and
                               forces on particles */
  double impulse_scheme[3]; /* N s, since creation; of the fluid, else 0: momentum error, gained by
                               the particles with no matching reaction on a boundary or body */
} mps_totals;

/** The state of a solver, in memory: filled by mps_solver_snapshot, restored bit for bit
 *  by mps_solver_rollback, so that a step can be repeated with other loads (implicit coupling). The
 * fields of the set are part of it, `external_force` too; definitions of boundaries and loads,
 * signals and materials are not: they keep their present state. It belongs to the solver that
 * filled it; filling it again reuses its memory. */
typedef struct mps_snapshot mps_snapshot;
/** Frees and nulls; accepts NULL. A snapshot may outlive its solver, and has no use then. */
MPS_API void mps_snapshot_destroy(mps_snapshot **snapshot);

/* ---- all solvers ----------------------------------------------------------------------------- */

/** A solver of any kind, as mps_mpm_solver, mps_dynamics_solver, mps_elastic_solver and
 *  mps_fluid_solver give it: the same object, lent. Functions with a status return
 *  MPS_ERROR_ARGUMENT for NULL, the others 0 or NULL. Records of errors name the function of the
 *  solver's own kind ("mps_fluid_step"). */
typedef struct mps_solver mps_solver;

/** Destroys and nulls; accepts NULL. Releases the set, bodies, materials and signals. In a callback
 *  of the solver it only records MPS_ERROR_STATE. */
MPS_API void mps_solver_destroy(mps_solver **solver);
/** The set. Lent: it lives at least as long as the solver. */
MPS_API mps_particles *mps_solver_particles(const mps_solver *solver);
/** The context, lent likewise. */
MPS_API mps_context *mps_solver_context(const mps_solver *solver);

/** Takes `count` (>= 0) steps of mps_solver_dt, and asks the cancel hook before each
 *  (MPS_ERROR_CANCELLED; explicit dynamics: before each 0.1 s of work, about). An error keeps the
 *  steps before it. Implicit elasticity steps after mps_elastic_start alone (MPS_ERROR_STATE). */
MPS_API MPS_NODISCARD mps_status mps_solver_step(mps_solver *solver, int64_t count);
/** Called at the start of a run, then every `every` steps and at the end. A status other than
 *  MPS_OK ends the run, which returns it. */
typedef mps_status (*mps_solver_fn)(void *user, mps_solver *solver);
/** Steps to exactly t_end (s, not before the present time): WLS-MPM and the fluid with steps of
 *  mps_solver_dt and shorter ones at the end, explicit dynamics and implicit elasticity with equal
 *  ones of at most that. `callback` may be NULL, `every` >= 1. The progress hook is called about
 * 100 times with the time since the start of the run, the cancel hook between steps.
 *  MPS_ERROR_ARGUMENT: `t_end` or `every` out of range; otherwise errors as mps_solver_step, or the
 *  status of `callback`. */
MPS_API MPS_NODISCARD mps_status mps_solver_run(mps_solver *solver, double t_end, int64_t every,
                                                mps_solver_fn callback, void *user);

/** Time (s); of implicit elasticity since mps_elastic_start. */
MPS_API double mps_solver_time(const mps_solver *solver);
/** Number of steps taken, likewise. */
MPS_API int64_t mps_solver_steps(const mps_solver *solver);
/** Size (s) of the next step: what the definition or mps_solver_set_dt gives, else what the solver
 *  chooses by its limit; 0 where none can be chosen: an error is recorded then. */
MPS_API double mps_solver_dt(mps_solver *solver);
/** The largest stable step of the present state (s), as the solver's header says; INFINITY where
 *  there is none. */
MPS_API double mps_solver_limit(const mps_solver *solver);
/** Sets the size of steps (s, > 0; WLS-MPM and the fluid: at most the limit, and NaN: it follows
 *  that). MPS_ERROR_ARGUMENT: out of range; MPS_ERROR_STATE: implicit elasticity without a motion.
 */
MPS_API MPS_NODISCARD mps_status mps_solver_set_dt(mps_solver *solver, double dt);

/** The definition that the solver uses, of `kind` MPS_DEF_MPM, MPS_DEF_DYNAMICS, MPS_DEF_ELASTIC or
 *  MPS_DEF_FLUID, to `out` of `size` bytes; objects in it are lent. MPS_ERROR_ARGUMENT: NULL, the
 *  kind of another solver, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_solver_get_def(const mps_solver *solver, int32_t kind,
                                                    void *out, size_t size);
/** Sums over the particles. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_solver_get_totals_sized(const mps_solver *solver,
                                                             mps_totals *out, size_t size);
static inline mps_status mps_solver_get_totals(const mps_solver *solver, mps_totals *out) {
  return mps_solver_get_totals_sized(solver, out, sizeof *out);
}
/** What boundary `number` exerts. MPS_ERROR_ARGUMENT: none of this number, NULL, or a `size`
 * unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_solver_get_reaction_sized(const mps_solver *solver,
                                                               int32_t number, mps_reaction *out,
                                                               size_t size);
static inline mps_status mps_solver_get_reaction(const mps_solver *solver, int32_t number,
                                                 mps_reaction *out) {
  return mps_solver_get_reaction_sized(solver, number, out, sizeof *out);
}

/* ---- numbered conditions: boundaries and loads ----------------------------------------------- */

/** Adds a condition: `def` is the struct of `kind`, MPS_DEF_MPM_BOUNDARY for a
 * mps_mpm_boundary_def. `number` (may be NULL) receives the lowest free number.
 * mps_mpm_add_boundary and its like, which say what a definition does, are this function.
 * MPS_ERROR_ARGUMENT: NULL, a kind that the solver does not have, a member of `def` out of range;
 * MPS_ERROR_STATE: a callback of the solver is running; MPS_ERROR_MEMORY. On an error nothing has
 * changed. */
MPS_API MPS_NODISCARD mps_status mps_solver_add(mps_solver *solver, int32_t kind, const void *def,
                                                int32_t *number);
/** Gives condition `number` another definition; its impulse and work are kept. Errors as
 *  mps_solver_add; MPS_ERROR_ARGUMENT: there is none of this number. */
MPS_API MPS_NODISCARD mps_status mps_solver_set(mps_solver *solver, int32_t kind, int32_t number,
                                                const void *def);
/** Removes condition `number`, which may be given again. MPS_ERROR_ARGUMENT: there is none. */
MPS_API MPS_NODISCARD mps_status mps_solver_remove(mps_solver *solver, int32_t kind,
                                                   int32_t number);
/** Definition of condition `number`, to `out` of `size` bytes, of the struct of `kind`: as it was
 *  given, except that particles or facets which the solver found by a box or `all` when it was
 * given are listed in `ids` (where ranks share a set: of each rank its own). Lists and signals are
 * lent: they live until the condition is set or removed. Not collective. MPS_ERROR_ARGUMENT: NULL,
 * a kind that the solver does not have, no condition of this number, a `size` unknown to this
 * library. */
MPS_API MPS_NODISCARD mps_status mps_solver_get(const mps_solver *solver, int32_t kind,
                                                int32_t number, void *out, size_t size);
/** Numbers of the conditions of a kind, ascending: `count` receives how many there are; at most
 *  `capacity` (>= 0) are written to `numbers` (may be NULL). MPS_ERROR_ARGUMENT: a kind that the
 *  solver does not have, `count` NULL, `capacity` below 0. */
MPS_API MPS_NODISCARD mps_status mps_solver_get_numbers(const mps_solver *solver, int32_t kind,
                                                        int64_t capacity, int64_t *count,
                                                        int32_t *numbers);

/** Removes boundary or load `number`, as mps_solver_remove. */
MPS_NODISCARD static inline mps_status mps_solver_remove_boundary(mps_solver *solver,
                                                                  int32_t number) {
  return mps_solver_remove(solver, MPS_DEF_BOUNDARY, number);
}
MPS_NODISCARD static inline mps_status mps_solver_remove_load(mps_solver *solver, int32_t number) {
  return mps_solver_remove(solver, MPS_DEF_LOAD, number);
}

/* ---- the state ------------------------------------------------------------------------------- */

/** Keeps the state in memory. *snapshot NULL: made; else one of this solver, which is filled again.
 *  Between steps only, as in the callback of a run. On an error *snapshot is as before.
 *  MPS_ERROR_ARGUMENT: a snapshot of another solver; MPS_ERROR_STATE: a step is open, running, or
 *  has failed; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_solver_snapshot(mps_solver *solver, mps_snapshot **snapshot);
/** Restores a snapshot, bit for bit. On an error nothing has changed. MPS_ERROR_ARGUMENT: NULL, or
 * of another solver; MPS_ERROR_STATE: the solver has changed in what a snapshot does not hold. */
MPS_API MPS_NODISCARD mps_status mps_solver_rollback(mps_solver *solver,
                                                     const mps_snapshot *snapshot);
/** Writes a checkpoint of solver and set: every field, and what the solver needs to continue. Of
 * `info` (NULL: the defaults) only user_key and user_data are read. The file appears whole or not
 * at all: it is written as "<path>.part", confirmed by the disk and then renamed, so that a crash
 * or a full disk never costs the former checkpoint. `path` is a new name, or that of an empty file
 * or of an earlier checkpoint: a directory, a device or any other file is refused and stays.
 * MPS_ERROR_IO: the file cannot be written; MPS_ERROR_STATE: as
 * mps_solver_snapshot; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_API MPS_NODISCARD mps_status mps_solver_save(mps_solver *solver, const char *path,
                                                 const mps_checkpoint *info);
/** Restores a file of mps_solver_save in a solver that was built in the same way; the run continues
 *  bit for bit. `info` (may be NULL) is as for mps_checkpoint_info. On an error nothing has
 * changed. MPS_ERROR_IO, MPS_ERROR_FORMAT: no checkpoint of such a solver; MPS_ERROR_ARGUMENT: of
 * one that was built in another way. */
MPS_API MPS_NODISCARD mps_status mps_solver_restore(mps_solver *solver, const char *path,
                                                    mps_checkpoint *info);

MPS_EXTERN_C_END
#endif
