/* mps/solver.h - types that all solvers share: degrees of freedom, boundary kinds, reactions,
 * totals, snapshots.
 *
 * Every solver mps_S (mpm, dynamics, elastic, fluid) has these functions, and its own header
 * documents only what differs:
 *
 *   mps_S_create           the set, and what else it is given, are kept alive; a definition NULL is
 *                          the defaults where there is one for all; on an error nothing has changed
 *   mps_S_destroy          destroys and nulls; accepts NULL
 *   mps_S_particles, mps_S_context   lent, as long as the solver lives; NULL for NULL
 *   mps_S_get_def          the definition as the solver has completed it
 *   mps_S_set_material     (solver, material, count, ids): what particles are made of, NULL with
 *                          count 0 all of them; a law that the solver does not have is
 *                          MPS_ERROR_UNSUPPORTED. Densities are the field `density`
 *   mps_S_add_boundary, mps_S_add_load   copies lists, keeps signals alive, gives a number (into
 *                          `number`, which may be NULL)
 *   mps_S_set_boundary, mps_S_set_load, mps_S_remove_boundary, mps_S_remove_load
 *                          by that number; MPS_ERROR_ARGUMENT where there is none of it
 *   mps_S_add_contact      with a rigid body, a handle (mps/contact.h): WLS-MPM and the fluid.
 *                          Explicit dynamics and implicit elasticity have no contact: a body
 *                          drives their particles as a boundary of the kind DRIVEN
 *   mps_S_get_reaction     what a boundary exerts (mps_reaction)
 *   mps_S_step, mps_S_run  call the cancel hook: MPS_ERROR_CANCELLED, between two steps
 *   mps_S_time, mps_S_dt, mps_S_limit   s, 0 for NULL; mps_S_steps: taken so far, 0 for NULL
 *   mps_S_get_totals       sums over the particles (mps_totals)
 *   mps_S_save, mps_S_restore (files); mps_S_snapshot, mps_S_rollback (memory)
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

#include "base.h"

MPS_EXTERN_C_BEGIN

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

/** Force, impulse and work of a boundary, contact or body. Of a boundary: on its particles. Of a
 *  contact or a body: on the body, by the particles. Forces and moments are means over the last
 *  step; before the first step all is 0. */
typedef struct mps_reaction {
  double force[3];          /* N */
  double moment[3];         /* N m, about the origin; of a body, about its reference point */
  double impulse[3];        /* N s, since the boundary, contact or body was made */
  double moment_impulse[3]; /* N m s, likewise; of a body about its reference point as it moved */
  int64_t count;            /* particles (or nodes) constrained or in contact in the last step */
  double work;     /* J, likewise: done on the particles by this boundary, contact or body */
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
  double impulse_scheme[3]; /* N s, since creation; of the fluid, else 0: momentum that the scheme
                               gives to the particles without a reaction on a boundary or body */
} mps_totals;

/** The state of a solver, in memory: filled by mps_S_snapshot, restored bit for bit by
 *  mps_S_rollback, so that a step can be repeated with other loads (implicit coupling). The fields
 *  of the set are part of it, `external_force` too; definitions of boundaries and loads, signals
 *  and materials are not: they keep their present state. It belongs to the solver that filled it;
 *  filling it again reuses its memory. */
typedef struct mps_snapshot mps_snapshot;
/** Frees and nulls; accepts NULL. A snapshot may outlive its solver, and has no use then. */
MPS_API void mps_snapshot_destroy(mps_snapshot **snapshot);

MPS_EXTERN_C_END
#endif
