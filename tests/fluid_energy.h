/* fluid_energy.h - energy that water gives to walls and bodies, for tests: a wall that is forced
 * to vibrate, blocks that strike, standing waves, a wall on a spring.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPS_FLUID_ENERGY_H
#define MPS_FLUID_ENERGY_H

#include "fluid_tank.h"

#define ENERGY_RHO 1000.0

/* ---- a wall that is forced to vibrate -------------------------------------------------------- */

#define FORCED_LENGTH 0.8 /* m */
#define FORCED_DEPTH 0.4
#define FORCED_HEIGHT 0.5
#define FORCED_POINTS 100
#define FORCED_ACCELERATION 1.0 /* m/s2 */
#define FORCED_RAMP 4.0         /* periods */
#define FORCED_FIRST 8.0        /* .. before the fit begins */

typedef struct forced {
  double mass, exact; /* added mass and that of theory, kg */
  double damping;     /* c/(omega mass) */
} forced;

/* The wall's displacement at height y over that at .5 m: y^power. */
static inline double forced_shape(int power, double y) {
  return pow(y / FORCED_HEIGHT, (double)power);
}

/* Added mass by linear potential flow in the closed tank: k tan(k d) = -omega^2/g, sum of
 * rho I^2 coth(k L)/(k N), I = int s cos(k y) dy, N = int cos^2(k y) dy. The surface wave is
 * shorter than the spacing here and carries nothing. Where g k << omega^2 it is that of q = 0 at
 * the top. */
static inline double forced_mass(int power, double omega) {
  enum { TERMS = 200, PARTS = 4000 };
  const double d = FORCED_DEPTH;
  double sum = 0.0;
  for (int n = 1; n <= TERMS; n++) {
    double low = (n - 0.5) * TANK_PI / d * (1.0 + 1e-12), high = n * TANK_PI / d;
    for (int b = 0; b < 60; b++) {
      const double k = 0.5 * (low + high);
      if (k * tan(k * d) < -omega * omega / TANK_G)
        low = k;
      else
        high = k;
    }
    const double k = 0.5 * (low + high), N = 0.5 * d + sin(2.0 * k * d) / (4.0 * k);
    double I = 0.0;
    for (int i = 0; i < PARTS; i++) {
      const double y = (i + 0.5) * d / PARTS;
      I += forced_shape(power, y) * cos(k * y) * d / PARTS;
    }
    sum += ENERGY_RHO * I * I / (tanh(k * FORCED_LENGTH) * k * N);
  }
  return sum;
}

/* Displacement (m) that rises to an amplitude of FORCED_ACCELERATION/omega^2. */
static inline double forced_place(double omega, double t) {
  const double ramp = FORCED_RAMP * 2.0 * TANK_PI / omega;
  const double rise = t < ramp ? 0.5 - 0.5 * cos(TANK_PI * t / ramp) : 1.0;
  return FORCED_ACCELERATION / (omega * omega) * rise * sin(omega * t);
}

static inline double forced_speed(double omega, double t) {
  const double h = 1e-6; /* s */
  return (forced_place(omega, t + h) - forced_place(omega, t - h)) / (2.0 * h);
}

/* Force (N) of the water on the wall in its shape, above that at rest. */
static inline double forced_force(const double *x, const double *s, const double *p) {
  const double part = FORCED_HEIGHT / FORCED_POINTS;
  double force = 0.0;
  for (int i = 0; i < FORCED_POINTS; i++) {
    const double depth = FORCED_DEPTH - x[3 * i + 1];
    force += part * s[i] * (p[i] - (depth > 0.0 ? ENERGY_RHO * TANK_G * depth : 0.0));
  }
  return force;
}

/* Sums of a least-squares fit of force = mass a + damping v. */
typedef struct forced_fit {
  double fa, fv, aa, vv, av;
} forced_fit;

/* Vibrates the right wall of a tank, y^power, for `periods`; steps of dt. */
static inline forced forced_run(mps_context *c, double l0, double dt, int power, double omega,
                                double periods) {
  tank t = {NULL, NULL};
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
  wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
  double x[3 * FORCED_POINTS], s[FORCED_POINTS], p[FORCED_POINTS], place[FORCED_POINTS],
      speed[FORCED_POINTS];
  forced_fit sum = {0};
  int32_t number;
  set.spacing = l0, def.dt = dt, def.level = FORCED_DEPTH;
  OK(mps_particles_create(c, &set, &t.water));
  tank_fill(t.water, FORCED_LENGTH, FORCED_DEPTH, NULL, NULL);
  OK(mps_fluid_create(c, t.water, &def, &t.fluid));
  tank_wall(t.fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(t.fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  for (int i = 0; i < FORCED_POINTS; i++) {
    x[3 * i] = FORCED_LENGTH, x[3 * i + 2] = 0.0;
    x[3 * i + 1] = (i + 0.5) * FORCED_HEIGHT / FORCED_POINTS;
    s[i] = forced_shape(power, x[3 * i + 1]);
  }
  wall.point[0] = FORCED_LENGTH, wall.normal[0] = -1.0;
  wall.nodes = x, wall.node_count = FORCED_POINTS;
  OK(mps_fluid_add_boundary(t.fluid, &wall, &number));
  for (double now = 0.0; now < periods * 2.0 * TANK_PI / omega; now = mps_fluid_time(t.fluid)) {
    const double v = forced_speed(omega, now + dt), before = forced_speed(omega, now);
    for (int i = 0; i < FORCED_POINTS; i++)
      place[i] = s[i] * forced_place(omega, now + dt), speed[i] = s[i] * v;
    OK(mps_fluid_begin_step(t.fluid, dt));
    OK(mps_fluid_set_boundary_motion(t.fluid, number, place, speed));
    OK(mps_fluid_solve_pressure(t.fluid));
    OK(mps_fluid_get_pressure(t.fluid, number, FORCED_POINTS, x, p));
    OK(mps_fluid_end_step(t.fluid));
    if (now < FORCED_FIRST * 2.0 * TANK_PI / omega) continue;
    const double force = forced_force(x, s, p), a = (v - before) / dt, mean = 0.5 * (v + before);
    sum.fa += force * a, sum.fv += force * mean;
    sum.aa += a * a, sum.vv += mean * mean, sum.av += a * mean;
  }
  tank_free(&t);
  const double det = sum.aa * sum.vv - sum.av * sum.av;
  const double mass = (sum.fa * sum.vv - sum.fv * sum.av) / det;
  return (forced){mass, forced_mass(power, omega),
                  (sum.fv * sum.aa - sum.fa * sum.av) / (det * omega * mass)};
}

/* The least damping that is allowed, over omega times the mass: 0 but for rounding of the fit, and
 * that of half a per mille at the limit of the step. */
static inline double forced_least(double l0, double dt) {
  return dt > 0.9 * 0.1 * sqrt(l0 / TANK_G) ? -1e-3 : -2e-4;
}

static inline void forced_check(mps_context *c, double l0, double dt, int power, double omega,
                                double bar) {
  const forced got = forced_run(c, l0, dt, power, omega, 14.0);
  print_message(
      "l0 %g m, y^%d, %3.0f rad/s, dt %.4g ms: added mass %.3f kg, theory %.3f (%+.2f %%), "
      "damping/(m omega) %+.3f %%\n",
      l0, power, omega, 1e3 * dt, got.mass, got.exact, 100.0 * (got.mass / got.exact - 1.0),
      100.0 * got.damping);
  NEAR(got.mass, got.exact, bar * got.exact);
  assert_true(got.damping > forced_least(l0, dt));
}

/* ---- blocks that strike ---------------------------------------------------------------------- */

#define BLOCK_SIDE 0.2 /* m */

/* Share of the kinetic energy that two squares that strike face to face keep, by pressure-impulse
 * theory: P = 0 at the free sides, dP/dx = rho U where they strike. */
static inline double blocks_exact(void) {
  double lost = 0.0;
  for (int n = 1; n < 200; n += 2) lost += tanh(n * TANK_PI) / ((double)n * n * n);
  return 1.0 - 8.0 / (TANK_PI * TANK_PI * TANK_PI) * lost;
}

typedef struct blocks {
  double first, least, most, last; /* shares of the kinetic energy once they have struck */
} blocks;

/* Two squares of n x n particles, `gap` spacings farther apart than a lattice, each at 1 m/s,
 * without gravity; `t_end` s after they have struck. */
static inline blocks blocks_run(mps_context *c, int n, double gap, double t_end) {
  const double l0 = BLOCK_SIDE / n;
  mps_particles_def set = mps_particles_defaults();
  mps_fluid_def def = mps_fluid_defaults();
  mps_particles *water;
  mps_fluid *fluid;
  mps_totals sum;
  blocks got = {0.0, INFINITY, 0.0, 0.0};
  const int64_t each = (int64_t)n * n;
  double *x = malloc(4 * (size_t)each * sizeof *x);
  set.spacing = l0, def.gravity[1] = 0.0;
  for (int64_t k = 0; k < 2 * each; k++) {
    const double column = (double)(k % n), row = (double)(k % each / n);
    x[2 * k] = k < each ? l0 * (column + 0.5 + 0.5 * gap) : -l0 * (column + 0.5 + 0.5 * gap);
    x[2 * k + 1] = l0 * (row + 0.5);
  }
  OK(mps_particles_create(c, &set, &water));
  OK(mps_particles_append(water, 2 * each, x));
  OK(mps_particles_add_field(water, "velocity", 0));
  EDIT(u, water, "velocity")
    for (int64_t k = 0; k < 2 * each; k++) *mps_edit_f64(&u, k, 0) = k < each ? -1.0 : 1.0;
  OK(mps_fluid_create(c, water, &def, &fluid));
  OK(mps_fluid_get_totals(fluid, &sum));
  const double before = sum.kinetic, struck = 0.5 * (1.0 + gap) * l0;
  while (mps_fluid_time(fluid) < struck + t_end) {
    OK(mps_fluid_step(fluid, 1));
    OK(mps_fluid_get_totals(fluid, &sum));
    got.last = sum.kinetic / before;
    if (mps_fluid_time(fluid) < struck) continue;
    if (got.first == 0.0) got.first = got.last;
    got.least = fmin(got.least, got.last), got.most = fmax(got.most, got.last);
  }
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
  free(x);
  return got;
}

static inline void blocks_check(mps_context *c, int n, double gap, double bar) {
  const blocks got = blocks_run(c, n, gap, 0.25);
  const double exact = blocks_exact();
  print_message("side/l0 %d, gap %g l0: energy %.3f when struck, then %.3f to %.3f, at last %.3f; "
                "theory %.3f\n",
                n, gap, got.first, got.least, got.most, got.last, exact);
  assert_true(got.least > (1.0 - bar) * exact);
  assert_true(got.most < (1.0 + bar) * exact);
}

/* ---- standing waves -------------------------------------------------------------------------- */

#define STANDING_LENGTH 0.9 /* m */
#define STANDING_DEPTH 0.3
#define STANDING_AMPLITUDE 0.005

static inline void standing_shape(void *user, double *x, double *u) {
  const double k = TANK_PI / STANDING_LENGTH, at = x[0], y = x[1];
  const double a = STANDING_AMPLITUDE / sinh(k * STANDING_DEPTH);
  (void)user;
  (void)u;
  x[0] = at - a * cosh(k * y) * sin(k * at);
  x[1] = y + a * sinh(k * y) * cos(k * at);
}

/* Share of its amplitude that the first mode of a tank keeps over 20 periods: the least squares
 * line through the logarithms of amplitudes over two periods each, for `periods`. dt NAN: the
 * library's step. */
static inline double standing_kept(mps_context *c, double l0, double dt, double periods) {
  enum { STATIONS = 64, WINDOWS = 32 };
  const double k = TANK_PI / STANDING_LENGTH, w = sqrt(TANK_G * k * tanh(k * STANDING_DEPTH));
  const double window = 2.0 * 2.0 * TANK_PI / w;
  tank t = tank_of(c, STANDING_LENGTH, STANDING_DEPTH, l0, dt, NULL, standing_shape, NULL);
  double at[STATIONS], level[STATIONS], n = 0.0, st = 0.0, sl = 0.0, stt = 0.0, stl = 0.0;
  for (int i = 0; i < STATIONS; i++) at[i] = (i + 0.5) * STANDING_LENGTH / STATIONS;
  for (double begin = 0.0; n < 0.5 * periods; begin = mps_fluid_time(t.fluid)) {
    double qc = 0.0, qs = 0.0, cc = 0.0, ss = 0.0, cs = 0.0;
    while (mps_fluid_time(t.fluid) < begin + window) {
      OK(mps_fluid_step(t.fluid, 1));
      OK(mps_fluid_get_levels(t.fluid, STATIONS, at, level));
      const double phase = w * mps_fluid_time(t.fluid), co = cos(phase), si = sin(phase);
      double q = 0.0;
      for (int i = 0; i < STATIONS; i++)
        q += 2.0 / STATIONS * (level[i] - STANDING_DEPTH) * cos(k * at[i]);
      qc += q * co, qs += q * si, cc += co * co, ss += si * si, cs += co * si;
    }
    const double det = cc * ss - cs * cs;
    const double a = hypot((qc * ss - qs * cs) / det, (qs * cc - qc * cs) / det);
    const double middle = begin + 0.5 * window;
    n += 1.0, st += middle, sl += log(a), stt += middle * middle, stl += middle * log(a);
  }
  tank_free(&t);
  return exp((n * stl - st * sl) / (n * stt - st * st) * 10.0 * window);
}

/* ---- a wall on a spring ---------------------------------------------------------------------- */

#define SPRING_LENGTH 0.6 /* m */
#define SPRING_DEPTH 0.3
#define SPRING_MASS 10.0   /* kg */
#define SPRING_ADDED 48.05 /* kg: of the water */

typedef struct spring_result {
  double early, late; /* m: amplitudes in the second and in the last eighth of the run */
} spring_result;

/* The end wall of a tank on a spring of `stiffness` N/m (midpoint rule), released 0.5 mm or less
 * off its rest, for `periods`. */
static inline spring_result spring_run(mps_context *c, double l0, double dt, double stiffness,
                                       double periods) {
  const double omega = sqrt(stiffness / (SPRING_MASS + SPRING_ADDED));
  const double still = 0.5 * ENERGY_RHO * TANK_G * SPRING_DEPTH * SPRING_DEPTH;
  const int64_t steps = (int64_t)ceil(periods * 2.0 * TANK_PI / (omega * dt));
  const double start = fmin(0.0005, 0.2 * TANK_G / (omega * omega));
  scoped_tank t = tank_make(c, SPRING_LENGTH, SPRING_DEPTH, l0, NULL, dt);
  double x = start, v = 0.0, a = 0.0;
  spring_result got = {0.0, 0.0};
  for (int64_t n = 0; n < steps; n++) {
    double factor = 0.1, before = 0.0;
    OK(mps_fluid_begin_step(t.fluid, dt));
    for (int k = 0;; k++) {
      const double speed = v + dt * a, place = x + 0.5 * dt * (v + speed) - start;
      mps_reaction r;
      OK(mps_fluid_set_boundary_motion(t.fluid, TANK_RIGHT, &place, &speed));
      OK(mps_fluid_solve_pressure(t.fluid));
      OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &r));
      const double load = r.force[0] + still - stiffness * (x + 0.5 * dt * v);
      const double residual = load / (SPRING_MASS + 0.25 * dt * dt * stiffness) - a;
      if (fabs(residual) < 1e-4 * (fabs(a + residual) + 1e-3 * TANK_G)) break;
      assert_true(k < 20);
      if (k > 0) factor = -factor * before / (residual - before);
      before = residual, a += factor * residual;
    }
    x += 0.5 * dt * (2.0 * v + dt * a), v += dt * a;
    OK(mps_fluid_end_step(t.fluid));
    if (n >= steps / 8 && n < steps / 4) got.early = fmax(got.early, fabs(x));
    if (n >= steps - steps / 8) got.late = fmax(got.late, fabs(x));
  }
  return got;
}

static inline void spring_check(mps_context *c, double l0, double dt, double stiffness,
                                double periods) {
  const double omega = sqrt(stiffness / (SPRING_MASS + SPRING_ADDED));
  const spring_result got = spring_run(c, l0, dt, stiffness, periods);
  print_message("spring of %g N/m, dt %g ms, omega dt %.2f, %g periods: amplitude %.4g mm, then "
                "%.4g mm\n",
                stiffness, 1e3 * dt, omega * dt, periods, 1e3 * got.early, 1e3 * got.late);
  assert_true(got.late < got.early);
}

/* ---- a vortex under water -------------------------------------------------------------------- */

#define VORTEX_LENGTH 1.2 /* m */
#define VORTEX_DEPTH 0.8
#define VORTEX_RADIUS 0.15
#define VORTEX_X 0.6
#define VORTEX_Y 0.35

/* A vortex of u = spin r exp(-r^2/(2 R^2)) in a tank of still water, 0.5 s long: the water keeps
 * its volume, and gains no energy. */
static inline void vortex_check(mps_context *c, double l0, double spin) {
  scoped_tank t = tank_make(c, VORTEX_LENGTH, VORTEX_DEPTH, l0, NULL, NAN);
  const mps_view x = view_field(t.water, "position");
  mps_edit u;
  OK(mps_particles_edit(t.water, "velocity", &u));
  for (int64_t k = 0; k < x.shape[0]; k++) {
    const double dx = *mps_view_f64(&x, k, 0) - VORTEX_X, dy = *mps_view_f64(&x, k, 1) - VORTEX_Y;
    const double turn = spin * exp(-0.5 * (dx * dx + dy * dy) / (VORTEX_RADIUS * VORTEX_RADIUS));
    *mps_edit_f64(&u, k, 0) = -turn * dy, *mps_edit_f64(&u, k, 1) = turn * dx;
  }
  OK(mps_particles_commit(t.water, &u));
  mps_totals start, end;
  OK(mps_fluid_get_totals(t.fluid, &start));
  OK(mps_fluid_run(t.fluid, 0.5, 1000000, NULL, NULL));
  OK(mps_fluid_get_totals(t.fluid, &end));
  enum { STATIONS = 23 };
  double station[STATIONS], level[STATIONS], rise = 0.0;
  for (int k = 0; k < STATIONS; k++) station[k] = 0.05 + 0.05 * k;
  OK(mps_fluid_get_levels(t.fluid, STATIONS, station, level));
  for (int k = 0; k < STATIONS; k++) rise += (level[k] - VORTEX_DEPTH) / (STATIONS * l0);
  const double kept = (end.kinetic + end.strain - start.strain) / start.kinetic;
  print_message("l0 %g m, %g 1/s: the level rises by %.3f l0, %.3f of the energy is kept, %.3f as "
                "motion\n",
                l0, spin, rise, kept, end.kinetic / start.kinetic);
  assert_true(fabs(rise) < 0.15);
  assert_true(kept > 0.8 && kept < 1.1);
  assert_true(end.kinetic > 0.92 * start.kinetic);
}

#endif
