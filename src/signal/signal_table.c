/* signal_table.c - tables of samples. Whatever was sampled, the displacement between two samples
 * is one cubic, u(t + s) = u + v s + a s^2/2 + j s^3/6:
 *   accelerations, linear between samples:  j = (a1 - a0)/h, and v, u by exact integration;
 *   velocities, linear between samples:     a = (v1 - v0)/h, j = 0, and u by exact integration;
 *   displacements, natural cubic spline:    a at the samples solves a tridiagonal system.
 * A number is kept likewise as u, with the slope v = (u1 - u0)/h, or 0 where it changes in steps.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "signal_private.h"

#include <lapacke.h>

#define BEYOND 0.05 /* of the range of samples, by which a spline goes past it unasked */

/* ---- evaluation ------------------------------------------------------------------------------ */

/* The knot that begins the piece with t in it; start <= t < end. Equal steps are found at once,
 * others by bisection. */
static int64_t find_knot(const mps_signal *signal, double t) {
  const mpsi_knot *knots = signal->knots;
  const double guess = (t - signal->start) * signal->knots_per_second;
  int64_t low = 0, high = signal->count - 1;
  if (guess >= 0.0 && guess < (double)high) {
    const int64_t i = (int64_t)guess;
    if (knots[i].t <= t && t < knots[i + 1].t) return i;
  }
  while (high - low > 1) {
    const int64_t middle = low + (high - low) / 2;
    if (knots[middle].t <= t)
      low = middle;
    else
      high = middle;
  }
  return low;
}

static mpsi_signal_motion table_at(const mps_signal *signal, double t) {
  if (t < signal->start) return (mpsi_signal_motion){.u = signal->knots[0].u};
  const mpsi_knot *k = &signal->knots[signal->count - 1];
  if (t == signal->end) return (mpsi_signal_motion){.u = k->u, .v = k->v, .a = k->a};
  if (t > signal->end)
    return (mpsi_signal_motion){.u = k->u + signal->coast * (t - k->t), .v = signal->coast};
  k = &signal->knots[find_knot(signal, t)];
  const double s = t - k->t;
  return (mpsi_signal_motion){.u = k->u + s * (k->v + s * (0.5 * k->a + s * k->j / 6.0)),
                              .v = k->v + s * (k->a + s * 0.5 * k->j),
                              .a = k->a + s * k->j};
}

/* ---- the quantities ---------------------------------------------------------------------------
 */

static void integrate_accelerations(mpsi_knot *knots, int64_t count, const double *values) {
  knots[0].a = values[0];
  for (int64_t i = 0; i + 1 < count; i++) {
    mpsi_knot *k = &knots[i], *next = k + 1;
    const double h = next->t - k->t;
    next->a = values[i + 1];
    k->j = (next->a - k->a) / h;
    next->v = k->v + 0.5 * h * (k->a + next->a);
    next->u = k->u + h * (k->v + h * (2.0 * k->a + next->a) / 6.0);
  }
}

static void integrate_velocities(mpsi_knot *knots, int64_t count, const double *values) {
  knots[0].v = values[0];
  for (int64_t i = 0; i + 1 < count; i++) {
    mpsi_knot *k = &knots[i], *next = k + 1;
    const double h = next->t - k->t;
    next->v = values[i + 1];
    k->a = (next->v - k->v) / h;
    next->u = k->u + 0.5 * h * (k->v + next->v);
  }
  knots[count - 1].a = knots[count - 2].a;
}

/* Second derivatives a of the natural cubic spline: a = 0 at both ends and, at the samples
 * between, h0/6 a[i-1] + (h0 + h1)/3 a[i] + h1/6 a[i+1] = (u[i+1] - u[i])/h1 - (u[i] - u[i-1])/h0
 * with h0, h1 the steps before and after: symmetric positive definite. */
static mps_status solve_spline(mps_context *context, const char *function, mpsi_knot *knots,
                               int64_t count) {
  const int64_t n = count - 2;
  if (n == 0) return MPS_OK;
  double *diagonal = mpsi_alloc(context, n, 3 * sizeof *diagonal);
  if (!diagonal) return mpsi_fail_memory(context, function, (size_t)n * 3 * sizeof *diagonal);
  double *above = diagonal + n, *right = above + n;
  for (int64_t i = 0; i < n; i++) {
    const mpsi_knot *k = &knots[i + 1];
    const double h0 = k->t - k[-1].t, h1 = k[1].t - k->t;
    diagonal[i] = (h0 + h1) / 3.0;
    above[i] = h1 / 6.0;
    right[i] = (k[1].u - k->u) / h1 - (k->u - k[-1].u) / h0;
  }
  const lapack_int info =
      LAPACKE_dptsv_work(LAPACK_COL_MAJOR, (lapack_int)n, 1, diagonal, above, right, (lapack_int)n);
  for (int64_t i = 0; i < n; i++) knots[i + 1].a = right[i];
  mpsi_free(context, diagonal);
  if (info == 0) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                   "the spline's system is singular at sample %lld: are the times distinct?",
                   (long long)info);
}

static mps_status fit_displacements(mps_context *context, const char *function, mpsi_knot *knots,
                                    int64_t count, const double *values) {
  for (int64_t i = 0; i < count; i++) knots[i].u = values[i];
  MPSI_TRY(solve_spline(context, function, knots, count));
  for (int64_t i = 0; i + 1 < count; i++) {
    mpsi_knot *k = &knots[i], *next = k + 1;
    const double h = next->t - k->t, slope = (next->u - k->u) / h;
    k->v = slope - h * (2.0 * k->a + next->a) / 6.0;
    k->j = (next->a - k->a) / h;
    next->v = slope + h * (k->a + 2.0 * next->a) / 6.0;
  }
  return MPS_OK;
}

static void interpolate_values(mpsi_knot *knots, int64_t count, const double *values, bool steps) {
  for (int64_t i = 0; i < count; i++) knots[i].u = values[i];
  for (int64_t i = 0; !steps && i + 1 < count; i++)
    knots[i].v = (values[i + 1] - values[i]) / (knots[i + 1].t - knots[i].t);
}

/* ---- creation -------------------------------------------------------------------------------- */

static mps_status check_table(mps_context *context, const char *function, int32_t quantity,
                              int64_t count, const double *times, const double *values) {
  if (quantity < MPS_SIGNAL_QUANTITY_ACCELERATION || quantity > MPS_SIGNAL_QUANTITY_VALUE_STEPS)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                     "quantity is %d, allowed are MPS_SIGNAL_QUANTITY_ACCELERATION, _VELOCITY, "
                     "_DISPLACEMENT, _VALUE and _VALUE_STEPS",
                     quantity);
  if (count < 2 || count >= INT32_MAX)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "count is %lld, must be in 2 to %d",
                     (long long)count, INT32_MAX - 1);
  if (!times || !values)
    return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s is NULL",
                     times ? "values" : "times");
  for (int64_t i = 0; i < count; i++) {
    if (!isfinite(times[i]) || !isfinite(values[i]))
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT, "%s[%lld] is %g, must be finite",
                       isfinite(times[i]) ? "values" : "times", (long long)i,
                       isfinite(times[i]) ? values[i] : times[i]);
    if (fabs(times[i]) > MPSI_SIGNAL_LATEST)
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "times[%lld] is %g s, must be within 1e15", (long long)i, times[i]);
    if (i > 0 && times[i] <= times[i - 1])
      return mpsi_fail(context, function, MPS_ERROR_ARGUMENT,
                       "times[%lld] is %.17g s, must be after times[%lld] = %.17g s", (long long)i,
                       times[i], (long long)i - 1, times[i - 1]);
  }
  return MPS_OK;
}

/* Terms of the cubics, over at most 2e15 s, stay finite. */
static bool small(double value) { return fabs(value) <= 1e250; }

static mps_status check_finite(mps_context *context, const char *function, const mpsi_knot *knots,
                               int64_t count) {
  for (const mpsi_knot *k = knots; k < knots + count; k++)
    if (!small(k->u) || !small(k->v) || !small(k->a) || !small(k->j))
      return mpsi_fail(context, function, MPS_ERROR_NUMERIC,
                       "the motion overflows at or after t = %g s: u = %g m, v = %g m/s, "
                       "a = %g m/s2, da/dt = %g m/s3",
                       k->t, k->u, k->v, k->a, k->j);
  return MPS_OK;
}

/* Displacement where the velocity v + a s + j s^2/2 of a piece of h seconds is 0 (m), at the sign
 * of the root; the piece's own u where it is not 0 within. */
static double turn(const mpsi_knot *k, double h, double sign) {
  const double size = fmax(fabs(k->v), h * fmax(fabs(k->a), h * fabs(k->j)));
  if (!(size > 0.0)) return k->u;
  const double v = k->v / size, a = h * k->a / size, j = h * h * k->j / size;
  const double square = a * a - 2.0 * v * j, below = a + sign * sqrt(fmax(square, 0.0));
  if (square < 0.0 || below == 0.0) return k->u;
  const double x = -2.0 * v / below, s = h * x; /* of h */
  return x > 0.0 && x < 1.0 ? k->u + s * (k->v + s * (0.5 * k->a + s * k->j / 6.0)) : k->u;
}

/* A ramp and a long rest by few samples: the spline comes into the rest with a velocity. */
static void warn_about_range(mps_context *context, const char *function, const mpsi_knot *knots,
                             int64_t count) {
  double low = knots[0].u, high = low, beyond = 0.0, farthest = low, at = knots[0].t;
  for (int64_t i = 1; i < count; i++) low = fmin(low, knots[i].u), high = fmax(high, knots[i].u);
  for (int64_t i = 0; i + 1 < count; i++)
    for (int side = 0; side < 2; side++) {
      const double u = turn(&knots[i], knots[i + 1].t - knots[i].t, side ? 1.0 : -1.0);
      const double out = fmax(u - high, low - u);
      if (out > beyond) beyond = out, farthest = u, at = knots[i].t;
    }
  if (!(beyond > BEYOND * (high - low)) || !(beyond > 1e-9 * fmax(-low, high))) return;
  mpsi_log(context, MPS_CONTEXT_LOG_WARNING,
           "%s: the displacements are samples from %.6g to %.6g m, and the natural cubic spline "
           "through them goes to %.6g m between t = %.6g s and the next sample: give more samples, "
           "or velocities, which are linear between samples, as for ramps and rests",
           function, low, high, farthest, at);
}

/* Fills the knots, whose times are set. */
static mps_status fill_knots(mps_context *context, const char *function, int32_t quantity,
                             mpsi_knot *knots, int64_t count, const double *values) {
  mps_status status = MPS_OK;
  if (quantity == MPS_SIGNAL_QUANTITY_ACCELERATION)
    integrate_accelerations(knots, count, values);
  else if (quantity == MPS_SIGNAL_QUANTITY_VELOCITY)
    integrate_velocities(knots, count, values);
  else if (quantity == MPS_SIGNAL_QUANTITY_DISPLACEMENT)
    status = fit_displacements(context, function, knots, count, values);
  else
    interpolate_values(knots, count, values, quantity == MPS_SIGNAL_QUANTITY_VALUE_STEPS);
  MPSI_TRY(status);
  MPSI_TRY(check_finite(context, function, knots, count));
  if (quantity == MPS_SIGNAL_QUANTITY_DISPLACEMENT)
    warn_about_range(context, function, knots, count);
  return MPS_OK;
}

mps_status mpsi_signal_from_table(mps_context *context, const char *function, int32_t quantity,
                                  int64_t count, const double *times, const double *values,
                                  mps_signal **out) {
  MPSI_TRY(check_table(context, function, quantity, count, times, values));
  mps_signal *signal = mpsi_signal_new(context, function);
  if (!signal) return MPS_ERROR_MEMORY;
  signal->knots = mpsi_alloc(context, count, sizeof *signal->knots);
  if (!signal->knots) {
    mps_signal_destroy(&signal);
    return mpsi_fail_memory(context, function, (size_t)count * sizeof(mpsi_knot));
  }
  for (int64_t i = 0; i < count; i++) signal->knots[i].t = times[i];
  mps_status status = fill_knots(context, function, quantity, signal->knots, count, values);
  if (status != MPS_OK) {
    mps_signal_destroy(&signal);
    return status;
  }
  signal->at = table_at;
  signal->start = times[0];
  signal->end = times[count - 1];
  const bool integrated = quantity < MPS_SIGNAL_QUANTITY_DISPLACEMENT;
  signal->value = quantity >= MPS_SIGNAL_QUANTITY_VALUE;
  signal->coast = integrated ? signal->knots[count - 1].v : 0.0;
  signal->count = count;
  signal->knots_per_second = (double)(count - 1) / (signal->end - signal->start);
  if (integrated && signal->start < 0.0) {
    const double before = table_at(signal, 0.0).u; /* displaces nothing at t = 0 */
    for (int64_t i = 0; i < count; i++) signal->knots[i].u -= before;
  }
  /* |a| is linear between samples, so it is largest at one of them */
  *out = signal;
  return MPS_OK;
}

mps_status mps_signal_create_table(mps_context *context, int32_t quantity, int64_t count,
                                   const double *times, const double *values, mps_signal **out) {
  if (!context) return mpsi_null(__func__, "context");
  if (!out) return mpsi_fail(context, __func__, MPS_ERROR_ARGUMENT, "out is NULL");
  *out = NULL;
  return mpsi_signal_from_table(context, __func__, quantity, count, times, values, out);
}
