/* solitary.c - a solitary wave of Boussinesq and its piston (Goring 1979),
 *
 *   eta = H sech^2(k (c t - x) + a),   c^2 = g (d + H),   k^2 = 3 H/(4 d^3).
 *
 * The piston has the depth-averaged velocity of the water at its face, X' = c eta/(d + eta):
 * X = S (tanh theta - tanh a), theta = k (c t - X) + a, S = H/(k d). It starts at theta = a.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "waves_private.h"

#define START (-4.0) /* theta, where the level is .0013 H */
#define HIGHEST 0.7  /* H over d; waves break from .78 on */

double mpsi_waves_solitary_level(const mps_waves *w, double x, double t) {
  const double k = w->report.wave_number, c = w->solitary;
  return w->def.height / pow(cosh(fmin(fabs(k * (c * t - x) + START), 300.0)), 2.0);
}

/* Of theta + k S tanh theta = k c t + START + k S tanh START, by Newton's method between bounds. */
static double find_phase(const mps_waves *w, double t) {
  const double stroke = w->def.height / w->def.depth; /* k S */
  const double right = w->report.wave_number * w->solitary * t + START + stroke * tanh(START);
  double low = right - stroke, high = right + stroke, theta = right;
  for (int n = 0; n < 60; n++) {
    const double excess = theta + stroke * tanh(theta) - right;
    const double change = excess / (1.0 + stroke / pow(cosh(fmin(fabs(theta), 300.0)), 2.0));
    const double next = theta - change;
    if (fabs(change) < 1e-14) break;
    *(excess > 0.0 ? &high : &low) = theta;
    theta = next > low && next < high ? next : 0.5 * (low + high);
  }
  return theta;
}

void mpsi_waves_move_solitary(const mps_waves *w, double t, double motion[4]) {
  const double d = w->def.depth, H = w->def.height, k = w->report.wave_number, c = w->solitary;
  const double theta = find_phase(w, t), turn = tanh(theta);
  const double eta = H / pow(cosh(fmin(fabs(theta), 300.0)), 2.0);
  motion[0] = H / (k * d) * (turn - tanh(START));
  motion[1] = c * eta / (d + eta);
  motion[2] = -2.0 * c * d * k * (c - motion[1]) * eta * turn / ((d + eta) * (d + eta));
  motion[3] = eta;
}

mps_status mpsi_waves_make_solitary(mps_waves *w) {
  const double d = w->def.depth, H = w->def.height, g = w->def.gravity;
  mps_waves_report *r = &w->report;
  if (H > HIGHEST * d)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "height %g m of the solitary wave must be at most %g m, %g of the depth: higher "
        "ones break",
        H, HIGHEST * d, HIGHEST);
  w->solitary = sqrt(g * (d + H));
  r->wave_number = sqrt(0.75 * H / d) / d;
  r->period = w->period = 2.0 * MPSI_WAVES_PI / (r->wave_number * w->solitary);
  r->height = H;
  r->repeat = w->repeat =
      -2.0 * (START + H / d * tanh(START)) / (r->wave_number * w->solitary); /* of the motion */
  return MPS_OK;
}
