/* test_fluid.c - the fluid against theory: water at rest, sloshing, the elliptic drop, waves of a
 * piston in a closed tank against nonlinear potential flow. docs/verification/fluid/tests.md has
 * the tables; finer resolutions run in test_fluid_long.c. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

static double force_right(const tank *t) {
  mps_reaction r;
  OK(mps_fluid_get_reaction(t->fluid, TANK_RIGHT, &r));
  return -r.force[0];
}

/* The lattice is exactly at rest: q = 0. */
TEST(water_on_a_lattice_stays_at_rest) {
  scoped_tank t = tank_make(context, 0.6, 0.3, 0.02, NULL, 2e-3);
  OK(mps_fluid_step(t.fluid, 200));
  mps_totals sum;
  OK(mps_fluid_get_totals(t.fluid, &sum));
  assert_true(sum.kinetic < 1e-12);
  NEAR(force_right(&t), 0.5 * 1000.0 * TANK_G * 0.09, 1e-3);
}

static void disturb(void *user, double *x, double *u) {
  uint64_t *seed = user;
  (void)u;
  for (int c = 0; c < 2; c++) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    x[c] += 0.1 * 0.02 * ((double)(*seed >> 11) * 0x1p-52 - 1.0);
  }
}

/* Particles displaced by up to .1 l0 settle; the force stays within .3 %. */
TEST(disturbed_water_settles) {
  uint64_t seed = 3;
  scoped_tank t = tank_of(context, 0.6, 0.3, 0.02, 2e-3, NULL, disturb, &seed);
  OK(mps_fluid_step(t.fluid, 1000));
  double mean = 0.0, square = 0.0;
  const double still = 0.5 * 1000.0 * TANK_G * 0.09;
  for (int k = 0; k < 250; k++) {
    OK(mps_fluid_step(t.fluid, 4));
    const double f = force_right(&t) / still - 1.0;
    mean += f / 250.0, square += f * f / 250.0;
  }
  print_message("force %+.3f %%, standard deviation %.3f %%\n", 100.0 * mean,
                100.0 * sqrt(square - mean * mean));
  NEAR(mean, 0.0, 0.003);
  assert_true(sqrt(square - mean * mean) < 0.0015);
}

/* First mode of a tank of length .7 and depth .3, amplitude a at the walls: particles where linear
 * theory has them. */
static void slosh(void *user, double *x, double *u) {
  const double a = *(const double *)user, k = TANK_PI / 0.7, y = x[1], at = x[0];
  (void)u;
  x[0] -= a * sin(k * at) * cosh(k * y) / sinh(k * 0.3);
  x[1] += a * cos(k * at) * sinh(k * y) / sinh(k * 0.3);
}

TEST(sloshing_has_the_period_of_theory) {
  double a = 0.01;
  const double k = TANK_PI / 0.7, exact = 2.0 * TANK_PI / sqrt(TANK_G * k * tanh(k * 0.3));
  scoped_tank t = tank_of(context, 0.7, 0.3, 0.02, 2e-3, NULL, slosh, &a);
  /* the force on the right wall less its mean over the run: zeros going up */
  enum { SAMPLES = 2600 };
  static double force[SAMPLES];
  double mean = 0.0;
  for (int n = 0; n < SAMPLES; n++) {
    OK(mps_fluid_step(t.fluid, 1));
    force[n] = force_right(&t);
    mean += force[n] / SAMPLES;
  }
  double first = 0.0, last = 0.0;
  int crossings = 0;
  for (int n = 1; n < SAMPLES; n++) {
    if (!(force[n - 1] < mean && force[n] >= mean)) continue;
    const double at = 2e-3 * (n + (mean - force[n - 1]) / (force[n] - force[n - 1]));
    if (crossings == 0) first = at;
    last = at;
    crossings++;
  }
  assert_true(crossings >= 4);
  const double period = (last - first) / (crossings - 1);
  print_message("period %.5f s, exact %.5f s, %+.2f %%\n", period, exact,
                100.0 * (period / exact - 1.0));
  NEAR(period, exact, 0.005 * exact);
}

/* ---- elliptic drop --------------------------------------------------------------------------- */

static mps_status in_circle(void *user, const double *x, int32_t *inside) {
  *inside = x[0] * x[0] + x[1] * x[1] < 1.0;
  return MPS_OK;
}

/* a' = -A a, b' = A b, A' = A^2 (a^2 - b^2)/(a^2 + b^2): semi-axes at t = 1 by small Euler steps of
 * second order. */
static void drop_axes(double *a, double *b) {
  const int steps = 20000;
  const double dt = 1.0 / steps;
  double A = 1.0;
  *a = *b = 1.0;
  for (int n = 0; n < steps; n++) {
    const double a2 = *a * (1.0 - 0.5 * dt * A), b2 = *b * (1.0 + 0.5 * dt * A);
    const double A2 = A + 0.5 * dt * A * A * (*a * *a - *b * *b) / (*a * *a + *b * *b);
    *a -= dt * A2 * a2, *b += dt * A2 * b2;
    A += dt * A2 * A2 * (a2 * a2 - b2 * b2) / (a2 * a2 + b2 * b2);
  }
}

TEST(a_drop_becomes_the_ellipse_of_theory) {
  const double l0 = 1.0 / 20.0, lo[2] = {-1.0, -1.0}, hi[2] = {1.0, 1.0};
  DEF(particles, set, .spacing = l0);
  DEF(fluid, def, .gravity[1] = 0.0, .dt = 2.5e-3);
  MAKE(particles, p, create, context, &set);
  OK(mps_particles_fill_where(p, lo, hi, in_circle, NULL, NULL));
  OK(mps_particles_add_field(p, "velocity", 0));
  mps_view x = view_field(p, "position");
  EDIT(u, p, "velocity")
    for (int64_t i = 0; i < mps_particles_count(p); i++) {
      *mps_edit_f64(&u, i, 0) = -*mps_view_f64(&x, i, 0);
      *mps_edit_f64(&u, i, 1) = *mps_view_f64(&x, i, 1);
    }
  MAKE(fluid, f, create, context, p, &def);
  mps_totals before, after;
  OK(mps_fluid_get_totals(f, &before));
  OK(mps_fluid_run(f, 1.0, 1000, NULL, NULL));
  OK(mps_fluid_get_totals(f, &after));
  /* semi-axes from the second moments */
  double a, b, sum[2] = {0.0, 0.0};
  const double n = (double)mps_particles_count(p);
  OK(mps_particles_view(p, "position", &x));
  for (int64_t i = 0; i < mps_particles_count(p); i++)
    for (int c = 0; c < 2; c++) sum[c] += *mps_view_f64(&x, i, c) * *mps_view_f64(&x, i, c);
  drop_axes(&a, &b);
  const double got[2] = {sqrt(4.0 * sum[0] / n), sqrt(4.0 * sum[1] / n)};
  print_message("semi-axes %.4f (%+.2f %%), %.4f (%+.2f %%); kinetic energy %.4f\n", got[0],
                100.0 * (got[0] / a - 1.0), got[1], 100.0 * (got[1] / b - 1.0),
                after.kinetic / before.kinetic);
  NEAR(b, 2.2755, 1e-3);
  NEAR(got[0], a, 0.015 * a);
  NEAR(got[1], b, 0.005 * b);
  NEAR(after.linear[0], 0.0, 1e-2 * before.mass);
  assert_true(after.kinetic > 0.99 * before.kinetic);
}

/* ---- waves of a piston ----------------------------------------------------------------------- */

/* .02 m sin(2 pi t/1 s), risen by 3 s^2 - 2 s^3 in the first second. */
static mps_status piston(void *user, double t, double *motion) {
  const double w = 2.0 * TANK_PI, s = t < 0.0 ? 0.0 : t < 1.0 ? t : 1.0;
  const double rise = s * s * (3.0 - 2.0 * s), rate = s < 1.0 ? 6.0 * s * (1.0 - s) : 0.0;
  const double bend = s < 1.0 && t > 0.0 ? 6.0 - 12.0 * s : 0.0;
  motion[0] = 0.02 * rise * sin(w * t);
  motion[1] = 0.02 * (rate * sin(w * t) + rise * w * cos(w * t));
  motion[2] = 0.02 * (bend * sin(w * t) + 2.0 * rate * w * cos(w * t) - rise * w * w * sin(w * t));
  return MPS_OK;
}

/* Closed tank 1.6 x .3 m: force on the far wall, and the balance of momentum. Reference: nonlinear
 * potential flow in cosine modes, fourth order in time, whose only filter takes 8th differences
 * (one of 4th differences lowers the waves: a trough of 335.6 N with 64 modes): 28 modes without it
 * 528.2, 548.6, 333.5, 532.8 N, 40 and 48 with it 527.9, 548.4, 334.1, 532.4 and 527.8, 548.2,
 * 334.1, 532.4 N. */
TEST(waves_press_on_the_wall_as_potential_flow_does) {
  const struct {
    double time, force;
  } exact[] = {{3.142, 527.8}, {4.170, 548.2}, {4.698, 334.1}, {5.235, 532.4}};
  scoped_signal *motion = NULL;
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, piston, NULL, NULL,
                            &motion));
  scoped_tank t = tank_make(context, 1.6, 0.3, 0.02, motion, 2e-3);
  size_t at = 0;
  while (at < sizeof exact / sizeof *exact) {
    OK(mps_fluid_step(t.fluid, 1));
    if (mps_fluid_time(t.fluid) < exact[at].time - 1e-3) continue;
    const double force = force_right(&t);
    print_message("%.3f s: %.1f N, reference %.1f N (%+.2f %%)\n", mps_fluid_time(t.fluid), force,
                  exact[at].force, 100.0 * (force / exact[at].force - 1.0));
    NEAR(force, exact[at].force, 0.005 * exact[at].force);
    at++;
  }
  mps_totals sum;
  mps_reaction left, right;
  OK(mps_fluid_get_totals(t.fluid, &sum));
  OK(mps_fluid_get_reaction(t.fluid, TANK_LEFT, &left));
  OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &right));
  const double impulse = left.impulse[0] + right.impulse[0];
  print_message("momentum %.3f N s, impulse of the walls %.3f N s\n", sum.linear[0], impulse);
  NEAR(sum.linear[0], impulse, 0.01 * 0.5 * 1000.0 * TANK_G * 0.09 * 1.0);
  mps_fluid_report report;
  OK(mps_fluid_get_report(t.fluid, &report));
  assert_int_equal(report.collisions, 0);
  assert_int_equal(report.limited, 0);
}

/* The classical scheme stays as noisy as it is known to be; its mean force is right. */
TEST(the_classical_scheme_has_the_mean_force) {
  const double gamma[2] = {1.0, 0.2}, still = 0.5 * 1000.0 * TANK_G * 0.09;
  for (int k = 0; k < 2; k++) {
    scoped_tank t = tank_make(context, 0.6, 0.3, 0.015, NULL, 1e-3);
    mps_fluid_report report;
    REFUSES(mps_experimental_fluid_classical(t.fluid, 1.5), "gamma is 1.5");
    OK(mps_experimental_fluid_classical(t.fluid, gamma[k]));
    FAILS(mps_fluid_begin_step(t.fluid, NAN), MPS_ERROR_STATE, "in parts");
    OK(mps_fluid_step(t.fluid, 300));
    double mean = 0.0, square = 0.0;
    for (int n = 0; n < 500; n++) {
      OK(mps_fluid_step(t.fluid, 1));
      const double f = force_right(&t) / still;
      mean += f / 500.0, square += f * f / 500.0;
    }
    OK(mps_fluid_get_report(t.fluid, &report));
    print_message("classical, gamma %.1f: force %+.2f %%, standard deviation %.0f %%\n", gamma[k],
                  100.0 * (mean - 1.0), 100.0 * sqrt(square - mean * mean));
    NEAR(mean, 1.0, 0.10);
    FAILS(mps_experimental_fluid_classical(t.fluid, 1.0), MPS_ERROR_STATE, "has made");
  }
}
