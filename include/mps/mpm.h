/* mps/mpm.h - the WLS-MPM grid solver (Nakamura): large deformation of material points that move
 * through a grid of nodes, with frictional contact against rigid bodies. Plane strain, axisymmetry
 * (x is the radius, y the axis) or space.
 *
 * Shape functions come from a weighted least-squares fit of a linear function over the nodes that a
 * particle may use: nodes of the domain, except those inside a body or behind it. Nodes exist only
 * in blocks of 8 x 8 (x 8) around particles, so memory grows with the particles and not with the
 * domain, which may be infinite.
 *
 * The solver works in the fields of the particle set itself (zero copy), and sorts the set when a
 * particle has moved a cell beyond its block: views taken before are then stale (their epoch). It
 * reads `density` (kg/m3, > 0) at creation, and `volume` (m3, of the modelled thickness or sector;
 * 0 is replaced by spacing^dim times measure, in axisymmetry times the radius), `velocity`,
 * `velocity_gradient` and `stress` where the set has them; it writes these and `mass` and
 * `position`. Committing `density` or `volume` gives those particles whose value has changed the
 * mass density * volume; the density is that of the present volume. The fields `body_acceleration`
 * (m/s2, adds to gravity) and `external_force` (N) are read in each step where the set has them.
 * Laws that need them bring the fields `volume_ratio`, `deformation_gradient` and their history.
 *
 * Forces and transfers take the slope of the fit, which is `velocity_gradient`; the laws see the
 * derivative of the shape functions, along axes whose stencil neither sides nor bodies cut. Beside
 * bodies with contact by impulses the spin of `velocity_gradient` is that by which the particle
 * carries the moment of its nodes' momenta (not in axisymmetry).
 *
 * Ranks (mps/experimental/domain.h; docs/cluster.md) each make the same whole set, of which they
 * keep a part that changes as particles move; all functions except queries are collective. Thread
 * rule: one thread at a time per context; a step runs on its executor, with the same bits for every
 * number of threads and ranks. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPM_H
#define LIBMPS_MPM_H

#include "contact.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_mpm mps_mpm;
/** The solver as one of all kinds (mps/solver.h), for the functions that all have; NULL for NULL.
 * It is the same object: `mpm` or this is destroyed, not both. */
MPS_API mps_solver *mps_mpm_solver(const mps_mpm *mpm);
typedef enum mps_mpm_geometry {
  MPS_MPM_GEOMETRY_PLANE_STRAIN = 0,
  MPS_MPM_GEOMETRY_AXISYMMETRIC = 1, /* x = r >= 0, y = z */
  MPS_MPM_GEOMETRY_SPACE = 2         /* three dimensions */
} mps_mpm_geometry;

/** Speed in the Courant limit: c is the velocity of P waves, sqrt((K + 4G/3)/rho). Viscous laws
 * have the limit rho h^2/(4 dim viscosity) besides. */
typedef enum mps_mpm_step_from {
  MPS_MPM_STEP_FROM_SPEED = 0, /* wave velocity and velocity of each particle, c + |v| */
  MPS_MPM_STEP_FROM_WAVE = 1   /* the wave velocity c alone: steps stay equal in a stiff body that
                                  moves; particles may then go further than `courant` cells a step */
} mps_mpm_step_from;

/** Volumetric strain rate that the laws receive, against volumetric locking and oscillating
 *  pressures in nearly incompressible material; and the filter of the mean stress of frictional
 *  laws and fluids, whose particles else share it unevenly once they have flowed. */
typedef enum mps_mpm_volumetric {
  MPS_MPM_VOLUMETRIC_BY_LAW = 0, /* for each material: Mohr-Coulomb and Drucker-Prager with an angle
                               of friction above 0, and users' frictional laws, as NODES; those
                               without friction or dilation (undrained clay), von Mises, and elastic
                               laws (linear, neo-Hookean, users' that state their moduli) with nu >=
                               0.45 as CELL; all others as POINT, fluids with a filter besides.
                               With explicit pressures of pore water those with friction and
                               without dilation as CELL */
  MPS_MPM_VOLUMETRIC_POINT = 1,  /* each particle's own tr(d), in axisymmetry with the hoop */
  MPS_MPM_VOLUMETRIC_CELL = 2, /* F-bar: the mean of tr(d), weighted by volumes, over the particles
                             of the cell (quadratic: of the cell-sized box about a node); the part
                             of d without trace, the spin and `velocity_gradient` stay. Volumes,
                             `volume_ratio` and `deformation_gradient` follow the mean.
                             Mohr-Coulomb and Drucker-Prager with an angle of dilation above 0,
                             and users' frictional laws keep their own tr(d), and are not in the
                             mean */
  MPS_MPM_VOLUMETRIC_NODES = 3 /* the mean of tr(d) and of pressures over the nodes near: fluids use
                              it, other laws approach it by 0.03 c dt/h a step. Mohr-Coulomb,
                              Drucker-Prager and users' frictional laws keep their own tr(d); every
                              eighth step (a step whose number, from creation, 8 divides) their mean
                              stress is filtered: docs/theory/pressures.md */
} mps_mpm_volumetric;

/** Shape functions of particles near a roller, a fixed side or the axis. */
typedef enum mps_mpm_edge {
  MPS_MPM_EDGE_MIRROR = 0, /* with images of the nodes inside: a roller is a mirror */
  MPS_MPM_EDGE_FIT = 1 /* without: the fit uses the existing nodes, as at other sides and at bodies
                           (Nakamura). Keeps affine velocities, which mirrors do not */
} mps_mpm_edge;

typedef struct mps_mpm_def {
  uint32_t struct_size;
  int32_t geometry;   /* mps_mpm_geometry, default PLANE_STRAIN; of as many dimensions as the set.
                         In 2D the third value of each array below is not read */
  int32_t spline;     /* degree of the B-spline weights: 3 (Nakamura (36)) or 2; 0 (default): 3 */
  int32_t volumetric; /* mps_mpm_volumetric, default BY_LAW */
  int32_t step_from;  /* mps_mpm_step_from, default SPEED */
  int32_t budget; /* 1: each step sums the energy budget, see mps_mpm_get_totals; forces are then
                     summed apart from the momenta, which costs time and changes last bits. 0
                     (default): no budget */
  double local_damping;   /* in [0, 1): each component of a node's force shrinks by this fraction of
                             the unbalanced force against its motion; default 0 */
  double viscous_damping; /* 1/s, >= 0: force on a node for each of its momentum; default 0. Both
                             act after all other forces, except on prescribed components, so that
                             reactions are right; they also slow free flight */
  double cell;            /* h, m, > 0; no default. Usually 2 spacings; 0.5 to 1000 are allowed */
  double origin[3];       /* m: a node lies here; default 0 */
  double lower[3], upper[3]; /* m: sides of the domain, on nodes; default: none (infinite). In
                                axisymmetry lower[0] is at least 0, and 0 by default. Each side is
                                initially a roller: see mps_mpm_set_boundary */
  double measure; /* thickness in m (default 1) in plane strain, sector angle in rad (default 2 pi,
                     the whole ring) in axisymmetry, to which all masses, volumes and forces refer;
                     1 in space. NaN: the default */
  double gravity[3]; /* m/s2, default 0 */
  double dt; /* s, > 0: every step; NaN (default): each step `courant` times the limit. At most that
                limit at creation; a warning is logged when it exceeds it later */
  double courant;     /* fraction of the limit h/(c + v), Nakamura (49), (50), that a step takes, in
                         (0, 1]; default 0.5 */
  mps_kernel *kernel; /* NULL (default): weights by `spline` and `cell`; else a B-spline of degree 2
                         or 3 of radius 1.5 or 2 cells, which gives the degree in place of `spline`;
                         kept alive */
  int32_t edge;       /* mps_mpm_edge, default MIRROR */
  int32_t reserved;
  mps_domain *domain; /* ranks that share the body; NULL (default): none. Kept alive */
  double flip_time; /* s, >= 0: in each step a particle keeps exp(-dt/flip_time) of the part of its
                       velocity that the nodes do not represent (its velocity less that of the nodes
                       before the forces), beside the slopes of the fit. 0: nothing, and each
                       transfer damps waves of a few cells. NaN (default): where some law is von
                       Mises, Drucker-Prager, Mohr-Coulomb, Cam-Clay or a user's frictional one, 20
                       times the time h/(c + v) of the fastest particle (explicit pressures of
                       water that flows do not count in c), so that ground flows alike by any step;
                       else, and with a variant of mps/experimental/papers.h, 0. Not while
                       mps_mpm_settle runs. A step takes longer, and angular momentum is conserved
                       to the error of the transfers, not to round-off */
} mps_mpm_def;

static inline mps_mpm_def mps_mpm_defaults(void) {
  mps_mpm_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MPM, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the set `particles` (at least one, inside the domain) and sorts it. A set
 *  has at most one solver that moves it. Between steps particles may be added to the set, inside
 *  the domain and outside the bodies, and removed from it; a callback is not between steps. New
 *  ones have the lattice's volume, no stress, and the material of creation; the next step is
 *  MPS_ERROR_STATE until their density is committed. Lists of ids skip removed particles. On an
 *  error the set is as before. All particles are of the one `material`, which is kept alive, until
 *  mps_mpm_set_material; its history columns become fields of the set. MPS_ERROR_ARGUMENT: a member
 *  of `def`, a position or a field value out of range; MPS_ERROR_FIELD: no field `density`;
 *  MPS_ERROR_STATE: another solver holds the set; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_mpm_create(mps_context *context, mps_particles *particles,
                                                mps_material *material, const mps_mpm_def *def,
                                                mps_mpm **out);
/** Destroys and nulls; accepts NULL. In a callback of the solver it only records MPS_ERROR_STATE.
 *  */
static inline void mps_mpm_destroy(mps_mpm **mpm) {
  mps_solver *solver = mpm ? mps_mpm_solver(*mpm) : NULL;
  mps_solver_destroy(&solver);
  if (mpm && !solver) *mpm = NULL;
}

/** Gives the `count` (>= 0) particles of `ids` (NULL with count 0: all) another law, before the
 *  first step or between steps. The material is kept alive. Its history in these particles is set
 *  to the law's initial values; stress, volume, `volume_ratio` and `deformation_gradient` stay as
 *  they are (0: 1, and all 0: no deformation). Fields that only this law needs are added to the
 *  set; the field `material` has each particle's law. The Courant limit, and the stiffness of
 *  penalty contacts without a `penalty` of their own, follow at once. MPS_ERROR_ARGUMENT: an
 *  unknown id, a volume ratio below 0, or a stress in which the law cannot begin. Before the first
 *  step that step, or a snapshot, says so instead, as the state may be restored from a checkpoint;
 *  MPS_ERROR_STATE: a step has failed, or a callback of the solver is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_material(mps_mpm *mpm, mps_material *material,
                                                      const int64_t *ids, int64_t count);

/** Adds contact of the particles with `body` (`def` NULL: the defaults) until mps_contact_destroy
 *  or the destruction of the solver. `contact`, which may be NULL, receives the caller's handle.
 *  The body keeps its own time. Each contact is with another body, and bodies may not
 *  overlap by more than 0.1 cells: before the first step that step says so, and of particles
 *  inside the body, as the state may be restored. Bodies have no contact with one another, nor
 *  with sides of the domain: where they come to overlap, or the reference point of a free one is
 *  beyond a side, a warning is logged. MPS_ERROR_ARGUMENT also where the body is thinner
 *  than two cells or particles lie inside it, unless `def` allows it, and for a free body in
 *  axisymmetry that has a radial velocity, gravity or load, or a spin: it moves along y alone. A
 *  moving body limits the step: its surface moves at most `courant` cells in one. Edges of a body
 *  that end in the ground, such as the tip of a wall, act as if the body were up to 0.7 cells wider
 *  there. With MPS_CONTACT_METHOD_PENALTY a warning is logged for a contact stiffness k dt^2/m > 6,
 *  with which contacts chatter. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_contact(mps_mpm *mpm, mps_body *body,
                                                     const mps_contact_def *def,
                                                     mps_contact **contact);

/** The definition of the solver, with its defaults completed. MPS_ERROR_ARGUMENT: NULL, or a `size`
 *  unknown to this library. */
static inline mps_status mps_mpm_get_def(const mps_mpm *mpm, mps_mpm_def *out) {
  return mps_solver_get_def(mps_mpm_solver(mpm), MPS_DEF_MPM, out, sizeof *out);
}
/** The set; NULL for NULL. Lent: it lives at least as long as the solver. */
static inline mps_particles *mps_mpm_particles(const mps_mpm *mpm) {
  return mps_solver_particles(mps_mpm_solver(mpm));
}
/** The context; NULL for NULL. Lent: it lives at least as long as the solver. */
static inline mps_context *mps_mpm_context(const mps_mpm *mpm) {
  return mps_solver_context(mps_mpm_solver(mpm));
}

/* ---- running --------------------------------------------------------------------------------- */
/** Takes `count` (>= 0) steps, and calls the cancel hook before each (MPS_ERROR_CANCELLED). A
 *  particle that passes a side of the domain by less than 0.1 cells is moved back to it. A step
 *  with a particle too deep in a body (MPS_ERROR_DIVERGED), without memory (MPS_ERROR_MEMORY), or
 *  with a user's law that fails is undone, except perhaps for the order of the particles. A step in
 *  which a particle leaves the domain (MPS_ERROR_DIVERGED) is complete and counted; no other is
 *  made until the particle is moved back (mps_particles_edit of `position`) or removed, or the
 *  solver is rolled back. MPS_ERROR_DIVERGED, and the step is undone: values that are not finite;
 *  more kinetic energy than what was there, stored or done as work can give; in ground with pore
 *  water a porosity outside (0, 1), a pressure beyond the bulk modulus of the water or a motion of
 *  more than a cell. The record names step, time, particle, value and bound; a smaller dt may go on
 *  from there. Values that are not finite after a step that continues a calm motion, which is not
 *  saved, stay for inspection: only mps_mpm_rollback or mps_mpm_restore continue from there, others
 *  return MPS_ERROR_STATE. */
MPS_NODISCARD static inline mps_status mps_mpm_step(mps_mpm *mpm, int64_t count) {
  return mps_solver_step(mps_mpm_solver(mpm), count);
}

/** Called at the start of a run, then every `every` steps and at the end. A status other than
 *  MPS_OK ends the run, which returns it. It may query the solver; functions that step, change or
 *  destroy it return MPS_ERROR_STATE. */
typedef mps_status (*mps_mpm_fn)(void *user, mps_mpm *mpm);
/* A run's callback with its solver, as mps_solver_run calls it. */
typedef struct mps_mpm_call {
  mps_mpm *solver;
  mps_mpm_fn callback;
  void *user;
} mps_mpm_call;
static inline mps_status mps_mpm_call_back(void *user, mps_solver *solver) {
  const mps_mpm_call *call = (const mps_mpm_call *)user;
  (void)solver;
  return call->callback(call->user, call->solver);
}

/** Steps to t_end (s, not before mps_mpm_time), the last step shortened to end exactly there;
 *  `callback` may be NULL, `every` >= 1. The context's progress hook is called about 100 times, the
 *  cancel hook before each step. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range; otherwise
 *  errors as mps_mpm_step, or the status of `callback`. */
MPS_NODISCARD static inline mps_status mps_mpm_run(mps_mpm *mpm, double t_end, int64_t every,
                                                   mps_mpm_fn callback, void *user) {
  mps_mpm_call call = {mpm, callback, user};
  return mps_solver_run(mps_mpm_solver(mpm), t_end, every, callback ? mps_mpm_call_back : NULL,
                        &call);
}

/** Time (s); 0 for NULL. */
static inline double mps_mpm_time(const mps_mpm *mpm) {
  return mps_solver_time(mps_mpm_solver(mpm));
}
/** Number of steps taken; 0 for NULL. */
static inline int64_t mps_mpm_steps(const mps_mpm *mpm) {
  return mps_solver_steps(mps_mpm_solver(mpm));
}
/** Size (s) of the next step; 0 for NULL. */
static inline double mps_mpm_dt(const mps_mpm *mpm) { return mps_solver_dt(mps_mpm_solver(mpm)); }
/** The Courant limit h/(c + v), Nakamura (49), that of viscosity, or h over the speed of the
 *  fastest body in contact, of the present state (s), without the fraction `courant`; 0 for NULL.
 *  Cheap. */
static inline double mps_mpm_limit(const mps_mpm *mpm) {
  return mps_solver_limit(mps_mpm_solver(mpm));
}
/** Sets `dt` of the definition (s, > 0, at most the limit; NaN: it follows the limit).
 *  MPS_ERROR_ARGUMENT: out of range; MPS_ERROR_STATE: a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_mpm_set_dt(mps_mpm *mpm, double dt) {
  return mps_solver_set_dt(mps_mpm_solver(mpm), dt);
}

/* ---- sums ------------------------------------------------------------------------------------ */
/** Sums over the particles (bodies not counted), of the measure. `angular` has the spin that the
 *  velocity gradients carry, m h^2/3 (cubic; quadratic: /4) curl v; it is conserved with full
 *  supports. `kinetic` is that of the particles' velocities alone. `work_boundaries` and
 *  `work_bodies` are always summed; the other energies are NaN unless `budget` of the definition is
 *  1 (mps/experimental/mpm_energy.h). MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this
 * library. */
static inline mps_status mps_mpm_get_totals(const mps_mpm *mpm, mps_totals *out) {
  return mps_solver_get_totals(mps_mpm_solver(mpm), out);
}

/** Size of the grid, and convergence of the contact impulses. */
typedef struct mps_mpm_report {
  int64_t blocks, nodes; /* blocks of cells that hold particles; nodes that exist */
  int64_t bytes;         /* memory of the grid, the particles' fields not counted */
  int64_t sweeps;        /* Gauss-Seidel sweeps over the contacts of the last step; 0: no contact by
                            METHOD_IMPULSE */
  double left; /* relative change of all impulses in the last sweep (mps_contact_def.tolerance) */
} mps_mpm_report;
/** Size of the grid and convergence of the last step's contacts. MPS_ERROR_ARGUMENT: NULL, or a
 *  `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_report_sized(const mps_mpm *mpm, mps_mpm_report *out,
                                                          size_t size);
static inline mps_status mps_mpm_get_report(const mps_mpm *mpm, mps_mpm_report *out) {
  return mps_mpm_get_report_sized(mpm, out, sizeof *out);
}

/* ---- state ----------------------------------------------------------------------------------- */

/** Keeps the state of the solver, its set (fields, order) and its bodies in memory. *snapshot is
 *  NULL, and receives a new one, or a snapshot of this solver, which is filled again and whose
 *  memory is reused. Needs as much memory as the fields. Between steps only, as in the callback of
 *  mps_mpm_run. Edits are read as by a step: dt and limit follow, particles may be sorted. On an
 *  error *snapshot is as before. MPS_ERROR_ARGUMENT: a snapshot of another solver; MPS_ERROR_STATE:
 *  a step has failed, or one is running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_mpm_snapshot(mps_mpm *mpm, mps_snapshot **snapshot) {
  return mps_solver_snapshot(mps_mpm_solver(mpm), snapshot);
}
/** Restores a snapshot, bit for bit; a failed step is discarded, particles added or removed since
 *  are removed or added again, and ids given since are given again. Not in the snapshot, and so
 *  unchanged: gravity, dt, courant, constants of materials and bodies, signals, loads. On an error
 *  nothing has changed. MPS_ERROR_ARGUMENT: of another solver; MPS_ERROR_STATE: bodies, boundaries,
 *  loads or materials are not those of the snapshot, the message says which. */
MPS_NODISCARD static inline mps_status mps_mpm_rollback(mps_mpm *mpm,
                                                        const mps_snapshot *snapshot) {
  return mps_solver_rollback(mps_mpm_solver(mpm), snapshot);
}

/** Writes a checkpoint of the solver's set (mps_solver_save) with all
 *  that the solver needs to continue: time, steps, order and blocks of the particles, forces of the
 *  walls; of its bodies motion, load, reactions and impulses. Of `info` (NULL: the defaults) only
 *  user_key and user_data are read. Edits are read as by mps_mpm_snapshot; the run continues as
 *  without saving. Between steps only, such as in the callback of mps_mpm_run. MPS_ERROR_STATE: a
 *  step has failed; MPS_ERROR_IO: the file cannot be written; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_NODISCARD static inline mps_status mps_mpm_save(mps_mpm *mpm, const char *path,
                                                    const mps_checkpoint *info) {
  return mps_solver_save(mps_mpm_solver(mpm), path, info);
}

/** Restores a file of mps_mpm_save in a solver that was built in the same way; its set takes the
 *  particles of the file. These must agree: spacing, geometry, scheme, spline, cell, origin, places
 *  and kinds of walls and boxes, number of loads, whether there are body accelerations, names and
 *  order of materials, and the shapes, motions and numbers of parts of the bodies in their order.
 *  The present state of the solver does not matter; a failed step is discarded. The run continues
 *  bit for bit as an uninterrupted one, for every number of threads. Everything else is set up by
 *  the caller, and may differ: constants of materials, gravity, dt, courant, signals, loads on
 *  particles, friction, masses of bodies.
 *
 *  The set takes the order of the file: views taken before are stale. On an error nothing has
 *  changed. `info` (may be NULL) is as for mps_checkpoint_info. Statuses are those of
 *  mps_checkpoint_read; MPS_ERROR_FORMAT: written without a solver; MPS_ERROR_ARGUMENT: by a solver
 *  that was built in another way, the message says in what; MPS_ERROR_STATE: another solver uses
 *  the set. */
MPS_NODISCARD static inline mps_status mps_mpm_restore(mps_mpm *mpm, const char *path,
                                                       mps_checkpoint *info) {
  return mps_solver_restore(mps_mpm_solver(mpm), path, info);
}

/* ---- boundaries and loads -------------------------------------------------------------------- */

/* ---- boundaries ------------------------------------------------------------------------------
 * A boundary constrains nodes of a side of the domain or of a box, or particles. Each finite side
 * of the domain is initially a roller, with the number of its mps_side (0 to 5); sides are set
 * and removed as other boundaries. Added boundaries have numbers from 6. Nodes do not move; a
 * boundary prescribes their velocity: `factor` times that of the signal at the middle of the step,
 * NULL being rest.
 *
 * A side acts on its nodes, and so on particles nearer than the spline reaches (1.5 or 2 cells).
 * Where several boundaries constrain one node, fixed sides act after other sides, then boxes in the
 * order of their numbers: the last prevails.
 *
 * Listed particles have exactly the prescribed velocity and place after each step. The nodes that
 * no side or box prescribes get impulses such that their mean velocity at the listed particles of
 * each cell is the prescribed one, in equilibrium with the contacts. The reaction is the sum of
 * these impulses. The end of a list acts on the body within a quarter of a cell of the faces of its
 * last particles. A list of one particle bears no moment. Lists whose particles share cells must
 * have the same velocity there. Not with implicit pore pressures. */

/* Kinds (mps_boundary_kind). Boxes and particles are HELD or DRIVEN, the components `dofs`. Sides:
 *
 *   ROLLER      no velocity across
 *   HELD        no velocity; DRIVEN: that of the signals
 *   FRICTIONAL  no velocity into the side, and Coulomb friction along it; without tension, so that
 *               material may separate
 *   ABSORBING   Lysmer dashpots: traction R - rho c_p v across and R - rho c_s v along, with rho,
 *               c_p and c_s of the particles in the cells at the side (elastic; under a user's law
 *               c_s = c_p/sqrt(3); c_p with K_w/n of water in the pores). The constant R is the
 *               traction at rest: see `settle`. Nodes that become active later carry no R. Stable
 *               for every dt. Particles move with the waves: one that passes the side has left the
 *               domain. A signal's velocity v enters as a wave of v/2
 *   FREE_FIELD  in plane strain, across x: beside the side is a column of soil, level ground that
 *               moves as if it went on without end, under the present kind of the sides across y
 *               (all but FRICTIONAL). The side has the tractions of the column's stresses, and
 *               dashpots rho c_p across and rho c_s along, as those of ABSORBING, on the difference
 *               between the velocities of column and side. The column is made of the particles in
 *               the cells at the side when the side is set, with their stresses, histories and
 *               laws, and the loads and temperatures that these particles have in each step; it
 *               does not feel boxes, lists of particles or bodies. For a law it lies at the x of
 *               the side. Set it again where ground, laws or `volume` have been changed. Each
 *               particle of the column has its own change of volume (MPS_MPM_VOLUMETRIC_POINT). The
 *               column has pore pressures of its own, with the permeabilities and porosities of the
 *               particles that it was made of, and takes the pressures that the caller writes to
 *               these. Displacements across the side must stay below half a spacing. Not on several
 *               ranks or with the standard method, nor in mps_mpm_settle; a step with implicit pore
 *               pressures is refused
 *   FREE        an edge of the grid without constraint
 *   OPEN        the same; particles that pass it are removed at the end of the step. The reaction's
 *               `removed` and `removed_mass` count them, its `count` those of the last step.
 *               Their momentum and kinetic energy are subtracted from its impulses and `work`
 *
 * The axis r = 0 may be ROLLER, HELD or DRIVEN along itself. */

typedef struct mps_mpm_boundary_def {
  uint32_t struct_size;
  int32_t kind; /* mps_boundary_kind, default HELD */
  /* One of a box of nodes, a list of particles and all nodes (mps/solver.h); none for a side. */
  double lower[3], upper[3]; /* m; NaN (default): no bound; in 2D the third value is not read */
  const int64_t *ids;        /* `id_count` particles, copied. Removed ones are skipped, an id named
                                twice counts once */
  int64_t id_count;
  uint32_t dofs;         /* MPS_DOF_X, Y, Z or-ed, of boxes and particles; 0 (default): all */
  int32_t all;           /* 1: all nodes; default 0 */
  mps_signal *signal[3]; /* by component, kept alive, not of HELD; NULL: at rest. Of a roller the
                            one across */
  double factor[3];      /* default 1 */
  double friction; /* Coulomb's mu of FRICTIONAL, >= 0; default 0. Of the effective normal stress
                      where water presses in the pores */
  double settle;   /* s, >= 0: duration in which an ABSORBING side is held, and over which R is the
                      mean traction; what stops moving ground is part of that. 0 (default): R balances
                      the other forces at the nodes in the first step. On the grid, stress and gravity
                      that balance in theory leave up to a percent unbalanced; without settling, the
                      dashpots move under that */
} mps_mpm_boundary_def;

static inline mps_mpm_boundary_def mps_mpm_boundary_defaults(void) {
  mps_mpm_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MPM_BOUNDARY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a box of nodes or a list of particles; `number` (may be NULL) receives the lowest free
 *  number from 6. MPS_ERROR_ARGUMENT: a member of `def` out of range, or an unknown id;
 *  MPS_ERROR_STATE: a callback of the solver is running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_mpm_add_boundary(mps_mpm *mpm, const mps_mpm_boundary_def *def, int32_t *number) {
  return mps_solver_add(mps_mpm_solver(mpm), MPS_DEF_MPM_BOUNDARY, def, number);
}
/** Gives boundary `number` another definition, from the next step on; its impulse and work are
 *  kept. An absorbing side determines its R again. MPS_ERROR_ARGUMENT: no boundary `number`, a side
 *  that the domain does not have, or a member of `def` out of range; MPS_ERROR_STATE: a callback of
 *  the solver is running, or a free-field side is set and new particles have no density or
 *  mps_mpm_settle was cancelled; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_mpm_set_boundary(mps_mpm *mpm, int32_t number,
                                                            const mps_mpm_boundary_def *def) {
  return mps_solver_set(mps_mpm_solver(mpm), MPS_DEF_MPM_BOUNDARY, number, def);
}
/** Removes a boundary: its nodes or particles are free; a side becomes FREE. MPS_ERROR_ARGUMENT: no
 *  boundary `number`, or the axis; MPS_ERROR_STATE: a callback of the solver is running. */
MPS_NODISCARD static inline mps_status mps_mpm_remove_boundary(mps_mpm *mpm, int32_t number) {
  return mps_solver_remove(mps_mpm_solver(mpm), MPS_DEF_MPM_BOUNDARY, number);
}
/** The definition of boundary `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_mpm_get_boundary(const mps_mpm *mpm, int32_t number,
                                              mps_mpm_boundary_def *out) {
  return mps_solver_get(mps_mpm_solver(mpm), MPS_DEF_MPM_BOUNDARY, number, out, sizeof *out);
}
/** Force, impulse and work of boundary `number` on the particles. MPS_ERROR_ARGUMENT: no boundary
 *  `number`, NULL, or a `size` unknown to this library. */
static inline mps_status mps_mpm_get_reaction(const mps_mpm *mpm, int32_t number,
                                              mps_reaction *out) {
  return mps_solver_get_reaction(mps_mpm_solver(mpm), number, out);
}
/** Shorthand: the side `side` (mps_side) of the domain gets `kind`, at rest, with `friction`. */
static inline mps_status mps_mpm_set_side(mps_mpm *mpm, int32_t side, int32_t kind,
                                          double friction) {
  mps_mpm_boundary_def def = mps_mpm_boundary_defaults();
  def.kind = kind;
  def.friction = friction;
  return mps_mpm_set_boundary(mpm, side, &def);
}

/* ---- loads ------------------------------------------------------------------------------------
 * Dead loads on particles. Besides, a field `external_force` (N) of the set is added to the forces
 * on the particles in each step; it may be added and written between steps at any time. */

typedef struct mps_mpm_load_def {
  uint32_t struct_size;
  int32_t all;        /* 1: all particles of the set when the load is added; default 0 */
  const int64_t *ids; /* `id_count` particles, copied */
  int64_t id_count;
  double lower[3], upper[3]; /* m, a box: the particles in it when the load is added; NaN (default):
                                no bound. On several ranks ids only */
  const double *area;    /* m2, one an id, finite, copied; of the measure. NULL: the spacing to the
                            power dim - 1 times the measure, in axisymmetry times the present radius */
  double traction[3];    /* Pa, finite: the force on a particle is area * traction */
  mps_signal *signal[3]; /* by component, a number in time at the beginning of the step, times
                            `factor` multiplies the traction; NULL: `factor` does. Kept alive */
  double factor[3];      /* default 1 */
} mps_mpm_load_def;

static inline mps_mpm_load_def mps_mpm_load_defaults(void) {
  mps_mpm_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_MPM_LOAD, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
/** Adds a load; `number` (may be NULL) receives the lowest free number from 0. MPS_ERROR_ARGUMENT:
 *  a member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a callback of the solver is
 *  running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_mpm_add_load(mps_mpm *mpm, const mps_mpm_load_def *def,
                                                        int32_t *number) {
  return mps_solver_add(mps_mpm_solver(mpm), MPS_DEF_MPM_LOAD, def, number);
}
/** Gives load `number` another definition. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors
 *  as mps_mpm_add_load. */
MPS_NODISCARD static inline mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t number,
                                                        const mps_mpm_load_def *def) {
  return mps_solver_set(mps_mpm_solver(mpm), MPS_DEF_MPM_LOAD, number, def);
}
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: a callback
 *  of the solver is running. */
MPS_NODISCARD static inline mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t number) {
  return mps_solver_remove(mps_mpm_solver(mpm), MPS_DEF_MPM_LOAD, number);
}
/** The definition of load `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_mpm_get_load(const mps_mpm *mpm, int32_t number,
                                          mps_mpm_load_def *out) {
  return mps_solver_get(mps_mpm_solver(mpm), MPS_DEF_MPM_LOAD, number, out, sizeof *out);
}

MPS_EXTERN_C_END
#endif
