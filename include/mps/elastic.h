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
 * `acceleration`, and when asked the stresses. Vectors have three components in 2D too; the third
 * is not read, and written as 0. In 2D all forces, masses and energies are those of the `measure`.
 *
 * In a libmps built without CHOLMOD mps_elastic_create returns MPS_ERROR_UNSUPPORTED.
 *
 * The set may be sorted while a solver uses it, and particles may be removed (mps_particles_remove:
 * excavation): what is left must be a body still, boundaries and loads lose what has gone, facets
 * are numbered anew, a motion ends. A rollback or restore brings them back. None can be added.
 *
 * Thread rule: one thread at a time per context; the work is shared among the context's threads, of
 * BLAS and CHOLMOD too (docs/elastic.md). The cancel hook is asked before the ordering, the
 * analysis and the factorisation, each of which runs to its end once begun, every 64 iterations of
 * CG and before each step. From hooks, signals and callbacks the solver may be asked, but not
 * changed: MPS_ERROR_STATE. SPDX-License-Identifier: BSD-3-Clause */
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
  MPS_ELASTIC_ORDERING_BEST = 0, /* AMD and METIS are tried, the smaller factor is kept */
  MPS_ELASTIC_ORDERING_AMD = 1,
  MPS_ELASTIC_ORDERING_METIS = 2
} mps_elastic_ordering;

typedef struct mps_elastic_def {
  uint32_t struct_size;
  int32_t state;       /* mps_elastic_state; 2D only */
  int32_t solver;      /* mps_elastic_solver */
  int32_t ordering;    /* mps_elastic_ordering */
  double radius_ratio; /* re / spacing of the stabilising pairs, in (1, 4]; NaN (default): 1.5 */
  double alpha;        /* weight of the stabilising pairs, in [0.03, 100]; default 1 */
  double measure;      /* 2D: thickness, m, 1e-30 to 1e30; default 1. Not read in 3D */
  double memory_limit; /* bytes the factor may take, >= 0; NaN (default): no limit */
  double tolerance;    /* CG: |residual| / |load| to reach, in [1e-14, 1e-2]; default 1e-10 */
  int64_t iterations;  /* CG: most iterations; 0 (default): ten times the unknowns */
  int32_t refinements; /* steps of iterative refinement after a direct solution, 0..10; default 1 */
  int32_t blas_threads;   /* most threads of BLAS, up to 1024; 0 (default): the context's. LLT gives
                             the same bits for the same number only; all else does for every number */
  mps_material *material; /* linear elastic, of all; NULL (default): the fields'. Kept alive */
  mps_kernel *kernel;     /* weight of the pairs, its radius in (1, 4] spacings, in place of
                             radius_ratio; kept alive; NULL (default): re/r - 1 */
  double bending; /* [0, 1], of a cell's own stiffness against bending, without which n cells lack
                     1/n^2; NaN (default): 1 in bodies of several materials, 0 of a single one */
  mps_domain *domain; /* ranks that solve together: mps/elastic_solver.h; NULL (default): none */
} mps_elastic_def;

MPS_API mps_status mps_elastic_def_init(mps_elastic_def *def, size_t size);
static inline mps_elastic_def mps_elastic_defaults(void) {
  mps_elastic_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Creates a solver for the particles of `particles`, which must lie on a lattice of the set's
 *  spacing (any origin), each with a neighbour along every axis. Reads `young` and `poisson`.
 *  `def` NULL: defaults. On an error the set is as before. */
MPS_API MPS_NODISCARD mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                                                    const mps_elastic_def *def, mps_elastic **out);
/** Destroys and nulls; accepts NULL. From within a callback of the solver: nothing happens. */
MPS_API void mps_elastic_destroy(mps_elastic **e);
/** What the solver was made from, completed. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_def_sized(const mps_elastic *e,
                                                           mps_elastic_def *out, size_t size);
static inline mps_status mps_elastic_get_def(const mps_elastic *e, mps_elastic_def *out) {
  return mps_elastic_get_def_sized(e, out, sizeof *out);
}
/** The set and the context; NULL for NULL. Lent: they live at least as long as the solver. */
MPS_API mps_particles *mps_elastic_particles(const mps_elastic *e);
MPS_API mps_context *mps_elastic_context(const mps_elastic *e);

/** Reads `young` and `poisson` again after the caller has changed them; on an error it goes on with
 *  the former ones. The symbolic factorisation is kept where joints are still on the same faces. */
MPS_API MPS_NODISCARD mps_status mps_elastic_update_material(mps_elastic *e);

/** Says what the particles `ids` (NULL with count 0: all) are made of: writes `young` and
 * `poisson`, then as mps_elastic_update_material. MPS_ERROR_UNSUPPORTED: not linear elastic. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_material(mps_elastic *e,
                                                          const mps_material *material,
                                                          int64_t count, const int64_t *ids);

/** The surface passes through these particles: the half of their cells on `side` (-1 or +1) of
 *  `axis` does not belong to the body. Refused where a particle has a neighbour on that side. Ends
 *  a motion under way. Loads on facets set before keep the areas that they had. */
MPS_API MPS_NODISCARD mps_status mps_elastic_cut(mps_elastic *e, int32_t axis, int32_t side,
                                                 int64_t count, const int64_t *ids);

/* ---- boundaries ------------------------------------------------------------------------------ */
/* Kinds (mps_boundary_kind): HELD, the components `dofs` of the displacement are 0. DRIVEN, they
 * are what `values` and signals say. ROLLER, the displacement along `normal`, free across. */

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
                            NULL: holds */
  double factor[3];      /* finite, default 1 */
} mps_elastic_boundary_def;

MPS_API mps_status mps_elastic_boundary_def_init(mps_elastic_boundary_def *def, size_t size);
static inline mps_elastic_boundary_def mps_elastic_boundary_defaults(void) {
  mps_elastic_boundary_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_boundary_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a boundary; `number` (may be NULL) receives the lowest free number, from 0. Where two fix
 *  the same direction of a particle, the one with the higher number has it. MPS_ERROR_STATE where a
 *  direction is fixed already by two or three others of that particle. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_boundary(mps_elastic *e,
                                                          const mps_elastic_boundary_def *def,
                                                          int32_t *number);
/** Another definition; impulse and work go on. The same directions keep the factor. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_boundary(mps_elastic *e, int32_t number,
                                                          const mps_elastic_boundary_def *def);
MPS_API MPS_NODISCARD mps_status mps_elastic_remove_boundary(mps_elastic *e, int32_t number);
/** Force and moment of the boundary on its particles, of the last solution or at the end of the
 * last step; impulse and work since the motion began. By particles: the field `reaction`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_reaction_sized(const mps_elastic *e,
                                                                int32_t number, mps_reaction *out,
                                                                size_t size);
static inline mps_status mps_elastic_get_reaction(const mps_elastic *e, int32_t number,
                                                  mps_reaction *out) {
  return mps_elastic_get_reaction_sized(e, number, out, sizeof *out);
}

/* ---- facets ---------------------------------------------------------------------------------- */
/** The surface is made of facets, faces that no neighbour shares, from 0, anew after a removal. */
MPS_API int64_t mps_elastic_facet_count(const mps_elastic *e);
/** Facets with outward normal `side` * `axis` (side 0: every facet) whose centre lies in the box
 *  [lo, hi] (dim values, infinities allowed; NULL: everywhere), ascending. Writes at most
 *  `capacity` of them to `facets` (may be NULL when capacity is 0); `count` receives how many. */
MPS_API MPS_NODISCARD mps_status mps_elastic_select_facets(const mps_elastic *e, int32_t axis,
                                                           int32_t side, const double *lo,
                                                           const double *hi, int64_t capacity,
                                                           int64_t *count, int64_t *facets);
/** Where to write what of each facet; NULL: not wanted. */
typedef struct mps_elastic_facet_arrays {
  int64_t *particle;    /* id */
  double *centre;       /* m, 3 a facet: in the unstrained body */
  double *normal;       /* 3: outward */
  double *extent;       /* m, 3: edge lengths, 0 along the normal and along z in 2D */
  double *area;         /* m2, of the measure */
  double *displacement; /* m, 3: at the centre */
  double *velocity;     /* m/s, 3: at the centre; 0 without a motion */
} mps_elastic_facet_arrays;
/** Of `count` facets, or of all (facets NULL, count mps_elastic_facet_count). */
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
 * normal. A status other than MPS_OK ends the call, which returns it. */
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
  mps_elastic_traction_fn function; /* FUNCTION: asked by this call only */
  void *user;
  mps_signal *signal[3]; /* by component, PRESSURE signal[0]: its displacement, as a number, at the
                            time of the solution or at the end of the step; NULL (default): 1. Kept
                            alive */
  double factor[3];      /* finite, default 1 */
} mps_elastic_load_def;

MPS_API mps_status mps_elastic_load_def_init(mps_elastic_load_def *def, size_t size);
static inline mps_elastic_load_def mps_elastic_load_defaults(void) {
  mps_elastic_load_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_load_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Adds a load to the others; `number` (may be NULL) receives the lowest free number, from 0. Where
 *  all loads together are beyond 1e150 N on a particle, what asks for them is MPS_ERROR_NUMERIC. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_load(mps_elastic *e,
                                                      const mps_elastic_load_def *def,
                                                      int32_t *number);
/** Another definition. As often as every step; allocates nothing when the list is not longer. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_load(mps_elastic *e, int32_t number,
                                                      const mps_elastic_load_def *def);
MPS_API MPS_NODISCARD mps_status mps_elastic_remove_load(mps_elastic *e, int32_t number);
/** Resultant of the present loads and of `external_force`: force (3 values, N) and moment (3, N m,
 *  about `about`, 3 values, NULL: the origin). Either may be NULL. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_load_resultant(const mps_elastic *e,
                                                                const double *about, double *force,
                                                                double *moment);

/* ---- statics --------------------------------------------------------------------------------- */
/** What the solution takes, known before it is made. */
typedef struct mps_elastic_estimate {
  int64_t unknowns, matrix_nonzeros; /* of the lower triangle; on ranks, of this one's rows */
  int64_t factor_nonzeros;           /* of L */
  double factor_flops, factor_bytes;
  int32_t ordering, solver; /* mps_elastic_ordering and mps_elastic_solver that will be used */
} mps_elastic_estimate;

/** Orders and analyses the matrix (kept for the solution). MPS_ERROR_STATE with the rigid motions
 *  that are left free where the boundaries do not hold the body. */
MPS_API MPS_NODISCARD mps_status mps_elastic_analyse_sized(mps_elastic *e,
                                                           mps_elastic_estimate *out, size_t size);
static inline mps_status mps_elastic_analyse(mps_elastic *e, mps_elastic_estimate *out) {
  return mps_elastic_analyse_sized(e, out, sizeof *out);
}

/** Solves for the loads and boundaries as they are at the present time; writes `displacement` and
 *  `reaction` (N, force of the boundaries on the particle). The factor is kept: it is made again
 *  only when boundaries, cuts or material have changed. Ends a motion under way. On an error
 * nothing has changed. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve(mps_elastic *e);
/** Solves for `count` load cases at once with the present boundaries. loads[(k * n + i) * 3 + c] is
 *  the force (N) of case k on particle i of the set's present order, displacements likewise (m). No
 *  field is written. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve_cases(mps_elastic *e, int64_t count,
                                                         const double *loads,
                                                         double *displacements);

/** How the last solution went. */
typedef struct mps_elastic_report {
  int64_t unknowns, matrix_nonzeros, factor_nonzeros;
  double factor_flops;
  double factor_bytes; /* of the numerical factor; CG: of matrix and vectors */
  double peak_bytes;   /* largest memory CHOLMOD has held */
  double residual;     /* |K u - F| / |F| over the free unknowns, after refinement */
  double condition;    /* crude lower estimate of the condition number; CG: 0 */
  double seconds_assemble, seconds_analyse, seconds_factor, seconds_solve;
  int64_t analyses, factorisations; /* since creation */
  int64_t iterations;               /* CG */
  int32_t solver, ordering;         /* mps_elastic_solver and mps_elastic_ordering used */
} mps_elastic_report;

MPS_API MPS_NODISCARD mps_status mps_elastic_get_report_sized(const mps_elastic *e,
                                                              mps_elastic_report *out, size_t size);
static inline mps_status mps_elastic_get_report(const mps_elastic *e, mps_elastic_report *out) {
  return mps_elastic_get_report_sized(e, out, sizeof *out);
}

/** Writes strain and stress of the present displacement to the fields `strain` and `stress`
 *  (components xx, yy, zz, xy and in 3D zx, yz; shear strain is tensorial), the principal stresses,
 *  largest first, to `principal`, and the von Mises stress to `von_mises`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_update_stress(mps_elastic *e);
/** Force (3 values, N) and moment (3, N m, about `about`, 3 values, NULL: origin) that the part of
 *  the body with x[axis] > position exerts on the rest, from the static balance of the rest's
 *  particles: normal force N, shear Q and bending moment M of the section. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_section(const mps_elastic *e, int32_t axis,
                                                         double position, const double *about,
                                                         double *force, double *moment);
/** Strain energy (J) now; `stabilising` (may be NULL) receives its part in the stabilising pairs.
 */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_energy(const mps_elastic *e, double *strain,
                                                        double *stabilising);
/** Sums over the body. Since the motion began, or of the last static solution, which counts as
 *  loaded in proportion from rest, so that the work of the loads is half of load times
 * displacement. Works in a step are means of the forces before and after it times the displacement,
 * plus the kinetic energy that driven particles gain; the budget of mps/solver.h closes to rounding
 * (1e-10) with Newmark's average acceleration, or to 1e-14 C if that is more: C is the greatest
 * Young's modulus over the lesser of the least one and 4 density spacing^2 / dt^2 (above a ratio of
 * moduli of 1e8 a warning says so). `dissipated` is that of Rayleigh damping and
 * `scheme`, which for other members of the family is what the scheme takes, measured as the rest of
 * the budget. */
MPS_API MPS_NODISCARD mps_status mps_elastic_get_totals_sized(const mps_elastic *e, mps_totals *out,
                                                              size_t size);
static inline mps_status mps_elastic_get_totals(const mps_elastic *e, mps_totals *out) {
  return mps_elastic_get_totals_sized(e, out, sizeof *out);
}

/* ---- dynamics: the same matrices, lumped mass density * cell volume, C = a0 M + a1 K --------- */

typedef struct mps_elastic_motion_def {
  uint32_t struct_size;
  int32_t reserved;
  double dt;      /* s, 1e-30 to 1e30; no default */
  double rho_inf; /* generalised alpha (Chung and Hulbert): spectral radius for endless frequencies,
                     in [0, 1]; default 1: Newmark's average acceleration, which keeps the energy */
  double beta, gamma;  /* Newmark's, both in place of rho_inf; NaN (default): of rho_inf. gamma in
                          [1/2, 1], beta in [(gamma + 1/2)^2 / 4, 10] */
  double mass_damping; /* a0, 1/s, >= 0; default 0 */
  double stiffness_damping; /* a1, s, >= 0; default 0 */
  double ratio[2]; /* damping ratios in [0, 1) at the two frequencies, in place of a0 and a1, which
                      they must give >= 0; NaN (default): none */
  double frequency[2]; /* Hz, > 0, different */
  double time;         /* s, of the start, finite; default 0 */
} mps_elastic_motion_def;

MPS_API mps_status mps_elastic_motion_def_init(mps_elastic_motion_def *def, size_t size);
static inline mps_elastic_motion_def mps_elastic_motion_defaults(void) {
  mps_elastic_motion_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_motion_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Begins a motion from the fields `displacement`, `velocity` (0 without) and `density`. Beyond
 * 1e100 m or m/s it is MPS_ERROR_NUMERIC. */
MPS_API MPS_NODISCARD mps_status mps_elastic_start(mps_elastic *e,
                                                   const mps_elastic_motion_def *def);
/** Takes `count` (>= 0) steps, and writes `displacement`, `velocity`, `acceleration` and
 * `reaction`. Loads and boundaries may be changed between calls: they act as they are at the end of
 * a step. A step that fails (MPS_ERROR_NUMERIC: a speed beyond 1e100 m/s) or is cancelled has not
 * happened: state, time and fields are those after the last whole one. */
MPS_API MPS_NODISCARD mps_status mps_elastic_step(mps_elastic *e, int64_t count);
/** Called at the start of a run, then every `every` steps and at the end, with fields up to date. A
 *  status other than MPS_OK ends the run, which returns it. */
typedef mps_status (*mps_elastic_fn)(void *user, mps_elastic *e);
/** Goes to exactly t_end (s, not before the present time) in equal steps of at most dt, which
 * stays. `callback` may be NULL, `every` >= 1. */
MPS_API MPS_NODISCARD mps_status mps_elastic_run(mps_elastic *e, double t_end, int64_t every,
                                                 mps_elastic_fn callback, void *user);
MPS_API double mps_elastic_time(const mps_elastic *e);   /* s since the start; 0 without */
MPS_API int64_t mps_elastic_steps(const mps_elastic *e); /* since the start */
MPS_API double mps_elastic_dt(const mps_elastic *e);     /* s; 0 without a motion */
MPS_API double mps_elastic_limit(const mps_elastic *e);  /* infinite: all are stable */
/** From the next step on (s, 1e-30 to 1e30); the matrix is factored again. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_dt(mps_elastic *e, double dt);

/** The motion, its set (particles removed since, numbers of facets) and what has been counted: bit
 *  for bit back to a snapshot (memory), or to what a solver built and started in the same way has
 *  saved. Loads, values and signals of boundaries, dt and moduli stay. Between steps only; on an
 * error nothing has changed. MPS_ERROR_STATE: no motion under way, or other boundaries. */
MPS_API MPS_NODISCARD mps_status mps_elastic_snapshot(mps_elastic *e, mps_snapshot **snapshot);
MPS_API MPS_NODISCARD mps_status mps_elastic_rollback(mps_elastic *e, const mps_snapshot *snapshot);
MPS_API MPS_NODISCARD mps_status mps_elastic_save(mps_elastic *e, const char *path,
                                                  const mps_checkpoint *info);
MPS_API MPS_NODISCARD mps_status mps_elastic_restore(mps_elastic *e, const char *path,
                                                     mps_checkpoint *info);

/** The lowest `count` circular eigenfrequencies (rad/s, ascending) of the supported body and, where
 *  `shapes` is not NULL, its modes: shapes[(k * n + i) * 3 + c], i in the set's present order, each
 *  of unit modal mass. By ARPACK on the inverse. Reads `density`. One calculation at a time in a
 *  process: others wait. */
MPS_API MPS_NODISCARD mps_status mps_elastic_modes(mps_elastic *e, int32_t count, double *omega,
                                                   double *shapes);

MPS_EXTERN_C_END
#endif
