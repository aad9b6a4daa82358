/* callbacks.c - all that the library calls: memory that counts and refuses, the hooks of a context,
 * laws, signals, foreign solvers, a domain of one rank; and their faults (plan.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No scene needs more than that: an absurd size is then refused at once. */
static const size_t largest = (size_t)1 << 28;

void *api_get_memory(void *user, size_t size, size_t alignment) {
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

void api_return_memory(void *user, void *block) {
  atomic_fetch_sub(&((api_memory *)user)->live, 1);
  free(block);
}

/* ---- calls that a callback may not make ------------------------------------------------------ */

#define SOLVER(solver)                                                                             \
  static mps_status forbid_##solver(uint32_t choice, mps_##solver *s, const char **what) {         \
    mps_snapshot *snapshot = NULL;                                                                 \
    mps_##solver *copy = s;                                                                        \
    switch (choice % 5) {                                                                          \
    case 0:                                                                                        \
      *what = "a callback calls mps_" #solver "_step";                                             \
      return mps_##solver##_step(s, 1);                                                            \
    case 1:                                                                                        \
      *what = "a callback calls mps_" #solver "_run";                                              \
      return mps_##solver##_run(s, mps_##solver##_time(s), 1, NULL, NULL);                         \
    case 2:                                                                                        \
      *what = "a callback calls mps_" #solver "_remove_boundary";                                  \
      return mps_##solver##_remove_boundary(s, 0);                                                 \
    case 3: /* nothing happens */                                                                  \
      mps_##solver##_destroy(&copy);                                                               \
      *what = "a callback calls mps_" #solver "_destroy";                                          \
      return MPS_ERROR_STATE;                                                                      \
    default: /* allowed in the callback of a run, never harmful */                                 \
      *what = "a callback calls mps_" #solver "_snapshot";                                         \
      (void)!mps_##solver##_snapshot(s, &snapshot);                                                \
      mps_snapshot_destroy(&snapshot);                                                             \
      return MPS_ERROR_STATE;                                                                      \
    }                                                                                              \
  }
SOLVER(mpm)
SOLVER(dynamics)
SOLVER(elastic)
SOLVER(fluid)

static mps_status forbid_set(uint32_t choice, mps_particles *set, const char **what) {
  const double lo[] = {0, 0, 0}, hi[] = {1, 1, 1};
  const int64_t id = 0;
  mps_edit edit;
  switch (choice % 4) {
  case 0:
    *what = "a callback calls mps_particles_edit";
    return mps_particles_edit(set, "position", &edit);
  case 1:
    *what = "a callback calls mps_particles_fill_box";
    return mps_particles_fill_box(set, lo, hi, NULL);
  case 2:
    *what = "a callback calls mps_particles_remove";
    return mps_particles_remove(set, &id, 1);
  default:
    *what = "a callback calls mps_particles_append";
    return mps_particles_append(set, 1, lo);
  }
}

static void forbidden(api_plan *plan) {
  const char *what = "";
  mps_status status = MPS_ERROR_STATE;
  const uint32_t of_set = plan->choice % 5 < 2, choice = plan->choice / 5;
  switch (plan->kind) {
#define CASE(number, S)                                                                            \
  case number:                                                                                     \
    status = of_set ? forbid_set(choice, mps_##S##_particles(plan->solver), &what)                 \
                    : forbid_##S(choice, plan->solver, &what);                                     \
    break;
    CASE(API_PLAN_MPM, mpm)
    CASE(API_PLAN_DYNAMICS, dynamics)
    CASE(API_PLAN_ELASTIC, elastic)
    CASE(API_PLAN_FLUID, fluid)
#undef CASE
  default:
    return;
  }
  if (status != MPS_ERROR_STATE) plan->broken = what;
}

/* ---- faults ---------------------------------------------------------------------------------- */

mps_status api_callback(void *user, double *values, int count) {
  api_plan *plan = user;
  if (plan->fault == API_FAULT_NONE || ++plan->callbacks != plan->at) return MPS_OK;
  if (plan->fault == API_FAULT_VALUE && count == 0) return MPS_OK;
  plan->faulted = true;
  switch (plan->fault) {
  case API_FAULT_STATUS:
    return plan->status;
  case API_FAULT_NO_STATUS:
    return (mps_status)(plan->choice % 2 ? 77 : -3);
  case API_FAULT_VALUE:
    values[plan->choice / 2 % (uint32_t)count] = plan->choice % 2 ? NAN : INFINITY;
    return MPS_OK;
  case API_FAULT_FORBIDDEN:
    if (plan->solver) forbidden(plan);
    return MPS_OK;
  default:
    return MPS_OK;
  }
}

/* Hooks have no status: of all faults only the forbidden call concerns them. */
static void hook(api_plan *plan) {
  if (plan->fault == API_FAULT_FORBIDDEN && plan->solver) (void)api_callback(plan, NULL, 0);
}

void api_write_log(void *user, int32_t level, const char *message) {
  (void)level, (void)message;
  hook(user);
}

void api_show_progress(void *user, const mps_context_progress *progress) {
  api_plan *plan = user;
  if (!(progress->fraction >= 0.0 && progress->fraction <= 1.0) || !progress->task)
    plan->broken = "shows a progress that is no fraction of a task";
  hook(plan);
}

/* A call that does not come to its end is stopped. */
int32_t api_cancel(void *user) {
  api_plan *plan = user;
  hook(plan);
  return ++plan->cancels == plan->cancel_at || plan->cancels > 2000;
}

void api_count_unit(void *task, int64_t index, int32_t worker) {
  atomic_llong *sum = task;
  atomic_fetch_add(sum, index + 1);
  (void)worker;
}

/* ---- laws, signals, fields ------------------------------------------------------------------- */

/* Elastic along each axis. Several threads call it at once: what it does follows from the block
 * alone, and from the plan. */
mps_status api_law(void *user, const mps_material_block *block) {
  const api_plan *plan = user;
  const bool turn = plan->fault != API_FAULT_NONE && block->count > 2 && plan->at <= 3;
  for (int64_t i = 0; i < block->count; i++)
    for (int k = 0; k < 3; k++) {
      const double *slope = block->gradient[4 * k];
      if (slope) block->stress[k][i] += 1e5 * block->dt * slope[i];
    }
  if (block->history_count > 0)
    for (int64_t i = 0; i < block->count; i++) block->history[0][i] += block->dt;
  if (!turn) return MPS_OK;
  if (plan->fault == API_FAULT_VALUE) block->stress[0][0] = NAN;
  if (block->refused) *block->refused = 0;
  if (plan->fault == API_FAULT_STATUS) return plan->status;
  return plan->fault == API_FAULT_NO_STATUS ? (mps_status)99 : MPS_OK;
}

MPS_MATERIAL_UMAT(api_umat) {
  MPS_MATERIAL_UMAT_UNUSED;
  for (int32_t k = 0; k < *ntens; k++) stress[k] += 1e5 * dstran[k];
  for (int32_t k = 0; k < *nstatv; k++) statev[k] += 1.0;
  if (*nprops > 0 && props[0] > 0.9) *pnewdt = 0.5; /* refuses every step */
}

mps_status api_motion(void *user, double t, double values[3]) {
  values[0] = 0.01 * sin(20.0 * t), values[1] = 0.2 * cos(20.0 * t),
  values[2] = -4.0 * sin(20.0 * t);
  return api_callback(user, values, 3);
}

mps_status api_number(void *user, double t, double values[3]) {
  values[0] = 1.0 + 0.2 * sin(20.0 * t);
  return api_callback(user, values, 1); /* the others are not read */
}

mps_status api_inside_disc(void *user, const double *x, int32_t *inside) {
  *inside = (x[0] - 0.4) * (x[0] - 0.4) + (x[1] - 0.4) * (x[1] - 0.4) < 0.09;
  return api_callback(user, NULL, 0);
}

mps_status api_flat(void *user, const double *x, double *level) {
  *level = 1.0 + 0.1 * x[0];
  return api_callback(user, level, 1);
}

mps_status api_some_stress(void *user, const double *x, double *stress) {
  for (int k = 0; k < 4; k++) stress[k] = -100.0 * x[1];
  return api_callback(user, stress, 4);
}

mps_status api_traction(void *user, const double *x, const double *normal, double *out) {
  (void)x;
  out[0] = 10.0 * normal[0], out[1] = -10.0;
  return api_callback(user, out, 2);
}

/* ---- a linear solver, which does not solve ----------------------------------------------------
 */

/* NaN is a value too. */
mps_status api_column(void *user, mps_solver *solver, double *value) {
  *value = mps_solver_time(solver);
  return api_callback(user, NULL, 0);
}

mps_status api_linear_matrix(void *user, const mps_linear_matrix *matrix) {
  (void)matrix;
  return api_callback(user, NULL, 0);
}

mps_status api_linear_solve(void *user, const double *b, double tolerance, double *x,
                            mps_linear_result *result) {
  (void)b, (void)tolerance;
  result->iterations = 1;
  return api_callback(user, x, 1);
}

mps_status api_linear_forget(void *user) { return api_callback(user, NULL, 0); }

/* ---- a domain of one rank -------------------------------------------------------------------- */

typedef struct star {
  int64_t guests, *index;
} star;

mps_status api_rendezvous(void *user, int32_t count, const mps_domain_message *messages,
                          mps_domain_room_fn room, void *room_user) {
  for (int32_t k = 0; k < count; k++) {
    void *to = room(room_user, 0, messages[k].bytes);
    if (!to && messages[k].bytes > 0) return MPS_ERROR_MEMORY;
    if (to) memcpy(to, messages[k].data, (size_t)messages[k].bytes);
  }
  return api_callback(user, NULL, 0);
}

mps_status api_star_create(void *user, int64_t own, int64_t guests, const int32_t *rank,
                           const int64_t *index, void **out) {
  (void)own, (void)rank;
  star *s = malloc(sizeof *s);
  if (!s) return MPS_ERROR_MEMORY;
  s->guests = guests;
  s->index = malloc((size_t)(guests + 1) * sizeof *s->index);
  if (s->index && guests > 0) memcpy(s->index, index, (size_t)guests * sizeof *s->index);
  const mps_status status = s->index ? api_callback(user, NULL, 0) : MPS_ERROR_MEMORY;
  if (status == MPS_OK) {
    *out = s;
    return MPS_OK;
  }
  free(s->index);
  free(s);
  return status;
}

mps_status api_star_begin(void *user, void *given, int32_t item_bytes, const void *own,
                          void *guests) {
  const star *s = given;
  const size_t bytes = (size_t)item_bytes;
  for (int64_t k = 0; k < s->guests; k++)
    memcpy((char *)guests + (size_t)k * bytes, (const char *)own + (size_t)s->index[k] * bytes,
           bytes);
  return api_callback(user, NULL, 0);
}

mps_status api_star_end(void *user, void *given) {
  (void)given;
  return api_callback(user, NULL, 0);
}

void api_star_destroy(void *user, void *given) {
  (void)user;
  free(((star *)given)->index);
  free(given);
}

mps_status api_reduce_max(void *user, int32_t count, double *values) {
  for (int32_t k = 0; k < count; k++)
    if (isnan(values[k])) ((api_plan *)user)->broken = "reduces a NaN";
  return api_callback(user, NULL, 0);
}

mps_status api_reduce_sum(void *user, int32_t count, int64_t *values) {
  (void)count, (void)values;
  return api_callback(user, NULL, 0);
}

/* ---- callbacks of runs ----------------------------------------------------------------------- */

#define IN_RUN(solver)                                                                             \
  mps_status api_in_run_##solver(void *user, mps_##solver *s) {                                    \
    (void)s;                                                                                       \
    return api_callback(user, NULL, 0);                                                            \
  }
IN_RUN(mpm)
IN_RUN(dynamics)
IN_RUN(elastic)
IN_RUN(fluid)
