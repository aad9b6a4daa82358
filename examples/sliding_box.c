/* sliding_box.c - an elastic block between four plates is pressed by the upper one and dragged by
 * the lower one, which is rough (Nakamura 7.1): contact with friction, by WLS-MPM.
 *
 * The block is confined, so that the pressure on it is M ln(H/(H - d)) where the plate has come
 * down by d, with the modulus M = K + 4G/3; on the lower plate friction is mu times the pressure.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double side = 0.1, cell = 0.02;                      /* m */
static const double young = 1e6, poisson = 0.3, density = 1000.0; /* Pa, 1, kg/m3 */
static const double speed = 5e-4, mu = 0.1;                       /* m/s */

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

/* A half plane whose normal points to the block; the lower one, whose normal points up, is rough.
 * Along component c (-1: not at all) it moves for a second from `start` on, 0.1 s of it to gain the
 * speed and to lose it. */
static void add_plate(mps_context *context, mps_mpm *mpm, const double *normal, double place,
                      int32_t c, double start, mps_body **plate) {
  const double t[4] = {start, start + 0.1, start + 0.9, start + 1.0},
               v[4] = {0.0, speed, speed, 0.0};
  mps_body_def def = mps_body_defaults();
  mps_contact_def contact = mps_contact_defaults();
  mps_signal *motion = NULL;
  for (int k = 0; k < 2; k++) def.position[k] = -normal[k] * place;
  contact.friction = normal[1] > 0.0 ? mu : 0.0;
  ok(mps_body_create_half_plane(context, &def, normal, plate));
  if (c >= 0) {
    ok(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 4, t, v, &motion));
    ok(mps_body_drive(*plate, c, motion, c == 1 ? -1.0 : 1.0));
    mps_signal_destroy(&motion);
  }
  ok(mps_mpm_add_contact(mpm, *plate, &contact, NULL));
}

int main(void) {
  static const double up[2] = {0.0, 1.0}, down[2] = {0.0, -1.0};
  static const double right[2] = {1.0, 0.0}, left[2] = {-1.0, 0.0};
  const double lo[2] = {0.0, 0.0}, hi[2] = {side, side};
  mps_context *context = NULL;
  mps_particles *block = NULL;
  mps_material *rubber = NULL;
  mps_mpm *mpm = NULL;
  mps_body *plate[4] = {NULL};
  ok(mps_context_create(NULL, &context, NULL, 0));

  mps_particles_def set = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults(); /* without sides: plates hold the block */
  set.spacing = 0.5 * cell, def.cell = cell;
  ok(mps_particles_create(context, &set, &block));
  ok(mps_particles_fill_box(block, lo, hi, NULL));
  ok(mps_particles_set(block, "density", 0, density));
  ok(mps_material_create_linear_elastic(context, young, poisson, &rubber));
  ok(mps_mpm_create(context, block, rubber, &def, &mpm));

  add_plate(context, mpm, right, 0.0, -1, 0.0, &plate[0]);
  add_plate(context, mpm, left, side, -1, 0.0, &plate[1]);
  add_plate(context, mpm, down, side, 1, 0.0, &plate[2]); /* presses for a second, */
  add_plate(context, mpm, up, 0.0, 0, 1.0, &plate[3]);    /* then the lower one slides */

  /* forces of the block on the lower plate, means over half a second of sliding */
  mps_reaction before, after;
  ok(mps_mpm_run(mpm, 1.4, 1, NULL, NULL));
  ok(mps_body_get_reaction(plate[3], -1, &before));
  ok(mps_mpm_run(mpm, 1.9, 1, NULL, NULL));
  ok(mps_body_get_reaction(plate[3], -1, &after));
  const double along = (after.impulse[0] - before.impulse[0]) / 0.5;
  const double across = (after.impulse[1] - before.impulse[1]) / 0.5;

  mps_moduli m;
  ok(mps_moduli_from_elastic(context, young, poisson, density, &m));
  const double exact = m.wave * side * log(side / (side - 0.9 * speed));
  int wrong = compare("normal force, N", -across, exact, 0.005 * exact);
  wrong += compare("friction over normal force", along / across, mu, 1e-4);

  mps_mpm_destroy(&mpm);
  for (int k = 0; k < 4; k++) mps_body_destroy(&plate[k]);
  mps_material_destroy(&rubber);
  mps_particles_destroy(&block);
  mps_context_destroy(&context);
  return wrong > 0;
}
