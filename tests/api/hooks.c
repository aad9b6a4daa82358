/* hooks.c - callbacks of the library: memory that counts and refuses, the hooks of a context, and
 * faults of callbacks: an error, a number that is no status, a NaN, or by calling what
 * a callback may not call. SPDX-License-Identifier: BSD-3-Clause */
#include "api.h"

#include <mps/mps.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No scene needs more than that: an absurd size is then refused at once. */
static const size_t largest = (size_t)1 << 28;

static void *get_memory(void *user, size_t size, size_t alignment) {
  api_memory *memory = user;
  const long long call = atomic_fetch_add(&memory->calls, 1) + 1;
  const long long from = atomic_load(&memory->refuse_from);
  if (size > largest || (from > 0 && call >= from && call <= atomic_load(&memory->refuse_to))) {
    atomic_fetch_add(&memory->refused, 1);
    return NULL;
  }
  void *block = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  if (!block) return NULL;
  memset(block, 0xff, size); /* NaN: a read before a write is detected */
  atomic_fetch_add(&memory->live, 1);
  return block;
}

static void return_memory(void *user, void *block) {
  atomic_fetch_sub(&((api_memory *)user)->live, 1);
  free(block);
}

/* ---- calls that a callback may not make ------------------------------------------------------ */

#define SOLVER(solver)                                                                             \
  static mps_status forbid_##solver(api *a, mps_##solver *s, const char **what) {                  \
    mps_snapshot *snapshot = NULL;                                                                 \
    mps_##solver *copy = s;                                                                        \
    switch (api_below(a, 5)) {                                                                     \
    case 0:                                                                                        \
      *what = "mps_" #solver "_step";                                                              \
      return mps_##solver##_step(s, 1);                                                            \
    case 1:                                                                                        \
      *what = "mps_" #solver "_run";                                                               \
      return mps_##solver##_run(s, mps_##solver##_time(s), 1, NULL, NULL);                         \
    case 2:                                                                                        \
      *what = "mps_" #solver "_remove_boundary";                                                   \
      return mps_##solver##_remove_boundary(s, 0);                                                 \
    case 3: /* nothing happens */                                                                  \
      mps_##solver##_destroy(&copy);                                                               \
      *what = "mps_" #solver "_destroy";                                                           \
      return MPS_ERROR_STATE;                                                                      \
    default: /* allowed in the callback of a run, never harmful */                                 \
      *what = "mps_" #solver "_snapshot";                                                          \
      (void)!mps_##solver##_snapshot(s, &snapshot);                                                \
      mps_snapshot_destroy(&snapshot);                                                             \
      return MPS_ERROR_STATE;                                                                      \
    }                                                                                              \
  }
SOLVER(mpm)
SOLVER(dynamics)
SOLVER(elastic)
SOLVER(fluid)

static mps_status forbid_set(api *a, mps_particles *set, const char **what) {
  const double lo[] = {0, 0, 0}, hi[] = {1, 1, 1};
  const int64_t id = 0;
  mps_edit edit;
  switch (api_below(a, 4)) {
  case 0:
    *what = "mps_particles_edit";
    return mps_particles_edit(set, "position", &edit);
  case 1:
    *what = "mps_particles_fill_box";
    return mps_particles_fill_box(set, lo, hi, NULL);
  case 2:
    *what = "mps_particles_remove";
    return mps_particles_remove(set, 1, &id);
  default:
    *what = "mps_particles_append";
    return mps_particles_append(set, 1, lo);
  }
}

static void forbidden(api *a) {
  const char *what = "";
  void *s = a->running->handle;
  mps_status status = MPS_ERROR_STATE;
  const bool set = api_chance(a, 40);
  switch (a->running_kind) {
#define CASE(kind, solver)                                                                         \
  case kind:                                                                                       \
    status =                                                                                       \
        set ? forbid_set(a, mps_##solver##_particles(s), &what) : forbid_##solver(a, s, &what);    \
    break;
    CASE(API_MPM, mpm)
    CASE(API_DYNAMICS, dynamics)
    CASE(API_ELASTIC, elastic)
    CASE(API_FLUID, fluid)
#undef CASE
  default:
    return;
  }
  if (status != MPS_ERROR_STATE) api_broken(a, "a callback calls %s: %d", what, (int)status);
}

/* ---- callbacks ------------------------------------------------------------------------------- */

void api_arm(api *a) {
  if (a->latest || !api_chance(a, 15)) return;
  a->fault = (api_fault)(1 + api_below(a, API_FAULTS - 1));
  a->fault_at = 1 + (int64_t)api_below(a, UINT32_C(1) << api_below(a, 5));
  a->fault_status = (mps_status)(1 + api_below(a, MPS_ERROR_INTERNAL));
  static const char *const names[] = {"", "status", "no status", "NaN", "forbidden"};
  api_say(a, "/* callback %d: %s %d */ ", (int)a->fault_at, names[a->fault],
          a->fault == API_FAULT_STATUS ? (int)a->fault_status : 0);
}

void api_run_solver(api *a, api_kind kind, api_object *object) {
  a->running = object->handle ? object : NULL;
  a->running_kind = kind;
  api_arm(a);
  if (!a->latest && api_chance(a, 4)) a->cancel_at = 1 + (int64_t)api_below(a, 3);
  if (a->cancel_at > 0) api_say(a, "/* cancel %d */ ", (int)a->cancel_at);
}

mps_status api_callback(api *a, double *values, int count) {
  if (a->fault == API_FAULT_NONE || ++a->callbacks != a->fault_at) return MPS_OK;
  if (a->fault == API_FAULT_VALUE && count == 0) return MPS_OK;
  a->faulted = true;
  switch (a->fault) {
  case API_FAULT_STATUS:
    return a->fault_status;
  case API_FAULT_NO_STATUS:
    return (mps_status)(api_chance(a, 50) ? 77 : -3);
  case API_FAULT_VALUE:
    values[api_below(a, (uint32_t)count)] = api_chance(a, 50) ? NAN : INFINITY;
    return MPS_OK;
  case API_FAULT_FORBIDDEN:
    if (a->running) forbidden(a);
    return MPS_OK;
  default:
    return MPS_OK;
  }
}

/* Hooks have no status: of all faults only the forbidden call concerns them. */
static void hook(api *a) {
  if (a->fault == API_FAULT_FORBIDDEN && a->running) (void)api_callback(a, NULL, 0);
}

static void write_log(void *user, int32_t level, const char *message) {
  (void)level, (void)message;
  hook(user);
}

static void show_progress(void *user, const mps_context_progress *progress) {
  api *a = user;
  if (!(progress->fraction >= 0.0 && progress->fraction <= 1.0) || !progress->task)
    api_broken(a, "progress %g of a task", progress->fraction);
  hook(a);
}

/* A call that does not come to its end is stopped. */
static int32_t cancel(void *user) {
  api *a = user;
  hook(a);
  return ++a->cancels == a->cancel_at || a->cancels > 2000;
}

void api_hooks(api *a, mps_context_def *def) {
  def->alloc = get_memory;
  def->free = return_memory;
  def->memory_user = &a->memory;
  def->log = write_log;
  def->progress = show_progress;
  def->cancel = cancel;
  def->log_user = def->progress_user = def->cancel_user = a;
}
