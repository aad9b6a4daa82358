/* test_wave_loads.c - Sainflou, Goda with Takahashi's impulsive part, EurOtop (2018) against
 * published numbers, closed forms and integrals of the pressures; refusals outside their ranges.
 * SPDX-License-Identifier: BSD-3-Clause */

#include "waves_theory.h"
#include "test_fixture.h"

/* ---- Sainflou -------------------------------------------------------------------------------- */

TEST(sainflou_is_his_trapezium) {
  DEF(sainflou, def, .height = 0.08, .period = 1.449, .depth = 0.4);
  mps_sainflou r;
  double k;
  OK(mps_sainflou_evaluate(context, &def, &r));
  k = theory_number(def.period, def.depth, 9.81);
  const double rise = PI * 0.08 * 0.08 * k / (2.0 * PI) / tanh(k * 0.4);
  NEAR(r.rise, rise, 1e-15);
  NEAR(r.bed, 9810.0 * 0.08 / cosh(k * 0.4), 1e-10);
  /* the classical form: p1 at the still level, trapezium below, triangle above */
  const double p1 = (r.bed + 9810.0 * 0.4) * (0.08 + rise) / (0.4 + 0.08 + rise);
  const double wave = 0.5 * p1 * (0.08 + rise) + 0.5 * (p1 + r.bed) * 0.4;
  NEAR(r.crest_force - 0.5 * 9810.0 * 0.16, wave, 1e-10);
  NEAR(r.trough_moment, r.trough_force * (0.4 + rise - 0.08) / 3.0, 1e-12);
  def.height = 0.3;
  REFUSES(mps_sainflou_evaluate(context, &def, &r), "breaking");
}

/* ---- Goda ------------------------------------------------------------------------------------ */

static mps_goda_def caisson(double height, double significant, double period, double depth) {
  DEF(goda, def, .height = height, .period = period, .depth = depth,
      .seaward = depth + 5.0 * significant / 100.0, .berm_depth = 4.0, .base = fmin(6.0, depth),
      .crest = 5.0, .width = 10.0, .density = 1025.0);
  return def;
}

TEST(goda_has_published_pressures) {
  /* kPa at the still level, kN/m: test values of Deltares' Coastal Structures Toolbox for Goda
   * (2000) */
  static const double table[][5] = {{5.07, 2.75, 8.0, 5.0, 52.9407},
                                    {3.60, 2.0, 8.0, 5.0, 35.403},
                                    {5.07, 2.75, 12.0, 5.0, 57.6835},
                                    {7.88, 4.35, 8.0, 10.0, 125.089}};
  mps_goda r;
  for (int n = 0; n < 4; n++) {
    const double *row = table[n];
    const mps_goda_def def = caisson(row[0], row[1], row[2], row[3]);
    OK(mps_goda_evaluate(context, &def, &r));
    NEAR(1e-3 * r.p1, row[4], 1e-3 * row[4]); /* their wave lengths are approximate */
  }
  NEAR(1e-3 * r.force, 1177.2, 1e-3 * 1177.2); /* of the last */
}

/* Force and moments are the integrals of the pressures, linear between p4, p1 and p3. */
TEST(forces_are_integrals_of_pressures) {
  mps_goda_def def = caisson(6.0, 3.3, 10.0, 9.0);
  def.angle = 0.4, def.weight = 1.5e6, def.arm = 4.0;
  for (int high = 0; high < 2; high++) {
    mps_goda r;
    def.crest = high ? 12.0 : 3.0; /* above and below eta* */
    OK(mps_goda_evaluate(context, &def, &r));
    const double top = fmin(r.reach, def.crest);
    double force = 0.0, moment = 0.0, uplift = 0.0, about = 0.0;
    enum { N = 200000 };
    for (int n = 0; n < N; n++) {
      const double z = -def.base + (top + def.base) * (n + 0.5) / N;
      const double p =
          z > 0.0 ? r.p1 + (r.p4 - r.p1) * z / top : r.p1 + (r.p1 - r.p3) * z / def.base;
      force += p * (top + def.base) / N;
      moment += p * (z + def.base) * (top + def.base) / N;
      const double x = def.width * (n + 0.5) / N; /* from the heel */
      uplift += r.pu * x / def.width * def.width / N;
      about += r.pu * x / def.width * x * def.width / N;
    }
    NEAR(r.force / force, 1.0, 1e-8);
    NEAR(r.moment / moment, 1.0, 1e-8);
    NEAR(r.uplift / uplift, 1.0, 1e-8);
    NEAR(r.uplift_moment / about, 1.0, 1e-8);
    NEAR(r.sliding, 0.6 * (1.5e6 - uplift) / force, 1e-6);
    NEAR(r.overturning, (1.5e6 * 4.0 - about) / moment, 1e-6);
    if (high) NEAR(r.p4, 0.0, 0.0);
  }
}

/* Takahashi's coefficient has its largest value, 2, at B/L .12, (h - d)/h .6, H/d 2. */
TEST(the_impulsive_coefficient_peaks_at_two) {
  DEF(goda, def, .impulsive = 1, .period = 8.0, .depth = 10.0, .berm_depth = 4.0, .height = 8.0,
      .crest = 5.0, .width = 10.0);
  double k;
  mps_goda r;
  k = theory_number(8.0, 10.0, 9.81);
  def.berm_width = 0.12 * 2.0 * PI / k;
  OK(mps_goda_evaluate(context, &def, &r));
  NEAR(r.impulsive, 2.0, 1e-12);
  NEAR(r.alpha[1], 2.0, 1e-12);
  def.height = 4.0;
  OK(mps_goda_evaluate(context, &def, &r));
  NEAR(r.impulsive, 1.0, 1e-12); /* H/d */
  def.berm_width = 0.0;          /* d11 -.1116, d22 .0432: both branches */
  OK(mps_goda_evaluate(context, &def, &r));
  NEAR(r.impulsive, 1.0 / (cosh(20.0 * 0.1116) * sqrt(cosh(3.0 * 0.0432))), 1e-9);
  def.berm_width = 0.2 * 2.0 * PI / k; /* d11 .0744, d22 -.0288 */
  OK(mps_goda_evaluate(context, &def, &r));
  NEAR(r.impulsive, cos(4.9 * 0.0288) / cosh(15.0 * 0.0744), 1e-9);
}

/* ---- EurOtop --------------------------------------------------------------------------------- */

static mps_eurotop_def slope(double height, double period, double cotangent, double crest) {
  DEF(eurotop, def, .wall = MPS_EUROTOP_WALL_SLOPE, .design = 1, .height = height, .period = period,
      .depth = 10.0, .cotangent = cotangent, .crest = crest);
  return def;
}

TEST(slopes_have_published_discharges) {
  /* l/s per m, design values: test values of Deltares' Coastal Structures Toolbox */
  static const struct {
    double height, period, cotangent, crest, obliquity, roughness, crown, q;
  } table[] = {
      {2.0, 5.0, 3.0, 5.0, 1.0, 1.0, 1.0, 0.8414}, {2.5, 5.0, 3.0, 5.0, 1.0, 1.0, 1.0, 2.546},
      {2.0, 7.0, 3.0, 5.0, 1.0, 1.0, 1.0, 7.097},  {2.0, 5.0, 3.0, 5.0, 0.901, 1.0, 1.0, 0.3253},
      {2.0, 5.0, 3.0, 4.5, 1.0, 1.0, 1.0, 1.946},  {2.0, 5.0, 3.0, 2.0, 1.0, 0.45, 1.0, 2.132},
      {2.0, 5.0, 3.0, 5.0, 1.0, 1.0, 0.8, 0.0929}, {2.0, 5.0, 3.0, 2.0, 0.811, 0.45, 1.0, 0.3672}};
  for (size_t n = 0; n < sizeof table / sizeof *table; n++) {
    mps_eurotop_def def =
        slope(table[n].height, table[n].period, table[n].cotangent, table[n].crest);
    mps_eurotop r;
    def.obliquity = table[n].obliquity, def.roughness = table[n].roughness;
    def.crown = table[n].crown;
    OK(mps_eurotop_evaluate(context, &def, &r));
    NEAR(1e3 * r.discharge, table[n].q, 1e-3);
  }
}

static double plain(double height, double depth, double crest, double period, int32_t foreshore,
                    int32_t *formula) {
  mps_eurotop r;
  USING(eurotop, mps_eurotop_evaluate(context, &given, &r), .height = height, .period = period,
        .depth = depth, .crest = crest, .foreshore = foreshore);
  assert_true(r.low < r.discharge && r.discharge < r.high);
  *formula = r.formula;
  return r.discharge / sqrt(9.81 * height * height * height);
}

TEST(vertical_walls_follow_the_chart) {
  int32_t formula;
  NEAR(plain(1.0, 5.0, 1.0, 5.0, 0, &formula), 0.047 * exp(-pow(2.35, 1.3)), 1e-12);
  assert_int_equal(formula, MPS_EUROTOP_FORMULA_DEEP);
  NEAR(plain(1.0, 5.0, 1.0, 5.0, 1, &formula), 0.05 * exp(-2.78), 1e-12);
  assert_int_equal(formula, MPS_EUROTOP_FORMULA_FORESHORE);
  const double L = 9.81 * 64.0 / (2.0 * PI); /* h^2/(H L) .0225 */
  NEAR(plain(1.0, 1.5, 1.0, 8.0, 0, &formula), 0.011 * sqrt(L / 1.5) * exp(-2.2), 1e-12);
  assert_int_equal(formula, MPS_EUROTOP_FORMULA_IMPULSIVE_LOW);
  NEAR(plain(1.0, 1.5, 2.0, 8.0, 0, &formula), 0.0014 * sqrt(L / 1.5) / 8.0, 1e-12);
  assert_int_equal(formula, MPS_EUROTOP_FORMULA_IMPULSIVE_HIGH);
}

/* EurOtop (2018): the limit begins at xi of some 1.8; 1.65 +- .10 and 1.00 +- .07 are its
 * coefficients; design values are one standard deviation higher. */
TEST(run_up_follows_the_chart) {
  static const double xi[4] = {1.0, 1.7, 1.9, 3.0};
  DEF(eurotop, def, .wall = MPS_EUROTOP_WALL_SLOPE, .height = 2.0, .depth = 8.0, .cotangent = 4.0);
  mps_eurotop_run_up r, design;
  for (int n = 0; n < 4; n++) {
    const double limit = 4.0 - 1.5 / sqrt(xi[n]), line = 1.65 * xi[n];
    def.period = sqrt(2.0 * PI * 2.0 / 9.81) * 4.0 * xi[n], def.design = 0;
    OK(mps_eurotop_find_run_up(context, &def, &r));
    NEAR(r.breaker, xi[n], 1e-12);
    assert_int_equal(r.breaking, xi[n] < 1.8);
    NEAR(r.height, 2.0 * fmin(line, limit), 1e-12);
    NEAR(r.low, 2.0 * fmin(1.55 * xi[n], 0.93 * limit), 1e-12);
    NEAR(r.high, 2.0 * fmin(1.75 * xi[n], 1.07 * limit), 1e-12);
    def.design = 1;
    OK(mps_eurotop_find_run_up(context, &def, &design));
    NEAR(design.height, r.high, 1e-12);
  }
  def.roughness = 0.6, def.obliquity = 0.9, def.design = 0;
  OK(mps_eurotop_find_run_up(context, &def, &design));
  NEAR(design.height, 0.54 * r.height, 1e-12);
#define REFUSED(change, word)                                                                      \
  do {                                                                                             \
    mps_eurotop_def d = def;                                                                       \
    change;                                                                                        \
    REFUSES(mps_eurotop_find_run_up(context, &d, &r), word);                                       \
  } while (0)
  REFUSED(d.wall = MPS_EUROTOP_WALL_VERTICAL, "wall");
  REFUSED(d.height = 0.0, "height");
  REFUSED(d.cotangent = 1.0, "cotangent");
  REFUSED(d.berm = NAN, "berm");
  REFUSED(d.period = 40.0, "breaker");
#undef REFUSED
}

/* ---- overtopping by low heads ---------------------------------------------------------------- */

enum { RECORD = 400 };

typedef struct level_record {
  double t[RECORD], head[RECORD], volume[RECORD];
} level_record;

/* Half sine waves of the heads given, of .5 s each, from 1, 3 and 5 s on; `passed` (m2) in the
 * middle of each. */
static mps_overtopping_def record_of(level_record *r, const double *heads, const double *passed) {
  for (int k = 0; k < RECORD; k++) {
    const double t = r->t[k] = 0.02 * k;
    r->head[k] = -0.05, r->volume[k] = k ? r->volume[k - 1] : 0.0;
    for (int n = 0; n < 3; n++) {
      const double since = t - 1.0 - 2.0 * n;
      if (since > 1e-9 && since < 0.5 - 1e-9) r->head[k] = heads[n] * sin(2.0 * PI * since);
      if (fabs(since - 0.26) < 1e-9) r->volume[k] += passed[n];
    }
  }
  DEF(overtopping, def, .samples = RECORD, .times = r->t, .heads = r->head, .volumes = r->volume,
      .resolved = 0.025);
  return def;
}

/* The integral over a half sine of 1/2 s: (2/3)^1.5 g^.5 h^1.5 B(5/4, 1/2)/(2 pi), B the complete
 * beta function, 1.7480384. */
static double half_sine(double head) {
  return pow(2.0 / 3.0, 1.5) * sqrt(9.81) * pow(head, 1.5) * 1.7480384 / (2.0 * PI);
}

TEST(low_heads_pass_by_the_law_of_the_weir) {
  static level_record r;
  static double thin[RECORD];
  mps_overtopping out;
  const double some[3] = {0.02, 0.03, 0.01}, passed[3] = {0.0, 2e-3, 0.0};
  mps_overtopping_def def = record_of(&r, some, passed);
  OK(mps_overtopping_find(context, &def, RECORD, thin, &out));
  assert_int_equal(out.events, 3);
  assert_int_equal(out.thin_events, 2); /* the second one is resolved */
  NEAR(out.highest, 0.03, 1e-4);
  NEAR(out.counted, 2e-3, 1e-15);
  NEAR(out.thin, half_sine(0.02) + half_sine(0.01), 2e-3 * out.thin);
  NEAR(thin[49], 0.0, 0.0); /* before the first */
  NEAR(thin[200], half_sine(0.02), 2e-3 * out.thin);
  NEAR(thin[RECORD - 1], out.thin, 0.0);
  for (int k = 1; k < RECORD; k++) assert_true(thin[k] >= thin[k - 1]);
  thin[0] = 7.0; /* without a capacity nothing is written */
  OK(mps_overtopping_find(context, &def, 0, thin, &out));
  NEAR(thin[0], 7.0, 0.0);
  def.pause = 1.6; /* all are one event, of which nothing is thin */
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  assert_int_equal(out.events, 1);
  assert_int_equal(out.thin_events, 0);
  NEAR(out.thin, 0.0, 0.0);
}

/* What is counted in a thin event is no second time in its flow; what stays on the crest is none.
 */
TEST(nothing_passes_twice) {
  static level_record r;
  mps_overtopping out;
  const double some[3] = {0.02, 0.01, 0.01};
  const double passed[3] = {0.4 * half_sine(0.02), 0.0, 2.0 * half_sine(0.01)};
  mps_overtopping_def def = record_of(&r, some, passed);
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  NEAR(out.thin, 0.6 * half_sine(0.02) + half_sine(0.01), 2e-3 * out.thin);
  NEAR(out.counted, passed[0] + passed[2], 1e-15);
  def.volumes = NULL;
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  NEAR(out.counted, 0.0, 0.0);
  NEAR(out.thin, half_sine(0.02) + 2.0 * half_sine(0.01), 2e-3 * out.thin);
  for (int k = 0; k < RECORD; k++) r.head[k] = k < 20 ? 0.03 : 0.01; /* a film after an event */
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  assert_int_equal(out.events, 1);
  NEAR(out.thin, 0.0, 0.0);
  for (int k = 0; k < RECORD; k++) r.head[k] = NAN; /* no surface */
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  assert_int_equal(out.events, 0);
}

/* The flow lowers the level by q/(g d)^1/2, of a steady head exactly. */
TEST(a_flow_lowers_the_level) {
  const double t[2] = {0.0, 10.0}, head[2] = {0.02, 0.02};
  DEF(overtopping, def, .samples = 2, .times = t, .heads = head, .resolved = 0.025, .depth = 0.2);
  mps_overtopping out;
  OK(mps_overtopping_find(context, &def, 0, NULL, &out));
  const double q = 0.1 * out.thin, h = 0.02 - q / sqrt(9.81 * 0.2);
  NEAR(q, pow(2.0 / 3.0, 1.5) * sqrt(9.81) * pow(h, 1.5), 1e-12);
  assert_true(h < 0.018);
}

TEST(walls_beyond_the_tests_are_refused) {
  mps_eurotop r;
  mps_eurotop_def def = slope(1.0, 12.0, 2.0, 1.0);
  REFUSES(mps_eurotop_evaluate(context, &def, &r), "breaker");
  def = slope(1.0, 5.0, 3.0, 4.0);
  REFUSES(mps_eurotop_evaluate(context, &def, &r), "crest");
}
