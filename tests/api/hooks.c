/* hooks.c - faults of the callbacks (callbacks.c), drawn before a call, and the hooks of a context.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

void api_arm(api *a) {
  if (a->latest || !api_chance(a, 15)) return;
  a->plan.fault = (api_fault)(1 + api_below(a, API_FAULTS - 1));
  a->plan.at = 1 + (int64_t)api_below(a, UINT32_C(1) << api_below(a, 5));
  a->plan.status = (mps_status)(1 + api_below(a, MPS_ERROR_INTERNAL));
  a->plan.choice = api_below(a, 1000);
  static const char *const names[] = {"", "status", "no status", "NaN", "forbidden"};
  api_say(a, "/* callback %d: %s %d */ ", (int)a->plan.at, names[a->plan.fault],
          a->plan.fault == API_FAULT_STATUS ? (int)a->plan.status : 0);
}

void api_run_solver(api *a, api_kind kind, api_object *object) {
  a->plan.solver = object->handle;
  a->plan.kind = API_PLAN_MPM + (int32_t)kind - API_MPM;
  api_arm(a);
  if (!a->latest && api_chance(a, 4)) a->plan.cancel_at = 1 + (int64_t)api_below(a, 3);
  if (a->plan.cancel_at > 0) api_say(a, "/* cancel %d */ ", (int)a->plan.cancel_at);
}

void api_hooks(api *a, mps_context_def *def) {
  def->alloc = api_get_memory;
  def->free = api_return_memory;
  def->memory_user = &a->memory;
  def->log = api_write_log;
  def->progress = api_show_progress;
  def->cancel = api_cancel;
  def->log_user = def->progress_user = def->cancel_user = &a->plan;
}
