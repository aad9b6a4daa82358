/* solver.c - the public functions of all solvers (mps/solver.h) but step and run: questions, the
 * time step, conditions by number, states. SPDX-License-Identifier: BSD-3-Clause */
#include "linear.h"
#include "solver_base.h"
#include "histories.h"
#include "domain/domain_internal.h"
#include "domain/moment.h"
#include "io/checkpoint.h"

/* ---- life ------------------------------------------------------------------------------------ */

void mpsi_solver_start(mps_solver *s, const char *function, const mpsi_solver_kind *kind,
                       mps_context *context, mps_particles *particles, mps_domain *domain,
                       const mpsi_holder *holder) {
  s->kind = kind;
  s->conditions[MPSI_BOUNDARIES].kind = kind->boundary;
  s->conditions[MPSI_LOADS].kind = kind->load;
  s->context = mpsi_context_retain(context);
  s->particles = particles;
  s->domain = mpsi_domain_retain(domain);
  s->holder = *holder;
  s->holder.self = s;
  s->holder.guard = &s->guard;
  (void)mpsi_particles_hold(particles, function, &s->holder); /* which the caller has checked */
}

void mpsi_solver_end(mps_solver *s) {
  mps_context *context = s->context;
  mpsi_histories_leave(s);
  mpsi_linear_drop(s);
  mpsi_conditions_drop(s);
  s->kind->destroy(s);
  mpsi_state_forget(&s->identity);
  mpsi_particles_release(s->particles, &s->holder);
  mps_domain_destroy(&s->domain);
  mpsi_free(context, s);
  mpsi_context_release(context);
}

void mps_solver_destroy(mps_solver **solver) {
  if (!solver || !*solver) return;
  mps_solver *s = *solver;
  if (mpsi_guard_check(&s->guard, s->context, s->kind->name.destroy) != MPS_OK) return;
  *solver = NULL;
  mpsi_solver_end(s);
}

/* ---- questions ------------------------------------------------------------------------------- */

mps_particles *mps_solver_particles(const mps_solver *s) { return s ? s->particles : NULL; }
mps_context *mps_solver_context(const mps_solver *s) { return s ? s->context : NULL; }
double mps_solver_time(const mps_solver *s) { return s ? s->kind->time(s) : 0.0; }
int64_t mps_solver_steps(const mps_solver *s) { return s ? s->kind->steps(s) : 0; }
double mps_solver_limit(const mps_solver *s) { return s ? s->kind->limit(s) : 0.0; }
double mps_solver_dt(mps_solver *s) { return s ? s->kind->dt(s, s->kind->name.dt) : 0.0; }

mps_status mps_solver_set_dt(mps_solver *s, double dt) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.set_dt;
  mps_status status = mpsi_solver_enter_to_change(s, function);
  if (status != MPS_OK) return status;
  status =
      mpsi_domain_agree_same(s->domain, function, s->kind->check_dt(s, function, dt), "dt", dt);
  return status == MPS_OK ? s->kind->use_dt(s, function, dt) : status;
}

mps_status mps_solver_get_totals_sized(const mps_solver *s, mps_totals *out, size_t size) {
  if (!s) return mpsi_null(__func__, "solver");
  mps_totals totals = {.mass = 0.0};
  /* scratch and messages only: the state stays */
  MPSI_TRY(s->kind->get_totals((void *)s, s->kind->name.get_totals, &totals));
  return mpsi_out_write(s->context, s->kind->name.get_totals, out, size, &totals, sizeof totals);
}

mps_status mps_solver_get_def(const mps_solver *s, int32_t kind, void *out, size_t size) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.get_def;
  if (kind != s->kind->def_kind)
    return mpsi_fail(s->context, function, MPS_ERROR_ARGUMENT,
                     "kind is %s, that of this solver's definition is %s",
                     mpsi_name_of("mps_def_kind", kind).text,
                     mpsi_name_of("mps_def_kind", s->kind->def_kind).text);
  union {
    double align;
    char bytes[MPSI_STRUCT_MOST];
  } known;
  s->kind->get_def(s, &known);
  return mpsi_def_write(s->context, function, out, size, &known, mpsi_definition_of(kind)->size);
}

/* ---- the state ------------------------------------------------------------------------------- */

/* Before a state is kept: between two steps, also in the callback of a run. The guard is checked on
 * each rank alone, since a callback may run on one of them. */
static mps_status settle(mps_solver *s, const char *function, bool *began) {
  mps_status status = mpsi_guard_check_between(&s->guard, s->context, function);
  *began = status == MPS_OK;
  if (status != MPS_OK) return status;
  if (s->kind->settle) status = s->kind->settle(s, function);
  if (status == MPS_OK) status = mpsi_linear_forget(s, function);
  return mpsi_domain_agree(s->domain, function, status);
}

static mps_status settled(mps_solver *s, const char *function, bool began, mps_status status) {
  if (!began) return status;
  status = mpsi_domain_agree(s->domain, function, status);
  if (s->kind->settled) s->kind->settled(s, status);
  return status;
}

/* With the histories of the solver. */
static mpsi_state_of state_of(mps_solver *s) {
  mpsi_state_of of = s->kind->state(s);
  of.list_also = mpsi_histories_list_state;
  return of;
}

mps_status mps_solver_snapshot(mps_solver *s, mps_snapshot **snapshot) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.snapshot;
  bool began;
  mps_status status = settle(s, function, &began);
  if (status == MPS_OK) {
    const mpsi_state_of of = state_of(s);
    status = mpsi_state_snapshot(&of, function, snapshot);
  }
  return settled(s, function, began, status);
}

/* All ranks have the same where the kind has no `save`. */
static mps_status write_file(mps_solver *s, const char *function, const char *path,
                             const mps_checkpoint *info) {
  const mpsi_state_of of = state_of(s);
  if (s->kind->save) return s->kind->save(s, &of, function, path, info);
  if (mps_domain_rank(s->domain) > 0) return MPS_OK;
  return mpsi_checkpoint_save(&of, function, path, info);
}

mps_status mps_solver_save(mps_solver *s, const char *path, const mps_checkpoint *info) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.save;
  bool began;
  mps_status status = settle(s, function, &began);
  if (status == MPS_OK) status = write_file(s, function, path, info);
  return settled(s, function, began, status);
}

static mps_status returned(mps_solver *s, const char *function, mps_status status) {
  return status == MPS_OK && s->kind->returned ? s->kind->returned(s, function) : status;
}

/* The state to go back to: the caller's edits since are given up, not read. */
static mpsi_state_of former_state_of(mps_solver *s) {
  mpsi_state_of of = state_of(s);
  of.take_in = NULL;
  return of;
}

/* Before a former state returns. */
static mps_status leave_present(mps_solver *s, const char *function) {
  MPSI_TRY(s->kind->leave ? s->kind->leave(s, function) : MPS_OK);
  return mpsi_linear_forget(s, function);
}

mps_status mps_solver_rollback(mps_solver *s, const mps_snapshot *snapshot) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.rollback;
  MPSI_TRY(mpsi_solver_enter_to_change(s, function));
  mps_status status = leave_present(s, function);
  MPSI_TRY(mpsi_domain_agree_moment(s->domain, function, status, snapshot));
  const mpsi_state_of of = former_state_of(s);
  return returned(s, function, mpsi_state_rollback(&of, function, snapshot));
}

mps_status mps_solver_restore(mps_solver *s, const char *path, mps_checkpoint *info) {
  if (!s) return mpsi_null(__func__, "solver");
  const char *function = s->kind->name.restore;
  mps_status status = mpsi_solver_enter_to_change(s, function);
  if (status != MPS_OK) return status;
  if (s->kind->leave || s->linear)
    status = mpsi_domain_agree(s->domain, function, leave_present(s, function));
  if (status != MPS_OK) return status;
  const mpsi_state_of of = former_state_of(s);
  return returned(s, function, mpsi_checkpoint_restore(&of, function, path, info));
}
