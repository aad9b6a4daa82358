/* fluid.c - benchmark of the fluid: waves of a piston in a closed tank 16/3 as long as deep, of
 * growing size. Time of a particle-step and its shares: preparation (neighbours, moments, the
 * matrix and its preconditioner), solution of the pressure, and motion (gradient, guards,
 * positions, wall pressures); iterations; memory besides the fields; the gain of a second thread;
 * and the classical scheme (mps/experimental/papers.h, gamma .2) with the same particles and steps.
 * Times of one thread are the processor's.
 *
 * bench-fluid [PARTICLES [STEPS [SMALLEST [THREADS [MULTIGRID]]]]]: the largest and the smallest
 * size, default 1e5 and 1e3, the steps timed at each, default 40, the threads compared with one,
 * default 2, and the particles from which on PETSc's multigrid solves for the pressure (where it is
 * built; default 0: never), then without the classical scheme.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/experimental/papers.h>
#include <mps/fluid.h>
#ifdef BENCH_PETSC
#include <mps/experimental/petsc.h>
#include <mps/experimental/fluid_parts.h>
#endif

#include <math.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <time.h>

typedef struct result {
  int64_t particles;
  double prepare, solve, move; /* s a step */
  double wall;                 /* s a step, by the clock */
  double iterations, bytes;
  double sleeps; /* of all threads, a step */
} result;

static void add_wall(mps_context *context, mps_fluid *fluid, double x, int axis, double sign,
                     mps_signal *signal) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  def.point[0] = x, def.normal[axis] = sign, def.signal = signal;
  check(context, mps_fluid_add_boundary(fluid, &def, NULL), "wall");
}

/* s: of one thread the processor's time, which other work on the machine hardly affects. */
static double now(int32_t threads) {
  struct timespec t;
  if (threads > 1) return seconds();
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Number of times that threads of the process have blocked. */
static double sleeps(void) {
  struct rusage use;
  getrusage(RUSAGE_SELF, &use);
  return (double)use.ru_nvcsw;
}

static void solve_by_multigrid(mps_context *context, mps_fluid *fluid, int64_t least) {
  if (least <= 0 || mps_particles_count(mps_fluid_particles(fluid)) < least) return;
#ifdef BENCH_PETSC
  mps_petsc_solver *solver = NULL; /* to the end of the program */
  check(context, mps_petsc_solver_create(context, MPS_PETSC_METHOD_MULTIGRID, &solver),
        "multigrid");
  mps_linear_solver_def def;
  check(context, mps_petsc_linear_solver(solver, &def), "multigrid");
  def.least = least;
  check(context,
        mps_solver_set_linear_solver(mps_fluid_solver(fluid), MPS_LINEAR_EQUATION_PRESSURE, &def),
        "multigrid");
#else
  (void)context, (void)fluid;
  fprintf(stderr, "built without PETSc: no multigrid\n");
  exit(1);
#endif
}

/* Steps of .04 (l0/g)^1/2 after as many that are not timed; classical ones count as motion. */
static result measure(int64_t rows, int64_t steps, int32_t threads, bool classical,
                      int64_t multigrid) {
  mps_context *context = NULL;
  mps_particles *water = NULL;
  mps_fluid *fluid = NULL;
  mps_signal *piston = NULL;
  mps_context_def context_def = mps_context_defaults();
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  char text[256] = "";
  context_def.threads = threads;
  check(NULL, mps_context_create(&context_def, &context, text, sizeof text), text);
  set.spacing = 0.3 / (double)rows;
  const double length = set.spacing * round(16.0 / 3.0 * (double)rows);
  const double lo[2] = {0.0, 0.0}, hi[2] = {length, 0.3};
  check(context, mps_particles_create(context, &set, &water), "particles");
  check(context, mps_particles_fill_box(water, lo, hi, NULL), "fill");
  def.dt = 0.04 * sqrt(set.spacing / 9.81);
  def.level = 0.3;
  check(context, mps_fluid_create(context, water, &def, &fluid), "fluid");
  check(context,
        mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0, &piston),
        "signal");
  add_wall(context, fluid, 0.0, 1, 1.0, NULL);
  add_wall(context, fluid, 0.0, 0, 1.0, piston);
  add_wall(context, fluid, length, 0, -1.0, NULL);
  if (classical) check(context, mps_experimental_fluid_classical(fluid, 0.2), "classical");
  solve_by_multigrid(context, fluid, multigrid);
  check(context, mps_fluid_step(fluid, steps), "steps");
  result r = {.particles = mps_particles_count(water)};
  mps_fluid_report before, after;
  check(context, mps_fluid_get_report(fluid, &before), "report");
  const double begin = seconds(), slept = sleeps();
  for (int64_t k = 0; k < steps; k++) {
    double clock[4];
    clock[0] = now(threads);
    if (classical) {
      check(context, mps_fluid_step(fluid, 1), "classical step");
      r.move += (now(threads) - clock[0]) / (double)steps;
      continue;
    }
    check(context, mps_fluid_begin_step(fluid, NAN), "begin");
    clock[1] = now(threads);
    check(context, mps_fluid_solve_pressure(fluid), "solve");
    clock[2] = now(threads);
    check(context, mps_fluid_end_step(fluid), "end");
    clock[3] = now(threads);
    r.prepare += (clock[1] - clock[0]) / (double)steps;
    r.solve += (clock[2] - clock[1]) / (double)steps;
    r.move += (clock[3] - clock[2]) / (double)steps;
  }
  r.wall = (seconds() - begin) / (double)steps;
  r.sleeps = (sleeps() - slept) / (double)steps;
  check(context, mps_fluid_get_report(fluid, &after), "report");
  r.iterations = (double)(after.all_iterations - before.all_iterations) / (double)steps;
  r.bytes = (double)after.bytes / (double)r.particles;
  mps_fluid_destroy(&fluid);
  mps_signal_destroy(&piston);
  mps_particles_destroy(&water);
  mps_context_destroy(&context);
  return r;
}

static double argument(int count, char **values, int at, double usual) {
  return at < count ? strtod(values[at], NULL) : usual;
}

static void print_row(const result *one, const result *more, const result *peer) {
  const double total = one->prepare + one->solve + one->move;
  printf("%10lld %10.3f %7.0f%% %7.0f%% %7.0f%% %11.1f %10.0f %8.2fx %8.2fx %8.2fx %8.2fx %8.1f",
         (long long)one->particles, 1e6 * total / (double)one->particles,
         100.0 * one->prepare / total, 100.0 * one->solve / total, 100.0 * one->move / total,
         one->iterations, one->bytes, total / more->wall, one->prepare / more->prepare,
         one->solve / more->solve, one->move / more->move, more->sleeps);
  if (peer->particles > 0) printf(" %10.3f", 1e6 * peer->move / (double)peer->particles);
  printf("\n");
  fflush(stdout);
}

int main(int count, char **values) {
  const double largest = argument(count, values, 1, 1e5);
  const int64_t steps = (int64_t)argument(count, values, 2, 40.0);
  const double smallest = argument(count, values, 3, 1e3);
  const int32_t threads = (int32_t)argument(count, values, 4, 2.0);
  const int64_t multigrid = (int64_t)argument(count, values, 5, 0.0);
  if (!(largest >= smallest && largest <= 1e7 && smallest >= 200.0) || steps < 1 ||
      steps > 100000 || threads < 1 || threads > 256 || multigrid < 0) {
    fprintf(stderr,
            "bench-fluid [PARTICLES [STEPS [SMALLEST [THREADS [MULTIGRID]]]]]: 200 to 1e7, 1 "
            "to 1e5, 200 to 1e7, 1 to 256, >= 0\n");
    return 1;
  }
  printf("%d threads: times as soon, by parts, and their sleeps a step\n", (int)threads);
  printf("%10s %10s %8s %8s %8s %11s %10s %9s %9s %9s %9s %8s %10s\n", "particles", "us/particle",
         "prepare", "solve", "move", "iterations", "B/particle", "threads", "prepare", "solve",
         "move", "sleeps", "classical");
  for (double size = smallest; size < 1.01 * largest; size *= sqrt(10.0)) {
    const int64_t rows = (int64_t)round(sqrt(size * 3.0 / 16.0));
    const result one = measure(rows, steps, 1, false, multigrid);
    const result more = threads > 1 ? measure(rows, steps, threads, false, multigrid) : one;
    const result peer = multigrid > 0 ? (result){0} : measure(rows, steps, 1, true, 0);
    print_row(&one, &more, &peer);
  }
  return 0;
}
