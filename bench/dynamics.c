/* dynamics.c - benchmark of the explicit MPS step: ns per particle-step and per pair for square
 * bodies from 1e3 to 1e6 particles, one thread and two, beside a plain serial loop of the same
 * equations. The three are timed in turn, in rounds, in one process; minima are compared, so that
 * the ratios hold when the machine's speed drifts.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"
#include "plain_dynamics.h"

#include <mps/dynamics.h>
#include <mps/experimental/neighbours.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS 5

/* One contender of the library: its own context, particles and solver. */
typedef struct contender {
  mps_context *context;
  mps_particles *particles;
  mps_dynamics *dynamics;
  double best; /* s a step */
} contender;

static contender contender_create(int64_t columns, int64_t rows, int threads, double damping,
                                  int isa) {
  contender c = {.best = INFINITY};
  char text[256] = "";
  mps_context_def context_def = mps_context_defaults();
  context_def.threads = threads;
  context_def.instruction_level = isa;
  if (threads == 1) context_def.executor = MPS_CONTEXT_EXECUTOR_SERIAL;
  check(NULL, mps_context_create(&context_def, &c.context, text, sizeof text), text);
  mps_particles_def set = mps_particles_defaults();
  set.spacing = 1.0;
  const double lo[2] = {0.0, 0.0}, hi[2] = {(double)columns, (double)rows};
  check(c.context, mps_particles_create(c.context, &set, &c.particles), "particles");
  check(c.context, mps_particles_fill_box(c.particles, lo, hi, NULL), "fill");
  check(c.context, mps_particles_set(c.particles, "density", 0, 1500.0), "density");
  check(c.context, mps_particles_set(c.particles, "shear_velocity", 0, 100.0), "Vs");
  check(c.context, mps_particles_set(c.particles, "pressure_velocity", 0, 200.0), "Vp");
  check(c.context, mps_particles_set(c.particles, "damping", 0, damping), "damping");
  check(c.context, mps_particles_set(c.particles, "velocity", 0, 0.0), "velocity");
  mps_view x;
  mps_edit v;
  check(c.context, mps_particles_view(c.particles, "position", &x), "position");
  check(c.context, mps_particles_edit(c.particles, "velocity", &v), "velocity");
  for (int64_t k = 0; k < x.shape[0]; k++)
    *mps_edit_f64(&v, k, 0) = 1e-3 * sin(0.1 * *mps_view_f64(&x, k, 1));
  check(c.context, mps_particles_commit(c.particles, &v), "velocity");
  mps_dynamics_def def = mps_dynamics_defaults();
  def.dt = 1e-4;
  check(c.context, mps_dynamics_create(c.context, c.particles, &def, &c.dynamics), "solver");
  return c;
}

static void contender_destroy(contender *c) {
  mps_dynamics_destroy(&c->dynamics);
  mps_particles_destroy(&c->particles);
  mps_context_destroy(&c->context);
}

static plain_body plain_square(int64_t columns, int64_t rows, double damping) {
  const int64_t n = columns * rows;
  double *xy = plain_doubles(2 * n);
  for (int64_t k = 0; k < n; k++) {
    xy[2 * k] = (double)(k % columns) + 0.5;
    xy[2 * k + 1] = (double)(k / columns) + 0.5;
  }
  plain_body b = plain_create(n, xy, 1.0, 1.5);
  b.dt = 1e-4;
  b.alpha = damping * 4.0 * 3.14159265358979 * 14.0 / 15.0;
  b.beta = damping / (3.14159265358979 * 15.0);
  b.first = malloc((size_t)(n + 1) * sizeof *b.first);
  b.neighbour = malloc((size_t)(8 * n) * sizeof *b.neighbour);
  if (!b.first || !b.neighbour) abort();
  int64_t at = 0;
  for (int64_t k = 0; k < n; k++) {
    b.first[k] = at;
    for (int j = -1; j <= 1; j++)
      for (int i = -1; i <= 1; i++) {
        const int64_t x = k % columns + i, y = k / columns + j;
        if ((i || j) && x >= 0 && x < columns && y >= 0 && y < rows)
          b.neighbour[at++] = (int32_t)(y * columns + x);
      }
    b.rho[k] = 1500.0;
    b.mu[k] = 1500.0 * 1e4;
    b.lambda[k] = 1500.0 * 2e4;
    b.r_old[3 * k] -= b.dt * 1e-3 * sin(0.1 * xy[2 * k + 1]);
  }
  b.first[n] = at;
  free(xy);
  return b;
}

static void time_size(int64_t columns, int64_t rows, double damping, int isa) {
  const int64_t n = columns * rows;
  const int64_t steps = n < 2000 ? 4000 : n < 20000 ? 400 : n < 200000 ? 40 : 6;
  const int64_t plain_steps = steps / 4 > 2 ? steps / 4 : 2;
  plain_body plain = plain_square(columns, rows, damping);
  contender one = contender_create(columns, rows, 1, damping, isa);
  contender two = contender_create(columns, rows, 2, damping, isa);
  contender *both[2] = {&one, &two};
  double plain_best = INFINITY;
  for (int round = 0; round <= ROUNDS; round++) { /* round 0 warms up */
    double start = seconds();
    for (int64_t k = 0; k < plain_steps; k++) plain_step(&plain);
    const double plain_time = (seconds() - start) / (double)plain_steps;
    if (round > 0 && plain_time < plain_best) plain_best = plain_time;
    for (int c = 0; c < 2; c++) {
      start = seconds();
      check(both[c]->context, mps_dynamics_step(both[c]->dynamics, steps), "step");
      const double time = (seconds() - start) / (double)steps;
      if (round > 0 && time < both[c]->best) both[c]->best = time;
    }
  }
  const double ns = 1e9 / (double)n, pairs = 0.5 * (double)plain.first[n];
  printf("%9lld %7.3g %9.1f %9.1f %9.1f %10.2f %10.2f %8.2f %8.2f\n", (long long)n, damping,
         plain_best * ns, one.best * ns, two.best * ns, 1e9 * one.best / pairs,
         1e9 * two.best / pairs, plain_best / one.best, plain_best / two.best);
  fflush(stdout);
  contender_destroy(&one);
  contender_destroy(&two);
  plain_free(&plain);
}

int main(int argc, char **argv) {
  const int isa = argc > 1 ? atoi(argv[1]) : 0;
  if (argc > 2 || (argc == 2 && isa != 0 && isa != 1 && isa != 3 && isa != 4)) {
    fprintf(stderr, "usage: bench-dynamics [LEVEL]   x86-64 level of the inner loops: 0 (best), "
                    "1, 3 or 4\n");
    return 2;
  }
  printf("# explicit MPS elastodynamics, Verlet, removal (12); minima of %d rounds\n", ROUNDS);
  printf(
      "# particles damping plain_ns  one_ns   two_ns  one_ns/pair two_ns/pair ratio_1 ratio_2\n");
  printf("#           h       a particle-step ...                               plain/one "
         "plain/two\n");
  const int64_t sizes[][2] = {{10, 100}, {20, 200}, {100, 100}, {320, 312}, {1000, 1000}};
  for (int damped = 0; damped < 2; damped++)
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++)
      time_size(sizes[k][0], sizes[k][1], damped ? 0.02 : 0.0, isa);
  return 0;
}
