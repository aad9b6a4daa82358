/* signal.c - functions of time, motions and numbers: the object, its evaluation, and the analytic
 * kinds (the Ricker wavelet of Yoshida (9) with its integrals, sine, quintic ramp).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "signal_private.h"

#include "core/context/guard.h"
#include "core/base/hash.h"
#include "core/context/retain.h"
#include "core/definition/digits.h"

#include <stdio.h>

#define PI 3.14159265358979323846
#define LARGEST 1e300      /* of |u|, |v|, |a|: factors of these stay finite */
#define SHORTEST 1e-100    /* s, of a ramp, whose square is a divisor */
#define FREQUENCY_MIN 1e-9 /* Hz: squares and their reciprocals stay far from overflow */
#define FREQUENCY_MAX 1e9

/* ---- life ------------------------------------------------------------------------------------ */

mps_signal *mpsi_signal_new(mps_context *context, const char *function) {
  mps_signal *signal = mpsi_alloc(context, 1, sizeof *signal);
  if (!signal) {
    (void)mpsi_fail_memory(context, function, sizeof *signal);
    return NULL;
  }
  signal->context = mpsi_context_retain(context);
  atomic_init(&signal->references, 1);
  return signal;
}

mps_signal *mpsi_signal_retain(mps_signal *signal) {
  atomic_fetch_add(&signal->references, 1);
  return signal;
}

void mps_signal_destroy(mps_signal **signal) {
  if (!signal || !*signal) return;
  mps_signal *s = *signal;
  *signal = NULL;
  if (atomic_fetch_sub(&s->references, 1) != 1) return;
  mps_context *context = s->context;
  mpsi_release(s->release, s->user);
  MPSI_FREE(context, s->knots, s);
  mpsi_context_release(context);
}

/* ---- evaluation ------------------------------------------------------------------------------ */

/* "signal[1] of boundary 3 at t = 2 s" */
static void describe(mpsi_signal_use use, double t, size_t size, char *out) {
  char component[24] = "", number[24] = "";
  if (use.component >= 0) (void)snprintf(component, sizeof component, "[%d]", use.component);
  if (use.number >= 0) (void)snprintf(number, sizeof number, " %d", use.number);
  (void)snprintf(out, size, "signal%s of %s%s%s at t = %g s", component,
                 use.number < 0 ? "the " : "", use.owner, number, t);
}

/* Completes the record of a failure of the signal. */
static mps_status fail_use(mpsi_signal_use use, mps_status status) {
  if (use.number >= 0) mpsi_fail_object(use.context, "%s %d", use.owner, use.number);
  return status;
}

static mps_status call_user(const mps_signal *signal, mpsi_signal_use use, double t,
                            mpsi_signal_motion *out) {
  const int64_t failures = use.context ? mpsi_failures(use.context) : 0;
  double motion[3] = {NAN, NAN, NAN};
  const mps_status status = signal->fn(signal->user, t, motion);
  *out = (mpsi_signal_motion){motion[0], motion[1], motion[2]};
  if (status == MPS_OK || !use.context) return status;
  char what[160];
  describe(use, t, sizeof what, what);
  return fail_use(use, mpsi_callback_status(use.context, use.function, what, failures, status));
}

mps_status mpsi_signal_evaluate(const mps_signal *signal, mpsi_signal_use use, double t,
                                mpsi_signal_motion *out) {
  mpsi_signal_motion at = {0};
  mps_status status = MPS_OK;
  if (signal && signal->fn)
    status = call_user(signal, use, t, &at);
  else if (signal)
    at = signal->at(signal, t);
  if (status != MPS_OK) return status;
  if (signal && signal->value) at.v = at.a = 0.0;
  if (!isfinite(at.u) || !isfinite(at.v) || !isfinite(at.a)) {
    char what[160];
    describe(use, t, sizeof what, what);
    if (signal->value)
      status = mpsi_fail(use.context, use.function, MPS_ERROR_NUMERIC, "%s is %g: must be finite",
                         what, at.u);
    else
      status = mpsi_fail(use.context, use.function, MPS_ERROR_NUMERIC,
                         "%s is u = %g m, v = %g m/s, a = %g m/s2: must be finite", what, at.u,
                         at.v, at.a);
    return fail_use(use, status);
  }
  *out = at;
  return MPS_OK;
}

mps_status mpsi_signal_factor(const mps_signal *signal, mpsi_signal_use use, double t,
                              double *out) {
  mpsi_signal_motion at = {.u = 1.0};
  const mps_status status = signal ? mpsi_signal_evaluate(signal, use, t, &at) : MPS_OK;
  if (status == MPS_OK) *out = at.u;
  return status;
}

mps_status mpsi_signal_check(mps_context *context, const char *function, mpsi_signal_role role,
                             int count, mps_signal *const *signal) {
  for (int c = 0; c < count; c++) {
    char component[16] = "";
    if (count > 1) (void)snprintf(component, sizeof component, "[%d]", c);
    if (!signal[c] || signal[c]->value == (role == MPSI_SIGNAL_NUMBER)) continue;
    if (role == MPSI_SIGNAL_NUMBER)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "signal%s is a motion, and a factor in time is a number: create it with "
                       "MPS_SIGNAL_QUANTITY_VALUE",
                       component);
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "signal%s is a number in time (MPS_SIGNAL_QUANTITY_VALUE), and what moves "
                     "needs a motion: create it with MPS_SIGNAL_QUANTITY_DISPLACEMENT, _VELOCITY "
                     "or _ACCELERATION",
                     component);
  }
  return MPS_OK;
}

bool mpsi_signal_may_fail(const mps_signal *signal) { return signal && signal->fn; }

/* Continues `hash` (core/base/hash.h) over the constants of a signal and samples of its motion. A
 * function of the caller adds its kind alone: its address differs between processes. */
static uint64_t hash_of(const mps_signal *signal, uint64_t hash) {
  const double kind = !signal ? 0.0 : (signal->fn ? 1.0 : 2.0) + (signal->value ? 2.0 : 0.0);
  hash = mpsi_hash(hash, &kind, sizeof kind);
  if (!signal || signal->fn) return hash;
  for (double t = 0.1; t < 20.0; t *= 5.0) { /* they distinguish the kinds */
    const mpsi_signal_motion m = signal->at(signal, t);
    const double sample[3] = {m.u, m.v, m.a};
    hash = mpsi_hash(hash, sample, sizeof sample);
  }
  const double numbers[] = {signal->start, signal->end,   signal->amplitude,    signal->rate,
                            signal->shift, signal->coast, (double)signal->count};
  hash = mpsi_hash(hash, numbers, sizeof numbers);
  return mpsi_hash(hash, signal->knots, (size_t)signal->count * sizeof *signal->knots);
}

void mpsi_signal_give(mpsi_given *list, const char *name, const mps_signal *signal) {
  mpsi_give(list, name, mpsi_hash_short(hash_of(signal, MPSI_HASH)));
}

/* For the public queries, which return no status: NaN where the signal fails, is not finite, or is
 * not of the kind that is asked for. */
static mpsi_signal_motion look(const mps_signal *signal, bool value, double t) {
  const mpsi_signal_use use = {.owner = "caller", .number = -1, .component = -1};
  mpsi_signal_motion at = {NAN, NAN, NAN};
  if (!signal) return (mpsi_signal_motion){0};
  if (isfinite(t) && signal->value == value) (void)mpsi_signal_evaluate(signal, use, t, &at);
  return at;
}

double mps_signal_displacement(const mps_signal *signal, double t) {
  return look(signal, false, t).u;
}

double mps_signal_velocity(const mps_signal *signal, double t) { return look(signal, false, t).v; }

double mps_signal_acceleration(const mps_signal *signal, double t) {
  return look(signal, false, t).a;
}

double mps_signal_value(const mps_signal *signal, double t) { return look(signal, true, t).u; }

void mps_signal_span(const mps_signal *signal, double *start, double *end) {
  if (start) *start = signal ? signal->start : 0.0;
  if (end) *end = signal ? signal->end : 0.0;
}

static mpsi_signal_motion ricker_at(const mps_signal *signal, double t) {
  if (t < 0.0) return (mpsi_signal_motion){0};
  const double amplitude = signal->amplitude, c = signal->rate, tp = signal->shift;
  const double tau = t - tp, first = exp(-c * tp * tp);
  const double x = c * tau * tau;
  if (x > 700.0) /* the exponential is 0, and 0 times an overflowed x would be NaN */
    return (mpsi_signal_motion){.u = amplitude * -first / (2.0 * c)};
  const double e = exp(-x);
  return (mpsi_signal_motion){.u = amplitude * (e - first) / (2.0 * c),
                              .v = -amplitude * tau * e,
                              .a = amplitude * (2.0 * x - 1.0) * e};
}

static mpsi_signal_motion sine_at(const mps_signal *signal, double t) {
  if (t < 0.0) return (mpsi_signal_motion){0};
  const double w = signal->rate, angle = w * t + signal->shift;
  const double s = signal->amplitude * sin(angle);
  return (mpsi_signal_motion){.u = s, .v = signal->amplitude * w * cos(angle), .a = -w * w * s};
}

static mpsi_signal_motion ramp_at(const mps_signal *signal, double t) {
  if (t <= signal->start) return (mpsi_signal_motion){0};
  if (t >= signal->end) return (mpsi_signal_motion){.u = signal->amplitude};
  const double amplitude = signal->amplitude, duration = signal->rate;
  const double x = (t - signal->start) / duration, y = 1.0 - x;
  return (mpsi_signal_motion){.u = amplitude * x * x * x * (10.0 + x * (6.0 * x - 15.0)),
                              .v = amplitude * 30.0 * x * x * y * y / duration,
                              .a = amplitude * 60.0 * x * y * (y - x) / (duration * duration)};
}

/* ---- the analytic kinds ---------------------------------------------------------------------- */

/* Of what is given by a formula or a function: a motion with its derivatives, or a number. */
static mps_status check_quantity(mps_context *context, const char *function, int32_t quantity) {
  if (quantity == MPS_SIGNAL_QUANTITY_DISPLACEMENT || quantity == MPS_SIGNAL_QUANTITY_VALUE)
    return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                   "quantity is %s, allowed are MPS_SIGNAL_QUANTITY_DISPLACEMENT, a motion, and "
                   "MPS_SIGNAL_QUANTITY_VALUE, a number",
                   mpsi_name_of("mps_signal_quantity", quantity).text);
}

/* Checks shared by the analytic kinds; `peaks` are the largest |u|, |v|, |a| of the motion. */
static mps_status check_motion(mps_context *context, const char *function, int32_t quantity,
                               double amplitude, mpsi_signal_motion peaks) {
  if (!isfinite(amplitude))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "amplitude is %g, must be finite",
                     amplitude);
  if (quantity == MPS_SIGNAL_QUANTITY_VALUE) peaks.v = peaks.a = 0.0;
  if (!(peaks.u <= LARGEST) || !(peaks.v <= LARGEST) || !(peaks.a <= LARGEST))
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "amplitude %g is too large: the motion overflows (peaks %g m, %g m/s, "
                     "%g m/s2)",
                     amplitude, peaks.u, peaks.v, peaks.a);
  return MPS_OK;
}

static mps_status check_frequency(mps_context *context, const char *function, double frequency) {
  if (frequency >= FREQUENCY_MIN && frequency <= FREQUENCY_MAX) return MPS_OK; /* not NaN */
  return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "frequency is %s Hz, must be in %g to %g",
                   mpsi_outside(frequency, FREQUENCY_MIN, FREQUENCY_MAX).text, FREQUENCY_MIN,
                   FREQUENCY_MAX);
}

mps_status mps_signal_create_ricker(mps_context *context, double frequency, double peak_time,
                                    double amplitude, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_status status = check_frequency(context, __func__, frequency);
  if (status != MPS_OK) return status;
  if (!isfinite(peak_time) || peak_time < 0.0)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "peak_time is %g s, must be finite and >= 0", peak_time);
  const double c = PI * frequency * PI * frequency, peak = fabs(amplitude);
  const mpsi_signal_motion peaks = {.u = peak / (2.0 * c), .v = peak / sqrt(c), .a = peak};
  if ((status = check_motion(context, __func__, MPS_SIGNAL_QUANTITY_DISPLACEMENT, amplitude,
                             peaks)) != MPS_OK)
    return status;
  mps_signal *signal = mpsi_signal_new(context, __func__);
  if (!signal) return MPS_ERROR_MEMORY;
  signal->at = ricker_at;
  signal->amplitude = amplitude;
  signal->rate = c;
  signal->shift = peak_time;
  signal->end = peak_time + sqrt(40.0 / c);
  *out = signal;
  return MPS_OK;
}

mps_status mps_signal_create_sine(mps_context *context, int32_t quantity, double frequency,
                                  double amplitude, double phase, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  mps_status status = check_quantity(context, __func__, quantity);
  if (status == MPS_OK) status = check_frequency(context, __func__, frequency);
  if (status != MPS_OK) return status;
  if (!isfinite(phase))
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "phase is %g rad, must be finite",
                     phase);
  const double w = 2.0 * PI * frequency, peak = fabs(amplitude);
  const mpsi_signal_motion peaks = {.u = peak, .v = peak * w, .a = peak * (w * w)};
  if ((status = check_motion(context, __func__, quantity, amplitude, peaks)) != MPS_OK)
    return status;
  mps_signal *signal = mpsi_signal_new(context, __func__);
  if (!signal) return MPS_ERROR_MEMORY;
  signal->at = sine_at;
  signal->value = quantity == MPS_SIGNAL_QUANTITY_VALUE;
  signal->amplitude = amplitude;
  signal->rate = w;
  signal->shift = phase;
  signal->end = INFINITY;
  *out = signal;
  return MPS_OK;
}

mps_status mps_signal_create_ramp(mps_context *context, int32_t quantity, double start,
                                  double duration, double amplitude, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_quantity(context, __func__, quantity));
  if (!isfinite(start))
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "start is %g s, must be finite", start);
  if (!isfinite(duration) || duration < SHORTEST || !isfinite(start + duration) ||
      start + duration <= start)
    return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT,
                     "duration is %g s, must be finite, > 0 (at least 1e-100) and not lost in "
                     "rounding beside the "
                     "start %g s",
                     duration, start);
  /* y = 1 - x: v has its largest value at x = 1/2, a at x y = 1/6 */
  const double peak = fabs(amplitude);
  const mpsi_signal_motion peaks = {.u = peak,
                                    .v = peak * 1.875 / duration,
                                    .a = peak * (10.0 / sqrt(3.0)) / duration / duration};
  MPSI_TRY(check_motion(context, __func__, quantity, amplitude, peaks));
  mps_signal *signal = mpsi_signal_new(context, __func__);
  if (!signal) return MPS_ERROR_MEMORY;
  signal->at = ramp_at;
  signal->value = quantity == MPS_SIGNAL_QUANTITY_VALUE;
  signal->amplitude = amplitude;
  signal->rate = duration;
  signal->start = start;
  signal->end = start + duration;
  *out = signal;
  return MPS_OK;
}

/* ---- the caller's own ------------------------------------------------------------------------ */

mps_status mpsi_signal_create_owned(mps_context *context, const char *function, mps_signal_fn fn,
                                    void (*release)(void *user), void *user, mps_signal **out) {
  mps_signal *signal = mpsi_signal_new(context, function);
  if (!signal) return MPS_ERROR_MEMORY;
  signal->fn = fn;
  signal->release = release;
  signal->user = user;
  signal->start = -INFINITY;
  signal->end = INFINITY;
  *out = signal;
  return MPS_OK;
}

mps_status mps_signal_create_user(mps_context *context, int32_t quantity, mps_signal_fn fn,
                                  void *user, mps_release_fn release, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  MPSI_TRY(check_quantity(context, __func__, quantity));
  if (!fn) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "fn is NULL");
  mps_status status = mpsi_signal_create_owned(context, __func__, fn, release, user, out);
  if (status == MPS_OK) (*out)->value = quantity == MPS_SIGNAL_QUANTITY_VALUE;
  return status;
}
