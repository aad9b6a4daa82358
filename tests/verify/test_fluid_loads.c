/* test_fluid_loads.c - loads of the fluid against moving walls, exact solutions and linear theory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#define SHAKEN 5e-6 /* N of 196: pair weights are kept in single precision, 6e-8 of each */

/* ---- body loads ------------------------------------------------------------------------------ */

/* Acceleration of the tank over step n, m/s2. */
static double shaking(int n) { return 0.4 * sin(0.013 * n) - 0.2 * sin(0.031 * n); }

static mps_status shake(void *user, double t, double motion[3]) {
  motion[0] = -shaking(*(const int *)user), motion[1] = motion[2] = 0.0;
  return MPS_OK;
}

/* A tank whose walls move, and the same water under a load in a tank that stands: one motion seen
 * from two places, so the forces agree to the rounding of the pair weights. */
TEST(a_shaken_tank_is_a_loaded_one) {
  const double dt = 2e-3;
  int n = 0;
  scoped_tank moves = tank_make(context, 0.6, 0.2, 0.02, NULL, dt);
  scoped_tank stands = tank_make(context, 0.6, 0.2, 0.02, NULL, dt);
  DEF(fluid_load, load, .all = 1, .acceleration[0] = 1.0);
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_VALUE, shake, &n, NULL, &load.signal[0]));
  OK(mps_fluid_add_load(stands.fluid, &load, NULL));
  mps_signal_destroy(&load.signal[0]);
  double place = 0.0, velocity = 0.0, largest = 0.0;
  for (; n < 250; n++) {
    velocity += dt * shaking(n), place += dt * velocity;
    const double back = -place, backwards = -velocity;
    OK(mps_fluid_set_boundary_motion(moves.fluid, TANK_LEFT, &place, &velocity));
    OK(mps_fluid_set_boundary_motion(moves.fluid, TANK_RIGHT, &back, &backwards));
    OK(mps_fluid_step(moves.fluid, 1));
    OK(mps_fluid_step(stands.fluid, 1));
    for (int32_t wall = TANK_BED; wall <= TANK_RIGHT; wall++) {
      mps_reaction a, b;
      OK(mps_fluid_get_reaction(moves.fluid, wall, &a));
      OK(mps_fluid_get_reaction(stands.fluid, wall, &b));
      if (wall == TANK_BED) continue; /* its points do not move along it */
      NEAR(a.force[0], b.force[0], SHAKEN);
      largest = fmax(largest, fabs(a.force[0] - (wall == TANK_LEFT ? 196.2 : -196.2)));
    }
  }
  assert_true(largest > 20.0); /* N of 196 at rest: there is something to compare */
}

static mps_status pull(void *user, double t, double value[3]) {
  ++*(int *)user;
  value[0] = 3.0, value[1] = value[2] = 0.0;
  return MPS_OK;
}

/* Without gravity the acceleration b of loads limits the step, .1 (l0/b)^1/2. A reading calls no
 * function of the caller's: it changed with what that returned; a step does. */
TEST(a_reading_of_the_limit_calls_no_function) {
  const double middle[2] = {0.0, 0.0}, l0 = 0.1, limit = 0.1 * sqrt(l0 / 3.0);
  for (int by_function = 0; by_function < 2; by_function++) {
    int calls = 0;
    DEF(particles, set, .spacing = l0);
    DEF(fluid, def, .gravity[1] = 0.0);
    DEF(fluid_load, load, .all = 1, .acceleration[0] = by_function ? 1.0 : 3.0);
    MAKE(particles, water, create, context, &set);
    OK(mps_particles_fill_ball(water, middle, 0.5, NULL));
    MAKE(fluid, fluid, create, context, water, &def);
    if (by_function)
      OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_VALUE, pull, &calls, NULL,
                                &load.signal[0]));
    OK(mps_fluid_add_load(fluid, &load, NULL));
    mps_signal_destroy(&load.signal[0]);
    const double read = mps_fluid_limit(fluid);
    assert_int_equal(calls, 0);
    assert_true(by_function ? isinf(read) : fabs(read - limit) < 1e-12);
    OK(mps_fluid_step(fluid, 1));
    NEAR(mps_fluid_time(fluid), limit, 1e-12);
    assert_int_equal(calls > 0, by_function);
    const int made = calls;
    assert_true(mps_fluid_limit(fluid) > 0.0 && mps_fluid_dt(fluid) > 0.0);
    assert_int_equal(calls, made);
  }
}

/* In free fall, without gravity: speed b t, work m b^2 t^2/2, nothing dissipated; only those in the
 * list, once each, whatever else it names. */
TEST(a_drop_falls) {
  const double middle[2] = {0.0, 0.0}, apart[2] = {5.0, 0.0}, b = 3.0;
  DEF(particles, set, .spacing = 0.1);
  DEF(fluid, def, .gravity[1] = 0.0, .dt = 1e-3, .measure = 0.5);
  MAKE(particles, water, create, context, &set);
  OK(mps_particles_fill_ball(water, middle, 1.0, NULL));
  const int64_t drop = mps_particles_count(water);
  OK(mps_particles_append(water, 1, apart));
  MAKE(fluid, fluid, create, context, water, &def);
  int64_t list[512], count = 0;
  mps_view id = view_field(water, "id");
  for (int64_t i = mps_particles_count(water); i-- > 0;)
    if (*mps_view_i64(&id, i, 0) != drop) list[count++] = *mps_view_i64(&id, i, 0);
  assert_int_equal(count, drop);
  for (int k = 0; k < 40; k++) list[count++] = k % 2 ? list[k] : 100000 + k; /* twice; not there */
  DEF(fluid_load, load, .acceleration[1] = b, .ids = list, .id_count = count);
  OK(mps_fluid_add_load(fluid, &load, NULL));
  OK(mps_fluid_step(fluid, 200));
  mps_totals sum;
  OK(mps_fluid_get_totals(fluid, &sum));
  const double mass = 1000.0 * 0.01 * 0.5 * (double)drop, work = 0.5 * mass * 0.6 * 0.6;
  NEAR(sum.linear[1], mass * 0.6, 1e-9 * mass);
  NEAR(sum.kinetic, work, 1e-8 * work);
  NEAR(sum.work_loads, work, 1e-8 * work);
  NEAR(sum.dissipated, 0.0, 1e-8 * work);
}

/* ---- pressure on the surface ----------------------------------------------------------------- */

/* A tank whose pressure is solved to 1e-8, as forces are compared to 2e-5 of themselves. */
static tank exact_tank(double length, double depth) {
  tank t = {NULL, NULL};
  DEF(fluid, def, .dt = 2e-3, .level = depth, .tolerance = 1e-8);
  USING(particles, mps_particles_create(context, &given, &t.water), .spacing = 0.02);
  tank_fill(t.water, length, depth, NULL, NULL);
  OK(mps_fluid_create(context, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(t.fluid, length, 0.0, -1.0, 0.0, NULL);
  return t;
}

/* The same pressure everywhere moves nothing and is felt everywhere: pushing or sucking. */
TEST(pressure_of_the_air_is_felt) {
  const double still = 0.5 * 1000.0 * TANK_G * 0.04;
  for (int k = 0; k < 2; k++) {
    const double p0 = k == 0 ? 500.0 : -500.0;
    scoped_tank t = exact_tank(0.4, 0.2);
    DEF(fluid_load, load, .kind = MPS_FLUID_LOAD_PRESSURE, .all = 1, .pressure = p0);
    OK(mps_fluid_add_load(t.fluid, &load, NULL));
    OK(mps_fluid_step(t.fluid, 50));
    mps_reaction bed, right;
    mps_totals sum;
    double p, at[3] = {0.2, 0.0, 0.0}, level, station = 0.2;
    OK(mps_fluid_get_reaction(t.fluid, TANK_BED, &bed));
    OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &right));
    OK(mps_fluid_get_pressure(t.fluid, TANK_BED, 1, at, &p));
    OK(mps_fluid_get_levels(t.fluid, 1, &station, &level));
    NEAR(bed.force[1], (1000.0 * TANK_G * 0.2 + p0) * 0.4, 0.02);
    NEAR(right.force[0], -(still + p0 * 0.2), 0.02);
    NEAR(p, 1000.0 * TANK_G * 0.2 + p0, 0.05);
    NEAR(level, 0.2, 1e-6);
    OK(mps_fluid_get_totals(t.fluid, &sum));
    assert_true(sum.kinetic < 1e-8);
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

TEST(a_gust_makes_waves) {
  gust s = {.length = 1.2, .depth = 0.3, .width = 0.4, .pressure = 15.0, .omega = 5.0, .dt = 2e-3};
  scoped_tank t = tank_make(context, s.length, s.depth, 0.02, NULL, s.dt);
  DEF(fluid_load, load, .kind = MPS_FLUID_LOAD_PRESSURE, .pressure = s.pressure, .lower[0] = 0.0,
      .upper[0] = s.width);
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_VALUE, s.omega / (2.0 * TANK_PI), 1.0, 0.0,
                            &load.signal[0]));
  OK(mps_fluid_add_load(t.fluid, &load, NULL));
  mps_signal_destroy(&load.signal[0]);
  mps_totals rest;
  OK(mps_fluid_get_totals(t.fluid, &rest));
  double most = 0.0, miss = 0.0, level;
  const double station = s.length - 0.02;
  for (int n = 0; n < 1000; n++) {
    OK(mps_fluid_step(t.fluid, 1));
    gust_step(&s, n * s.dt);
    if (n % 10 != 9) continue;
    OK(mps_fluid_get_levels(t.fluid, 1, &station, &level));
    const double theory = gust_level(&s, station);
    most += theory * theory, miss += (level - s.depth - theory) * (level - s.depth - theory);
  }
  mps_totals sum;
  OK(mps_fluid_get_totals(t.fluid, &sum));
  const double energy = sum.kinetic + sum.strain - rest.strain;
  print_message("level %.2f %% rms off, energy %.5f J (theory %.5f), work %.5f J\n",
                100.0 * sqrt(miss / most), energy, gust_energy(&s), sum.work_loads);
  assert_true(sqrt(miss / most) < 0.06);
  NEAR(energy, gust_energy(&s), 0.08 * energy);
  NEAR(sum.work_loads, energy, 0.03 * energy);
}

/* ---- state ----------------------------------------------------------------------------------- */

static uint64_t bits_of(tank *t) {
  mps_view x;
  uint64_t sum = 14695981039346656037u;
  static const char *const names[] = {"position", "velocity", "pressure"};
  for (int f = 0; f < 3; f++) {
    OK(mps_particles_view(t->water, names[f], &x));
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
TEST(loads_go_back) {
  scoped_tank t = tank_make(context, 0.6, 0.2, 0.02, NULL, 2e-3);
  mps_fluid_load_def gust_def = mps_fluid_load_defaults(), push = mps_fluid_load_defaults();
  gust_def.kind = MPS_FLUID_LOAD_PRESSURE;
  gust_def.pressure = -80.0, gust_def.lower[0] = 0.3;
  push.acceleration[0] = 0.7, push.upper[0] = 0.3;
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_VALUE, 1.0, 1.0, 0.0, &push.signal[0]));
  OK(mps_fluid_add_load(t.fluid, &gust_def, NULL));
  OK(mps_fluid_add_load(t.fluid, &push, NULL));
  mps_signal_destroy(&push.signal[0]);
  scoped_snapshot *snapshot = NULL;
  uint64_t end[2];
  mps_totals sum[2];
  double p[2][2];
  const double at[3] = {0.0, 0.05, 0.0};
  for (int k = 0; k < 2; k++) {
    if (k == 0) {
      OK(mps_fluid_step(t.fluid, 33));
      OK(mps_fluid_snapshot(t.fluid, &snapshot));
    } else {
      OK(mps_fluid_rollback(t.fluid, snapshot));
    }
    OK(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p[k][0]));
    OK(mps_fluid_step(t.fluid, 40));
    OK(mps_fluid_get_pressure(t.fluid, TANK_LEFT, 1, at, &p[k][1]));
    OK(mps_fluid_get_totals(t.fluid, &sum[k]));
    end[k] = bits_of(&t);
  }
  assert_true(end[0] == end[1]);
  assert_true(sum[0].work_loads == sum[1].work_loads && sum[0].work_loads != 0.0);
  assert_true(p[0][0] == p[1][0] && p[0][1] == p[1][1]);
}

/* ---- damping --------------------------------------------------------------------------------- */

/* A drop in free flight without gravity: each step takes rate dt of its speed, within the box. */
TEST(a_damping_zone_slows_what_is_in_it) {
  const double middle[2] = {0.0, 0.0}, dt = 1e-3, rate = 3.0;
  DEF(particles, set, .spacing = 0.02);
  DEF(fluid, def, .gravity[1] = 0.0, .dt = dt, .level = 0.0);
  mps_totals sum;
  MAKE(particles, water, create, context, &set);
  OK(mps_particles_fill_ball(water, middle, 0.1, NULL));
  OK(mps_particles_add_field(water, "velocity", 0));
  OK(mps_particles_set(water, "velocity", 0, 0.5));
  MAKE(fluid, fluid, create, context, water, &def);
  DEF(fluid_load, load, .kind = MPS_FLUID_LOAD_DAMPING, .rate = rate, .all = 1);
  OK(mps_fluid_add_load(fluid, &load, NULL));
  OK(mps_fluid_step(fluid, 100));
  OK(mps_fluid_get_totals(fluid, &sum));
  const double mass = 1000.0 * 0.02 * 0.02 * (double)mps_particles_count(water);
  const double speed = 0.5 * pow(1.0 - rate * dt, 100.0);
  NEAR(sum.linear[0] / mass, speed, 1e-9);
  NEAR(sum.work_loads, 0.5 * mass * (speed * speed - 0.25), 1e-6 * mass);
  load.all = 0;
  load.lower[0] = 1.0, load.upper[0] = 2.0, load.rise = 1; /* elsewhere */
  OK(mps_fluid_set_load(fluid, 0, &load));
  OK(mps_fluid_step(fluid, 20));
  OK(mps_fluid_get_totals(fluid, &sum));
  NEAR(sum.linear[0] / mass, speed, 1e-9);
}

/* ---- errors ---------------------------------------------------------------------------------- */

static mps_status refuse(void *user, double t, double motion[3]) {
  motion[0] = motion[1] = motion[2] = 0.0;
  return MPS_ERROR_IO;
}

TEST(what_is_refused) {
  scoped_tank t = tank_make(context, 0.4, 0.2, 0.02, NULL, 2e-3);
  const int64_t one = 0;
  int32_t number = -1;
  mps_fluid_load_def bad;
#define REFUSED(change, part)                                                                      \
  bad = mps_fluid_load_defaults();                                                                 \
  bad.all = 1;                                                                                     \
  change;                                                                                          \
  REFUSES(mps_fluid_add_load(t.fluid, &bad, &number), part)
  REFUSED(bad.kind = 3, "kind is 3");
  REFUSED(bad.rate = -1.0, "rate is -1 1/s");
  REFUSED(bad.rise = 2, "rise is 2");
  REFUSED((bad.kind = MPS_FLUID_LOAD_DAMPING, bad.rise = 1), "lower[0] is nan m, must be finite");
  REFUSED(bad.acceleration[1] = NAN, "acceleration[1]");
  REFUSED(bad.acceleration[2] = 1.0, "acceleration[2] is 1 m/s2");
  REFUSED(bad.pressure = INFINITY, "pressure is inf Pa");
  REFUSED(bad.factor[0] = NAN, "factor[0]");
  REFUSED((bad.all = 0, bad.id_count = 1), "at least one id is required");
  REFUSED((bad.all = 0, bad.ids = &one), "at least one id is required");
  REFUSED((bad.all = 0, bad.lower[1] = 1.0, bad.upper[1] = 0.0),
          "lower[1] is 1 m and upper[1] 0 m");
  REFUSES(mps_fluid_add_load(t.fluid, NULL, NULL), "NULL");
  assert_int_equal(number, -1);
  bad = mps_fluid_load_defaults();
  bad.all = 1;
  REFUSES(mps_fluid_set_load(t.fluid, 0, &bad), "number is 0");
  REFUSES(mps_fluid_remove_load(t.fluid, 3), "number is 3");
  for (int k = 0; k < 10; k++) OK(mps_fluid_add_load(t.fluid, &bad, &number));
  assert_int_equal(number, 9);
  OK(mps_fluid_remove_load(t.fluid, 4));
  OK(mps_fluid_add_load(t.fluid, &bad, &number));
  assert_int_equal(number, 4);
  /* a signal that refuses: the step has not happened */
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_VALUE, refuse, NULL, NULL,
                            &bad.signal[1]));
  OK(mps_fluid_set_load(t.fluid, 4, &bad));
  mps_signal_destroy(&bad.signal[1]);
  assert_int_equal(mps_fluid_step(t.fluid, 1), MPS_ERROR_IO);
  assert_int_equal(mps_fluid_steps(t.fluid), 0);
  OK(mps_fluid_remove_load(t.fluid, 4));
  OK(mps_fluid_step(t.fluid, 1));
}
