/* separation.c - incident and reflected waves from levels at several gauges: Mansard and Funke
 * (1980). At each frequency the Fourier amplitudes B_p at x_p are
 *
 *   B_p = a_i exp(-i k x_p) + a_r exp(i k x_p) + e_p,
 *
 * with the least sum |e_p|^2. The normal matrix {P, S; S*, P}, S = sum exp(2 i k x_p), is singular
 * where all gauges lie half a wavelength apart: frequencies with 1 - |S|^2/P^2 below a bound are
 * left out. SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"
#include "waves_private.h"

#define GAUGES 16
#define RESOLVED 0.05   /* least 1 - |S|^2/P^2 */
#define SMOOTHING 0.025 /* half the width of the smoothing of the peak, over the frequency */

/* ---- checks ---------------------------------------------------------------------------------- */

#define FUNCTION "mps_separation_find_sized"

static mps_status check_arrays(mps_context *context, const mps_separation_def *d) {
  for (int p = 0; p < d->gauges; p++) {
    for (int q = 0; q < p; q++)
      if (d->position[p] == d->position[q])
        return mpsi_fail(context, FUNCTION, MPS_ERROR_ARGUMENT,
                         "position[%d] and position[%d] are both %g m: gauges must lie apart", q, p,
                         d->position[p]);
  }
  for (int64_t k = 0; k < d->samples; k++) {
    for (int p = 0; p < d->gauges; p++)
      if (!(fabs(d->levels[k * d->gauges + p]) <= 1e12))
        return mpsi_fail(context, FUNCTION, MPS_ERROR_ARGUMENT,
                         "levels[%lld] (sample %lld of gauge %d) is %g m, must be within 1e12",
                         (long long)(k * d->gauges + p), (long long)k, p,
                         d->levels[k * d->gauges + p]);
  }
  return MPS_OK;
}

/* ---- the analysis ---------------------------------------------------------------------------- */

typedef struct analysis {
  const mps_separation_def *d;
  double from, to; /* s */
  int64_t count;   /* instants, evenly spaced over the window without its end */
  double *level;   /* gauges rows of `count` values, m, less their mean */
  int64_t first, bands;
  double *energy; /* of the incident waves at each band, a^2/2, m2 */
} analysis;

static mps_status find_window(mps_context *context, analysis *a) {
  const mps_separation_def *d = a->d;
  const double start = d->times[0], end = d->times[d->samples - 1];
  a->from = isnan(d->from) ? start : d->from, a->to = isnan(d->to) ? end : d->to;
  const double slack = 1e-9 * (end - start);
  if (!(a->from >= start - slack && a->to <= end + slack && a->to > a->from))
    return mpsi_fail(context, FUNCTION, MPS_ERROR_ARGUMENT,
                     "from and to of the separation are %g and %g s, must be ascending and within "
                     "times, %g to %g s",
                     a->from, a->to, start, end);
  const double span = a->to - a->from, interval = (end - start) / (double)(d->samples - 1);
  a->count = (int64_t)ceil(span / interval);
  a->first = (int64_t)ceil(d->lower * span * (1.0 - 1e-9));
  if (a->first < 1) a->first = 1;
  const double last = floor(d->upper * span * (1.0 + 1e-9));
  if (2.0 * last >= (double)a->count)
    return mpsi_fail(
        context, FUNCTION, MPS_ERROR_ARGUMENT,
        "upper of the separation is %g Hz, must be below half the rate of times, %g Hz", d->upper,
        0.5 / interval);
  a->bands = (int64_t)last - a->first + 1;
  if (a->bands < 1)
    return mpsi_fail(context, FUNCTION, MPS_ERROR_ARGUMENT,
                     "lower and upper of the separation, %g and %g Hz, have no multiple of 1/%g s "
                     "between them",
                     d->lower, d->upper, span);
  for (int k = 0; k < 2; k++) {
    const double f = (double)(k ? a->first + a->bands - 1 : a->first) / span;
    MPSI_TRY(mpsi_waves_check_range(context, FUNCTION, 1.0 / f, d->depth, d->gravity));
  }
  return MPS_OK;
}

static void resample(analysis *a) {
  const mps_separation_def *d = a->d;
  const double step = (a->to - a->from) / (double)a->count;
  for (int p = 0; p < d->gauges; p++) {
    double *level = a->level + p * a->count, mean = 0.0;
    int64_t k = 0;
    for (int64_t n = 0; n < a->count; n++) {
      const double t = a->from + step * (double)n;
      while (k < d->samples - 2 && d->times[k + 1] <= t) k++;
      const double part = (t - d->times[k]) / (d->times[k + 1] - d->times[k]);
      level[n] =
          (1.0 - part) * d->levels[k * d->gauges + p] + part * d->levels[(k + 1) * d->gauges + p];
      mean += level[n] / (double)a->count;
    }
    for (int64_t n = 0; n < a->count; n++) level[n] -= mean;
  }
}

/* 2/count sum eta exp(-i omega (t - from)), by rotations of blocks of 64. */
static double complex fourier(const double *level, int64_t count, int64_t bin) {
  const double turn = 2.0 * MPSI_WAVES_PI * (double)bin / (double)count;
  const double complex step = cexp(-I * turn);
  double complex sum = 0.0, at = 1.0;
  for (int64_t n = 0; n < count; n++) {
    if (n % 64 == 0) at = cexp(-I * turn * (double)n);
    sum += level[n] * at;
    at *= step;
  }
  return 2.0 / (double)count * sum;
}

typedef struct band {
  double complex incident, reflected; /* m */
  double total, residual;             /* m2, mean over the gauges of |B|^2/2 and |e|^2/2 */
  bool resolved;
} band;

static band separate(const analysis *a, int64_t bin) {
  const mps_separation_def *d = a->d;
  const double omega = 2.0 * MPSI_WAVES_PI * (double)bin / (a->to - a->from);
  const double k = mpsi_waves_depths(omega * omega * d->depth / d->gravity) / d->depth;
  const double P = d->gauges;
  double complex B[GAUGES], S = 0.0, in = 0.0, out = 0.0;
  band b = {.resolved = false};
  for (int p = 0; p < d->gauges; p++) {
    const double complex go = cexp(I * k * (d->position[p] - d->position[0]));
    B[p] = fourier(a->level + p * a->count, a->count, bin);
    S += go * go, in += B[p] * go, out += B[p] * conj(go);
    b.total += 0.5 * creal(B[p] * conj(B[p])) / P;
  }
  const double determinant = P * P - creal(S * conj(S));
  if (determinant < RESOLVED * P * P) return b;
  b.resolved = true;
  b.incident = (P * in - S * out) / determinant;
  b.reflected = (P * out - conj(S) * in) / determinant;
  for (int p = 0; p < d->gauges; p++) {
    const double complex go = cexp(I * k * (d->position[p] - d->position[0]));
    const double complex e = B[p] - b.incident * conj(go) - b.reflected * go;
    b.residual += 0.5 * creal(e * conj(e)) / P;
  }
  return b;
}

/* Frequency of the peak of the energies, smoothed by a running mean. */
static double find_peak(const analysis *a) {
  double best = -1.0, at = NAN;
  for (int64_t n = 0; n < a->bands; n++) {
    const int64_t half = (int64_t)(SMOOTHING * (double)(a->first + n));
    double sum = 0.0, moment = 0.0;
    for (int64_t m = n - half; m <= n + half; m++)
      if (m >= 0 && m < a->bands) sum += a->energy[m], moment += a->energy[m] * (double)m;
    const double mean = sum / (double)(2 * half + 1);
    if (mean > best && sum > 0.0) best = mean, at = ((double)a->first + moment / sum);
  }
  return at / (a->to - a->from);
}

static void add_up(const analysis *a, double incident, double reflected, double total,
                   double residual, mps_separation *out) {
  double moment = 0.0;
  for (int64_t n = 0; n < a->bands; n++)
    moment += a->energy[n] * (a->to - a->from) / (double)(a->first + n);
  out->incident_height = 4.0 * sqrt(incident);
  out->reflected_height = 4.0 * sqrt(reflected);
  out->reflection = incident > 0.0 ? sqrt(reflected / incident) : NAN;
  out->peak_period = incident > 0.0 ? 1.0 / find_peak(a) : NAN;
  out->energy_period = incident > 0.0 ? moment / incident : NAN;
  out->residual = total > 0.0 ? residual / total : 0.0;
  out->bands = a->bands;
}

/* Rows of the caller, `capacity` values each; NULL: not wanted. */
typedef struct rows {
  int64_t capacity;
  double *frequency, *incident, *reflected;
} rows;

/* Waves of all bands: amplitudes to `to`, sums to `out`. */
static void separate_bands(analysis *a, const rows *to, mps_separation *out) {
  double in = 0.0, back = 0.0, total = 0.0, residual = 0.0;
  for (int64_t n = 0; n < a->bands; n++) {
    const band b = separate(a, a->first + n);
    out->unresolved += !b.resolved;
    a->energy[n] = 0.5 * creal(b.incident * conj(b.incident));
    in += a->energy[n], back += 0.5 * creal(b.reflected * conj(b.reflected));
    if (b.resolved) total += b.total, residual += b.residual;
    if (n >= to->capacity) continue;
    if (to->frequency) to->frequency[n] = (double)(a->first + n) / (a->to - a->from);
    if (to->incident) to->incident[n] = cabs(b.incident);
    if (to->reflected) to->reflected[n] = cabs(b.reflected);
  }
  add_up(a, in, back, total, residual, out);
}

mps_status mps_separation_find_sized(mps_context *context, const mps_separation_def *user_def,
                                     int64_t capacity, int64_t *count, double *frequency,
                                     double *incident, double *reflected, mps_separation *out,
                                     size_t size) {
  if (!context) return mpsi_null(__func__, "context");
  if (!user_def) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "def is NULL");
  if (capacity < 0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  mps_separation_def def = mps_separation_defaults();
  mps_separation result = {0};
  analysis a = {.d = &def};
  MPSI_TRY(MPSI_DEF_READ(context, __func__, mps_separation_def, user_def, &def));
  MPSI_TRY(mpsi_out_check(context, __func__, out, size));
  MPSI_TRY(check_arrays(context, &def));
  MPSI_TRY(find_window(context, &a));
  a.level = mpsi_alloc(context, a.count * def.gauges, sizeof *a.level);
  if (a.level) a.energy = mpsi_alloc(context, a.bands, sizeof *a.energy);
  if (!a.level || !a.energy) {
    MPSI_FREE(context, a.level, a.energy);
    return mpsi_fail_memory(context, __func__, (size_t)(a.count * def.gauges) * sizeof *a.level);
  }
  resample(&a);
  separate_bands(&a, &(rows){capacity, frequency, incident, reflected}, &result);
  if (count) *count = a.bands;
  MPSI_FREE(context, a.level, a.energy);
  return mpsi_out_write(context, __func__, out, size, &result, sizeof result);
}
