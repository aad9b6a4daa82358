/* guard.c - re-entrancy of objects with callbacks, and the record of a callback's status.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "guard.h"

#include "context_private.h"

#include <stdio.h>

mps_status mpsi_guard_check(const mpsi_guard *guard, mps_context *context, const char *function) {
  if (!guard->callback) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_STATE,
                   "called from %s of the same object: a callback may only read it",
                   guard->callback);
}

mps_status mpsi_guard_check_between(const mpsi_guard *guard, mps_context *context,
                                    const char *function) {
  if (!guard->callback || guard->outer) return MPS_OK;
  return mpsi_fail(context, function, MPS_ERROR_STATE,
                   "called back from within %s: the state is between two steps", guard->callback);
}

void mpsi_guard_enter(mpsi_guard *guard, mps_context *context, const char *callback) {
  guard->outer = guard->callback;
  guard->callback = callback;
  guard->failures = context->failures;
}

mpsi_guard mpsi_guard_close(mpsi_guard *guard, mps_context *context, const char *callback) {
  const mpsi_guard former = *guard;
  *guard = (mpsi_guard){.callback = callback, .failures = context->failures};
  return former;
}

void mpsi_guard_end(mpsi_guard *guard) {
  guard->callback = guard->outer;
  guard->outer = NULL;
}

mps_status mpsi_callback_status(mps_context *context, const char *function, const char *callback,
                                int64_t failures, mps_status status) {
  if (status == MPS_OK) return MPS_OK;
  const mps_error *error = &context->error;
  char reason[380] = "";
  if (context->failures != failures && error->status == status)
    snprintf(reason, sizeof reason, ": %.63s: %.300s", error->function, error->message);
  const bool known = status > MPS_OK && status <= MPS_ERROR_INTERNAL;
  return mpsi_fail(context, function, known ? status : MPS_ERROR_ARGUMENT,
                   "%s returned status %d (%s)%s", callback, (int)status, mps_status_text(status),
                   reason);
}

mps_status mpsi_guard_leave(mpsi_guard *guard, mps_context *context, const char *function,
                            mps_status status) {
  const char *callback = guard->callback;
  mpsi_guard_end(guard);
  return mpsi_callback_status(context, function, callback, guard->failures, status);
}
