/* guest.h - MPI and PETSc as a guest of the program: started where they are not running, ended with
 * the last object that has entered. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <petscksp.h>
#include <petscsf.h>

#include <mps/experimental/petsc.h>

/* The status of a call of MPI or PETSc. */
#define MPSI_PETSC_STATUS(call) ((call) == 0 ? MPS_OK : MPS_ERROR_IO)

/* Each success is followed by one mpsi_petsc_leave. */
mps_status mpsi_petsc_enter(void);
void mpsi_petsc_leave(void);
/* What is called before MPI is ended here. */
void mpsi_petsc_before_end(void (*task)(void));

/* A communicator of our own with the processes of another; an error of MPI comes back as a status,
 * with a record. */
mps_status mpsi_petsc_duplicate(mps_context *context, const char *function, MPI_Comm from,
                                MPI_Comm *out);
/* The record of a failure of MPI or PETSc: what failed, and what PETSc has said since
 * mpsi_petsc_listen. Returns `status`. */
void mpsi_petsc_listen(void);
mps_status mpsi_petsc_fail(mps_context *context, const char *function, mps_status status,
                           const char *what);

/* From now on no message reaches the other processes, which wait for this one within PETSc:
 * nothing here waits for them any more, and neither MPI nor PETSc is ended. */
void mpsi_petsc_strand(void);
int mpsi_petsc_stranded(void);
