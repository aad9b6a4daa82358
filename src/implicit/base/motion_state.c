/* motion_state.c - the state of a motion: its arrays, its end, and its time.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "motion_state.h"
#include "implicit/base/implicit_solver.h"

#include <string.h>

#define ARRAYS 11
static void list_arrays(mpsi_elastic_motion *m, double **list[ARRAYS]) {
  double **const all[ARRAYS] = {&m->velocity, &m->acceleration, &m->force,   &m->inner,
                                &m->held,     &m->scratch,      &m->next[0], &m->next[1],
                                &m->next[2],  &m->next[3],      &m->next[4]};
  memcpy(list, all, sizeof all);
}

void mpsi_elastic_free_arrays(mps_elastic *e, mpsi_elastic_motion *m) {
  double **array[ARRAYS];
  list_arrays(m, array);
  for (int k = 0; k < ARRAYS; k++) {
    mpsi_free(e->context, *array[k]);
    *array[k] = NULL;
  }
}

mps_status mpsi_elastic_allocate_motion(mps_elastic *e, const char *function,
                                        mpsi_elastic_motion *m) {
  const int64_t all = e->n * e->dim;
  double **array[ARRAYS];
  list_arrays(m, array);
  for (int k = 0; k < ARRAYS; k++)
    if (!(*array[k] = mpsi_alloc(e->context, all, sizeof(double))))
      return mpsi_fail_memory(e->context, function, (size_t)all * sizeof(double));
  return MPS_OK;
}

void mpsi_elastic_move_arrays(mpsi_elastic_motion *from, mpsi_elastic_motion *to) {
  double **source[ARRAYS], **target[ARRAYS];
  list_arrays(from, source), list_arrays(to, target);
  for (int k = 0; k < ARRAYS; k++) {
    *target[k] = *source[k];
    *source[k] = NULL;
  }
}

void mpsi_elastic_end_motion(mps_elastic *e) {
  if (e->motion) mpsi_elastic_free_arrays(e, e->motion);
  MPSI_FREE(e->context, e->motion, e->ended);
  e->motion = e->ended = NULL;
}

void mpsi_elastic_suspend_motion(mps_elastic *e) {
  if (!e->motion) return;
  mpsi_elastic_free_arrays(e, e->motion);
  mpsi_free(e->context, e->ended);
  e->ended = e->motion;
  e->motion = NULL;
}

double mpsi_elastic_time(const void *solver) {
  const mps_elastic *e = solver;
  return e->motion ? e->motion->time : 0.0;
}

int64_t mpsi_elastic_steps(const void *solver) {
  const mps_elastic *e = solver;
  return e->motion ? e->motion->steps : 0;
}

double mpsi_elastic_dt(void *solver, const char *function) {
  const mps_elastic *e = solver;
  return e->motion ? e->motion->dt : 0.0;
}
