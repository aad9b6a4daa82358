/* mps/dynamics.h - explicit MPS elastodynamics (Yoshida): earthquake response of an elastic body of
 * particles in plane strain, with Verlet, leapfrog and Euler time integration, Rayleigh damping,
 * held, driven, viscous and free-field boundaries, and the stability limit of the time step.
 * docs/dynamics.md is a guide.
 *
 * Three unknowns a particle: two displacements (m) and a rotation (rad); every force, mass and
 * energy is that of the thickness `measure`. Neighbours and the weight function come from the
 * reference positions, at creation those without the displacement, and never change. Restoring
 * forces follow from displacement differences, so that small strains keep all their digits.
 *
 * The solver works in the fields of the set itself and sorts it once, at creation. It reads
 * `density` (kg/m3, 1e-6 to 1e9), `shear_velocity` Vs (m/s, 1e-6 to 1e9), `pressure_velocity` Vp
 * (m/s, Vp >= sqrt(2) Vs so that lambda >= 0) and, if present, `damping` (h, of critical: 0.02 is 2
 * %; 0 to 1000) at creation and when they have been edited (mps_particles_edit) between two steps;
 * `displacement`, `velocity`, `rotation`, `spin` at creation and, once edited, at
 * mps_dynamics_restart, without which no step is taken then; `external_force` (N) at every step, if
 * the set has it by then; it writes displacement, velocity, rotation, spin, `position`,
 * `acceleration`, `pressure`, the history fields `displacement_old`, `rotation_old`,
 * `restoring_old` and, if the set has it, `reaction` (N).
 *
 * After a step to time t = mps_dynamics_time the positions, displacements and rotations are those
 * of t; accelerations, pressures and reactions are those of the beginning of the step, t - dt
 * (mps_dynamics_refresh brings accelerations and pressures to t); velocity and spin those of t -
 * dt/2 (Verlet, leapfrog) or of t (Euler).
 *
 * Between two steps particles may be removed (mps_particles_remove): erosion, excavation. The other
 * particles continue without the forces of the removed ones, as in a new solver; boundaries and
 * loads drop them, dt is checked or chosen again. Removed particles are restored, also in
 * boundaries and loads, with an earlier state (mps_dynamics_rollback, mps_dynamics_restore). None
 * can be added: an added particle has no reference position in a body that has moved.
 *
 * Ranks (mps/experimental/domain.h) each make the same whole set, of which each keeps its part and
 * all free-field columns. All functions are collective except the queries get_def, particles,
 * context, pairs, limit, time and steps; lists of ids name particles of any rank. No particle can
 * be removed. Rank 0 writes files, all read them, on any number of ranks. Thread rule: one thread
 * at a time per context; a step runs on its executor, with the same bits for every number of
 * threads and ranks. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_DYNAMICS_H
#define LIBMPS_DYNAMICS_H

#include "io.h"
#include "kernel.h"
#include "material.h"
#include "particles.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_dynamics mps_dynamics;
/** The solver as one of all kinds (mps/solver.h), for the functions that all have; NULL for NULL.
 * It is the same object: `dynamics` or this is destroyed, not both. */
MPS_API mps_solver *mps_dynamics_solver(const mps_dynamics *dynamics);

typedef enum mps_dynamics_integrator {
  MPS_DYNAMICS_INTEGRATOR_VERLET = 0,   /* Yoshida (8) */
  MPS_DYNAMICS_INTEGRATOR_LEAPFROG = 1, /* Yoshida (4), (5): the same motion */
  MPS_DYNAMICS_INTEGRATOR_EULER = 2     /* Yoshida (2), (3) corrected: grows without damping */
} mps_dynamics_integrator;

/** Removal of the rigid rotation from a pair's relative position r: u = r - R r0, with R of the
 *  rotations th_i, th_j of the two particles. */
typedef enum mps_dynamics_rotation {
  MPS_DYNAMICS_ROTATION_MEAN_MATRIX = 0, /* (R(th_i) + R(th_j))/2, Yoshida (12) */
  MPS_DYNAMICS_ROTATION_MEAN_ANGLE = 1   /* R((th_i + th_j)/2), Yoshida (11) */
} mps_dynamics_rotation;

/** Stiffness-proportional Rayleigh damping where the ratio h differs between particles. With one
 *  ratio for all the two are the same. */
typedef enum mps_dynamics_damping {
  MPS_DYNAMICS_DAMPING_PAIR = 0,    /* by pairs, as element damping: keeps momentum, dissipates
                                       always, Yoshida (A15) */
  MPS_DYNAMICS_DAMPING_PARTICLE = 1 /* each particle's whole restoring force times its h: the
                                       stress at a layer boundary is undamped, Yoshida (A24) */
} mps_dynamics_damping;

typedef struct mps_dynamics_def {
  uint32_t struct_size;
  int32_t integrator; /* MPS_DYNAMICS_INTEGRATOR_..., default VERLET */
  int32_t rotation;   /* MPS_DYNAMICS_ROTATION_..., default MEAN_MATRIX */
  int32_t damping;    /* MPS_DYNAMICS_DAMPING_..., default PAIR */
  /* s, 1e-12 to 1e9, at most the linear limit (mps_dynamics_find_limit): a larger one is refused at
     the first step (Euler: a warning), but mps_dynamics_set_dt takes it. NaN (default): `courant`
     times that limit, found at the first step */
  double dt;
  double courant;        /* fraction of the linear limit for dt, in (0, 1]; default 0.9 */
  double radius_ratio;   /* re / D, in (1, 4]; default 1.5. Not read with a kernel */
  double f1, f2;         /* Rayleigh damping has the ratio h at these frequencies, Hz, 1e-20 to 1e9;
                            default 1 and 14 */
  double period_x;       /* m, > 0: the body repeats itself in x with this period; NaN (default): it
                            does not */
  double divergence;     /* m/s2, > 0: |acceleration| beyond it alone stops the run; NaN (default):
                            1e15, and a kinetic energy beyond what was there and was put in */
  double measure;        /* thickness, m, 1e-9 to 1e9; default 1 */
  double gravity[3];     /* m/s2, |g| at most 1e6, on all particles; [2] must be 0; default 0 */
  int32_t watch_damping; /* 1: each step sums the dissipation of Rayleigh damping, so that
                            mps_dynamics_get_totals reports it apart from that of the time
                            integration, and takes longer. 0 (default): reports their sum */
  int32_t reserved;      /* 0 */
  mps_material *material; /* linear elastic, of all particles; NULL (default): the moduli of the
                             fields. Kept alive */
  mps_kernel *kernel; /* weight function, its radius in (1, 4] spacings; NULL (default): re/r - 1
                         with radius_ratio, Yoshida (A8). Kept alive */
  mps_domain *domain; /* ranks that share the body; NULL (default): none. Kept alive */
} mps_dynamics_def;

static inline mps_dynamics_def mps_dynamics_defaults(void) {
  mps_dynamics_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_DYNAMICS, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the 2D set `particles`, sorting it (its epoch changes). `def` NULL:
 *  defaults. On an error the set is as before: fields, values, order, epoch. MPS_ERROR_ARGUMENT: a
 *  member of `def` or a field value out of range; MPS_ERROR_FIELD: a field that is needed is
 *  missing; MPS_ERROR_STATE: another solver holds the set; MPS_ERROR_UNSUPPORTED: a set that is not
 *  2D; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_create(mps_context *context, mps_particles *particles,
                                                     const mps_dynamics_def *def,
                                                     mps_dynamics **out);
/** Releases and nulls; accepts NULL. In a callback of the solver itself it only records
 *  MPS_ERROR_STATE. */
static inline void mps_dynamics_destroy(mps_dynamics **dynamics) {
  mps_solver *solver = dynamics ? mps_dynamics_solver(*dynamics) : NULL;
  mps_solver_destroy(&solver);
  if (dynamics && !solver) *dynamics = NULL;
}

/** The definition in use, with dt as set since (NaN: not yet chosen). MPS_ERROR_ARGUMENT: NULL, or
 *  a `size` unknown to this library. */
static inline mps_status mps_dynamics_get_def(const mps_dynamics *dynamics, mps_dynamics_def *out) {
  return mps_solver_get_def(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS, out, sizeof *out);
}
/** The set of the solver; NULL for NULL. Lent. */
static inline mps_particles *mps_dynamics_particles(const mps_dynamics *dynamics) {
  return mps_solver_particles(mps_dynamics_solver(dynamics));
}
/** The context of the solver; NULL for NULL. Lent. */
static inline mps_context *mps_dynamics_context(const mps_dynamics *dynamics) {
  return mps_solver_context(mps_dynamics_solver(dynamics));
}
/** Assigns a material to the particles `ids` (NULL with count 0: all), before the first step or
 *  between two: writes `shear_velocity` and `pressure_velocity` from the constants of `material`
 *  and the particles' `density`. MPS_ERROR_UNSUPPORTED: not linear elastic; MPS_ERROR_FIELD: no
 *  field `density`; MPS_ERROR_STATE: a field is being edited, or a callback of the solver is
 *  running. On an error nothing has changed. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_set_material(mps_dynamics *dynamics,
                                                           const mps_material *material,
                                                           const int64_t *ids, int64_t count);

/* ---- boundaries: before the first step and between any two ----------------------------------- */

/* Kinds (mps_boundary_kind): HELD, each of `dofs` is at rest: a roller, a rigid base. DRIVEN, each
 * component with a signal follows it, the rest of `dofs` is held. ABSORBING, Lysmer dashpots to a
 * half space outside, with a wave coming in from it: traction rho V (2 v_in - v), V = Vp along the
 * normal and Vs across. */

/** A boundary on some particles. Where two prescribe the same degree of freedom, the one with the
 *  higher number prevails; dashpots of several (a corner) add up, and do not act on a prescribed
 *  degree of freedom. */
typedef struct mps_dynamics_boundary_def {
  uint32_t struct_size;
  int32_t kind; /* mps_boundary_kind: HELD (default), DRIVEN or ABSORBING */
  /* The particles: a list, or those whose present position lies in a box, or all (mps/solver.h). */
  const int64_t *ids; /* copied */
  int64_t id_count;
  double lower[3], upper[3]; /* m, bounds included; NaN (default): no bound */
  int32_t all;               /* 1: all particles; default 0 */
  int32_t reserved;
  uint32_t dofs; /* MPS_DOF_X, MPS_DOF_Y, MPS_DOF_ROTATION, or-ed, besides those with a signal. 0
                    (default): all three. Not of ABSORBING */
  int32_t axis;  /* absorbing: that of the face's normal, 0 x, 1 (default) y; each particle
                    has one face of length D */
  /* Driven: the displacement is that of the particle when the boundary is added, plus factor (u(t)
   * - u(then)). Absorbing: the incoming wave, of which the velocity is used. x and y; the third is
   * NULL. Signals are kept alive. */
  mps_signal *signal[3];                             /* default NULL */
  double factor[3];                                  /* finite, default 1 */
  double density, shear_velocity, pressure_velocity; /* absorbing: of the half space; NaN (default):
                                                        of each particle itself */
} mps_dynamics_boundary_def;

static inline mps_dynamics_boundary_def mps_dynamics_boundary_defaults(void) {
  mps_dynamics_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_DYNAMICS_BOUNDARY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a boundary; `number` receives the lowest free number, from 0. Before the first step, held
 *  degrees of freedom start at rest and driven ones with the signal's velocity; later the next step
 *  brings them to that velocity. Dashpots act with the mean of the velocities before and after a
 *  step, so that they do not lower the stable time step (Euler: explicitly). MPS_ERROR_ARGUMENT: a
 *  member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a callback of the solver is
 *  running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_dynamics_add_boundary(mps_dynamics *dynamics, const mps_dynamics_boundary_def *def,
                          int32_t *number) {
  return mps_solver_add(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_BOUNDARY, def, number);
}
/** Gives a boundary another definition; its impulse and work are kept. A degree of freedom that it
 *  prescribes already continues from its present value. MPS_ERROR_ARGUMENT: no boundary `number`;
 *  otherwise errors as mps_dynamics_add_boundary. */
MPS_NODISCARD static inline mps_status
mps_dynamics_set_boundary(mps_dynamics *dynamics, int32_t number,
                          const mps_dynamics_boundary_def *def) {
  return mps_solver_set(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_BOUNDARY, number, def);
}
/** Removes a boundary: its particles are free from the next step on, with their present velocity.
 *  MPS_ERROR_ARGUMENT: no boundary `number`; MPS_ERROR_STATE: a callback of the solver is running.
 *  */
MPS_NODISCARD static inline mps_status mps_dynamics_remove_boundary(mps_dynamics *dynamics,
                                                                    int32_t number) {
  return mps_solver_remove(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_BOUNDARY, number);
}
/** The definition of boundary `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_dynamics_get_boundary(const mps_dynamics *dynamics, int32_t number,
                                                   mps_dynamics_boundary_def *out) {
  return mps_solver_get(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_BOUNDARY, number, out,
                        sizeof *out);
}
/** Force, moment, impulse and work of the boundary on its particles; the field `reaction`, if the
 *  set has it, holds the force on each particle, of all boundaries. MPS_ERROR_ARGUMENT: no boundary
 *  `number`, NULL, or a `size` unknown to this library. */
static inline mps_status mps_dynamics_get_reaction(const mps_dynamics *dynamics, int32_t number,
                                                   mps_reaction *out) {
  return mps_solver_get_reaction(mps_dynamics_solver(dynamics), number, out);
}

/** Before mps_dynamics_create: appends a free-field column beside the vertical edge `side`
 *  (MPS_SIDE_X_LOWER or _UPPER) of the set, `gap` spacings away (2 to 1000000): one copy, fields
 *  included, of each particle of that edge, marked in the field `free_field`. The solver moves the
 *  column as horizontally infinite ground, applies to the edge the forces of the missing ground
 *  beside it, and couples edge and column by dashpots, so that level ground responds exactly as the
 *  column and waves from inside leave. Base conditions must include the column: select by a box
 *  wide enough. MPS_ERROR_ARGUMENT: `side` or `gap` out of range, or no 2D body; MPS_ERROR_STATE: a
 *  solver holds the set, the set lies in parts on ranks, or it has such a column already;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_add_free_field(mps_particles *particles, int32_t side,
                                                             int32_t gap);

/* ---- loads: before the first step and between any two ---------------------------------------- */

typedef enum mps_dynamics_load_kind {
  MPS_DYNAMICS_LOAD_TRACTION = 0, /* `traction` on the `area` of each particle */
  MPS_DYNAMICS_LOAD_BODY = 1      /* `acceleration` on the mass of each particle: gravity */
} mps_dynamics_load_kind;

/** A load on the particles of a list, of a box at present, or all (mps/solver.h), dead (it does not
 *  turn with the particles), times factor times signal in each
 *  component. Forces that another code computes go into the field `external_force` instead. */
typedef struct mps_dynamics_load_def {
  uint32_t struct_size;
  int32_t kind;       /* MPS_DYNAMICS_LOAD_..., default TRACTION */
  const int64_t *ids; /* copied */
  int64_t id_count;
  double lower[3], upper[3]; /* m, bounds included; NaN (default): no bound */
  int32_t all;               /* 1: all particles; default 0 */
  int32_t reserved;
  double traction[3];     /* Pa, finite; the third is 0; default 0 */
  double acceleration[3]; /* m/s2, finite; the third is 0; default 0 */
  double area; /* m2, 1e-30 to 1e30: of each particle; NaN (default): spacing times measure */
  mps_signal *signal[3]; /* a number in time (mps/signal.h), at the time that a step begins
                            with; NULL (default): 1. Kept alive */
  double factor[3];      /* finite, default 1 */
} mps_dynamics_load_def;

static inline mps_dynamics_load_def mps_dynamics_load_defaults(void) {
  mps_dynamics_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_DYNAMICS_LOAD, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load; `number` (may be NULL) receives the lowest free number, from 0. MPS_ERROR_ARGUMENT:
 *  a member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a callback of the solver is
 *  running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_dynamics_add_load(mps_dynamics *dynamics, const mps_dynamics_load_def *def, int32_t *number) {
  return mps_solver_add(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_LOAD, def, number);
}
/** Gives load `number` another definition. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors
 *  as mps_dynamics_add_load. */
MPS_NODISCARD static inline mps_status mps_dynamics_set_load(mps_dynamics *dynamics, int32_t number,
                                                             const mps_dynamics_load_def *def) {
  return mps_solver_set(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_LOAD, number, def);
}
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: a callback
 *  of the solver is running. */
MPS_NODISCARD static inline mps_status mps_dynamics_remove_load(mps_dynamics *dynamics,
                                                                int32_t number) {
  return mps_solver_remove(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_LOAD, number);
}
/** The definition of load `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_dynamics_get_load(const mps_dynamics *dynamics, int32_t number,
                                               mps_dynamics_load_def *out) {
  return mps_solver_get(mps_dynamics_solver(dynamics), MPS_DEF_DYNAMICS_LOAD, number, out,
                        sizeof *out);
}

/* ---- running --------------------------------------------------------------------------------- */

/** Takes `count` (>= 0) steps of dt, then brings all fields up to date. The cancel hook is called
 *  before the first and some ten times a second: MPS_ERROR_CANCELLED, after whole steps.
 *  MPS_ERROR_DIVERGED: an acceleration beyond the limit of the definition or not finite, more
 *  kinetic energy than the body can have, or at the end a velocity beyond 1e100 m/s; the record
 *  names step, time and particle. The step is undone, and a smaller dt may go on. Where
 *  accelerations rise from below a thousandth of the limit within one step, it is not: fields show
 *  the state after it, `pressure` of its positions; mps_dynamics_rollback, _restore and _restart
 *  continue, other calls return MPS_ERROR_STATE. */
MPS_NODISCARD static inline mps_status mps_dynamics_step(mps_dynamics *dynamics, int64_t count) {
  return mps_solver_step(mps_dynamics_solver(dynamics), count);
}

/** Called at the start of a run, then every `every` steps and at the end, with fields up to date.
 *  It may query the solver; functions that change it return MPS_ERROR_STATE. A status other than
 *  MPS_OK ends the run, which returns it. */
typedef mps_status (*mps_dynamics_fn)(void *user, mps_dynamics *dynamics);
/* A run's callback with its solver, as mps_solver_run calls it. */
typedef struct mps_dynamics_call {
  mps_dynamics *solver;
  mps_dynamics_fn callback;
  void *user;
} mps_dynamics_call;
static inline mps_status mps_dynamics_call_back(void *user, mps_solver *solver) {
  const mps_dynamics_call *call = (const mps_dynamics_call *)user;
  (void)solver;
  return call->callback(call->user, call->solver);
}

/** Goes to exactly t_end (s, not before the present time), in equal steps of at most dt; dt itself
 *  stays. Runs of one length after the other so have one step length. Calls `callback` (may be
 *  NULL) every `every` (>= 1) steps, the context's progress hook at least about 100 times, and its
 *  cancel hook some ten times a second. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range;
 *  otherwise errors as mps_dynamics_step, or the status of `callback`. */
MPS_NODISCARD static inline mps_status mps_dynamics_run(mps_dynamics *dynamics, double t_end,
                                                        int64_t every, mps_dynamics_fn callback,
                                                        void *user) {
  mps_dynamics_call call = {dynamics, callback, user};
  return mps_solver_run(mps_dynamics_solver(dynamics), t_end, every,
                        callback ? mps_dynamics_call_back : NULL, &call);
}

/** Reads displacement, velocity, rotation and spin from the fields as a new initial state without
 *  history, at time `time` (s, finite), step 0: the budget of mps_dynamics_get_totals and the
 *  reactions start from 0. MPS_ERROR_ARGUMENT: a value that is not finite, or a speed (m/s; spin
 *  times spacing) above 1e100; MPS_ERROR_STATE: a field is being edited, or a callback of the
 *  solver is running. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_restart(mps_dynamics *dynamics, double time);

/** Computes `acceleration` and `pressure` at the time of the positions, boundaries and loads
 *  included (signals are evaluated). Costs one step; nothing else changes. MPS_ERROR_DIVERGED,
 *  changing nothing: they would not be finite. MPS_ERROR_STATE: the run has diverged before. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_refresh(mps_dynamics *dynamics);

/** Keeps the state of the solver and its set (fields, order) in memory. *snapshot is created when
 *  it is NULL; a snapshot of this solver is filled again. Edited fields are read as by a step, and
 *  not read on an error. Allowed in a callback of mps_dynamics_run. MPS_ERROR_ARGUMENT: a snapshot
 *  of another solver; MPS_ERROR_STATE: a step is running, a field is being edited, or the run has
 *  diverged; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_dynamics_snapshot(mps_dynamics *dynamics,
                                                             mps_snapshot **snapshot) {
  return mps_solver_snapshot(mps_dynamics_solver(dynamics), snapshot);
}
/** Restores a snapshot, bit for bit, also after a run that has diverged or particles that were
 *  removed. Not in the snapshot: loads and signals. MPS_ERROR_STATE, changing nothing: the
 *  boundaries are on other particles than then. */
MPS_NODISCARD static inline mps_status mps_dynamics_rollback(mps_dynamics *dynamics,
                                                             const mps_snapshot *snapshot) {
  return mps_solver_rollback(mps_dynamics_solver(dynamics), snapshot);
}
/** Writes the state to a file, as mps_dynamics_snapshot; of `info` (NULL: nothing) user_key and
 *  user_data are written too. After a failure while writing (a full disk; on several ranks any
 *  failure on rank 0), edited fields may have been read. MPS_ERROR_IO: the file cannot be written;
 *  MPS_ERROR_STATE: as mps_dynamics_snapshot; MPS_ERROR_UNSUPPORTED: no HDF5.
 *  */
MPS_NODISCARD static inline mps_status mps_dynamics_save(mps_dynamics *dynamics, const char *path,
                                                         const mps_checkpoint *info) {
  return mps_solver_save(mps_dynamics_solver(dynamics), path, info);
}
/** Restores a file of mps_dynamics_save in a solver that was built in the same way: set, definition
 *  (but dt), boundaries. Particles are removed or restored as in the file. Coefficients follow the
 *  fields in the file. MPS_ERROR_FORMAT, changing nothing: a file of another model, the message
 *  says in what. `info` (may be NULL) as for mps_checkpoint_info. */
MPS_NODISCARD static inline mps_status
mps_dynamics_restore(mps_dynamics *dynamics, const char *path, mps_checkpoint *info) {
  return mps_solver_restore(mps_dynamics_solver(dynamics), path, info);
}

/** Time (s); 0 for NULL. */
static inline double mps_dynamics_time(const mps_dynamics *dynamics) {
  return mps_solver_time(mps_dynamics_solver(dynamics));
}
/** Number of steps taken; 0 for NULL. */
static inline int64_t mps_dynamics_steps(const mps_dynamics *dynamics) {
  return mps_solver_steps(mps_dynamics_solver(dynamics));
}
/** Time step (s), computed first where the definition leaves it to the library. 0 on failure. */
static inline double mps_dynamics_dt(mps_dynamics *dynamics) {
  return mps_solver_dt(mps_dynamics_solver(dynamics));
}
/** Sets the time step (s, 1e-12 to 1e9). Above the linear limit, where motion grows without bound,
 *  a warning is logged. At a change the velocity is kept, and forces act for the mean of the two
 * steps. MPS_ERROR_ARGUMENT: out of range; MPS_ERROR_STATE: a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_dynamics_set_dt(mps_dynamics *dynamics, double dt) {
  return mps_solver_set_dt(mps_dynamics_solver(dynamics), dt);
}

/** Sums over the body; free-field columns are not counted. Kinetic energy is v-.M.v+ / 2 with v-
 *  the velocity half a step before the state and v+ the one that the restoring forces alone lead to
 *  half a step after it (Euler: v.M.v / 2); works are forces times the mean of the velocities
 *  before and after a step. So for a linear body (small strains and rotations), Verlet or leapfrog
 *  and constant dt the budget of mps/solver.h closes by itself, to 1e-10 of its largest term or of
 *  the largest rotation (rad), whichever is more. `scheme` is the remainder: the effect of
 *  rotations that are not small, changes of dt, and Euler. Without mps_dynamics_def.watch_damping
 *  the remainder is the dissipation of damping, and `scheme` is NaN; with free-field columns it
 *  belongs to work_boundaries, and `scheme` is NaN too. MPS_ERROR_ARGUMENT: NULL, or a `size`
 *  unknown to this library; MPS_ERROR_MEMORY. */
static inline mps_status mps_dynamics_get_totals(const mps_dynamics *dynamics, mps_totals *out) {
  return mps_solver_get_totals(mps_dynamics_solver(dynamics), out);
}

/* ---- stability limit of the time step -------------------------------------------------------- */

/** A stable time step (s) at once: the linear limit where it is known, else a lower bound of it
 *  from the stiffest and lightest material on a lattice, at most a quarter below it where all
 *  ground is alike. NaN: not known off a lattice before mps_dynamics_find_limit; 0: Euler,
 *  likewise. */
static inline double mps_dynamics_limit(const mps_dynamics *dynamics) {
  return mps_solver_limit(mps_dynamics_solver(dynamics));
}

/** Limit by linear theory: the highest eigenfrequency of the tangent at the reference state. */
typedef struct mps_dynamics_linear_limit {
  double dt;       /* largest stable step, s; Euler without damping: 0 unless `duration` was given;
                      infinite where no relative motion is possible */
  double omega;    /* highest eigenfrequency of the undamped set, rad/s */
  double residual; /* relative bound on the error of omega^2 */
  int64_t iterations;
} mps_dynamics_linear_limit;

/** No time stepping: Lanczos iteration on the tangent with the present boundaries; damping may
 *  differ from particle to particle. Costs from some tens to a few thousand steps, once as long as
 *  nothing changes. `duration` (s, >= 0): for Euler, which has no limit without damping but grows
 *  slowly, the largest step (up to 4/omega) whose amplification over `duration` stays below 1e15;
 *  0: the asymptotic limit. Other integrators ignore it. MPS_ERROR_ARGUMENT: `duration` below 0 or
 *  not finite; MPS_ERROR_NUMERIC: no convergence; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_dynamics_find_limit_sized(mps_dynamics *dynamics,
                                                               double duration,
                                                               mps_dynamics_linear_limit *out,
                                                               size_t size);
static inline mps_status mps_dynamics_find_limit(mps_dynamics *dynamics, double duration,
                                                 mps_dynamics_linear_limit *out) {
  return mps_dynamics_find_limit_sized(dynamics, duration, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
