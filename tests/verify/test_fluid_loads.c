/* test_fluid_loads.c - loads of the fluid against moving walls, exact solutions and linear theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define SHAKEN 5e-6 /* N of 196: pair weights are kept in single precision, 6e-8 of each */

/* ---- body loads ------------------------------------------------------------------------------ */

/* Acceleration of the tank over step n, m/s2. */
static double shaking(int n) { return 0.4 * sin(0.013 * n) - 0.2 * sin(0.031 * n); }

static mps_status shake(void *user, double t, double motion[3]) {
  (void)t;
  motion[0] = -shaking(*(const int *)user), motion[1] = motion[2] = 0.0;
  return MPS_OK;
}

/* A tank whose walls move, and the same water under a load in a tank that stands: one motion seen
 * from two places, so the forces agree to the rounding of the pair weights. */
static void a_shaken_tank_is_a_loaded_one(void **state) {
  (void)state;
  const double dt = 2e-3;
  int n = 0;
  tank moves = tank_make(context, 0.6, 0.2, 0.02, NULL, dt);
  tank stands = tank_make(context, 0.6, 0.2, 0.02, NULL, dt);
  mps_fluid_load_def load = mps_fluid_load_defaults();
  load.acceleration[0] = 1.0;
  mps_assert_ok(context, mps_signal_create_user(context, shake, &n, &load.signal[0]));
  mps_assert_ok(context, mps_fluid_add_load(stands.fluid, &load, NULL));
  mps_signal_destroy(&load.signal[0]);
  double place = 0.0, velocity = 0.0, largest = 0.0;
  for (; n < 250; n++) {
    velocity += dt * shaking(n), place += dt * velocity;
    const double back = -place, backwards = -velocity;
    mps_assert_ok(context, mps_fluid_set_wall_motion(moves.fluid, TANK_LEFT, &place, &velocity));
    mps_assert_ok(context, mps_fluid_set_wall_motion(moves.fluid, TANK_RIGHT, &back, &backwards));
    mps_assert_ok(context, mps_fluid_step(moves.fluid, 1));
    mps_assert_ok(context, mps_fluid_step(stands.fluid, 1));
    for (int32_t wall = TANK_BED; wall <= TANK_RIGHT; wall++) {
      mps_reaction a, b;
      mps_assert_ok(context, mps_fluid_get_reaction(moves.fluid, wall, &a));
      mps_assert_ok(context, mps_fluid_get_reaction(stands.fluid, wall, &b));
      if (wall == TANK_BED) continue; /* its points do not move along it */
      mps_assert_near(a.force[0], b.force[0], SHAKEN);
      largest = fmax(largest, fabs(a.force[0] - (wall == TANK_LEFT ? 196.2 : -196.2)));
    }
  }
  assert_true(largest > 20.0); /* N of 196 at rest: there is something to compare */
  tank_free(&moves);
  tank_free(&stands);
}

/* In free fall, without gravity: speed b t, work m b^2 t^2/2, nothing dissipated; only those in the
 * list. */
static void a_drop_falls(void **state) {
  (void)state;
  const double middle[2] = {0.0, 0.0}, apart[2] = {5.0, 0.0}, b = 3.0;
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_fluid_load_def load = mps_fluid_load_defaults();
  mps_particles *water;
  mps_fluid *fluid;
  set.spacing = 0.1;
  def.gravity[1] = 0.0, def.dt = 1e-3, def.measure = 0.5;
  mps_assert_ok(context, mps_particles_create(context, &set, &water));
  mps_assert_ok(context, mps_particles_fill_ball(water, middle, 1.0, NULL));
  const int64_t drop = mps_particles_count(water);
  mps_assert_ok(context, mps_particles_append(water, 1, apart));
  mps_assert_ok(context, mps_fluid_create(context, water, &def, &fluid));
  mps_view id;
  int64_t list[512], count = 0;
  mps_assert_ok(context, mps_particles_view(water, "id", &id));
  for (int64_t i = mps_particles_count(water); i-- > 0;)
    if (*mps_view_i64(&id, i, 0) != drop) list[count++] = *mps_view_i64(&id, i, 0);
  assert_int_equal(count, drop);
  load.acceleration[1] = b;
  load.ids = list, load.id_count = count;
  mps_assert_ok(context, mps_fluid_add_load(fluid, &load, NULL));
  mps_assert_ok(context, mps_fluid_step(fluid, 200));
  mps_totals sum;
  mps_assert_ok(context, mps_fluid_get_totals(fluid, &sum));
  const double mass = 1000.0 * 0.01 * 0.5 * (double)drop, work = 0.5 * mass * 0.6 * 0.6;
  mps_assert_near(sum.linear[1], mass * 0.6, 1e-9 * mass);
  mps_assert_near(sum.kinetic, work, 1e-8 * work);
  mps_assert_near(sum.work_loads, work, 1e-8 * work);
  mps_assert_near(sum.dissipated, 0.0, 1e-8 * work);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

/* ---- pressure on the surface ----------------------------------------------------------------- */

/* A tank whose pressure is solved to 1e-8, as forces are compared to 2e-5 of themselves. */
static tank exact_tank(double length, double depth) {
  tank t = {NULL, NULL};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  set.spacing = 0.02;
  def.dt = 2e-3, def.level = depth, def.tolerance = 1e-8;
  mps_assert_ok(context, mps_particles_create(context, &set, &t.water));
  tank_fill(context, t.water, length, depth, NULL, NULL);
  mps_assert_ok(context, mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(context, t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(context, t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(context, t.fluid, length, 0.0, -1.0, 0.0, NULL);
  return t;
}

/* The same pressure everywhere moves nothing and is felt everywhere: pushing or sucking. */
static void pressure_of_the_air_is_felt(void **state) {
  (void)state;
  const double still = 0.5 * 1000.0 * TANK_G * 0.04;
  for (int k = 0; k < 2; k++) {
    const double p0 = k == 0 ? 500.0 : -500.0;
    tank t = exact_tank(0.4, 0.2);
    mps_fluid_load_def load = mps_fluid_load_defaults();
    load.kind = MPS_FLUID_LOAD_PRESSURE;
    load.pressure = p0;
    mps_assert_ok(context, mps_fluid_add_load(t.fluid, &load, NULL));
    mps_assert_ok(context, mps_fluid_step(t.fluid, 50));
    mps_reaction bed, right;
    mps_totals sum;
    double p, at[3] = {0.2, 0.0, 0.0}, level, station = 0.2;
    mps_assert_ok(context, mps_fluid_get_reaction(t.fluid, TANK_BED, &bed));
    mps_assert_ok(context, mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &right));
    mps_assert_ok(context, mps_fluid_get_pressure(t.fluid, TANK_BED, 1, at, &p));
    mps_assert_ok(context, mps_fluid_get_levels(t.fluid, 1, &station, &level));
    mps_assert_near(bed.force[1], (1000.0 * TANK_G * 0.2 + p0) * 0.4, 0.02);
    mps_assert_near(right.force[0], -(still + p0 * 0.2), 0.02);
    mps_assert_near(p, 1000.0 * TANK_G * 0.2 + p0, 0.05);
    mps_assert_near(level, 0.2, 1e-6);
    mps_assert_ok(context, mps_fluid_get_totals(t.fluid, &sum));
    assert_true(sum.kinetic < 1e-8);
    tank_free(&t);
  }
}

/* A gust over the left part of a tank makes waves: modes b_j of the level cos(k_j x),
 *   b_j'' + g k_j tanh(k_j d) b_j = -k_j tanh(k_j d)/rho p_j(t),
 * p_j those of the pressure. The energy that it brings is its work. */
enum { GUST_MODES = 12 };

typedef struct gust {
  double length, depth, width, pressure, omega, dt;
  double b[GUST_MODES], v[GUST_MODES];
} gust;

static void gust_step(gust *s, double t) {
  for (int j = 0; j < GUST_MODES; j++) {
    const double k = (j + 1) * TANK_PI / s->length, kt = k * tanh(k * s->depth);
    const double part = 2.0 / (k * s->length) * sin(k * s->width);
    for (int n = 0; n < 10; n++) {
      const double dt = 0.1 * s->dt, force = s->pressure * sin(s->omega * (t + (n + 0.5) * dt));
      s->v[j] -= dt * kt * (TANK_G * s->b[j] + part * force / 1000.0);
      s->b[j] += dt * s->v[j];
    }
  }
}

static double gust_level(const gust *s, double x) {
  double sum = 0.0;
  for (int j = 0; j < GUST_MODES; j++) sum += s->b[j] * cos((j + 1) * TANK_PI * x / s->length);
  return sum;
}

/* rho g b^2 L/4 and as much when it moves, with v^2 over omega_j^2 */
static double gust_energy(const gust *s) {
  double sum = 0.0;
  for (int j = 0; j < GUST_MODES; j++) {
    const double k = (j + 1) * TANK_PI / s->length, square = TANK_G * k * tanh(k * s->depth);
    sum += 0.25 * 1000.0 * TANK_G * s->length * (s->b[j] * s->b[j] + s->v[j] * s->v[j] / square);
  }
  return sum;
}

static void a_gust_makes_waves(void **state) {
  (void)state;
  gust s = {.length = 1.2, .depth = 0.3, .width = 0.4, .pressure = 15.0, .omega = 5.0, .dt = 2e-3};
  tank t = tank_make(context, s.length, s.depth, 0.02, NULL, s.dt);
  mps_fluid_load_def load = mps_fluid_load_defaults();
  load.kind = MPS_FLUID_LOAD_PRESSURE;
  load.pressure = s.pressure;
  load.lower[0] = 0.0, load.upper[0] = s.width;
  mps_assert_ok(context, mps_signal_create_sine(context, s.omega / (2.0 * TANK_PI), 1.0, 0.0,
                                                &load.signal[0]));
  mps_assert_ok(context, mps_fluid_add_load(t.fluid, &load, NULL));
  mps_signal_destroy(&load.signal[0]);
  mps_totals rest;
  mps_assert_ok(context, mps_fluid_get_totals(t.fluid, &rest));
  double most = 0.0, miss = 0.0, level;
  const double station = s.length - 0.02;
  for (int n = 0; n < 1000; n++) {
    mps_assert_ok(context, mps_fluid_step(t.fluid, 1));
    gust_step(&s, n * s.dt);
    if (n % 10 != 9) continue;
    mps_assert_ok(context, mps_fluid_get_levels(t.fluid, 1, &station, &level));
    const double theory = gust_level(&s, station);
    most += theory * theory, miss += (level - s.depth - theory) * (level - s.depth - theory);
  }
  mps_totals sum;
  mps_assert_ok(context, mps_fluid_get_totals(t.fluid, &sum));
  const double energy = sum.kinetic + sum.strain - rest.strain;
  print_message("level %.2f %% rms off, energy %.5f J (theory %.5f), work %.5f J\n",
                100.0 * sqrt(miss / most), energy, gust_energy(&s), sum.work_loads);
  assert_true(sqrt(miss / most) < 0.06);
  mps_assert_near(energy, gust_energy(&s), 0.08 * energy);
  mps_assert_near(sum.work_loads, energy, 0.03 * energy);
  tank_free(&t);
}

/* ---- state ----------------------------------------------------------------------------------- */

static uint64_t bits_of(tank *t) {
  mps_view x;
  uint64_t sum = 14695981039346656037u;
  static const char *const names[] = {"position", "velocity", "pressure"};
  for (int f = 0; f < 3; f++) {
    mps_assert_ok(context, mps_particles_view(t->water, names[f], &x));
    for (int64_t i = 0; i < x.shape[0]; i++)
      for (int c = 0; c < (f < 2 ? 2 : 1); c++) {
        const double value = *mps_view_f64(&x, i, c);
        uint64_t word;
        memcpy(&word, &value, sizeof word);
        sum = (sum ^ word) * 1099511628211u;
      }
  }
  return sum;
}

/* Back and again: the same bits, the same work, the same wall pressures read afterwards. */
static void loads_go_back(void **state) {
  (void)state;
  tank t = tank_make(context, 0.6, 0.2, 0.02, NULL, 2e-3);
  mps_fluid_load_def gust_def = mps_fluid_load_defaults(), push = mps_fluid_load_defaults();
  gust_def.kind = MPS_FLUID_LOAD_PRESSURE;
  gust_def.pressure = -80.0, gust_def.lower[0] = 0.3;
  push.acceleration[0] = 0.7, push.upper[0] = 0.3;
  mps_assert_ok(context, mps_signal_create_sine(context, 1.0, 1.0, 0.0, &push.signal[0]));
  mps_assert_ok(context, mps_fluid_add_load(t.fluid, &gust_def, NULL));
  mps_assert_ok(context, mps_fluid_add_load(t.fluid, &push, NULL));
  mps_signal_destroy(&push.signal[0]);
  mps_snapshot *snapshot = NULL;
  uint64_t end[2];
  mps_totals sum[2];
  double p[2][2];
  const double at[3] = {0.0, 0.05, 0.0};
  for (int k = 0; k < 2; k++) {
    if (k == 0) {
      mps_assert_ok(context, mps_fluid_step(t.fluid, 33));
      mps_assert_ok(context, mps_fluid_snapshot(t.fluid, &snapshot));
    } else {
      mps_assert_ok(context, mps_fluid_rollback(t.fluid, snapshot));
    }
    mps_assert_ok(context, mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p[k][0]));
    mps_assert_ok(context, mps_fluid_step(t.fluid, 40));
    mps_assert_ok(context, mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p[k][1]));
    mps_assert_ok(context, mps_fluid_get_totals(t.fluid, &sum[k]));
    end[k] = bits_of(&t);
  }
  assert_true(end[0] == end[1]);
  assert_true(sum[0].work_loads == sum[1].work_loads && sum[0].work_loads != 0.0);
  assert_true(p[0][0] == p[1][0] && p[0][1] == p[1][1]);
  mps_snapshot_destroy(&snapshot);
  tank_free(&t);
}

/* ---- damping --------------------------------------------------------------------------------- */

/* A drop in free flight without gravity: each step takes rate dt of its speed, within the box. */
static void a_damping_zone_slows_what_is_in_it(void **state) {
  (void)state;
  const double middle[2] = {0.0, 0.0}, dt = 1e-3, rate = 3.0;
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_particles *water = NULL;
  mps_fluid *fluid = NULL;
  mps_totals sum;
  set.spacing = 0.02;
  def.gravity[1] = 0.0, def.dt = dt, def.level = 0.0;
  mps_assert_ok(context, mps_particles_create(context, &set, &water));
  mps_assert_ok(context, mps_particles_fill_ball(water, middle, 0.1, NULL));
  mps_assert_ok(context, mps_particles_add_field(water, "velocity", 0));
  mps_assert_ok(context, mps_particles_set(water, "velocity", 0, 0.5));
  mps_assert_ok(context, mps_fluid_create(context, water, &def, &fluid));
  mps_fluid_load_def load = mps_fluid_load_defaults();
  load.kind = MPS_FLUID_LOAD_DAMPING, load.rate = rate;
  mps_assert_ok(context, mps_fluid_add_load(fluid, &load, NULL));
  mps_assert_ok(context, mps_fluid_step(fluid, 100));
  mps_assert_ok(context, mps_fluid_get_totals(fluid, &sum));
  const double mass = 1000.0 * 0.02 * 0.02 * (double)mps_particles_count(water);
  const double speed = 0.5 * pow(1.0 - rate * dt, 100.0);
  mps_assert_near(sum.linear[0] / mass, speed, 1e-9);
  mps_assert_near(sum.work_loads, 0.5 * mass * (speed * speed - 0.25), 1e-6 * mass);
  load.lower[0] = 1.0, load.upper[0] = 2.0, load.side = 1; /* elsewhere */
  mps_assert_ok(context, mps_fluid_set_load(fluid, 0, &load));
  mps_assert_ok(context, mps_fluid_step(fluid, 20));
  mps_assert_ok(context, mps_fluid_get_totals(fluid, &sum));
  mps_assert_near(sum.linear[0] / mass, speed, 1e-9);
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static mps_status refuse(void *user, double t, double motion[3]) {
  (void)user, (void)t;
  motion[0] = motion[1] = motion[2] = 0.0;
  return MPS_ERROR_IO;
}

static void what_is_refused(void **state) {
  (void)state;
  tank t = tank_make(context, 0.4, 0.2, 0.02, NULL, 2e-3);
  const int64_t one = 0;
  int32_t number = -1;
  mps_fluid_load_def bad;
#define REFUSED(change, part)                                                                      \
  bad = mps_fluid_load_defaults();                                                                 \
  change;                                                                                          \
  mps_assert_fails(context, mps_fluid_add_load(t.fluid, &bad, &number), MPS_ERROR_ARGUMENT, part)
  REFUSED(bad.kind = 3, "kind of the load is 3");
  REFUSED(bad.rate = -1.0, "rate of the load is -1");
  REFUSED(bad.side = 2, "side of the load is 2");
  REFUSED((bad.kind = MPS_FLUID_LOAD_DAMPING, bad.side = 1), "lower[0] and upper[0]");
  REFUSED(bad.acceleration[1] = NAN, "acceleration[1]");
  REFUSED(bad.acceleration[2] = 1.0, "acceleration[2] of the load is 1");
  REFUSED(bad.pressure = INFINITY, "pressure of the load is inf");
  REFUSED(bad.factor[0] = NAN, "factor[0]");
  REFUSED(bad.id_count = 1, "give both or neither");
  REFUSED(bad.ids = &one, "give both or neither");
  REFUSED((bad.lower[1] = 1.0, bad.upper[1] = 0.0), "1 and 0 m along y: empty");
  mps_assert_fails(context, mps_fluid_add_load(t.fluid, NULL, NULL), MPS_ERROR_ARGUMENT, "NULL");
  assert_int_equal(number, -1);
  bad = mps_fluid_load_defaults();
  mps_assert_fails(context, mps_fluid_set_load(t.fluid, 0, &bad), MPS_ERROR_ARGUMENT, "number 0");
  mps_assert_fails(context, mps_fluid_remove_load(t.fluid, 3), MPS_ERROR_ARGUMENT, "number 3");
  for (int k = 0; k < 10; k++) mps_assert_ok(context, mps_fluid_add_load(t.fluid, &bad, &number));
  assert_int_equal(number, 9);
  mps_assert_ok(context, mps_fluid_remove_load(t.fluid, 4));
  mps_assert_ok(context, mps_fluid_add_load(t.fluid, &bad, &number));
  assert_int_equal(number, 4);
  /* a signal that refuses: the step has not happened */
  mps_assert_ok(context, mps_signal_create_user(context, refuse, NULL, &bad.signal[1]));
  mps_assert_ok(context, mps_fluid_set_load(t.fluid, 4, &bad));
  mps_signal_destroy(&bad.signal[1]);
  assert_int_equal(mps_fluid_step(t.fluid, 1), MPS_ERROR_IO);
  assert_int_equal(mps_fluid_steps(t.fluid), 0);
  mps_assert_ok(context, mps_fluid_remove_load(t.fluid, 4));
  mps_assert_ok(context, mps_fluid_step(t.fluid, 1));
  tank_free(&t);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_shaken_tank_is_a_loaded_one),
      cmocka_unit_test(a_drop_falls),
      cmocka_unit_test(pressure_of_the_air_is_felt),
      cmocka_unit_test(a_gust_makes_waves),
      cmocka_unit_test(loads_go_back),
      cmocka_unit_test(a_damping_zone_slows_what_is_in_it),
      cmocka_unit_test(what_is_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
