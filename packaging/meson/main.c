/* main.c - a block of ground falls for a second; its height is compared with g t^2/2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>

static mps_status fall(mps_context *context, mps_particles *block, mps_mpm **solver, double *lowest) {
  const double lo[2] = {0.0, 5.0}, hi[2] = {1.0, 6.0}; /* m */
  mps_material *law = NULL;
  mps_mpm_def def = mps_mpm_defaults();
  mps_view x;
  def.cell = 0.2;
  def.gravity[1] = -9.81;
  mps_status s = mps_particles_fill_box(block, lo, hi, NULL);
  if (!s) s = mps_particles_set(block, "density", 0, 1800.0);
  if (!s) s = mps_material_create_linear_elastic(context, 1e6, 0.3, &law);
  if (!s) s = mps_mpm_create(context, block, law, &def, solver);
  mps_material_destroy(&law); /* the solver keeps its own reference */
  if (!s) s = mps_mpm_run(*solver, 1.0, 1000, NULL, NULL);
  if (!s) s = mps_particles_view(block, "position", &x);
  *lowest = 1e9;
  for (int64_t i = 0; !s && i < x.shape[0]; i++) *lowest = fmin(*lowest, *mps_view_f64(&x, i, 1));
  return s;
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *block = NULL;
  mps_mpm *solver = NULL;
  mps_particles_def set = mps_particles_defaults();
  double lowest = 0.0;
  set.spacing = 0.1;
  if (mps_context_create(NULL, &context, NULL, 0)) return 1;
  mps_status s = mps_particles_create(context, &set, &block);
  if (!s) s = fall(context, block, &solver, &lowest);
  if (s) fprintf(stderr, "%s\n", mps_context_error(context)->message);
  printf("libmps %s: fallen %.3f m, theory %.3f m\n", mps_version(), 5.05 - lowest, 0.5 * 9.81);
  mps_mpm_destroy(&solver);
  mps_particles_destroy(&block);
  mps_context_destroy(&context);
  return s || fabs(5.05 - lowest - 0.5 * 9.81) > 0.02;
}
