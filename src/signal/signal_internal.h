/* signal_internal.h - what solvers and bodies use of a signal besides the public functions.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_SIGNAL_INTERNAL_H
#define MPSI_SIGNAL_INTERNAL_H

#include <mps/signal.h>

#include <stdbool.h>

typedef struct mpsi_signal_motion {
  double u, v, a; /* m, m/s, m/s2 */
} mpsi_signal_motion;

/* Motion at the finite time t (s); of a NULL signal: at rest at 0. When the caller's function
 * refuses or gives what is not finite, that is recorded on `context` for `function`. */
mps_status mpsi_signal_at(const mps_signal *signal, mps_context *context, const char *function,
                          double t, mpsi_signal_motion *out);
/* Whether mpsi_signal_at can fail: the signal is a function of the caller. NULL: no. */
bool mpsi_signal_may_fail(const mps_signal *signal);
/* Goes on with a hash (core/hash.h) over what the signal is made of; of a function of the caller,
 * over that it is one. */
uint64_t mpsi_signal_hash(const mps_signal *signal, uint64_t hash);

#endif
