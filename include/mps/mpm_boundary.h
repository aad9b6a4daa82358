/* mps/mpm_boundary.h - boundaries and loads of WLS-MPM: sides of the domain, boxes of nodes, lists
 * of particles; tractions and accelerations.
 *
 * Thread rule: as mps/mpm.h, which includes this header.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_MPM_BOUNDARY_H
#define LIBMPS_MPM_BOUNDARY_H

#include "mpm.h"

MPS_EXTERN_C_BEGIN

/* ---- boundaries ------------------------------------------------------------------------------
 * A boundary constrains nodes of a side of the domain or of a box, or particles. Each finite side
 * of the domain is initially a roller, with the number of that side below (0 to 5); sides are set
 * and removed as other boundaries. Added boundaries have numbers from 6. Nodes do not move; a
 * boundary prescribes their velocity: `factor` times that of the signal at the middle of the step,
 * NULL being rest.
 *
 * A side acts on its nodes, and so on particles nearer than the spline reaches (1.5 or 2 cells).
 * Where several boundaries constrain one node, fixed sides act after other sides, then boxes in the
 * order of their numbers, then particles: the last prevails. */

typedef enum mps_mpm_side {
  MPS_MPM_SIDE_X_LOWER = 0, /* 2 axis + upper */
  MPS_MPM_SIDE_X_UPPER = 1,
  MPS_MPM_SIDE_Y_LOWER = 2,
  MPS_MPM_SIDE_Y_UPPER = 3,
  MPS_MPM_SIDE_Z_LOWER = 4,
  MPS_MPM_SIDE_Z_UPPER = 5
} mps_mpm_side;

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
 *               column has the pore pressures of the particles that it was made of. Displacements
 *               across the side must stay below half a spacing. Not on several ranks or with the
 *               standard method, nor in mps_mpm_settle
 *   FREE        an edge of the grid without constraint
 *   OPEN        the same; particles that pass it are removed at the end of the step. The reaction's
 *               `removed` and `removed_mass` count them, its `count` those of the last step; its
 *               impulses and `work` are less the momentum and kinetic energy that they carry out
 *
 * The axis r = 0 may be ROLLER, HELD or DRIVEN along itself. */

typedef struct mps_mpm_boundary_def {
  uint32_t struct_size;
  int32_t kind;       /* mps_boundary_kind, default HELD */
  double lower[3];    /* m, a box of nodes: default +-infinity; */
  double upper[3];    /* in 2D the third value is not read */
  const int64_t *ids; /* `id_count` particles in place of a box, copied; NULL: a box */
  int64_t id_count;   /* 0 with a box or side */
  uint32_t dofs;      /* MPS_DOF_X, Y, Z or-ed, of boxes and particles; 0 (default): all */
  int32_t reserved;
  mps_signal *signal[3]; /* by component, kept alive, not of HELD; NULL: at rest. Of a roller the
                            one across */
  double factor[3];      /* default 1 */
  double friction;       /* Coulomb's mu of FRICTIONAL, >= 0; default 0 */
  double settle; /* s, >= 0: duration in which an ABSORBING side is held, and over which R is the
                    mean traction. 0 (default): R balances the other forces at the nodes in the
                    first step. On the grid, stress and gravity that balance in theory leave up to a
                    percent unbalanced; without settling, the dashpots move under that */
} mps_mpm_boundary_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_mpm_boundary_def_init(mps_mpm_boundary_def *def, size_t size);
static inline mps_mpm_boundary_def mps_mpm_boundary_defaults(void) {
  mps_mpm_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_mpm_boundary_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a box of nodes or a list of particles; `number` (may be NULL) receives the lowest free
 *  number from 6. MPS_ERROR_ARGUMENT: a member of `def` out of range, or an unknown id;
 *  MPS_ERROR_STATE: a callback of the solver is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_boundary(mps_mpm *mpm, const mps_mpm_boundary_def *def,
                                                      int32_t *number);
/** Gives boundary `number` another definition, from the next step on; its impulse and work are
 *  kept. An absorbing side determines its R again. MPS_ERROR_ARGUMENT: no boundary `number`, a side
 *  that the domain does not have, or a member of `def` out of range; MPS_ERROR_STATE: a callback of
 *  the solver is running, or a free-field side is set and new particles have no density or
 *  mps_mpm_settle was cancelled; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_boundary(mps_mpm *mpm, int32_t number,
                                                      const mps_mpm_boundary_def *def);
/** Removes a boundary: its nodes or particles are free; a side becomes FREE. MPS_ERROR_ARGUMENT: no
 *  boundary `number`, or the axis; MPS_ERROR_STATE: a callback of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_mpm_remove_boundary(mps_mpm *mpm, int32_t number);
/** Force, impulse and work of boundary `number` on the particles. MPS_ERROR_ARGUMENT: no boundary
 *  `number`, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_mpm_get_reaction_sized(const mps_mpm *mpm, int32_t number,
                                                            mps_reaction *out, size_t size);
static inline mps_status mps_mpm_get_reaction(const mps_mpm *mpm, int32_t number,
                                              mps_reaction *out) {
  return mps_mpm_get_reaction_sized(mpm, number, out, sizeof *out);
}
/** Shorthand: the side `side` of the domain gets `kind`, at rest, with `friction`. */
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
  int32_t reserved;
  const int64_t *ids; /* `id_count` (>= 1) particles, copied */
  int64_t id_count;
  const double
      *area; /* m2, one a particle, finite, copied; of the measure. NULL: the spacing to the
                power dim - 1 times the measure, in axisymmetry times the present radius */
  double traction[3]; /* Pa, finite: the force on a particle is area * traction */
  mps_signal
      *signal[3];   /* by component, its value (displacement) at the beginning of the step times
                       `factor` multiplies the traction; NULL: `factor` does. Kept alive */
  double factor[3]; /* default 1 */
} mps_mpm_load_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_mpm_load_def_init(mps_mpm_load_def *def, size_t size);
static inline mps_mpm_load_def mps_mpm_load_defaults(void) {
  mps_mpm_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_mpm_load_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}
/** Adds a load; `number` (may be NULL) receives the lowest free number from 0. MPS_ERROR_ARGUMENT:
 *  a member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a callback of the solver is
 *  running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_mpm_add_load(mps_mpm *mpm, const mps_mpm_load_def *def,
                                                  int32_t *number);
/** Gives load `number` another definition; with ids NULL and id_count 0 it keeps its particles and
 *  areas. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors as mps_mpm_add_load. */
MPS_API MPS_NODISCARD mps_status mps_mpm_set_load(mps_mpm *mpm, int32_t number,
                                                  const mps_mpm_load_def *def);
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: a callback
 *  of the solver is running. */
MPS_API MPS_NODISCARD mps_status mps_mpm_remove_load(mps_mpm *mpm, int32_t number);

MPS_EXTERN_C_END
#endif
