/* domain_elastic.c - memory and time of implicit elasticity on ranks: mpirun -n N
 * bench-domain-elastic [UNKNOWNS [multigrid|direct [HEIGHT]]], of all ranks together (1e5). A block
 * in space, HEIGHT (1) times as high as wide, clamped below and pulled sideways above, solved by
 * PETSc's multigrid or by MUMPS. What the process holds
 * at most is the kernel's number, with the programs' code; PETSc's own memory is in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/elastic.h>
#include <mps/experimental/petsc.h>

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* VmHWM of this process, MB; 0 where there is no /proc. */
static double peak_memory(void) {
  char line[256];
  double kilobytes = 0.0;
  FILE *file = fopen("/proc/self/status", "r");
  while (file && fgets(line, sizeof line, file))
    if (strncmp(line, "VmHWM:", 6) == 0) kilobytes = atof(line + 6);
  if (file) fclose(file);
  return kilobytes / 1024.0;
}

typedef struct problem {
  mps_context *context;
  mps_domain *domain;
  mps_particles *particles;
  mps_elastic *elastic;
} problem;

static void make(problem *p, int64_t cells, double height) {
  mps_particles_def set = mps_particles_defaults();
  mps_elastic_def def = mps_elastic_defaults();
  const double lo[3] = {0, 0, 0}, hi[3] = {1, 1, height};
  set.dim = 3;
  set.spacing = 1.0 / (double)cells;
  def.domain = p->domain;
  check(p->context, mps_particles_create(p->context, &set, &p->particles), "particles");
  check(p->context, mps_particles_fill_box(p->particles, lo, hi, NULL), "fill");
  check(p->context, mps_particles_set(p->particles, "young", 0, 1.0), "young");
  check(p->context, mps_particles_set(p->particles, "poisson", 0, 0.3), "poisson");
  check(p->context, mps_elastic_create(p->context, p->particles, &def, &p->elastic), "create");
  const int64_t n = mps_particles_count(p->particles);
  int64_t *ids = malloc((size_t)n * sizeof *ids), count = 0;
  const double base[3] = {1, 1, set.spacing};
  if (!ids) check(NULL, MPS_ERROR_MEMORY, "ids");
  check(p->context, mps_particles_select_box(p->particles, lo, base, n, &count, ids), "select");
  mps_elastic_boundary_def clamp = mps_elastic_boundary_defaults();
  clamp.ids = ids, clamp.id_count = count;
  check(p->context, mps_elastic_add_boundary(p->elastic, &clamp, NULL), "boundary");
  check(p->context,
        mps_elastic_select_facets(p->elastic, MPS_SIDE_Z_UPPER, NULL, NULL, n, &count, ids),
        "facets");
  mps_elastic_load_def pull = mps_elastic_load_defaults();
  pull.kind = MPS_ELASTIC_LOAD_TRACTION;
  pull.ids = ids, pull.id_count = count;
  pull.force[0] = 1.0;
  check(p->context, mps_elastic_add_load(p->elastic, &pull, NULL), "load");
  free(ids);
}

int main(int argc, char **argv) {
  const double unknowns = argc > 1 ? atof(argv[1]) : 1e5;
  const bool direct = argc > 2 && strcmp(argv[2], "direct") == 0;
  const double height = argc > 3 ? fmax(1.0, atof(argv[3])) : 1.0;
  const int64_t cells = (int64_t)fmax(2.0, rint(cbrt(unknowns / 3.0 / height)));
  problem p = {.context = NULL};
  mps_petsc_solver *solver = NULL;
  mps_context_def def = mps_context_defaults();
  mps_elastic_report report;
  def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&def, &p.context, NULL, 0), "context");
  check(p.context, mps_petsc_domain_create_world(p.context, &p.domain), "domain");
  check(p.context,
        mps_petsc_solver_create_world(
            p.context, direct ? MPS_PETSC_METHOD_DIRECT : MPS_PETSC_METHOD_MULTIGRID, &solver),
        "solver");
  double most[6] = {peak_memory()};
  double start = seconds();
  make(&p, cells, height);
  most[3] = seconds() - start;
  most[1] = peak_memory();
  mps_linear_solver_def linear;
  check(p.context, mps_petsc_linear_solver(solver, &linear), "solver");
  check(p.context,
        mps_solver_set_linear_solver(mps_elastic_solver(p.elastic), MPS_LINEAR_EQUATION_STIFFNESS,
                                     &linear),
        "solver");
  start = seconds();
  check(p.context, mps_elastic_solve(p.elastic), "solve");
  most[4] = seconds() - start;
  most[2] = peak_memory();
  check(p.context, mps_domain_max(p.domain, 6, most), "times");
  check(p.context, mps_elastic_get_report(p.elastic, &report), "report");
  if (mps_domain_rank(p.domain) == 0)
    printf("%d ranks, %lld unknowns: %lld iterations, residual %.1e; made in %.2f s, solved in "
           "%.2f; at most %.0f MB a rank at the start, %.0f with the body, %.0f at the end\n",
           (int)mps_domain_size(p.domain), (long long)report.unknowns, (long long)report.iterations,
           report.residual, most[3], most[4], most[0], most[1], most[2]);
  mps_elastic_destroy(&p.elastic);
  mps_particles_destroy(&p.particles);
  mps_petsc_solver_destroy(&solver);
  mps_domain_destroy(&p.domain);
  mps_context_destroy(&p.context);
  return 0;
}
