/* signal_internal.h - what solvers and bodies use of a signal besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/base/given.h"

#include <mps/signal.h>

#include <stdbool.h>

typedef struct mpsi_signal_motion {
  double u, v, a; /* m, m/s, m/s2 */
} mpsi_signal_motion;

/* The object that evaluates a signal, for the record of a failure: signal[1] of boundary 3. */
typedef struct mpsi_signal_use {
  mps_context *context; /* NULL: nothing is recorded */
  const char *function;
  const char *owner; /* "boundary" */
  int32_t number;    /* of the owner; -1: it has none (yet) */
  int32_t component; /* of the owner's signals; -1: it has but one */
} mpsi_signal_use;

/* Motion at the finite time t (s); of a NULL signal: at rest at 0. All of the library evaluates
 * signals here, before the call in which it does has changed anything. The caller's function may
 * refuse, and a signal may give what is not finite (MPS_ERROR_NUMERIC): both are recorded with the
 * signal, its owner and the time, and *out stays. */
mps_status mpsi_signal_evaluate(const mps_signal *signal, mpsi_signal_use use, double t,
                                mpsi_signal_motion *out);
/* Number at time t; 1 without a signal: a factor in time. Otherwise as mpsi_signal_evaluate. */
mps_status mpsi_signal_factor(const mps_signal *signal, mpsi_signal_use use, double t, double *out);

typedef enum mpsi_signal_role { MPSI_SIGNAL_NUMBER, MPSI_SIGNAL_MOTION } mpsi_signal_role;
/* Checks that the signals (NULL: none) of a definition, its member `signal` of `count` components,
 * are numbers, or motions. Every definition that takes signals asks here. */
mps_status mpsi_signal_check(mps_context *context, const char *function, mpsi_signal_role role,
                             int count, mps_signal *const *signal);
/* Whether the caller may refuse: the signal is a function of the caller. NULL: no. */
bool mpsi_signal_may_fail(const mps_signal *signal);
/* A signal of a function, on behalf of the public `function`; `release` (NULL: none) is called with
 * `user` when the last reference ends. */
mps_status mpsi_signal_create_owned(mps_context *context, const char *function, mps_signal_fn fn,
                                    void (*release)(void *user), void *user, mps_signal **out);
/* Adds that hash. */
void mpsi_signal_give(mpsi_given *list, const char *name, const mps_signal *signal);
