/* test_mpm_liquefaction.c - level saturated ground of cyclic sand between free-field sides, shaken
 * from below: contraction and excess pressures by depth against the sum over half cycles of the
 * shear strain of an elastic column, settlement against the water that has left and the
 * contraction; the same ground dry. SPDX-License-Identifier: BSD-3-Clause */
#include "mpm_free_field.h"
#include "test_fixture.h"

#define HEIGHT 3.0
#define SPACING 0.125
#define WIDTH 1.0 /* four cells, the least between free-field sides */
#define VS 100.0
#define GRAVITY 9.81
#define WATER 1000.0 /* kg/m3 */
#define DENSITY 0.5  /* relative */
#define FREQUENCY 2.0
#define THRESHOLD 1e-4
#define C1 (7600.0 * pow(100.0 * DENSITY, -2.5))

enum { ROWS = 24, ONE = 15, TWO = 7 }; /* at depths of 1.06 and 2.06 m */

typedef struct shaken {
  mpm_scene s;
  mps_signal *motion;
  double volume; /* m3, at the start */
} shaken;

/* Velocity amplitude of the base at its full acceleration (m/s2). */
static double velocity_of(double acceleration) { return acceleration / (2.0 * PI * FREQUENCY); }

typedef struct ground {
  double acceleration, end; /* m/s2, s: of the shaking */
  double permeability;      /* m/s; 0: undrained; NaN: dry */
  double spacing;           /* m, four cells wide */
  double stiffness;         /* K_w/n over K + 4G/3 */
  int32_t volumetric;
} ground;

static shaken begin_with(const ground *of) {
  const bool dry = isnan(of->permeability);
  const double width = 8.0 * of->spacing;
  shaken x = {.s = mpm_scene_begin(context, of->spacing, 0.0, 0.0, field_young(VS))};
  DEF(material_cyclic_sand, law, .young = field_young(VS), .poisson = FIELD_NU, .friction = 0.61,
      .relative_density = DENSITY);
  MAKE(material, sand, create_cyclic_sand, context, &law);
  mpm_scene_box(&x.s, 0.0, 0.0, width, HEIGHT);
  OK(mps_particles_set(x.s.particles, "density", 0, FIELD_RHO));
  mpm_scene_weigh(&x.s, (dry ? FIELD_RHO : FIELD_RHO - WATER) * GRAVITY, FIELD_K0, HEIGHT);
  USING(mpm, mps_mpm_create(context, x.s.particles, sand, &given, &x.s.mpm),
        .cell = 2.0 * of->spacing, .lower[0] = 0.0, .upper[0] = width, .lower[1] = 0.0,
        .gravity[1] = -GRAVITY, .volumetric = of->volumetric);
  x.motion = field_shaking(context, FREQUENCY, velocity_of(of->acceleration), of->end);
  DEF(mpm_boundary, base, .kind = MPS_BOUNDARY_DRIVEN, .signal[0] = x.motion);
  OK(mps_mpm_set_boundary(x.s.mpm, MPS_SIDE_Y_LOWER, &base));
  mpm_scene_side(&x.s, MPS_SIDE_X_LOWER, MPS_BOUNDARY_FREE_FIELD, 0.0);
  if (!dry) {
    const double level[2] = {0.0, HEIGHT};
    DEF(pore_water, water, .porosity = 0.4);
    if (of->permeability > 0.0) water.permeability = of->permeability;
    water.bulk = 0.4 * of->stiffness * 3.5 * FIELD_RHO * VS * VS;
    OK(mps_mpm_add_pore_water(x.s.mpm, &water));
    OK(mps_mpm_set_pore_level(x.s.mpm, level));
  }
  mpm_scene_side(&x.s, MPS_SIDE_X_UPPER, MPS_BOUNDARY_FREE_FIELD, 0.0);
  x.volume = mpm_scene_totals(&x.s).volume;
  return x;
}

static shaken begin(double acceleration, double permeability, double end) {
  const ground of = {.acceleration = acceleration,
                     .end = end,
                     .permeability = permeability,
                     .spacing = SPACING,
                     .stiffness = 20.0};
  return begin_with(&of);
}

static void finish(shaken *x) {
  mps_signal_destroy(&x->motion);
  mpm_scene_end(&x->s);
}

/* Means over the rows of particles, from below; their ids begin with rows in x. */
static void rows_of(shaken *x, const char *field, int c, double *mean, double *spread) {
  const mps_view v = mpm_scene_view(&x->s, field), ids = mpm_scene_view(&x->s, "id");
  const int across = (int)(WIDTH / SPACING);
  double low[ROWS], high[ROWS];
  for (int r = 0; r < ROWS; r++) mean[r] = 0.0, low[r] = INFINITY, high[r] = -INFINITY;
  for (int64_t k = 0; k < v.shape[0]; k++) {
    const int r = (int)(*mps_view_i64(&ids, k, 0) / across);
    const double value = *mps_view_f64(&v, k, c);
    mean[r] += value / across;
    low[r] = fmin(low[r], value), high[r] = fmax(high[r], value);
  }
  *spread = 0.0;
  for (int r = 0; r < ROWS; r++) *spread = fmax(*spread, high[r] - low[r]);
}

static double depth_of(int row) { return HEIGHT - (row + 0.5) * SPACING; }

/* Excess pressure of a row over the first vertical effective stress. */
static double excess_ratio(const double *u, int row) {
  return (u[row] / (GRAVITY * depth_of(row)) - WATER) / (FIELD_RHO - WATER);
}

/* ---- an elastic column ----------------------------------------------------------------------- */

enum { CELLS = 2 * ROWS };

/* Half cycles of a strain: from the last reversal `from` to the farthest since, `far`. */
typedef struct counter {
  double from, far, sum;
} counter;

static double byrne(double range, double before) {
  const double g = 0.5 * range, counts = fmin(1.0, fmax(0.0, g / THRESHOLD - 1.0));
  return counts > 0.0 ? counts * 0.5 * C1 * g * exp(-0.4 / C1 * before / g) : 0.0;
}

static void count(counter *c, double strain) {
  const double range = fabs(c->far - c->from);
  if (fabs(strain - c->from) >= range) {
    c->far = strain;
  } else if (fabs(strain - c->far) > fmax(0.1 * range, 2.0 * THRESHOLD)) {
    c->sum += byrne(range, c->sum);
    c->from = c->far, c->far = strain;
  }
}

/* The contraction of each row of particles up to `end` by the strains of a linear elastic column of
 * shear that the base drives, in one dimension by differences of second order. */
static void elastic_column(const shaken *x, double end, double *contraction) {
  const double h = HEIGHT / CELLS, dt = 0.4 * h / VS, share = VS * VS * dt / h;
  double u[CELLS + 1] = {0.0}, v[CELLS + 1] = {0.0}, g[CELLS] = {0.0};
  counter rows[CELLS] = {{0.0, 0.0, 0.0}};
  for (double t = 0.0; t < end; t += dt) {
    for (int n = 1; n <= CELLS; n++) {
      const double pull = n < CELLS ? g[n] - g[n - 1] : -2.0 * g[n - 1];
      v[n] += share * pull;
      u[n] += dt * v[n];
    }
    u[0] += dt * mps_signal_velocity(x->motion, t + 0.5 * dt);
    for (int n = 0; n < CELLS; n++) g[n] = (u[n + 1] - u[n]) / h, count(&rows[n], g[n]);
  }
  for (int r = 0; r < ROWS; r++) { /* a row is in the middle of two cells */
    double sum = 0.0;
    for (int n = 2 * r; n < 2 * r + 2; n++)
      sum += rows[n].sum + byrne(fabs(rows[n].far - rows[n].from), rows[n].sum);
    contraction[r] = 0.5 * sum;
  }
}

/* ---- undrained ------------------------------------------------------------------------------- */

TEST(pressures_rise_by_depth) {
  const double end = 2.0, rebound = 3.5 * FIELD_RHO * VS * VS;
  SCOPED(finish) shaken x = begin(0.75, 0.0, end);
  OK(mps_mpm_run(x.s.mpm, end, 10000000, NULL, NULL));
  double u[ROWS], vertical[ROWS], contraction[ROWS], spread, apart, ignored;
  rows_of(&x, "pore_pressure", 0, u, &spread);
  rows_of(&x, "stress", 1, vertical, &apart);
  rows_of(&x, "cyclic_sand.contraction", 0, contraction, &ignored);
  double elastic[ROWS];
  elastic_column(&x, end, elastic);
  print_message("depth (m)  ru     M e/u'  e/elastic  (sigma' + u)/total\n");
  for (int r = 1; r < ROWS; r += 2) {
    const double z = depth_of(r), first = (FIELD_RHO - WATER) * GRAVITY * z;
    const double excess = u[r] - WATER * GRAVITY * z;
    print_message("%9.3f  %5.3f  %6.3f  %9.3f  %10.4f\n", z, excess / first,
                  rebound * contraction[r] / excess, contraction[r] / elastic[r],
                  (u[r] - vertical[r]) / (FIELD_RHO * GRAVITY * z));
  }
  print_message("spread over x: u %.3g Pa, vertical stress %.3g Pa\n", spread, apart);
  int risen = 0;
  double both = 0.0;
  for (int r = 0; r < ROWS - 1; r++) {
    const double z = depth_of(r), first = (FIELD_RHO - WATER) * GRAVITY * z;
    const double excess = u[r] - WATER * GRAVITY * z;
    NEAR((u[r] - vertical[r]) / (FIELD_RHO * GRAVITY * z), 1.0, 0.015);
    if (excess < 0.1 * first) continue;
    /* pressures are means over cells, contraction is not */
    NEAR(rebound * contraction[r] / excess, 1.0, 0.15);
    /* the stress that contraction takes makes the strains larger than those of an elastic column */
    NEAR(contraction[r] / elastic[r], 1.15, 0.15);
    both += rebound * contraction[r] / excess;
    risen++;
  }
  print_message("M times contraction over excess pressure, mean of %d rows: %.4f\n", risen,
                both / risen);
  assert_in_range(risen, ROWS / 3, ROWS);
  assert_true(spread < 0.02 * (FIELD_RHO - WATER) * GRAVITY * HEIGHT);
  assert_true(apart < 0.02 * (FIELD_RHO - WATER) * GRAVITY * HEIGHT);
}

/* ---- liquefied ----------------------------------------------------------------------------------
 * Grains without contact leave a gap, which only water can fill: undrained sand that has liquefied
 * keeps its height. When the water did not feel that the gaps opened, the surface rose by some 2 mm
 * a second for as long as the run lasted, 19 mm in ten seconds. */

static double mean_height(mpm_scene *s) {
  const mps_view x = mpm_scene_view(s, "position");
  double sum = 0.0;
  for (int64_t k = 0; k < x.shape[0]; k++) sum += *mps_view_f64(&x, k, 1) / (double)x.shape[0];
  return sum;
}

TEST(liquefied_sand_keeps_its_height) {
  static const double spacing[] = {0.5, 0.25, 0.1875}, stiffness[] = {5.0, 20.0, 80.0};
  for (int q = 0; q < 9; q++) {
    const ground of = {.acceleration = 1.0,
                       .end = 4.0,
                       .spacing = spacing[q / 3],
                       .stiffness = stiffness[q % 3],
                       .volumetric = MPS_MPM_VOLUMETRIC_CELL};
    SCOPED(finish) shaken x = begin_with(&of);
    const double first = mean_height(&x.s);
    double low = 0.0, high = 0.0;
    for (int k = 1; k <= 60; k++) {
      OK(mps_mpm_run(x.s.mpm, 0.1 * k, 10000000, NULL, NULL));
      const double risen = 2.0 * (mean_height(&x.s) - first);
      low = fmin(low, risen), high = fmax(high, risen);
    }
    print_message("h = %g m, K_w/n = %g (K + 4G/3): surface by its mean strain %.2f to %.2f mm\n",
                  2.0 * of.spacing, of.stiffness, 1e3 * low, 1e3 * high);
    assert_true(high < 1e-3 && low > -5e-3);
  }
}

/* ---- with flow ------------------------------------------------------------------------------- */

/* m3: of grains and water, which fills the gaps between grains too. */
static double volume_with_gaps(mpm_scene *s) {
  const mps_view V = mpm_scene_view(s, "volume"), gap = mpm_scene_view(s, "opening");
  double sum = 0.0;
  for (int64_t k = 0; k < V.shape[0]; k++)
    sum += *mps_view_f64(&V, k, 0) * (1.0 + *mps_view_f64(&gap, k, 0));
  return sum;
}

TEST(ground_settles_by_the_water_that_leaves) {
  const double end = 3.0, rest = 4.0;
  SCOPED(finish) shaken x = begin(1.0, 4e-4, end);
  double most = 0.0, base = 0.0, settled = 0.0, water = 0.0;
  for (double t = 1.0; t <= end + rest; t += 1.0) {
    OK(mps_mpm_run(x.s.mpm, t, 10000000, NULL, NULL));
    double u[ROWS], spread;
    mps_pore_budget budget;
    rows_of(&x, "pore_pressure", 0, u, &spread);
    OK(mps_mpm_get_pore_budget(x.s.mpm, &budget));
    settled = (x.volume - volume_with_gaps(&x.s)) / WIDTH;
    water = budget.drained / WATER / WIDTH;
    base = excess_ratio(u, 0), most = fmax(most, excess_ratio(u, TWO));
    print_message("%4.1f s: ru %.3f at 1 m, %.3f at 2 m, %.3f at the base; settlement %.3f mm, "
                  "water %.3f mm\n",
                  t, excess_ratio(u, ONE), excess_ratio(u, TWO), base, 1e3 * settled, 1e3 * water);
  }
  double contraction[ROWS], ignored, sum = 0.0;
  rows_of(&x, "cyclic_sand.contraction", 0, contraction, &ignored);
  for (int r = 0; r < ROWS; r++) sum += contraction[r] * SPACING;
  print_message("contraction %.3f mm\n", 1e3 * sum);
  print_message("settlement over water %.4f, over contraction %.4f\n", settled / water,
                settled / sum);
  assert_true(most > 0.8 && most < 1.1 && base < 0.15);
  NEAR(settled / water, 1.0, 0.01);
  NEAR(settled / sum, 1.0, 0.06); /* some pressure is left */
}

/* ---- a run that is cut ----------------------------------------------------------------------- */

/* With water, free-field sides and half cycles under way a rollback continues bit for bit. */
TEST(continues_from_a_snapshot) {
  static const char *const fields[] = {"stress", "pore_pressure", "cyclic_sand.contraction",
                                       "cyclic_sand.far_xy", "mass"};
  enum { FIELDS = sizeof fields / sizeof *fields };
  SCOPED(finish) shaken x = begin(1.6, 4e-4, 3.0);
  scoped_snapshot *kept = NULL;
  double once[FIELDS][ROWS], again[FIELDS][ROWS], spread;
  OK(mps_mpm_run(x.s.mpm, 0.6, 10000000, NULL, NULL));
  OK(mps_mpm_snapshot(x.s.mpm, &kept));
  OK(mps_mpm_step(x.s.mpm, 2000));
  for (int f = 0; f < FIELDS; f++) rows_of(&x, fields[f], 0, once[f], &spread);
  OK(mps_mpm_rollback(x.s.mpm, kept));
  OK(mps_mpm_step(x.s.mpm, 2000));
  for (int f = 0; f < FIELDS; f++) rows_of(&x, fields[f], 0, again[f], &spread);
  assert_memory_equal(once, again, sizeof once);
  assert_true(once[2][1] > 0.0);
}

/* ---- dry ------------------------------------------------------------------------------------- */

TEST(dry_ground_settles_at_once) {
  const double end = 3.0;
  SCOPED(finish) shaken x = begin(1.6, NAN, end);
  OK(mps_mpm_run(x.s.mpm, end + 1.0, 10000000, NULL, NULL));
  double contraction[ROWS], ignored, sum = 0.0, reference = 0.0;
  rows_of(&x, "cyclic_sand.contraction", 0, contraction, &ignored);
  for (int r = 0; r < ROWS; r++) sum += contraction[r] * SPACING;
  double elastic[ROWS];
  elastic_column(&x, end + 1.0, elastic);
  for (int r = 0; r < ROWS; r++) reference += SPACING * elastic[r];
  const double settled = (x.volume - mpm_scene_totals(&x.s).volume) / WIDTH;
  print_message("dry: settlement %.4f mm, contraction %.4f mm, of an elastic column %.4f mm\n",
                1e3 * settled, 1e3 * sum, 1e3 * reference);
  print_message("dry: settlement over contraction %.4f, contraction over that of an elastic column "
                "%.4f\n",
                settled / sum, sum / reference);
  NEAR(settled / sum, 1.0, 0.08);
  NEAR(sum / reference, 1.0, 0.08);
}
