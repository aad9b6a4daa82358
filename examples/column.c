/* column.c - a column of dry sand, twice as high as wide, collapses on a rough floor when the gate
 * beside it is taken away (WLS-MPM): how far it runs, and how high the heap stays at the wall,
 * against the laws of Lube, Huppert, Sparks and Freundt (2005) for sands in a channel. These fit
 * sands that differ among themselves, hence wide bounds.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double width = 0.1, height = 0.2, cell = 0.01; /* m */
enum { COUNT = 20 * 40 };                                   /* particles, half a cell apart */

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

static int descending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x < y) - (x > y);
}

/* The place along axis c beyond which 1/200 of the sand lies, m. */
static double edge(mps_particles *sand, int c) {
  double value[COUNT];
  mps_view x;
  ok(mps_particles_view(sand, "position", &x));
  for (int64_t i = 0; i < COUNT; i++) value[i] = *mps_view_f64(&x, i, c);
  qsort(value, COUNT, sizeof *value, descending);
  return value[COUNT / 200];
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *sand = NULL;
  mps_material *law = NULL;
  mps_mpm *mpm = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));

  const double lo[2] = {0.0, 0.0}, hi[2] = {width, height};
  const double phi = 35.0 * acos(-1.0) / 180.0; /* rad */
  mps_particles_def set = mps_particles_defaults();
  mps_material_drucker_prager_def rule = mps_material_drucker_prager_defaults();
  set.spacing = 0.5 * cell;
  rule.young = 1e6, rule.friction = phi; /* and no dilation */
  ok(mps_particles_create(context, &set, &sand));
  ok(mps_particles_fill_box(sand, lo, hi, NULL));
  ok(mps_particles_set(sand, "density", 0, 1600.0));
  ok(mps_material_create_drucker_prager(context, &rule, &law));

  mps_mpm_def def = mps_mpm_defaults();
  def.cell = cell, def.gravity[1] = -9.81;
  def.lower[0] = def.lower[1] = 0.0; /* a smooth wall and the floor */
  def.flip_time = 0.01;              /* s: else the transfers of a coarse grid stop the front */
  ok(mps_mpm_create(context, sand, law, &def, &mpm));
  ok(mps_mpm_set_side(mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));

  puts("time, s   front, m   height, m");
  for (int k = 0; k <= 6; k++) {
    ok(mps_mpm_run(mpm, 0.1 * k, 1, NULL, NULL));
    printf("%7.1f %10.3f %11.3f\n", mps_mpm_time(mpm), edge(sand, 0), edge(sand, 1));
  }

  /* between a < 1.8, 1.2 a, and a > 2.8, 1.9 a^(2/3), on a straight line; a is 2 */
  const double low = 1.2 * 1.8, high = 1.9 * pow(2.8, 2.0 / 3.0);
  const double run = low + (high - low) * (height / width - 1.8);
  const double heap = pow(height / width, 0.4);
  int wrong = compare("run-out over the width", edge(sand, 0) / width - 1.0, run, 0.15 * run);
  wrong += compare("height over the width", edge(sand, 1) / width, heap, 0.2 * heap);

  mps_mpm_destroy(&mpm);
  mps_material_destroy(&law);
  mps_particles_destroy(&sand);
  mps_context_destroy(&context);
  return wrong > 0;
}
