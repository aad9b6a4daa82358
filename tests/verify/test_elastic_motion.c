/* test_elastic_motion.c - motions of implicit elasticity: energy budget, momentum, damping ratios,
 * spectral radius of the step, driven boundaries.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_common.h"

/* A clamped bar of nx x ny cells of 0.5 m, E = 2, rho = 1, fixed at x = 0 by boundary 0. */
static test_body beam(mps_context *context, int nx, int ny, const mps_elastic_def *def) {
  test_body b = test_body_begin(context, 2, 0.5);
  test_body_box(&b, 0, 0, 0, 0.5 * nx, 0.5 * ny, 0);
  test_body_finish(&b, 2.0, 0.3, def);
  OK(mps_particles_set(b.particles, "density", 0, 1.0));
  USING(elastic_boundary, mps_elastic_add_boundary(b.elastic, &given, NULL),
        .lower[0] = given.lower[1] = -1.0, .upper[0] = 0.3, .upper[1] = INFINITY);
  return b;
}

static void drive_wall(test_body *b, mps_signal *x, mps_signal *y) {
  USING(elastic_boundary, mps_elastic_set_boundary(b->elastic, 0, &given),
        .lower[0] = given.lower[1] = -1.0, .upper[0] = 0.3, .upper[1] = INFINITY,
        .kind = MPS_BOUNDARY_DRIVEN, .signal[0] = x, .signal[1] = y, .factor[1] = 0.5);
}

static double energy_error(test_body *b, double *largest) {
  mps_totals t;
  OK(mps_elastic_get_totals(b->elastic, &t));
  const double terms[] = {t.kinetic,    t.strain,          t.dissipated,
                          t.work_loads, t.work_boundaries, t.work_bodies};
  for (int k = 0; k < 6; k++) *largest = fmax(*largest, fabs(terms[k]));
  return t.kinetic + t.strain + t.dissipated - t.work_loads - t.work_boundaries - t.work_bodies;
}

/* A load that oscillates, gravity, a force on one particle, a wall that is shaken. */
static void load_all(test_body *b, mps_signal *swing) {
  const double gravity[2] = {0.01, -0.05};
  int64_t count, *facets = test_facets(b, 0, 1, &count);
  DEF(elastic_load, def, .kind = MPS_ELASTIC_LOAD_TRACTION, .ids = facets, .id_count = count,
      .force[0] = 0.3, .force[1] = -0.2, .signal[0] = def.signal[1] = swing);
  OK(mps_elastic_add_load(b->elastic, &def, NULL));
  free(facets);
  OK(test_load(b->elastic, MPS_ELASTIC_LOAD_BODY, 0, NULL, gravity, 0));
  OK(mps_particles_add_field(b->particles, "external_force", 0));
  OK(mps_particles_set(b->particles, "external_force", 1, 1e-3));
}

TEST_SERIAL(the_energy_budget_closes) {
  scoped_signal *swing = NULL, *factor = NULL, *ramp = NULL;
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_VALUE, 0.11, 1.0, 0.3, &factor));
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.11, 1.0, 0.3, &swing));
  OK(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2.0, 9.0, 0.4, &ramp));
  for (int damped = 0; damped < 3; damped++) {
    scoped_test_body b = beam(context, 16, 4, NULL);
    load_all(&b, factor);
    drive_wall(&b, swing, ramp);
    OK(mps_particles_set(b.particles, "velocity", 1, 0.02));
    USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 0.21,
          .mass_damping = damped ? 0.05 : 0.0, .stiffness_damping = damped == 2 ? 0.3 : 0.0);
    double largest = 0.0, worst = 0.0;
    const double start = energy_error(&b, &largest);
    mps_totals t;
    for (int k = 0; k < 200; k++) {
      OK(mps_elastic_step(b.elastic, 1));
      worst = fmax(worst, fabs(energy_error(&b, &largest) - start));
    }
    OK(mps_elastic_get_totals(b.elastic, &t));
    print_message("budget, damping %d: %.1e of %.3g J; dissipated %.3g J, loads %.3g J, "
                  "boundaries %.3g J\n",
                  damped, worst / largest, largest, t.dissipated, t.work_loads, t.work_boundaries);
    NEAR(worst / largest, 0.0, 1e-10);
    NEAR(t.scheme / largest, 0.0, 1e-12); /* rounding of the solutions */
    assert_true(damped ? t.dissipated > 1e-3 * largest : t.dissipated == t.scheme);
    mps_reaction r;
    OK(mps_elastic_get_reaction(b.elastic, 0, &r));
    NEAR(r.work / t.work_boundaries, 1.0, 1e-12);
  }
}

/* What comes in by gravity and the wall is the momentum. */
TEST_SERIAL(impulses_are_the_momentum) {
  scoped_test_body b = beam(context, 12, 4, NULL);
  const double gravity[2] = {0.02, -0.05};
  OK(test_load(b.elastic, MPS_ELASTIC_LOAD_BODY, 0, NULL, gravity, 0));
  USING(elastic_motion, mps_elastic_start(b.elastic, &given), .dt = 0.3);
  OK(mps_elastic_step(b.elastic, 50));
  mps_totals t;
  mps_reaction r;
  OK(mps_elastic_get_totals(b.elastic, &t));
  OK(mps_elastic_get_reaction(b.elastic, 0, &r));
  assert_int_equal(r.count, 4);
  NEAR(t.mass, 12.0, 1e-12);
  const double time = mps_elastic_time(b.elastic);
  for (int c = 0; c < 2; c++)
    NEAR((r.impulse[c] + t.mass * gravity[c] * time - t.linear[c]) / (12 * 0.05 * time), 0.0,
         1e-11);
}

/* ---- damping --------------------------------------------------------------------------------- */

/* Amplitudes of the two lowest modes fall as exp(-h w t), with h as requested. */
TEST_SERIAL(modes_decay_with_the_damping_ratios_asked_for) {
  for (int mode = 0; mode < 2; mode++) {
    scoped_test_body b = beam(context, 20, 4, NULL);
    double omega[2], energy[2];
    const double ratio[2] = {0.02, 0.035};
    double *shape = malloc((size_t)b.n * 6 * sizeof *shape);
    OK(mps_elastic_modes(b.elastic, 2, omega, shape));
    OK(mps_particles_add_field(b.particles, "velocity", 0));
    EDIT(v, b.particles, "velocity")
      for (int64_t i = 0; i < b.n; i++)
        for (int c = 0; c < 2; c++) *mps_edit_f64(&v, i, c) = shape[(mode * b.n + i) * 3 + c];
    const double period = 2 * PI / omega[mode];
    DEF(elastic_motion, def, .dt = period / 200);
    for (int k = 0; k < 2; k++) {
      def.ratio[k] = ratio[k];
      def.frequency[k] = omega[k] / (2 * PI);
    }
    OK(mps_elastic_start(b.elastic, &def));
    for (int k = 0; k < 2; k++) { /* energy of the mode after 5 and after 10 damped periods */
      const double damped = period / sqrt(1 - ratio[mode] * ratio[mode]);
      mps_totals t;
      OK(mps_elastic_run(b.elastic, 5 * (k + 1) * damped, 1, NULL, NULL));
      OK(mps_elastic_get_totals(b.elastic, &t));
      energy[k] = t.kinetic + t.strain;
    }
    const double found =
        -0.5 * log(energy[1] / energy[0]) / (2 * PI * 5) * sqrt(1 - ratio[mode] * ratio[mode]);
    print_message("mode %d: damping ratio %.6f, asked for %.6f\n", mode, found, ratio[mode]);
    NEAR(found / ratio[mode], 1.0, 2e-3);
    free(shape);
  }
}

static mps_status start(test_body *b, double dt, double rho, double beta, double gamma) {
  DEF(elastic_motion, def, .dt = dt, .rho_inf = rho, .beta = beta, .gamma = gamma);
  return mps_elastic_start(b->elastic, &def);
}

/* Steps very long against every period: the motion falls by rho_inf a step. The step's matrix has
 * rho_inf as a root of multiplicity three there, so the size after k steps is rho^k times a
 * quadratic in k, which the ratio at 3 sizes takes out. */
TEST_SERIAL(endless_frequencies_fall_by_rho_inf) {
  const double rho[] = {0.9, 0.8, 0.5};
  for (int k = 0; k < 3; k++) {
    scoped_test_body b = beam(context, 6, 3, NULL);
    OK(mps_particles_set(b.particles, "velocity", 1, 1.0));
    OK(start(&b, 1e6, rho[k], NAN, NAN));
    double c[4];
    for (int s = 0; s < 4; s++) { /* u after 10, 20, 30, 40 steps, over rho^steps */
      OK(mps_elastic_step(b.elastic, 10));
      c[s] = test_value(&b, "displacement", b.n - 1, 1) / pow(rho[k], 10 * (s + 1));
    }
    const double third = c[3] - 3 * c[2] + 3 * c[1] - c[0];
    const double size = fabs(c[3]) + 3 * fabs(c[2]) + 3 * fabs(c[1]) + fabs(c[0]);
    print_message("rho_inf %.1f: third difference of u / rho^k is %.1e of u\n", rho[k],
                  third / size);
    assert_true(size > 0.0);
    NEAR(third / size, 0.0, 1e-4);
  }
}

/* Second order for every rho_inf: error of one period of the first mode against steps. */
TEST_SERIAL(every_member_is_of_second_order) {
  const double rho[] = {1.0, 0.6, 0.0};
  for (int k = 0; k < 3; k++) {
    double error[2];
    for (int fine = 0; fine < 2; fine++) {
      scoped_test_body b = beam(context, 20, 4, NULL);
      double omega, *shape = malloc((size_t)b.n * 3 * sizeof *shape);
      OK(mps_elastic_modes(b.elastic, 1, &omega, shape));
      OK(mps_particles_add_field(b.particles, "displacement", 0));
      EDIT(u, b.particles, "displacement")
        for (int64_t i = 0; i < b.n; i++)
          for (int c = 0; c < 2; c++) *mps_edit_f64(&u, i, c) = shape[i * 3 + c];
      OK(start(&b, 2 * PI / omega / (fine ? 80 : 40), rho[k], NAN, NAN));
      OK(mps_elastic_run(b.elastic, 2.25 * 2 * PI / omega, 1, NULL, NULL));
      error[fine] = test_value(&b, "displacement", b.n - 1, 1) / shape[3 * (b.n - 1) + 1];
      free(shape);
      mps_totals t;
      OK(mps_elastic_get_totals(b.elastic, &t));
      const double rounding = 1e-12 * (t.kinetic + t.strain);
      assert_true(rho[k] == 1.0 ? fabs(t.scheme) < rounding : t.scheme > rounding);
    }
    const double order = log2(error[0] / error[1]);
    print_message("rho_inf %.1f: errors %.2e, %.2e, order %.2f\n", rho[k], error[0], error[1],
                  order);
    NEAR(order, 2.0, 0.25);
  }
}

/* ---- driven boundaries ----------------------------------------------------------------------- */

TEST_SERIAL(a_driven_wall_follows_its_signal) {
  scoped_test_body b = beam(context, 8, 4, NULL);
  MAKE(signal, ramp, create_ramp, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0.5, 3.0, 0.2);
  drive_wall(&b, ramp, NULL);
  OK(start(&b, 0.1, 1.0, NAN, NAN));
  for (int k = 0; k < 20; k++) {
    OK(mps_elastic_step(b.elastic, 1));
    const double t = mps_elastic_time(b.elastic);
    NEAR(test_value(&b, "displacement", 0, 0), mps_signal_displacement(ramp, t), 1e-15);
    NEAR(test_value(&b, "velocity", 0, 0), mps_signal_velocity(ramp, t), 1e-15);
    NEAR(test_value(&b, "acceleration", 0, 0), mps_signal_acceleration(ramp, t), 1e-15);
  }
  /* A static solution takes the signal at the present time, then ends the motion. */
  const double now = mps_signal_displacement(ramp, mps_elastic_time(b.elastic));
  OK(mps_elastic_solve(b.elastic));
  NEAR(test_value(&b, "displacement", b.n - 1, 0), now, 1e-12);
}
