/* test_mpm_schemes.c - the original material point method (Nakamura Table 1) with FLIP and PIC
 * beside WLS: linear fields, angular momentum and energy that each conserves, on a rotating disc, a
 * vibrating bar and a column under its weight. docs/verification/wls-mpm/original-method.md has the
 * table. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#include "mpm/base/mpm_solver.h"

enum { WLS, FLIP, BLEND, PIC, SCHEMES };
static const char *const name[SCHEMES] = {"WLS", "FLIP", "FLIP 0.95", "PIC"};

static void solve(mpm_scene *s, const mps_mpm_def *def, int scheme) {
  static const double flip[SCHEMES] = {1.0, 1.0, 0.95, 0.0};
  mpm_scene_solve(s, def);
  if (scheme != WLS) OK(mps_experimental_mpm_standard(s->mpm, flip[scheme]));
}

/* ---- shape functions and transfer ------------------------------------------------------------ */

/* A block of 6 x 6 cells in which the velocity is linear, after one step without forces. */
static mpm_scene linear_velocity(int scheme, int32_t spline) {
  const double v0[] = {0.3, -0.2}, L[] = {1.1, -0.7, 0.4, 0.9};
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.0, 0.0, 1e5);
  mpm_scene_box(&s, 0.0, 0.0, 0.12, 0.12);
  mpm_scene_affine(&s, v0, L);
  DEF(mpm, def, .cell = 0.02, .spline = spline, .dt = 1e-12);
  solve(&s, &def, scheme);
  OK(mps_mpm_step(s.mpm, 1));
  return s;
}

/* The derivatives of the splines give sum s^n = 0, 1, 0, 3 sum w s^2 for n = 0 to 3 (cubic), and
 * the first three if quadratic: as many conditions as there are values. */
TEST(splines_are_differentiated) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (double t = spline == 3 ? 1.0 : 0.5; t < (spline == 3 ? 2.0 : 1.5); t += 0.07) {
      double w[4], slope[4], sum[4] = {0.0}, second = 0.0;
      mpsi_weights(spline, t, w);
      mpsi_slopes(spline, t, slope);
      for (int i = 0; i <= spline; i++) {
        const double s = (double)i - t;
        second += w[i] * s * s;
        for (int n = 0; n < 4; n++) sum[n] += slope[i] * pow(s, n);
      }
      for (int n = 0; n < 3; n++) NEAR(sum[n], n == 1, 1e-14);
      if (spline == 3) NEAR(sum[3], 3.0 * second, 1e-14);
    }
}

/* WLS gives a linear velocity back, at the block's edge too. PIC does not; FLIP, which changes
 * velocities only, does; but the edge's velocity gradient is wrong with both. */
TEST(linear_velocity_returns) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
      scoped_mpm_scene s = linear_velocity(scheme, spline);
      mps_view x = mpm_scene_view(&s, "position"), v = mpm_scene_view(&s, "velocity");
      mps_view L = mpm_scene_view(&s, "velocity_gradient");
      double off = 0.0, gradient = 0.0;
      for (int64_t k = 0; k < x.shape[0]; k++) {
        const double X = *mps_view_f64(&x, k, 0), Y = *mps_view_f64(&x, k, 1);
        off = fmax(off, fabs(*mps_view_f64(&v, k, 0) - (0.3 + 1.1 * X - 0.7 * Y)));
        gradient = fmax(gradient, fabs(*mps_view_f64(&L, k, 1) + 0.7));
      }
      print_message("linear velocity, spline %d, %s: off by %.1e m/s, gradient by %.1e 1/s\n",
                    spline, name[scheme], off, gradient);
      if (scheme == WLS || scheme == FLIP) assert_true(off < 1e-11);
      if (scheme == PIC) assert_true(off > 1e-3);
      assert_true(scheme == WLS ? gradient < 1e-10 : gradient > 0.01);
    }
}

/* ---- rotating disc --------------------------------------------------------------------------- */

typedef struct warm {
  double linear, angular, energy; /* linear: relative error; the others: share that is left */
} warm;

/* A free disc, ten cells across, makes `turns` turns while it translates. */
static warm rotating_disc(int scheme, int32_t spline, double turns) {
  const double w = 5.0, v0[] = {0.4, -0.3}, L[] = {0.0, -w, w, 0.0};
  mpm_scene s = mpm_scene_begin(context, 0.01, 0.003, -0.001, 1e5);
  mpm_scene_ball(&s, 0.0, 0.0, 0.1);
  mpm_scene_affine(&s, v0, L);
  DEF(mpm, def, .cell = 0.02, .spline = spline);
  solve(&s, &def, scheme);
  const mps_totals a = mpm_scene_totals(&s);
  OK(mps_mpm_run(s.mpm, turns * 2.0 * PI / w, 1000000, NULL, NULL));
  const mps_totals b = mpm_scene_totals(&s);
  const double away = 0.5 * (v0[0] * v0[0] + v0[1] * v0[1]); /* J/kg of the flight */
  mpm_scene_end(&s);
  return (warm){
      hypot(b.linear[0] - a.linear[0], b.linear[1] - a.linear[1]) / hypot(a.linear[0], a.linear[1]),
      b.angular[2] / a.angular[2], (b.kinetic - away * b.mass) / (a.kinetic - away * a.mass)};
}

TEST(disc_keeps) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (int scheme = 0; scheme < SCHEMES; scheme++) {
      const warm k = rotating_disc(scheme, spline, 1.0);
      print_message(
          "disc, one turn, spline %d, %s: linear %.1e, angular left %.9f, energy left %.4f\n",
          spline, name[scheme], k.linear, k.angular, k.energy);
      assert_true(k.linear < 1e-12);
      if (scheme == WLS) NEAR(k.angular, 1.0, 1e-11);
      if (scheme == FLIP) assert_true(k.angular > 0.85 && k.angular < 0.99);
      if (scheme >= BLEND) assert_true(k.angular < 0.05);
    }
}

/* ---- vibrating bar --------------------------------------------------------------------------- */

static double bar_energy(mpm_scene *s, double modulus) {
  mps_view v = mpm_scene_view(s, "velocity"), stress = mpm_scene_view(s, "stress");
  mps_view m = mpm_scene_view(s, "mass"), V = mpm_scene_view(s, "volume");
  double sum = 0.0;
  for (int64_t k = 0; k < v.shape[0]; k++) {
    const double speed = *mps_view_f64(&v, k, 1), yy = *mps_view_f64(&stress, k, 1);
    sum += 0.5 * *mps_view_f64(&m, k, 0) * speed * speed;
    sum += 0.5 * *mps_view_f64(&V, k, 0) * yy * yy / modulus;
  }
  return sum;
}

/* A bar of 25 cells between rollers, fixed at the bottom, oscillates `periods` times: the mean
 * period over the exact 4 L/c, and what is left of the energy. */
static void vibrating_bar(int scheme, int periods, double *period, double *energy) {
  const double E = 1e6, rho = 1000.0, length = 1.0, modulus = E * 0.7 / (1.3 * 0.4);
  const double exact = 4.0 * length / sqrt(modulus / rho);
  scoped_mpm_scene s = mpm_scene_begin(context, 0.02, 0.0, 0.0, E);
  mpm_scene_box(&s, 0.0, 0.0, 0.08, length);
  OK(mps_particles_add_field(s.particles, "velocity", 0));
  mps_view x = mpm_scene_view(&s, "position");
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 1) = 0.01 * sin(0.5 * PI * *mps_view_f64(&x, k, 1) / length);
  DEF(mpm, def, .cell = 0.04, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.08);
  solve(&s, &def, scheme);
  const double start = bar_energy(&s, modulus);
  double first = 0.0, last = 0.0, before = mpm_scene_totals(&s).linear[1], t_before = 0.0;
  for (int found = 0; found < 2 * periods + 1;) {
    OK(mps_mpm_step(s.mpm, 1));
    const double now = mpm_scene_totals(&s).linear[1], t = mps_mpm_time(s.mpm);
    if (now * before < 0.0) {
      last = t_before + (t - t_before) * before / (before - now);
      if (found++ == 0) first = last;
    }
    before = now;
    t_before = t;
    assert_true(t < (periods + 2) * exact);
  }
  *period = (last - first) / periods / exact;
  *energy = bar_energy(&s, modulus) / start;
}

TEST(bar_swings) {
  for (int scheme = 0; scheme < SCHEMES; scheme++) {
    double period, energy;
    vibrating_bar(scheme, 5, &period, &energy);
    print_message("bar, %s: period over exact %.5f, energy left after 5 periods %.4f\n",
                  name[scheme], period, energy);
    NEAR(period, 1.0, scheme == WLS ? 0.002 : 0.03);
    if (scheme == WLS) assert_true(energy > 0.99 && energy < 1.0);
    if (scheme == FLIP) assert_true(energy > 0.95 && energy < 1.0);
    if (scheme == BLEND) assert_true(energy > 0.8 && energy < 0.95);
    if (scheme == PIC) assert_true(energy < 0.4);
  }
}

/* ---- column ---------------------------------------------------------------------------------- */

static double column(int scheme, int32_t spline) {
  const double rho = 1000.0, g = 10.0, K0 = 0.3 / 0.7;
  scoped_mpm_scene s = mpm_scene_begin(context, 0.02, 0.0, 0.0, 1e7);
  mpm_scene_box(&s, 0.0, 0.0, 0.2, 1.0);
  mpm_scene_weigh(&s, rho * g, K0, 1.0);
  DEF(mpm, def, .cell = 0.04, .spline = spline, .lower[0] = def.lower[1] = 0.0, .upper[0] = 0.2,
      .gravity[1] = -g);
  solve(&s, &def, scheme);
  OK(mps_mpm_run(s.mpm, 0.2, 1000000, NULL, NULL));
  return mpm_scene_weight_error(&s, rho * g, 1.0);
}

TEST(column_rests) {
  for (int scheme = 0; scheme < SCHEMES; scheme++) {
    const double cubic = column(scheme, 3), quadratic = column(scheme, 2);
    print_message("column, %s: stress within %.4f, quadratic %.4f\n", name[scheme], cubic,
                  quadratic);
    assert_true(scheme == WLS ? cubic < 0.005 : cubic < 0.15);
    assert_true(quadratic <= cubic);
  }
}

/* ---- damping of waves by transfers ----------------------------------------------------------- */

/* B-spline at the distance s (cells), written here independently. */
static double bump(int32_t spline, double s) {
  const double a = fabs(s);
  if (spline == 2) return a < 0.5 ? 0.75 - a * a : a < 1.5 ? 0.5 * (1.5 - a) * (1.5 - a) : 0.0;
  return a < 1.0 ? 2.0 / 3.0 - a * a + 0.5 * a * a * a : a < 2.0 ? pow(2.0 - a, 3.0) / 6.0 : 0.0;
}

/* Of a wave v = cos k x at the nodes, k in 1/cell: the share that is left after particles at 1/4
 * and 3/4 of each cell have taken their velocity and slope from it and given them back. */
static double left_of_wave(int32_t spline, double k) {
  const double m2 = spline == 3 ? 1.0 / 3.0 : 0.25;
  double given = 0.0, weight = 0.0;
  for (int p = -8; p < 8; p++) {
    const double x = 0.5 * p + 0.25, w = bump(spline, x);
    double v = 0.0, slope = 0.0;
    for (int i = -8; i <= 8; i++) {
      v += bump(spline, i - x) * cos(k * i);
      slope += bump(spline, i - x) * (i - x) / m2 * cos(k * i);
    }
    given += w * (v - slope * x);
    weight += w;
  }
  return given / weight;
}

/* A shear wave between mirrors, of very soft ground: the ratio of its amplitudes after and
 * before a step. The first five, in which the particles get their velocity gradients, are not
 * counted. */
static double left_by_step(int32_t spline, int cells) {
  enum { STEPS = 20 };
  const double h = 0.02, length = cells * h;
  mpm_scene s = mpm_scene_begin(context, 0.5 * h, 0.0, 0.0, 1e-3);
  mpm_scene_box(&s, 0.0, 0.0, length, 4.0 * h);
  mps_view x = mpm_scene_view(&s, "position");
  OK(mps_particles_set(s.particles, "velocity", 0, 0.0));
  EDIT(v, s.particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++)
      *mps_edit_f64(&v, k, 1) = cos(2.0 * PI * *mps_view_f64(&x, k, 0) / length);
  DEF(mpm, def, .cell = h, .spline = spline, .dt = 1e-9, .lower[0] = 0.0, .upper[0] = length);
  mpm_scene_solve(&s, &def);
  OK(mps_mpm_step(s.mpm, 5));
  x = mpm_scene_view(&s, "velocity");
  const double before = *mps_view_f64(&x, 0, 1);
  OK(mps_mpm_step(s.mpm, STEPS));
  x = mpm_scene_view(&s, "velocity");
  const double after = *mps_view_f64(&x, 0, 1);
  mpm_scene_end(&s);
  return pow(after / before, 1.0 / STEPS);
}

/* A wave of a few cells is damped by the transfers of each step, however short that is, by about
 * (k h)^4/42 with quadratic weights and (k h)^4/21 with cubic ones. */
TEST(transfers_damp_waves) {
  for (int32_t spline = 2; spline <= 3; spline++)
    for (int cells = 4; cells <= 12; cells += 4) {
      const double k = 2.0 * PI / cells;
      const double left = left_by_step(spline, cells), theory = left_of_wave(spline, k);
      print_message(
          "wave of %d cells, spline %d: a step takes off %.3e, theory %.3e, %.4f (kh)^4\n", cells,
          spline, 1.0 - left, 1.0 - theory, (1.0 - left) / pow(k, 4.0));
      NEAR(1.0 - left, 1.0 - theory, 1e-6);
      assert_true((1.0 - left) / pow(k, 4.0) < (spline == 3 ? 1.0 / 21.0 : 1.0 / 41.0));
    }
}
