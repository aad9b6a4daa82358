/* test_elastic_vibration.c - Newmark's method and eigenmodes: period of a slender cantilever
 * against beam theory, energy, agreement of the two, static limit, a uniaxial bar.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "implicit/operator/budget.h"
#include "elastic_common.h"

/* A cantilever of nx x ny cells, its last layer clamped; E = rho = 1, nu = 0.3, height 1. */
static test_body slender(mps_context *context, int nx, int ny, double *length) {
  const double spacing = 1.0 / ny;
  test_body b = test_body_begin(context, 2, spacing);
  test_body_box(&b, 0, 0, 0, nx * spacing, 1, 0);
  test_body_finish(&b, 1.0, 0.3, NULL);
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  int64_t count, *wall = test_select(&b, 0, (nx - 0.6) * spacing, INFINITY, &count);
  OK(mps_elastic_cut(b.elastic, MPS_SIDE_X_UPPER, wall, count));
  for (int c = 0; c < 2; c++) OK(test_prescribe(b.elastic, c, count, wall, NULL));
  free(wall);
  *length = (nx - 0.5) * spacing;
  return b;
}

/* First circular frequency of a Timoshenko cantilever (E = rho = h = b = 1, kappa = 5/6) by
 * bisection of the determinant of its boundary conditions. */
static double timoshenko_determinant(double omega, double l) {
  const double inertia = 1.0 / 12, shear = 5.0 / 6 / 2.6;
  const double b2 = omega * omega * pow(l, 4) / inertia, r2 = inertia / l / l;
  const double s2 = inertia / shear / l / l;
  const double root = sqrt((r2 - s2) * (r2 - s2) + 4 / b2), b = sqrt(b2);
  const double al = sqrt((-(r2 + s2) + root) / 2), be = sqrt((r2 + s2 + root) / 2);
  /* Huang (1961), clamped-free. */
  return 2 + (b2 * (r2 - s2) * (r2 - s2) + 2) * cosh(b * al) * cos(b * be) -
         b * (r2 + s2) / sqrt(1 - b2 * r2 * s2) * sinh(b * al) * sin(b * be);
}

static double timoshenko(double l) {
  double low = 0.5 * 1.8751 * 1.8751 * sqrt(1.0 / 12) / l / l, high = 1.1 * 2 * low;
  const double sign = timoshenko_determinant(low, l);
  for (int k = 0; k < 80; k++) {
    const double middle = 0.5 * (low + high);
    if (timoshenko_determinant(middle, l) * sign > 0)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static double first_mode(mps_context *context, int nx, int ny, double *expected) {
  double length, omega[3];
  test_body b = slender(context, nx, ny, &length);
  OK(mps_elastic_modes(b.elastic, 3, omega, NULL));
  const double euler = 1.875104068711961 * 1.875104068711961 * sqrt(1.0 / 12) / length / length;
  *expected = timoshenko(length);
  print_message("l/h %.2f, %d x %d: omega %.6g, Timoshenko %.6g (%+.2f %%), Euler-Bernoulli %.6g "
                "(%+.2f %%)\n",
                length, nx, ny, omega[0], *expected, 100 * (omega[0] / *expected - 1), euler,
                100 * (omega[0] / euler - 1));
  assert_true(omega[0] < omega[1] && omega[1] < omega[2]);
  test_body_end(&b);
  return omega[0];
}

TEST_SERIAL(the_period_of_a_slender_cantilever_is_that_of_beam_theory) {
  double expected;
  const double omega = first_mode(context, 160, 8, &expected);
  NEAR(omega / expected, 1.0, 0.01);
}

/* Released from its first mode it oscillates with that mode's period; total energy stays. */
TEST_SERIAL(a_released_mode_keeps_its_period_and_energy) {
  double length, omega[1], strain, kinetic;
  scoped_test_body b = slender(context, 80, 8, &length);
  double *shape = malloc((size_t)b.n * 3 * sizeof *shape);
  OK(mps_elastic_modes(b.elastic, 1, omega, shape));
  OK(mps_particles_add_field(b.particles, "displacement", 0));
  mps_edit u;
  OK(mps_particles_edit(b.particles, "displacement", &u));
  double modal_mass = 0.0;
  for (int64_t i = 0; i < b.n; i++)
    for (int c = 0; c < 2; c++) *mps_edit_f64(&u, i, c) = shape[3 * i + c];
  OK(mps_particles_commit(b.particles, &u));
  for (int64_t i = 0; i < b.n * 3; i++)
    modal_mass += shape[i] * shape[i] / 64.0; /* wall particles do not move */
  NEAR(modal_mass, 1.0, 1e-10);
  const double period = 2 * PI / omega[0];
  DEF(elastic_motion, def, .dt = period / 200);
  OK(mps_elastic_start(b.elastic, &def));
  OK(mpsi_elastic_strain_energy(b.elastic, __func__, &strain));
  NEAR(strain / (0.5 * omega[0] * omega[0]), 1.0, 1e-8);
  const double start = test_value(&b, "displacement", 0, 1);
  double before = 1.0, crossed = 0.0, drift = 0.0;
  for (int k = 1; k <= 400; k++) {
    double now_strain;
    OK(mps_elastic_step(b.elastic, 1));
    OK(mpsi_elastic_strain_energy(b.elastic, __func__, &now_strain));
    mps_totals totals;
    OK(mps_elastic_get_totals(b.elastic, &totals));
    kinetic = totals.kinetic;
    drift = fmax(drift, fabs((now_strain + kinetic) / strain - 1.0));
    const double now = test_value(&b, "displacement", 0, 1) / start;
    if (before < 0 && now >= 0) /* at 3/4, 7/4 of the period */
      crossed = (k - now / (now - before)) * def.dt / (k < 200 ? 0.75 : 1.75);
    before = now;
  }
  /* The trapezoidal rule stretches the period by (omega dt)^2 / 12. */
  const double stretched = 1.0 + pow(omega[0] * def.dt, 2) / 12;
  print_message("period / mode's period %.8f, theory of the step %.8f; energy drift %.1e\n",
                crossed / period, stretched, drift);
  NEAR(crossed / period, stretched, 1e-5);
  NEAR(drift, 0.0, 1e-9);
  NEAR(mps_elastic_time(b.elastic), 400 * def.dt, 1e-9);
  free(shape);
}

/* gamma > 1/2 takes energy until the structure rests at the static solution. */
TEST_SERIAL(damped_steps_end_at_the_static_solution) {
  double length;
  scoped_test_body b = slender(context, 24, 6, &length);
  const double load[2] = {0.0, -1e-3};
  OK(test_body_force(b.elastic, load));
  OK(mps_elastic_solve(b.elastic));
  const double still = test_value(&b, "displacement", 0, 1);
  DEF(elastic_motion, def, .dt = 50.0);
  /* From rest at the static solution nothing moves. */
  OK(mps_elastic_start(b.elastic, &def));
  OK(mps_elastic_step(b.elastic, 20));
  NEAR(test_value(&b, "displacement", 0, 1) / still, 1.0, 1e-9);
  OK(mps_particles_set(b.particles, "displacement", 1, 0.0));
  OK(mps_particles_set(b.particles, "displacement", 0, 0.0));
  def.gamma = 0.9;
  def.beta = 0.25 * 1.4 * 1.4;
  OK(mps_elastic_start(b.elastic, &def));
  OK(mps_elastic_step(b.elastic, 400));
  NEAR(test_value(&b, "displacement", 0, 1) / still, 1.0, 1e-6);
  double force[3];
  OK(test_reactions(b.elastic, NULL, force, NULL));
  NEAR(force[1] / (1e-3 * length), 1.0, 1e-6);
}

TEST_SERIAL(bad_steps_are_refused) {
  double length, omega[4];
  scoped_test_body b = slender(context, 6, 3, &length);
  mps_elastic_motion_def def = mps_elastic_motion_defaults();
  REFUSES(mps_elastic_start(b.elastic, &def), "dt is 0");
  def.dt = 1.0;
  def.beta = 0.1;
  REFUSES(mps_elastic_start(b.elastic, &def), "beta is 0.1");
  def = mps_elastic_motion_defaults();
  def.dt = 1.0;
  FAILS(mps_elastic_step(b.elastic, 1), MPS_ERROR_STATE, "mps_elastic_start");
  OK(mps_particles_set(b.particles, "density", 0, 0.0));
  REFUSES(mps_elastic_start(b.elastic, &def), "density of particle 0 is 0");
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  REFUSES(mps_elastic_modes(b.elastic, 0, omega, NULL), "count is 0");
  REFUSES(mps_elastic_modes(b.elastic, 30, omega, NULL), "count is 30");
}
