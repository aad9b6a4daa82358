/* test_mpm_space.c - the WLS-MPM solver in space against itself in axisymmetry, a quarter between
 * rollers: the breathing of a thin ring (exact period too), and columns, elastic and of
 * sand, that sag under their weight.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_scene.h"
#include "test_fixture.h"

#define E_ 1e6 /* Pa */
#define RHO 1e3 /* kg/m3, what mpm_scene_solve gives */
#define CUBE 2  /* particles along the edge of a cell */
#define SAMPLES 40

/* A tube inner <= r <= outer, 0 <= height <= `height`. */
typedef struct tube {
  double inner, outer, height, cell;
} tube;

/* Puts particles on circles about the axis, a spacing apart and with the volumes of their pieces of
 * the circles, so that both sets have the same r and heights and the same mass. */
static void fill_tube(mpm_scene *s, const tube *t, bool space) {
  const double d = t->cell / CUBE;
  const int layers = (int)lround(t->height / d), rings = (int)lround((t->outer - t->inner) / d);
  OK(mps_particles_add_field(s->particles, "volume", 0));
  for (int k = 0; k < layers; k++)
    for (int i = 0; i < rings; i++) {
      const double r = t->inner + (i + 0.5) * d, z = (k + 0.5) * d;
      const int count = space ? (int)lround(0.5 * PI * r / d) : 1;
      for (int j = 0; j < count; j++) {
        const double angle = (j + 0.5) / count * 0.5 * PI;
        const double at[] = {space ? r * cos(angle) : r, space ? r * sin(angle) : z, z};
        const int64_t last = mps_particles_count(s->particles);
        OK(mps_particles_append(s->particles, 1, at));
        EDIT(volume, s->particles, "volume")
          *mps_edit_f64(&volume, last, 0) = r * d * d * (space ? 0.5 * PI / count : 1.0);
      }
    }
  OK(mps_particles_add_field(s->particles, "velocity", 0));
}

static mpm_scene make_tube(const tube *t, bool space) {
  mpm_scene s = mpm_scene_begin_in(context, space ? 3 : 2, t->cell / CUBE, 0.0, 0.0, E_);
  fill_tube(&s, t, space);
  return s;
}

static void solve(mpm_scene *s, const tube *t, double g, double courant) {
  const int up = mps_particles_dim(s->particles) - 1;
  DEF(mpm, def, .geometry = up == 2 ? MPS_MPM_GEOMETRY_SPACE : MPS_MPM_GEOMETRY_AXISYMMETRIC,
      .cell = t->cell);
  for (int c = 0; c <= up; c++) def.lower[c] = 0.0;
  def.gravity[up] = -g;
  def.dt = courant * t->cell / sqrt(E_ * 0.7 / (1.3 * 0.4) / RHO);
  mpm_scene_solve(s, &def);
  if (g > 0.0) mpm_scene_side(s, 2 * up, MPS_BOUNDARY_HELD, 0.0);
}

/* Means over mass: outward velocity, upward velocity. */
static void mean_velocity(mpm_scene *s, double *out, double *upward) {
  const mps_view x = mpm_scene_view(s, "position"), v = mpm_scene_view(s, "velocity");
  const mps_view mass = mpm_scene_view(s, "mass");
  const int up = mps_particles_dim(s->particles) - 1;
  double total = 0.0;
  *out = *upward = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double m = *mps_view_f64(&mass, k, 0), X = *mps_view_f64(&x, k, 0);
    const double Y = up == 2 ? *mps_view_f64(&x, k, 1) : 0.0;
    const double vy = up == 2 ? *mps_view_f64(&v, k, 1) : 0.0;
    total += m;
    *out += m * (*mps_view_f64(&v, k, 0) * X + vy * Y) / hypot(X, Y);
    *upward += m * *mps_view_f64(&v, k, up);
  }
  *out /= total, *upward /= total;
}

/* ---- ring ------------------------------------------------------------------------------------ */

/* Starts outwards with 0.01 m/s everywhere; `v` receives the mean outward velocity after each step.
 * Returns the period (s), from the first and the third change of sign. */
static double breathe(mpm_scene *s, const tube *ring, int steps, double *v) {
  const int up = mps_particles_dim(s->particles) - 1;
  const mps_view x = mpm_scene_view(s, "position");
  EDIT(start, s->particles, "velocity")
    for (int64_t k = 0; k < x.shape[0]; k++) {
      const double X = *mps_view_f64(&x, k, 0), Y = up == 2 ? *mps_view_f64(&x, k, 1) : 0.0;
      *mps_edit_f64(&start, k, 0) = 0.01 * X / hypot(X, Y);
      if (up == 2) *mps_edit_f64(&start, k, 1) = 0.01 * Y / hypot(X, Y);
    }
  solve(s, ring, 0.0, 0.5);
  const double dt = mps_mpm_dt(s->mpm);
  double before = 0.01, crossing[3] = {0.0}, unused;
  int found = 0;
  for (int n = 0; n < steps; n++) {
    OK(mps_mpm_step(s->mpm, 1));
    mean_velocity(s, &v[n], &unused);
    if (v[n] * before < 0.0 && found < 3) crossing[found++] = dt * (n + before / (before - v[n]));
    before = v[n];
  }
  assert_int_equal(found, 3);
  return crossing[2] - crossing[0];
}

/* omega = sqrt(E/(rho R^2)); a ring as thick as this departs by some (t/R)^2, 1/100. */
TEST(ring_breathes) {
  const tube ring = {0.95, 1.05, 0.1, 0.05};
  const double exact = 2.0 * PI * sqrt(RHO / E_);
  enum { STEPS = 420 };
  double v[2][STEPS], period[2], apart = 0.0;
  for (int k = 0; k < 2; k++) {
    scoped_mpm_scene s = make_tube(&ring, k == 1);
    period[k] = breathe(&s, &ring, STEPS, v[k]);
    print_message("ring, %s: %lld particles, period %.6g s, exact %.6g s, %+.3f %%\n",
                  k ? "quarter in space" : "axisymmetric",
                  (long long)mps_particles_count(s.particles), period[k], exact,
                  100.0 * (period[k] / exact - 1.0));
  }
  for (int n = 0; n < STEPS; n++) apart = fmax(apart, fabs(v[1][n] - v[0][n]));
  print_message("velocities apart: %.3g of the first one\n", apart / 0.01);
  NEAR(period[0], exact, 0.003 * exact);
  NEAR(period[1], exact, 0.003 * exact);
  assert_true(apart < 0.03 * 0.01);
}

/* ---- column ---------------------------------------------------------------------------------- */

static void become_sand(mpm_scene *s) {
  DEF(material_drucker_prager, law, .cone = MPS_MATERIAL_CONE_INSCRIBED, .young = E_,
      .poisson = 0.3, .friction = 35.0 / 180.0 * PI);
  mps_material_destroy(&s->material);
  OK(mps_material_create_drucker_prager(context, &law, &s->material));
}

/* On a floor that holds it, free at its side: released, it sags and bulges. The largest differences
 * between space and axisymmetry over SAMPLES times until t_end, over the largest velocity: outward
 * and upward. */
static void sag(const tube *column, bool sand, double t_end, double *apart) {
  double v[2][2][SAMPLES], most[2] = {0.0, 0.0};
  apart[0] = apart[1] = 0.0;
  for (int k = 0; k < 2; k++) {
    scoped_mpm_scene s = make_tube(column, k == 1);
    if (sand) become_sand(&s);
    solve(&s, column, sand ? 9.81 : 1.0, 0.4);
    for (int n = 0; n < SAMPLES; n++) {
      OK(mps_mpm_run(s.mpm, t_end * (n + 1) / SAMPLES, 1000000, NULL, NULL));
      mean_velocity(&s, &v[k][0][n], &v[k][1][n]);
    }
  }
  for (int c = 0; c < 2; c++) {
    for (int n = 0; n < SAMPLES; n++) {
      most[c] = fmax(most[c], fabs(v[0][c][n]));
      apart[c] = fmax(apart[c], fabs(v[1][c][n] - v[0][c][n]));
    }
    apart[c] /= most[c];
  }
  print_message(
      "%s column, cell %g m: outward %.3g m/s, apart %.3g of it; downward %.3g m/s, apart "
      "%.3g of it\n",
      sand ? "sand" : "elastic", column->cell, most[0], apart[0], most[1], apart[1]);
}

TEST(elastic_column) {
  const tube column = {0.0, 0.4, 0.8, 0.1};
  double apart[2];
  sag(&column, false, 0.14, apart);
  assert_true(apart[0] < 0.05);
  assert_true(apart[1] < 0.03);
}

/* Apart by the grid: with half the cell much less. */
TEST(sand_column) {
  const tube coarse = {0.0, 0.4, 0.4, 0.1}, fine = {0.0, 0.4, 0.4, 0.05};
  double at_coarse[2], at_fine[2];
  sag(&coarse, true, 0.2, at_coarse);
  sag(&fine, true, 0.2, at_fine);
  for (int c = 0; c < 2; c++) {
    assert_true(at_fine[c] < 0.03);
    assert_true(at_fine[c] < 0.3 * at_coarse[c]);
  }
}
