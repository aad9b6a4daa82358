/* mps/experimental/petsc.h - domains (mps/experimental/domain.h) on MPI, and solvers of large
 * equations by PETSc. In a library of its own, libmps-petsc, which is built where PETSc is found
 * (CMake: the component `petsc` of the package mps; pkg-config: libmps-petsc).
 *
 * MPI and PETSc, where not running yet, are started without signal handlers, and ended with the
 * last domain or solver; MPI cannot be started a second time (MPS_ERROR_STATE). MPI or PETSc
 * started by the program are not ended. An error of MPI or PETSc is returned as a status with a
 * record in the context: nothing is printed or aborted. No handle of MPI is part of the binary
 * interface: communicators are passed as integers, by MPI_Comm_c2f.
 *
 * Include <mpi.h> before this header for mps_petsc_domain_create.
 *
 * Thread rule: one thread of a process at a time, the one that has started MPI.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_EXPERIMENTAL_PETSC_H
#define LIBMPS_EXPERIMENTAL_PETSC_H

#ifndef MPS_EXPERIMENTAL
#error                                                                                             \
    "experimental interface, which may change in any minor release: #define MPS_EXPERIMENTAL first"
#endif

#include "domain.h"
#include "linear_solver.h"

#define MPS_PETSC_API MPS_API

MPS_EXTERN_C_BEGIN

/** Makes a domain of the processes of a communicator, given by MPI_Comm_c2f; collective. The
 *  communicator is duplicated. MPS_ERROR_STATE: MPI is not running or has been ended;
 *  MPS_ERROR_ARGUMENT: the communicator is MPI_COMM_NULL or joins two groups. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_domain_create_c2f(mps_context *context,
                                                                   int32_t communicator,
                                                                   mps_domain **out);
/** Makes a domain of all processes that mpirun has started, of this one alone without it.
 *  MPS_ERROR_STATE: MPI has been ended; MPS_ERROR_MEMORY. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_domain_create_world(mps_context *context,
                                                                     mps_domain **out);

#ifdef MPI_VERSION
MPS_NODISCARD static inline mps_status
mps_petsc_domain_create(mps_context *context, MPI_Comm communicator, mps_domain **out) {
  return mps_petsc_domain_create_c2f(context, (int32_t)MPI_Comm_c2f(communicator), out);
}
#endif

/* ---- equations ------------------------------------------------------------------------------- */

typedef struct mps_petsc_solver mps_petsc_solver;

typedef enum mps_petsc_method {
  MPS_PETSC_METHOD_MULTIGRID = 0, /* conjugate gradients with an algebraic multigrid (GAMG):
                              iterations hardly grow with the size. A multigrid is reused for
                              several equations, as long as its convergence is good enough */
  MPS_PETSC_METHOD_DIRECT = 1     /* a Cholesky factor by MUMPS for every equation */
} mps_petsc_method;

/** Makes a solver (mps_petsc_method) of this process alone, for one mps_solver at a time. Records
 * of its failures go to `context`, that of the mps_solver, which must outlive it. PETSc's options
 * that begin with mps_ change it: PETSC_OPTIONS="-mps_pc_type hypre". MPS_ERROR_UNSUPPORTED: PETSc
 * was built without this solver, or an option is unknown to it.
 *
 *  Where PETSc fails on one of several processes, the others may wait for it within PETSc, without
 *  a way to notify them. After -mps_patience seconds (default 60) the failed one returns the error;
 *  from then on every function of a domain of MPI returns MPS_ERROR_IO at once on this process, no
 *  object can be created (MPS_ERROR_STATE), and MPI is not ended: the process should report the
 *  error and exit, upon which mpirun ends the others. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_solver_create(mps_context *context, int32_t method,
                                                               mps_petsc_solver **out);
/** As mps_petsc_solver_create, of all processes that mpirun has started, which solve the equations
 *  of one model together. Collective. MPS_ERROR_UNSUPPORTED as there; MPS_ERROR_STATE: MPI has been
 *  ended. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_solver_create_world(mps_context *context,
                                                                     int32_t method,
                                                                     mps_petsc_solver **out);
/** As mps_petsc_solver_create_world, of the processes of a communicator by MPI_Comm_c2f, which is
 *  duplicated. MPS_ERROR_ARGUMENT: the communicator is MPI_COMM_NULL or joins two groups; other
 *  errors as there. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_solver_create_c2f(mps_context *context,
                                                                   int32_t method,
                                                                   int32_t communicator,
                                                                   mps_petsc_solver **out);
/** Releases and nulls; accepts NULL. The mps_solver that it was set for must have been destroyed
 *  before, or have another linear solver. */
MPS_PETSC_API void mps_petsc_solver_destroy(mps_petsc_solver **solver);

/** The definition of `solver` for mps_solver_set_linear_solver, for each of its equations. `least`
 * may be set before: the multigrid may be faster than the library's own solver of the fluid's
 * pressure from some hundred thousand particles on, for water that starts from rest
 * (docs/fluid.md), and docs/pore-water.md compares it with that of pore pressures. A solver of
 * several processes is for the domain of these processes, in the same order; results then depend on
 * their number within the tolerance. `release` is NULL: `solver` stays the caller's.
 * MPS_ERROR_ARGUMENT: NULL. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_linear_solver(mps_petsc_solver *solver,
                                                               mps_linear_solver_def *def);

MPS_EXTERN_C_END
#endif
