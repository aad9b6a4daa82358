/* test_fluid_solitary.c - a solitary wave, made by Goring's piston, climbs a vertical wall: run-up
 * against the third-order theory of Su and Mirie (1980) for the height of the wave that arrives,
 *
 *   R/d = 2 e + e^2/2 + 3 e^3/4,   e = H/d.
 *
 * The wave keeps its height on the way to the wall.
 *
 * test-verify-fluid_solitary E L0 [ANGLE]: run-up of a wave of height E d with the spacing L0 (m)
 * on the wall, or on a slope of ANGLE degrees, against R/d = 2.831 (cot ANGLE)^(1/2) e^(5/4) of
 * Synolakis (1987), which is for e < .8183 (cot ANGLE)^(-10/9) (no breaking) and e^(1/2) well above
 * .288 tan ANGLE. The tongue that climbs a slope is thinner than a spacing at its end: it is read
 * where it is a spacing thick, and continued to its end by its own slope there.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "common/tongue.h"
#include "goring.h"

#define DEPTH 0.3  /* m */
#define LENGTH 5.0 /* m */

/* Highest levels above rest (in depths): `passing` at 1.5 m from the wall before the wave comes
 * back, `wall` at the wall. */
static void climb(double e, double l0, double *passing, double *wall) {
  const solitary w = solitary_of(DEPTH, e * DEPTH);
  scoped_signal *signal = goring_piston(context, &w);
  scoped_tank t = tank_make(context, LENGTH, DEPTH, l0, signal, 0.1 * l0);
  const double station[] = {LENGTH - 1.5, LENGTH - 0.5 * l0};
  const double end = 3.8 / (w.number * w.speed) + LENGTH / w.speed + 0.8;
  *passing = *wall = 0.0;
  while (mps_fluid_time(t.fluid) < end) {
    double level[2];
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_fluid_get_levels(t.fluid, 2, station, level));
    *wall = fmax(*wall, level[1] / DEPTH - 1.0);
    if (level[1] < DEPTH * (1.0 + 0.1 * e)) /* the crest is yet to arrive at the wall */
      *passing = fmax(*passing, level[0] / DEPTH - 1.0);
  }
  printf("H/d %.4f, run-up/d %.4f\n", *passing, *wall);
}

static void a_solitary_wave_climbs_a_wall(void **state) {
  double e, run_up;
  climb(0.3, 0.025, &e, &run_up);
  const double theory = 2.0 * e + 0.5 * e * e + 0.75 * e * e * e;
  printf("theory %.4f (%+.2f %%)\n", theory, 100.0 * (run_up / theory - 1.0));
  NEAR(e, 0.3, 0.03 * 0.3);
  NEAR(run_up, theory, 0.03 * theory);
}

/* ---- a slope, for the table ------------------------------------------------------------------ */

typedef struct slope {
  double foot, angle; /* m; rad */
} slope;

static double off_slope(const slope *s, const double *x) {
  return (s->foot - x[0]) * sin(s->angle) + x[1] * cos(s->angle);
}

/* Water from the piston to the slope, whose foot is LENGTH from the piston. */
static tank before_a_slope(const slope *s, double l0, mps_signal *piston_motion) {
  tank t = {NULL, NULL};
  DEF(fluid, def, .level = DEPTH, .dt = 0.1 * l0);
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = l0);
  const int rows = (int)lround(DEPTH / l0), columns = 100 * rows;
  for (int i = 0; i < columns; i++)
    for (int j = 0; j < rows; j++) {
      const double x[2] = {(i + 0.5) * l0, (j + 0.5) * l0};
      if (off_slope(s, x) > 0.45 * l0) OK(mps_particles_append(t.water, 1, x));
    }
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, piston_motion);
  tank_wall(t.fluid, s->foot, 0.0, -sin(s->angle), cos(s->angle), NULL);
  return t;
}

/* Height above rest, in depths, of the end of the water on the slope (common/tongue.h); *resolved:
 * where the part that is a spacing thick ends. Minus infinity, both: there is none. */
static double continued(const tank *t, const slope *s, double l0, double *resolved) {
  const tongue_slope plane = {{s->foot, 0.0}, s->angle, 4000.0 * l0};
  tongue found;
  assert_true(tongue_find(t->water, &plane, l0, &found));
  *resolved = found.resolved * sin(s->angle) / DEPTH - 1.0;
  return found.end * sin(s->angle) / DEPTH - 1.0;
}

/* Highest levels above rest, in depths, on a slope. */
typedef struct climbing {
  double passing;             /* 1.5 m before the foot */
  double continued, resolved; /* see there: not at the same time */
  double theory;              /* run-up of Synolakis for `passing` */
} climbing;

static climbing climb_slope(double e, double l0, double angle) {
  const slope s = {LENGTH, angle * TANK_PI / 180.0};
  const solitary w = solitary_of(DEPTH, e * DEPTH);
  scoped_signal *signal = goring_piston(context, &w);
  tank t = before_a_slope(&s, l0, signal);
  climbing r = {0.0, 0.0, 0.0, 0.0};
  const double station = LENGTH - 1.5, start = 3.8 / (w.number * w.speed);
  while (mps_fluid_time(t.fluid) < start + LENGTH / w.speed + 0.5 + 0.6 / tan(s.angle)) {
    double level, resolved;
    OK(mps_fluid_step(t.fluid, 1));
    OK(mps_fluid_get_levels(t.fluid, 1, &station, &level));
    if (mps_fluid_time(t.fluid) < start + LENGTH / w.speed)
      r.passing = fmax(r.passing, level / DEPTH - 1.0);
    if (mps_fluid_time(t.fluid) < start || mps_fluid_steps(t.fluid) % 10 != 0) continue;
    r.continued = fmax(r.continued, continued(&t, &s, l0, &resolved));
    r.resolved = fmax(r.resolved, resolved);
  }
  tank_free(&t);
  r.theory = 2.831 * sqrt(1.0 / tan(s.angle)) * pow(r.passing, 1.25);
  print_message(
      "H/d %.4f, slope %g degrees, l0 %g m: a spacing thick to %.4f d, continued run-up/d "
      "%.4f, Synolakis %.4f (%+.1f %%)\n",
      r.passing, angle, l0, r.resolved, r.continued, r.theory,
      100.0 * (r.continued / r.theory - 1.0));
  return r;
}

static void a_solitary_wave_climbs_a_slope(void **state) {
  const climbing r = climb_slope(0.2, 0.03, 20.0);
  NEAR(r.passing, 0.2, 0.05 * 0.2);
  assert_true(r.resolved > 0.0 && r.resolved < r.continued);
  NEAR(r.continued, r.theory, 0.1 * r.theory);
}

/* ---- the table's rows by hand ---------------------------------------------------------------- */

static double asked[3];

static void a_row(void **state) {
  double e, run_up;
  if (asked[2] > 0.0) {
    climb_slope(asked[0], asked[1], asked[2]);
    return;
  }
  climb(asked[0], asked[1], &e, &run_up);
  const double theory = 2.0 * e + 0.5 * e * e + 0.75 * e * e * e;
  printf("l0 %g m: Su and Mirie %.4f (%+.2f %%)\n", asked[1], theory,
         100.0 * (run_up / theory - 1.0));
}

int main(int count, char **values) {
  if (count > 2) {
    const struct CMUnitTest row[] = {cmocka_unit_test(a_row)};
    for (int k = 0; k < 3 && k + 1 < count; k++) asked[k] = strtod(values[k + 1], NULL);
    return cmocka_run_group_tests(row, make_context, drop_context);
  }
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_solitary_wave_climbs_a_wall),
                                     cmocka_unit_test(a_solitary_wave_climbs_a_slope)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
