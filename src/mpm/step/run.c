/* run.c - the size of the steps of WLS-MPM, and steps for the loop of all solvers
 * (solver/solver_base.h). SPDX-License-Identifier: BSD-3-Clause */
#include "mpm/base/march.h"
#include "mpm/base/mpm_solver.h"
#include "mpm/particles/mpm_particles.h"
#include "core/definition/digits.h"

mps_status mpsi_mpm_check_dt(void *solver, const char *function, double dt) {
  const mps_mpm *mpm = solver;
  const double limit = mpsi_mpm_limit(mpm);
  if (isnan(dt) || (dt >= MPSI_MPM_LEAST_DT && dt <= limit)) return MPS_OK;
  return mpsi_fail(mpm->context, function, MPS_ERROR_ARGUMENT,
                   "dt is %s s, must be %g s to the Courant limit of the present state, %g s, "
                   "or NaN for a step that follows the limit",
                   mpsi_outside(dt, MPSI_MPM_LEAST_DT, limit).text, MPSI_MPM_LEAST_DT, limit);
}

mps_status mpsi_mpm_begin_march(void *solver, const char *function, mpsi_march *m) {
  mps_mpm *mpm = solver;
  mpm->run.as_edited = mpsi_mpm_edit_state(&mpm->run);
  MPSI_TRY(mpsi_mpm_apply_edits(mpm, function));
  return mpsi_march_check(m, mpm->context, function, mpsi_mpm_dt(mpm));
}

/* Size (s) of the next step, at most to t_end. The last two steps are equal, because a very short
 * one has irregular forces. */
static double next_step(const mps_mpm *mpm, double t_end, bool *last) {
  const double dt = mpsi_mpm_dt(mpm), rest = t_end - mpm->run.time;
  *last = rest <= dt * (1.0 + 1e-9);
  if (*last) return rest;
  return rest < 2.0 * dt * (1.0 - 1e-9) ? 0.5 * rest : dt;
}

mps_status mpsi_mpm_advance_march(void *solver, const char *function, mpsi_march *m,
                                  int64_t count) {
  mps_mpm *mpm = solver;
  (void)count; /* 1 */
  const bool run = mpsi_march_is_run(m);
  const int64_t steps = mpm->run.steps;
  mps_status status = MPS_OK;
  if (m->called || mpm->run.edited) status = mpsi_mpm_apply_edits(mpm, function);
  if (status == MPS_OK)
    status = run ? mpsi_mpm_check_advance(mpm, function) : mpsi_mpm_check_bounded(mpm, function);
  if (status != MPS_OK) return status;
  const double dt = run ? next_step(mpm, m->t_end, &m->last) : mpsi_mpm_dt(mpm);
  status = mpsi_mpm_step_from_settling(mpm, function, dt);
  /* a refused step took no time; one in which a particle is lost is complete */
  if (run && m->last && mpm->run.steps > steps) mpm->run.time = m->t_end;
  return status;
}

mps_status mpsi_mpm_end_march(void *solver, const char *function, const mpsi_march *m,
                              mps_status status) {
  mpsi_run *run = &((mps_mpm *)solver)->run;
  if (status != MPS_OK && run->steps == m->before)
    mpsi_mpm_restore_edit_state(run, &run->as_edited);
  return status;
}

/* The hook is asked in each step of several ranks. */
bool mpsi_mpm_stopped(const void *solver) { return ((const mps_mpm *)solver)->partition->cancel; }
