/* disc.c - a rigid disc on an elastic slope of 30 degrees, drawn level with gravity tilted
 * (Nakamura 7.2), moves by its contact alone. It rolls where tan(slope) < 3 mu, and slips else; its
 * path is then that of a rigid slope, Nakamura (51):
 *
 *   rolls: g sin(slope) t^2/3,   slips: g (sin(slope) - mu cos(slope)) t^2/2.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double g = 9.81, density = 1000.0, radius = 0.05;         /* m/s2, kg/m3, m */
static const double length = 0.8, depth = 0.1, cell = 0.01, end = 0.5; /* m, s */

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

/* Path along the slope after `end`, m, and the velocity of the rim over that of the centre. */
static void roll(mps_context *context, double slope, double mu, double *path, double *rim) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {length, depth};
  mps_particles_def set = mps_particles_defaults();
  mps_particles *ground = NULL;
  mps_material *rubber = NULL;
  mps_mpm_def def = mps_mpm_defaults();
  mps_mpm *mpm = NULL;
  set.spacing = 0.5 * cell;
  def.cell = cell;
  def.lower[0] = def.lower[1] = 0.0, def.upper[0] = length;
  ok(mps_particles_create(context, &set, &ground));
  ok(mps_particles_fill_box(ground, lo, hi, NULL));
  ok(mps_particles_set(ground, "density", 0, density));
  ok(mps_material_create_linear_elastic(context, 1e6, 0.3, &rubber));
  ok(mps_mpm_create(context, ground, rubber, &def, &mpm));
  ok(mps_mpm_set_side(mpm, MPS_SIDE_Y_LOWER, MPS_BOUNDARY_HELD, 0.0));

  mps_body_def place = mps_body_defaults();
  mps_body *disc = NULL;
  place.motion = MPS_BODY_MOTION_FREE;
  place.mass = density * acos(-1.0) * radius * radius;
  place.inertia[2] = 0.5 * place.mass * radius * radius;
  place.position[0] = 0.15, place.position[1] = depth + radius;
  place.gravity[0] = g * sin(slope), place.gravity[1] = -g * cos(slope);
  ok(mps_body_create_disc(context, &place, radius, &disc));

  mps_contact_def contact = mps_contact_defaults();
  contact.friction = mu;
  ok(mps_mpm_add_contact(mpm, disc, &contact, NULL));
  ok(mps_mpm_run(mpm, end, 1, NULL, NULL));

  mps_body_state now;
  ok(mps_body_get_state(disc, &now));
  *path = now.position[0] - place.position[0];
  *rim = -now.spin[2] * radius / now.velocity[0];
  mps_mpm_destroy(&mpm);
  mps_body_destroy(&disc);
  mps_material_destroy(&rubber);
  mps_particles_destroy(&ground);
}

int main(void) {
  const double slope = acos(-1.0) / 6.0, rough = 0.6, smooth = 0.1;
  const double rolls = g * sin(slope) * end * end / 3.0;
  const double slips = 0.5 * g * (sin(slope) - smooth * cos(slope)) * end * end;
  /* a disc that slips has the angular acceleration mu g cos(slope) R/(R^2/2) */
  const double spins = 2.0 * smooth * cos(slope) / (sin(slope) - smooth * cos(slope));
  double path, rim;
  mps_context *context = NULL;
  ok(mps_context_create(NULL, &context, NULL, 0));
  roll(context, slope, rough, &path, &rim);
  int wrong = compare("rough slope: path, m", path, rolls, 0.04 * rolls);
  wrong += compare("velocity of the rim over that of the centre", rim, 1.0, 0.02);
  roll(context, slope, smooth, &path, &rim);
  wrong += compare("smooth slope: path, m", path, slips, 0.04 * slips);
  wrong += compare("velocity of the rim over that of the centre", rim, spins, 0.04 * spins);
  mps_context_destroy(&context);
  return wrong > 0;
}
