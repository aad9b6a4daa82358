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
 * motions `density` (kg/m3, 1e-30 to 1e30), `young` and `poisson` again before the next solution or
 * step after they have been edited, and at every solution and step `external_force` (N) where the
 * set has it; it writes `displacement`, `reaction`, in motions `velocity` and
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

#include "io.h"
#include "kernel.h"
#include "material.h"
#include "signal.h"
#include "solver.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_elastic mps_elastic;
/** The solver as one of all kinds (mps/solver.h), for the functions that all have; NULL for NULL.
 * It is the same object: `elastic` or this is destroyed, not both. */
MPS_API mps_solver *mps_elastic_solver(const mps_elastic *elastic);

typedef enum mps_elastic_state {
  MPS_ELASTIC_STATE_PLANE_STRESS = 0, /* lambda = nu E / (1 - nu^2) */
  MPS_ELASTIC_STATE_PLANE_STRAIN = 1  /* lambda = nu E / ((1 + nu)(1 - 2 nu)), as in 3D */
} mps_elastic_state;

typedef enum mps_elastic_solver_kind {
  MPS_ELASTIC_SOLVER_AUTO = 0, /* LLT where the factor fits `memory_limit`, else CG. In 3D fewer than
                                  eight load cases at rest are solved by CG where that is faster,
                                  from some 5000 unknowns on in a compact body, by LLT where CG
                                  does not converge: for loads one after the other take LLT */
  MPS_ELASTIC_SOLVER_LLT = 1,  /* supernodal Cholesky */
  MPS_ELASTIC_SOLVER_LDLT = 2, /* simplicial LDL^T */
  MPS_ELASTIC_SOLVER_CG = 3, /* conjugate gradients with a symmetric Gauss-Seidel preconditioner */
  MPS_ELASTIC_SOLVER_FOREIGN = 4 /* of a report: a solver of the caller
                                    (mps/experimental/linear_solver.h) */
} mps_elastic_solver_kind;

typedef enum mps_elastic_ordering {
  MPS_ELASTIC_ORDERING_BEST = 0, /* AMD and METIS are compared, the smaller factor is kept */
  MPS_ELASTIC_ORDERING_AMD = 1,
  MPS_ELASTIC_ORDERING_METIS = 2
} mps_elastic_ordering;

typedef struct mps_elastic_def {
  uint32_t struct_size;
  int32_t state;       /* mps_elastic_state, 2D only; default PLANE_STRESS */
  int32_t solver;      /* mps_elastic_solver_kind, default AUTO */
  int32_t ordering;    /* mps_elastic_ordering, default BEST */
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
  double gravity[3];      /* m/s2, |g| at most 1e6, on all particles, by their `density`, which is
                             read where it is not 0; default 0 */
  mps_material *material; /* linear elastic, of all; NULL (default): the fields'. Kept alive */
  mps_kernel *kernel;     /* weight of the pairs, its radius in (1, 4] spacings, in place of
                             radius_ratio; kept alive; NULL (default): re/r - 1 */
  double bending; /* [0, 1], of a cell's own stiffness against bending, without which n cells lack
                     1/n^2; NaN (default): 1 in bodies of several materials, 0 of a single one,
                     with a warning in the log where slender parts have at most 8 cells */
  mps_domain *domain; /* ranks that solve together: mps/experimental/linear_solver.h; NULL
                         (default): none */
} mps_elastic_def;

static inline mps_elastic_def mps_elastic_defaults(void) {
  mps_elastic_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_ELASTIC, &def, sizeof def) != MPS_OK) def.struct_size = 0;
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
static inline void mps_elastic_destroy(mps_elastic **e) {
  mps_solver *solver = e ? mps_elastic_solver(*e) : NULL;
  mps_solver_destroy(&solver);
  if (e && !solver) *e = NULL;
}
/** The definition of the solver, with its defaults completed. MPS_ERROR_ARGUMENT: NULL, or a `size`
 *  unknown to this library. */
static inline mps_status mps_elastic_get_def(const mps_elastic *e, mps_elastic_def *out) {
  return mps_solver_get_def(mps_elastic_solver(e), MPS_DEF_ELASTIC, out, sizeof *out);
}
/** The set; NULL for NULL. Lent: it lives at least as long as the solver. */
static inline mps_particles *mps_elastic_particles(const mps_elastic *e) {
  return mps_solver_particles(mps_elastic_solver(e));
}
/** The context; NULL for NULL. Lent: it lives at least as long as the solver. */
static inline mps_context *mps_elastic_context(const mps_elastic *e) {
  return mps_solver_context(mps_elastic_solver(e));
}

/** Assigns a material to the particles `ids` (NULL with count 0: all): writes `young` and
 *  `poisson`. The symbolic factorisation is kept where joints are on the same faces. On an error
 *  nothing has changed. MPS_ERROR_UNSUPPORTED: not linear elastic; MPS_ERROR_ARGUMENT: a modulus
 * out of range, or an unknown id; MPS_ERROR_STATE: a callback of the solver is running, or a field
 * is being edited; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_material(mps_elastic *e,
                                                          const mps_material *material,
                                                          const int64_t *ids, int64_t count);

/** The surface passes through these particles: the half of their cells on `side` (mps_side) does
 *  not belong to the body. Ends a motion under way. Loads on facets set before keep
 *  their areas. MPS_ERROR_ARGUMENT: `side` or an id is not allowed; MPS_ERROR_STATE: a
 *  particle has a neighbour on that side, or as mps_elastic_set_material. */
MPS_API MPS_NODISCARD mps_status mps_elastic_cut(mps_elastic *e, int32_t side, const int64_t *ids,
                                                 int64_t count);

/* ---- boundaries ------------------------------------------------------------------------------ */
/* Kinds (mps_boundary_kind): HELD, the components `dofs` of the displacement are 0. DRIVEN, they
 * are given by `values` and signals. ROLLER, the displacement along `normal` is prescribed, the
 * others are free. */

/** Displacements prescribed on some particles: those of `values`, plus factor times the signal's
 *  displacement; in motions the signal's velocity and acceleration too. */
typedef struct mps_elastic_boundary_def {
  uint32_t struct_size;
  int32_t kind; /* mps_boundary_kind: HELD (default), DRIVEN or ROLLER */
  /* The particles: a list, or those whose centres lie in a box, or all (mps/solver.h). */
  const int64_t *ids; /* copied */
  int64_t id_count;
  double lower[3], upper[3]; /* m, bounds included; NaN (default): no bound */
  uint32_t dofs;             /* HELD, DRIVEN: MPS_DOF_X, Y, Z, or-ed; 0 (default): all */
  int32_t all;               /* 1: all particles; default 0 */
  double normal[3];          /* ROLLER: any length > 0 */
  const double *values;      /* m, copied: DRIVEN 3 a particle of `ids`, ROLLER 1; NULL: 0 */
  mps_signal *signal[3];     /* kept alive; by component, not of HELD; ROLLER: [0], along `normal`;
                                NULL: at rest */
  double factor[3];          /* finite, default 1 */
} mps_elastic_boundary_def;

static inline mps_elastic_boundary_def mps_elastic_boundary_defaults(void) {
  mps_elastic_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_ELASTIC_BOUNDARY, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a boundary; `number` (may be NULL) receives the lowest free number, from 0. Where two fix
 *  the same direction of a particle, the one with the higher number prevails. MPS_ERROR_ARGUMENT: a
 *  member of `def` out of range, or an unknown id; MPS_ERROR_STATE: a direction is fixed already by
 *  two or three others of that particle, or as mps_elastic_set_material; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status
mps_elastic_add_boundary(mps_elastic *e, const mps_elastic_boundary_def *def, int32_t *number) {
  return mps_solver_add(mps_elastic_solver(e), MPS_DEF_ELASTIC_BOUNDARY, def, number);
}
/** Gives a boundary another definition; its impulse and work are kept. With the same directions the
 *  factor of the matrix is kept. MPS_ERROR_ARGUMENT: no boundary `number`; otherwise errors as
 *  mps_elastic_add_boundary. */
MPS_NODISCARD static inline mps_status
mps_elastic_set_boundary(mps_elastic *e, int32_t number, const mps_elastic_boundary_def *def) {
  return mps_solver_set(mps_elastic_solver(e), MPS_DEF_ELASTIC_BOUNDARY, number, def);
}
/** Removes boundary `number`. MPS_ERROR_ARGUMENT: no boundary of that number; MPS_ERROR_STATE: as
 *  mps_elastic_set_material. */
MPS_NODISCARD static inline mps_status mps_elastic_remove_boundary(mps_elastic *e, int32_t number) {
  return mps_solver_remove(mps_elastic_solver(e), MPS_DEF_ELASTIC_BOUNDARY, number);
}
/** The definition of boundary `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_elastic_get_boundary(const mps_elastic *e, int32_t number,
                                                  mps_elastic_boundary_def *out) {
  return mps_solver_get(mps_elastic_solver(e), MPS_DEF_ELASTIC_BOUNDARY, number, out, sizeof *out);
}
/** Force and moment of the boundary on its particles, of the last solution or at the end of the
 *  last step; impulse and work since the motion began. By particles: the field `reaction`.
 *  MPS_ERROR_ARGUMENT: no boundary `number`, NULL, or a `size` unknown to this library. */
static inline mps_status mps_elastic_get_reaction(const mps_elastic *e, int32_t number,
                                                  mps_reaction *out) {
  return mps_solver_get_reaction(mps_elastic_solver(e), number, out);
}

/* ---- facets ---------------------------------------------------------------------------------- */
/** Number of facets: the surface consists of the faces of cells without a neighbour there, numbered
 *  from 0, again after a removal. 0 for NULL. */
MPS_API int64_t mps_elastic_facet_count(const mps_elastic *e);
/** Facets that look to `side` (mps_side; MPS_SIDE_ANY: every facet) whose centre lies in the box
 *  [lo, hi] (dim values, infinities allowed; NULL: everywhere), ascending. Writes at most
 *  `capacity` of them to `facets` (may be NULL when capacity is 0); `count` receives their number.
 *  MPS_ERROR_ARGUMENT: `side`, `capacity` or the box is not allowed. */
MPS_API MPS_NODISCARD mps_status mps_elastic_select_facets(const mps_elastic *e, int32_t side,
                                                           const double *lo, const double *hi,
                                                           int64_t capacity, int64_t *count,
                                                           int64_t *facets);
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
mps_elastic_get_facets_sized(const mps_elastic *e, const int64_t *facets, int64_t count,
                             const mps_elastic_facet_arrays *arrays, size_t size);
static inline mps_status mps_elastic_get_facets(const mps_elastic *e, const int64_t *facets,
                                                int64_t count,
                                                const mps_elastic_facet_arrays *arrays) {
  return mps_elastic_get_facets_sized(e, facets, count, arrays, sizeof *arrays);
}

/* ---- loads; forces that another code computes may go to the field `external_force` instead --- */

typedef enum mps_elastic_load_kind {
  MPS_ELASTIC_LOAD_BODY = 0,   /* `force` per mass (m/s2) of each particle; reads `density` */
  MPS_ELASTIC_LOAD_VOLUME = 1, /* `force` per volume (N/m3) of each particle */
  MPS_ELASTIC_LOAD_FORCE = 2,  /* force (N) on each particle */
  MPS_ELASTIC_LOAD_TRACTION =
      3, /* traction (Pa) on each facet, with its moment about the particle */
  MPS_ELASTIC_LOAD_PRESSURE = 4, /* pressure (Pa, inwards) on each facet */
  MPS_ELASTIC_LOAD_FUNCTION = 5  /* traction by `function`, integrated by 3 Gauss points an edge */
} mps_elastic_load_kind;

/** Traction (dim values, Pa, 0 on entry) at the surface point x (dim values, m) with outward
 *  normal. A status other than MPS_OK ends the call, which returns it. */
typedef mps_status (*mps_elastic_traction_fn)(void *user, const double *x, const double *normal,
                                              double *traction);

typedef struct mps_elastic_load_def {
  uint32_t struct_size;
  int32_t kind; /* mps_elastic_load_kind, default BODY */
  /* Particles or, from TRACTION on, facets: a list, or those whose centres lie in a box, or all
   * (mps/solver.h). */
  const int64_t *ids; /* read by the call */
  int64_t id_count;
  double lower[3], upper[3]; /* m, bounds included; NaN (default): no bound */
  int32_t all;               /* 1: all particles or facets; default 0 */
  int32_t reserved;
  const double *values; /* with ids, not of BODY and VOLUME; read by the call: 3 a particle or
                           facet, PRESSURE 1; NULL: `force`, PRESSURE force[0], for each */
  double force[3];      /* as the kind says; finite, default 0 */
  mps_elastic_traction_fn function; /* FUNCTION: called within this call only */
  void *user;
  mps_signal *signal[3]; /* by component, PRESSURE signal[0]: a number in time, at the
                            time of the solution or at the end of the step; NULL (default): 1. Kept
                            alive */
  double factor[3];      /* finite, default 1 */
} mps_elastic_load_def;

static inline mps_elastic_load_def mps_elastic_load_defaults(void) {
  mps_elastic_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_ELASTIC_LOAD, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load to the others; `number` (may be NULL) receives the lowest free number, from 0. Where
 *  all loads together exceed 1e150 N on a particle, functions that sum them return
 *  MPS_ERROR_NUMERIC. MPS_ERROR_ARGUMENT: a member of `def` out of range, or an unknown id or
 *  facet; MPS_ERROR_FIELD: BODY without a field `density`; MPS_ERROR_STATE: as
 *  mps_elastic_set_material; MPS_ERROR_MEMORY; or the status of `function`. */
MPS_NODISCARD static inline mps_status
mps_elastic_add_load(mps_elastic *e, const mps_elastic_load_def *def, int32_t *number) {
  return mps_solver_add(mps_elastic_solver(e), MPS_DEF_ELASTIC_LOAD, def, number);
}
/** Gives load `number` another definition, if need be in every step. MPS_ERROR_ARGUMENT: no load
 *  `number`; otherwise errors as mps_elastic_add_load. */
MPS_NODISCARD static inline mps_status mps_elastic_set_load(mps_elastic *e, int32_t number,
                                                            const mps_elastic_load_def *def) {
  return mps_solver_set(mps_elastic_solver(e), MPS_DEF_ELASTIC_LOAD, number, def);
}
/** Removes load `number`. MPS_ERROR_ARGUMENT: no load of that number; MPS_ERROR_STATE: as
 *  mps_elastic_set_material. */
MPS_NODISCARD static inline mps_status mps_elastic_remove_load(mps_elastic *e, int32_t number) {
  return mps_solver_remove(mps_elastic_solver(e), MPS_DEF_ELASTIC_LOAD, number);
}
/** The definition of load `number`, with what it selected as `ids`: mps_solver_get. */
static inline mps_status mps_elastic_get_load(const mps_elastic *e, int32_t number,
                                              mps_elastic_load_def *out) {
  return mps_solver_get(mps_elastic_solver(e), MPS_DEF_ELASTIC_LOAD, number, out, sizeof *out);
}
/** Resultant of the present loads and of `external_force`: force (3 values, N) and moment (3, N m,
 *  about `about`, 3 values, NULL: the origin). Either may be NULL. MPS_ERROR_ARGUMENT: `about` or
 *  an `external_force` is not finite; MPS_ERROR_NUMERIC: the sums are too large; MPS_ERROR_STATE:
 *  as mps_elastic_set_material; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_load_resultant(const mps_elastic *e,
                                                                const double *about, double *force,
                                                                double *moment);

/* ---- statics --------------------------------------------------------------------------------- */
/** Size and cost of the solution, from the symbolic analysis. */
typedef struct mps_elastic_estimate {
  int64_t unknowns, matrix_nonzeros; /* of the lower triangle; on ranks, of this one's rows */
  int64_t factor_nonzeros;           /* of L */
  double factor_flops, factor_bytes;
  int32_t ordering, solver; /* mps_elastic_ordering and mps_elastic_solver_kind that will be used */
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
 *  mps_elastic_set_material; MPS_ERROR_NUMERIC, a singular matrix, CG without convergence, or
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
  int32_t solver, ordering;         /* mps_elastic_solver_kind and mps_elastic_ordering used */
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
static inline mps_status mps_elastic_get_totals(const mps_elastic *e, mps_totals *out) {
  return mps_solver_get_totals(mps_elastic_solver(e), out);
}

/* ---- motions in time, vibration -------------------------------------------------------------- */

typedef struct mps_elastic_motion_def {
  uint32_t struct_size;
  int32_t reserved;
  double dt;      /* s, 1e-30 to 1e30; no default */
  double rho_inf; /* generalised alpha (Chung and Hulbert): spectral radius at infinite frequency,
                     in [0, 1]; default 1: Newmark's average acceleration, which keeps the energy */
  double beta, gamma;  /* Newmark's, both in place of rho_inf; NaN (default): of rho_inf. gamma in
                          [1/2, 1], beta in [(gamma + 1/2)^2 / 4, 10] */
  double mass_damping; /* a0, 1/s, >= 0; default 0 */
  double stiffness_damping; /* a1, s, >= 0; default 0 */
  double ratio[2]; /* damping ratios in [0, 1) at the two frequencies, in place of a0 and a1, which
                      must result >= 0; NaN (default): none */
  double frequency[2]; /* Hz, > 0, different; read with `ratio` */
  double time;         /* s, of the start, finite; default 0 */
} mps_elastic_motion_def;

static inline mps_elastic_motion_def mps_elastic_motion_defaults(void) {
  mps_elastic_motion_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_ELASTIC_MOTION, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Begins a motion from the fields `displacement`, `velocity` (0 without) and `density`.
 *  MPS_ERROR_ARGUMENT: a member of `def` out of range; MPS_ERROR_FIELD: no field `density`;
 *  MPS_ERROR_NUMERIC: a displacement or velocity beyond 1e100 m or m/s; MPS_ERROR_STATE: as
 *  mps_elastic_solve; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_start(mps_elastic *e,
                                                   const mps_elastic_motion_def *def);
/** Takes `count` (>= 0) steps, and writes `displacement`, `velocity`, `acceleration` and
 *  `reaction`. Loads and boundaries may be changed between calls; their values at the end of a step
 *  act. A step that fails (MPS_ERROR_DIVERGED: a displacement or speed beyond 1e100 m or m/s;
 *  MPS_ERROR_NUMERIC as mps_elastic_solve) or
 *  is cancelled (MPS_ERROR_CANCELLED) is undone: state, time and fields are those after the last
 *  complete step. MPS_ERROR_STATE: no motion under way. */
MPS_NODISCARD static inline mps_status mps_elastic_step(mps_elastic *e, int64_t count) {
  return mps_solver_step(mps_elastic_solver(e), count);
}
/** Called at the start of a run, then every `every` steps and at the end, with fields up to date. A
 *  status other than MPS_OK ends the run, which returns it. */
typedef mps_status (*mps_elastic_fn)(void *user, mps_elastic *e);
/* A run's callback with its solver, as mps_solver_run calls it. */
typedef struct mps_elastic_call {
  mps_elastic *solver;
  mps_elastic_fn callback;
  void *user;
} mps_elastic_call;
static inline mps_status mps_elastic_call_back(void *user, mps_solver *solver) {
  const mps_elastic_call *call = (const mps_elastic_call *)user;
  (void)solver;
  return call->callback(call->user, call->solver);
}
/** Steps to exactly t_end (s, not before the present time) in equal steps of at most dt, which is
 *  kept. `callback` may be NULL, `every` >= 1. MPS_ERROR_ARGUMENT: `t_end` or `every` out of range;
 *  otherwise errors as mps_elastic_step, or the status of `callback`. */
MPS_NODISCARD static inline mps_status mps_elastic_run(mps_elastic *e, double t_end, int64_t every,
                                                       mps_elastic_fn callback, void *user) {
  mps_elastic_call call = {e, callback, user};
  return mps_solver_run(mps_elastic_solver(e), t_end, every,
                        callback ? mps_elastic_call_back : NULL, &call);
}
/** Time (s) since the start of the motion; 0 without a motion. */
static inline double mps_elastic_time(const mps_elastic *e) {
  return mps_solver_time(mps_elastic_solver(e));
}
/** Number of steps since the start of the motion; 0 without a motion. */
static inline int64_t mps_elastic_steps(const mps_elastic *e) {
  return mps_solver_steps(mps_elastic_solver(e));
}
/** Time step (s); 0 without a motion. */
static inline double mps_elastic_dt(const mps_elastic *e) {
  return mps_solver_dt(mps_elastic_solver(e));
}
/** Largest stable time step (s): infinite, since all are stable. */
static inline double mps_elastic_limit(const mps_elastic *e) {
  return mps_solver_limit(mps_elastic_solver(e));
}
/** Sets the time step (s, 1e-30 to 1e30) from the next step on; the matrix is factored again.
 *  MPS_ERROR_ARGUMENT: out of range; MPS_ERROR_STATE: no motion under way, or as
 *  mps_elastic_set_material. */
MPS_NODISCARD static inline mps_status mps_elastic_set_dt(mps_elastic *e, double dt) {
  return mps_solver_set_dt(mps_elastic_solver(e), dt);
}

/** Keeps the state of the motion and of the set (removed particles, numbers of facets), with
 *  impulses and works, in memory; *snapshot NULL: created, else filled again. Between steps only;
 *  on an error nothing has changed. MPS_ERROR_ARGUMENT: a snapshot of another solver;
 *  MPS_ERROR_STATE: no motion under way, or a step is running; MPS_ERROR_MEMORY. */
MPS_NODISCARD static inline mps_status mps_elastic_snapshot(mps_elastic *e,
                                                            mps_snapshot **snapshot) {
  return mps_solver_snapshot(mps_elastic_solver(e), snapshot);
}
/** Restores a snapshot, bit for bit. Loads, values and signals of boundaries, dt and moduli stay.
 *  On an error nothing has changed. MPS_ERROR_ARGUMENT: a snapshot of another solver;
 *  MPS_ERROR_STATE: no motion under way, or other boundaries or cuts. */
MPS_NODISCARD static inline mps_status mps_elastic_rollback(mps_elastic *e,
                                                            const mps_snapshot *snapshot) {
  return mps_solver_rollback(mps_elastic_solver(e), snapshot);
}
/** Writes the state to a file, as mps_elastic_snapshot; of `info` (NULL: nothing) user_key and
 *  user_data are written too. MPS_ERROR_IO: the file cannot be written; MPS_ERROR_STATE: as
 *  mps_elastic_snapshot; MPS_ERROR_UNSUPPORTED: no HDF5. */
MPS_NODISCARD static inline mps_status mps_elastic_save(mps_elastic *e, const char *path,
                                                        const mps_checkpoint *info) {
  return mps_solver_save(mps_elastic_solver(e), path, info);
}
/** Restores a file of mps_elastic_save, as mps_elastic_rollback, into a solver that was built and
 *  started in the same way; `info` (may be NULL) as for mps_checkpoint_info. On an error nothing
 *  has changed: statuses of mps_checkpoint_read, and MPS_ERROR_STATE as mps_elastic_rollback. */
MPS_NODISCARD static inline mps_status mps_elastic_restore(mps_elastic *e, const char *path,
                                                           mps_checkpoint *info) {
  return mps_solver_restore(mps_elastic_solver(e), path, info);
}

/** The lowest `count` circular eigenfrequencies (rad/s, ascending) of the supported body and, where
 *  `shapes` is not NULL, its modes: shapes[(k * n + i) * 3 + c], i in the set's present order, each
 *  of unit modal mass. By ARPACK on the inverse (shift-invert at 0). Reads `density`. One
 *  calculation at a time in a process: others wait. MPS_ERROR_ARGUMENT: `count` below 1, or not
 *  below the number of unknowns; MPS_ERROR_FIELD: no field `density`; MPS_ERROR_UNSUPPORTED: no
 *  ARPACK, or too many unknowns for its integers; MPS_ERROR_NUMERIC: no convergence;
 *  MPS_ERROR_STATE: as mps_elastic_solve; MPS_ERROR_CANCELLED; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_modes(mps_elastic *e, int64_t count, double *omega,
                                                   double *shapes);

MPS_EXTERN_C_END
#endif
