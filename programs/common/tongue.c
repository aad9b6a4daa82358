/* tongue.c - the tongue of water that climbs a slope: its end is thinner than a spacing, so it is
 * measured where it is resolved and continued from there. SPDX-License-Identifier: BSD-3-Clause */
#include "tongue.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

enum { THICKEST = 6, LEAST_POINTS = 4 }; /* spacings; bins of the line */

/* Thickness (m) of the water in bins of 2 l0 along the slope from its foot. A particle is a length
 * l0 of a layer of thickness l0. */
static void find_thickness(const mps_view *x, const tongue_slope *s, double l0, int64_t bins,
                           double *thickness) {
  const double c = cos(s->angle), d = sin(s->angle);
  for (int64_t i = 0; i < x->shape[0]; i++) {
    const double at[2] = {*mps_view_f64(x, i, 0) - s->foot[0], *mps_view_f64(x, i, 1) - s->foot[1]};
    const double along = at[0] * c + at[1] * d;
    if (at[1] * c - at[0] * d < 0.0) continue; /* below the slope: behind its upper end */
    const double from = 0.5 * (along / l0 - 0.5), to = 0.5 * (along / l0 + 0.5);
    if (!(to > 0.0)) continue;
    for (int64_t k = (int64_t)fmax(floor(from), 0.0); k < bins && (double)k < to; k++)
      thickness[k] += l0 * (fmin(to, (double)k + 1.0) - fmax(from, (double)k));
  }
}

/* As far as there is water within two spacings of the slope without a gap of two bins. */
static double find_layer(const mps_view *x, const tongue_slope *s, double l0, int64_t bins,
                         double *layer) {
  const double c = cos(s->angle), d = sin(s->angle);
  int64_t gap = 0;
  double last = 0.0;
  for (int64_t k = 0; k < bins; k++) layer[k] = -INFINITY;
  for (int64_t i = 0; i < x->shape[0]; i++) {
    const double at[2] = {*mps_view_f64(x, i, 0) - s->foot[0], *mps_view_f64(x, i, 1) - s->foot[1]};
    const double along = at[0] * c + at[1] * d, off = at[1] * c - at[0] * d;
    const double bin = floor(0.5 * along / l0);
    if (off >= 0.0 && off < 2.0 * l0 && bin >= 0.0 && bin < (double)bins)
      layer[(int64_t)bin] = fmax(layer[(int64_t)bin], along + 0.5 * l0);
  }
  for (int64_t k = 0; k < bins && gap < 2; k++) {
    gap = layer[k] > 0.0 ? 0 : gap + 1;
    last = fmax(last, layer[k]);
  }
  return last;
}

static void continue_line(const double *thickness, int64_t bins, double l0, tongue *out) {
  int64_t end = 0, begin;
  double sum[2] = {0.0, 0.0}, xx = 0.0, xy = 0.0;
  while (end < bins && thickness[end] >= l0) end++;
  for (begin = end; begin > 0 && thickness[begin - 1] <= THICKEST * l0;) begin--;
  const double n = (double)(end - begin);
  for (int64_t k = begin; k < end; k++)
    sum[0] += (double)(2 * k + 1) * l0 / n, sum[1] += thickness[k] / n;
  for (int64_t k = begin; k < end; k++) {
    const double x = (double)(2 * k + 1) * l0 - sum[0];
    xx += x * x, xy += x * thickness[k];
  }
  if (end - begin < LEAST_POINTS || !(xy < 0.0)) return;
  const double resolved = 2.0 * (double)end * l0, zero = sum[0] - sum[1] * xx / xy;
  if (zero - resolved > 2.0 * (double)(end - begin) * l0) return; /* a bore, not a tongue */
  out->resolved = resolved, out->end = zero;
}

bool tongue_find(mps_particles *water, const tongue_slope *slope, double spacing, tongue *out) {
  const int64_t bins = (int64_t)(0.5 * slope->length / spacing);
  double *thickness = calloc((size_t)bins + 1, sizeof *thickness);
  mps_view x;
  *out = (tongue){-INFINITY, -INFINITY, 0.0};
  if (!thickness) return false;
  if (mps_particles_view(water, "position", &x) == MPS_OK) {
    find_thickness(&x, slope, spacing, bins, thickness);
    continue_line(thickness, bins, spacing, out);
    out->layer = find_layer(&x, slope, spacing, bins, thickness);
  }
  free(thickness);
  return true;
}
