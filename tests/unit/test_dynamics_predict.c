/* test_dynamics_predict.c - the prediction of a time step without particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_fixture.h"

/* ---- prediction ------------------------------------------------------------------------------ */

static mps_dynamics_predict_def ground(double R, double vs, double vp, double h) {
  mps_dynamics_predict_def def = mps_dynamics_predict_defaults();
  def.spacing = 2.0 * R;
  def.shear_velocity = vs;
  def.pressure_velocity = vp;
  def.damping = h;
  return def;
}

static mps_dynamics_prediction predict(const mps_dynamics_predict_def *def) {
  mps_dynamics_prediction out;
  mps_assert_ok(context, mps_dynamics_predict(context, def, &out));
  return out;
}

static void prediction_by_linear_theory(void **state) {
  (void)state;
  const double pi = 3.14159265358979323846;
  for (double h = 0.0; h < 0.5; h += 0.07) {
    const mps_dynamics_predict_def def = ground(0.4, 150.0, 330.0, h);
    const mps_dynamics_prediction p = predict(&def);
    const double omega = sqrt(24.0) * 150.0 / 0.8; /* the spin mode */
    mps_assert_near(p.omega / omega, 1.0, 1e-12);
    const double b = h / (pi * 15.0) + 4.0 * pi * 14.0 / 15.0 * h / (omega * omega);
    mps_assert_near(p.dt / (-b + sqrt(b * b + 4.0 / (omega * omega))), 1.0, 1e-10);
    if (h == 0.0) mps_assert_near(p.dt, 2.0 / omega, 1e-12);
  }
  /* stiff in pressure: a wave, no longer the spin */
  const mps_dynamics_predict_def stiff = ground(0.4, 150.0, 1500.0, 0.0);
  assert_true(predict(&stiff).omega > 1.5 * sqrt(24.0) * 150.0 / 0.8);
}

static void bad_questions_are_refused(void **state) {
  (void)state;
  mps_dynamics_prediction out = {.dt = -7.0};
  const mps_dynamics_predict_def good = ground(0.5, 100.0, 200.0, 0.05);
  const struct {
    size_t offset;
    double value;
    const char *text;
  } bad[] = {
      {offsetof(mps_dynamics_predict_def, spacing), 0.0, "spacing is 0, must be in 1e-09..1e+09 m"},
      {offsetof(mps_dynamics_predict_def, spacing), INFINITY, "spacing is inf"},
      {offsetof(mps_dynamics_predict_def, shear_velocity), -1.0, "shear_velocity is -1"},
      {offsetof(mps_dynamics_predict_def, pressure_velocity), 141.0, "pressure_velocity is 141"},
      {offsetof(mps_dynamics_predict_def, damping), -0.1, "damping is -0.1, must be in 0..1000"},
      {offsetof(mps_dynamics_predict_def, damping), NAN, "damping is nan"},
      {offsetof(mps_dynamics_predict_def, f1), 0.0, "f1 is 0, must be in 1e-20"},
      {offsetof(mps_dynamics_predict_def, f2), NAN, "f2 is nan"},
      {offsetof(mps_dynamics_predict_def, radius_ratio), 1.0, "radius_ratio is 1, must be in 1..4"},
      {offsetof(mps_dynamics_predict_def, radius_ratio), 4.5, "radius_ratio is 4.5"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    mps_dynamics_predict_def def = good;
    memcpy((char *)&def + bad[k].offset, &bad[k].value, sizeof(double));
    mps_assert_fails(context, mps_dynamics_predict(context, &def, &out), MPS_ERROR_ARGUMENT,
                     bad[k].text);
  }
  mps_dynamics_predict_def def = good;
  def.integrator = MPS_DYNAMICS_INTEGRATOR_EULER;
  mps_assert_fails(context, mps_dynamics_predict(context, &def, &out), MPS_ERROR_ARGUMENT,
                   "integrator is 2, allowed are 0");
  mps_assert_fails(context, mps_dynamics_predict(context, NULL, &out), MPS_ERROR_ARGUMENT,
                   "def is NULL");
  mps_assert_fails(context, mps_dynamics_predict(context, &good, NULL), MPS_ERROR_ARGUMENT,
                   "out is NULL");
  mps_assert_near(out.dt, -7.0, 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(prediction_by_linear_theory),
      cmocka_unit_test(bad_questions_are_refused),
  };
  return cmocka_run_group_tests(tests, make_context, drop_context);
}
