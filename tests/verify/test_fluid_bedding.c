/* test_fluid_bedding.c - still water around a caisson on a bedding of rock: no force sideways, the
 * buoyancy of Archimedes, and no energy gained, from lattices that are shifted and disturbed.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

#include "material_paths.h"

#define L0 0.02
#define DEPTH 0.4
#define LENGTH 1.6
#define POROSITY 0.45

#ifndef BEDDING_RADIUS
#define BEDDING_RADIUS 3.1 /* spacings, of the weights in water */
#endif

enum { CAISSON = 3, EVERY = 4, SHIFTS = 10 };

static const double caisson[5][3] = {
    {0.65, 0.1, 0.0}, {0.65, 0.6, 0.0}, {0.95, 0.6, 0.0}, {0.95, 0.1, 0.0}, {0.65, 0.1, 0.0}};
static const double bedding[4][3] = {
    {0.35, 0.0, 0.0}, {0.55, 0.1, 0.0}, {1.05, 0.1, 0.0}, {1.25, 0.0, 0.0}};

static mps_particles *water;
static mps_fluid *fluid;

static double height_of_rock(double x) {
  return fmin(fmin(0.1, 0.5 * (x - 0.35)), 0.5 * (1.25 - x));
}

/* Lattice of a spacing, shifted by fractions of it and disturbed, inside or outside of the rock. */
static void fill(double spacing, bool inside, const double *shift, double disturb, uint64_t *seed) {
  for (double y = (0.5 + shift[1]) * spacing; y < DEPTH; y += spacing)
    for (double x = (0.5 + shift[0]) * spacing; x < LENGTH; x += spacing) {
      const bool rock = y < height_of_rock(x);
      double at[2] = {x, y};
      if (rock != inside) continue;
      for (int c = 0; c < 2; c++) at[c] += disturb * spacing * noise(seed);
      const double off = 0.45 * L0;
      const bool solid = at[0] > 0.65 - off && at[0] < 0.95 + off && at[1] > 0.1 - off;
      if (!solid && at[0] > off && at[0] < LENGTH - off && at[1] > off)
        OK(mps_particles_append(water, 1, at));
    }
}

static void add_wall(int axis, double at, double side) {
  DEF(fluid_boundary, wall, .kind = MPS_BOUNDARY_ROLLER, .point[axis] = at, .normal[axis] = side);
  OK(mps_fluid_add_boundary(fluid, &wall, NULL));
}

static void start(const double *shift, double disturb, uint64_t seed, double radius) {
  mps_fluid_rock_def rock = mps_fluid_rock_defaults();
  int32_t number;
  USING(particles, mps_particles_create(context, &given, &water), .spacing = L0);
  fill(L0, false, shift, disturb, &seed);
  fill(L0 / sqrt(POROSITY), true, shift, disturb, &seed);
  DEF(fluid, def, .level = DEPTH, .radius_ratio = radius);
  OK(mps_fluid_create(context, water, &def, &fluid));
  add_wall(1, 0.0, 1.0);
  add_wall(0, 0.0, 1.0);
  add_wall(0, LENGTH, -1.0);
  DEF(fluid_boundary, line, .kind = MPS_BOUNDARY_ROLLER, .corners = caisson[0], .corner_count = 5);
  OK(mps_fluid_add_boundary(fluid, &line, &number));
  assert_int_equal(number, CAISSON);
  rock.corners = bedding[0], rock.corner_count = 4;
  rock.porosity = POROSITY, rock.diameter = 0.02;
  OK(mps_fluid_add_rock(fluid, &rock, NULL));
}

static void end(void) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

typedef struct sums {
  double mean[2], spread[2]; /* N, of the force on the caisson */
  double lost, gained;       /* J: dissipated, and by how much that fell below what it had been */
} sums;

/* Means and standard deviations from `from` to `to` s. */
static sums observe(double from, double to) {
  sums s = {.gained = 0.0};
  double square[2] = {0.0, 0.0};
  int64_t count = 0;
  while (mps_fluid_time(fluid) < to) {
    mps_totals t;
    mps_reaction r;
    OK(mps_fluid_step(fluid, EVERY));
    OK(mps_fluid_get_totals(fluid, &t));
    s.lost = fmax(s.lost, t.dissipated);
    s.gained = fmax(s.gained, s.lost - t.dissipated);
    if (mps_fluid_time(fluid) < from) continue;
    OK(mps_fluid_get_reaction(fluid, CAISSON, &r));
    for (int c = 0; c < 2; c++) {
      s.mean[c] -= r.force[c];
      square[c] += r.force[c] * r.force[c];
    }
    count++;
  }
  for (int c = 0; c < 2; c++) {
    s.mean[c] /= (double)count;
    s.spread[c] = sqrt(fmax(square[c] / (double)count - s.mean[c] * s.mean[c], 0.0));
  }
  return s;
}

/* The force upwards by Archimedes, N: water of the tank, the caisson and the rock's stones have the
 * volume below the level. */
static double buoyancy(void) {
  const double count = (double)mps_particles_count(water), stones = (1.0 - POROSITY) * 0.07;
  const double level = (count * L0 * L0 - 0.3 * 0.1 + stones) / (LENGTH - 0.3);
  return 1000.0 * 9.81 * 0.3 * (level - 0.1);
}

/* Where the lattices of water and rock part at the toes on the bed, particles must not count as a
 * free surface: when they did, the force scattered by 22 N, the uplift by 34 N. */
TEST(caisson_feels_no_side_force) {
  const double shift[2] = {0.0, 0.0};
  start(shift, 0.05, 1, BEDDING_RADIUS);
  const sums s = observe(0.5, 2.5);
  const double uplift = buoyancy();
  print_message("caisson on rock: force %.2f +- %.2f N, uplift %.1f +- %.1f N (%.1f N, %+.2f %%), "
                "energy gained "
                "%.1e of %.2f J lost\n",
                s.mean[0], s.spread[0], s.mean[1], s.spread[1], uplift,
                100.0 * (s.mean[1] / uplift - 1.0), s.gained, s.lost);
  assert_true(fabs(s.mean[0]) < 0.01 * uplift && s.spread[0] < 0.006 * uplift);
  NEAR(s.mean[1], uplift, 0.01 * uplift);
  assert_true(s.spread[1] < 0.01 * uplift);
  assert_true(s.gained < 0.02 * s.lost);
  end();
}

/* Lattices shifted against walls and rock leave gaps, and the water sloshes as they close: forces
 * sway by some N and no energy is gained. */
TEST(rest_gains_no_energy) {
  double squares[2] = {0.0, 0.0};
  for (int k = 0; k < SHIFTS; k++) {
    const double shift[2] = {0.1 * k, 0.07 * k};
    start(shift, 0.1, 2 + (uint64_t)k, BEDDING_RADIUS);
    const sums s = observe(0.3, 0.6);
    print_message("shift %.1f, %.2f l0: force %.2f +- %.2f N, uplift %.1f +- %.1f N, energy gained "
                  "%.1e of %.2f J lost\n",
                  shift[0], shift[1], s.mean[0], s.spread[0], s.mean[1], s.spread[1], s.gained,
                  s.lost);
    for (int c = 0; c < 2; c++) squares[c] += s.spread[c] * s.spread[c] / SHIFTS;
    assert_true(s.lost > 0.0 && s.gained < 0.01 * s.lost);
    end();
  }
  assert_true(sqrt(squares[0]) < 10.0 && sqrt(squares[1]) < 25.0);
}

/* Particle by particle water passes below the caisson's corner on the rock. As the particle's own
 * image appeared in the base, its velocity towards or from the base was divergence at once, and the
 * uplift of that step was 14.6 % low in this run (1.2 % with that part of the divergence faded in).
 */
TEST(no_step_falls_out) {
  const double shift[2] = {0.8, 0.56};
  double up[3] = {0.0, 0.0, 0.0}, worst = 0.0;
  start(shift, 0.1, 2010, BEDDING_RADIUS);
  const double uplift = buoyancy();
  while (mps_fluid_time(fluid) < 0.6) {
    mps_reaction r;
    OK(mps_fluid_step(fluid, 1));
    OK(mps_fluid_get_reaction(fluid, CAISSON, &r));
    up[0] = up[1], up[1] = up[2], up[2] = -r.force[1];
    if (mps_fluid_time(fluid) > 0.3)
      worst = fmax(worst, fabs(up[1] - 0.5 * (up[0] + up[2])) / uplift);
  }
  print_message("largest difference of a step's uplift from the mean of the steps beside it: "
                "%.1f %%\n",
                100.0 * worst);
  assert_true(worst > 0.0 && worst < 0.06);
  end();
}
