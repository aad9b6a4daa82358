/* footing.c - a smooth strip footing, 2 m wide, is pressed into clay by WLS-MPM (Nakamura 7.3.1),
 * half of it by symmetry. Its pressure against its settlement, and the load at which the clay
 * fails, against Prandtl's exact one: (2 + pi) times the undrained strength.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double half = 1.0, width = 6.0, depth = 4.0, cell = 0.2; /* m */
static const double cohesion = 25e3, young = 1e9, density = 1000.0;   /* Pa, Pa, kg/m3 */
static const double speed = 12.5e-3, settlement = 3e-3;               /* m/s, m */

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

int main(void) {
  mps_context *context = NULL;
  mps_particles *ground = NULL;
  mps_material *clay = NULL;
  mps_body *footing = NULL;
  mps_signal *down = NULL;
  mps_mpm *mpm = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));

  /* in plane strain von Mises' law has the strength c of Tresca's: sqrt(3) c, Nakamura (54); the
   * weight of undrained clay makes no difference, and is left out */
  const double lo[2] = {0.0, 0.0}, hi[2] = {width, depth};
  mps_particles_def set = mps_particles_defaults();
  mps_material_von_mises_def law = mps_material_von_mises_defaults();
  set.spacing = 0.5 * cell;
  law.young = young, law.yield_stress = sqrt(3.0) * cohesion;
  ok(mps_particles_create(context, &set, &ground));
  ok(mps_particles_fill_box(ground, lo, hi, NULL));
  ok(mps_particles_set(ground, "density", 0, density));
  ok(mps_material_create_von_mises(context, &law, &clay));

  /* a box about the plane of symmetry, which gains its speed in 4 ms */
  const double t[3] = {0.0, 4e-3, 1.0}, v[3] = {0.0, speed, speed};
  mps_body_def place = mps_body_defaults();
  place.position[1] = depth + 0.5;
  ok(mps_body_create_box(context, &place, 2.0 * half, 1.0, &footing));
  ok(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, t, v, &down));
  ok(mps_body_drive(footing, 1, down, -1.0));

  mps_mpm_def def = mps_mpm_defaults();
  mps_contact_def contact = mps_contact_defaults(); /* without friction */
  def.cell = cell;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = width; /* smooth sides */
  contact.corner = 0.6 * cell; /* the grid widens a sharp edge by about as much */
  ok(mps_mpm_create(context, ground, clay, &def, &mpm));
  ok(mps_mpm_set_side(mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));
  ok(mps_mpm_add_contact(mpm, footing, &contact, NULL));

  /* pressures are means of each tenth of the path, from the impulse */
  double pressure = 0.0, before = 0.0;
  mps_reaction r;
  puts("settlement, mm   pressure, kPa");
  for (int k = 1; k <= 10; k++) {
    const double span = 0.1 * settlement / speed;
    ok(mps_mpm_run(mpm, k * span, 1, NULL, NULL));
    ok(mps_body_get_reaction(footing, -1, &r));
    pressure = (r.impulse[1] - before) / (span * half);
    before = r.impulse[1];
    printf("%14.1f %15.1f\n", 100.0 * settlement * k, 1e-3 * pressure);
  }
  const double prandtl = 2.0 + acos(-1.0);
  const int wrong =
      compare("bearing capacity over the strength", pressure / cohesion, prandtl, 0.04 * prandtl);

  mps_mpm_destroy(&mpm);
  mps_signal_destroy(&down);
  mps_body_destroy(&footing);
  mps_material_destroy(&clay);
  mps_particles_destroy(&ground);
  mps_context_destroy(&context);
  return wrong > 0;
}
