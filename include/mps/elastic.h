/* mps/elastic.h - implicit particle elasticity for thick structures (Chikazawa, sections 2 and 3):
 * plates, walls and cantilevers of any lattice shape in 2D (plane stress or strain) and 3D, of one
 * or several materials, under forces, tractions, pressures and prescribed displacements. Small
 * displacements; the sparse symmetric system is solved by CHOLMOD, or by conjugate gradients in a
 * limited memory. docs/elastic.md is the guide.
 *
 * Every particle is the centre of a lattice cell (a square or cube of the set's spacing), so free
 * surfaces lie half a spacing OUTSIDE the outer particles. Where a surface must pass THROUGH a
 * layer of particles (a fixed wall, a plane of symmetry) the cells of the layer are cut in half
 * with mps_elastic_cut.
 *
 * The solver reads the fields `young` (Pa, 1e-30 to 1e30), `poisson` (-0.99 <= nu < 0.5), for
 * motions `density` (kg/m3, 1e-30 to 1e30), and at every solution and step `external_force` (N)
 * where the set has it; it writes `displacement`, `reaction`, in motions `velocity` and
 * `acceleration`, and by mps_elastic_update_stress the stresses. Vectors have three components in
 * 2D too; the third is not read, and written as 0. In 2D all forces, masses and energies are those
 * of the `measure`.
 *
 * The set may be sorted while a solver uses it, and particles may be removed (mps_particles_remove:
 * excavation): the rest must be a connected body; boundaries and loads drop removed particles,
 * facets are renumbered, a motion ends. A rollback or restore restores removed particles. None can
 * be added.
 *
 * Thread rule: one thread at a time per context; the work is shared among the context's threads, of
 * BLAS and CHOLMOD too (docs/elastic.md). The cancel hook is called (MPS_ERROR_CANCELLED) before
 * the ordering, the analysis and the factorisation, which are not interrupted, every 64 iterations
 * of CG and before each step. Hooks, signals and callbacks may query the solver, not change it:
 * MPS_ERROR_STATE. A function without a solver (NULL) returns MPS_ERROR_ARGUMENT; in a libmps
 * without CHOLMOD all return MPS_ERROR_UNSUPPORTED. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_ELASTIC_H
#define LIBMPS_ELASTIC_H

#include "domain.h"
#include "io.h"
#include "kernel.h"
#include "material.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_elastic mps_elastic;

typedef enum mps_elastic_state {
  MPS_ELASTIC_STATE_PLANE_STRESS = 0, /* lambda = nu E / (1 - nu^2) */
  MPS_ELASTIC_STATE_PLANE_STRAIN = 1  /* lambda = nu E / ((1 + nu)(1 - 2 nu)), as in 3D */
} mps_elastic_state;

typedef enum mps_elastic_solver {
  MPS_ELASTIC_SOLVER_AUTO = 0, /* LLT where the factor fits `memory_limit`, else CG */
  MPS_ELASTIC_SOLVER_LLT = 1,  /* supernodal Cholesky */
  MPS_ELASTIC_SOLVER_LDLT = 2, /* simplicial LDL^T */
  MPS_ELASTIC_SOLVER_CG = 3 /* conjugate gradients with a symmetric Gauss-Seidel preconditioner */
} mps_elastic_solver;

typedef enum mps_elastic_ordering {
  MPS_ELASTIC_ORDERING_BEST = 0, /* AMD and METIS are compared, the smaller factor is kept */
  MPS_ELASTIC_ORDERING_AMD = 1,
  MPS_ELASTIC_ORDERING_METIS = 2
} mps_elastic_ordering;

typedef struct mps_elastic_def {
  uint32_t struct_size;
  int32_t state;       /* mps_elastic_state; 2D only */
  int32_t solver;      /* mps_elastic_solver */
  int32_t ordering;    /* mps_elastic_ordering */
  double radius_ratio; /* re / spacing of the stabilising pairs, in (1, 4]; NaN (default): 1.5 */
  double alpha;        /* weight of the stabilising pairs, in [0.03, 100]; default and NaN: 1 */
  double measure;      /* 2D: thickness, m, 1e-30 to 1e30; default and NaN: 1. Not read in 3D */
  double memory_limit; /* bytes the factor may take, >= 0; NaN (default): no limit */
  double tolerance; /* CG: |residual| / |load| to reach, in [1e-14, 1e-2]; default and NaN: 1e-10 */
  int64_t iterations;  /* CG: most iterations; 0 (default): ten times the unknowns */
  int32_t refinements; /* steps of iterative refinement after a direct solution, 0..10; default 1 */
  int32_t blas_threads;   /* most threads of BLAS, up to 1024; 0 (default): the context's. LLT gives
                             the same bits for the same number only; all other results are the same
                             for every number */
  mps_material *material; /* linear elastic, of all; NULL (default): the fields'. Kept alive */
  mps_kernel *kernel;     /* weight of the pairs, its radius in (1, 4] spacings, in place of
                             radius_ratio; kept alive; NULL (default): re/r - 1 */
  double bending; /* [0, 1], of a cell's own stiffness against bending, without which n cells lack
                     1/n^2; NaN (default): 1 in bodies of several materials, 0 of a single one,
                     with a warning in the log where slender parts have at most 8 cells */
  mps_domain *domain; /* ranks that solve together: mps/elastic_solver.h; NULL (default): none */
} mps_elastic_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_elastic_def_init(mps_elastic_def *def, size_t size);
static inline mps_elastic_def mps_elastic_defaults(void) {
  mps_elastic_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the particles of `particles`, which must lie on a lattice of the set's
 *  spacing (any origin), each with a neighbour along every axis. Reads `young` and `poisson`. `def`
 *  NULL: defaults. On an error the set is as before. MPS_ERROR_ARGUMENT: a member of `def`, a
 *  modulus or the lattice is not allowed; MPS_ERROR_FIELD: no `young` or `poisson`;
 *  MPS_ERROR_STATE: another solver holds the set; MPS_ERROR_UNSUPPORTED: no CHOLMOD;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                                                    const mps_elastic_def *def, mps_elastic **out);
/** Destroys and nulls; accepts NULL. In a callback of the solver it only records MPS_ERROR_STATE.
 *  */
MPS_API void mps_elastic_destroy(mps_elastic **e);
/** The definition of the solver, with its defaults completed. MPS_ERROR_ARGUMENT: NULL, or a `size`
 *  unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_def_sized(const mps_elastic *e,
                                                           mps_elastic_def *out, size_t size);
static inline mps_status mps_elastic_get_def(const mps_elastic *e, mps_elastic_def *out) {
  return mps_elastic_get_def_sized(e, out, sizeof *out);
}
/** The set; NULL for NULL. Lent: it lives at least as long as the solver. */
MPS_API mps_particles *mps_elastic_particles(const mps_elastic *e);
/** The context; NULL for NULL. Lent: it lives at least as long as the solver. */
MPS_API mps_context *mps_elastic_context(const mps_elastic *e);

/** Reads `young` and `poisson` again after the caller has changed them; on an error the former ones
 *  stay. The symbolic factorisation is kept where joints are on the same faces. MPS_ERROR_ARGUMENT:
 *  a modulus out of range; MPS_ERROR_STATE: a callback of the solver is running, or a field is
 *  being edited; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_update_material(mps_elastic *e);

/** Assigns a material to the particles `ids` (NULL with count 0: all): writes `young` and
 *  `poisson`, then as mps_elastic_update_material, also for errors. MPS_ERROR_UNSUPPORTED: not
 *  linear elastic. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_material(mps_elastic *e,
                                                          const mps_material *material,
                                                          int64_t count, const int64_t *ids);

/** The surface passes through these particles: the half of their cells on `side` (-1 or +1) of
 *  `axis` does not belong to the body. Ends a motion under way. Loads on facets set before keep
 *  their areas. MPS_ERROR_ARGUMENT: `axis`, `side` or an id is not allowed; MPS_ERROR_STATE: a
 *  particle has a neighbour on that side, or as mps_elastic_update_material. */
MPS_API MPS_NODISCARD mps_status mps_elastic_cut(mps_elastic *e, int32_t axis, int32_t side,
                                                 int64_t count, const int64_t *ids);

/* ---- boundaries ------------------------------------------------------------------------------ */
/* Kinds (mps_boundary_kind): HELD, the components `dofs` of the displacement are 0. DRIVEN, they
 * are given by `values` and signals. ROLLER, the displacement along `normal` is prescribed, the
 * others are free. */

/** Displacements prescribed on some particles: those of `values`, plus factor times the signal's
 *  displacement; in motions the signal's velocity and acceleration too. */
typedef struct mps_elastic_boundary_def {
  uint32_t struct_size;
  int32_t kind;              /* mps_boundary_kind: HELD (default), DRIVEN or ROLLER */
  const int64_t *ids;        /* `id_count` particles, copied; NULL (default): those of the box */
  int64_t id_count;          /* 0 with a box */
  double lower[3], upper[3]; /* m, bounds included, of the particles' centres; infinities are
                                allowed; NaN (default): the list */
  uint32_t dofs;             /* HELD, DRIVEN: MPS_DOF_X, Y, Z, or-ed; 0 (default): all */
  int32_t reserved;
  double normal[3];      /* ROLLER: any length > 0 */
  const double *values;  /* m, copied: DRIVEN 3 a particle of `ids`, ROLLER 1; NULL: 0 */
  mps_signal *signal[3]; /* kept alive; by component, not of HELD; ROLLER: [0], along `normal`;
                            NULL: at rest */
  double factor[3];      /* finite, default 1 */
} mps_elastic_boundary_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_elastic_boundary_def_init(mps_elastic_boundary_def *def, size_t size);
static inline mps_elastic_boundary_def mps_elastic_boundary_defaults(void) {
  mps_elastic_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_boundary_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a boundary; `number` (may be NULL) receives the lowest free number, from 0. Where two fix
 *  the same direction of a particle, the one with the higher number prevails. MPS_ERROR_ARGUMENT: a
 *  member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a direction is fixed already by
 *  two or three others of that particle, or as mps_elastic_update_material; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_boundary(mps_elastic *e,
                                                          const mps_elastic_boundary_def *def,
                                                          int32_t *number);
/** Gives a boundary another definition; its impulse and work are kept. With the same directions the
 *  factor of the matrix is kept. MPS_ERROR_ARGUMENT: no boundary `number`; otherwise errors as
 *  mps_elastic_add_boundary. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_boundary(mps_elastic *e, int32_t number,
                                                          const mps_elastic_boundary_def *def);
/** Removes boundary `number`. MPS_ERROR_ARGUMENT: no boundary of that number; MPS_ERROR_STATE: as
 *  mps_elastic_update_material. */
MPS_API MPS_NODISCARD mps_status mps_elastic_remove_boundary(mps_elastic *e, int32_t number);
/** Force and moment of the boundary on its particles, of the last solution or at the end of the
 *  last step; impulse and work since the motion began. By particles: the field `reaction`.
 *  MPS_ERROR_ARGUMENT: no boundary `number`, NULL, or a `size` unknown to this library. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_reaction_sized(const mps_elastic *e,
                                                                int32_t number, mps_reaction *out,
                                                                size_t size);
static inline mps_status mps_elastic_get_reaction(const mps_elastic *e, int32_t number,
                                                  mps_reaction *out) {
  return mps_elastic_get_reaction_sized(e, number, out, sizeof *out);
}

/* ---- facets ---------------------------------------------------------------------------------- */
/** Number of facets: the surface consists of the faces of cells without a neighbour there, numbered
 *  from 0, again after a removal. 0 for NULL. */
MPS_API int64_t mps_elastic_facet_count(const mps_elastic *e);
/** Facets with outward normal `side` * `axis` (side 0: every facet) whose centre lies in the box
 *  [lo, hi] (dim values, infinities allowed; NULL: everywhere), ascending. Writes at most
 *  `capacity` of them to `facets` (may be NULL when capacity is 0); `count` receives their number.
 *  MPS_ERROR_ARGUMENT: `axis`, `side`, `capacity` or the box is not allowed. */
MPS_API MPS_NODISCARD mps_status mps_elastic_select_facets(const mps_elastic *e, int32_t axis,
                                                           int32_t side, const double *lo,
                                                           const double *hi, int64_t capacity,
                                                           int64_t *count, int64_t *facets);
/** Arrays that receive the properties of facets; each may be NULL. */
typedef struct mps_elastic_facet_arrays {
  int64_t *particle;    /* id */
  double *centre;       /* m, 3 a facet: in the unstrained body */
  double *normal;       /* 3: outward */
  double *extent;       /* m, 3: edge lengths, 0 along the normal and along z in 2D */
  double *area;         /* m2, of the measure */
  double *displacement; /* m, 3: at the centre */
  double *velocity;     /* m/s, 3: at the centre; 0 without a motion */
} mps_elastic_facet_arrays;
/** Properties of `count` facets, or of all (facets NULL, count mps_elastic_facet_count).
 *  MPS_ERROR_ARGUMENT: a facet or `count` out of range; MPS_ERROR_STATE: a step is running;
 *  MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status
mps_elastic_get_facets_sized(const mps_elastic *e, int64_t count, const int64_t *facets,
                             const mps_elastic_facet_arrays *arrays, size_t size);
static inline mps_status mps_elastic_get_facets(const mps_elastic *e, int64_t count,
                                                const int64_t *facets,
                                                const mps_elastic_facet_arrays *arrays) {
  return mps_elastic_get_facets_sized(e, count, facets, arrays, sizeof *arrays);
}

/* ---- loads; forces that another code computes may go to the field `external_force` instead --- */

typedef enum mps_elastic_load_kind {
  MPS_ELASTIC_LOAD_BODY = 0,     /* `force` per volume (N/m3) on the whole body */
  MPS_ELASTIC_LOAD_GRAVITY = 1,  /* `force` per mass (m/s2) on the whole body; reads `density` */
  MPS_ELASTIC_LOAD_FORCE = 2,    /* force (N) on each particle of `ids` */
  MPS_ELASTIC_LOAD_TRACTION = 3, /* traction (Pa) on each facet of `ids`, with its first moment */
  MPS_ELASTIC_LOAD_PRESSURE = 4, /* pressure (Pa, inwards) on each facet of `ids` */
  MPS_ELASTIC_LOAD_FUNCTION = 5  /* traction by `function`, integrated by 3 Gauss points an edge */
} mps_elastic_load_kind;

/** Traction (dim values, Pa, 0 on entry) at the surface point x (dim values, m) with outward
 *  normal. A status other than MPS_OK ends the call, which returns it. */
typedef mps_status (*mps_elastic_traction_fn)(void *user, const double *x, const double *normal,
                                              double *traction);

typedef struct mps_elastic_load_def {
  uint32_t struct_size;
  int32_t kind;       /* mps_elastic_load_kind, default BODY */
  const int64_t *ids; /* particles or facets, read by the call */
  int64_t id_count;
  const double *values; /* read by the call: 3 a particle or facet, PRESSURE 1; NULL: `force`,
                           PRESSURE force[0], for each */
  double force[3];      /* as the kind says; finite, default 0 */
  mps_elastic_traction_fn function; /* FUNCTION: called within this call only */
  void *user;
  mps_signal *signal[3]; /* by component, PRESSURE signal[0]: its displacement, as a number, at the
                            time of the solution or at the end of the step; NULL (default): 1. Kept
                            alive */
  double factor[3];      /* finite, default 1 */
} mps_elastic_load_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_elastic_load_def_init(mps_elastic_load_def *def, size_t size);
static inline mps_elastic_load_def mps_elastic_load_defaults(void) {
  mps_elastic_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_load_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load to the others; `number` (may be NULL) receives the lowest free number, from 0. Where
 *  all loads together exceed 1e150 N on a particle, functions that sum them return
 *  MPS_ERROR_NUMERIC. MPS_ERROR_ARGUMENT: a member of `def` out of range, or an unknown id or
 *  facet; MPS_ERROR_FIELD: GRAVITY without a field `density`; MPS_ERROR_STATE: as
 *  mps_elastic_update_material; MPS_ERROR_MEMORY; or the status of `function`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_load(mps_elastic *e,
                                                      const mps_elastic_load_def *def,
                                                      int32_t *number);
/** Gives load `number` another definition, if need be in every step; allocates nothing when the
 *  list is not longer. MPS_ERROR_ARGUMENT: no load `number`; otherwise errors as
 *  mps_elastic_add_load. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_load(mps_elastic *e, int32_t number,
                                                      const mps_elastic_load_def *def);
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: as
 *  mps_elastic_update_material. */
MPS_API MPS_NODISCARD mps_status mps_elastic_remove_load(mps_elastic *e, int32_t number);
/** Resultant of the present loads and of `external_force`: force (3 values, N) and moment (3, N m,
 *  about `about`, 3 values, NULL: the origin). Either may be NULL. MPS_ERROR_ARGUMENT: `about` or
 *  an `external_force` is not finite; MPS_ERROR_NUMERIC: the sums are too large; MPS_ERROR_STATE:
 *  as mps_elastic_update_material; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_load_resultant(const mps_elastic *e,
                                                                const double *about, double *force,
                                                                double *moment);

/* ---- statics --------------------------------------------------------------------------------- */
/** Size and cost of the solution, from the symbolic analysis. */
typedef struct mps_elastic_estimate {
  int64_t unknowns, matrix_nonzeros; /* of the lower triangle; on ranks, of this one's rows */
  int64_t factor_nonzeros;           /* of L */
  double factor_flops, factor_bytes;
  int32_t ordering, solver; /* mps_elastic_ordering and mps_elastic_solver that will be used */
} mps_elastic_estimate;

/** Orders and analyses the matrix (kept for the solution). MPS_ERROR_STATE: the boundaries leave
 *  rigid motions free, which the message names; MPS_ERROR_UNSUPPORTED: a factor beyond CHOLMOD's
 *  integers; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_analyse_sized(mps_elastic *e,
                                                           mps_elastic_estimate *out, size_t size);
static inline mps_status mps_elastic_analyse(mps_elastic *e, mps_elastic_estimate *out) {
  return mps_elastic_analyse_sized(e, out, sizeof *out);
}

/** Solves for the loads and boundaries at the present time; writes `displacement` and `reaction`
 *  (N, force of the boundaries on the particle). The factor is kept: it is made again only when
 *  boundaries, cuts or material have changed. Ends a motion under way. On an error nothing has
 *  changed: MPS_ERROR_STATE, the boundaries leave rigid motions free, or as
 *  mps_elastic_update_material; MPS_ERROR_NUMERIC, a singular matrix, CG without convergence, or
 *  values too large; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve(mps_elastic *e);
/** Solves for `count` load cases at once with the present boundaries. loads[(k * n + i) * 3 + c] is
 *  the force (N) of case k on particle i of the set's present order, displacements likewise (m). No
 *  field is written. MPS_ERROR_ARGUMENT: `count` below 0, or a load that is not finite; otherwise
 *  MPS_ERROR_STATE and the other errors of mps_elastic_solve. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve_cases(mps_elastic *e, int64_t count,
                                                         const double *loads,
                                                         double *displacements);

/** Statistics of the last solution. */
typedef struct mps_elastic_report {
  int64_t unknowns, matrix_nonzeros, factor_nonzeros;
  double factor_flops;
  double factor_bytes; /* of the numerical factor; CG: of matrix and vectors */
  double peak_bytes;   /* largest memory of CHOLMOD */
  double residual;     /* |K u - F| / |F| over the free unknowns, after refinement */
  double condition;    /* crude lower estimate of the condition number; CG: 0 */
  double seconds_assemble, seconds_analyse, seconds_factor, seconds_solve;
  int64_t analyses, factorisations; /* since creation */
  int64_t iterations;               /* CG */
  int32_t solver, ordering;         /* mps_elastic_solver and mps_elastic_ordering used */
} mps_elastic_report;

/** Statistics of the last solution. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library.
 *  */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_report_sized(const mps_elastic *e,
                                                              mps_elastic_report *out, size_t size);
static inline mps_status mps_elastic_get_report(const mps_elastic *e, mps_elastic_report *out) {
  return mps_elastic_get_report_sized(e, out, sizeof *out);
}

/** Writes strain and stress of the present displacement to the fields `strain` and `stress`
 *  (components xx, yy, zz, xy and in 3D zx, yz; shear strain is tensorial), the principal stresses,
 *  largest first, to `principal`, and the von Mises stress to `von_mises`. MPS_ERROR_FIELD: one of
 *  these fields has another shape; MPS_ERROR_STATE: a step is running; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_update_stress(mps_elastic *e);
/** Force (3 values, N) and moment (3, N m, about `about`, 3 values, NULL: origin) that the part of
 *  the body with x[axis] > position exerts on the rest, from the static balance of the rest's
 *  particles: normal force N, shear Q and bending moment M of the section. MPS_ERROR_ARGUMENT:
 *  `axis` out of range, `position` or `about` not finite; MPS_ERROR_STATE: a step is running. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_section(const mps_elastic *e, int32_t axis,
                                                         double position, const double *about,
                                                         double *force, double *moment);
/** Present strain energy (J); `stabilising` (may be NULL) receives the part of the stabilising
 *  pairs. MPS_ERROR_ARGUMENT: NULL; MPS_ERROR_STATE: a step is running. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_energy(const mps_elastic *e, double *strain,
                                                        double *stabilising);
/** Sums over the body: since the motion began, or of the last static solution, taken as loaded
 *  proportionally from rest, so that the work of the loads is half of load times displacement.
 *  Works in a step are means of the forces before and after it times the displacement, plus the
 *  kinetic energy that driven particles gain; the budget of mps/solver.h closes to rounding
 *  (1e-10). `dissipated` is that of Rayleigh damping and `scheme`. With Newmark's average
 *  acceleration, and in statics, `scheme` is the work of the forces that solutions leave
 *  unbalanced: of conjugate gradients and foreign solvers, of |residual| up to `tolerance` times
 *  that of the step's equations; of direct ones rounding, at most 1e-14 C of the largest term of
 *  the budget, where C is the greatest Young's modulus (times 1 + 2 stiffness_damping/dt) over the
 *  lesser of the least one and 4 density spacing^2 / dt^2 (above a ratio of moduli of 1e8 a warning
 *  says so). For other members of the family it is the numerical dissipation, computed as the
 *  remainder of the budget. MPS_ERROR_ARGUMENT: NULL, or a `size` unknown to this library;
 *  MPS_ERROR_STATE: a step is running. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_totals_sized(const mps_elastic *e, mps_totals *out,
                                                              size_t size);
static inline mps_status mps_elastic_get_totals(const mps_elastic *e, mps_totals *out) {
  return mps_elastic_get_totals_sized(e, out, sizeof *out);
}

MPS_EXTERN_C_END

#include "elastic_motion.h"

#endif
