/* beside.c - what two threads cost where other programs compute too: wall and processor time of a
 * WLS-MPM step by one thread and by two, in turn. Start as many busy programs beside it as there
 * are processors (docs/verification/wls-mpm/speed.md): threads that wait must give the processor
 * away. SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/body.h>
#include <mps/mpm.h>

#include <math.h>
#include <string.h>

typedef struct ground {
  mps_context *context;
  mps_mpm *mpm;
  double wall, busy; /* s, of all its turns */
} ground;

/* A block on a rough floor between smooth sides, with a heavy rough box set on it. */
static void make_ground(int32_t executor, int32_t threads, int64_t particles, ground *g) {
  mps_context_def on = mps_context_defaults();
  mps_particles_def set = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_particles *block = NULL;
  mps_material *soil = NULL;
  mps_body *footing = NULL;
  char text[256];
  const double side = floor(sqrt((double)particles) / 2.0), low[2] = {0.0, 0.0};
  const double high[2] = {side, side};
  on.executor = executor, on.threads = threads;
  memset(g, 0, sizeof *g);
  if (mps_context_create(&on, &g->context, text, sizeof text) != MPS_OK) {
    fprintf(stderr, "bench-beside: %s\n", text);
    exit(1);
  }
  set.spacing = 0.5;
  check(g->context, mps_particles_create(g->context, &set, &block), "particles");
  check(g->context, mps_particles_fill_box(block, low, high, NULL), "fill");
  check(g->context, mps_particles_set(block, "density", 0, 1600.0), "density");
  check(g->context, mps_material_create_linear_elastic(g->context, 1e7, 0.3, &soil), "material");
  def.cell = 1.0;
  def.gravity[1] = -9.81;
  for (int c = 0; c < 2; c++) def.lower[c] = 0.0, def.upper[c] = c == 0 ? side : 2.0 * side;
  check(g->context, mps_mpm_create(g->context, block, soil, &def, &g->mpm), "solver");
  check(g->context, mps_mpm_set_side(g->mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0), "floor");
  mps_body_def place = mps_body_defaults();
  mps_contact_def rough = mps_contact_defaults();
  place.position[0] = 0.5 * side, place.position[1] = side + 2.0;
  place.motion = MPS_BODY_MOTION_FREE;
  place.mass = 1e5, place.inertia[2] = 1e7, place.gravity[1] = -9.81;
  place.velocity[1] = -0.1;
  rough.friction = 0.3;
  check(g->context, mps_body_create_box(g->context, &place, 0.25 * side, 4.0, &footing), "body");
  check(g->context, mps_mpm_add_contact(g->mpm, footing, &rough, NULL), "contact");
  mps_body_destroy(&footing);
  mps_material_destroy(&soil);
  mps_particles_destroy(&block);
}

static double processor_seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void turn(ground *g, int64_t steps) {
  const double wall = seconds(), busy = processor_seconds();
  check(g->context, mps_mpm_step(g->mpm, steps), "step");
  g->wall += seconds() - wall;
  g->busy += processor_seconds() - busy;
}

int main(int argc, char **argv) {
  const int64_t particles = argc > 1 ? atoll(argv[1]) : 100000;
  const int turns = argc > 2 ? atoi(argv[2]) : 10;
  if (argc > 3 || particles < 1000 || particles > 10000000 || turns < 1) {
    fprintf(stderr, "usage: bench-beside [PARTICLES [TURNS]]   1000 to 1e7; turns of half a "
                    "second\n");
    return 2;
  }
  static const char *name[] = {"openmp", "threads"};
  static const int32_t executor[] = {MPS_CONTEXT_EXECUTOR_OPENMP, MPS_CONTEXT_EXECUTOR_THREADS};
  const int64_t steps = 1 + 20000000 / (2 * particles) / 10 * 10 / 2;
  printf("# executor, ms a step by one thread and by two: wall, processors; two over one\n");
  for (int e = 0; e < 2; e++) {
    ground one, two;
    make_ground(executor[e], 1, particles, &one);
    make_ground(executor[e], 2, particles, &two);
    turn(&one, 2), turn(&two, 2);
    one.wall = one.busy = two.wall = two.busy = 0.0;
    for (int k = 0; k < turns; k++) turn(&one, steps), turn(&two, steps);
    const double scale = 1e3 / (double)(turns * steps);
    printf("%-8s %8.3f %8.3f   %8.3f %8.3f   %6.3f %6.3f\n", name[e], scale * one.wall,
           scale * one.busy, scale * two.wall, scale * two.busy, two.wall / one.wall,
           two.busy / one.busy);
    fflush(stdout);
    mps_mpm_destroy(&one.mpm), mps_mpm_destroy(&two.mpm);
    mps_context_destroy(&one.context), mps_context_destroy(&two.context);
  }
  return 0;
}
