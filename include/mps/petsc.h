/* mps/petsc.h - domains (mps/domain.h) on MPI, by PETSc. In a library of its own, libmps-petsc,
 * which is built where PETSc is found (CMake: the component `petsc` of the package mps; pkg-config:
 * libmps-petsc).
 *
 * The library is a guest of the program. Where MPI or PETSc is not running yet it is started,
 * without handlers of signals, and ended with the last domain; what the program has started is left
 * as it is. An error of MPI or PETSc comes back as a status. No handle of MPI is part of the binary
 * interface: communicators are passed as integers, by MPI_Comm_c2f.
 *
 * Include <mpi.h> before this header for mps_petsc_domain_create.
 *
 * Thread rule: one thread of a process at a time, the one that has started MPI.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef LIBMPS_PETSC_H
#define LIBMPS_PETSC_H

#include "domain.h"

#define MPS_PETSC_API MPS_API

MPS_EXTERN_C_BEGIN

/** Makes a domain of the processes of a communicator, given by MPI_Comm_c2f; collective. The
 *  communicator is duplicated. MPS_ERROR_STATE: MPI is not running or has been ended. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_domain_create_c2f(mps_context *context,
                                                                   int32_t communicator,
                                                                   mps_domain **out);
/** Makes a domain of all processes that mpirun has started, of this one alone without it. */
MPS_PETSC_API MPS_NODISCARD mps_status mps_petsc_domain_create_world(mps_context *context,
                                                                     mps_domain **out);

#ifdef MPI_VERSION
MPS_NODISCARD static inline mps_status
mps_petsc_domain_create(mps_context *context, MPI_Comm communicator, mps_domain **out) {
  return mps_petsc_domain_create_c2f(context, (int32_t)MPI_Comm_c2f(communicator), out);
}
#endif

MPS_EXTERN_C_END
#endif
