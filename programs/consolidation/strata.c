/* strata.c - eigenfunctions of a layered column that consolidates.
 *
 * In a layer, with w = (lambda/(k M'))^1/2, R = r sin(phi) and k dR/dz = r k w cos(phi), and phi
 * grows by w h across it. Where the next layer has another k w, tan(phi) changes by their ratio and
 * phi stays in its quarter. So phi at the bottom grows with lambda, and eigenvalue number n is
 * where it has come to its n-th multiple: no eigenvalue is missed. SPDX-License-Identifier:
 * BSD-3-Clause */
#include "strata.h"

#include <math.h>
#include <stddef.h>

#define PI 3.14159265358979323846

void strata_scale(strata *s, double *k_mean, double *modulus_mean, double *height) {
  double all = 0.0, resistance = 0.0, compliance = 0.0;
  for (int i = 0; i < s->count; i++) {
    const stratum *l = &s->layer[i];
    all += l->thickness;
    resistance += l->thickness / l->k;
    compliance += l->thickness / l->modulus;
  }
  for (int i = 0; i < s->count; i++) {
    stratum *l = &s->layer[i];
    l->thickness /= all;
    l->k *= resistance / all;
    l->modulus *= compliance / all;
  }
  if (k_mean) *k_mean = all / resistance;
  if (modulus_mean) *modulus_mean = all / compliance;
  if (height) *height = all;
}

static double wave_number(const stratum *l, double lambda) {
  return sqrt(lambda / (l->k * l->modulus));
}

/* phi in another layer, whose k w is `ratio` times less. */
static double refract(double phi, double ratio) {
  const double turn = floor(phi / PI + 0.5) * PI; /* so that the rest has a positive cosine */
  return turn + atan(ratio * tan(phi - turn));
}

static double phase(const strata *s, double lambda) {
  double phi = s->drained[0] ? 0.0 : 0.5 * PI;
  for (int i = 0; i < s->count; i++) {
    const stratum *l = &s->layer[i], *next = l + 1;
    const double w = wave_number(l, lambda);
    phi += w * l->thickness;
    if (i + 1 < s->count) phi = refract(phi, next->k * wave_number(next, lambda) / (l->k * w));
  }
  return phi;
}

static double eigenvalue(const strata *s, int n) {
  const double goal = s->drained[1] ? (n + 1) * PI : (n + 0.5) * PI;
  double low = 0.0, high = 1.0;
  while (phase(s, high) < goal) high *= 2.0;
  for (int k = 0; k < 200 && high - low > 1e-15 * high; k++) {
    const double middle = 0.5 * (low + high);
    if (phase(s, middle) < goal)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

/* R and k dR/dz. */
typedef struct state {
  double value, flow;
} state;

static state top_of(const strata *s) {
  return s->drained[0] ? (state){0.0, 1.0} : (state){1.0, 0.0};
}

static state below(const stratum *l, double lambda, state at, double distance) {
  const double w = wave_number(l, lambda), kw = l->k * w, c = cos(w * distance),
               d = sin(w * distance);
  return (state){at.value * c + at.flow / kw * d, -at.value * kw * d + at.flow * c};
}

/* Integral of R^2/M' over a layer. */
static double square(const stratum *l, double lambda, state at) {
  const double w = wave_number(l, lambda), h = l->thickness, b = at.flow / (l->k * w);
  const double wave = sin(2.0 * w * h) / (4.0 * w), both = sin(w * h) * sin(w * h) / w;
  return (at.value * at.value * (0.5 * h + wave) + b * b * (0.5 * h - wave) + at.value * b * both) /
         l->modulus;
}

void strata_solve(strata *s) {
  for (int n = 0; n < STRATA_TERMS; n++) {
    const double lambda = eigenvalue(s, n);
    const state top = top_of(s);
    state at = top;
    double squares = 0.0;
    for (int i = 0; i < s->count; i++) {
      squares += square(&s->layer[i], lambda, at);
      at = below(&s->layer[i], lambda, at, s->layer[i].thickness);
    }
    const double sum = (top.flow - at.flow) / lambda; /* of R/M' */
    s->lambda[n] = lambda;
    s->weight[n] = sum / squares;
    s->mean[n] = sum * sum / squares;
  }
}

static double shape(const strata *s, double lambda, double depth) {
  state at = top_of(s);
  for (int i = 0; i < s->count; i++) {
    const stratum *l = &s->layer[i];
    if (depth <= l->thickness || i + 1 == s->count) return below(l, lambda, at, depth).value;
    at = below(l, lambda, at, l->thickness);
    depth -= l->thickness;
  }
  return 0.0;
}

/* What is left at T of a load that grew within `ramp`. */
static double left(double lambda, double T, double ramp) {
  if (!(ramp > 0.0)) return exp(-lambda * T);
  const double since = fmin(T, ramp);
  return exp(-lambda * (T - since)) * -expm1(-lambda * since) / (lambda * ramp);
}

double strata_pressure(const strata *s, double depth, double T, double ramp) {
  double u = 0.0;
  for (int n = 0; n < STRATA_TERMS; n++)
    u += s->weight[n] * shape(s, s->lambda[n], depth) * left(s->lambda[n], T, ramp);
  return u;
}

double strata_degree(const strata *s, double T, double ramp) {
  double degree = ramp > 0.0 ? fmin(1.0, T / ramp) : 1.0;
  for (int n = 0; n < STRATA_TERMS; n++) degree -= s->mean[n] * left(s->lambda[n], T, ramp);
  return degree;
}
