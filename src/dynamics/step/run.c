/* run.c - steps and runs, for the loop of all solvers (solver/solver_base.h).
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/particles/particles_internal.h"
#include "run.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/limit/dt.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/ground.h"
#include "dynamics/step/step.h"

#include <float.h>

#define PROMPT_WORK 5000000 /* particle-steps between calls of the cancel hook: some 0.1 s */

/* Before steps: reads edited material fields and allocates the budget's arrays. */
static mps_status prepare_run(mps_dynamics *dynamics, const char *function) {
  mps_status status = mpsi_particles_ready(dynamics->particles, function);
  if (status == MPS_OK && mpsi_particles_column(dynamics->particles, "external_force", 0) &&
      !mpsi_dynamics_reserve_accounts(dynamics))
    status = mpsi_fail_memory(dynamics->context, function, (size_t)dynamics->count * 24);
  return mpsi_dynamics_reread_ground(dynamics, function, status);
}

/* Before the first step of `length`: reads the edited motion, if the signals of that step succeed.
 */
static mps_status take_motion(mps_dynamics *dynamics, const char *function, double length) {
  if (!dynamics->begins) return MPS_OK;
  MPSI_TRY(mpsi_dynamics_look_ahead(dynamics, function, length));
  return mpsi_dynamics_begin(dynamics, function, mpsi_dynamics_time(dynamics));
}

mps_status mpsi_dynamics_check_diverged(const mps_dynamics *dynamics, const char *function) {
  if (!dynamics->diverged) return MPS_OK; /* on all ranks */
  return mpsi_fail(dynamics->context, function, MPS_ERROR_STATE,
                   "the run has diverged: mps_dynamics_rollback or mps_dynamics_restore recovers "
                   "it, mps_dynamics_restart begins a new one");
}

mps_status mpsi_dynamics_ready(mps_dynamics *dynamics, const char *function) {
  MPSI_TRY(mpsi_guard_check(&dynamics->guard, dynamics->context, function));
  MPSI_TRY(mpsi_dynamics_check_diverged(dynamics, function));
  MPSI_TRY(prepare_run(dynamics, function));
  return mpsi_dynamics_choose_dt(dynamics, function);
}

/* Steps between calls of the cancel hook. */
static int64_t prompt_steps(const mps_dynamics *dynamics) {
  const int32_t ranks = mps_domain_size(dynamics->domain);
  return PROMPT_WORK / (dynamics->whole / (ranks > 0 ? ranks : 1) + 1) + 1;
}

/* Equal steps of at most dt from `start` to `t_end`: their number and length. Where dt, or the
 * length of the last steps, fits to round-off, it is kept bit for bit. */
static double divide(const mps_dynamics *dynamics, double start, double t_end, int64_t *total) {
  const double dt = dynamics->dt, way = t_end - start, exact = way / dt;
  const double round_off = fmax(1e-9, 4.0 * DBL_EPSILON * (exact + fabs(t_end) / dt));
  *total = exact > round_off ? (int64_t)ceil(exact - round_off) : 0;
  const double length = *total > 0 ? way / (double)*total : dt;
  const double kept[2] = {dt, dynamics->length};
  for (int k = 0; k < 2; k++)
    if (fabs(kept[k] - length) * (double)*total <= round_off * dt) return kept[k];
  return length;
}

/* Equal steps to the end of a run, and about a hundred reports. */
static mps_status plan_run(const mps_dynamics *dynamics, const char *function, mpsi_march *m) {
  MPSI_TRY(mpsi_march_check(m, dynamics->context, function, dynamics->dt));
  m->length = divide(dynamics, m->start, m->t_end, &m->total);
  const int64_t part = m->total / 100 > 0 ? m->total / 100 : 1;
  if (part < m->prompt) m->prompt = part;
  return MPS_OK;
}

mps_status mpsi_dynamics_begin_march(void *solver, const char *function, mpsi_march *m) {
  mps_dynamics *dynamics = solver;
  mps_status status = mpsi_dynamics_ready(dynamics, function);
  if (status != MPS_OK) return status;
  m->prompt = prompt_steps(dynamics);
  m->length = dynamics->dt;
  if (mpsi_march_is_run(m)) status = plan_run(dynamics, function, m);
  if (status != MPS_OK) return status;
  mpsi_guard_enter(&dynamics->guard, dynamics->context, function); /* signals are evaluated */
  status = take_motion(dynamics, function, m->length);
  mpsi_guard_end(&dynamics->guard);
  if (status == MPS_OK && mpsi_march_is_run(m) && m->total == 0) {
    dynamics->base_time = m->t_end;
    dynamics->base_step = dynamics->steps;
  }
  return status;
}

/* As many as are left to the next callback. */
int64_t mpsi_dynamics_batch(const void *solver, const mpsi_march *m, int64_t most) {
  const int64_t n = m->every - m->done % m->every;
  return mpsi_march_is_run(m) && n < most ? n : most;
}

mps_status mpsi_dynamics_advance_march(void *solver, const char *function, mpsi_march *m,
                                       int64_t count) {
  mps_dynamics *dynamics = solver;
  const bool run = mpsi_march_is_run(m), shown = !run || m->calls || m->last;
  mps_status status = MPS_OK;
  if (m->callback) status = prepare_run(dynamics, function); /* it may have edited */
  if (status == MPS_OK) status = mpsi_dynamics_advance(dynamics, function, count, m->length, shown);
  if (run && m->last && status == MPS_OK) {
    dynamics->base_time = m->t_end; /* to the last bit */
    dynamics->base_step = dynamics->steps;
  }
  if (status == MPS_OK && m->calls) mpsi_dynamics_publish(dynamics);
  return status;
}

mps_status mpsi_dynamics_end_march(void *solver, const char *function, const mpsi_march *m,
                                   mps_status status) {
  mps_dynamics *dynamics = solver;
  if (status == MPS_OK || dynamics->steps > m->before) mpsi_dynamics_publish(dynamics);
  return status;
}
