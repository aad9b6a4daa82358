/* test_fluid_viscous.c - viscosity in closed boxes full of water against exact decay rates: a
 * vortex between walls that slip, and the slowest Stokes flow between walls that hold the water.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

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
