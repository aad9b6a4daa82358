/* motion.c - a sea in time: the motion of the piston with its ramp, the level there, and levels at
 * any station. First order: X = Re A/(i c0) exp(i omega t), c0 the transfer of Biesel and Suquet;
 * the level at the piston has the evanescent modes besides, C X. The second order rises with the
 * square of the ramp. SPDX-License-Identifier: BSD-3-Clause */
#include "waves_private.h"

#include <string.h>

/* Rise from 0 to 1 over the ramp with its two derivatives: 10 s^3 - 15 s^4 + 6 s^5. */
static void rise(const mps_waves *w, double t, double r[3]) {
  r[0] = t >= w->ramp && t >= 0.0 ? 1.0 : 0.0;
  r[1] = r[2] = 0.0;
  if (!(t > 0.0 && t < w->ramp)) return;
  const double s = t / w->ramp, q = 1.0 - s;
  r[0] = s * s * s * (10.0 + s * (6.0 * s - 15.0));
  r[1] = 30.0 * s * s * q * q / w->ramp;
  r[2] = 60.0 * s * q * (q - s) / (w->ramp * w->ramp);
}

/* motion += r f with f, f', f''. */
static void multiply(const double r[3], const double f[3], double motion[3]) {
  motion[0] += r[0] * f[0];
  motion[1] += r[0] * f[1] + r[1] * f[0];
  motion[2] += r[0] * f[2] + 2.0 * r[1] * f[1] + r[2] * f[0];
}

/* Sum of the bins at time t: value and two derivatives. */
static void sum_bins(const mps_waves *w, const double complex *bin, double t, double f[3]) {
  const double step = 2.0 * MPSI_WAVES_PI / w->repeat, turns = t / w->repeat;
  const double angle = 2.0 * MPSI_WAVES_PI * (turns - floor(turns));
  for (int64_t n = 1; n <= w->bins; n++) {
    if (bin[n] == 0.0) continue;
    const double omega = step * (double)n, C = cos(angle * (double)n), S = sin(angle * (double)n);
    const double in = creal(bin[n]) * C - cimag(bin[n]) * S;
    const double out = creal(bin[n]) * S + cimag(bin[n]) * C;
    f[0] += in, f[1] -= omega * out, f[2] -= omega * omega * in;
  }
}

void mpsi_waves_move(const mps_waves *w, double t, const double complex *eta, double motion[4]) {
  double first[3] = {0.0}, second[3] = {0.0}, bound[3] = {0.0}, r[3], level = 0.0;
  for (int c = 0; c < 4; c++) motion[c] = 0.0;
  if (t < 0.0) return;
  if (w->solitary > 0.0) {
    mpsi_waves_move_solitary(w, t, motion);
    return;
  }
  for (int64_t n = 0; n < w->count; n++) {
    const mpsi_wave *wave = &w->wave[n];
    const double C = cos(wave->omega * t), S = sin(wave->omega * t);
    const double in = creal(wave->a) * C - cimag(wave->a) * S;  /* Re A exp(i omega t) */
    const double out = creal(wave->a) * S + cimag(wave->a) * C; /* Im, and Re of A/i */
    first[0] += out / wave->far, first[1] += wave->omega * in / wave->far;
    first[2] -= wave->omega * wave->omega * out / wave->far;
    level += in + wave->near * out / wave->far;
  }
  if (w->bins > 0) sum_bins(w, w->push, t, second);
  if (eta) sum_bins(w, eta, t, bound);
  rise(w, t, r);
  multiply(r, first, motion);
  const double r2[3] = {r[0] * r[0], 2.0 * r[0] * r[1], 2.0 * (r[1] * r[1] + r[0] * r[2])};
  multiply(r2, second, motion);
  motion[3] = r[0] * level + r2[0] * bound[0];
}

/* Adds Re A exp(i omega t) and two derivatives at evenly spaced times, by a rotation each. */
static void add_evenly(double complex a, double omega, double t, double step, int64_t count,
                       double (*f)[3]) {
  const double complex turn = cexp(I * omega * step);
  double x = creal(a * cexp(I * omega * t)), y = cimag(a * cexp(I * omega * t));
  const double c = creal(turn), s = cimag(turn);
  for (int64_t k = 0; k < count; k++) {
    f[k][0] += x, f[k][1] -= omega * y, f[k][2] -= omega * omega * x;
    const double next = c * x - s * y;
    y = s * x + c * y, x = next;
  }
}

void mpsi_waves_move_evenly(const mps_waves *w, double t, double step, int64_t count,
                            double (*motion)[3]) {
  double first[MPSI_WAVES_BLOCK][3], second[MPSI_WAVES_BLOCK][3], r[3], all[4];
  for (int64_t k = 0; w->solitary > 0.0 && k < count; k++) {
    mpsi_waves_move(w, t + step * (double)k, NULL, all);
    memcpy(motion[k], all, sizeof motion[k]);
  }
  if (w->solitary > 0.0) return;
  memset(first, 0, sizeof first);
  memset(second, 0, sizeof second);
  for (int64_t n = 0; n < w->count; n++)
    add_evenly(w->wave[n].a / (I * w->wave[n].far), w->wave[n].omega, t, step, count, first);
  for (int64_t n = 1; n <= w->bins; n++)
    if (w->push[n] != 0.0)
      add_evenly(w->push[n], 2.0 * MPSI_WAVES_PI * (double)n / w->repeat, t, step, count, second);
  for (int64_t k = 0; k < count; k++) {
    rise(w, t + step * (double)k, r);
    const double r2[3] = {r[0] * r[0], 2.0 * r[0] * r[1], 2.0 * (r[1] * r[1] + r[0] * r[2])};
    for (int c = 0; c < 3; c++) motion[k][c] = 0.0;
    multiply(r, first[k], motion[k]);
    multiply(r2, second[k], motion[k]);
  }
}

/* ---- public ---------------------------------------------------------------------------------- */

static mps_status check_times(const mps_waves *w, const char *function, int64_t count,
                              const double *t) {
  if (count < 0)
    return mpsi_fail(w->context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be >= 0",
                     (long long)count);
  if (count > 0 && !t) return mpsi_fail(w->context, function, MPS_ERROR_ARGUMENT, "t is NULL");
  for (int64_t k = 0; k < count; k++)
    if (!(fabs(t[k]) <= 1e12))
      return mpsi_fail(w->context, function, MPS_ERROR_ARGUMENT,
                       "t[%lld] is %g s, must be within 1e12", (long long)k, t[k]);
  return MPS_OK;
}

/* Amplitudes of the bound waves at x; *out NULL where there are none. */
static mps_status find_bound(const mps_waves *w, const char *function, double x,
                             double complex **out) {
  *out = NULL;
  if (w->bins == 0) return MPS_OK;
  *out = mpsi_alloc(w->context, w->bins + 1, sizeof **out);
  if (!*out) return mpsi_fail_memory(w->context, function, (size_t)(w->bins + 1) * sizeof **out);
  mpsi_waves_add_bound(w, x, *out);
  return MPS_OK;
}

mps_status mps_waves_get_levels(const mps_waves *w, double station, int64_t count, const double *t,
                                double *linear, double *level) {
  if (!w) return mpsi_null(__func__, "waves");
  if (!(station >= 0.0 && station <= 1e12))
    return mpsi_fail(w->context, __func__, MPS_ERROR_ARGUMENT,
                     "station is %g m from the piston, must be in 0 to 1e12", station);
  mps_status status = check_times(w, __func__, count, t);
  double complex *eta = NULL;
  if (status == MPS_OK && level) status = find_bound(w, __func__, station, &eta);
  if (status != MPS_OK) return status;
  for (int64_t k = 0; k < count; k++) {
    double sum = w->solitary > 0.0 ? mpsi_waves_solitary_level(w, station, t[k]) : 0.0;
    double bound[3] = {0.0};
    for (int64_t n = 0; n < w->count; n++) {
      const double angle = w->wave[n].omega * t[k] - w->wave[n].k * station;
      sum += creal(w->wave[n].a) * cos(angle) - cimag(w->wave[n].a) * sin(angle);
    }
    if (eta) sum_bins(w, eta, t[k], bound);
    if (linear) linear[k] = sum;
    if (level) level[k] = sum + bound[0];
  }
  mpsi_free(w->context, eta);
  return MPS_OK;
}

mps_status mps_waves_get_piston(const mps_waves *w, int64_t count, const double *t,
                                double *displacement, double *velocity, double *acceleration,
                                double *level) {
  if (!w) return mpsi_null(__func__, "waves");
  MPSI_TRY(check_times(w, __func__, count, t));
  double *const out[4] = {displacement, velocity, acceleration, level};
  for (int64_t k = 0; k < count; k++) {
    double motion[4];
    mpsi_waves_move(w, t[k], w->bound, motion);
    for (int c = 0; c < 4; c++)
      if (out[c]) out[c][k] = motion[c];
  }
  return MPS_OK;
}

mps_status mps_waves_get_components(const mps_waves *w, int64_t capacity, int64_t *count,
                                    double *frequency, double *amplitude, double *phase) {
  if (!w) return mpsi_null(__func__, "waves");
  if (!count) return mpsi_fail(w->context, __func__, MPS_ERROR_ARGUMENT, "count is NULL");
  if (capacity < 0)
    return mpsi_fail(w->context, __func__, MPS_ERROR_ARGUMENT, "capacity is %lld, must be >= 0",
                     (long long)capacity);
  for (int64_t n = 0; n < w->count && n < capacity; n++) {
    if (frequency) frequency[n] = (double)w->wave[n].bin / w->repeat;
    if (amplitude) amplitude[n] = cabs(w->wave[n].a);
    if (phase) phase[n] = carg(w->wave[n].a);
  }
  *count = w->count;
  return MPS_OK;
}
