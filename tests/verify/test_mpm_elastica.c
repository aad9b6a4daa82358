/* test_mpm_elastica.c - a slender cantilever that bends far under its own weight in the WLS-MPM
 * solver, against the elastica with shear and stretch (Reissner's beam), solved by shooting.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define LENGTH 1.0
#define DEPTH 0.1
#define YOUNG 1e6 /* Pa */
#define POISSON 0.3
#define DENSITY 1000.0
#define FAR 4.0    /* weight times L^2 over the bending stiffness */
#define SLIGHT 0.1 /* the same, for a small deflection */

/* Per unit thickness in plane strain. */
static const double modulus = YOUNG / (1.0 - POISSON * POISSON);
static const double shear = YOUNG / (2.0 * (1.0 + POISSON));

static double bending(void) { return modulus * DEPTH * DEPTH * DEPTH / 12.0; }

/* m/s2 for a load. */
static double gravity_of(double load) {
  return load * bending() / (DENSITY * DEPTH * pow(LENGTH, 3.0));
}

/* ---- the beam ---------------------------------------------------------------------------------
 * The part beyond s weighs w (L - s), which is the force on the section at s; so the state there,
 * angle, x, y and moment, follows from that at the clamp, where only the moment is unknown. */

typedef struct section {
  double angle, x, y, moment;
} section;

static section slope_of(double gravity, double s, section a) {
  const double force = DENSITY * DEPTH * gravity * (LENGTH - s); /* downwards */
  const double stretch = 1.0 - force * sin(a.angle) / (modulus * DEPTH);
  const double slide = -force * cos(a.angle) / (5.0 / 6.0 * shear * DEPTH);
  const double dx = stretch * cos(a.angle) - slide * sin(a.angle);
  return (section){.angle = a.moment / bending(),
                   .x = dx,
                   .y = stretch * sin(a.angle) + slide * cos(a.angle),
                   .moment = force * dx};
}

static section along(section a, double by, section d) {
  return (section){.angle = a.angle + by * d.angle,
                   .x = a.x + by * d.x,
                   .y = a.y + by * d.y,
                   .moment = a.moment + by * d.moment};
}

/* The section at s_end, by Runge and Kutta's steps. */
static section integrate(double gravity, double clamp_moment, double s_end) {
  enum { STEPS = 400 };
  const double ds = s_end / STEPS;
  section a = {.moment = clamp_moment};
  for (int k = 0; k < STEPS; k++) {
    const double s = ds * k, half = s + 0.5 * ds;
    const section k1 = slope_of(gravity, s, a);
    const section k2 = slope_of(gravity, half, along(a, 0.5 * ds, k1));
    const section k3 = slope_of(gravity, half, along(a, 0.5 * ds, k2));
    const section k4 = slope_of(gravity, s + ds, along(a, ds, k3));
    a = along(along(along(along(a, ds / 6.0, k1), ds / 3.0, k2), ds / 3.0, k3), ds / 6.0, k4);
  }
  return a;
}

/* The moment at the clamp for which there is none at the free end. */
static double clamp_moment(double gravity) {
  double low = -DENSITY * DEPTH * gravity * LENGTH * LENGTH, high = 0.0;
  for (int k = 0; k < 60; k++) {
    const double middle = 0.5 * (low + high);
    if (integrate(gravity, middle, LENGTH).moment < 0.0)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* The reference is right: the moment at the clamp is that of the weights where they hang, and a
 * slight load has the closed form w L^4/(8 EI) + w L^2/(2 kappa G A). */
TEST(the_beam_is_in_balance) {
  const double g = gravity_of(FAR), at_clamp = clamp_moment(g);
  double moment = 0.0;
  for (int k = 0; k < 100; k++)
    moment -=
        DENSITY * DEPTH * g * integrate(g, at_clamp, LENGTH * (k + 0.5) / 100.0).x * LENGTH / 100.0;
  NEAR(moment, at_clamp, 1e-4 * fabs(at_clamp));
  const double slight = gravity_of(1e-4), w = DENSITY * DEPTH * slight;
  NEAR(integrate(slight, clamp_moment(slight), LENGTH).y,
       -w / (8.0 * bending()) - w / (2.0 * 5.0 / 6.0 * shear * DEPTH), 1e-7 * w / bending());
}

/* ---- the solver ------------------------------------------------------------------------------ */

/* Takes a share of all velocities away, to come to rest. */
static void damp(mpm_scene *s, double share) {
  EDIT(v, s->particles, "velocity")
    EDIT(L, s->particles, "velocity_gradient")
      for (int64_t c = 0; c < 4; c++)
        for (int64_t k = 0; k < v.view.shape[0]; k++) {
          if (c < 2) *mps_edit_f64(&v, k, c) *= 1.0 - share;
          *mps_edit_f64(&L, k, c) *= 1.0 - share;
        }
}

/* Mean place of the last column of particles. */
static void tip_of(mpm_scene *s, const int64_t *ids, int64_t count, double *tip) {
  mps_view x = mpm_scene_view(s, "position");
  tip[0] = tip[1] = 0.0;
  for (int64_t k = 0; k < count; k++)
    for (int c = 0; c < 2; c++)
      tip[c] += *mps_view_f64(&x, mps_particles_index(s->particles, ids[k]), c) / (double)count;
}

/* Lets a beam of `cells` cells over its depth, with `across` x `across` particles a cell, sink
 * under its weight with critical damping for so many periods of its first mode. Its axis starts at
 * y = 0. Returns by how much the end lies lower than the beam's, relative to the beam's deflection.
 */
static double bend_for(double periods, int32_t spline, int cells, int across, double load) {
  const double cell = DEPTH / cells, spacing = cell / across, g = gravity_of(load);
  scoped_mpm_scene s = mpm_scene_begin(context, spacing, 0.0, -0.5 * DEPTH, YOUNG);
  mps_material_destroy(&s.material);
  OK(mps_material_create_neo_hookean(context, YOUNG, POISSON, &s.material));
  mpm_scene_box(&s, 0.0, -0.5 * DEPTH, LENGTH, 0.5 * DEPTH);
  const double lo[2] = {LENGTH - spacing, -INFINITY}, hi[2] = {INFINITY, INFINITY};
  int64_t ids[64], count;
  OK(mps_particles_select_box(s.particles, lo, hi, 64, &count, ids));
  assert_int_equal(count, across * cells);
  DEF(mpm, def, .cell = cell, .spline = spline, .lower[0] = 0.0, .gravity[1] = -g);
  mpm_scene_solve(&s, &def);
  mpm_scene_side(&s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_HELD, 0.0);
  const double frequency = 3.516 * sqrt(bending() / (DENSITY * DEPTH)) / (LENGTH * LENGTH);
  while (mps_mpm_time(s.mpm) < periods * 2.0 * 3.14159265358979 / frequency) {
    damp(&s, 2.0 * frequency * mps_mpm_dt(s.mpm));
    OK(mps_mpm_step(s.mpm, 1));
  }
  double tip[2];
  tip_of(&s, ids, count, tip);
  const section exact = integrate(g, clamp_moment(g), LENGTH - 0.5 * spacing);
  const double error = tip[1] / exact.y - 1.0;
  print_message("spline %d, load %g, %d cells of %d particles, %g periods: (%.4f, %.4f) m, beam "
                "(%.4f, %.4f) m, %+.2f %%\n",
                (int)spline, load, cells, across * across, periods, tip[0], tip[1], exact.x,
                exact.y, 100.0 * error);
  return error;
}

/* Until it has come to rest. */
static double bend(int32_t spline, int cells, int across, double load) {
  return bend_for(1.27, spline, cells, across, load);
}

/* What limits the accuracy far from the start is the number of particles a cell, see
 * docs/verification/wls-mpm/waves-and-bending.md. */
TEST(the_end_hangs_where_the_elastica_has_it) {
  const bool all = getenv("MPS_LONG_TESTS") != NULL;
  for (int32_t spline = 2; spline <= 3; spline++) {
    assert_true(fabs(bend(spline, 2, 4, SLIGHT)) < 0.02);
    const double coarse = bend(spline, 2, 2, FAR), fine = bend(spline, 2, 4, FAR);
    assert_true(fabs(fine) < 0.01 && fabs(fine) < 0.5 * fabs(coarse));
    assert_true(fabs(bend_for(15.0, spline, 2, 4, FAR) - fine) < 0.01); /* it does not creep */
    for (int across = 2; all && across <= 6; across += across < 4 ? 1 : 2) {
      const double wide = bend(spline, 2, across, FAR), narrow = bend(spline, 4, across, FAR);
      assert_true(fabs(narrow) < fmax(fabs(wide), 0.005));
    }
  }
}
