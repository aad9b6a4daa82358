/* mps/experimental/linear_solver.h - a linear solver of the caller in place of the library's own:
 * an algebraic multigrid, a direct solver to check with, a solver on several machines
 * (mps/experimental/petsc.h has all three).
 *
 * Each equation A x = b is symmetric and positive definite. On the ranks of a domain each has an
 * interval of the rows, in the order of the ranks, and all solve together:
 *
 * - STIFFNESS: implicit elasticity, K, in motions K plus a multiple of the masses. It changes with
 *   supports, material and step. mps_particles_dim rows a particle in ascending order of ids (on
 *   ranks: by layers across the body's longest axis, then by ids): the displacement along the axes
 *   or, where supports fix the particle, first along the prescribed directions, whose rows have
 *   their diagonal alone, then along the free ones. `mode` has the rigid motions. Start: 0.
 * - PRESSURE: the reduced pressure of the fluid, a row a particle in the present order of the set;
 *   another matrix each step. A particle apart from the others has a row of its diagonal alone.
 *   Start: extrapolated from former steps.
 * - PORE_PRESSURE: the implicit pressures of pore water (MPS_PORE_SCHEME_IMPLICIT of
 *   mps/experimental/pore_water.h), [S + dt T + dt^2 G^T m^-1 G] d = b (docs/pore-water.md), a row
 *   for each filled cell that is no part of a drained surface, in the order of the grid's cells,
 *   with at most 49 entries in the plane and 343 in space. Rows and columns are divided by the
 *   roots of their diagonals. Start: 0. Not called in steps where saturated ground is in contact
 *   with a body: contacts couple distant cells.
 *
 * The library computes the residual of each solution by its own operator.
 *
 * Before each call of a callback ranks agree on a status: where one of them has failed, none calls
 * it.
 *
 * Implicit elasticity on the ranks of a domain (mps_elastic_def.domain) is solved together by such
 * a solver, by each rank alone without one. A rank has the rows, neighbours, joints and stresses of
 * its part of the particles alone; positions, moduli, displacements, forces and the set it has of
 * all. All functions of mps/elastic.h are then collective, mps_particles_remove too, except
 * mps_elastic_select_facets, _facet_count, _get_def, _get_report, _get_reaction, and _get_facets
 * without displacement and velocity; so arguments are the same on all ranks. mps_elastic_save
 * writes one file, by rank 0. The domain is kept alive.
 *
 * Thread rule: as the solver's header; callbacks are called by the thread that steps or solves,
 * outside of the context's executor. They may query the solver, not step, change or destroy it.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_LINEAR_SOLVER_H
#define LIBMPS_EXPERIMENTAL_LINEAR_SOLVER_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "../solver.h"

MPS_EXTERN_C_BEGIN

/** The equation that is solved. */
typedef enum mps_linear_equation {
  MPS_LINEAR_EQUATION_STIFFNESS = 1,    /* of mps_elastic */
  MPS_LINEAR_EQUATION_PRESSURE = 2,     /* of mps_fluid */
  MPS_LINEAR_EQUATION_PORE_PRESSURE = 3 /* of mps_mpm with pore water */
} mps_linear_equation;

typedef enum mps_linear_change {
  MPS_LINEAR_CHANGE_PATTERN = 0, /* sizes or columns too; always so after `forget` */
  MPS_LINEAR_CHANGE_VALUES = 1   /* on no rank more than the values, since the last matrix */
} mps_linear_change;

/** This rank's rows of A. Row first + i has the columns column[start[i]] to column[start[i + 1] -
 * 1] of all rows, ascending, with the diagonal and both halves. */
typedef struct mps_linear_matrix {
  uint32_t struct_size; /* of the library's struct: what lies beyond an older one is not there */
  int32_t change;       /* mps_linear_change */
  int64_t all;          /* rows of the equation, < 2^31 */
  int64_t first, rows;  /* this rank's; `rows` may be 0 on ranks, not in one process */
  int32_t block;        /* rows of a particle or cell, which follow one another: 1, 2 or 3 */
  int32_t modes;        /* vectors that A nearly maps to 0: rigid motions, 3 or 6; 0: not given */
  const int64_t *start; /* rows + 1, from 0 */
  const int32_t *column;
  const double *value; /* of stiffness: N/m */
  const double *mode;  /* modes * rows, vector after vector, 0 in prescribed rows */
} mps_linear_matrix;

/** Receives a matrix, before the first solution with it. Its arrays are valid during the call. */
typedef mps_status (*mps_linear_matrix_fn)(void *user, const mps_linear_matrix *matrix);

/** What a solution reports; set to 0 and NaN at the call. */
typedef struct mps_linear_result {
  uint32_t struct_size; /* as of mps_linear_matrix */
  int32_t reserved;
  int64_t iterations; /* >= 0, for reports */
  double residual;    /* |b - A x| / |b| of all ranks; NaN: not known. A solution that has more than
                         twice this is refused */
} mps_linear_result;

/** Solves A x = b with the last matrix, this rank's `rows` of both vectors: `x` has a start and
 *  receives the solution, |b - A x| <= `tolerance` |b| over all ranks. */
typedef mps_status (*mps_linear_solve_fn)(void *user, const double *b, double tolerance, double *x,
                                          mps_linear_result *result);

/** Discards the data of former equations (a preconditioner), so that later solutions depend on
 *  later equations alone; the matrix comes again before the next solution. Snapshot, rollback, save
 *  and restore call it first: a run that continues after them has the bits of one that continues
 *  from the snapshot or the file. */
typedef mps_status (*mps_linear_forget_fn)(void *user);

typedef struct mps_linear_solver_def {
  uint32_t struct_size;
  int32_t rank, ranks; /* of the processes that solve together: those of the solver's domain, in
                          their order; default 0 of 1 */
  int32_t reserved;
  int64_t least;               /* rows of all ranks; smaller equations are solved by the library;
                                  >= 0; default 0 */
  void *user;                  /* passed to all; the caller's own */
  mps_release_fn release;      /* of `user`, with the solver or once another one is set */
  mps_linear_matrix_fn matrix; /* no default */
  mps_linear_solve_fn solve;   /* no default */
  mps_linear_forget_fn forget; /* default NULL: there are no such data */
} mps_linear_solver_def;

static inline mps_linear_solver_def mps_linear_solver_defaults(void) {
  mps_linear_solver_def def;
  memset(&def, 0, sizeof def);
  if (mps_def_init(MPS_DEF_LINEAR_SOLVER, &def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Sets a linear solver for `equation` (mps_linear_equation), between steps; `def` NULL: the
 *  library's own. Of implicit elasticity it replaces `solver`, `ordering` and `refinements` of the
 *  definition; tolerances stay those of the solver's definition (pore pressures: 1e-9 |b|). A
 * status of a callback ends the step or solution, which is not made (pore pressures: the solver has
 *  failed); so does a solution that is not finite, is written beyond its rows, or whose residual is
 *  above the tolerance or not what the result says (MPS_ERROR_NUMERIC). The linear solver is part
 * of no snapshot and no file. Collective. MPS_ERROR_ARGUMENT: the solver has no such equation, a
 * member of `def` is missing or out of range, or `rank` and `ranks` are not those of its domain;
 * MPS_ERROR_STATE: a step is open or has failed, there is no pore water, or a callback is running;
 * MPS_ERROR_UNSUPPORTED: ranks do not solve the published elastic method together;
 * MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_solver_set_linear_solver(mps_solver *solver, int32_t equation,
                                                              const mps_linear_solver_def *def);

MPS_EXTERN_C_END
#endif
