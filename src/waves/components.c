/* components.c - the linear components of a sea on the grid of frequencies n/repeat: a regular
 * wave; spectra S(f), a = (2 S df)^1/2, with random phases, random amplitudes or a focus; a record,
 * by its Fourier sums.
 *
 * JONSWAP: S ~ f^-5 exp(-5/4 (fp/f)^4) gamma^exp(-(f/fp - 1)^2/(2 s^2)), s .07 up to fp and .09
 * above; gamma 1 is the spectrum of Pierson and Moskowitz. The sum over the band has Hm0^2/16.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "dispersion.h"
#include "waves_private.h"

#define USUAL_WAVES 100.0 /* periods of `repeat` */

/* ---- random numbers -------------------------------------------------------------------------- */

/* In (0, 1), of a seed and a number: the finaliser of splitmix64. */
static double draw(int64_t seed, int64_t number) {
  uint64_t z = (uint64_t)seed * UINT64_C(0x9e3779b97f4a7c15) +
               (uint64_t)number * UINT64_C(0xd1b54a32d192ed03);
  for (int round = 0; round < 2; round++) {
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    z ^= z >> 31;
  }
  return ((double)(z >> 11) + 0.5) * 0x1p-53;
}

/* ---- spectra --------------------------------------------------------------------------------- */

static double table_density(const mps_waves_def *def, double f) {
  if (f < def->frequency[0] || f > def->frequency[def->count - 1]) return 0.0;
  int64_t low = 0, high = def->count - 1;
  while (high - low > 1) {
    const int64_t middle = low + (high - low) / 2;
    *(def->frequency[middle] <= f ? &low : &high) = middle;
  }
  const double part = (f - def->frequency[low]) / (def->frequency[high] - def->frequency[low]);
  return (1.0 - part) * def->density[low] + part * def->density[high];
}

/* Any scale. */
static double density(const mps_waves_def *def, double fp, double f) {
  if (def->kind == MPS_WAVES_SPECTRUM) return table_density(def, f);
  const double r = f / fp, width = r <= 1.0 ? 0.07 : 0.09;
  const double peak = exp(-0.5 * (r - 1.0) * (r - 1.0) / (width * width));
  const double gamma = def->kind == MPS_WAVES_JONSWAP ? def->gamma : 1.0;
  return pow(r, -5.0) * exp(-1.25 * pow(r, -4.0)) * pow(gamma, peak);
}

static double table_peak(const mps_waves_def *def) {
  int64_t best = 0;
  for (int64_t k = 1; k < def->count; k++)
    if (def->density[k] > def->density[best]) best = k;
  return def->frequency[best];
}

/* ---- components ------------------------------------------------------------------------------ */

static mps_status reserve(mps_waves *w, int64_t count) {
  const int64_t most = w->def.theory == MPS_WAVES_THEORY_SECOND ? 1024 : 4096;
  const char *function = "mps_waves_create";
  if (count < 1)
    return mpsi_fail(
        w->context, function, MPS_ERROR_ARGUMENT,
        "lower, upper and repeat leave no component: there is no multiple of 1/repeat = "
        "%g Hz in the band",
        1.0 / w->repeat);
  if (count > most)
    return mpsi_fail(w->context, function, MPS_ERROR_ARGUMENT,
                     "repeat of %g s makes %lld components, allowed are %lld with this theory",
                     w->repeat, (long long)count, (long long)most);
  w->wave = mpsi_alloc(w->context, count, sizeof *w->wave);
  if (!w->wave) return mpsi_fail_memory(w->context, function, (size_t)count * sizeof *w->wave);
  w->count = count;
  return MPS_OK;
}

/* Frequencies n/repeat within the band about the frequency fp. */
static mps_status make_band(mps_waves *w, double fp, int64_t *first) {
  const double low = ceil(w->def.lower * fp * w->repeat * (1.0 - 1e-9));
  const double high = floor(w->def.upper * fp * w->repeat * (1.0 + 1e-9));
  *first = low < 1.0 ? 1 : (int64_t)fmin(low, 1e9);
  return reserve(w, (int64_t)fmin(high, 2e9) - *first + 1);
}

/* Wave numbers and transfers, once bins are known. */
static mps_status complete(mps_waves *w) {
  for (int64_t n = 0; n < w->count; n++) {
    mpsi_wave *wave = &w->wave[n];
    const double f = (double)wave->bin / w->repeat;
    MPSI_TRY(mpsi_waves_check_range(w->context, "mps_waves_create", 1.0 / f, w->def.depth,
                                    w->def.gravity));
    wave->omega = 2.0 * MPSI_WAVES_PI * f;
    const double y = wave->omega * wave->omega * w->def.depth / w->def.gravity;
    const double kd = mpsi_waves_depths(y);
    wave->k = kd / w->def.depth;
    wave->far = mpsi_waves_far(kd);
    wave->near = mpsi_waves_near(y);
  }
  return MPS_OK;
}

static mps_status make_regular(mps_waves *w) {
  w->period = w->repeat = w->def.period;
  MPSI_TRY(reserve(w, 1));
  w->wave[0].bin = 1;
  w->wave[0].a = 0.5 * w->def.height;
  return complete(w);
}

/* Energies s (m2, a^2/2) to amplitudes. */
static void combine(mps_waves *w, const double *s) {
  const mps_waves_def *d = &w->def;
  double sum = 0.0;
  for (int64_t n = 0; n < w->count; n++) sum += s[n];
  for (int64_t n = 0; n < w->count; n++) {
    mpsi_wave *wave = &w->wave[n];
    const double phase = 2.0 * MPSI_WAVES_PI * draw(d->seed, 2 * wave->bin);
    double a = sqrt(2.0 * s[n]);
    if (d->phases == MPS_WAVES_PHASES_AMPLITUDES) a *= sqrt(-log(draw(d->seed, 2 * wave->bin + 1)));
    if (d->phases == MPS_WAVES_PHASES_FOCUSED)
      wave->a = d->crest * s[n] / sum * cexp(I * (wave->k * d->position - wave->omega * d->time));
    else
      wave->a = a * cexp(I * phase);
  }
}

static mps_status make_spectrum(mps_waves *w, const mps_waves_def *def) {
  const double fp = isnan(def->period) ? table_peak(def) : 1.0 / def->period;
  int64_t first = 0;
  w->period = 1.0 / fp;
  w->repeat = isnan(def->repeat) ? USUAL_WAVES / fp : def->repeat;
  MPSI_TRY(make_band(w, fp, &first));
  double *s = mpsi_alloc(w->context, w->count, sizeof *s), sum = 0.0;
  if (!s) return mpsi_fail_memory(w->context, "mps_waves_create", (size_t)w->count * sizeof *s);
  for (int64_t n = 0; n < w->count; n++) {
    w->wave[n].bin = first + n;
    s[n] = density(def, fp, (double)(first + n) / w->repeat) / w->repeat;
    sum += s[n];
  }
  mps_status status = complete(w);
  if (status == MPS_OK && !(sum > 0.0 && isfinite(sum)))
    status = mpsi_fail(w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
                       "density has a sum of %g m2 over the band, must be finite and > 0", sum);
  /* FOCUSED takes its size from the crest; the height's square may underflow */
  const double energy = def->height * def->height / 16.0, scale = energy / sum;
  const bool focused = def->phases == MPS_WAVES_PHASES_FOCUSED;
  for (int64_t n = 0; n < w->count && status == MPS_OK && !isnan(def->height); n++)
    if (scale > 1e-200 && scale < 1e200)
      s[n] *= scale;
    else if (!focused)
      s[n] = s[n] / sum * energy;
  if (status == MPS_OK) combine(w, s);
  mpsi_free(w->context, s);
  return status;
}

/* ---- a record -------------------------------------------------------------------------------- */

/* The amplitude of bin n: 2/samples times sum eta exp(-i omega t), by a rotation each sample. */
static double complex fourier(const mps_waves_def *def, double repeat, int64_t bin) {
  const double omega = 2.0 * MPSI_WAVES_PI * (double)bin / repeat;
  const double step = repeat / (double)def->samples;
  double complex sum = 0.0;
  for (int64_t k = 0; k < def->samples; k++) {
    const double angle = omega * (def->times[0] + step * (double)k);
    sum += def->levels[k] * (cos(angle) - I * sin(angle));
  }
  return 2.0 / (double)def->samples * sum;
}

/* Without a period given: of the largest of all. */
static double record_peak(const mps_waves_def *def, double repeat) {
  const int64_t most = def->samples / 2 < 4096 ? def->samples / 2 : 4096;
  double best = 0.0;
  int64_t at = 1;
  for (int64_t n = 1; n < most; n++) {
    const double a = cabs(fourier(def, repeat, n));
    if (a > best) best = a, at = n;
  }
  return (double)at / repeat;
}

static mps_status make_record(mps_waves *w, const mps_waves_def *def) {
  const int64_t n = def->samples;
  w->repeat = (def->times[n - 1] - def->times[0]) * (double)n / (double)(n - 1);
  const double fp = isnan(def->period) ? record_peak(def, w->repeat) : 1.0 / def->period;
  int64_t first = 0;
  w->period = 1.0 / fp;
  MPSI_TRY(make_band(w, fp, &first));
  if (2 * (first + w->count - 1) >= n)
    return mpsi_fail(
        w->context, "mps_waves_create", MPS_ERROR_ARGUMENT,
        "samples is %lld: too few for the frequency %g Hz of upper, more than %lld are "
        "needed",
        (long long)n, (double)(first + w->count - 1) / w->repeat,
        (long long)(2 * (first + w->count - 1)));
  for (int64_t k = 0; k < w->count; k++) w->wave[k].bin = first + k;
  mps_status status = complete(w);
  for (int64_t k = 0; status == MPS_OK && k < w->count; k++)
    w->wave[k].a = fourier(def, w->repeat, first + k) * cexp(I * w->wave[k].k * def->position);
  return status;
}

mps_status mpsi_waves_make_components(mps_waves *w, const mps_waves_def *def) {
  if (def->kind == MPS_WAVES_REGULAR) return make_regular(w);
  if (def->kind == MPS_WAVES_RECORD) return make_record(w, def);
  return make_spectrum(w, def);
}
