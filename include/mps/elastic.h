/* mps/elastic.h - implicit particle elasticity for thick structures (Chikazawa, sections 2 and 3):
 * plates, walls and cantilevers of any lattice shape in 2D (plane stress or strain) and 3D, loaded
 * by forces, tractions, pressures and prescribed displacements. Small displacements; the sparse
 * symmetric system is solved by CHOLMOD, or by conjugate gradients in a limited memory.
 *
 * Every particle stands for one lattice cell (a square or cube of the set's spacing) that it is
 * the centre of, so free surfaces lie half a spacing OUTSIDE the outer particles. Where a surface
 * must pass THROUGH a layer of particles (a fixed wall, a plane of symmetry) the cells of the layer
 * are cut in half with mps_elastic_cut.
 *
 * The solver reads the fields `young` (Pa, > 0), `poisson` (-1 < nu < 0.5) and, for dynamics,
 * `density` (kg/m3, > 0), and writes `displacement`, `reaction` and, when asked, the stresses.
 * In 2D everything is for a slab of `thickness` (1 m), so that forces are in N.
 *
 * A libmps built without CHOLMOD has these functions too; mps_elastic_create then returns
 * MPS_ERROR_UNSUPPORTED.
 *
 * The set may be sorted, but not added to, while a solver uses it. Thread rule: one thread at a
 * time per context; the work is shared among the context's threads. During a factorisation or
 * triangular solution OpenBLAS, whose number of threads is one for the process, is set to at most
 * the context's and set back after it (calls of several contexts at once share the smallest); on a
 * context of one thread CHOLMOD's OpenMP loops have one thread too, otherwise at most four. Other
 * BLAS libraries keep the number that the process gave them. The cancel hook is asked before the
 * ordering, the analysis and the factorisation, each of which runs to its end once begun, every 64
 * iterations of CG and each step. METIS (ordering BEST and METIS) prints a line of its own on
 * stderr when the process is out of memory; AMD does not.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_ELASTIC_H
#define LIBMPS_ELASTIC_H

#include "particles.h"

MPS_EXTERN_C_BEGIN

typedef struct mps_elastic mps_elastic;

typedef enum mps_elastic_method {
  MPS_ELASTIC_CONSERVATIVE = 0, /* gradient from shared cell faces, stabilised; 2D and 3D */
  MPS_ELASTIC_PUBLISHED = 1     /* Chikazawa (10), corrected, R and D eliminated; 2D */
} mps_elastic_method;

typedef enum mps_elastic_state {
  MPS_ELASTIC_PLANE_STRESS = 0, /* lambda = nu E / (1 - nu^2) */
  MPS_ELASTIC_PLANE_STRAIN = 1  /* lambda = nu E / ((1 + nu)(1 - 2 nu)), as in 3D */
} mps_elastic_state;

/** What divides the sums (7), (8) of the published method. */
typedef enum mps_elastic_divisor {
  MPS_ELASTIC_LOCAL = 0,   /* each particle's own n_i: rigid rotation is free of stress */
  MPS_ELASTIC_CONSTANT = 1 /* the full lattice's n0, as the paper has it */
} mps_elastic_divisor;

typedef enum mps_elastic_solver {
  MPS_ELASTIC_AUTO = 0, /* LLT where the factor fits `memory_limit`, else CG */
  MPS_ELASTIC_LLT = 1,  /* supernodal Cholesky */
  MPS_ELASTIC_LDLT = 2, /* simplicial LDL^T */
  MPS_ELASTIC_CG = 3    /* conjugate gradients with a symmetric Gauss-Seidel preconditioner */
} mps_elastic_solver;

typedef enum mps_elastic_ordering {
  MPS_ELASTIC_ORDER_BEST = 0, /* AMD and METIS are tried, the smaller factor is kept */
  MPS_ELASTIC_ORDER_AMD = 1,
  MPS_ELASTIC_ORDER_METIS = 2
} mps_elastic_ordering;

typedef struct mps_elastic_def {
  uint32_t struct_size;
  int32_t method;      /* mps_elastic_method */
  int32_t state;       /* mps_elastic_state; 2D only */
  int32_t divisor;     /* mps_elastic_divisor; published only */
  int32_t solver;      /* mps_elastic_solver */
  int32_t ordering;    /* mps_elastic_ordering */
  double radius_ratio; /* re / spacing in (1, 4]; 0 (default): 1.5 conservative, 3 published */
  double alpha;        /* weight of the stabilising pairs of the conservative method, in
                          [0.03, 100]; default 1 */
  double thickness;    /* m, > 0, 2D only; default 1 */
  double memory_limit; /* bytes the factor may take, 0 (default): no limit */
  double tolerance;    /* CG: |residual| / |load| to reach, in [1e-14, 1e-2]; default 1e-10 */
  int64_t iterations;  /* CG: most iterations; 0 (default): ten times the unknowns */
  int32_t refinements; /* steps of iterative refinement after a direct solution, 0..10; default 1 */
  int32_t first_moment; /* 1: the first moment of a surface load goes into the equations; 0: only
                           its resultant; -1 (default): 1 conservative, 0 published */
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
 *  `def` NULL: defaults. */
MPS_API MPS_NODISCARD mps_status mps_elastic_create(mps_context *context, mps_particles *particles,
                                                    const mps_elastic_def *def, mps_elastic **out);
MPS_API void mps_elastic_destroy(mps_elastic **elastic);

/** Reads `young` and `poisson` again after the caller has changed them. The symbolic
 *  factorisation is kept where joints of different materials are still on the same faces. */
MPS_API MPS_NODISCARD mps_status mps_elastic_update_material(mps_elastic *elastic);

/* ---- shape and supports ---------------------------------------------------------------------- */

/** The surface passes through these particles: the half of their cells on `side` (-1 or +1) of
 *  `axis` does not belong to the body. Refused where a particle has a neighbour on that side. Ends
 * a motion under way. */
MPS_API MPS_NODISCARD mps_status mps_elastic_cut(mps_elastic *elastic, int32_t axis, int32_t side,
                                                 int64_t count, const int64_t *ids);

/** Prescribes displacement component `component` (0 x, 1 y, 2 z) of `count` particles: values[i]
 *  in m, or 0 where `values` is NULL. A later value replaces an earlier one. */
MPS_API MPS_NODISCARD mps_status mps_elastic_prescribe(mps_elastic *elastic, int32_t component,
                                                       int64_t count, const int64_t *ids,
                                                       const double *values);
/** A roller: the displacement along `normal` (dim values, any length > 0) is values[i] (m), or 0
 *  where `values` is NULL; the particles move freely across. MPS_ERROR_STATE where the direction
 *  is already fixed by the particle's other supports. */
MPS_API MPS_NODISCARD mps_status mps_elastic_roller(mps_elastic *elastic, const double *normal,
                                                    int64_t count, const int64_t *ids,
                                                    const double *values);
/** Removes all supports. */
MPS_API MPS_NODISCARD mps_status mps_elastic_clear_supports(mps_elastic *elastic);

/* ---- loads: they add up until they are cleared ------------------------------------------------
 */

/** A piece of the body's surface: the face of one cell that no neighbour shares. */
typedef struct mps_elastic_facet {
  int64_t particle; /* id */
  int32_t axis;     /* of the outward normal: 0 x, 1 y, 2 z */
  int32_t side;     /* -1 or +1: its sense */
  double centre[3]; /* m */
  double extent[3]; /* m: edge lengths, 0 along `axis` (2D: 0 along z) */
  double area;      /* m2 */
} mps_elastic_facet;

MPS_API int64_t mps_elastic_facet_count(const mps_elastic *elastic);
MPS_API MPS_NODISCARD mps_status mps_elastic_get_facet(const mps_elastic *elastic, int64_t facet,
                                                       mps_elastic_facet *out);
/** Facets with outward normal `side` * `axis` (side 0: every facet) whose centre lies in the box
 *  [lo, hi] (dim values, infinities allowed; NULL: everywhere), ascending. Writes at most
 *  `capacity` of them to `facets` (may be NULL when capacity is 0); `count` receives how many. */
MPS_API MPS_NODISCARD mps_status mps_elastic_select_facets(const mps_elastic *elastic, int32_t axis,
                                                           int32_t side, const double *lo,
                                                           const double *hi, int64_t capacity,
                                                           int64_t *facets, int64_t *count);

MPS_API MPS_NODISCARD mps_status mps_elastic_clear_loads(mps_elastic *elastic);
/** Forces at particles: forces[i * dim + c] in N. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_forces(mps_elastic *elastic, int64_t count,
                                                        const int64_t *ids, const double *forces);
/** The same force per volume (dim values, N/m3) on the whole body. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_body_force(mps_elastic *elastic,
                                                            const double *force);
/** Uniform traction (dim values, Pa) on `count` facets, with its first moment. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_traction(mps_elastic *elastic, int64_t count,
                                                          const int64_t *facets,
                                                          const double *traction);
/** Pressure pressures[i] (Pa, pushing inwards) on facets[i]. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_pressure(mps_elastic *elastic, int64_t count,
                                                          const int64_t *facets,
                                                          const double *pressures);
/** Traction (dim values, Pa, 0 on entry) at the surface point x (dim values, m) with outward
 * normal. A status other than MPS_OK ends the call, which returns it. */
typedef mps_status (*mps_traction_fn)(void *user, const double *x, const double *normal,
                                      double *traction);
/** Traction that varies over the surface: integrated over each facet by 3 Gauss points an edge. */
MPS_API MPS_NODISCARD mps_status mps_elastic_add_traction_fn(mps_elastic *elastic, int64_t count,
                                                             const int64_t *facets,
                                                             mps_traction_fn traction, void *user);
/** Resultant of all loads: force (dim values, N) and moment (N m, about `about`, dim values, NULL:
 *  the origin; 2D: one value, 3D: three). Either may be NULL. */
MPS_API MPS_NODISCARD mps_status mps_elastic_load_resultant(const mps_elastic *elastic,
                                                            const double *about, double *force,
                                                            double *moment);

/* ---- statics -----------------------------------------------------------------------------------
 */

/** What the solution takes, known before it is made. */
typedef struct mps_elastic_estimate {
  int64_t unknowns;
  int64_t matrix_nonzeros; /* of the lower triangle, diagonal included */
  int64_t factor_nonzeros; /* of L */
  double factor_flops;
  double factor_bytes;
  int32_t ordering; /* mps_elastic_ordering that was chosen */
  int32_t solver;   /* mps_elastic_solver that will be used */
} mps_elastic_estimate;

/** Orders and analyses the matrix (kept for the solution). MPS_ERROR_STATE with the rigid motions
 *  that are left free where the supports do not hold the body. */
MPS_API MPS_NODISCARD mps_status mps_elastic_analyse(mps_elastic *elastic,
                                                     mps_elastic_estimate *out);

/** Solves for the loads and supports as they are; writes the fields `displacement` and `reaction`
 *  (N, force of the support on the particle). The factor is kept: it is made again only when
 *  supports, cuts or material have changed. Ends a motion under way. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve(mps_elastic *elastic);

/** Solves for `count` load cases at once with the present supports: loads[(k * n + i) * dim + c] is
 *  the force (N) on the particle of id i, displacements likewise (m). No field is written. */
MPS_API MPS_NODISCARD mps_status mps_elastic_solve_cases(mps_elastic *elastic, int64_t count,
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
  int32_t solver;                   /* mps_elastic_solver used */
  int32_t ordering;                 /* mps_elastic_ordering used */
} mps_elastic_report;

MPS_API MPS_NODISCARD mps_status mps_elastic_get_report(const mps_elastic *elastic,
                                                        mps_elastic_report *out);

/** Resultant of all support reactions, as mps_elastic_load_resultant. */
MPS_API MPS_NODISCARD mps_status mps_elastic_reaction_resultant(const mps_elastic *elastic,
                                                                const double *about, double *force,
                                                                double *moment);

/* ---- results -----------------------------------------------------------------------------------
 */

/** Writes strain and stress of the present displacement to the fields `strain` and `stress`
 *  (components xx, yy, zz, xy and in 3D zx, yz; shear strain is tensorial), the principal stresses,
 * largest first, to `principal`, and the von Mises stress to `von_mises`. Conservative: from the
 *  gradient; published: the virial stress of the pairs. */
MPS_API MPS_NODISCARD mps_status mps_elastic_stress(mps_elastic *elastic);

/** Force (dim values, N) and moment (2D 1, 3D 3 values, N m, about `about`, NULL: origin) that the
 *  part of the body with x[axis] > position exerts on the rest, from the balance of the rest's
 *  particles: normal force N, shear Q and bending moment M of the section. */
MPS_API MPS_NODISCARD mps_status mps_elastic_section(mps_elastic *elastic, int32_t axis,
                                                     double position, const double *about,
                                                     double *force, double *moment);

/** Strain energy (J) of the present displacement; for the conservative method `stabilising` (may
 *  be NULL) receives the part of it in the stabilising pairs. */
MPS_API MPS_NODISCARD mps_status mps_elastic_energy(mps_elastic *elastic, double *strain,
                                                    double *stabilising);

/* ---- dynamics: the same matrices, lumped mass density * cell volume ----------------------------
 */

typedef struct mps_newmark_def {
  uint32_t struct_size;
  int32_t reserved;
  double dt;          /* s, > 0; no default */
  double beta, gamma; /* default 1/4, 1/2: unconditionally stable, energy conserving. gamma in
                         [1/2, 1], beta >= (gamma + 1/2)^2 / 4 */
} mps_newmark_def;

MPS_API mps_status mps_newmark_def_init(mps_newmark_def *def, size_t size);
static inline mps_newmark_def mps_newmark_defaults(void) {
  mps_newmark_def def;
  memset(&def, 0, sizeof def);
  if (mps_newmark_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Begins a motion at the fields `displacement` and `velocity` (zero where the set has none), with
 *  the acceleration that the loads give it. Reads `density`. Ends a former one. */
MPS_API MPS_NODISCARD mps_status mps_elastic_start(mps_elastic *elastic,
                                                   const mps_newmark_def *def);
/** Takes `count` (>= 0) steps under the present loads (they may be changed between calls), and
 *  writes `displacement`, `velocity`, `acceleration` and `reaction`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_step(mps_elastic *elastic, int64_t count);
MPS_API double mps_elastic_time(const mps_elastic *elastic); /* s since the start */
/** Kinetic energy (J) of the present motion. */
MPS_API MPS_NODISCARD mps_status mps_elastic_kinetic_energy(const mps_elastic *elastic,
                                                            double *out);

/** The lowest `count` circular eigenfrequencies (rad/s, ascending) of the supported body and, where
 *  `shapes` is not NULL, its modes: shapes[(k * n + i) * dim + c], i the particle's id, each of
 *  unit modal mass. By ARPACK on the inverse. Reads `density`. */
MPS_API MPS_NODISCARD mps_status mps_elastic_modes(mps_elastic *elastic, int32_t count,
                                                   double *omega, double *shapes);

MPS_EXTERN_C_END
#endif
