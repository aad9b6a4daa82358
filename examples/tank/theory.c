/* theory.c - the drop of mps-tank; waves are in common/waves.c. docs/references.md has the sources.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "tank.h"

#include <math.h>

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
  *centre = WAVES_DENSITY * A * A * x * x * y * y / (x * x + y * y);
}
