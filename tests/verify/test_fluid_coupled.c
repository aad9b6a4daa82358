/* test_fluid_coupled.c - water and walls that move together, by steps in parts: an end wall on a
 * spring against potential flow, and a wall that bends.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "fluid_tank.h"

/* A wall of mass m on a spring k, with the midpoint rule over a step. */
typedef struct spring_wall {
  double m, k, still; /* kg, N/m; force of the water at rest, N */
  double x, v;        /* m, m/s, into the tank, from the spring's rest */
  double start;       /* m: x at the beginning, where the water's edge is */
  double first;       /* relaxation that a step begins with */
  int64_t solutions;
} spring_wall;

/* Acceleration of the wall over the step if the water presses with -force at its middle. */
static double answer(const spring_wall *w, double force, double dt) {
  const double load = -force + w->still;
  return (load - w->k * (w->x + 0.5 * dt * w->v)) / (w->m + 0.25 * dt * dt * w->k);
}

/* One step with Aitken's relaxation of the wall's acceleration, from a. */
static double coupled_step(const tank *t, spring_wall *w, double a, double dt) {
  double factor = w->first, before = 0.0;
  OK(mps_fluid_begin_step(t->fluid, dt));
  for (int k = 0;; k++) {
    const double v = w->v + dt * a, x = w->x + 0.5 * dt * (w->v + v) - w->start;
    mps_reaction r;
    OK(mps_fluid_set_boundary_motion(t->fluid, TANK_RIGHT, &x, &v));
    OK(mps_fluid_solve_pressure(t->fluid));
    OK(mps_fluid_get_reaction(t->fluid, TANK_RIGHT, &r));
    const double residual = answer(w, -r.force[0], dt) - a;
    w->solutions++;
    if (fabs(residual) < 1e-4 * (fabs(a + residual) + 1e-3 * TANK_G)) break;
    assert_true(k < 20);
    if (k > 0) factor = -factor * before / (residual - before);
    before = residual;
    a += factor * residual;
  }
  w->x += 0.5 * dt * (2.0 * w->v + dt * a);
  w->v += dt * a;
  OK(mps_fluid_end_step(t->fluid));
  return a;
}

/* Added mass (kg) of the end wall of a closed tank that oscillates with w, by linear potential
 * flow: sum over the k with k tan(k d) = -w^2/g of rho I^2 coth(k L)/(k N), I = int cos(k y) dy, N
 * = int cos^2(k y) dy. The short surface wave carries less than 1/1000 of it. */
static double added_mass(double w, double length, double depth) {
  double sum = 0.0;
  for (int j = 0; j < 2000; j++) {
    double low = (j + 0.5) * TANK_PI / depth * (1.0 + 1e-12), high = (j + 1) * TANK_PI / depth;
    for (int n = 0; n < 60; n++) {
      const double k = 0.5 * (low + high);
      if (k * tan(k * depth) < -w * w / TANK_G)
        low = k;
      else
        high = k;
    }
    const double k = low, I = sin(k * depth) / k;
    const double N = 0.5 * (depth + sin(2.0 * k * depth) / (2.0 * k));
    sum += 1000.0 * I * I / (tanh(k * length) * k * N);
  }
  return sum;
}

/* Tank .6 x .3 m, end wall of 10 kg on 211.8 kN/m, 1 mm off: w^2 = k/(m + m_a). */
TEST(a_wall_on_a_spring_swings_as_with_added_mass) {
  const double dt = 5e-4, l0 = 0.02;
  spring_wall w = {.m = 10.0, .k = 211800.0, .still = 0.5 * 1000.0 * TANK_G * 0.09, .first = 0.1};
  double exact = 60.0;
  for (int n = 0; n < 5; n++) exact = sqrt(w.k / (w.m + added_mass(exact, 0.6, 0.3)));
  NEAR(exact, 60.35, 0.1);
  scoped_tank t = tank_make(context, 0.6, 0.3, l0, NULL, dt);
  w.x = w.start = 1e-3;
  double a = 0.0, last = 0.0, first_zero = 0.0, zero = 0.0;
  int zeros = 0, steps = 0;
  for (; zeros < 9; steps++) {
    const double before = w.x;
    a = coupled_step(&t, &w, a, dt);
    assert_true(steps < 4000);
    last = w.x;
    if (!(before < 0.0) != !(last < 0.0)) {
      zero = dt * (steps + before / (before - last));
      if (zeros++ == 0) first_zero = zero;
    }
  }
  const double omega = 8.0 * TANK_PI / (zero - first_zero);
  print_message("omega %.3f rad/s, potential flow %.3f (%+.2f %%), %.2f solutions a step\n", omega,
                exact, 100.0 * (omega / exact - 1.0), (double)w.solutions / steps);
  NEAR(omega, exact, 0.005 * exact);
  assert_true((double)w.solutions / steps < 4.0);
}

/* ---- a wall that bends ----------------------------------------------------------------------- */

enum { NODES = 61 };

/* A tank of still water whose right wall has nodes every d/60, listed from the top. */
static tank bending_tank(double l0, double depth) {
  double nodes[3 * NODES];
  tank t = tank_make(context, 0.6, depth, l0, NULL, 1e-3);
  mps_fluid_boundary_def def = mps_fluid_boundary_defaults();
  def.kind = MPS_BOUNDARY_ROLLER; /* slip */
  OK(mps_fluid_remove_boundary(t.fluid, TANK_RIGHT));
  for (int k = 0; k < NODES; k++)
    nodes[3 * k] = 0.6, nodes[3 * k + 1] = depth * (1.0 - k / (NODES - 1.0)),
              nodes[3 * k + 2] = 0.0;
  def.point[0] = 0.6, def.normal[0] = -1.0;
  def.nodes = nodes, def.node_count = NODES;
  int32_t number;
  OK(mps_fluid_add_boundary(t.fluid, &def, &number));
  assert_int_equal(number, TANK_RIGHT);
  return t;
}

/* A wall that starts with acceleration a cos(k y), k = (j + 1/2) pi/d, feels p = rho a coth(k L)/k
 * cos(k y): pressures along it and their resultant. */
TEST(a_bending_wall_feels_the_pressure_of_its_shape) {
  const double d = 0.3, l0 = 0.01, a = 2.0, still = 0.5 * 1000.0 * TANK_G * d * d;
  scoped_tank t = bending_tank(l0, d);
  for (int j = 0; j < 3; j++) {
    const double k = (j + 0.5) * TANK_PI / d, p0 = 1000.0 * a / (k * tanh(k * 0.6));
    double velocity[NODES], x[3 * 15], p[15], worst = 0.0, sum = 0.0;
    mps_reaction r;
    OK(mps_fluid_begin_step(t.fluid, NAN));
    for (int n = 0; n < NODES; n++) velocity[n] = 1e-3 * a * cos(k * d * (1.0 - n / (NODES - 1.0)));
    OK(mps_fluid_set_boundary_motion(t.fluid, TANK_RIGHT, NULL, velocity));
    OK(mps_fluid_solve_pressure(t.fluid));
    OK(mps_fluid_get_reaction(t.fluid, TANK_RIGHT, &r));
    for (int n = 0; n < 15; n++)
      x[3 * n] = 0.6, x[3 * n + 1] = (n + 0.5) * d / 15.0, x[3 * n + 2] = 0.0;
    OK(mps_fluid_get_pressure(t.fluid, TANK_RIGHT, 15, x, p));
    for (int n = 0; n < 15; n++) {
      const double y = x[3 * n + 1], exact = 1000.0 * TANK_G * (d - y) + p0 * cos(k * y);
      if (exact > 0.0) worst = fmax(worst, fabs(p[n] - exact) / p0);
      sum += p[n] * d / 15.0;
    }
    const double force = -r.force[0] - still, exact = p0 * (j % 2 ? -1.0 : 1.0) / k;
    print_message(
        "mode %d: force %.3f N, exact %.3f N (%+.2f %% of p0 d); pressures within %.2f %% of "
        "p0, their sum %+.2f %%\n",
        j, force, exact, 100.0 * (force - exact) / (p0 * d), 100.0 * worst,
        100.0 * (sum / -r.force[0] - 1.0));
    NEAR(force, exact, 0.02 * p0 * d);
    assert_true(worst < 0.05);
    NEAR(sum, -r.force[0], 0.005 * still);
    OK(mps_fluid_abandon_step(t.fluid));
  }
}

/* Nodes that move alike are a plane wall. */
TEST(nodes_that_move_alike_are_a_plane_wall) {
  scoped_tank plane = tank_make(context, 0.6, 0.2, 0.02, NULL, 1e-3),
              bent = bending_tank(0.02, 0.2);
  mps_reaction r[2];
  for (int k = 0; k < 100; k++) {
    double v[NODES];
    for (int n = 0; n < NODES; n++) v[n] = 0.1 * sin(0.05 * k);
    OK(mps_fluid_set_boundary_motion(plane.fluid, TANK_RIGHT, NULL, v));
    OK(mps_fluid_set_boundary_motion(bent.fluid, TANK_RIGHT, NULL, v));
    OK(mps_fluid_step(plane.fluid, 1));
    OK(mps_fluid_step(bent.fluid, 1));
  }
  OK(mps_fluid_get_reaction(plane.fluid, TANK_RIGHT, &r[0]));
  OK(mps_fluid_get_reaction(bent.fluid, TANK_RIGHT, &r[1]));
  assert_true(fabs(r[0].force[0] + 0.5 * 1000.0 * TANK_G * 0.04) > 1.0);
  NEAR(r[0].force[0], r[1].force[0], 1e-6 * fabs(r[0].force[0]));
  NEAR(r[0].work, r[1].work, 1e-6 * fabs(r[0].work));
}
