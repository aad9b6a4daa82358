/* series.h - evaluation of tables of samples: harmonics, means, decay.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* Samples of a quantity at ascending times, each `stride` bytes behind the one before. */
typedef struct series {
  int64_t count;
  size_t stride;
  const double *t, *value; /* s; of the first sample */
} series;

/* Amplitude of the first harmonic of `period` (s) over the whole periods before `to` that begin at
 * `from` at the earliest; NaN where there is less than one. `phase` (rad, may be NULL): before
 * sin(2 pi t/T). */
double series_harmonic(const series *s, double period, double from, double to, double *phase);
/* Mean between two times, NaN where the samples do not reach as far. */
double series_mean(const series *s, double from, double to);
/* Decay rate (1/s) of the amplitude of a standing wave of `period` between two times, from its
 * kinetic energy: half the decay rate of that, by a linear fit of the logarithms of its means over
 * a period. NaN where there are less than two periods. */
double series_wave_decay(const series *kinetic, double period, double from, double to);
