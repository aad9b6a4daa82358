/* guest.c - see guest.h. SPDX-License-Identifier: BSD-3-Clause */
#include "guest.h"

#include <stdbool.h>

/* The one state of the process: MPI and PETSc exist once in it. */
static struct {
  int objects;
  void (*before_end)(void);
  bool began_mpi, began_petsc;
} guest;

/* PETSc's errors come back as codes and are not printed. */
static PetscErrorCode quiet(MPI_Comm comm, int line, const char *function, const char *file,
                            PetscErrorCode code, PetscErrorType type, const char *message,
                            void *context) {
  (void)comm, (void)line, (void)function, (void)file, (void)type, (void)message, (void)context;
  return code;
}

void mpsi_petsc_before_end(void (*task)(void)) { guest.before_end = task; }

mps_status mpsi_petsc_enter(void) {
  PetscBool petsc = PETSC_FALSE;
  int mpi = 0, ended = 0;
  if (MPI_Initialized(&mpi) != 0 || MPI_Finalized(&ended) != 0 || ended) return MPS_ERROR_STATE;
  if (!mpi) {
    int provided;
    if (MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &provided) != 0) return MPS_ERROR_IO;
    guest.began_mpi = true;
  }
  if (PetscInitialized(&petsc) != 0) return MPS_ERROR_IO;
  if (!petsc) {
    static char name[] = "libmps", option[] = "-no_signal_handler";
    char *words[] = {name, option, NULL}, **arguments = words;
    int count = 2;
    if (PetscInitialize(&count, &arguments, NULL, NULL) != 0) return MPS_ERROR_IO;
    guest.began_petsc = true;
  }
  if (PetscPushErrorHandler(quiet, NULL) != 0) return MPS_ERROR_IO;
  guest.objects++;
  return MPS_OK;
}

void mpsi_petsc_leave(void) {
  (void)PetscPopErrorHandler();
  if (--guest.objects > 0) return;
  if (guest.began_mpi && guest.before_end) guest.before_end();
  if (guest.began_petsc) (void)PetscFinalize();
  if (guest.began_mpi) (void)MPI_Finalize();
  guest.began_petsc = guest.began_mpi = false;
}
