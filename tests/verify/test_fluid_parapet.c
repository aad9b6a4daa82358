/* test_fluid_parapet.c - water below an overhanging parapet (a recurve wall): its rest against
 * hydrostatics, and a wave that strikes it: no particle passes into the wall.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define L0 0.025
#define TOE 1.0

enum { CORNERS = 8 };

/* Bed, wall, curve towards the water, lip, crest, land. */
static const double corner[CORNERS][3] = {{-0.5, 0.0, 0.0}, {TOE, 0.0, 0.0},  {TOE, 0.3, 0.0},
                                          {0.95, 0.4, 0.0}, {0.8, 0.45, 0.0}, {0.8, 0.6, 0.0},
                                          {1.5, 0.6, 0.0},  {1.5, -1.0, 0.0}};

static mps_particles *water;
static mps_fluid *fluid;

/* Whether a point is in the wall, or below the bed. */
static bool in_solid(const double *x) {
  bool inside = false;
  for (int k = 1, last = CORNERS - 1; k < CORNERS; last = k++) {
    const double *p = corner[k], *q = corner[last];
    if ((p[1] > x[1]) != (q[1] > x[1]) &&
        x[0] < p[0] + (x[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]))
      inside = !inside;
  }
  return inside || x[1] < 0.0;
}

static double distance(const double *x) {
  double least = INFINITY;
  for (int k = 0; k + 1 < CORNERS; k++) {
    const double *p = corner[k], e[2] = {corner[k + 1][0] - p[0], corner[k + 1][1] - p[1]};
    const double d[2] = {x[0] - p[0], x[1] - p[1]};
    const double s = (d[0] * e[0] + d[1] * e[1]) / (e[0] * e[0] + e[1] * e[1]);
    const double at = fmin(fmax(s, 0.0), 1.0);
    least = fmin(least, hypot(d[0] - at * e[0], d[1] - at * e[1]));
  }
  return least;
}

/* Water up to `level` that moves towards the wall with u, m/s. */
static void make(double level, double u) {
  USING(particles, mps_particles_create(context, &given, &water), .spacing = L0);
  for (double y = 0.5 * L0; y < level; y += L0)
    for (double x = 0.5 * L0; x < TOE; x += L0) {
      const double at[2] = {x, y};
      if (!in_solid(at) && distance(at) > 0.45 * L0) OK(mps_particles_append(water, 1, at));
    }
  OK(mps_particles_add_field(water, "velocity", 0));
  EDIT(edit, water, "velocity")
    for (int64_t i = 0; i < mps_particles_count(water); i++) *mps_edit_f64(&edit, i, 0) = u;
  USING(fluid, mps_fluid_create(context, water, &given, &fluid), .level = level);
  DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .corners = corner[0],
      .corner_count = CORNERS);
  OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  wall.corners = NULL, wall.corner_count = 0;
  wall.normal[0] = 1.0;
  OK(mps_fluid_add_boundary(fluid, &wall, NULL));
}

static void drop(void) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

static int count_leaked(void) {
  int leaked = 0;
  mps_view x = view_field(water, "position");
  for (int64_t i = 0; i < x.shape[0]; i++) {
    const double at[2] = {*mps_view_f64(&x, i, 0), *mps_view_f64(&x, i, 1)};
    leaked += in_solid(at) || at[0] < 0.0;
  }
  return leaked;
}

/* Largest error of a pressure along the wall, m of water. */
static double worst_pressure(double level) {
  enum { MOST = 200 };
  double x[3 * MOST], p[MOST], worst = 0.0;
  int64_t points;
  OK(mps_fluid_get_boundary_points(fluid, 0, MOST, &points, x, p));
  assert_true(points > 50 && points <= MOST);
  for (int64_t k = 0; k < points; k++)
    worst = fmax(worst, fabs(p[k] / 9810.0 - (level - x[3 * k + 1])));
  return worst;
}

/* The level is above the lip: the water below the curve is under pressure from above. */
TEST(water_rests_below_a_parapet) {
  const double station = 0.3, level = 0.55;
  double present, force[3 * (CORNERS - 1)], worst = 0.0, lift = 0.0, out = 0.0;
  int32_t number;
  int64_t segments;
  make(level, 0.0);
  DEF(fluid_load, damping, .all = 1, .kind = MPS_FLUID_LOAD_DAMPING, .rate = 5.0);
  OK(mps_fluid_add_load(fluid, &damping, &number));
  OK(mps_fluid_step(fluid, 400));
  OK(mps_fluid_remove_load(fluid, number));
  for (int n = 0; n < 10; n++) {
    OK(mps_fluid_step(fluid, 100));
    OK(mps_fluid_get_levels(fluid, 1, &station, &present));
    worst = fmax(worst, worst_pressure(present));
    OK(mps_fluid_get_segments(fluid, 0, CORNERS - 1, &segments, force, NULL));
    for (int k = 2; k < 4; k++) { /* below the curve: pressure on its two faces */
      const double *a = corner[k], *b = corner[k + 1], mean = present - 0.5 * (a[1] + b[1]);
      lift += -force[3 * k + 1] / (9810.0 * mean * (a[0] - b[0])) / 20.0;
      out += -force[3 * k] / (9810.0 * mean * (b[1] - a[1])) / 20.0;
    }
    assert_int_equal(count_leaked(), 0);
  }
  mps_totals sum;
  OK(mps_fluid_get_totals(fluid, &sum));
  printf("%lld particles, level %.4f m: pressures within %.4f m, lift %.4f and thrust %.4f of the "
         "hydrostatic ones, kinetic energy %.1e J\n",
         (long long)mps_particles_count(water), present, worst, lift, out, sum.kinetic);
  assert_true(worst < 0.02 * level);
  NEAR(lift, 1.0, 0.02);
  NEAR(out, 1.0, 0.02);
  assert_true(sum.kinetic < 0.1);
  drop();
}

/* Water of .3 m runs against the wall, up into the curve, and is thrown back. */
TEST(a_wave_is_thrown_back) {
  mps_totals sum;
  double thrown = 0.0, lifted = 0.0;
  make(0.3, 1.5);
  OK(mps_fluid_get_totals(fluid, &sum));
  const double kinetic = sum.kinetic, before = sum.kinetic + sum.strain;
  for (int n = 0; n < 60; n++) {
    mps_reaction r;
    OK(mps_fluid_run(fluid, 0.02 * (n + 1), 1000000, NULL, NULL));
    assert_int_equal(count_leaked(), 0);
    OK(mps_fluid_get_reaction(fluid, 0, &r));
    mps_view u = view_field(water, "velocity");
    mps_view x = view_field(water, "position");
    for (int64_t i = 0; i < u.shape[0]; i++) {
      const double *v = mps_view_f64(&u, i, 0), high = *mps_view_f64(&x, i, 1);
      if (high > 0.3) thrown = fmin(thrown, *v);
      lifted = fmax(lifted, high);
    }
  }
  OK(mps_fluid_get_totals(fluid, &sum));
  printf("highest %.3f m, fastest back above .3 m %.2f m/s, energy lost %.4f of the kinetic one\n",
         lifted, thrown, (before - sum.kinetic - sum.strain) / kinetic);
  assert_true(lifted > 0.4);
  assert_true(thrown < -0.5);
  assert_true(sum.kinetic + sum.strain < before);
  drop();
}
