/* domain.c - weak efficiency of explicit dynamics on ranks: mpirun -n N bench-domain [PARTICLES
 * [CALLS]], the number of particles a rank (20000) and of calls of ten steps (60). Each rank has
 * one thread. The least of many steps counts: on a busy machine the others tell of its other
 * programs. SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/dynamics.h>
#include <mps/petsc.h>

#include <math.h>

enum { STEPS = 10 };

/* Ground of so many particles, twice as wide as high. */
static mps_particles *ground(mps_context *context, int64_t count) {
  mps_particles_def def = mps_particles_defaults();
  mps_particles *set = NULL;
  def.spacing = 1.0;
  check(context, mps_particles_create(context, &def, &set), "set");
  const double high = floor(sqrt(0.5 * (double)count));
  const double lo[2] = {0.0, 0.0}, hi[2] = {floor((double)count / high), high};
  check(context, mps_particles_fill_box(set, lo, hi, NULL), "fill");
  check(context, mps_particles_set(set, "density", 0, 1900.0), "density");
  check(context, mps_particles_set(set, "shear_velocity", 0, 200.0), "velocity");
  check(context, mps_particles_set(set, "pressure_velocity", 0, 400.0), "velocity");
  check(context, mps_particles_set(set, "damping", 0, 0.02), "damping");
  return set;
}

int main(int argc, char **argv) {
  const int64_t each = argc > 1 ? atoll(argv[1]) : 20000;
  const int calls = argc > 2 ? atoi(argv[2]) : 60;
  mps_context_def def = mps_context_defaults();
  mps_context *context = NULL;
  mps_domain *domain = NULL;
  mps_dynamics *dynamics = NULL;
  def.executor = MPS_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&def, &context, NULL, 0), "context");
  check(context, mps_petsc_domain_create_world(context, &domain), "domain");
  const int32_t ranks = mps_domain_size(domain);
  mps_particles *set = ground(context, each * ranks);
  const int64_t whole = mps_particles_count(set);
  mps_dynamics_def solver = mps_dynamics_defaults();
  solver.domain = domain;
  double start = seconds();
  check(context, mps_dynamics_create(context, set, &solver, &dynamics), "solver");
  double made = seconds() - start, least = INFINITY;
  check(context, mps_dynamics_step(dynamics, 1), "step"); /* finds dt */
  for (int k = 0; k < calls; k++) {
    start = seconds();
    check(context, mps_dynamics_step(dynamics, STEPS), "step");
    least = fmin(least, (seconds() - start) / STEPS);
  }
  double most[2] = {made, least};
  check(context, mps_domain_max(domain, 2, most), "times");
  if (mps_domain_rank(domain) == 0)
    printf("%d ranks, %lld particles: made in %.2f s, %.3f ms a step (least), %.1f ns a particle "
           "and rank\n",
           (int)ranks, (long long)whole, most[0], 1e3 * most[1],
           1e9 * most[1] * ranks / (double)whole);
  mps_dynamics_destroy(&dynamics);
  mps_particles_destroy(&set);
  mps_domain_destroy(&domain);
  mps_context_destroy(&context);
  return 0;
}
