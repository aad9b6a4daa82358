/* exact.c - exact solutions of mps-consolidation but those of columns (column.c), for water and
 * grains that keep their volume.
 *
 * mandel    Mandel (1953); tan(a)/a = (1 - nu)/(1/2 - nu)
 * cryer     Cryer (1963); (1 - eta x^2/2) tan(x) = x, eta = (1 - nu)/(1 - 2 nu)
 * barron    vertical drain of radius b in a cylinder of radius a, n = a/b, Barron (1948). Between a
 *           rigid plate and walls that stay, radial equilibrium gives p = q - M' e, e the change of
 *           volume; so p follows the equation of heat: u/q = sum c R(r) exp(-x^2 T), his solution
 *           for free strain, (r R')' + x^2 r R = 0, R(b) = R'(a) = 0, T = c_v t/a^2. The plate goes
 *           down by the mean of q - p over M'. For equal strain: 1 - U = exp(-2 T/F),
 *           F = n^2/(n^2 - 1) ln n - (3 n^2 - 1)/(4 n^2)
 * strip     half space under a strip load, undrained: p = q alpha/pi, alpha = 2 atan(B/z)
 * SPDX-License-Identifier: BSD-3-Clause */
#include "consolidation.h"

#include <math.h>

#define PI 3.14159265358979323846

enum { TERMS = 400 };
#define GONE 750.0 /* exp of less is 0 */

/* ---- roots ----------------------------------------------------------------------------------- */

typedef double (*function)(double x, double parameter);

/* Between a and b, where the function changes its sign. */
static double root(function f, double parameter, double a, double b) {
  const bool rises = f(b, parameter) > 0.0;
  for (int k = 0; k < 80; k++) {
    const double middle = 0.5 * (a + b);
    if ((f(middle, parameter) > 0.0) == rises)
      b = middle;
    else
      a = middle;
  }
  return 0.5 * (a + b);
}

/* ---- Mandel ---------------------------------------------------------------------------------- */

static double mandel_equation(double a, double nu) {
  return sin(a) - (1.0 - nu) / (0.5 - nu) * a * cos(a);
}

/* They do not depend on the time: found once. */
static const double *mandel_roots(double nu) {
  static double known = NAN, at[TERMS];
  for (int i = 0; i < TERMS && known != nu; i++)
    at[i] = root(mandel_equation, nu, i * PI + 1e-9, (i + 0.5) * PI);
  known = nu;
  return at;
}

/* p/p0 at x/a, p0 = F/(2 a). */
static double mandel(double nu, double x, double T) {
  const double *at = mandel_roots(nu);
  double p = 0.0;
  for (int i = 0; i < TERMS && at[i] * at[i] * T < GONE; i++) {
    const double a = at[i], s = sin(a), c = cos(a);
    p += 2.0 * s / (a - s * c) * (cos(a * x) - c) * exp(-a * a * T);
  }
  return p;
}

double exact_plate(double nu, double T) {
  double sum = 0.0, start = 0.5 - nu; /* that sum at T = 0 */
  const double *at = mandel_roots(nu);
  for (int i = 0; i < TERMS && T > 0.0 && at[i] * at[i] * T < GONE; i++) {
    const double a = at[i], s = sin(a), c = cos(a);
    sum += s * c / (a - s * c) * exp(-a * a * T);
  }
  if (!(T > 0.0)) sum = start;
  /* F/(2 G a) (start - sum) = u0/G (...) */
  return (start - sum) * 2.0 * (1.0 - nu) / (1.0 - 2.0 * nu);
}

/* ---- Cryer ----------------------------------------------------------------------------------- */

static double eta_of(double nu) { return (1.0 - nu) / (1.0 - 2.0 * nu); }

static double cryer_equation(double x, double eta) {
  return (1.0 - 0.5 * eta * x * x) * sin(x) - x * cos(x);
}

static const double *cryer_roots(double eta) {
  static double known = NAN, at[TERMS];
  for (int i = 0; i < TERMS && known != eta; i++)
    at[i] = root(cryer_equation, eta, i > 0 ? i * PI : 1e-3, (i + 1) * PI);
  known = eta;
  return at;
}

static double cryer_weight(double x, double eta) {
  return eta / (0.5 * eta * x * cos(x) + (eta - 1.0) * sin(x));
}

/* p/p0 at r/a. */
static double cryer(double nu, double r, double T) {
  const double eta = eta_of(nu);
  double p = 0.0;
  for (int i = 0; i < TERMS; i++) {
    const double x = cryer_roots(eta)[i];
    const double profile = r > 1e-9 ? sin(x * r) / r : x;
    p += cryer_weight(x, eta) * (sin(x) - profile) * exp(-x * x * T);
  }
  return p;
}

/* Radial displacement over a u0/M': the water that has left through the surface. */
static double cryer_settlement(double nu, double T) {
  const double eta = eta_of(nu);
  double sum = 0.0;
  for (int i = 0; i < TERMS; i++) {
    const double x = cryer_roots(eta)[i];
    sum += cryer_weight(x, eta) * (x * cos(x) - sin(x)) / (x * x) * (1.0 - exp(-x * x * T));
  }
  return sum;
}

/* ---- Barron ---------------------------------------------------------------------------------- */

enum { DRAIN_TERMS = 100, DRAIN_STEPS = 1200 };

typedef struct mode {
  double value, slope; /* R, dR/dr */
} mode;

static mode rate_of(double r, double x, mode m) {
  return (mode){m.slope, -m.slope / r - x * x * m.value};
}

static mode moved(mode m, double step, mode rate) {
  return (mode){m.value + step * rate.value, m.slope + step * rate.slope};
}

/* R and its slope at r, with R(b) = 0 and R'(b) = 1: Runge and Kutta's method of fourth order. */
static mode mode_at(double b, double r, double x) {
  const double h = (r - b) / DRAIN_STEPS;
  mode m = {0.0, 1.0};
  for (int k = 0; k < DRAIN_STEPS; k++) {
    const double at = b + k * h;
    const mode k1 = rate_of(at, x, m), k2 = rate_of(at + 0.5 * h, x, moved(m, 0.5 * h, k1)),
               k3 = rate_of(at + 0.5 * h, x, moved(m, 0.5 * h, k2)),
               k4 = rate_of(at + h, x, moved(m, h, k3));
    m.value += h / 6.0 * (k1.value + 2.0 * (k2.value + k3.value) + k4.value);
    m.slope += h / 6.0 * (k1.slope + 2.0 * (k2.slope + k3.slope) + k4.slope);
  }
  return m;
}

static double drain_equation(double x, double b) { return mode_at(b, 1.0, x).slope; }

/* Numbers x of the series, its coefficients c, and the mean of c R. */
typedef struct drain {
  double n, x[DRAIN_TERMS], c[DRAIN_TERMS], mean[DRAIN_TERMS];
} drain;

static const drain *drain_of(double n) {
  static drain all;
  const double b = 1.0 / n;
  for (int i = 0; i < DRAIN_TERMS && all.n != n; i++) {
    const double x =
        root(drain_equation, b, i > 0 ? i * PI / (1.0 - b) : 1e-3, (i + 1) * PI / (1.0 - b));
    const double end = mode_at(b, 1.0, x).value;
    const double integral = b / (x * x);                       /* of R r from b to a, */
    const double square = 0.5 * (end * end - b * b / (x * x)); /* of R^2 r */
    all.x[i] = x;
    all.c[i] = integral / square;
    all.mean[i] = all.c[i] * integral * 2.0 / (1.0 - b * b);
  }
  all.n = n;
  return &all;
}

static double barron(double n, double r, double T) {
  const drain *d = drain_of(n);
  double u = 0.0;
  for (int i = 0; i < DRAIN_TERMS && d->x[i] * d->x[i] * T < 50.0; i++)
    u += d->c[i] * mode_at(1.0 / n, r, d->x[i]).value * exp(-d->x[i] * d->x[i] * T);
  return u;
}

double exact_drain(double n, double T) {
  const drain *d = drain_of(n);
  double left = 0.0, start = 0.0;
  for (int i = 0; i < DRAIN_TERMS; i++) {
    left += d->mean[i] * exp(-d->x[i] * d->x[i] * T);
    start += d->mean[i];
  }
  const double last = d->x[DRAIN_TERMS - 1]; /* the terms left out fall faster than this one */
  return 1.0 - left - (1.0 - start) * exp(-last * last * T);
}

double exact_drain_equal(double n, double T) {
  const double F = n * n / (n * n - 1.0) * log(n) - (3.0 * n * n - 1.0) / (4.0 * n * n);
  return 1.0 - exp(-2.0 * T / F);
}

/* ---- all ------------------------------------------------------------------------------------- */

double exact_pressure(const settings *s, double depth, double T) {
  switch (s->kase) {
  case MANDEL:
    return mandel(s->nu, 1.0 - depth, T);
  case CRYER:
    return cryer(s->nu, 1.0 - depth, T);
  case BARRON:
    return barron(s->ratio, 1.0 - depth, T);
  default:
    return 2.0 * atan(1.0 / depth) / PI;
  }
}

double exact_sphere(double nu, double m, double T) { return m * cryer_settlement(nu, T); }
