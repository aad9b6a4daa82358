/* dam_break.c - a column of water, twice as high as wide, collapses on a dry bed (incompressible
 * moving particles): when its front passes certain places, against the experiments of Martin and
 * Moyce (1952). Since they could not time the gate well, clocks are set where the front is at 1.44
 * widths, as is usual.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/fluid.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double width = 0.05715, height = 0.1143, spacing = 0.05715 / 16.0; /* m */

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

/* A wall through the origin, which the water slips along. */
static void add_wall(mps_fluid *fluid, double nx, double ny) {
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER;
  def.normal[0] = nx, def.normal[1] = ny; /* into the water */
  ok(mps_fluid_add_boundary(fluid, &def, NULL));
}

/* The time at which the foremost water comes to x, s: the surface lies half a spacing outside. */
static double passes(mps_fluid *fluid, mps_particles *water, double x) {
  double front = 0.0, before = 0.0, dt = 0.0;
  mps_view at;
  while (front < x) {
    before = front, dt = mps_fluid_time(fluid);
    ok(mps_fluid_step(fluid, 1));
    dt = mps_fluid_time(fluid) - dt;
    ok(mps_particles_view(water, "position", &at));
    for (int64_t i = 0; i < at.shape[0]; i++)
      front = fmax(front, *mps_view_f64(&at, i, 0) + 0.5 * spacing);
  }
  return mps_fluid_time(fluid) - dt * (front - x) / (front - before);
}

int main(void) {
  /* x over the width against t (n^2 g/a)^(1/2), n^2 = 2: Martin and Moyce, table 2 */
  static const double place[4] = {1.44, 2.11, 3.0, 4.11}, time[4] = {1.19, 1.83, 2.51, 3.33};
  const double lo[2] = {0.0, 0.0}, hi[2] = {width, height}, clock = sqrt(2.0 * 9.81 / width);
  mps_context *context = NULL;
  mps_particles *water = NULL;
  mps_fluid *fluid = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));

  mps_particles_def set = mps_particles_defaults();
  set.spacing = spacing;
  ok(mps_particles_create(context, &set, &water));
  ok(mps_particles_fill_box(water, lo, hi, NULL));
  ok(mps_fluid_create(context, water, NULL, &fluid)); /* 1000 kg/m3, without viscosity */
  add_wall(fluid, 0.0, 1.0);
  add_wall(fluid, 1.0, 0.0);

  int wrong = 0;
  const double start = passes(fluid, water, place[0] * width);
  for (int k = 1; k < 4; k++) {
    char what[40];
    snprintf(what, sizeof what, "time of the front from 1.44 to %.2f", place[k]);
    wrong += compare(what, clock * (passes(fluid, water, place[k] * width) - start),
                     time[k] - time[0], 0.05 * (time[k] - time[0]));
  }
  mps_totals now; /* `strain` is the energy in gravity, above the level of the water at the start */
  ok(mps_fluid_get_totals(fluid, &now));
  const double weight = now.mass * 9.81, energy = now.kinetic + now.strain + weight * height;
  wrong += compare("energy over that at the start", energy / (0.5 * weight * height), 1.0, 0.03);

  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  mps_context_destroy(&context);
  return wrong > 0;
}
