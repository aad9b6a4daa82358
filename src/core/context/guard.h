/* guard.h - re-entrancy: while a solver runs a callback, only its queries may be called. One guard
 * in each solver; every function that is not a query begins with mpsi_guard_check, the public
 * destroy function too (it then returns without destroying).
 *
 *   mpsi_guard_enter(&s->guard, s->context, "the callback of mps_s_run");
 *   status = callback(user, s);
 *   status = mpsi_guard_leave(&s->guard, s->context, __func__, status);
 *
 * A whole call that evaluates signals and hooks is guarded by its own name, from mpsi_guard_enter
 * to mpsi_guard_end; callbacks may be nested in it.
 * SPDX-License-Identifier: BSD-3-Clause */
#pragma once

#include "core/internal.h"

typedef struct mpsi_guard {
  const char *callback; /* running function, NULL: none */
  const char *outer;    /* enclosing call, or NULL */
  int64_t failures;     /* of the context, when it began */
} mpsi_guard;

/* MPS_ERROR_STATE, recorded for `function`, while a callback of the object runs. */
mps_status mpsi_guard_check(const mpsi_guard *guard, mps_context *context, const char *function);
/* `callback` names it for messages and must outlive the call. */
void mpsi_guard_enter(mpsi_guard *guard, mps_context *context, const char *callback);
/* Ends the callback, which returned `status`. Where that is an error, the record of `function`
 * names the callback and keeps the message of a failure in the callback on the same context.
 * Returns `status`, or MPS_ERROR_ARGUMENT where that is not a status. */
mps_status mpsi_guard_leave(mpsi_guard *guard, mps_context *context, const char *function,
                            mps_status status);
/* The same for a callback without a guard, before which mpsi_failures(context) was `failures`. */
mps_status mpsi_callback_status(mps_context *context, const char *function, const char *callback,
                                int64_t failures, mps_status status);
/* The same for functions that need a complete state and change none, such as a snapshot: allowed in
 * a callback between two steps of a run, and not from a hook, signal or law within a step. */
mps_status mpsi_guard_check_between(const mpsi_guard *guard, mps_context *context,
                                    const char *function);
/* For a callback at any point: returns the present guard, to be restored after it. */
mpsi_guard mpsi_guard_close(mpsi_guard *guard, mps_context *context, const char *callback);
/* Ends a guarded call that records its status itself. */
void mpsi_guard_end(mpsi_guard *guard);
