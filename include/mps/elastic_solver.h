/* mps/elastic_solver.h - another solver of implicit elasticity's equations in place of the
 * library's own: an algebraic multigrid, a solver on several machines (mps/petsc.h has both).
 *
 * The equation A x = b is symmetric and positive definite, with mps_particles_dim rows a particle
 * in ascending order of ids: its displacement along the axes or, where supports hold it, first
 * along the prescribed directions, which have a row of their diagonal alone, then along the free
 * ones. A is K, in motions K plus a multiple of the masses; it changes with supports, material and
 * step.
 *
 * The ranks of a domain (mps_elastic_def.domain) may solve one equation together: `part` is then
 * the rank and `parts` the number of ranks. Particles are ordered by layers across the body's
 * longest axis, by ids within a layer, and a rank has the rows, neighbours, joints and stresses of
 * its part of them alone; positions, moduli, displacements, forces and the set it has of all.
 * Before each call of a callback ranks agree on a status: where one of them has failed, none calls
 * it. With a domain all functions of mps/elastic.h are collective, mps_particles_remove too, except
 * mps_elastic_select_facets, _facet_count, _get_def, _get_report, _get_reaction, and _get_facets
 * without displacement and velocity; so arguments are the same on all ranks. mps_elastic_save
 * writes one file, by rank 0. The domain is kept alive.
 *
 * Thread rule: as mps/elastic.h; the callbacks are called by the thread that solves, outside of the
 * context's executor. SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_ELASTIC_SOLVER_H
#define LIBMPS_ELASTIC_SOLVER_H

#include "elastic.h"

MPS_EXTERN_C_BEGIN

typedef enum mps_elastic_solver_foreign {
  MPS_ELASTIC_SOLVER_FOREIGN = 4 /* mps_elastic_report.solver: a solver of mps_elastic_set_solver */
} mps_elastic_solver_foreign;

/** The matrix, or the rows of this process. Row first + i has the columns column[start[i]] to
 *  column[start[i + 1] - 1], ascending, with the diagonal and both halves. */
typedef struct mps_elastic_matrix {
  int64_t all;          /* rows of the equation */
  int64_t first, rows;  /* the part; both multiples of `block`; no rows where ranks outnumber
                           particles */
  int32_t block;        /* rows of a particle, 2 or 3 */
  int32_t modes;        /* 3 or 6: rigid motions */
  const int64_t *start; /* rows + 1, from 0 */
  const int32_t *column;
  const double *value; /* N/m */
  const double *mode; /* modes * rows, motion after motion: each in the part's rows, 0 in prescribed
                         ones: the near null space of multigrids */
} mps_elastic_matrix;

/** Receives a matrix, whose arrays are valid during the call. `size` is that of the struct. */
typedef mps_status (*mps_elastic_matrix_fn)(void *user, const mps_elastic_matrix *matrix,
                                            size_t size);

/** Solves A x = b with the last matrix. `b` and `x` have all rows, on every process; `x` is 0 and
 *  receives the solution: |b - A x| <= `tolerance` |b|, which the library checks. `iterations` (0
 *  at the call) may be set, for the report. */
typedef mps_status (*mps_elastic_solve_fn)(void *user, const double *b, double tolerance, double *x,
                                           int64_t *iterations);

typedef struct mps_elastic_solver_def {
  uint32_t struct_size;
  int32_t part, parts;          /* of the rows: 0 <= part < parts; default 0 of 1 */
  int32_t reserved;             /* 0 */
  void *user;                   /* passed to both; the caller's own */
  mps_elastic_matrix_fn matrix; /* no default */
  mps_elastic_solve_fn solve;   /* no default */
} mps_elastic_solver_def;

/** Fills `def` (of `size` bytes) with the defaults. MPS_ERROR_ARGUMENT: NULL, or a size unknown to
 *  this library. */
MPS_API mps_status mps_elastic_solver_def_init(mps_elastic_solver_def *def, size_t size);
static inline mps_elastic_solver_def mps_elastic_solver_defaults(void) {
  mps_elastic_solver_def def;
  memset(&def, 0, sizeof def);
  if (mps_elastic_solver_def_init(&def, sizeof def) != MPS_OK) def.struct_size = 0;
  return def;
}

/** Sets a solver, between steps, in place of `solver`, `ordering` and `refinements` of the
 *  definition; its `tolerance` stays. `def` NULL: the library's own solver. A status of a callback
 *  ends the solution or step, which is undone, as does a residual above the tolerance
 *  (MPS_ERROR_NUMERIC). The solver is part of no snapshot and no file. MPS_ERROR_ARGUMENT: a member
 *  of `def` out of range; MPS_ERROR_STATE: as mps_elastic_update_material; MPS_ERROR_MEMORY. */
MPS_API MPS_NODISCARD mps_status mps_elastic_set_solver(mps_elastic *e,
                                                        const mps_elastic_solver_def *def);

MPS_EXTERN_C_END
#endif
