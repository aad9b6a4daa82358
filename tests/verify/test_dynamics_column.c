/* test_dynamics_column.c - the paper's column against the reference values of docs/verification:
 * stability limits, travel time, surface peaks, leapfrog against Verlet.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"

static mps_dynamics_def column_def(int integrator, double dt) {
  DEF(dynamics, def, .integrator = integrator, .dt = dt);
  return def;
}

static void close_column(mps_context **context, mps_particles **particles,
                         mps_dynamics **dynamics) {
  mps_dynamics_destroy(dynamics);
  mps_particles_destroy(particles);
  mps_context_destroy(context);
}

/* Linear limit of the R = 0.5 m column. */
static double linear_limit(char wave, double vs, double damping, bool printed) {
  mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  mps_particles *particles = NULL;
  mps_dynamics_def def = column_def(MPS_DYNAMICS_INTEGRATOR_VERLET, NAN);
  mps_dynamics *dynamics =
      paper_column(context, 0.5, vs, 2.0 * vs, damping, wave, &def, &particles);
  mps_dynamics_linear_limit limit;
  if (printed) OK(mps_experimental_dynamics_printed_torque(dynamics));
  OK(mps_dynamics_find_limit(dynamics, 0.0, &limit));
  close_column(&context, &particles, &dynamics);
  return limit.dt;
}

TEST(linear_limits_are_the_reference_values) {
  NEAR(linear_limit('S', 100.0, 0.0, false), 4.1047e-3, 0.5e-7);
  NEAR(linear_limit('S', 100.0, 0.0, true), 2.9048e-3, 0.5e-7);
  const struct {
    char wave;
    double vs, damping, dt;
  } rows[] = {{'S', 100.0, 0.001, 4.084e-3}, {'S', 100.0, 0.048, 3.209e-3},
              {'S', 100.0, 0.22, 1.546e-3},  {'P', 50.0, 0.001, 8.184e-3},
              {'P', 50.0, 0.048, 7.242e-3},  {'P', 50.0, 0.22, 4.750e-3}};
  for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
    NEAR(linear_limit(rows[k].wave, rows[k].vs, rows[k].damping, false), rows[k].dt,
         1e-3 * rows[k].dt);
}

TEST(stepping_is_stable_at_4_10_ms_and_not_at_4_11_ms) {
  for (int k = 0; k < 2; k++) {
    mps_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
    mps_particles *particles = NULL;
    const mps_dynamics_def def = column_def(MPS_DYNAMICS_INTEGRATOR_VERLET, NAN);
    mps_dynamics *dynamics = paper_column(context, 0.5, 100.0, 200.0, 0.0, 'S', &def, &particles);
    OK(mps_dynamics_set_dt(dynamics, k == 0 ? 4.10e-3 : 4.11e-3));
    const mps_status status = mps_dynamics_run(dynamics, 10.0, 1000, NULL, NULL);
    assert_int_equal(status, k == 0 ? MPS_OK : MPS_ERROR_DIVERGED);
    close_column(&context, &particles, &dynamics);
  }
}

/* A soft layer of `rows` rows on stiff ground whose lowest row, the 1.5 times as many, is held in
 * its middle: the time (s) in which the first mode, released, passes its middle, and that by
 * theory: tan(w h1/V1) tan(w h2/V2) = rho2 V2/(rho1 V1). */
static double quarter_period(int rows, double vs, double *theory) {
  const double spacing = 8.0 / rows, height = 20.0, h2 = 12.0 - 0.5 * spacing;
  const soil_layer ground[2] = {{8.0, 1700.0, 100.0, 200.0, 0.0},
                                {12.0, 2000.0, vs, 2.0 * vs, 0.0}};
  const double ratio = 2000.0 * vs / (1700.0 * 100.0);
  double low = 0.0, high = 0.5 * PI * fmin(100.0 / 8.0, vs / h2);
  for (int k = 0; k < 60; k++) {
    const double w = 0.5 * (low + high);
    if (tan(w * 0.08) * tan(w * h2 / vs) < ratio)
      low = w;
    else
      high = w;
  }
  *theory = 0.5 * PI / low;
  scoped_context *context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1);
  scoped_particles *particles = soil_particles(context, spacing, 3.0 * spacing, height, 2, ground);
  mps_edit u;
  OK(mps_particles_set(particles, "displacement", 0, 0.0));
  const mps_view x = view_field(particles, "position");
  OK(mps_particles_edit(particles, "displacement", &u));
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double up = *mps_view_f64(&x, k, 1), below = up - (height - 8.0 - h2);
    *mps_edit_f64(&u, k, 0) =
        1e-4 * (up > height - 8.0 ? cos(low * (height - up) * 0.01)
                                  : cos(low * 0.08) * sin(low * below / vs) / sin(low * h2 / vs));
  }
  OK(mps_particles_commit(particles, &u));
  DEF(dynamics, def, .period_x = 3.0 * spacing, .courant = 0.3);
  MAKE(dynamics, dynamics, create, context, particles, &def);
  soil_hold(particles, dynamics, MPS_DOF_X | MPS_DOF_Y, -1.0, -1.0, height, spacing);
  const double top[2] = {1.5 * spacing, height};
  const int64_t id = mps_particles_nearest(particles, top);
  double before = 1.0, now = 1.0;
  while (now > 0.0 && mps_dynamics_time(dynamics) < 2.0 * *theory) {
    OK(mps_dynamics_step(dynamics, 1));
    before = now, now = soil_value(particles, "displacement", id, 0);
  }
  return mps_dynamics_time(dynamics) - mps_dynamics_dt(dynamics) * now / (now - before);
}

/* With the arithmetic mean of both moduli in the pairs across, the layer lacks up to half a row. */
TEST(a_soft_layer_on_stiff_ground_has_its_whole_thickness) {
  for (int rows = 4; rows <= 16; rows *= 2)
    for (double vs = 200.0; vs < 4000.0; vs *= 4.0) {
      double theory;
      const double measured = quarter_period(rows, vs, &theory);
      print_message("%d rows, Vs %g on %g m/s: %.5f s, theory %.5f s (%+.2f %%)\n", rows, 100.0, vs,
                    measured, theory, 100.0 * (measured / theory - 1.0));
      NEAR(measured / theory, 1.0, 0.024 / rows);
    }
}

/* Peaks of |acceleration| and their times at the middle and the edge of the surface. */
typedef struct response {
  mps_context *context;
  mps_particles *particles;
  int64_t id[2];
  double peak[2], time[2];
  double *trace; /* of the middle, if not NULL */
} response;

static mps_status watch(void *user, mps_dynamics *dynamics) {
  response *r = user;
  for (int k = 0; k < 2; k++) {
    const double a = fabs(soil_value(r->particles, "acceleration", r->id[k], 0));
    if (k == 0 && r->trace) r->trace[mps_dynamics_steps(dynamics)] = a;
    if (a <= r->peak[k]) continue;
    r->peak[k] = a;
    r->time[k] = mps_dynamics_time(dynamics) - mps_dynamics_dt(dynamics); /* of a_k */
  }
  return MPS_OK;
}

static response run_column(int integrator, double dt, double duration, double *trace) {
  response r = {.context = test_context(MPS_CONTEXT_EXECUTOR_SERIAL, 1), .trace = trace};
  const mps_dynamics_def def = column_def(integrator, dt);
  mps_dynamics *dynamics = paper_column(r.context, 0.5, 100.0, 200.0, 0.0, 'S', &def, &r.particles);
  const double middle[2] = {4.5, 99.5}, edge[2] = {0.5, 99.5};
  r.id[0] = mps_particles_nearest(r.particles, middle);
  r.id[1] = mps_particles_nearest(r.particles, edge);
  OK(mps_dynamics_run(dynamics, duration, 1, watch, &r));
  close_column(&r.context, &r.particles, &dynamics);
  return r;
}

TEST(travel_time_and_surface_peaks) {
  const response r = run_column(MPS_DYNAMICS_INTEGRATOR_VERLET, 1e-4, 1.6, NULL);
  print_message("surface peak %.4f m/s2 (middle), %.4f (edge); travel time %.4f s\n", r.peak[0],
                r.peak[1], r.time[0] - 0.25);
  NEAR(r.peak[0], 1.92, 0.0192);
  NEAR(r.peak[1], 2.02, 0.0202);
  NEAR(r.time[0] - 0.25, 1.036, 0.005 * 1.036);
}

TEST(leapfrog_equals_verlet) {
  enum { STEPS = 600 };
  double verlet[STEPS + 2] = {0}, leapfrog[STEPS + 2] = {0}, worst = 0.0;
  run_column(MPS_DYNAMICS_INTEGRATOR_VERLET, 4e-3, STEPS * 4e-3, verlet);
  run_column(MPS_DYNAMICS_INTEGRATOR_LEAPFROG, 4e-3, STEPS * 4e-3, leapfrog);
  for (int k = 0; k <= STEPS; k++) worst = fmax(worst, fabs(verlet[k] - leapfrog[k]));
  print_message("largest difference of the surface accelerations %.2g m/s2\n", worst);
  NEAR(worst, 0.0, 1e-9);
}
