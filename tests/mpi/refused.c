/* refused.c NUMBER - implicit elasticity on several ranks, of which rank 1 is refused the
 * allocation of that number inside PETSc. Ends with 0 where ranks report the error, all or that one
 * alone (the others then wait for it within PETSc), with 3 where there was none, and with 4 where
 * what must hold after an error does not. SPDX-License-Identifier: BSD-3-Clause */
#include "petsc_solves.h"

#include <petscsys.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static long left; /* allocations until the one that is refused; 0: none is */

static PetscErrorCode refuse(size_t size, PetscBool clear, int line, const char *function,
                             const char *file, void **out) {
  (void)line, (void)function, (void)file;
  if (left > 0 && --left == 0) return PETSC_ERR_MEM;
  *out = size == 0 ? NULL : clear ? calloc(size, 1) : malloc(size);
  return size == 0 || *out ? 0 : PETSC_ERR_MEM;
}

static PetscErrorCode release(void *memory, int line, const char *function, const char *file) {
  (void)line, (void)function, (void)file;
  free(memory);
  return 0;
}

static PetscErrorCode resize(size_t size, int line, const char *function, const char *file,
                             void **memory) {
  (void)line, (void)function, (void)file;
  void *other = realloc(*memory, size);
  if (size > 0 && !other) return PETSC_ERR_MEM;
  *memory = other;
  return 0;
}

static mps_status build(mps_context *context, mps_domain *domain, mps_petsc_solver *solver,
                        mps_particles **set, mps_elastic **elastic) {
  mps_particles_def def = mps_particles_defaults();
  mps_elastic_def body = mps_elastic_defaults();
  mps_elastic_boundary_def held = mps_elastic_boundary_defaults();
  mps_elastic_load_def load = mps_elastic_load_defaults();
  const double lo[2] = {0.0, 0.0}, hi[2] = {4.0, 1.0};
  def.spacing = 0.1;
  body.domain = domain;
  held.lower[0] = -1.0, held.lower[1] = -1.0;
  held.upper[0] = 0.2, held.upper[1] = 2.0;
  load.kind = MPS_ELASTIC_LOAD_VOLUME, load.all = 1;
  load.force[1] = -1.0;
  mps_status status = mps_particles_create(context, &def, set);
  if (status == MPS_OK) status = mps_particles_fill_box(*set, lo, hi, NULL);
  if (status == MPS_OK) status = mps_particles_set(*set, "young", 0, 1e6);
  if (status == MPS_OK) status = mps_particles_set(*set, "poisson", 0, 0.3);
  if (status == MPS_OK) status = mps_elastic_create(context, *set, &body, elastic);
  if (status == MPS_OK) status = mps_elastic_add_boundary(*elastic, &held, NULL);
  if (status == MPS_OK) status = mps_elastic_add_load(*elastic, &load, NULL);
  return status == MPS_OK
             ? petsc_solves(solver, mps_elastic_solver(*elastic), MPS_LINEAR_EQUATION_STIFFNESS, 0)
             : status;
}

int main(int argc, char **argv) {
  if (argc != 2 || PetscMallocSet(refuse, release, resize) != 0) return 2;
  mps_context_def def = mps_context_defaults();
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  mps_petsc_solver *solver = NULL;
  mps_particles *set = NULL;
  mps_elastic *elastic = NULL;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  mps_status status = mps_context_create(&def, &context, NULL, 0);
  if (status == MPS_OK) status = mps_petsc_domain_create_world(context, &domain);
  if (status == MPS_OK)
    status = mps_petsc_solver_create_world(context, MPS_PETSC_METHOD_MULTIGRID, &solver);
  if (status == MPS_OK) status = build(context, domain, solver, &set, &elastic);
  if (status != MPS_OK) {
    fprintf(stderr, "refused: %s\n", mps_context_error(context)->message);
    return 2;
  }
  mps_domain *none = NULL; /* MPI itself would end the program */
  const int32_t nobody = (int32_t)MPI_Comm_c2f(MPI_COMM_NULL);
  if (mps_petsc_domain_create_c2f(context, nobody, &none) != MPS_ERROR_ARGUMENT ||
      !strstr(mps_context_error(context)->message, "MPI_COMM_NULL"))
    return 4;
  if (mps_domain_rank(domain) == 1) left = strtol(argv[1], NULL, 10);
  status = mps_elastic_solve(elastic);
  left = 0;
  const mps_error *error = mps_context_error(context);
  if (mps_domain_rank(domain) == 1 && status != MPS_OK) {
    printf("refused: %s: %s\n", error->function, error->message);
    if (error->status != status || !strstr(error->message, "PETSc")) return 4;
  }
  if (status != MPS_OK && strstr(error->message, "this process must end")) {
    double value = 0.0; /* nothing waits here any more */
    if (mps_domain_agree(domain, MPS_OK) != MPS_ERROR_IO) return 4;
    if (mps_domain_max(domain, 1, &value) != MPS_ERROR_IO) return 4;
    if (mps_elastic_solve(elastic) == MPS_OK) return 4;
    fflush(stdout);
  }
  mps_elastic_destroy(&elastic);
  mps_particles_destroy(&set);
  mps_petsc_solver_destroy(&solver);
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return status == MPS_OK ? 3 : 0;
}
