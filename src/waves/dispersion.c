/* dispersion.c - linear waves over a flat bed, and those that a piston makes: the dispersion
 * relation omega^2 = g k tanh kd, the transfer of Biesel and Suquet (1951), the evanescent modes q
 * tan qd = -omega^2/g. SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"

#include "core/definition/digits.h"
#include "waves_private.h"

#define MODES 60 /* of the sum at the piston; its tail is added in closed form */

double mpsi_waves_depths(double y) {
  double x = y / sqrt(tanh(y)); /* exact for short and long waves, 5 % between */
  for (int n = 0; n < 30; n++) {
    const double t = tanh(x), step = (x * t - y) / (t + x * (1.0 - t * t));
    x -= step;
    if (fabs(step) <= 1e-15 * x) break;
  }
  return x;
}

/* With e = exp(-2 kd), which does not overflow. */
double mpsi_waves_far(double kd) {
  const double e = exp(-2.0 * kd), less = -expm1(-2.0 * kd);
  if (kd < 1e-3) return kd; /* the limit of long waves, to kd^3/6 */
  return less * less / (0.5 * less * (1.0 + e) + 2.0 * kd * e);
}

/* qd lies in ((j - 1/2) pi, j pi): qd = j pi - atan(y/qd). */
double mpsi_waves_evanescent(double y, int j, double *amplitude) {
  const double top = j * MPSI_WAVES_PI;
  double low = top - 0.5 * MPSI_WAVES_PI, high = top, q = top - atan(y / top);
  for (int n = 0; n < 100; n++) {
    const double f = q - top + atan(y / q); /* grows with q */
    *(f > 0.0 ? &high : &low) = q;
    const double next = q - f / (1.0 - y / (q * q + y * y));
    const double taken = next > low && next < high ? next : 0.5 * (low + high);
    if (fabs(taken - q) <= 1e-15 * q) break;
    q = taken;
  }
  const double s = sin(q);
  *amplitude = 4.0 * s * s / (2.0 * q + sin(2.0 * q));
  return q;
}

/* sin^2 qd = y^2/(q^2 d^2 + y^2): high modes have 2 y^2/(qd (q^2 d^2 + y^2)), and are summed as the
 * integral over qd/pi. */
double mpsi_waves_near(double y) {
  double sum = 0.0, one;
  int modes = MODES;
  if (y > 10.0) modes = (int)fmin(MODES + 10.0 * y, 20000.0);
  for (int j = 1; j <= modes; j++) {
    (void)mpsi_waves_evanescent(y, j, &one);
    sum += one;
  }
  const double last = (modes + 0.5) * MPSI_WAVES_PI;
  return sum + log1p(y * y / (last * last)) / MPSI_WAVES_PI;
}

mps_status mpsi_waves_check_range(mps_context *context, const char *function, double period,
                                  double depth, double gravity) {
  const struct {
    const char *name, *unit;
    double value;
  } given[] = {{"period", "s", period}, {"depth", "m", depth}, {"gravity", "m/s2", gravity}};
  for (int k = 0; k < 3; k++)
    if (!mpsi_waves_positive(given[k].value))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "%s is %s %s, must be in 1e-12 to 1e12", given[k].name,
                       mpsi_outside(given[k].value, 1e-12, 1e12).text, given[k].unit);
  const double omega = 2.0 * MPSI_WAVES_PI / period, y = omega * omega * depth / gravity;
  if (!(y >= MPSI_WAVES_SHALLOWEST && y <= MPSI_WAVES_DEEPEST))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "period %g s in a depth of %g m has omega^2 depth/g = %g, must be in %g to %g",
                     period, depth, y, MPSI_WAVES_SHALLOWEST, MPSI_WAVES_DEEPEST);
  return MPS_OK;
}

