/* regression.h - the paper's regression of stability limits, Yoshida (14)-(16), and its Table 2.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { FIT_MOST_DAMPINGS = 32 };

/* dt = a1 (R/V)^a2 for each damping ratio; log10 a1 and log10 a2 are quadratics of log10 h over
 * h <= h_max. */
typedef struct limit_fit {
  int32_t dampings; /* number of distinct h */
  double h[FIT_MOST_DAMPINGS], a1[FIT_MOST_DAMPINGS], a2[FIT_MOST_DAMPINGS];
  double b1[3], b2[3]; /* b11 b12 b13 and b21 b22 b23 */
  double rms;          /* relative rms of the fitted against the given dt, h <= h_max */
} limit_fit;

/* Fits `count` limits dt[k] (s) of radius R[k] (m), velocity V[k] (m/s), damping h[k], all > 0, by
 * least squares. Each h needs at least 2 distinct R/V, and h_max at least 3 distinct h. False with
 * the reason in `why`. */
bool limit_fit_make(int64_t count, const double *R, const double *V, const double *h,
                    const double *dt, double h_max, limit_fit *out, char why[160]);
/* dt (s) of a fit's quadratics at R, V, h. */
double limit_fit_dt(const limit_fit *fit, double R, double V, double h);
/* The printed Table 2 as a fit (only b1 and b2 are set): wave 'S' or 'P'. Up to 1.5 times above the
 * linear limit, and so no safe time step. */
limit_fit limit_fit_printed(char wave);
