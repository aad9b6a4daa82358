/* guest.h - MPI and PETSc as a guest of the program: started where they are not running, ended with
 * the last object that has entered. SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_PETSC_GUEST_H
#define MPSI_PETSC_GUEST_H

#include <petscksp.h>
#include <petscsf.h>

#include <mps/petsc.h>

/* The status of a call of MPI or PETSc. */
#define MPSI_PETSC_STATUS(call) ((call) == 0 ? MPS_OK : MPS_ERROR_IO)

/* Each success is followed by one mpsi_petsc_leave. */
mps_status mpsi_petsc_enter(void);
void mpsi_petsc_leave(void);
/* What is called before MPI is ended here. */
void mpsi_petsc_before_end(void (*task)(void));

#endif
