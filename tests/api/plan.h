/* plan.h - what the callbacks of one call do: whether one of them misbehaves, and how. It follows
 * from numbers that are drawn before the call, so that a printed program (record.c) has the same
 * callbacks with the same faults. callbacks.c needs nothing else. SPDX-License-Identifier:
 * BSD-3-Clause */
#ifndef TESTS_API_PLAN_H
#define TESTS_API_PLAN_H

#include <mps/mps.h>
#include <mps/experimental/domain.h>
#include <mps/experimental/linear_solver.h>

#include <stdatomic.h>
#include <stdbool.h>

/* Fault of a callback, once, in one call. */
typedef enum api_fault {
  API_FAULT_NONE,
  API_FAULT_STATUS,    /* returns an error */
  API_FAULT_NO_STATUS, /* returns a number that is no status */
  API_FAULT_VALUE,     /* writes NaN */
  API_FAULT_FORBIDDEN, /* calls what a callback may not call */
  API_FAULTS
} api_fault;

typedef struct api_memory {
  atomic_llong live, calls, refused;
  atomic_llong refuse_from, refuse_to; /* calls by number, from 1; 0: none */
} api_memory;

enum {
  API_PLAN_MPM = 1,
  API_PLAN_DYNAMICS,
  API_PLAN_ELASTIC,
  API_PLAN_FLUID
}; /* kinds of solvers */

typedef struct api_plan {
  api_fault fault;
  int64_t at;                 /* call of a callback that misbehaves, from 1 */
  mps_status status;          /* what it returns */
  uint32_t choice;            /* of values and calls */
  int32_t kind;               /* of the solver that runs */
  void *solver;               /* NULL: none runs */
  int64_t cancel_at;          /* call of the cancel hook that returns "stop" */
  int64_t callbacks, cancels; /* so far in this call */
  bool faulted;
  const char *broken; /* what a callback has found; NULL: nothing */
} api_plan;

/* In a callback on the thread of the call: makes the fault if it is due. `user` is the plan. */
mps_status api_callback(void *user, double *values, int count);

void *api_get_memory(void *user, size_t size, size_t alignment); /* `user`: api_memory */
void api_return_memory(void *user, void *block);
void api_write_log(void *user, int32_t level, const char *message);
void api_show_progress(void *user, const mps_context_progress *progress);
int32_t api_cancel(void *user);
void api_count_unit(void *task, int64_t index, int32_t worker); /* `task`: atomic_llong */
mps_status api_law(void *user, const mps_material_block *block);
MPS_MATERIAL_UMAT(api_umat);
mps_status api_motion(void *user, double t, double values[3]);
mps_status api_number(void *user, double t, double values[3]);
mps_status api_inside_disc(void *user, const double *x, int32_t *inside);
mps_status api_flat(void *user, const double *x, double *level);
mps_status api_some_stress(void *user, const double *x, double *stress);
mps_status api_traction(void *user, const double *x, const double *normal, double *out);
mps_status api_column(void *user, mps_solver *solver, double *value);
mps_status api_linear_matrix(void *user, const mps_linear_matrix *matrix);
mps_status api_linear_solve(void *user, const double *b, double tolerance, double *x,
                            mps_linear_result *result);
mps_status api_linear_forget(void *user);
mps_status api_rendezvous(void *user, int32_t count, const mps_domain_message *messages,
                          mps_domain_room_fn room, void *room_user);
mps_status api_star_create(void *user, int64_t own, int64_t guests, const int32_t *rank,
                           const int64_t *index, void **out);
mps_status api_star_begin(void *user, void *given, int32_t item_bytes, const void *own,
                          void *guests);
mps_status api_star_end(void *user, void *given);
void api_star_destroy(void *user, void *given);
mps_status api_reduce_max(void *user, int32_t count, double *values);
mps_status api_reduce_sum(void *user, int32_t count, int64_t *values);
mps_status api_in_run_mpm(void *user, mps_mpm *s);
mps_status api_in_run_dynamics(void *user, mps_dynamics *s);
mps_status api_in_run_elastic(void *user, mps_elastic *s);
mps_status api_in_run_fluid(void *user, mps_fluid *s);

#endif
