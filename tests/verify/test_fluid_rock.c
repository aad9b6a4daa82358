/* test_fluid_rock.c - flow through rock: the discharge of a dam between two basins by Dupuit's
 * formula, which is exact for Darcy's law, the force that moves water and rock to and fro, and the
 * break of a dam through crushed rock against measured levels (Liu, Lin, Chang and Sakakiyama 1999,
 * as digitised in the case CR35 of olaFlow). SPDX-License-Identifier: BSD-3-Clause */
#include "test_fixture.h"

static mps_particles *water;
static mps_fluid *fluid;

static void add(double x, double y) {
  const double at[2] = {x, y};
  OK(mps_particles_append(water, 1, at));
}

static void start(double spacing) {
  USING(particles, mps_particles_create(context, &given, &water), .spacing = spacing);
}

/* Bed and the ends at 0 and `length`; rock between two stations. */
static void close_tank(double length, double level, const double *rock, mps_fluid_rock_def *def) {
  const double normal[3][3] = {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}, {-1.0, 0.0, length}};
  const double corner[4][3] = {
      {rock[0], -0.1, 0.0}, {rock[1], -0.1, 0.0}, {rock[1], 1.0, 0.0}, {rock[0], 1.0, 0.0}};
  USING(fluid, mps_fluid_create(context, water, &given, &fluid), .level = level);
  for (int k = 0; k < 3; k++) {
    USING(fluid_boundary, mps_fluid_add_boundary(fluid, &given, NULL), .kind = MPS_BOUNDARY_ROLLER,
          .normal[0] = normal[k][0], .normal[1] = normal[k][1], .point[0] = normal[k][2]);
  }
  def->corners = corner[0], def->corner_count = 4;
  OK(mps_fluid_add_rock(fluid, def, NULL));
}

static void end(void) {
  mps_fluid_destroy(&fluid);
  mps_particles_destroy(&water);
}

static double level_of(double from, double to) {
  enum { STATIONS = 9 };
  double x[STATIONS], level[STATIONS], mean = 0.0;
  for (int k = 0; k < STATIONS; k++) x[k] = from + (to - from) * (k + 0.5) / STATIONS;
  OK(mps_fluid_get_levels(fluid, STATIONS, x, level));
  for (int k = 0; k < STATIONS; k++) mean += level[k] / STATIONS;
  return mean;
}

/* Basins of .3 m, levels .32 and .28 m, a dam of .2 m with K = g/a: the difference of levels falls
 * at the rate K (h1 + h2)/(B L). */
TEST(basins_drain_as_dupuit_says) {
  const double l0 = 0.01, basin = 0.3, dam = 0.2, e = 0.5, at[2] = {basin, basin + dam};
  DEF(fluid_rock, rock, .porosity = e, .diameter = 0.01, .alpha = 4900.0, .beta = 0.0);
  const double a = rock.alpha * (1.0 - e) * (1.0 - e) / (e * e * e) * 1e-6 / 1e-4;
  const double rate = 9.81 / a * 0.6 / (basin * dam);
  start(l0);
  for (double y = 0.5 * l0; y < 0.32; y += l0)
    for (double x = 0.5 * l0; x < basin; x += l0) {
      add(x, y);
      if (y < 0.28) add(basin + dam + x, y);
    }
  for (int j = 0; j < 14; j++) /* at l0/e^.5 */
    for (int k = 0; k < 21; k++) add(basin + (j + 0.5) * dam / 14.0, (k + 0.5) * 0.3 / 21.0);
  close_tank(2.0 * basin + dam, 0.3, at, &rock);
  double t[2], d[2], sum[2];
  for (int n = 0; n < 2; n++) {
    OK(mps_fluid_run(fluid, n ? 1.2 : 0.2, 1000000, NULL, NULL));
    const double left = level_of(0.02, 0.28), right = level_of(0.52, 0.78);
    t[n] = mps_fluid_time(fluid), d[n] = left - right, sum[n] = left + right;
  }
  const double measured = log(d[0] / d[1]) / (t[1] - t[0]);
  printf("difference of levels %.4f, %.4f m, rate %.3f /s, Dupuit %.3f /s (%+.1f %%), mean level "
         "%.4f, %.4f m\n",
         d[0], d[1], measured, rate, 100.0 * (measured / rate - 1.0), 0.5 * sum[0], 0.5 * sum[1]);
  NEAR(measured / rate, 1.0, 0.08);
  for (int n = 0; n < 2; n++) NEAR(0.5 * sum[n], 0.3, 0.002);
  end();
}

/* A full box of water and rock to and fro between two walls that move as one: a displacement of A
 * sin(wt) needs the force rho H (L dU/dt + B ((s/e - 1) dU/dt + a U)), s = 1 + Cm. From two periods
 * the sine and the cosine of the force, hence s and f = a e/w. */
typedef struct tube {
  double s, f; /* over those of the rock */
} tube;

static tube shake_tube(double l0, double way) {
  enum { ACROSS = 10, HIGH = 4 };
  const double e = 4.0 / 9.0, pitch = 1.5 * l0, gap = 10.0 * pitch, width = ACROSS * pitch;
  const double high = HIGH * pitch, length = 2.0 * gap + width, omega = 4.32, f = 3.0, D = 0.02;
  const double mass = 1.0 + 0.34 * (1.0 - e) / e, solid = (1.0 - e) * (1.0 - e) / (e * e * e);
  const double dt = 0.2 * sqrt(l0 / 9.81), period = 2.0 * 3.14159265358979 / omega;
  const double wall[4][4] = {
      {0.0, 1.0, 0.0, 0.0}, {0.0, -1.0, 0.0, high}, {1.0, 0.0, 0.0, 0.0}, {-1.0, 0.0, length, 0.0}};
  const double corner[4][3] = {
      {gap, -1.0, 0.0}, {gap + width, -1.0, 0.0}, {gap + width, 1.0, 0.0}, {gap, 1.0, 0.0}};
  const double A = way * l0;
  int32_t number[4];
  start(l0);
  for (int j = 0; j < 3 * HIGH / 2; j++)
    for (int k = 0; k < 15; k++)
      for (int side = 0; side < 2; side++)
        add((k + 0.5) * l0 + side * (gap + width), (j + 0.5) * l0);
  for (int j = 0; j < HIGH; j++)
    for (int k = 0; k < ACROSS; k++) add(gap + (k + 0.5) * pitch, (j + 0.5) * pitch);
  USING(fluid, mps_fluid_create(context, water, &given, &fluid), .level = high, .dt = dt);
  MAKE(signal, sine, create_sine, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT,
       omega / 6.28318530717959, A, 0.0);
  for (int k = 0; k < 4; k++) {
    USING(fluid_boundary, mps_fluid_add_boundary(fluid, &given, &number[k]),
          .kind = k < 2 ? MPS_BOUNDARY_ROLLER : MPS_BOUNDARY_DRIVEN, .normal[0] = wall[k][0],
          .normal[1] = wall[k][1], .point[0] = wall[k][2], .point[1] = wall[k][3],
          .signal = k < 2 ? NULL : sine, .factor = wall[k][0] < 0.0 ? -1.0 : 1.0);
  }
  USING(fluid_rock, mps_fluid_add_rock(fluid, &given, NULL), .corners = corner[0],
        .corner_count = 4, .porosity = e, .diameter = D, .beta = 0.0,
        .alpha = f * omega / e / (solid * 1e-6 / (D * D)));
  double sum[2] = {0.0, 0.0};
  const int64_t steps = llround(2.0 * period / dt), first = llround(0.5 * period / dt);
  for (int64_t n = 0; n < first + steps; n++) {
    mps_reaction force[2];
    OK(mps_fluid_step(fluid, 1));
    for (int k = 0; k < 2; k++) OK(mps_fluid_get_reaction(fluid, number[2 + k], &force[k]));
    const double t = ((double)n + 0.5) * dt, all = force[0].force[0] + force[1].force[0];
    if (n < first) continue;
    sum[0] += 2.0 * all * sin(omega * t) / (double)steps;
    sum[1] += 2.0 * all * cos(omega * t) / (double)steps;
  }
  end();
  const double unit = 1000.0 * high * A * omega * omega;
  return (tube){.s = (-sum[0] / unit - (length - width)) / width * e / mass,
                .f = sum[1] / unit / width * e / f};
}

TEST(rock_has_its_inertia_and_resistance) {
  const double spacing[3] = {0.04, 0.02, 0.01};
  for (int k = 0; k < 3; k++) {
    const tube got = shake_tube(spacing[k], 1.5);
    printf("spacing %g m: inertia %+.2f %%, resistance %+.2f %%\n", spacing[k],
           100.0 * (got.s - 1.0), 100.0 * (got.f - 1.0));
    NEAR(got.s, 1.0, 0.02);
    NEAR(got.f, 1.0, 0.015);
  }
}

enum { TIMES = 5, POINTS = 12 };
static const double laboratory[TIMES][POINTS][2] = {/* x, level (m); x < 0: none */
                                                    {{0.000, 0.2729},
                                                     {0.077, 0.2709},
                                                     {0.153, 0.2716},
                                                     {0.220, 0.2788},
                                                     {0.287, 0.2921},
                                                     {0.369, 0.2524},
                                                     {0.451, 0.1454},
                                                     {0.535, 0.0773},
                                                     {0.600, 0.0304},
                                                     {0.702, 0.0198},
                                                     {0.783, 0.0211},
                                                     {0.890, 0.0218}},
                                                    {{0.000, 0.2620},
                                                     {0.078, 0.2548},
                                                     {0.158, 0.2424},
                                                     {0.238, 0.2410},
                                                     {0.319, 0.2450},
                                                     {0.398, 0.2280},
                                                     {0.481, 0.1703},
                                                     {0.565, 0.1192},
                                                     {0.649, 0.0177},
                                                     {0.753, 0.0360},
                                                     {0.849, 0.0275},
                                                     {-1.000, 0.0000}},
                                                    {{0.000, 0.2252},
                                                     {0.078, 0.2206},
                                                     {0.154, 0.2265},
                                                     {0.236, 0.2343},
                                                     {0.318, 0.2362},
                                                     {0.398, 0.2187},
                                                     {0.478, 0.1718},
                                                     {0.563, 0.1301},
                                                     {0.634, 0.0306},
                                                     {0.727, 0.0449},
                                                     {0.808, 0.0592},
                                                     {-1.000, 0.0000}},
                                                    {{0.000, 0.2200},
                                                     {0.078, 0.2130},
                                                     {0.156, 0.2172},
                                                     {0.236, 0.2144},
                                                     {0.317, 0.2087},
                                                     {0.425, 0.1974},
                                                     {0.510, 0.1592},
                                                     {0.581, 0.1174},
                                                     {0.650, 0.0587},
                                                     {0.728, 0.0778},
                                                     {0.806, 0.0701},
                                                     {0.890, 0.0764}},
                                                    {{0.000, 0.2073},
                                                     {0.078, 0.2038},
                                                     {0.155, 0.1988},
                                                     {0.237, 0.1981},
                                                     {0.316, 0.2038},
                                                     {0.394, 0.1939},
                                                     {0.505, 0.1571},
                                                     {0.576, 0.1132},
                                                     {0.650, 0.0913},
                                                     {0.726, 0.0842},
                                                     {0.807, 0.0877},
                                                     {0.887, 0.0948}}};

/* A column of .29 x .35 m, water of .025 m before it and in the rock. Root mean square of levels,
 * m. */
static double break_dam(double alpha, double beta) {
  const double l0 = 0.01, gate = 0.29, e = 0.49, length = 0.892, stone[2] = {0.3, 0.59};
  const double time[TIMES] = {0.35, 0.75, 1.15, 1.55, 1.95};
  double square = 0.0;
  int count = 0;
  start(l0);
  for (double y = 0.5 * l0; y < 0.35; y += l0)
    for (double x = 0.5 * l0; x < gate; x += l0) add(x, y);
  for (double y = 0.5 * l0; y < 0.025; y += l0) {
    add(gate + 0.5 * l0, y);
    for (double x = stone[1] + 0.5 * l0; x < length - 0.4 * l0; x += l0) add(x, y);
  }
  for (int n = 0; n < 36; n++) /* e .29 .025/l0^2 */
    add(stone[0] + 0.29 * (n / 2 + 0.5) / 18.0, 0.00625 + 0.0125 * (n % 2));
  DEF(fluid_rock, rock, .porosity = e, .diameter = 0.0159, .alpha = alpha, .beta = beta);
  close_tank(length, 0.35, stone, &rock);
  for (int n = 0; n < TIMES; n++) {
    OK(mps_fluid_run(fluid, time[n], 1000000, NULL, NULL));
    for (int k = 0; k < POINTS; k++) {
      double level;
      if (laboratory[n][k][0] < 0.0) continue;
      OK(mps_fluid_get_levels(fluid, 1, laboratory[n][k], &level));
      if (!isfinite(level)) continue;
      square += (level - laboratory[n][k][1]) * (level - laboratory[n][k][1]), count++;
    }
  }
  assert_true(count > TIMES * POINTS * 9 / 10);
  end();
  return sqrt(square / count);
}

TEST(a_dam_breaks_through_rock_as_measured) {
  const double gent = break_dam(1000.0, 1.1), jensen = break_dam(500.0, 2.0);
  printf("levels within %.1f mm (alpha 1000, beta 1.1), %.1f mm (500, 2), root mean square\n",
         1e3 * gent, 1e3 * jensen);
  assert_true(gent < 0.015);
  assert_true(jensen < 0.015);
}
