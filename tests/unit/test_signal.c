/* test_signal.c - time functions against closed forms: Ricker, sine, ramp, tables; their spans,
 * peaks, errors, sharing and memory.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "test_allocator.h"
#include "test_fixture.h"
#include "test_journal.h"

#include "core/context/retain.h"

typedef double (*function_of_time)(const mps_signal *signal, double t);

/* Eighth-order central difference: error h^8/630 f^(9). */
static double derivative(function_of_time f, const mps_signal *signal, double t, double h) {
  static const double c[] = {4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};
  double sum = 0.0;
  for (int k = 1; k <= 4; k++) sum += c[k - 1] * (f(signal, t + k * h) - f(signal, t - k * h));
  return sum / h;
}

/* v = du/dt and a = dv/dt in [start, end]. */
static void check_derivatives(const mps_signal *signal, double start, double end, double step,
                              double tolerance_v, double tolerance_a) {
  for (int i = 0; i <= 200; i++) {
    const double t = start + (end - start) * i / 200.0;
    NEAR(derivative(mps_signal_displacement, signal, t, step), mps_signal_velocity(signal, t),
         tolerance_v);
    NEAR(derivative(mps_signal_velocity, signal, t, step), mps_signal_acceleration(signal, t),
         tolerance_a);
  }
}

TEST(a_ricker_wavelet_is_the_papers_acceleration_and_its_integrals) {
  const double fc = 4.0, tp = 0.25, amplitude = -3.0, c = PI * fc * PI * fc;
  MAKE(signal, signal, create_ricker, context, fc, tp, amplitude);
  for (int i = 0; i <= 100; i++) { /* Yoshida (9) */
    const double t = 0.006 * i, x = c * (t - tp) * (t - tp);
    NEAR(mps_signal_acceleration(signal, t), amplitude * (2.0 * x - 1.0) * exp(-x), 1e-14);
  }
  /* the truncation error (h/width)^8 is below the rounding error of u / h */
  check_derivatives(signal, 0.01, 0.8, 0.002, 1e-11, 1e-9);
  assert_true(mps_signal_displacement(signal, 0.0) == 0.0);
  NEAR(mps_signal_velocity(signal, 0.0), amplitude * tp * exp(-c * tp * tp), 1e-17);
  NEAR(exp(-c * tp * tp), 5.2e-5, 1e-6); /* what the header says */
  assert_true(mps_signal_acceleration(signal, -1e-9) == 0.0);
  assert_true(mps_signal_velocity(signal, -1e-9) == 0.0);
  assert_true(mps_signal_displacement(signal, -1e-9) == 0.0);
  NEAR(mps_signal_acceleration(signal, tp), -amplitude, 0.0);
  double start, end;
  mps_signal_span(signal, &start, &end);
  assert_true(start == 0.0);
  NEAR(mps_signal_acceleration(signal, end), 0.0, 3.0 * 80.0 * exp(-39.9));
  NEAR(mps_signal_displacement(signal, end), mps_signal_displacement(signal, 1e200), 1e-18);
  assert_true(mps_signal_acceleration(signal, 1e200) == 0.0); /* inf * 0 inside would be NaN */
}

TEST(a_sine_starts_at_zero_time_with_its_phase) {
  const double f = 2.5, amplitude = 0.02, phase = 0.7, w = 2.0 * PI * f;
  scoped_signal *signal = NULL;
  OK(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, f, amplitude, phase,
                            &signal));
  for (int i = 0; i < 50; i++) {
    const double t = 0.037 * i;
    NEAR(mps_signal_displacement(signal, t), amplitude * sin(w * t + phase), 1e-15);
    NEAR(mps_signal_velocity(signal, t), amplitude * w * cos(w * t + phase), 1e-14);
    NEAR(mps_signal_acceleration(signal, t), -amplitude * w * w * sin(w * t + phase), 1e-12);
  }
  check_derivatives(signal, 0.05, 1.0, 0.005, 1e-11, 1e-9);
  assert_true(mps_signal_displacement(signal, -1e-12) == 0.0);
  double start = -1.0, end = -1.0;
  mps_signal_span(signal, &start, &end);
  assert_true(start == 0.0 && isinf(end) && end > 0.0);
  mps_signal_span(signal, NULL, NULL);
  assert_true(isnan(mps_signal_displacement(signal, NAN)));
  assert_true(isnan(mps_signal_velocity(signal, INFINITY)));
}

TEST(a_ramp_begins_and_ends_at_rest) {
  const double start = -0.5, duration = 2.0, amplitude = -0.3;
  scoped_signal *signal = NULL;
  OK(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, start, duration, amplitude,
                            &signal));
  for (int side = -1; side <= 1; side++) {
    const double t0 = start + side * 1e-9, t1 = start + duration + side * 1e-9;
    NEAR(mps_signal_displacement(signal, t0), 0.0, 1e-20);
    NEAR(mps_signal_displacement(signal, t1), amplitude, 1e-16);
    NEAR(mps_signal_velocity(signal, t0), 0.0, 1e-15);
    NEAR(mps_signal_velocity(signal, t1), 0.0, 1e-15);
    NEAR(mps_signal_acceleration(signal, t0), 0.0, 1e-7);
    NEAR(mps_signal_acceleration(signal, t1), 0.0, 1e-7);
  }
  check_derivatives(signal, start + 0.1, start + duration - 0.1, 0.02, 1e-13, 1e-12);
  NEAR(mps_signal_displacement(signal, start + 0.5 * duration), 0.5 * amplitude, 1e-15);
}

TEST(a_table_of_accelerations_is_integrated_exactly) {
  /* a = 0, 6, 6, -12, 0 at uneven times; by hand: v = 3 t^2, u = t^3 in the first second, ... */
  const double times[] = {10.0, 11.0, 13.0, 13.5, 17.5}, values[] = {0.0, 6.0, 6.0, -12.0, 0.0};
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_ACCELERATION, 5, times, values);
  for (int i = 0; i <= 100; i++) {
    double s = 0.01 * i;
    NEAR(mps_signal_displacement(signal, 10.0 + s), s * s * s, 1e-14);
    NEAR(mps_signal_velocity(signal, 10.0 + s), 3.0 * s * s, 2e-14);
    NEAR(mps_signal_acceleration(signal, 10.0 + s), 6.0 * s, 1e-13);
    s = 0.02 * i;
    NEAR(mps_signal_displacement(signal, 11.0 + s), 1.0 + 3.0 * s + 3.0 * s * s, 1e-13);
    s = 0.005 * i; /* a = 6 - 36 s */
    NEAR(mps_signal_velocity(signal, 13.0 + s), 15.0 + 6.0 * s - 18.0 * s * s, 1e-13);
    NEAR(mps_signal_displacement(signal, 13.0 + s), 19.0 + 15.0 * s + 3.0 * s * s - 6.0 * s * s * s,
         1e-13);
  }
  /* v(17.5) = 13.5 - 12 * 4/2 = -10.5: it continues with it */
  NEAR(mps_signal_velocity(signal, 17.5), -10.5, 1e-13);
  const double last = mps_signal_displacement(signal, 17.5);
  NEAR(mps_signal_displacement(signal, 19.5), last - 21.0, 1e-13);
  NEAR(mps_signal_velocity(signal, 1e6), -10.5, 1e-13);
  assert_true(mps_signal_acceleration(signal, 17.6) == 0.0);
  assert_true(mps_signal_displacement(signal, 9.99) == 0.0);
  assert_true(mps_signal_acceleration(signal, -1e300) == 0.0);
  double start, end;
  mps_signal_span(signal, &start, &end);
  assert_true(start == 10.0 && end == 17.5);
}

TEST(a_table_of_velocities_is_linear_between_samples) {
  const double times[] = {0.0, 1.0, 3.0}, values[] = {2.0, 4.0, 1.0};
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, times, values);
  NEAR(mps_signal_velocity(signal, 0.0), 2.0, 0.0);
  NEAR(mps_signal_velocity(signal, -1e-9), 0.0, 0.0);
  NEAR(mps_signal_displacement(signal, 0.5), 1.25, 1e-15); /* 2 s + s^2 */
  NEAR(mps_signal_displacement(signal, 1.0), 3.0, 1e-15);
  NEAR(mps_signal_displacement(signal, 3.0), 8.0, 1e-14);
  NEAR(mps_signal_displacement(signal, 5.0), 10.0, 1e-14);
  NEAR(mps_signal_acceleration(signal, 0.999), 2.0, 0.0);
  NEAR(mps_signal_acceleration(signal, 1.0), -1.5, 0.0);
  NEAR(mps_signal_acceleration(signal, 3.0), -1.5, 0.0);
  NEAR(mps_signal_acceleration(signal, 3.1), 0.0, 0.0);
}

/* Largest error of the spline through sin on [0, pi], whose ends are natural (sin'' = 0). */
static double spline_error(int steps) {
  enum { MOST = 129 };
  double times[MOST] = {0}, values[MOST] = {0}, worst = 0.0;
  for (int i = 0; i <= steps; i++) {
    times[i] = 1.0 + PI * i / steps;
    values[i] = 0.5 + sin(PI * i / steps);
  }
  scoped_signal *signal = NULL;
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, steps + 1, times, values,
                             &signal));
  for (int i = 0; i <= steps; i++)
    NEAR(mps_signal_displacement(signal, times[i]), values[i], 1e-15);
  for (int i = 0; i <= 1000; i++) {
    const double x = PI * i / 1000.0;
    worst = fmax(worst, fabs(mps_signal_displacement(signal, 1.0 + x) - 0.5 - sin(x)));
    NEAR(mps_signal_velocity(signal, 1.0 + x), cos(x), 1.0 / (steps * steps));
  }
  NEAR(mps_signal_displacement(signal, 0.0), 0.5, 0.0);
  NEAR(mps_signal_velocity(signal, 0.999), 0.0, 0.0);
  NEAR(mps_signal_displacement(signal, 9.0), values[steps], 0.0);
  NEAR(mps_signal_velocity(signal, 9.0), 0.0, 0.0);
  return worst;
}

TEST(a_table_of_displacements_is_a_natural_spline_of_fourth_order) {
  const double coarse = spline_error(16), middle = spline_error(32), fine = spline_error(64);
  /* the classical bound of a cubic spline: 5/384 h^4 max|u''''| */
  assert_true(coarse <= 5.0 / 384.0 * pow(PI / 16.0, 4.0));
  NEAR(log2(coarse / middle), 4.0, 0.1);
  NEAR(log2(middle / fine), 4.0, 0.1);
}

TEST(a_spline_is_smooth_on_uneven_samples_and_a_line_stays_a_line) {
  const double times[] = {0.0, 0.1, 1.0, 1.3, 3.0}, values[] = {1.0, -1.0, 2.0, 0.0, 0.5};
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 5, times, values);
  for (int i = 1; i < 4; i++) {
    const double before = nextafter(times[i], -1.0), at = times[i];
    NEAR(mps_signal_displacement(signal, before), values[i], 1e-13);
    NEAR(mps_signal_velocity(signal, before), mps_signal_velocity(signal, at), 1e-12);
    NEAR(mps_signal_acceleration(signal, before), mps_signal_acceleration(signal, at), 1e-10);
  }
  NEAR(mps_signal_acceleration(signal, 0.0), 0.0, 0.0);
  NEAR(mps_signal_acceleration(signal, 3.0), 0.0, 0.0);
  mps_signal_destroy(&signal);
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2, times, values, &signal));
  NEAR(mps_signal_displacement(signal, 0.025), 0.5, 1e-15);
  NEAR(mps_signal_velocity(signal, 0.1), -20.0, 1e-13);
}

TEST(every_piece_of_a_table_is_found) {
  enum { COUNT = 300 };
  double times[COUNT], values[COUNT];
  for (int law = 0; law < 3; law++) { /* equal steps, growing steps, one far away */
    for (int i = 0; i < COUNT; i++) {
      times[i] = law == 0 ? 0.1 * i : law == 1 ? 1e-6 * pow(1.1, i) : i + (i == COUNT - 1) * 1e9;
      values[i] = i;
    }
    scoped_signal *signal = NULL;
    OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_ACCELERATION, COUNT, times, values,
                               &signal));
    for (int i = 0; i < COUNT; i++) {
      NEAR(mps_signal_acceleration(signal, times[i]), i, 1e-12 * COUNT);
      if (i + 1 == COUNT) break;
      const double x = 0.25, t = times[i] + x * (times[i + 1] - times[i]);
      NEAR(mps_signal_acceleration(signal, t), i + x, 1e-9);
    }
  }
}

TEST(the_table_is_a_copy_and_owners_share_it) {
  double times[] = {0.0, 1.0}, values[] = {1.0, 1.0};
  MAKE_KEPT(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_ACCELERATION, 2, times,
            values);
  values[0] = values[1] = times[1] = 99.0;
  mps_signal *other = mpsi_signal_retain(signal);
  mps_signal_destroy(&signal);
  assert_null(signal);
  NEAR(mps_signal_displacement(other, 1.0), 0.5, 1e-16);
  mps_signal_destroy(&other);
  mps_signal_destroy(&other);
  mps_signal_destroy(NULL);
  assert_true(mps_signal_displacement(NULL, 1.0) == 0.0);
  double start = 1.0, end = 1.0;
  mps_signal_span(NULL, &start, &end);
  assert_true(start == 0.0 && end == 0.0);
}

TEST(bad_analytic_arguments_are_refused) {
  mps_signal *s = NULL;
  REFUSES(mps_signal_create_ricker(context, 0.0, 1, 1, &s),
          "frequency is 0 Hz, must be in 1e-09 to 1e+09");
  REFUSES(mps_signal_create_ricker(context, NAN, 1, 1, &s), "frequency is nan");
  REFUSES(mps_signal_create_ricker(context, 1, -0.5, 1, &s), "peak_time is -0.5 s");
  REFUSES(mps_signal_create_ricker(context, 1, INFINITY, 1, &s), "peak_time is inf s");
  REFUSES(mps_signal_create_ricker(context, 1, 1, NAN, &s), "amplitude is nan");
  REFUSES(mps_signal_create_ricker(context, 1e-9, 1, 1e300, &s), "the motion overflows");
  REFUSES(mps_signal_create_ricker(context, 1, 1, 1, NULL), "out is NULL");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, -2.0, 1, 0, &s),
          "frequency is -2 Hz");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2.0, INFINITY, 0, &s),
          "amplitude is inf");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 2.0, 1, NAN, &s),
          "phase is nan rad");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1e9, 1e300, 0, &s),
          "the motion overflows");
  REFUSES(mps_signal_create_sine(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1, 1, 1, NULL),
          "out is NULL");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, NAN, 1, 1, &s),
          "start is nan s");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 0, 1, &s),
          "duration is 0 s");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, NAN, 1, &s),
          "duration is nan s");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1e20, 1, 1, &s),
          "lost in rounding beside the start 1e+20 s");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 1e-200, 1, &s),
          "duration is 1e-200 s");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 1e-90, 1e200, &s),
          "the motion overflows");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 1, NAN, &s),
          "amplitude is nan");
  REFUSES(mps_signal_create_ramp(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 1, 1, NULL),
          "out is NULL");
  assert_null(s);
  assert_int_equal(mps_signal_create_ricker(NULL, 1, 1, 1, &s), MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_signal_create_sine(NULL, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1, 1, 1, &s),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_signal_create_ramp(NULL, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1, 1, 1, &s),
                   MPS_ERROR_ARGUMENT);
}

TEST(bad_tables_are_refused) {
  mps_signal *s = NULL;
  const double up[] = {0.0, 1.0, 2.0}, level[] = {0.0, 1.0, 1.0}, broken[] = {0.0, NAN, 2.0};
  const double longest[] = {-1e15, 0.0, 1e15}, wide[] = {-1e308, 0.0, 1e308},
               tight[] = {0.0, 1e-320, 1.0};
  REFUSES(mps_signal_create_table(context, (mps_signal_quantity)5, 3, up, up, &s), "quantity is 5");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 1, up, up, &s),
          "count is 1, must be in 2");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, INT64_MAX, up, up, &s),
          "must be in 2");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, NULL, up, &s),
          "times is NULL");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, up, NULL, &s),
          "values is NULL");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, level, up, &s),
          "times[2] is 1 s, must be after times[1] = 1 s");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, broken, up, &s),
          "times[1] is nan");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, up, broken, &s),
          "values[1] is nan");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, wide, up, &s),
          "times[0] is -1e+308 s, must be within 1e15");
  REFUSES(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 3, up, up, NULL),
          "out is NULL");
  for (int quantity = MPS_SIGNAL_QUANTITY_ACCELERATION; quantity < MPS_SIGNAL_QUANTITY_DISPLACEMENT;
       quantity++)
    FAILS(mps_signal_create_table(context, (mps_signal_quantity)quantity, 3, longest, wide, &s),
          MPS_ERROR_NUMERIC, "the motion overflows at or after t = ");
  for (int quantity = 0; quantity < 3; quantity++)
    FAILS(mps_signal_create_table(context, (mps_signal_quantity)quantity, 3, tight, up, &s),
          MPS_ERROR_NUMERIC, "the motion overflows at or after t = ");
  assert_null(s);
  assert_int_equal(mps_signal_create_table(NULL, MPS_SIGNAL_QUANTITY_VELOCITY, 3, up, up, &s),
                   MPS_ERROR_ARGUMENT);
}

static mps_status make_one(mps_context *owner, int kind) {
  const double times[] = {0.0, 1.0, 2.0, 3.0}, values[] = {0.0, 1.0, -1.0, 2.0};
  scoped_signal *signal = NULL;
  const mps_status status =
      kind == 0 ? mps_signal_create_ricker(owner, 1, 1, 1, &signal)
      : kind == 1
          ? mps_signal_create_sine(owner, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1, 1, 0, &signal)
      : kind == 2
          ? mps_signal_create_ramp(owner, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 0, 1, 1, &signal)
          : mps_signal_create_table(owner, (mps_signal_quantity)(kind - 3), 4, times, values,
                                    &signal);
  assert_int_equal(status == MPS_OK, signal != NULL);
  return status;
}

TEST(a_refused_allocation_leaks_nothing) {
  for (int kind = 0; kind < 6; kind++) test_allocator_sweep(make_one, kind);
}

TEST(a_signal_outlives_its_context) {
  test_allocator allocator = {0};
  mps_context *owner = test_allocator_context(&allocator);
  MAKE_KEPT(signal, signal, create_sine, owner, MPS_SIGNAL_QUANTITY_DISPLACEMENT, 1.0, 2.0,
            0.5 * PI);
  mps_context_destroy(&owner);
  NEAR(mps_signal_displacement(signal, 0.0), 2.0, 0.0);
  mps_signal_destroy(&signal);
  assert_int_equal(allocator.live, 0);
}

/* ---- before t = 0, and the caller's own ------------------------------------------------------ */

TEST(what_lies_before_zero_displaces_nothing_at_the_start) {
  const double times[] = {-2.0, -1.0, 1.0, 3.0}, values[] = {1.0, 1.0, 1.0, -0.5};
  MAKE(signal, signal, create_table, context, MPS_SIGNAL_QUANTITY_VELOCITY, 4, times, values);
  NEAR(mps_signal_displacement(signal, 0.0), 0.0, 1e-15);
  NEAR(mps_signal_displacement(signal, 1.0), 1.0, 1e-15);
  NEAR(mps_signal_displacement(signal, -2.0), -2.0, 1e-15);
  NEAR(mps_signal_displacement(signal, -9.0), -2.0, 1e-15);
  NEAR(mps_signal_velocity(signal, 0.5), 1.0, 1e-15);
  mps_signal_destroy(&signal);
  /* a from t = -2: v = t + 2 from rest there, u = (t + 2)^2/2 - 2 */
  const double ones[] = {1.0, 1.0, 1.0, 1.0};
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_ACCELERATION, 4, times, ones, &signal));
  for (double t = -2.0; t < 3.0; t += 0.25) {
    NEAR(mps_signal_displacement(signal, t), 0.5 * (t + 2.0) * (t + 2.0) - 2.0, 1e-14);
    NEAR(mps_signal_velocity(signal, t), t + 2.0, 1e-14);
  }
  mps_signal_destroy(&signal);
  /* entirely in the past: what continues is the last velocity, from 0 at t = 0 */
  const double past[] = {-5.0, -4.0};
  OK(mps_signal_create_table(context, MPS_SIGNAL_QUANTITY_VELOCITY, 2, past, ones, &signal));
  NEAR(mps_signal_displacement(signal, 0.0), 0.0, 1e-15);
  NEAR(mps_signal_displacement(signal, 2.0), 2.0, 1e-15);
}

typedef struct parabola {
  double rate;
  int refuse_after;
} parabola;

static mps_status parabola_at(void *user, double t, double motion[3]) {
  const parabola *p = user;
  if (p->refuse_after > 0 && t > p->refuse_after) return MPS_ERROR_IO;
  motion[0] = 0.5 * p->rate * t * t;
  motion[1] = p->rate * t;
  motion[2] = p->refuse_after < 0 ? NAN : p->rate;
  return MPS_OK;
}

TEST(the_callers_function_is_a_signal) {
  parabola p = {3.0, 0};
  mps_signal *signal = NULL;
  OK(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, parabola_at, &p, NULL,
                            &signal));
  NEAR(mps_signal_displacement(signal, -2.0), 6.0, 0.0);
  NEAR(mps_signal_velocity(signal, 2.0), 6.0, 0.0);
  NEAR(mps_signal_acceleration(signal, 2.0), 3.0, 0.0);
  assert_true(isnan(mps_signal_displacement(signal, NAN)));
  double start, end;
  mps_signal_span(signal, &start, &end);
  assert_true(isinf(start) && isinf(end) && start < end);
  p.refuse_after = 1;
  assert_true(isnan(mps_signal_velocity(signal, 2.0)));
  NEAR(mps_signal_velocity(signal, 0.5), 1.5, 0.0);
  p.refuse_after = -1;
  assert_true(isnan(mps_signal_displacement(signal, 2.0)));
  mps_signal_destroy(&signal);
  assert_int_equal(
      mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, NULL, NULL, NULL, &signal),
      MPS_ERROR_ARGUMENT);
  assert_null(signal);
  assert_int_equal(mps_signal_create_user(NULL, MPS_SIGNAL_QUANTITY_DISPLACEMENT, parabola_at, NULL,
                                          NULL, &signal),
                   MPS_ERROR_ARGUMENT);
  assert_int_equal(mps_signal_create_user(context, MPS_SIGNAL_QUANTITY_DISPLACEMENT, parabola_at,
                                          NULL, NULL, NULL),
                   MPS_ERROR_ARGUMENT);
}

/* A ramp to 1 m in 0.4 s and a rest until `end`, by three samples. Returns the number of warnings.
 */
static int warned_of_rest(double end, double sign, int32_t quantity) {
  const double times[] = {0.0, 0.4, end}, values[] = {0.0, sign, sign};
  journal j = {0};
  scoped_context *own = journal_context(&j, NULL);
  scoped_signal *signal = NULL;
  double largest = 0.0;
  OK(mps_signal_create_table(own, quantity, 3, times, values, &signal));
  for (int i = 0; i <= 10000; i++)
    largest = fmax(largest, sign * mps_signal_displacement(signal, end * i / 1e4));
  if (quantity == MPS_SIGNAL_QUANTITY_DISPLACEMENT) assert_true(j.count == (largest > 1.05));
  return j.count;
}

TEST(says_where_a_spline_leaves_the_range_of_its_samples) {
  for (int side = -1; side <= 1; side += 2) {
    assert_int_equal(warned_of_rest(99.0, side, MPS_SIGNAL_QUANTITY_DISPLACEMENT), 1);
    assert_int_equal(warned_of_rest(0.8, side, MPS_SIGNAL_QUANTITY_DISPLACEMENT), 1);
    assert_int_equal(warned_of_rest(0.5, side, MPS_SIGNAL_QUANTITY_DISPLACEMENT), 0);
    assert_int_equal(warned_of_rest(99.0, side, MPS_SIGNAL_QUANTITY_VELOCITY), 0);
  }
}
