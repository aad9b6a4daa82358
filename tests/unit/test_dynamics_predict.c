/* test_dynamics_predict.c - the prediction of a time step without particles.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "soil_column.h"
#include "test_fixture.h"

/* ---- prediction ------------------------------------------------------------------------------ */

static mps_dynamics_predict_def ground(double R, double vs, double vp, double h) {
  DEF(dynamics_predict, def, .spacing = 2.0 * R, .shear_velocity = vs, .pressure_velocity = vp,
      .damping = h);
  return def;
}

static mps_dynamics_prediction predict(const mps_dynamics_predict_def *def) {
  mps_dynamics_prediction out;
  OK(mps_dynamics_predict(context, def, &out));
  return out;
}

TEST(prediction_by_linear_theory) {
  for (double h = 0.0; h < 0.5; h += 0.07) {
    const mps_dynamics_predict_def def = ground(0.4, 150.0, 330.0, h);
    const mps_dynamics_prediction p = predict(&def);
    const double omega = sqrt(24.0) * 150.0 / 0.8; /* the spin mode */
    NEAR(p.omega / omega, 1.0, 1e-12);
    const double b = h / (PI * 15.0) + 4.0 * PI * 14.0 / 15.0 * h / (omega * omega);
    NEAR(p.dt / (-b + sqrt(b * b + 4.0 / (omega * omega))), 1.0, 1e-10);
    if (h == 0.0) NEAR(p.dt, 2.0 / omega, 1e-12);
  }
  /* stiff in pressure: a wave, no longer the spin */
  const mps_dynamics_predict_def stiff = ground(0.4, 150.0, 1500.0, 0.0);
  assert_true(predict(&stiff).omega > 1.5 * sqrt(24.0) * 150.0 / 0.8);
}

TEST(bad_questions_are_refused) {
  mps_dynamics_prediction out = {.dt = -7.0};
  const mps_dynamics_predict_def good = ground(0.5, 100.0, 200.0, 0.05);
  REFUSES(mps_dynamics_predict(context, NULL, &out), "def is NULL");
  REFUSES(mps_dynamics_predict(context, &good, NULL), "out is NULL");
  NEAR(out.dt, -7.0, 0.0);
}
