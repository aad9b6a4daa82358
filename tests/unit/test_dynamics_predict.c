/* test_dynamics_predict.c - the regression of Yoshida (14)-(16) and the prediction of a time step
 * without particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"

#include <mps/dynamics.h>

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

typedef struct cases {
  int64_t count;
  double R[MOST], V[MOST], h[MOST], dt[MOST];
} cases;

static cases from_table(const double b[2][3], int dampings) {
  const double R[3] = {0.25, 0.5, 1.6}, V[4] = {100.0, 200.0, 400.0, 800.0};
  const double h[6] = {0.22, 0.001, 0.05, 0.005, 0.1, 0.01}; /* in any order */
  cases c = {0};
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

static mps_status fit(mps_context *own, const cases *c, double h_max, mps_limit_fit *out) {
  return mps_dynamics_fit_limits(own, c->count, c->R, c->V, c->h, c->dt, h_max, out);
}

static void the_printed_table_is_recovered_from_its_own_limits(void **state) {
  (void)state;
  for (int wave = 0; wave < 2; wave++) {
    const double(*b)[3] = wave ? table_p : table_s;
    cases c = from_table(b, 6);
    mps_limit_fit out, table;
    mps_assert_ok(context, fit(context, &c, 0.22, &out));
    mps_assert_ok(context, mps_limit_fit_printed(context, wave ? 'P' : 'S', &table));
    assert_int_equal(out.dampings, 6);
    for (int k = 0; k < 3; k++) {
      mps_assert_near(out.b1[k], b[0][k], 1e-9);
      mps_assert_near(out.b2[k], b[1][k], 1e-9);
      mps_assert_near(table.b1[k], b[0][k], 0.0);
      mps_assert_near(table.b2[k], b[1][k], 0.0);
    }
    assert_true(out.rms < 1e-9);
    for (int k = 0; k < 5; k++) assert_true(out.h[k] < out.h[k + 1]); /* ascending */
    for (int64_t k = 0; k < c.count; k++)
      mps_assert_near(mps_limit_fit_dt(&out, c.R[k], c.V[k], c.h[k]) / c.dt[k], 1.0, 1e-9);
    /* (14) for each h */
    const double x = log10(out.h[2]);
    mps_assert_near(log10(out.a1[2]), b[0][0] * x * x + b[0][1] * x + b[0][2], 1e-9);
    mps_assert_near(log10(out.a2[2]), b[1][0] * x * x + b[1][1] * x + b[1][2], 1e-9);
    /* what is above h_max is not looked at, and rms is that of a known scatter */
    for (int64_t k = 0; k < c.count; k++)
      if (c.h[k] == 0.22) c.dt[k] *= 3.0 + c.R[k];
    mps_assert_ok(context, fit(context, &c, 0.1, &out));
    assert_true(out.rms < 1e-9);
    mps_assert_near(out.b2[1], b[1][1], 1e-9);
    assert_int_equal(out.dampings, 6);
    for (int64_t k = 0; k < c.count; k += 2) /* both of each pair: 0.99 and 1.01 of the mean */
      c.dt[k] *= 1.0001, c.dt[k + 1] *= 0.9999;
    mps_assert_ok(context, fit(context, &c, 0.1, &out));
    assert_true(out.rms > 1e-6 && out.rms < 1.1e-4);
  }
}

static void too_few_cases_are_refused(void **state) {
  (void)state;
  mps_limit_fit out = {.rms = -7.0};
  for (int dampings = 1; dampings < 3; dampings++) {
    const cases c = from_table(table_s, dampings);
    char text[64];
    snprintf(text, sizeof text, "%d damping ratios are at most", dampings);
    mps_assert_fails(context, fit(context, &c, 0.3, &out), MPS_ERROR_NUMERIC, text);
  }
  cases c = from_table(table_s, 6);
  mps_assert_fails(context, fit(context, &c, 0.005, &out), MPS_ERROR_NUMERIC, "2 damping ratios");
  c.count = 6; /* one R/V */
  mps_assert_fails(context, fit(context, &c, 0.22, &out), MPS_ERROR_NUMERIC,
                   "h = 0.001 has 1 cases: at least 2 distinct R/V");
  c = from_table(table_s, 6);
  for (int64_t k = 0; k < c.count; k++) c.R[k] = 0.01 * c.V[k]; /* many, but one R/V */
  mps_assert_fails(context, fit(context, &c, 0.22, &out), MPS_ERROR_NUMERIC, "2 distinct R/V");
  c = from_table(table_s, 6);
  for (int64_t k = 0; k < c.count; k++) c.dt[k] = c.V[k] / c.R[k];
  mps_assert_fails(context, fit(context, &c, 0.22, &out), MPS_ERROR_NUMERIC,
                   "a2 for h = 0.001 is -1, must be > 0");
  mps_assert_near(out.rms, -7.0, 0.0);
}

static void bad_cases_are_refused(void **state) {
  (void)state;
  cases c = from_table(table_s, 6);
  mps_limit_fit out = {.rms = -7.0};
  const double *r = c.R, *v = c.V, *h = c.h, *t = c.dt;
#define FIT(count, R, V, H, T, max, text)                                                          \
  mps_assert_fails(context, mps_dynamics_fit_limits(context, count, R, V, H, T, max, &out),        \
                   MPS_ERROR_ARGUMENT, text)
  FIT(0, r, v, h, t, 0.22, "count is 0");
  FIT(9, NULL, v, h, t, 0.22, "must not be NULL");
  FIT(9, r, NULL, h, t, 0.22, "must not be NULL");
  FIT(9, r, v, NULL, t, 0.22, "must not be NULL");
  FIT(9, r, v, h, NULL, 0.22, "must not be NULL");
  FIT(9, r, v, h, t, 0.0, "h_max is 0, must be > 0");
  FIT(9, r, v, h, t, NAN, "h_max is nan");
#undef FIT
  mps_assert_fails(context, mps_dynamics_fit_limits(context, 9, r, v, h, t, 0.22, NULL),
                   MPS_ERROR_ARGUMENT, "out is NULL");
  double *columns[4] = {c.R, c.V, c.h, c.dt};
  const char *const names[4] = {"R[5] is", "V[5] is", "h[5] is", "dt[5] is"};
  const double bad[4] = {0.0, -1.0, NAN, INFINITY};
  for (int k = 0; k < 16; k++) {
    const double former = columns[k / 4][5];
    columns[k / 4][5] = bad[k % 4];
    mps_assert_fails(context, fit(context, &c, 0.22, &out), MPS_ERROR_ARGUMENT, names[k / 4]);
    columns[k / 4][5] = former;
  }
  for (int64_t k = 0; k < c.count; k++) c.h[k] = 0.001 * (double)(k + 1);
  mps_assert_fails(context, fit(context, &c, 0.22, &out), MPS_ERROR_ARGUMENT, "more than 32");
  mps_assert_near(out.rms, -7.0, 0.0);
  mps_assert_fails(context, mps_limit_fit_printed(context, 'Q', &out), MPS_ERROR_ARGUMENT,
                   "wave is 'Q'");
  mps_assert_fails(context, mps_limit_fit_printed(context, 'S', NULL), MPS_ERROR_ARGUMENT, "out");
  assert_true(isnan(mps_limit_fit_dt(NULL, 1.0, 1.0, 1.0)));
  assert_true(isnan(mps_limit_fit_dt(&out, 0.0, 1.0, 1.0)));
  assert_true(isnan(mps_limit_fit_dt(&out, 1.0, NAN, 1.0)));
  assert_true(isnan(mps_limit_fit_dt(&out, 1.0, 1.0, -1.0)));
}

static mps_status fit_again(mps_context *own, int what) {
  const cases c = from_table(table_s, 6);
  mps_limit_fit out;
  (void)what;
  return fit(own, &c, 0.22, &out);
}

static void a_refused_allocation_is_told_as_such(void **state) {
  (void)state;
  test_allocator_sweep(fit_again, 0);
}

/* ---- prediction ------------------------------------------------------------------------------ */

static mps_predict_def ground(double R, double vs, double vp, double h) {
  mps_predict_def def = mps_predict_defaults();
  def.spacing = 2.0 * R;
  def.shear_velocity = vs;
  def.pressure_velocity = vp;
  def.damping = h;
  return def;
}

static mps_prediction predict(const mps_predict_def *def) {
  mps_prediction out;
  mps_assert_ok(context, mps_dynamics_predict_dt(context, def, &out));
  return out;
}

static void prediction_by_linear_theory(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  for (double h = 0.0; h < 0.5; h += 0.07) {
    const mps_predict_def def = ground(0.4, 150.0, 330.0, h);
    const mps_prediction p = predict(&def);
    const double omega = sqrt(24.0) * 150.0 / 0.8; /* the spin mode */
    mps_assert_near(p.omega / omega, 1.0, 1e-12);
    const double b = h / (pi * 15.0) + 4.0 * pi * 14.0 / 15.0 * h / (omega * omega);
    mps_assert_near(p.linear / (-b + sqrt(b * b + 4.0 / (omega * omega))), 1.0, 1e-10);
    if (h == 0.0) mps_assert_near(p.linear, 2.0 / omega, 1e-12);
  }
  /* stiff in pressure: a wave, no longer the spin */
  const mps_predict_def stiff = ground(0.4, 150.0, 1500.0, 0.0);
  assert_true(predict(&stiff).omega > 1.5 * sqrt(24.0) * 150.0 / 0.8);
}

static void prediction_by_the_printed_table_and_its_range(void **state) {
  (void)state;
  const double h[] = {0.001, 0.01, 0.048, 0.22};
  for (int k = 0; k < 4; k++) {
    const mps_predict_def def = ground(0.5, 100.0, 200.0, h[k]);
    const mps_prediction p = predict(&def);
    mps_assert_near(p.printed_s, printed(table_s, 0.5, 100.0, h[k]), 1e-15);
    mps_assert_near(p.printed_p, printed(table_p, 0.5, 200.0, h[k]), 1e-15);
    mps_assert_near(p.printed, fmin(p.printed_s, p.printed_p), 0.0);
    assert_int_equal(p.printed_in_range, 1);
    assert_int_equal(p.printed_is_safe, p.printed <= p.linear);
  }
  /* Table 2's figures for R = 0.5 m, V = 100 m/s */
  const mps_predict_def s = ground(0.5, 100.0, 200.0, 0.048);
  mps_assert_near(predict(&s).printed_s, 3.243e-3, 5e-7);
  const mps_predict_def p = ground(0.5, 50.0, 100.0, 0.22);
  mps_assert_near(predict(&p).printed_p, 4.589e-3, 5e-7);
  /* outside the range of h there is nothing printed; undamped is the paper's 0.001 */
  const double outside[] = {0.0005, 0.23, 1.0};
  for (int k = 0; k < 3; k++) {
    const mps_predict_def def = ground(0.5, 100.0, 200.0, outside[k]);
    const mps_prediction q = predict(&def);
    assert_true(isnan(q.printed) && isnan(q.printed_s) && isnan(q.printed_p));
    assert_true(!q.printed_in_range && !q.printed_is_safe && q.linear > 0.0);
  }
  const mps_predict_def undamped = ground(0.5, 100.0, 200.0, 0.0);
  mps_assert_near(predict(&undamped).printed_s, printed(table_s, 0.5, 100.0, 0.001), 1e-15);
  const mps_predict_def coarse = ground(2.0, 100.0, 200.0, 0.01);
  assert_int_equal(predict(&coarse).printed_in_range, 0);
}

/* The printed regression may be far above the limit, and must then not be called safe. */
static void the_printed_table_is_not_always_safe(void **state) {
  (void)state;
  double worst = 0.0;
  for (double h = 0.048; h <= 0.22; h += 0.0043) {
    const mps_predict_def def = ground(1.6, 100.0, 200.0, h);
    const mps_prediction p = predict(&def);
    assert_int_equal(p.printed_in_range, 1);
    assert_int_equal(p.printed_is_safe, 0);
    worst = fmax(worst, p.printed_s / p.linear);
  }
  print_message("printed for S waves / linear: up to %.3f at R = 1.6 m\n", worst);
  mps_assert_near(worst, 1.52, 0.02);
}

static void bad_questions_are_refused(void **state) {
  (void)state;
  mps_prediction out = {.linear = -7.0};
  const mps_predict_def good = ground(0.5, 100.0, 200.0, 0.05);
  const struct {
    size_t offset;
    double value;
    const char *text;
  } bad[] = {{offsetof(mps_predict_def, spacing), 0.0, "spacing is 0, must be finite and > 0 m"},
             {offsetof(mps_predict_def, spacing), INFINITY, "spacing is inf"},
             {offsetof(mps_predict_def, shear_velocity), -1.0, "shear_velocity is -1"},
             {offsetof(mps_predict_def, pressure_velocity), 141.0, "pressure_velocity is 141"},
             {offsetof(mps_predict_def, damping), -0.1, "damping is -0.1, must be finite and >= 0"},
             {offsetof(mps_predict_def, damping), NAN, "damping is nan"},
             {offsetof(mps_predict_def, f1), 0.0, "f1 is 0, must be finite and > 0 Hz"},
             {offsetof(mps_predict_def, f2), NAN, "f2 is nan"},
             {offsetof(mps_predict_def, radius_ratio), 1.0,
              "radius_ratio is 1, must be finite and in (1,"},
             {offsetof(mps_predict_def, radius_ratio), 4.5, "radius_ratio is 4.5"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    mps_predict_def def = good;
    memcpy((char *)&def + bad[k].offset, &bad[k].value, sizeof(double));
    mps_assert_fails(context, mps_dynamics_predict_dt(context, &def, &out), MPS_ERROR_ARGUMENT,
                     bad[k].text);
  }
  mps_predict_def def = good;
  def.integrator = MPS_INTEGRATOR_EULER;
  mps_assert_fails(context, mps_dynamics_predict_dt(context, &def, &out), MPS_ERROR_ARGUMENT,
                   "integrator is 0, allowed are 1");
  mps_assert_fails(context, mps_dynamics_predict_dt(context, NULL, &out), MPS_ERROR_ARGUMENT,
                   "def is NULL");
  mps_assert_fails(context, mps_dynamics_predict_dt(context, &good, NULL), MPS_ERROR_ARGUMENT,
                   "out is NULL");
  mps_assert_near(out.linear, -7.0, 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_printed_table_is_recovered_from_its_own_limits),
      cmocka_unit_test(too_few_cases_are_refused),
      cmocka_unit_test(bad_cases_are_refused),
      cmocka_unit_test(a_refused_allocation_is_told_as_such),
      cmocka_unit_test(prediction_by_linear_theory),
      cmocka_unit_test(prediction_by_the_printed_table_and_its_range),
      cmocka_unit_test(the_printed_table_is_not_always_safe),
      cmocka_unit_test(bad_questions_are_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
