/* guard.h - re-entrancy: while a solver runs a callback, only its reading functions may be called.
 * One guard in each solver; every function that is not for reading begins with mpsi_guard_check,
 * the public destroy function too (it then returns without destroying).
 *
 *   mpsi_guard_enter(&s->guard, s->context, "the callback of mps_s_run");
 *   status = callback(user, s);
 *   status = mpsi_guard_leave(&s->guard, s->context, __func__, status);
 *
 * A whole call that asks signals and hooks on its way is guarded by its own name, from
 * mpsi_guard_enter to mpsi_guard_end; a callback may be within.
 * SPDX-License-Identifier: BSD-3-Clause */
#ifndef MPSI_GUARD_H
#define MPSI_GUARD_H

#include "core/internal.h"

typedef struct mpsi_guard {
  const char *callback; /* what is running, NULL: nothing */
  const char *outer;    /* the call that it is within, or NULL */
  int64_t failures;     /* of the context, when it began */
} mpsi_guard;

/* MPS_ERROR_STATE, recorded for `function`, while a callback of the object runs. */
mps_status mpsi_guard_check(const mpsi_guard *guard, mps_context *context, const char *function);
/* `callback` names it for messages and must outlive the call. */
void mpsi_guard_enter(mpsi_guard *guard, mps_context *context, const char *callback);
/* Ends the callback, which returned `status`. Where that is an error, the record of `function`
 * names the callback and keeps the message of a failure that the callback met on the same context.
 * Returns `status`, or MPS_ERROR_ARGUMENT where that is no status at all. */
mps_status mpsi_guard_leave(mpsi_guard *guard, mps_context *context, const char *function,
                            mps_status status);
/* The same of a callback without a guard, before which mpsi_failures(context) was `failures`. */
mps_status mpsi_callback_status(mps_context *context, const char *function, const char *callback,
                                int64_t failures, mps_status status);
/* The same for what needs a whole state but changes none, such as a snapshot: allowed in a callback
 * that comes between two steps of a run, and not from a hook, signal or law within a step. */
mps_status mpsi_guard_check_between(const mpsi_guard *guard, mps_context *context,
                                    const char *function);
/* While something calls back from wherever it may be: returns the guard as it was, to be put back.
 */
mpsi_guard mpsi_guard_close(mpsi_guard *guard, mps_context *context, const char *callback);
/* Ends a guarded call that answers for its status itself. */
void mpsi_guard_end(mpsi_guard *guard);

#endif
