/* coupling_private.h - a coupling: iterates, their answers H, and the differences that the
 * quasi-Newton method learns from. SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

#include <mps/experimental/coupling.h>

#include <stdbool.h>

#define MPSI_COUPLING_PAST 3 /* accepted values that guesses are made from */

/* How the residual and the answer changed from one repeat to the next. */
typedef struct mpsi_coupling_column {
  double *residual, *answer;
  int64_t step; /* accepted steps when it was seen */
} mpsi_coupling_column;

/* Sums over the last steps, see swing.c. */
typedef struct mpsi_coupling_swing {
  double across, middle, outer;
  int64_t seen; /* steps */
  bool warned;
} mpsi_coupling_swing;

struct mps_coupling {
  mps_context *context;
  mps_coupling_def def;
  double *block;
  double *x, *residual, *answer, *last_residual, *last_answer; /* of this step */
  double *past[MPSI_COUPLING_PAST];                            /* the newest first */
  mpsi_coupling_column *column;                                /* the newest first */
  double *basis, *triangle, *share;                            /* of the least squares */
  int64_t steps, all_repeats;
  int32_t columns, repeats;
  double factor, relative; /* Aitken's; |residual|/|answer| */
  bool open, agreed;
  mpsi_coupling_swing swing;
};

/* Warns once where the values, before they are accepted, swing too fast for the steps. */
void mpsi_coupling_watch(mps_coupling *c);

/* Takes up the difference between this repeat and the last. */
void mpsi_coupling_learn(mps_coupling *c);
/* Forgets the differences of steps before `oldest`, or from `newest` on. */
void mpsi_coupling_forget(mps_coupling *c, int64_t oldest, int64_t newest);
/* x becomes answer + W alpha with |V alpha + residual| least. False where nothing is known. */
bool mpsi_coupling_quasi_newton(mps_coupling *c);
double mpsi_coupling_dot(int64_t n, const double *a, const double *b);
