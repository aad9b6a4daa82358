/* signal_private.h - the members of a signal, and what a table of accelerations goes through, for
 * the files signal*.c, baseline.c and record*.c only.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"
#include "signal_internal.h"

#include <mps/signal.h>

/* Times of a table (s): terms of its cubics stay finite. */
#define MPSI_SIGNAL_LATEST 1e15

/* Start of a cubic piece: u(t + s) = u + v s + a s^2/2 + j s^3/6 up to the next knot. */
typedef struct mpsi_knot {
  double t, u, v, a, j;
} mpsi_knot;

struct mps_signal {
  mps_context *context;
  atomic_int references;
  mpsi_signal_motion (*at)(const mps_signal *signal, double t); /* any finite t */
  double start, end;                                            /* s */
  bool value; /* a number, u of the motion, and no motion */
  /* The caller's own function; NULL: `at` is the motion. */
  mps_signal_fn fn;
  void *user;
  mps_release_fn release;
  /* The analytic kinds: amplitude, and c (1/s2) and tp (s) of a Ricker wavelet, the angular
   * frequency (rad/s) and the phase of a sine, or the duration (s) of a ramp. */
  double amplitude, rate, shift;
  /* The table. */
  int64_t count;
  double knots_per_second;
  double coast; /* velocity after the table, m/s */
  mpsi_knot *knots;
  /* Of a file; count 0: the signal is not of one. */
  mps_signal_record_report record;
};

/* An empty signal of one owner, or NULL after recording that memory is short. */
mps_signal *mpsi_signal_new(mps_context *context, const char *function);

/* As mps_signal_create_table, on behalf of the public `function`; context and out are valid. */
mps_status mpsi_signal_from_table(mps_context *context, const char *function, int32_t quantity,
                                  int64_t count, const double *times, const double *values,
                                  mps_signal **out);

/* Multiplies both ends, `length` seconds each, with half a cosine wave that starts from 0. */
void mpsi_taper(int64_t count, const double *times, double *accelerations, double length);
/* Corrects the accelerations in place: see mps_signal_baseline. times[0] is 0. */
mps_status mpsi_baseline_correct(mps_context *context, const char *function, int32_t baseline,
                                 int64_t count, const double *times, double *accelerations);
