/* servo.c - a plate that keeps its load: a rigid body whose velocity is set, before each step, by
 * the force on it. It presses a column of soil between smooth walls, with friction nowhere; the
 * settlement is that of an oedometer, F H / (M W), M = K + 4G/3.
 *
 * The plate moves by v = gain (F - R) with the desired force F and the reaction R, so that it rests
 * when they agree. A stiff soil responds with a frequency of its own; the gain lets the plate go
 * about one settlement in ten travel times of the wave through the column.
 * SPDX-License-Identifier: BSD-3-Clause */
#include <mps/mpm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double spacing = 0.05, width = 0.4, height = 1.0;    /* m */
static const double young = 1e7, poisson = 0.3, density = 1800.0; /* Pa, kg/m3 */
static const double force = 4e4;                                  /* N, per m of thickness */

typedef struct test {
  mps_particles *soil;
  mps_mpm *mpm;
  mps_body *plate;
  mps_contact *contact;
  double gain; /* m/s a N */
} test;

/* Stops where a call fails, with the library's message. */
static void ok(mps_status status) {
  if (status == MPS_OK) return;
  fprintf(stderr, "%s\n", mps_last_error()->message);
  exit(1);
}

static void make(mps_context *context, test *t) {
  const double lo[2] = {0.0, 0.0}, hi[2] = {width, height};
  mps_particles_def of_soil = mps_particles_defaults();
  mps_mpm_def def = mps_mpm_defaults();
  mps_material *sand = NULL;
  of_soil.spacing = spacing;
  def.cell = 2.0 * spacing;
  def.upper[0] = width, def.upper[1] = 2.0; /* sides are smooth walls by default */
  def.lower[0] = def.lower[1] = 0.0;
  ok(mps_particles_create(context, &of_soil, &t->soil));
  ok(mps_particles_fill_box(t->soil, lo, hi, NULL));
  ok(mps_particles_set(t->soil, "density", 0, density));
  ok(mps_material_create_linear_elastic(context, young, poisson, &sand));
  ok(mps_mpm_create(context, t->soil, sand, &def, &t->mpm));
  mps_material_destroy(&sand);
  /* wider than the column, so that its corners are free */
  mps_body_def place = mps_body_defaults();
  place.position[0] = 0.5 * width, place.position[1] = height + 0.2;
  ok(mps_body_create_box(context, &place, 2.0 * width, 0.4, &t->plate));
  ok(mps_mpm_add_contact(t->mpm, t->plate, NULL, &t->contact));
}

/* Before each step: the plate's velocity from the force of the last one. */
static mps_status steer(void *user, mps_mpm *mpm) {
  test *t = user;
  mps_reaction r;
  mps_body_motion motion = mps_body_motion_defaults(); /* the position is unchanged */
  (void)mpm;
  ok(mps_contact_get_reaction(t->contact, -1, &r));
  motion.velocity[1] = -t->gain * (force - r.force[1]);
  return mps_body_set_motion(t->plate, &motion);
}

/* Of all particles, m. */
static double mean_height(const test *t) {
  mps_view x;
  double sum = 0.0;
  ok(mps_particles_view(t->soil, "position", &x));
  for (int64_t k = 0; k < x.shape[0]; k++) sum += *mps_view_f64(&x, k, 1);
  return sum / (double)x.shape[0];
}

int main(void) {
  mps_context *context = NULL;
  test t = {0};
  const double modulus = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
  const double wanted = force * height / (modulus * width),
               travel = height / sqrt(modulus / density);
  t.gain = wanted / (10.0 * travel * force);
  ok(mps_context_create(NULL, &context, NULL, 0));
  make(context, &t);
  const double start = mean_height(&t);
  mps_reaction r = {0};
  printf("   t, s   force, N  settlement of the surface, mm\n");
  for (int part = 1; part <= 10; part++) {
    ok(mps_mpm_run(t.mpm, 10.0 * travel * part, 1, steer, &t));
    ok(mps_contact_get_reaction(t.contact, -1, &r));
    /* in uniform strain the mean of all particles has moved half as far as the surface */
    printf("%7.4f  %9.1f  %8.4f\n", mps_mpm_time(t.mpm), r.force[1],
           2e3 * (start - mean_height(&t)));
  }
  const double got = 2.0 * (start - mean_height(&t));
  printf("wanted: %9.1f  %8.4f\n", force, 1e3 * wanted);
  mps_contact_destroy(&t.contact);
  mps_mpm_destroy(&t.mpm);
  mps_body_destroy(&t.plate);
  mps_particles_destroy(&t.soil);
  mps_context_destroy(&context);
  return fabs(r.force[1] / force - 1.0) < 0.01 && fabs(got / wanted - 1.0) < 0.02 ? 0 : 1;
}
