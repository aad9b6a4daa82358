/* petsc_solves.h - sets PETSc for an equation of a solver, of at least so many rows.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_TEST_MPI_PETSC_SOLVES_H
#define MPS_TEST_MPI_PETSC_SOLVES_H

#include <mps/mps.h>
#include <mps/experimental/petsc.h>

static inline mps_status petsc_solves(mps_petsc_solver *petsc, mps_solver *solver, int32_t equation,
                                      int64_t least) {
  mps_linear_solver_def def;
  const mps_status status = mps_petsc_linear_solver(petsc, &def);
  def.least = least;
  return status == MPS_OK ? mps_solver_set_linear_solver(solver, equation, &def) : status;
}

#endif
