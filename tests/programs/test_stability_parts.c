/* test_stability_parts.c - the parts of mps-stability: the regression of Yoshida (14)-(16) and the
 * bisection over runs, against the paper's figures.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_fixture.h"

#include "stability/bisection.h"
#include "stability/regression.h"

#define MOST 256

/* Yoshida, Table 2. */
static const double table_s[2][3] = {{0.264375, 1.621563, 2.540176}, {0.04089, 0.262491, 0.438239}};
static const double table_p[2][3] = {{0.304301, 1.666102, 2.614558},
                                     {0.046261, 0.263985, 0.392512}};

/* (14)-(16) written out, s. */
static double printed(const double b[2][3], double R, double V, double h) {
  const double x = log10(h);
  const double a1 = pow(10.0, b[0][0] * x * x + b[0][1] * x + b[0][2]);
  const double a2 = pow(10.0, b[1][0] * x * x + b[1][1] * x + b[1][2]);
  return a1 * pow(R / V, a2);
}

typedef struct case_list {
  int64_t count;
  double R[MOST], V[MOST], h[MOST], dt[MOST];
} case_list;

static case_list from_table(const double b[2][3], int dampings) {
  const double R[3] = {0.25, 0.5, 1.6}, V[4] = {100.0, 200.0, 400.0, 800.0};
  const double h[6] = {0.22, 0.001, 0.05, 0.005, 0.1, 0.01}; /* in any order */
  case_list c = {0};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++)
      for (int k = 0; k < dampings; k++, c.count++) {
        c.R[c.count] = R[i];
        c.V[c.count] = V[j];
        c.h[c.count] = h[k];
        c.dt[c.count] = printed(b, R[i], V[j], h[k]);
      }
  return c;
}

static char why[160];

static bool fit(const case_list *c, double h_max, limit_fit *out) {
  return limit_fit_make(c->count, c->R, c->V, c->h, c->dt, h_max, out, why);
}

static void refused(const case_list *c, double h_max, limit_fit *out, const char *text) {
  assert_false(fit(c, h_max, out));
  if (!strstr(why, text)) fail_msg("expected '%s' in '%s'", text, why);
}

TEST(the_printed_table_is_recovered_from_its_own_limits) {
  for (int wave = 0; wave < 2; wave++) {
    const double(*b)[3] = wave ? table_p : table_s;
    case_list c = from_table(b, 6);
    limit_fit out, table;
    assert_true(fit(&c, 0.22, &out));
    table = limit_fit_printed(wave ? 'P' : 'S');
    assert_int_equal(out.dampings, 6);
    for (int k = 0; k < 3; k++) {
      NEAR(out.b1[k], b[0][k], 1e-9);
      NEAR(out.b2[k], b[1][k], 1e-9);
      NEAR(table.b1[k], b[0][k], 0.0);
      NEAR(table.b2[k], b[1][k], 0.0);
    }
    assert_true(out.rms < 1e-9);
    for (int k = 0; k < 5; k++) assert_true(out.h[k] < out.h[k + 1]); /* ascending */
    for (int64_t k = 0; k < c.count; k++)
      NEAR(limit_fit_dt(&out, c.R[k], c.V[k], c.h[k]) / c.dt[k], 1.0, 1e-9);
    /* (14) for each h */
    const double x = log10(out.h[2]);
    NEAR(log10(out.a1[2]), b[0][0] * x * x + b[0][1] * x + b[0][2], 1e-9);
    NEAR(log10(out.a2[2]), b[1][0] * x * x + b[1][1] * x + b[1][2], 1e-9);
    /* what is above h_max is not looked at, and rms is that of a known scatter */
    for (int64_t k = 0; k < c.count; k++)
      if (c.h[k] == 0.22) c.dt[k] *= 3.0 + c.R[k];
    assert_true(fit(&c, 0.1, &out));
    assert_true(out.rms < 1e-9);
    NEAR(out.b2[1], b[1][1], 1e-9);
    assert_int_equal(out.dampings, 6);
    for (int64_t k = 0; k < c.count; k += 2) /* both of each pair: 0.99 and 1.01 of the mean */
      c.dt[k] *= 1.0001, c.dt[k + 1] *= 0.9999;
    assert_true(fit(&c, 0.1, &out));
    assert_true(out.rms > 1e-6 && out.rms < 1.1e-4);
  }
}

TEST(too_few_cases_are_refused) {
  limit_fit out = {.rms = -7.0};
  for (int dampings = 1; dampings < 3; dampings++) {
    const case_list c = from_table(table_s, dampings);
    char text[64];
    snprintf(text, sizeof text, "%d damping ratios are at most", dampings);
    refused(&c, 0.3, &out, text);
  }
  case_list c = from_table(table_s, 6);
  refused(&c, 0.005, &out, "2 damping ratios");
  c.count = 6; /* one R/V */
  refused(&c, 0.22, &out, "h = 0.001 has 1 cases: at least 2 distinct R/V");
  c = from_table(table_s, 6);
  for (int64_t k = 0; k < c.count; k++) c.R[k] = 0.01 * c.V[k]; /* many, but one R/V */
  refused(&c, 0.22, &out, "2 distinct R/V");
  c = from_table(table_s, 6);
  for (int64_t k = 0; k < c.count; k++) c.dt[k] = c.V[k] / c.R[k];
  refused(&c, 0.22, &out, "a2 for h = 0.001 is -1, must be > 0");
  NEAR(out.rms, -7.0, 0.0);
}

TEST(bad_cases_are_refused) {
  case_list c = from_table(table_s, 6);
  limit_fit out = {.rms = -7.0};
  double *columns[4] = {c.R, c.V, c.h, c.dt};
  const char *const names[4] = {"R[5] is", "V[5] is", "h[5] is", "dt[5] is"};
  const double bad[4] = {0.0, -1.0, NAN, INFINITY};
  for (int k = 0; k < 16; k++) {
    const double former = columns[k / 4][5];
    columns[k / 4][5] = bad[k % 4];
    refused(&c, 0.22, &out, names[k / 4]);
    columns[k / 4][5] = former;
  }
  for (int64_t k = 0; k < c.count; k++) c.h[k] = 0.001 * (double)(k + 1);
  refused(&c, 0.22, &out, "more than 32");
  NEAR(out.rms, -7.0, 0.0);
}

/* The printed regression may be far above the limit by linear theory. */
TEST(the_printed_table_is_no_safe_step) {
  const double h[] = {0.048, 0.1, 0.22};
  const limit_fit table = limit_fit_printed('S');
  double worst = 0.0;
  for (int k = 0; k < 3; k++) {
    DEF(dynamics_predict, def, .spacing = 3.2, .shear_velocity = 100.0, .pressure_velocity = 200.0,
        .damping = h[k]);
    mps_dynamics_prediction p;
    OK(mps_dynamics_predict(context, &def, &p));
    worst = fmax(worst, limit_fit_dt(&table, 1.6, 100.0, h[k]) / p.dt);
  }
  print_message("printed for S waves / linear: up to %.3f at R = 1.6 m\n", worst);
  assert_true(worst > 1.3 && worst < 1.6);
}

static double linear(mps_dynamics *dynamics) {
  mps_dynamics_linear_limit limit;
  OK(mps_dynamics_find_limit(dynamics, 0.0, &limit));
  return limit.dt;
}

static mps_dynamics *lone(mps_particles *set) {
  mps_dynamics *dynamics = NULL;
  DEF(dynamics, def, .dt = 1e-3);
  OK(mps_dynamics_create(context, set, &def, &dynamics));
  return dynamics;
}

/* ---- Yoshida's column ------------------------------------------------------------------------ */

/* The paper's column with the limits of the reference values; stepping with accuracy 1.02. */
TEST(the_papers_column) {
  const struct {
    char wave;
    double h, linear, stepping; /* ms */
  } cases[] = {{'S', 0.0, 4.1047, 0.0},   {'S', 0.001, 4.084, 4.120}, {'S', 0.048, 3.209, 3.346},
               {'S', 0.22, 1.546, 2.093}, {'P', 0.001, 8.184, 8.256}, {'P', 0.048, 7.242, 7.305},
               {'P', 0.22, 4.750, 5.290}};
  mps_dynamics_def paper = mps_dynamics_defaults();
  paper.divergence = 1e15; /* that criterion alone */
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    scoped_particles *set = NULL;
    const bool P = cases[k].wave == 'P';
    scoped_dynamics *d = paper_column(context, 0.5, P ? 50.0 : 100.0, P ? 100.0 : 200.0, cases[k].h,
                                      cases[k].wave, &paper, &set);
    NEAR(1e3 * linear(d) / cases[k].linear, 1.0, 1e-3);
    if (cases[k].stepping > 0.0) {
      bisection_def def = bisection_defaults();
      bisection found;
      def.accuracy = 1.02;
      def.lower = 0.98e-3 * cases[k].stepping;
      def.upper = 1.03e-3 * cases[k].stepping;
      OK(bisection_find(d, &def, &found, why));
      assert_true(found.unstable <= 1.02 * found.stable);
      print_message("%c wave, h = %g: %.4g ms, reference %.4g ms\n", cases[k].wave, cases[k].h,
                    1e3 * found.stable, cases[k].stepping);
      /* where the spin saturates, which dt passes the criterion is a matter of chance */
      NEAR(1e3 * found.stable / cases[k].stepping, 1.0, 0.03);
    }
  }
}

TEST(the_papers_undamped_limits) {
  for (int integrator = 0; integrator < 2; integrator++) {
    scoped_particles *set = NULL;
    DEF(dynamics, dynamics_def, .integrator = integrator);
    bisection_def def = bisection_defaults();
    bisection found;
    scoped_dynamics *d = paper_column(context, 0.5, 100.0, 200.0, 0.0, 'S', &dynamics_def, &set);
    def.lower = 4.10e-3;
    def.upper = 4.11e-3;
    OK(bisection_find(d, &def, &found, why));
    NEAR(found.stable, def.lower, 0.0);
    NEAR(found.unstable, def.upper, 0.0);
    assert_int_equal(found.runs, 2);
    assert_true(found.steps > 2.5 / def.lower && found.steps <= 5.0 / def.lower + 2.0);
  }
}

TEST(bisection_finds_its_own_bounds_and_leaves_the_state) {
  scoped_particles *set = NULL;
  DEF(dynamics, dynamics_def, .dt = 7e-3);
  scoped_dynamics *d = paper_column(context, 1.6, 100.0, 200.0, 0.0, 'S', &dynamics_def, &set);
  OK(mps_particles_set(set, "rotation", 0, 1e-6));
  OK(mps_dynamics_restart(d, 0.1));
  bisection_def def = bisection_defaults();
  bisection found[4];
  const double bounds[4][2] = {{NAN, NAN}, {1e-3, NAN}, {NAN, 0.1}, {5e-2, 6e-2}};
  const double limit = linear(d);
  def.accuracy = 1.01;
  for (int k = 0; k < 4; k++) { /* also from bounds that are both stable or both not */
    def.lower = bounds[k][0];
    def.upper = bounds[k][1];
    OK(bisection_find(d, &def, &found[k], why));
    assert_true(found[k].stable < found[k].unstable);
    assert_true(found[k].unstable <= 1.01 * found[k].stable);
    /* 190 steps: a little above the limit the criterion is not reached */
    assert_true(found[k].stable > 0.99 * limit && found[k].unstable < 1.03 * limit);
    assert_int_equal(mps_dynamics_steps(d), 0);
    NEAR(mps_dynamics_time(d), 0.1, 0.0);
    NEAR(soil_value(set, "rotation", 40, 0), 1e-6, 0.0);
  }
  def.accuracy = 1.0 + 1e-15; /* down to neighbouring numbers, not for ever */
  OK(bisection_find(d, &def, &found[0], why));
  assert_true(found[0].unstable < found[0].stable * (1.0 + 1e-14));
}

TEST(bisection_says_when_there_is_no_limit) {
  const soil_layer soil = {1e9, 1500.0, 100.0, 200.0, 0.0};
  scoped_particles *set =
      soil_particles(context, 1.0, 1.0, 1.0, 1, &soil); /* nothing can diverge */
  scoped_dynamics *d = lone(set);
  bisection found = {0};
  const bisection_def def = bisection_defaults();
  assert_int_equal(bisection_find(d, &def, &found, why), MPS_ERROR_NUMERIC);
  assert_non_null(strstr(why, "stays below the criterion within 2.5 s: no limit was found"));
  NEAR(found.stable, 0.0, 0.0);
}

TEST(bisection_brackets_the_linear_limit) {
  scoped_particles *particles = NULL;
  DEF(dynamics, dynamics_def, .divergence = 2.2);
  mps_dynamics *dynamics =
      paper_column(context, 0.5, 100.0, 200.0, 0.0, 'S', &dynamics_def, &particles);
  bisection_def def = bisection_defaults();
  bisection found;
  def.accuracy = 1.003;
  def.lower = 3.5e-3;
  def.upper = 5e-3;
  OK(bisection_find(dynamics, &def, &found, why));
  print_message("2.2 m/s2: stable %.5g s, unstable %.5g s, %lld runs, %lld steps\n", found.stable,
                found.unstable, (long long)found.runs, (long long)found.steps);
  assert_true(found.stable <= 4.1047e-3 && found.stable >= 4.1047e-3 / 1.006);
  assert_true(found.unstable <= 4.1047e-3 * 1.006 && found.unstable / found.stable <= 1.003);
  assert_int_equal(mps_dynamics_steps(dynamics), 0);
  mps_dynamics_destroy(&dynamics);
}
