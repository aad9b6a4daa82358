/* theory.c - what linear and nonlinear theory say of the cases of mps-tank; docs/references.md has
 * the sources. SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <math.h>

double tank_wave_number(double period, double depth) {
  const double w2 = 4.0 * TANK_PI * TANK_PI / (period * period);
  double k = w2 / TANK_G / sqrt(tanh(w2 * depth / TANK_G)); /* close for all depths */
  for (int n = 0; n < 50; n++) {
    const double t = tanh(k * depth);
    k -= (TANK_G * k * t - w2) / (TANK_G * (t + k * depth * (1.0 - t * t)));
  }
  return k;
}

double tank_havelock(double k, double depth) {
  const double a = 2.0 * k * depth;
  return 2.0 * (cosh(a) - 1.0) / (sinh(a) + a);
}

double tank_sainflou(double k, double depth, double H, int sign) {
  const double rise = 0.5 * k * H * H / tanh(k * depth); /* pi H^2 coth(kd)/L */
  const double bed = TANK_DENSITY * TANK_G * H / cosh(k * depth);
  return 0.5 * (depth + sign * H + rise) * (TANK_DENSITY * TANK_G * depth + sign * bed);
}

double tank_sloshing_period(double length, double depth) {
  const double k = TANK_PI / length;
  return 2.0 * TANK_PI / sqrt(TANK_G * k * tanh(k * depth));
}

/* a' = -A a, b' = A b, A' = A^2 (a^2 - b^2)/(a^2 + b^2), A(0) = 1/s; p = rho A^2 a^2 b^2/(a^2 +
 * b^2). */
void tank_drop(double radius, double t, double *a, double *b, double *centre) {
  const int steps = 20000;
  const double dt = t / steps;
  double A = 1.0, x = radius, y = radius;
  for (int n = 0; n < steps; n++) { /* midpoint rule */
    const double xm = x * (1.0 - 0.5 * dt * A), ym = y * (1.0 + 0.5 * dt * A);
    const double Am = A + 0.5 * dt * A * A * (x * x - y * y) / (x * x + y * y);
    x -= dt * Am * xm, y += dt * Am * ym;
    A += dt * Am * Am * (xm * xm - ym * ym) / (xm * xm + ym * ym);
  }
  *a = x, *b = y;
  *centre = TANK_DENSITY * A * A * x * x * y * y / (x * x + y * y);
}
