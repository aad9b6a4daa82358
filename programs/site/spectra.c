/* spectra.c - response spectra by the exact solution between samples (Nigam and Jennings 1969), and
 * Fourier amplitudes. SPDX-License-Identifier: BSD-3-Clause */
#include "site.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- response -------------------------------------------------------------------------------- */

/* An oscillator w, h over a step with an acceleration of the ground that is linear in time:
 * x'' + 2 h w x' + w^2 x = -(a + b t). Its particular solution is p + q t. */
typedef struct oscillator {
  double w, h, wd, decay, sine, cosine, step;
} oscillator;

static oscillator make_oscillator(double period, double damping, double step) {
  const double w = 2.0 * PI / period, wd = w * sqrt(1.0 - damping * damping);
  return (oscillator){w,   damping, wd, exp(-damping * w * step), sin(wd * step), cos(wd * step),
                      step};
}

static void advance(const oscillator *o, double a, double next, double *x, double *v) {
  const double w2 = o->w * o->w, q = -(next - a) / o->step / w2;
  const double p = -a / w2 - 2.0 * o->h * q / o->w;
  const double A = *x - p, B = (*v - q + o->h * o->w * A) / o->wd;
  const double moved = o->decay * (A * o->cosine + B * o->sine);
  *v = o->decay *
           ((o->wd * B - o->h * o->w * A) * o->cosine - (o->wd * A + o->h * o->w * B) * o->sine) +
       q;
  *x = moved + p + q * o->step;
}

double site_response(const double *a, int64_t count, double step, double period, double damping) {
  /* at least 20 points in a period, between which the largest value may lie */
  const int64_t parts = (int64_t)fmax(1.0, ceil(20.0 * step / period));
  const oscillator o = make_oscillator(period, damping, step / (double)parts);
  const int64_t rest = (int64_t)ceil(period / step); /* free motion behind the samples */
  double x = 0.0, v = 0.0, most = 0.0;
  for (int64_t k = 0; k + 1 < count + rest; k++) {
    const double from = k < count ? a[k] : 0.0, to = k + 1 < count ? a[k + 1] : 0.0;
    for (int64_t q = 0; q < parts; q++) {
      const double share = 1.0 / (double)parts;
      advance(&o, from + (to - from) * (double)q * share,
              from + (to - from) * (double)(q + 1) * share, &x, &v);
      most = fmax(most, fabs(x));
    }
  }
  return o.w * o.w * most;
}

/* ---- Fourier --------------------------------------------------------------------------------- */

static double amplitude(const double *a, int64_t count, double step, double frequency) {
  const double angle = 2.0 * PI * frequency * step;
  double real = 0.0, imaginary = 0.0;
  for (int64_t k = 0; k < count; k++)
    real += a[k] * cos(angle * (double)k), imaginary += a[k] * sin(angle * (double)k);
  return step * hypot(real, imaginary);
}

void site_transform(const site_series *s, double highest, site_fourier *out) {
  const double length = (double)s->count * s->step;
  out->step = fmax(1.0 / length, highest / SITE_FREQUENCIES);
  out->count = (int64_t)fmin(SITE_FREQUENCIES, floor(highest / out->step));
  for (int64_t k = 0; k < out->count; k++) {
    const double f = (double)(k + 1) * out->step;
    out->surface[k] = amplitude(s->surface, s->count, s->step, f);
    out->input[k] = amplitude(s->input, s->count, s->step, f);
  }
}

/* Root of the mean squares within 2.5 % of the frequency, at least with both neighbours. `exact` is
 * weighted as what it is compared with. */
void site_smooth(site_fourier *f) {
  static double surface[SITE_FREQUENCIES], input[SITE_FREQUENCIES], exact[SITE_FREQUENCIES];
  for (int64_t k = 0; k < f->count; k++) {
    const int64_t reach = (int64_t)fmax(1.0, 0.025 * (double)(k + 1));
    double sum[3] = {0.0};
    for (int64_t q = k - reach; q <= k + reach; q++) {
      if (q < 0 || q >= f->count) continue;
      const double weight = 1.0 - fabs((double)(q - k)) / (double)(reach + 1);
      sum[0] += weight * f->surface[q] * f->surface[q];
      sum[1] += weight * f->input[q] * f->input[q];
      sum[2] += weight * f->input[q] * f->input[q] * f->exact[q] * f->exact[q];
    }
    surface[k] = sqrt(sum[0]), input[k] = sqrt(sum[1]), exact[k] = sqrt(sum[2] / sum[1]);
  }
  memcpy(f->surface, surface, sizeof surface);
  memcpy(f->input, input, sizeof input);
  memcpy(f->exact, exact, sizeof exact);
}
