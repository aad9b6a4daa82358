/* restart.c - a run that is cut in two by a file: sand falls, its state is saved on the way, and a
 * solver that is built anew, as in another process, continues from the file. It must end with the
 * bits of the run that went on. Needs a libmps with HDF5.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/io.h>
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const file = "example-restart.h5";
static const double middle = 0.1, end = 0.2; /* s */

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

/* A column of sand on a rough floor beside a smooth wall. */
static void make(mps_context *context, mps_particles **sand, mps_mpm **mpm) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {0.1, 0.2};
  mps_particles_def set = mps_particles_defaults();
  mps_material_drucker_prager_def rule = mps_material_drucker_prager_defaults();
  mps_material *law = NULL;
  mps_mpm_def def = mps_mpm_defaults();
  set.spacing = 0.005, def.cell = 0.01;
  rule.young = 1e6, rule.friction = 0.6;
  def.lower[0] = def.lower[1] = 0.0, def.gravity[1] = -9.81;
  ok(mps_particles_create(context, &set, sand));
  ok(mps_particles_fill_box(*sand, lo, hi, NULL));
  ok(mps_particles_set(*sand, "density", 0, 1600.0));
  ok(mps_material_create_drucker_prager(context, &rule, &law));
  ok(mps_mpm_create(context, *sand, law, &def, mpm));
  ok(mps_mpm_set_side(*mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
  mps_material_destroy(&law); /* the solver keeps it alive */
}

/* The largest difference between the places of a particle in both sets, m. */
static double difference(mps_particles *one, mps_particles *other) {
  double largest = 0.0;
  mps_view x, y, id;
  ok(mps_particles_view(one, "position", &x));
  ok(mps_particles_view(one, "id", &id));
  ok(mps_particles_view(other, "position", &y));
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const int64_t j = mps_particles_index(other, *mps_view_i64(&id, i, 0));
    for (int c = 0; c < 2; c++)
      largest = fmax(largest, fabs(*mps_view_f64(&x, i, c) - *mps_view_f64(&y, j, c)));
  }
  return largest;
}

int main(void) {
  mps_context *context = NULL;
  mps_particles *whole = NULL, *again = NULL;
  mps_mpm *first = NULL, *second = NULL;
  mps_checkpoint info = mps_checkpoint_defaults();
  ok(mps_context_create(NULL, &context, NULL, 0));

  make(context, &whole, &first);
  ok(mps_mpm_run(first, middle, 1, NULL, NULL));
  snprintf(info.user_key, sizeof info.user_key, "column 0.1 x 0.2 m"); /* what may be restored */
  ok(mps_mpm_save(first, file, &info));
  ok(mps_mpm_run(first, end, 1, NULL, NULL));

  make(context, &again, &second);
  const double apart = difference(whole, again);
  ok(mps_mpm_restore(second, file, &info));
  int wrong = compare("time in the file, s", mps_mpm_time(second), middle, 0.0);
  ok(mps_mpm_run(second, end, 1, NULL, NULL));

  printf("%lld steps; sand has moved by up to %.3f m\n", (long long)mps_mpm_steps(first), apart);
  wrong += compare("steps", (double)mps_mpm_steps(second), (double)mps_mpm_steps(first), 0.0);
  wrong += compare("difference of the places, m", difference(whole, again), 0.0, 0.0);

  remove(file);
  mps_mpm_destroy(&second);
  mps_mpm_destroy(&first);
  mps_particles_destroy(&again);
  mps_particles_destroy(&whole);
  mps_context_destroy(&context);
  return wrong > 0;
}
