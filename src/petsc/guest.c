/* guest.c - see guest.h. SPDX-License-Identifier: BSD-3-Clause */
#include "guest.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* The one state of the process: MPI and PETSc exist once in it. */
static struct {
  int objects;
  void (*before_end)(void);
  bool began_mpi, began_petsc;
  bool stranded;
  char said[300]; /* the error that PETSc has reported first */
} guest;

/* PETSc's errors come back as codes and are not printed; the innermost is kept. */
static PetscErrorCode quiet(MPI_Comm comm, int line, const char *function, const char *file,
                            PetscErrorCode code, PetscErrorType type, const char *message,
                            void *context) {
  const char *text = message;
  if (!text || !text[strspn(text, " ")]) (void)PetscErrorMessage(code, &text, NULL);
  if (!guest.said[0])
    snprintf(guest.said, sizeof guest.said, "PETSc's error %d in %.60s: %.200s", (int)code,
             function ? function : "a function", text ? text : "no text");
  return code;
}

void mpsi_petsc_listen(void) { guest.said[0] = '\0'; }

mps_status mpsi_petsc_fail(mps_context *context, const char *function, mps_status status,
                           const char *what) {
  char line[480];
  snprintf(line, sizeof line, "%.150s%s%s", what, guest.said[0] ? ": " : "", guest.said);
  guest.said[0] = '\0';
  return mps_context_set_error(context, status, function, line);
}

void mpsi_petsc_strand(void) { guest.stranded = true; }
int mpsi_petsc_stranded(void) { return guest.stranded; }

mps_status mpsi_petsc_duplicate(mps_context *context, const char *function, MPI_Comm from,
                                MPI_Comm *out) {
  MPI_Errhandler former;
  char text[MPI_MAX_ERROR_STRING] = "";
  int between = 0, length = 0;
  if (from == MPI_COMM_NULL)
    return mps_context_set_error(context, MPS_ERROR_ARGUMENT, function,
                                 "the communicator is none (MPI_COMM_NULL)");
  if (MPI_Comm_get_errhandler(from, &former) != 0)
    return mps_context_set_error(context, MPS_ERROR_IO, function, "MPI_Comm_get_errhandler failed");
  int code = MPI_Comm_set_errhandler(from, MPI_ERRORS_RETURN);
  if (code == 0) code = MPI_Comm_test_inter(from, &between);
  if (code == 0 && !between) code = MPI_Comm_dup(from, out);
  (void)MPI_Comm_set_errhandler(from, former);
  (void)MPI_Errhandler_free(&former);
  if (between)
    return mps_context_set_error(context, MPS_ERROR_ARGUMENT, function,
                                 "the communicator is one between two groups of processes");
  if (code != 0) {
    if (MPI_Error_string(code, text, &length) != 0) text[0] = '\0';
    return mps_context_set_error(context, MPS_ERROR_IO, function,
                                 text[0] ? text : "MPI has failed");
  }
  (void)MPI_Comm_set_errhandler(*out, MPI_ERRORS_RETURN);
  return MPS_OK;
}

void mpsi_petsc_before_end(void (*task)(void)) { guest.before_end = task; }

mps_status mpsi_petsc_enter(void) {
  PetscBool petsc = PETSC_FALSE;
  int mpi = 0, ended = 0;
  if (guest.stranded) return MPS_ERROR_STATE;
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
  if (--guest.objects > 0 || guest.stranded) return; /* ending MPI waits for all processes */
  if (guest.began_mpi && guest.before_end) guest.before_end();
  if (guest.began_petsc) (void)PetscFinalize();
  if (guest.began_mpi) (void)MPI_Finalize();
  guest.began_petsc = guest.began_mpi = false;
}
