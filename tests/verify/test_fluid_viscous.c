/* test_fluid_viscous.c - viscosity in closed boxes full of water against exact decay rates: a
 * vortex between walls that slip, and the slowest Stokes flow between walls that hold the water.
 * And below a free surface: a film that a body force drives along a wall, and a standing wave. And
 * beside bodies: water that a lid drags along, the torque of a disc that turns, light discs that
 * turn freely. SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

#include <complex.h>

#define NU 0.01 /* m2/s */

/* Velocities of the stream function sin(pi x) sin(pi y)/pi, or its square. */
static void add_swirl(mps_particles *water, bool square, double size) {
  OK(mps_particles_add_field(water, "velocity", 0));
  mps_view x = view_field(water, "position");
  EDIT(u, water, "velocity")
    for (int64_t i = 0; i < mps_particles_count(water); i++) {
      const double a = TANK_PI * *mps_view_f64(&x, i, 0), b = TANK_PI * *mps_view_f64(&x, i, 1);
      *mps_edit_f64(&u, i, 0) = size * (square ? sin(a) * sin(a) * sin(2.0 * b) : sin(a) * cos(b));
      *mps_edit_f64(&u, i, 1) = -size * (square ? sin(b) * sin(b) * sin(2.0 * a) : cos(a) * sin(b));
    }
}

/* Rate of the velocity's decay between t1 and t2, in units of NU/(1 m)^2. The level stands above
 * the box, so that no pressure is below 0. Flow between walls of no slip decays to where the
 * particles' own noise counts: it begins faster. */
static double decay(int32_t kind, double l0, double t1, double t2) {
  scoped_fluid *fluid = NULL;
  DEF(particles, set, .spacing = l0);
  DEF(fluid, def, .gravity[1] = -0.1, .level = 2.0, .viscosity = 1000.0 * NU,
      .dt = fmin(0.02, 0.15 * l0 * l0 / NU));
  MAKE(particles, water, create, context, &set);
  tank_fill(water, 1.0, 1.0, NULL, NULL);
  const bool held = kind == MPS_BOUNDARY_HELD;
  add_swirl(water, held, held ? 0.05 : 0.02);
  OK(mps_fluid_create(context, water, &def, &fluid));
  for (int b = 0; b < 4; b++) {
    mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
    wall.kind = MPS_BOUNDARY_ROLLER; /* slip */
    wall.kind = kind;
    wall.point[0] = wall.point[1] = b < 2 ? 0.0 : 1.0;
    wall.normal[b % 2] = b < 2 ? 1.0 : -1.0;
    OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  }
  mps_totals first, last;
  OK(mps_fluid_run(fluid, t1, 1000, NULL, NULL));
  OK(mps_fluid_get_totals(fluid, &first));
  OK(mps_fluid_run(fluid, t2, 1000, NULL, NULL));
  OK(mps_fluid_get_totals(fluid, &last));
  return 0.5 * log(first.kinetic / last.kinetic) / (t2 - t1) / NU;
}

TEST(a_vortex_between_slip_walls_decays_as_exact) {
  const double exact = 2.0 * TANK_PI * TANK_PI, l0[2] = {1.0 / 20.0, 1.0 / 40.0};
  double error[2];
  for (int k = 0; k < 2; k++) {
    error[k] = decay(MPS_BOUNDARY_ROLLER, l0[k], 0.5, 2.5) / exact - 1.0;
    print_message("slip, l0 1/%g: rate %+.2f %%\n", 1.0 / l0[k], 100.0 * error[k]);
  }
  NEAR(error[0], 0.0, 0.05);
  NEAR(error[1], 0.0, 0.02);
}

/* The lowest eigenvalue of the Stokes operator in the unit square: 4 x 13.0861727 (Leriche and
 * Labrosse 2004). */
TEST(flow_between_walls_of_no_slip_decays_as_the_stokes_mode) {
  const double exact = 4.0 * 13.0861727, l0[2] = {1.0 / 20.0, 1.0 / 40.0};
  double error[2];
  for (int k = 0; k < 2; k++) {
    error[k] = decay(MPS_BOUNDARY_HELD, l0[k], 2.0, 4.0) / exact - 1.0;
    print_message("no slip, l0 1/%g: rate %+.2f %%\n", 1.0 / l0[k], 100.0 * error[k]);
  }
  NEAR(error[0], 0.0, 0.10);
  NEAR(error[1], 0.0, 0.04);
}

/* Viscous water between two walls that move alike and a bed that holds it: the walls' reactions
 * include the friction, so that they make up the change of its momentum but for some hundredths. */
TEST(walls_feel_the_friction) {
  const double l0 = 0.02, length = 0.4, depth = 0.2;
  scoped_fluid *fluid = NULL;
  DEF(particles, set, .spacing = l0);
  DEF(fluid, def, .dt = 2e-3, .level = depth, .viscosity = 1000.0 * NU);
  MAKE(particles, water, create, context, &set);
  tank_fill(water, length, depth, NULL, NULL);
  OK(mps_fluid_create(context, water, &def, &fluid));
  mps_fluid_boundary_def bed = mps_fluid_boundary_defaults(); /* no slip */
  bed.normal[1] = 1.0;
  OK(mps_fluid_add_boundary(fluid, &bed, NULL));
  tank_wall(fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(fluid, length, 0.0, -1.0, 0.0, NULL);
  for (int k = 1; k <= 200; k++) {
    const double u = 0.1 * fmin(1.0, k / 50.0), against = -u;
    OK(mps_fluid_set_boundary_motion(fluid, TANK_LEFT, NULL, &u));
    OK(mps_fluid_set_boundary_motion(fluid, TANK_RIGHT, NULL, &against));
    OK(mps_fluid_step(fluid, 1));
  }
  mps_totals sum;
  mps_reaction r[3];
  OK(mps_fluid_get_totals(fluid, &sum));
  for (int32_t b = 0; b < 3; b++) OK(mps_fluid_get_reaction(fluid, b, &r[b]));
  const double push = r[TANK_LEFT].impulse[0];
  print_message("impulse of the left wall %.2f N s, of the right one %.2f, of the bed %.2f, of the "
                "scheme %.2f; momentum %.2f\n",
                push, r[TANK_RIGHT].impulse[0], r[TANK_BED].impulse[0], sum.impulse_scheme[0],
                sum.linear[0]);
  assert_true(r[TANK_BED].impulse[0] < -0.05 * push); /* it holds back what slides on it */
  assert_true(fabs(sum.impulse_scheme[0]) < 0.05 * push);
}

/* ---- below a free surface -------------------------------------------------------------------- */

#define PUSH 0.5 /* m/s2, along the wall */

/* Velocity at the height y of a film of thickness h, t after a body force began to act along its
 * wall: du/dt = PUSH + NU d2u/dy2, u(0) = 0 and no shear at h. */
static double of_film(double y, double h, double t) {
  double u = PUSH / NU * (h * y - 0.5 * y * y);
  for (int k = 0; k < 100; k++) {
    const double l = (k + 0.5) * TANK_PI / h;
    u -= 2.0 * PUSH / (h * NU * l * l * l) * sin(l * y) * exp(-NU * l * l * t);
  }
  return u;
}

typedef struct film {
  double h, t; /* m, s */
  int rows;
  double turn; /* of the wall against x, degrees; the film is pushed up or down it */
  bool polyline;
} film;

static void turn_about(const film *d, double along, double across, double *out) {
  const double c = cos(d->turn * TANK_PI / 180.0), s = sin(d->turn * TANK_PI / 180.0);
  out[0] = c * along - s * across, out[1] = s * along + c * across;
}

static mps_particles *fill_film(const film *d, double length) {
  const double l0 = d->h / d->rows;
  mps_particles *water = NULL;
  USING(particles, mps_particles_create(context, &given, &water), .spacing = l0);
  for (int i = 0; i < (int)(length / l0); i++)
    for (int j = 0; j < d->rows; j++) {
      double x[2];
      turn_about(d, (i + 0.5) * l0 - 0.5 * length, (j + 0.5) * l0, x);
      OK(mps_particles_append(water, 1, x));
    }
  return water;
}

/* Largest error of a velocity in the middle of a film of ten times its thickness, of the largest
 * velocity; *scheme: momentum that no wall and no load owns, of that of the load. */
static double film_error(const film *d, double *scheme) {
  scoped_fluid *fluid = NULL;
  DEF(fluid, def, .gravity[1] = 0.0, .viscosity = 1000.0 * NU);
  scoped_particles *water = fill_film(d, 10.0 * d->h);
  OK(mps_fluid_create(context, water, &def, &fluid));
  mps_fluid_boundary_def wall = mps_fluid_boundary_defaults(); /* no slip */
  double corners[6] = {0.0}, ends[2];
  turn_about(d, 0.0, 1.0, wall.normal);
  turn_about(d, 10.0 * d->h, 0.0, ends);
  corners[0] = -ends[0], corners[1] = -ends[1], corners[3] = ends[0], corners[4] = ends[1];
  if (d->polyline) wall.corners = corners, wall.corner_count = 2;
  OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  mps_fluid_load_def load = mps_fluid_load_defaults();
  load.all = 1;
  turn_about(d, PUSH, 0.0, load.acceleration);
  OK(mps_fluid_add_load(fluid, &load, NULL));
  OK(mps_fluid_run(fluid, d->t, 1000, NULL, NULL));
  mps_totals sum;
  OK(mps_fluid_get_totals(fluid, &sum));
  const double given = hypot(sum.impulse_loads[0], sum.impulse_loads[1]);
  *scheme = hypot(sum.impulse_scheme[0], sum.impulse_scheme[1]) / given;
  const mps_view x = view_field(water, "position"), u = view_field(water, "velocity");
  double axis[2], middle = 0.0, worst = 0.0;
  turn_about(d, 1.0, 0.0, axis);
  for (int64_t i = 0; i < mps_particles_count(water); i++)
    middle += (*mps_view_f64(&x, i, 0) * axis[0] + *mps_view_f64(&x, i, 1) * axis[1]) /
              (double)mps_particles_count(water);
  for (int64_t i = 0; i < mps_particles_count(water); i++) {
    const double px = *mps_view_f64(&x, i, 0), py = *mps_view_f64(&x, i, 1);
    const double v = *mps_view_f64(&u, i, 0) * axis[0] + *mps_view_f64(&u, i, 1) * axis[1];
    if (fabs(px * axis[0] + py * axis[1] - middle) > d->h) continue;
    worst = fmax(worst, fabs(v - of_film(py * axis[0] - px * axis[1], d->h, d->t)));
  }
  return worst / of_film(d->h, d->h, d->t);
}

TEST(a_film_along_a_wall_flows_as_exact) {
  const film films[] = {{0.2, 1.0, 6, 0.0, false},
                        {0.2, 1.0, 10, 27.0, false},
                        {0.14, 1.0, 14, -71.0, true},
                        {0.1, 1.0, 8, 180.0, true}};
  for (size_t k = 0; k < sizeof films / sizeof *films; k++) {
    double scheme;
    const double error = film_error(&films[k], &scheme);
    print_message(
        "film of %d rows, turned by %g degrees: velocity within %.2f %%, momentum %.2f %%\n",
        films[k].rows, films[k].turn, 100.0 * error, 100.0 * scheme);
    NEAR(error, 0.0, 0.02);
    NEAR(scheme, 0.0, 0.01);
  }
}

/* Complex rate n of a standing wave, exp(n t), of viscous water on a bed that slips: potential A
 * cosh(k y) cos(k x) and stream function C sinh(l y) sin(k x), l2 = k2 + n/nu, without shear at the
 * surface and with p = rho g eta + 2 mu dv/dy there. */
static double complex residual(double complex n, double k, double d, double nu) {
  const double complex l = csqrt(k * k + n / nu);
  const double complex C = 2.0 * k * k * sinh(k * d) / (l * l + k * k); /* times sinh(l d) */
  return n * cosh(k * d) + TANK_G / n * k * (sinh(k * d) - C) +
         2.0 * nu * k * (k * cosh(k * d) - l * C / ctanh(l * d));
}

static double complex wave_rate(double k, double d, double nu) {
  double complex n = -2.0 * nu * k * k + I * sqrt(TANK_G * k * tanh(k * d));
  for (int round = 0; round < 50; round++) {
    const double complex step = 1e-6 * n;
    n -= 2.0 * step * residual(n, k, d, nu) /
         (residual(n + step, k, d, nu) - residual(n - step, k, d, nu));
  }
  return n;
}

/* Rate of decay of the first mode from .01 d, by kinetic energies at its largest. */
static double wave_decay(double length, double depth, double l0, double nu) {
  const double k = TANK_PI / length, period = 2.0 * TANK_PI / cimag(wave_rate(k, depth, nu));
  scoped_fluid *fluid = NULL;
  DEF(particles, set, .spacing = l0);
  DEF(fluid, def, .level = depth, .viscosity = 1000.0 * nu);
  MAKE(particles, water, create, context, &set);
  tank_fill(water, length, depth, NULL, NULL);
  OK(mps_particles_add_field(water, "velocity", 0));
  mps_view x = view_field(water, "position");
  EDIT(u, water, "velocity")
    for (int64_t i = 0; i < mps_particles_count(water); i++) {
      const double a = k * *mps_view_f64(&x, i, 0), b = k * *mps_view_f64(&x, i, 1);
      const double size = 0.01 * depth * TANK_G * k * period / (2.0 * TANK_PI) / cosh(k * depth);
      *mps_edit_f64(&u, i, 0) = -size * cosh(b) * sin(a);
      *mps_edit_f64(&u, i, 1) = size * sinh(b) * cos(a);
    }
  OK(mps_fluid_create(context, water, &def, &fluid));
  tank_wall(fluid, 0.0, 0.0, 0.0, 1.0, NULL);
  tank_wall(fluid, 0.0, 0.0, 1.0, 0.0, NULL);
  tank_wall(fluid, length, 0.0, -1.0, 0.0, NULL);
  double most[2] = {0.0, 0.0};
  for (int part = 0; part < 2; part++) {
    const double from = (part == 0 ? 0.3 : 2.3) * period;
    OK(mps_fluid_run(fluid, from, 1000, NULL, NULL));
    while (mps_fluid_time(fluid) < from + 0.5 * period) {
      mps_totals sum;
      OK(mps_fluid_step(fluid, 1));
      OK(mps_fluid_get_totals(fluid, &sum));
      most[part] = fmax(most[part], sum.kinetic);
    }
  }
  return 0.5 * log(most[0] / most[1]) / (2.0 * period);
}

TEST(a_standing_wave_decays_by_the_stress_at_its_surface) {
  const double tanks[3][4] = {
      {1.0, 0.5, 0.05, 0.02}, {1.0, 0.5, 0.025, 0.02}, {0.7, 0.28, 0.014, 0.005}};
  for (int c = 0; c < 3; c++) {
    const double *t = tanks[c], exact = -creal(wave_rate(TANK_PI / t[0], t[1], t[3]));
    const double error = wave_decay(t[0], t[1], t[2], t[3]) / exact - 1.0;
    print_message("wave, d/%g, nu k2/omega %.3f: decay %.4f 1/s, %+.2f %%\n", t[1] / t[2],
                  t[3] * TANK_PI * TANK_PI / (t[0] * t[0]) /
                      cimag(wave_rate(TANK_PI / t[0], t[1], t[3])),
                  exact, 100.0 * error);
    NEAR(error, 0.0, 0.05);
  }
}

/* ---- beside bodies --------------------------------------------------------------------------- */

#define LID 0.2  /* m/s */
#define SPIN 3.0 /* 1/s */

static mps_status at_speed(void *user, double t, double motion[3]) {
  const double speed = *(const double *)user;
  motion[0] = speed * t, motion[1] = speed, motion[2] = 0.0;
  return MPS_OK;
}

/* Start of Couette's flow: a lid on water of depth h, of no slip, moves along x. */
static double of_lid(double y, double h, double t) {
  double u = y / h;
  for (int k = 1; k < 100; k++)
    u += 2.0 / (k * TANK_PI) * cos(k * TANK_PI) * exp(-NU * pow(k * TANK_PI / h, 2.0) * t) *
         sin(k * TANK_PI * y / h);
  return LID * u;
}

static void lid(int rows, double side, double *error, double *momentum, double *work) {
  const double h = 0.2, length = 2.0, t = 0.4 * h * h / NU;
  double speed = side * LID;
  const double corners[8] = {-9.0, 0.0, 9.0, 0.0, 9.0, 1.0, -9.0, 1.0};
  scoped_fluid *fluid = NULL;
  DEF(particles, set, .spacing = h / rows);
  DEF(fluid, def, .gravity[1] = 0.0, .viscosity = 1000.0 * NU);
  MAKE(particles, water, create, context, &set);
  tank_fill(water, length, h, NULL, NULL);
  OK(mps_fluid_create(context, water, &def, &fluid));
  mps_fluid_boundary_def bed = mps_fluid_boundary_defaults();
  bed.normal[1] = 1.0;
  OK(mps_fluid_add_boundary(fluid, &bed, NULL));
  DEF(body, plate, .position[1] = h);
  MAKE(body, body, create_polygon, context, &plate, 4, corners);
  MAKE(signal, motion, create_user, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, at_speed, &speed,
       NULL);
  OK(mps_body_drive(body, 0, motion, 1.0));
  scoped_contact *contact = NULL;
  OK(mps_fluid_add_contact(fluid, body, NULL, &contact)); /* no slip */
  OK(mps_fluid_run(fluid, t, 1000, NULL, NULL));
  const mps_view x = view_field(water, "position"), u = view_field(water, "velocity");
  *error = 0.0;
  for (int64_t i = 0; i < mps_particles_count(water); i++) {
    if (fabs(*mps_view_f64(&x, i, 0) - 0.5 * length - 0.5 * speed * t) > h) continue;
    const double exact = side * of_lid(*mps_view_f64(&x, i, 1), h, t);
    *error = fmax(*error, fabs(*mps_view_f64(&u, i, 0) - exact) / LID);
  }
  mps_totals sum;
  mps_reaction by;
  OK(mps_fluid_get_totals(fluid, &sum));
  OK(mps_contact_get_reaction(contact, -1, &by));
  *momentum = fabs(sum.impulse_scheme[0] / by.impulse[0]);
  *work = by.work / (-speed * by.impulse[0]);
}

TEST(water_is_dragged_along_by_a_lid) {
  const int rows[3] = {6, 10, 10};
  for (int k = 0; k < 3; k++) {
    double error, momentum, work;
    lid(rows[k], k < 2 ? 1.0 : -1.0, &error, &momentum, &work);
    print_message("lid, %d rows: velocity within %.2f %%, momentum %.2f %%, work %.4f\n", rows[k],
                  100.0 * error, 100.0 * momentum, work);
    NEAR(error, 0.0, 0.02);
    NEAR(momentum, 0.0, 0.04);
    NEAR(work, 1.0, 1e-6);
  }
}

typedef struct disc_run {
  double l0, density, nu; /* m; over the water's, 0: driven; m2/s */
} disc_run;

/* A disc of radius .12 m with 24 corners in the middle of 1 x 1 m of water, that turns with SPIN:
 * moments that the water has given to it, and its spins, after .2 and .4 s. */
static void turn_disc(const disc_run *run, double *moment, double *spin) {
  double speed = SPIN;
  const double R = 0.12, size = 1.0, mass = run->density * 1000.0 * TANK_PI * R * R;
  double corners[48];
  for (int k = 0; k < 24; k++)
    corners[2 * k] = R * cos(TANK_PI * (k + 0.5) / 12.0),
                corners[2 * k + 1] = R * sin(TANK_PI * (k + 0.5) / 12.0);
  scoped_fluid *fluid = NULL;
  DEF(particles, set, .spacing = run->l0);
  DEF(fluid, def, .viscosity = 1000.0 * run->nu);
  MAKE(particles, water, create, context, &set);
  const int n = (int)lround(size / run->l0);
  for (int k = 0; k < n * n; k++) {
    const double x[2] = {(k % n + 0.5) * run->l0, (k / n + 0.5) * run->l0};
    if (hypot(x[0] - 0.5 * size, x[1] - 0.5 * size) > R + 0.25 * run->l0)
      OK(mps_particles_append(water, 1, x));
  }
  OK(mps_fluid_create(context, water, &def, &fluid));
  for (int b = 0; b < 3; b++) {
    mps_fluid_boundary_def wall = mps_fluid_boundary_defaults();
    wall.point[0] = b == 2 ? size : 0.0;
    wall.normal[b == 0] = b == 2 ? -1.0 : 1.0;
    OK(mps_fluid_add_boundary(fluid, &wall, NULL));
  }
  DEF(body, given, .position[0] = 0.5 * size, .position[1] = 0.5 * size);
  if (mass > 0.0)
    given.motion = MPS_BODY_MOTION_FREE, given.mass = mass, given.inertia[2] = 0.5 * mass * R * R,
    given.spin[2] = SPIN;
  MAKE(body, body, create_polygon, context, &given, 24, corners);
  MAKE(signal, motion, create_user, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, at_speed, &speed,
       NULL);
  if (!(mass > 0.0)) OK(mps_body_drive(body, 5, motion, 1.0));
  scoped_contact *contact = NULL;
  OK(mps_fluid_add_contact(fluid, body, NULL, &contact));
  for (int k = 0; k < 2; k++) {
    mps_reaction by;
    mps_body_state state;
    OK(mps_fluid_run(fluid, 0.2 * (k + 1), 1000, NULL, NULL));
    OK(mps_contact_get_reaction(contact, -1, &by));
    OK(mps_body_get_state(body, &state));
    moment[k] = by.moment_impulse[2], spin[k] = state.spin[2];
  }
}

/* From .2 to .4 s, by finite differences of du/dt = nu (u'' + u'/r - u/r2), at rest at .56 m: the
 * stress is mu (u' - u/r), half of it by the spin. */
TEST(water_brakes_a_disc_that_turns) {
  const double exact = -6.218, l0[2] = {0.02, 1.0 / 64.0};
  for (int k = 0; k < 2; k++) {
    double moment[2], spin[2];
    turn_disc(&(disc_run){l0[k], 0.0, 0.05}, moment, spin);
    const double error = (moment[1] - moment[0]) / exact - 1.0;
    print_message("disc, R/l0 %g: moment %+.1f %%\n", 0.12 / l0[k], 100.0 * error);
    NEAR(error, 0.0, 0.07);
  }
}

TEST(a_light_disc_comes_to_rest) {
  const disc_run runs[3] = {{0.02, 0.02, 0.02}, {0.02, 0.002, 0.02}, {0.025, 0.002, 0.05}};
  for (int k = 0; k < 3; k++) {
    double moment[2], spin[2];
    turn_disc(&runs[k], moment, spin);
    print_message("light disc: spin %.3f, %.3f 1/s\n", spin[0], spin[1]);
    assert_true(fabs(spin[0]) < 0.1 * SPIN && fabs(spin[1]) < 0.05 * SPIN);
  }
}
