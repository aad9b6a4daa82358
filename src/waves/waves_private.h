/* waves_private.h - the members of a sea, for the files of this folder only.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <mps/experimental/waves.h>

#include <complex.h>
#include <math.h>

#define MPSI_WAVES_HARMONICS 32 /* of the stream function */
#define MPSI_WAVES_PI 3.14159265358979323846

/* Whether a member of a definition is in 1e-12 to 1e12, of which products and ratios are numbers
 * that neither overflow nor vanish; or NaN. */
static inline bool mpsi_waves_positive(double value) { return value >= 1e-12 && value <= 1e12; }

/* A wave of first order: Re A exp(i (omega t - k x)). */
typedef struct mpsi_wave {
  int64_t bin;      /* its frequency is bin/repeat */
  double omega;     /* rad/s */
  double k;         /* rad/m */
  double far, near; /* transfer functions of the piston: mps_waves_find_piston */
  double complex a; /* A, m */
} mpsi_wave;

struct mps_waves {
  mps_context *context;
  atomic_int references;
  mps_waves_def def;           /* without its arrays */
  double period, repeat, ramp; /* s, as found */
  int64_t count;
  mpsi_wave *wave; /* ascending frequency */
  int64_t bins;    /* of second order: frequencies 1/repeat to bins/repeat; 0: none */
  /* bins + 1 amplitudes (m): of the second-order displacement of the piston, of bound waves at x =
   * 0 */
  double complex *push, *bound;
  double solitary; /* m/s: speed of a solitary wave, which has no components; 0: other waves */
  double complex *shape; /* THEORY_STREAM: harmonics of the level, m; NULL: another theory */
  mps_waves_report report;
};

mps_waves *mpsi_waves_retain(mps_waves *waves);

/* components.c: fills `wave` and `count`, period and repeat, from a definition that is checked. */
mps_status mpsi_waves_make_components(mps_waves *w, const mps_waves_def *def);

/* second_order.c. */
/* Fills `push` of a sea with the components. */
mps_status mpsi_waves_find_push(mps_waves *w);
/* Adds the bound waves at x (m) to `eta`, bins + 1 amplitudes. */
void mpsi_waves_add_bound(const mps_waves *w, double x, double complex *eta);

/* stream.c: the harmonics of a regular wave and of its piston, in place of those of second order.
 */
mps_status mpsi_waves_make_stream(mps_waves *w);

/* solitary.c: fills period, repeat and report; the motion of the piston, and the level at x. */
mps_status mpsi_waves_make_solitary(mps_waves *w);
void mpsi_waves_move_solitary(const mps_waves *w, double t, double motion[4]);
double mpsi_waves_solitary_level(const mps_waves *w, double x, double t);

/* motion.c: displacement, velocity, acceleration and level at the piston; `eta`: bound waves of x =
 * 0 or NULL. */
void mpsi_waves_move(const mps_waves *w, double t, const double complex *eta, double motion[4]);
/* The first three at `count` times t, t + step, ..., at most MPSI_WAVES_BLOCK. */
#define MPSI_WAVES_BLOCK 256
void mpsi_waves_move_evenly(const mps_waves *w, double t, double step, int64_t count,
                            double (*motion)[3]);
