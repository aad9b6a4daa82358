/* mps/contact.h - the contact of one solver with one rigid body: friction, stiffness, reactions by
 * part of the surface, and the particles in contact. By impulses at the surface
 * (docs/theory/contact.md), or by penalty springs at the particles (Nakamura 5).
 *
 * A solver makes it (mps_mpm_add_contact, mps_fluid_add_contact, which has a definition of its
 * own). A body may be in contact with several solvers at once; it receives the sum of their forces.
 * One of the solvers advances it, or the caller by mps_body_advance (`mover`).
 *
 * The handle is the caller's; destroying it ends the contact. When the solver is destroyed first,
 * the contact has ended, and its queries return their last values. Thread rule: as of its solver.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_CONTACT_H
#define LIBMPS_CONTACT_H

#include "body.h"
#include "signal.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_contact mps_contact;

/** Which object moves the body: of all solvers. */
typedef enum mps_contact_mover {
  MPS_CONTACT_MOVER_SOLVER = 0, /* this solver, at the end of each of its steps */
  MPS_CONTACT_MOVER_OTHER = 1   /* another solver, or the caller by mps_body_advance */
} mps_contact_mover;

/** Treatment of particles whose centres lie inside the body when the contact is made. By impulses
 *  also of those that only reach into it then, nearer to it than `offset`: with PUSH they are moved
 *  out, the faster the stiffer they are, else they bear where they are until they have come off, or
 *  come out as they slide along the surface, over a spacing. */
typedef enum mps_contact_inside {
  MPS_CONTACT_INSIDE_REFUSE = 0, /* MPS_ERROR_ARGUMENT, with their number */
  MPS_CONTACT_INSIDE_PUSH = 1,   /* they stay, and the contact moves them out: a twentieth of the
                                    overlap in each step, or with the contact stiffness */
  MPS_CONTACT_INSIDE_REMOVE =
      2 /* removed now, and before each step when deeper than `depth`; the reaction counts them */
} mps_contact_inside;

/** Method of contact. */
typedef enum mps_contact_method {
  MPS_CONTACT_METHOD_IMPULSE = 0, /* impulses at the surface, such that no particle enters it and
                                     Coulomb's law of friction holds; without a stiffness */
  MPS_CONTACT_METHOD_PENALTY = 1  /* Nakamura 5: springs at the particles (28), friction at the
                                     nodes (31)-(34) */
} mps_contact_method;

typedef struct mps_contact_def {
  uint32_t struct_size;
  int32_t mover;  /* mps_contact_mover, default SOLVER */
  int32_t method; /* mps_contact_method, default IMPULSE */
  int32_t
      sweeps; /* Gauss-Seidel sweeps over the contacts of a step, 1 to 100000, by METHOD_IMPULSE;
                 0 (default): 10, with a tolerance at most 30. Each step is warm-started from
                 the last impulses; the solver makes the largest number of all its contacts */
  double friction; /* Coulomb's mu, 0 to 1e3; default 0. Where water presses in the pores, of
                      the effective normal stress; by METHOD_PENALTY of the total one, and a warning
                      says so */
  double penalty;  /* for METHOD_PENALTY: contact stiffness k of Nakamura (28), N/m (2D: per m of
                      thickness; in axisymmetry per m of radius and rad, times the particle's
                      radius), > 0; NaN (default): from xi, or where that is NaN too 1.33 (K + 4G/3)
                      of the particle's material, in 3D times the particles' spacing */
  double xi;       /* in (0, 1): k from Nakamura (58), 2 (1 - xi) (K + 4G/3)/(n CFL^2) with n
                      particles a cell, in 3D times the cell's size; n and CFL are those of the
                      solver's definition. NaN (default): not used. Giving both is an error */
  double offset; /* m, >= 0: half the size of a particle, which is in contact where it is nearer to
                    the surface; by impulses it changes with the particle's elastic strain across
                    the surface. NaN (default): half the particles' spacing */
  double depth;  /* m, > 0: a step that finds a particle deeper below the surface than this fails
                    before anything moves.
                    NaN (default): one cell; with INSIDE_PUSH unbounded; with INSIDE_REMOVE,
                    where such particles are removed instead, half the particles' spacing */
  int32_t thin;  /* for METHOD_PENALTY, where momentum passes through a body thinner than two cells:
                    0 (default): MPS_ERROR_ARGUMENT; 1: allowed, with a warning. With METHOD_IMPULSE
                    such a body separates its sides, unless the solver has a penalty contact too */
  int32_t inside;   /* mps_contact_inside, default REFUSE */
  double adhesion;  /* Pa, a >= 0: the shear limit is a + mu p where the pressure p is above 0;
                       default 0 */
  double strength;  /* Pa, > 0: upper bound of its shear stress, such as alpha times the undrained
                       strength of clay; NaN (default): no bound. Both by METHOD_IMPULSE, over the
                       area that soil covers, which on curved surfaces is short where the spacing is
                       more than half a cell, with a warning (docs/limits.md) */
  double corner;    /* m, >= 0: radius by which edges and corners of the body are rounded for the
                       particles, so that the grid resolves the flow of soil around them; less than
                       half of the body's thinnest wall. 0 (default): not at all. Not for
                       METHOD_PENALTY */
  double tolerance; /* in [0, 1): sweeps end once the relative l2 change of the impulses, the
                       maximum over blocks of cells, is below this; tested after sweeps 10, 14, 18,
                       ... (one reduction each on ranks). 0, NaN (default): all sweeps are made. The
                       solver uses the least of its contacts; mps_mpm_get_report reports the change
                       of the last sweep */
  mps_signal *friction_factor; /* times `friction` at the beginning of each step, kept alive: a
                                  number in time (MPS_SIGNAL_QUANTITY_VALUE), >= 0, or the step
                                  is MPS_ERROR_ARGUMENT. NULL (default): 1 */
  double inset; /* m, >= 0: how far before the edges of a polygon its faces end for the particles,
                   so that the ground feels a face as wide as the edges say, wherever these lie on
                   the grid: 0.6 cells in clay, 0.75 to 0.9 in sand. Particles beyond are moved out
                   of the body without a force. 0 (default): not at all. In the plane and in
                   axisymmetry; not for METHOD_PENALTY, nor with `corner` */
} mps_contact_def;

static inline mps_contact_def mps_contact_defaults(void) {
  mps_contact_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_CONTACT, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Ends the contact, releases the handle and nulls it; accepts NULL. In a callback of the solver it
 *  only records MPS_ERROR_STATE. In an open step of a fluid (mps_fluid_begin_step) the body stays
 *  in the water until that step is ended or abandoned. */
MPS_API void mps_contact_destroy(mps_contact **contact);

/** The definition in use, to `out` of `size` bytes, of `kind`: MPS_DEF_CONTACT in WLS-MPM, with
 *  members that were NaN or 0 as completed, MPS_DEF_FLUID_CONTACT in a fluid. MPS_ERROR_ARGUMENT:
 *  NULL, the kind of another solver, a `size` unknown to this library; MPS_ERROR_STATE: a fluid's
 *  contact that has ended. */
MPS_API MPS_NODISCARD mps_status mps_contact_get_def(const mps_contact *contact, int32_t kind,
                                                     void *out, size_t size);
/** Reaction of the particles of this solver on part `part` of the body (mps_body_find_part), or on
 *  all of it (-1); `work` is that of the body's surface on the particles. MPS_ERROR_ARGUMENT: no
 *  part of that number, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_contact_get_reaction_sized(const mps_contact *contact,
                                                                int32_t part, mps_reaction *out,
                                                                size_t size);
static inline mps_status mps_contact_get_reaction(const mps_contact *contact, int32_t part,
                                                  mps_reaction *out) {
  return mps_contact_get_reaction_sized(contact, part, out, sizeof *out);
}

/** Particles in contact with the body, in the set's order: `count` receives their number; at most
 *  `capacity` (>= 0) of them are written. METHOD_IMPULSE: those with an impulse in the last step;
 *  METHOD_PENALTY: those nearer than `offset` at the present positions. Each array may be NULL:
 *  `ids`; `gap` (m: the surface's present distance less half the particle's size); `normal` (3
 *  values a particle, outward unit vector of the surface); `force` (N, 3 values a particle, on the
 *  particle: normal force and friction in the last step; by the penalty the present normal force);
 *  `foot` (m, 3 values a particle, nearest point of the surface). The distribution of force between
 *  neighbours may be uneven: only its sum is determined. Takes time in proportion to the number of
 *  particles. MPS_ERROR_ARGUMENT: `capacity` below 0; MPS_ERROR_STATE: the contact has ended. */
MPS_API MPS_NODISCARD mps_status mps_contact_get_particles(const mps_contact *contact,
                                                           int64_t capacity, int64_t *count,
                                                           int64_t *ids, double *gap,
                                                           double *normal, double *force,
                                                           double *foot);

MPS_EXTERN_C_END
#endif
