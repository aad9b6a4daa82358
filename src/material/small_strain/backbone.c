/* backbone.c - the definition of the small-strain law, and the layers whose sum follows its
 * backbone tau = G0 gamma/(1 + (gamma/gamma_r)^a) (Hardin & Drnevich 1972 with a = 1; Darendeli
 * 2001) up to the strength: straight pieces between points that lie above the curve by a fraction
 * e, and whose chords lie below it by e at most. A chord over dx of the curve t(x), x =
 * gamma/gamma_r, errs by -t'' dx^2/8; so the points are evenly spaced in the integral W of
 * sqrt(-t''/t) dx, and with n points the fraction is e = (W/(n - 1))^2/16. The first point is where
 * the line of G0 leaves (1 + e) t(x), the last where that reaches the strength. A layer yields at
 * each point, where the slope falls. SPDX-License-Identifier: BSD-3-Clause */
#include "core/definition/digits.h"
#include "material/constants.h"

#include <mps/soil.h>
#include <mps/experimental/soil.h>

enum { TABLE = 4000 }; /* intervals of ln x in the integral */
#define LEAST_SHARE 0.05 /* of G0 gamma_r: least strength */
#define FARTHEST 1000.0  /* x at which the largest strength of a curve without a limit is taken */

/* ---- the curve ------------------------------------------------------------------------------- */

/* Stress over G0 gamma_r. */
static double curve(double a, double x) { return x / (1.0 + pow(x, a)); }

/* d W/d ln x. */
static double density(double a, double x) {
  const double y = pow(x, a);
  return sqrt(a * y * (1.0 + a + (1.0 - a) * y)) / (1.0 + y);
}

/* x at which the curve reaches `share`, below its limit. */
static double reach(double a, double share) {
  double low = -30.0, high = 30.0; /* ln x */
  for (int i = 0; i < 200 && high - low > 1e-14; i++) {
    const double middle = 0.5 * (low + high);
    if (curve(a, exp(middle)) < share)
      low = middle;
    else
      high = middle;
  }
  return exp(0.5 * (low + high));
}

/* Interval k of the integral, of the length `step` of ln x. */
static double part_of(double a, double first, double step, int k) {
  return step * density(a, first * exp((k + 0.5) * step));
}

/* W between the ends. */
static double integrate(double a, double first, double last) {
  const double step = log(last / first) / TABLE;
  double sum = 0.0;
  for (int k = 0; k < TABLE; k++) sum += part_of(a, first, step, k);
  return sum;
}

typedef struct polygon {
  double error, first, last; /* e; x of the first and last point */
  double x[MPSI_LAYERS];
} polygon;

static polygon between(double a, double share, double error) {
  return (polygon){
      .error = error, .first = pow(error, 1.0 / a), .last = reach(a, share / (1.0 + error))};
}

/* The points for a strength of `share` times G0 gamma_r. */
static polygon find_points(double a, double share) {
  double low = 1e-6, high = 0.05, all = 0.0;
  polygon p = between(a, share, high);
  for (int i = 0; i < 60; i++) {
    const double middle = sqrt(low * high);
    p = between(a, share, middle);
    if (p.last > p.first) all = integrate(a, p.first, p.last);
    const double part = p.last > p.first ? all / (MPSI_LAYERS - 1) : 0.0;
    if (part * part / 16.0 > middle)
      low = middle;
    else
      high = middle;
  }
  const double step = log(p.last / p.first) / TABLE;
  all = integrate(a, p.first, p.last);
  double from = 0.0, to = part_of(a, p.first, step, 0); /* sums at both ends of interval k */
  for (int i = 0, k = 0; i < MPSI_LAYERS; i++) {
    const double wanted = all * i / (MPSI_LAYERS - 1);
    for (; k < TABLE - 1 && to < wanted; from = to, to = from + part_of(a, p.first, step, k)) k++;
    p.x[i] = p.first * exp(step * (k + (wanted - from) / (to - from)));
  }
  p.x[0] = p.first, p.x[MPSI_LAYERS - 1] = p.last;
  return p;
}

/* Each layer takes the fall of the slope at its point, and yields there. */
static void set_layers(mpsi_law *law, double a, double share, double strain) {
  const polygon p = find_points(a, share);
  double slope = 1.0, left = 0.0, borne = 0.0;
  for (int i = 0; i < MPSI_LAYERS; i++) {
    const bool last = i == MPSI_LAYERS - 1;
    const double now = i == 0 ? p.x[0] : (1.0 + p.error) * curve(a, p.x[i]);
    const double next = last ? now : (1.0 + p.error) * curve(a, p.x[i + 1]);
    const double after = last ? 0.0 : (next - now) / (p.x[i + 1] - p.x[i]);
    /* the last layer makes up the sums to the last bits */
    law->layer_shear[i] = last ? law->shear - left : (slope - after) * law->shear;
    law->layer_strength[i] =
        last ? share * strain * law->shear - borne : law->layer_shear[i] * p.x[i] * strain;
    left += law->layer_shear[i];
    borne += law->layer_strength[i];
    slope = after;
  }
}

/* ---- the definition -------------------------------------------------------------------------- */

static mps_status check_strength(mps_context *context, const char *function,
                                 const mps_material_small_strain_def *d) {
  const double unit = d->shear_modulus * d->reference_strain;
  const double most = d->curvature == 1.0 ? 1.0 : curve(d->curvature, FARTHEST);
  if (isnan(d->strength)) return MPS_OK;
  const double low = LEAST_SHARE * unit, high = most * unit * (1.0 + 1e-12);
  if (d->strength >= low && d->strength <= high) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "strength is %s Pa, must be %g to %g Pa: 0.05 to %g times shear_modulus times "
                   "reference_strain",
                   mpsi_outside(d->strength, low, high).text, low, most * unit, most);
}

mps_status mpsi_define_small_strain(mps_context *context, const char *function, const void *values,
                                    mpsi_law *law) {
  const mps_material_small_strain_def *d = values;
  MPSI_TRY(check_strength(context, function, d));
  *law = mpsi_law_elastic(2.0 * d->shear_modulus * (1.0 + d->poisson), d->poisson);
  const double unit = d->shear_modulus * d->reference_strain;
  set_layers(law, d->curvature, isnan(d->strength) ? 1.0 : d->strength / unit, d->reference_strain);
  return MPS_OK;
}
