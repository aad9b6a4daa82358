/* rock.c - what rock costs in a fluid: waves of a piston in the closed tank of fluid.c, 16/3 as
 * long as deep. Time of a particle-step (of the processor, one thread) without rock, with rock far
 * from the water, and with rock of porosity .45 in the last third of the tank's length or under the
 * water there (`height` of .5, of the depth).
 *
 * bench-rock [ROWS [STEPS [RADIUS [ONLY]]]]: particles across the depth, timed steps, radius of the
 * weights in water over the spacing, and one of the cases 0 to 3 alone, for callgrind.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "measure.h"

#include <mps/experimental/fluid_rock.h>

#include <math.h>
#include <stdbool.h>

#define CASES 4
#define DEPTH 0.3
#define POROSITY 0.45

typedef struct tank {
  mps_context *context;
  mps_particles *water;
  mps_fluid *fluid;
  mps_signal *piston;
  int64_t in_rock;
} tank;

static double processor(void) {
  struct timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void add_wall(const tank *t, double at, int axis, double side, mps_signal *signal) {
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER;
  wall.point[axis] = at, wall.normal[axis] = side;
  wall.signal = signal;
  check(t->context, mps_fluid_add_boundary(t->fluid, &wall, NULL), "wall");
}

/* Water between two stations and heights, at the spacing given. */
static int64_t fill(const tank *t, double x0, double x1, double y0, double y1, double spacing) {
  const int64_t columns = (int64_t)round((x1 - x0) / spacing);
  const int64_t rows = (int64_t)round((y1 - y0) / spacing);
  for (int64_t a = 0; a < columns; a++)
    for (int64_t b = 0; b < rows; b++) {
      const double at[2] = {x0 + ((double)a + 0.5) * (x1 - x0) / (double)columns,
                            y0 + ((double)b + 0.5) * (y1 - y0) / (double)rows};
      check(t->context, mps_particles_append(t->water, 1, at), "particle");
    }
  return rows * columns;
}

static void add_rock(const tank *t, double x0, double x1, double y1) {
  const double corner[12] = {x0, -0.1, 0.0, x1, -0.1, 0.0, x1, y1, 0.0, x0, y1, 0.0};
  mps_fluid_rock_def rock = mps_fluid_rock_defaults();
  rock.corners = corner, rock.corner_count = 4;
  rock.porosity = POROSITY, rock.diameter = 0.02;
  check(t->context, mps_fluid_add_rock(t->fluid, &rock, NULL), "rock");
}

/* Rock up to `height` of the depth, 0: none, from two thirds of the length on. */
static tank make(int64_t rows, double radius, double height, bool far) {
  tank t = {.context = NULL};
  mps_context_def context_def = mps_context_defaults();
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  context_def.threads = 1;
  check(NULL, mps_context_create(&context_def, &t.context, NULL, 0), "context");
  set.spacing = DEPTH / (double)rows;
  check(t.context, mps_particles_create(t.context, &set, &t.water), "particles");
  const double length = set.spacing * round(16.0 / 3.0 * (double)rows);
  const double face = set.spacing * round(32.0 / 9.0 * (double)rows);
  const double top = set.spacing * round(height * (double)rows);
  fill(&t, 0.0, face, 0.0, DEPTH, set.spacing);
  if (top > 0.0) t.in_rock = fill(&t, face, length, 0.0, top, set.spacing / sqrt(POROSITY));
  if (top < DEPTH) fill(&t, face, length, top, DEPTH, set.spacing);
  def.dt = 0.04 * sqrt(set.spacing / 9.81);
  def.level = DEPTH, def.radius_ratio = radius;
  check(t.context, mps_fluid_create(t.context, t.water, &def, &t.fluid), "fluid");
  check(t.context,
        mps_signal_create_sine(t.context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 0.02, 0.0,
                               &t.piston),
        "signal");
  add_wall(&t, 0.0, 1, 1.0, NULL);
  add_wall(&t, 0.0, 0, 1.0, t.piston);
  add_wall(&t, length, 0, -1.0, NULL);
  if (top > 0.0) add_rock(&t, face, length + 0.1, top < DEPTH ? top : 1.0);
  if (far) add_rock(&t, length + 10.0, length + 11.0, DEPTH);
  return t;
}

static void run(int which, int64_t rows, int64_t steps, double radius) {
  static const char *const names[CASES] = {"no rock", "rock far away", "a third of the length",
                                           "the lower half of that"};
  tank t = make(rows, radius, which == 2 ? 1.0 : which == 3 ? 0.5 : 0.0, which == 1);
  mps_fluid_report before, after;
  check(t.context, mps_fluid_step(t.fluid, steps), "steps");
  check(t.context, mps_fluid_get_report(t.fluid, &before), "report");
  const double begin = processor();
  check(t.context, mps_fluid_step(t.fluid, steps), "steps");
  const double took = processor() - begin;
  check(t.context, mps_fluid_get_report(t.fluid, &after), "report");
  const double count = (double)mps_particles_count(t.water);
  printf("%-24s %10.0f %10lld %12.3f %11.1f %9.1f\n", names[which], count, (long long)t.in_rock,
         1e6 * took / (count * (double)steps),
         (double)(after.all_iterations - before.all_iterations) / (double)steps,
         (double)after.pairs / count);
  fflush(stdout);
  mps_fluid_destroy(&t.fluid);
  mps_signal_destroy(&t.piston);
  mps_particles_destroy(&t.water);
  mps_context_destroy(&t.context);
}

int main(int count, char **values) {
  const double rows = count > 1 ? strtod(values[1], NULL) : 24.0;
  const double steps = count > 2 ? strtod(values[2], NULL) : 100.0;
  const double radius = count > 3 ? strtod(values[3], NULL) : 3.1;
  const double only = count > 4 ? strtod(values[4], NULL) : -1.0;
  if (!(rows >= 9.0 && rows <= 1000.0) || !(steps >= 1.0 && steps <= 1e5) ||
      !(radius >= 2.6 && radius <= 4.0) || !(only >= -1.0 && only < CASES)) {
    fprintf(stderr, "bench-rock [ROWS [STEPS [RADIUS [ONLY]]]]: 9 to 1000, 1 to 1e5, 2.6 to 4, 0 "
                    "to 3\n");
    return 1;
  }
  printf("%-24s %10s %10s %12s %11s %9s\n", "rock", "particles", "in rock", "us/particle",
         "iterations", "pairs");
  for (int which = 0; which < CASES; which++)
    if (only < 0.0 || which == (int)only) run(which, (int64_t)rows, (int64_t)steps, radius);
  return 0;
}
