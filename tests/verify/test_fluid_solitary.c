/* test_fluid_solitary.c - a solitary wave, made by Goring's piston, climbs a vertical wall: run-up
 * against the third-order theory of Su and Mirie (1980) for the height of the wave that arrives,
 *
 *   R/d = 2 e + e^2/2 + 3 e^3/4,   e = H/d.
 *
 * The wave keeps its height on the way to the wall. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define DEPTH 0.3  /* m */
#define LENGTH 5.0 /* m */
#define SAMPLES 1200

/* Goring's piston for H sech^2: X = S tanh(theta), theta = k (c (t - t0) - X), from theta = -3.8.
 */
typedef struct wave {
  double height, speed, number, stroke; /* H, c, k, S = H/(k d) */
} wave;

static wave wave_of(double e) {
  wave w = {.height = e * DEPTH};
  w.speed = sqrt(TANK_G * (DEPTH + w.height));
  w.number = sqrt(3.0 * w.height / (4.0 * DEPTH * DEPTH * DEPTH));
  w.stroke = w.height / (w.number * DEPTH);
  return w;
}

static double time_at(const wave *w, double theta) {
  return (theta / w->number + w->stroke * tanh(theta)) / w->speed;
}

static mps_signal *piston(const wave *w) {
  double times[SAMPLES], x[SAMPLES];
  mps_signal *signal = NULL;
  const double start = time_at(w, -3.8);
  for (int k = 0; k < SAMPLES; k++) {
    double low = -4.0, high = 40.0;
    times[k] = 0.005 * k;
    for (int n = 0; n < 60; n++) {
      const double middle = 0.5 * (low + high);
      if (time_at(w, middle) - start < times[k])
        low = middle;
      else
        high = middle;
    }
    x[k] = w->stroke * (tanh(low) - tanh(-3.8));
  }
  x[0] = 0.0;
  mps_assert_ok(context,
                mps_signal_table(context, MPS_SIGNAL_DISPLACEMENT, SAMPLES, times, x, &signal));
  return signal;
}

/* Highest levels above rest (in depths): `passing` at 1.5 m from the wall before the wave comes
 * back, `wall` at the wall. */
static void climb(double e, double l0, double *passing, double *wall) {
  const wave w = wave_of(e);
  mps_signal *signal = piston(&w);
  tank t = tank_make(context, LENGTH, DEPTH, l0, signal, 0.1 * l0);
  const double station[] = {LENGTH - 1.5, LENGTH - 0.5 * l0};
  const double end = 3.8 / (w.number * w.speed) + LENGTH / w.speed + 0.8;
  *passing = *wall = 0.0;
  while (mps_fluid_time(t.fluid) < end) {
    double level[2];
    mps_assert_ok(context, mps_fluid_step(t.fluid, 1));
    mps_assert_ok(context, mps_fluid_get_levels(t.fluid, 2, station, level));
    *wall = fmax(*wall, level[1] / DEPTH - 1.0);
    if (level[1] < DEPTH * (1.0 + 0.1 * e)) /* the crest is yet to arrive at the wall */
      *passing = fmax(*passing, level[0] / DEPTH - 1.0);
  }
  printf("H/d %.4f, run-up/d %.4f\n", *passing, *wall);
  mps_signal_destroy(&signal);
  tank_free(&t);
}

static void a_solitary_wave_climbs_a_wall(void **state) {
  (void)state;
  double e, run_up;
  climb(0.3, 0.025, &e, &run_up);
  const double theory = 2.0 * e + 0.5 * e * e + 0.75 * e * e * e;
  printf("theory %.4f (%+.2f %%)\n", theory, 100.0 * (run_up / theory - 1.0));
  mps_assert_near(e, 0.3, 0.03 * 0.3);
  mps_assert_near(run_up, theory, 0.03 * theory);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_solitary_wave_climbs_a_wall)};
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
