/* theory.c - the drop and the structures of mps-tank; waves are in common/waves.c.
 * docs/references.md has the sources. SPDX-License-Identifier: BSD-3-Clause */
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

/* ---- wall on a spring ------------------------------------------------------------------------ */

/* Added mass (kg) of the end wall of a closed tank that oscillates with w: the sum over the k with
 * k tan(k d) = -w^2/g of rho I^2 coth(k L)/(k N), I the integral of cos(k y) over the depth, N that
 * of its square. The travelling wave carries next to nothing at the frequencies of a stiff spring.
 */
double tank_added_mass(double w, double length, double depth) {
  double sum = 0.0;
  for (int j = 0; j < 2000; j++) {
    double low = (j + 0.5) * WAVES_PI / depth * (1.0 + 1e-12), high = (j + 1) * WAVES_PI / depth;
    for (int n = 0; n < 60; n++) {
      const double k = 0.5 * (low + high);
      if (k * tan(k * depth) < -w * w / WAVES_G)
        low = k;
      else
        high = k;
    }
    const double I = sin(low * depth) / low;
    const double N = 0.5 * (depth + sin(2.0 * low * depth) / (2.0 * low));
    sum += WAVES_DENSITY * I * I / (tanh(low * length) * low * N);
  }
  return sum;
}

double tank_spring_omega(const tank_settings *s) {
  double w = sqrt(s->stiffness / s->mass);
  for (int n = 0; n < 50; n++)
    w = sqrt(s->stiffness / (s->mass + tank_added_mass(w, s->length, s->depth)));
  return w;
}

/* ---- plate ----------------------------------------------------------------------------------- */

double tank_plate_rigidity(const tank_settings *s) {
  return s->young * pow(s->plate_thickness, 3.0) / (12.0 * (1.0 - s->poisson * s->poisson));
}

double tank_plate_root(int k) {
  double r = (k + 1.5) * WAVES_PI; /* close */
  for (int n = 0; n < 20; n++) {
    const double f = cos(r) - 1.0 / cosh(r), slope = -sin(r) + tanh(r) / cosh(r);
    r -= f / slope;
  }
  return r;
}

/* cosh - cos - sigma (sinh - sin), without the difference of two large numbers. */
double tank_plate_shape(int k, double at) {
  const double r = tank_plate_root(k), z = r * at, e = exp(-r);
  const double sigma = (1.0 + e * e - 2.0 * e * cos(r)) / (1.0 - e * e - 2.0 * e * sin(r));
  const double rest =
      (2.0 * e * (cos(r) - sin(r)) - 2.0 * e * e) / (1.0 - e * e - 2.0 * e * sin(r));
  return 0.5 * (rest * exp(z) + (1.0 + sigma) * exp(-z)) - cos(z) + sigma * sin(z);
}

double tank_plate_deflection(const tank_settings *s) {
  const double water = WAVES_DENSITY * WAVES_G * s->depth;
  const double weight = s->plate_density * s->plate_thickness * WAVES_G;
  return (water + weight) * pow(s->plate_length, 4.0) / (384.0 * tank_plate_rigidity(s));
}

enum { WAVES = 100 }; /* cosines that the plate's shapes are made of */

/* Share of cos(n pi x/L) in each shape: their mean product over the plate. */
static void find_shares(double share[WAVES][TANK_SHAPES]) {
  enum { POINTS = 400 };
  for (int k = 0; k < TANK_SHAPES; k++)
    for (int p = 0; p < POINTS; p++) {
      const double at = (p + 0.5) / POINTS, shape = tank_plate_shape(k, at) / POINTS;
      for (int n = 0; n < WAVES; n++) share[n][k] += shape * cos(n * WAVES_PI * at);
    }
}

/* Mass (kg) of the plate and its water in shapes i and j: cos(n pi x/L) carries water like a layer
 * of tanh(k d)/k, the mean motion the whole depth. */
static double mass_between(const tank_settings *s, double share[WAVES][TANK_SHAPES], int i, int j) {
  const double L = s->plate_length;
  double mass = i == j ? s->plate_density * s->plate_thickness * L : 0.0;
  for (int n = 0; n < WAVES; n++) {
    const double k = n * WAVES_PI / L, layer = n ? 2.0 * tanh(k * s->depth) / k : s->depth;
    mass += WAVES_DENSITY * layer * share[n][i] * share[n][j] * L;
  }
  return mass;
}

/* Ritz: the largest eigenvalue of K^-1 M by repeated multiplication. */
double tank_plate_omega(const tank_settings *s) {
  double share[WAVES][TANK_SHAPES] = {{0.0}}, mass[TANK_SHAPES][TANK_SHAPES];
  double stiffness[TANK_SHAPES], x[TANK_SHAPES] = {1.0}, value = 1.0;
  find_shares(share);
  for (int i = 0; i < TANK_SHAPES; i++) {
    stiffness[i] =
        tank_plate_rigidity(s) * pow(tank_plate_root(i) / s->plate_length, 4.0) * s->plate_length;
    for (int j = 0; j <= i; j++) mass[i][j] = mass[j][i] = mass_between(s, share, i, j);
  }
  for (int n = 0; n < 60; n++) {
    double y[TANK_SHAPES] = {0.0};
    for (int i = 0; i < TANK_SHAPES; i++) {
      for (int j = 0; j < TANK_SHAPES; j++) y[i] += mass[i][j] * x[j];
      y[i] /= stiffness[i];
    }
    value = y[0];
    for (int i = 0; i < TANK_SHAPES; i++) x[i] = y[i] / value;
  }
  return sqrt(1.0 / value);
}

/* ---- where theory ends ----------------------------------------------------------------------- */

#define UPRIGHT 0.05 /* rad */

/* The heave and its theory assume a box that stays upright. */
static void warn_of_roll(app *a, const tank_model *m) {
  if (m->roll > UPRIGHT)
    app_warn(a,
             "the box rolls by up to %.1f degrees: period, decay and their theory are those of the "
             "heave of a box that stays upright",
             180.0 / WAVES_PI * m->roll);
}

#define THIN                                                                                       \
  0.3 /* of the thickness: where a plate held at both ends begins to act as a membrane             \
       */

static void warn_of_bending(app *a, const tank_model *m) {
  const tank_sample *bent = m->sample;
  for (int64_t k = 1; k < m->samples; k++)
    if (fabs(m->sample[k].deflection) > fabs(bent->deflection)) bent = &m->sample[k];
  if (m->s.kind == TANK_PLATE && fabs(bent->deflection) > THIN * m->s.plate_thickness)
    app_warn(a,
             "the plate bends by %.3g m at t = %.3f s, more than %g of its thickness of %g m: its "
             "deflections are computed as small ones, without the tension that they cause",
             bent->deflection, bent->t, THIN, m->s.plate_thickness);
}

#define SCHEME 0.26 /* viscosity of the scheme over (g spacing^3)^1/2 (docs/theory/fluid.md) */

static void warn_of_viscosity(app *a, const tank_model *m) {
  const tank_settings *s = &m->s;
  const double least = SCHEME * sqrt(WAVES_G * pow(s->spacing, 3.0)) * WAVES_DENSITY;
  if (!(s->viscosity > 0.0) || s->kind == TANK_DROP || s->scheme == 1) return;
  if (s->viscosity < least)
    app_warn(
        a,
        "--viscosity %.3g Pa s has no effect: that of the scheme is %.2g Pa s with a spacing of "
        "%g m",
        s->viscosity, least, s->spacing);
}

void tank_warn(app *a, const tank_model *m) {
  warn_of_viscosity(a, m);
  warn_of_roll(a, m);
  warn_of_bending(a, m);
}
