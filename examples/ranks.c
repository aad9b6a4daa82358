/* ranks.c - one model on several processes, of one machine or of many:
 *
 *   mpirun -n 2 ranks
 *
 * A column of sand collapses. Each process makes the same set, and keeps the part that its domain
 * gives it; what they find together must have the bits of what each finds alone. Without mpirun
 * there is one process. Needs libmps-petsc, which has the transport by MPI.
 * SPDX-License-Identifier: BSD-3-Clause */
#define MPS_EXPERIMENTAL 1
#include <mps/experimental/domain.h>
#include <mps/experimental/petsc.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

/* One line of the results; 1 where `got` is farther from the right value than `bound`. */
static int compare(const char *what, double got, double right, double bound) {
  printf("%-44s %11.5g   right: %11.5g +- %.2g\n", what, got, right, bound);
  return !(fabs(got - right) <= bound);
}

/* The front of the sand, m, and its kinetic energy, J, after 0.2 s. `domain` NULL: alone. */
static void collapse(mps_context *context, mps_domain *domain, double *front, double *kinetic) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.1, 0.2};
  mps_particles_def set = mps_particles_defaults();
  mps_material_drucker_prager_def rule = mps_material_drucker_prager_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_particles *sand = NULL;
  mps_material *law = NULL;
  mps_mpm *mpm = NULL;
  set.spacing = 0.005, def.cell = 0.01;
  rule.young = 1e6, rule.friction = 0.6;
  def.lower[0] = def.lower[1] = 0.0, def.gravity[1] = -9.81;
  def.domain = domain; /* the one line that a program on ranks needs more */
  ok(mps_particles_create(context, &set, &sand));
  ok(mps_particles_fill_box(sand, lo, hi, NULL));
  ok(mps_particles_set(sand, "density", 0, 1600.0));
  ok(mps_material_create_drucker_prager(context, &rule, &law));
  ok(mps_mpm_create(context, sand, law, &def, &mpm));
  ok(mps_mpm_set_side(mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
  ok(mps_mpm_run(mpm, 0.2, 1, NULL, NULL));

  mps_view x; /* of this process's own particles */
  mps_totals totals;
  *front = 0.0;
  ok(mps_particles_view(sand, "position", &x));
  for (int64_t i = 0; i < x.shape[0]; i++) *front = fmax(*front, *mps_view_f64(&x, i, 0));
  if (domain) printf("rank %d: %lld particles\n", mps_domain_rank(domain), (long long)x.shape[0]);
  if (domain) ok(mps_domain_max(domain, 1, front));
  ok(mps_mpm_get_totals(mpm, &totals)); /* of all ranks */
  *kinetic = totals.kinetic;
  mps_mpm_destroy(&mpm);
  mps_material_destroy(&law);
  mps_particles_destroy(&sand);
}

int main(void) {
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  double front[2], kinetic[2];
  ok(mps_context_create(NULL, &context, NULL, 0));
  ok(mps_petsc_domain_create_world(context, &domain));
  collapse(context, domain, &front[0], &kinetic[0]);
  collapse(context, NULL, &front[1], &kinetic[1]);

  int wrong = 0;
  if (mps_domain_rank(domain) == 0) {
    printf("%d ranks, and one alone:\n", mps_domain_size(domain));
    wrong = compare("front, m", front[0], front[1], 0.0);
    wrong += compare("kinetic energy, J", kinetic[0], kinetic[1], 0.0);
  }
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return wrong > 0;
}
