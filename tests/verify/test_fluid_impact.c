/* test_fluid_impact.c - a column of water breaks and strikes a wall: pressures of four sensors
 * against a record of Lobovsky, Botia-Vera, Castellana, Mas-Soler and Souto-Iglesias (2014),
 * Journal of Fluids and Structures 48, figure 18, as stored with the examples of TNL-SPH (one
 * impact, not the median of many): depth H .3 m, column .6 m, tank 1.61 m; sensors 3, 15, 30 and 80
 * mm above the bed. The record's water has friction on the bed, which parts from it before the
 * wall (docs/verification/fluid/impact.md); the water here has none, so its pressures are also held
 * against a computation of the same without friction by another code: OpenFOAM 1912, interFoam, two
 * phases, laminar, walls of free slip, cells of 5 x 5 mm where the water is.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#define H 0.3
#define G 9.81
#define LENGTH 1.61
#define ROWS 30

enum { SENSORS = 4, WALL = 2 };

/* Of the record, times in (H/g)^1/2 from the release, pressures in rho g H: when the mean of 11
 * samples of 50 us passes .05; the mean from 3.3 to 4.9, and that of interFoam without friction. */
static const struct {
  double height, arrival, mean, smooth; /* m */
} record[SENSORS] = {{0.003, 2.443, 0.6935, 0.998},
                     {0.015, 2.459, 0.6679, 0.948},
                     {0.03, 2.496, 0.5914, 0.852},
                     {0.08, 2.728, 0.5423, 0.346}};

static void add_wall(mps_fluid *fluid, int axis, double at, double side) {
  DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .point[axis] = at, .normal[axis] = side);
  OK(mps_fluid_add_boundary(fluid, &wall, NULL));
}

static mps_fluid *make(mps_particles **water) {
  USING(particles, mps_particles_create(context, &given, water), .spacing = H / ROWS);
  OK(mps_particles_fill_box(*water, AT(0.0, 0.0), AT(2.0 * H, H), NULL));
  DEF(fluid, def, .level = H);
  MAKE_KEPT(fluid, fluid, create, context, *water, &def);
  add_wall(fluid, 1, 0.0, 1.0);
  add_wall(fluid, 0, 0.0, 1.0);
  add_wall(fluid, 0, LENGTH, -1.0);
  return fluid;
}

/* Pressures of the record are lower at the bed and higher above it:
 * docs/verification/fluid/impact.md. */
TEST(water_arrives_as_recorded) {
  const double unit = 1000.0 * G * H, clock = sqrt(G / H);
  scoped_particles *water = NULL;
  scoped_fluid *fluid = make(&water);
  double at[3 * SENSORS] = {0.0}, p[SENSORS], sum[SENSORS] = {0.0}, arrival[SENSORS] = {0.0};
  double before = 0.0, span = 0.0;
  for (int k = 0; k < SENSORS; k++) at[3 * k] = LENGTH, at[3 * k + 1] = record[k].height;
  while (mps_fluid_time(fluid) * clock < 4.9) {
    OK(mps_fluid_step(fluid, 1));
    OK(mps_fluid_get_pressure(fluid, WALL, SENSORS, at, p));
    const double t = mps_fluid_time(fluid) * clock;
    for (int k = 0; k < SENSORS; k++) {
      assert_true(isfinite(p[k]) && p[k] >= 0.0);
      if (arrival[k] == 0.0 && p[k] > 0.05 * unit) arrival[k] = t;
      if (t > 3.3) sum[k] += (t - before) * p[k] / unit;
    }
    if (t > 3.3) span += t - before;
    before = t;
  }
  for (int k = 0; k < SENSORS; k++) {
    const double mean = sum[k] / span;
    print_message("sensor %.0f mm: water arrives at %.2f, record %.2f (%+.1f %%), mean pressure "
                  "%.3f, record %.3f (%+.1f %%)\n",
                  1e3 * record[k].height, arrival[k], record[k].arrival,
                  100.0 * (arrival[k] / record[k].arrival - 1.0), mean, record[k].mean,
                  100.0 * (mean / record[k].mean - 1.0));
    print_message("without friction at %.0f mm: mean pressure %.3f, interFoam %.3f (%+.1f %%)\n",
                  1e3 * record[k].height, mean, record[k].smooth,
                  100.0 * (mean / record[k].smooth - 1.0));
    NEAR(arrival[k], record[k].arrival, 0.05 * record[k].arrival);
    NEAR(mean, record[k].smooth, 0.15 * record[k].smooth);
  }
}
