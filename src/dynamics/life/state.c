/* state.c - the state of the explicit MPS solver (core/state.h): snapshots, rollback, checkpoints;
 * refresh.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "core/state/state.h"

#include "core/particles/particles_internal.h"
#include "dynamics/base/dynamics_solver.h"
#include "dynamics/life/change.h"
#include "dynamics/life/files.h"
#include "dynamics/life/state.h"
#include "io/checkpoint.h"
#include "dynamics/ranks/partition.h"
#include "dynamics/step/begin.h"
#include "dynamics/step/ground.h"
#include "dynamics/step/run.h"
#include "dynamics/step/step.h"

#include <string.h>

/* ---- prescribed degrees of freedom, dashpots ------------------------------------------------- */

enum { BOUND = 4 };

static int64_t count_bounds(const void *solver) { return ((const mps_dynamics *)solver)->bounds; }

/* The next in order of particles, then of components, the order of lists outside of the solver: so
 * the whole body's list is that of its parts in turn. The list itself has the component first. */
typedef struct walk {
  int64_t at[3], end[3];
} walk;

static walk begin_walk(const mps_dynamics *dynamics) {
  walk w = {{0}, {0}};
  int64_t k = 0;
  for (int c = 0; c < 3; c++) {
    w.at[c] = k;
    while (k < dynamics->bounds && dynamics->bound[k].component == c) k++;
    w.end[c] = k;
  }
  return w;
}

static mpsi_dynamics_bound *next_bound(const mps_dynamics *dynamics, walk *w) {
  int64_t *least = NULL;
  for (int c = 0; c < 3; c++)
    if (w->at[c] < w->end[c] &&
        (!least || dynamics->bound[w->at[c]].particle < dynamics->bound[*least].particle))
      least = &w->at[c];
  return least ? &dynamics->bound[(*least)++] : NULL;
}

static void get_bounds(const void *solver, void *values) {
  const mps_dynamics *dynamics = solver;
  double *row = values;
  walk w = begin_walk(dynamics);
  for (const mpsi_dynamics_bound *q; (q = next_bound(dynamics, &w)); row += BOUND) {
    const double of[BOUND] = {q->rest, q->at, q->before, q->force};
    memcpy(row, of, sizeof of);
  }
}

static void set_bounds(void *solver, int64_t rows, const void *values) {
  mps_dynamics *dynamics = solver;
  const double *row = values, *end = row + rows * BOUND;
  walk w = begin_walk(dynamics);
  for (mpsi_dynamics_bound *q; row < end && (q = next_bound(dynamics, &w)); row += BOUND)
    q->rest = row[0], q->at = row[1], q->before = row[2], q->force = row[3];
}

static int64_t count_dashpots(const void *solver) {
  return ((const mps_dynamics *)solver)->dashpots;
}

/* Backwards: in order of particles. */
static void get_dashpots(const void *solver, void *values) {
  const mps_dynamics *dynamics = solver;
  for (int64_t k = 0; k < dynamics->dashpots; k++)
    ((double *)values)[k] = dynamics->dashpot[dynamics->dashpots - 1 - k].force;
}

static void set_dashpots(void *solver, int64_t rows, const void *values) {
  mps_dynamics *dynamics = solver;
  for (int64_t k = 0; k < rows && k < dynamics->dashpots; k++)
    dynamics->dashpot[dynamics->dashpots - 1 - k].force = ((const double *)values)[k];
}

static const mpsi_state_table bounds_table = {MPSI_STATE_F64, BOUND, count_bounds,
                                              get_bounds,     NULL,  set_bounds};
static const mpsi_state_table dashpots_table = {MPSI_STATE_F64, 1,    count_dashpots,
                                                get_dashpots,   NULL, set_dashpots};

/* ---- the list -------------------------------------------------------------------------------- */

static void list_setting(mpsi_state *s, const mps_dynamics *dynamics) {
  const mps_dynamics_def *def = &dynamics->def;
  mpsi_state_agree_choice(s, "integrator", "mps_dynamics_integrator", def->integrator);
  mpsi_state_agree_choice(s, "rotation", "mps_dynamics_rotation", def->rotation);
  mpsi_state_agree_choice(s, "damping", "mps_dynamics_damping", def->damping);
  mpsi_state_agree_integer(s, "watch_damping", def->watch_damping);
  mpsi_state_agree_choice(s, "kernel", "mps_kernel_kind", mps_kernel_get_kind(dynamics->kernel));
  mpsi_state_agree_number(s, "radius_ratio", def->radius_ratio);
  mpsi_state_agree_number(s, "f1", def->f1);
  mpsi_state_agree_number(s, "f2", def->f2);
  mpsi_state_agree_number(s, "period_x", isnan(def->period_x) ? 0.0 : def->period_x);
  mpsi_state_agree_number(s, "measure", def->measure);
  mpsi_state_agree_number(s, "torque", dynamics->torque);
  mpsi_state_agree_integer(s, "particles_made", mpsi_particles_made(dynamics->particles));
}

static void list_boundary(mpsi_state *s, mpsi_dynamics_boundary *b, int32_t number) {
  mpsi_state_enter(s, "boundary%d", (int)number);
  mpsi_state_agree_choice(s, "kind", "mps_boundary_kind", b->kind);
  mpsi_state_agree_integer(s, "dofs", b->dofs);
  mpsi_state_i64(s, "particles", &b->part.count, 1);
  mpsi_state_exact(s, "pushed", b->pushed, 3);
  mpsi_state_exact(s, "impulse", b->impulse, 3);
  mpsi_state_exact(s, "work", &b->work, 1);
  mpsi_state_f64(s, "kick", &b->kick, 1);
  mpsi_state_leave(s);
}

static void list_state(mpsi_state *s, void *solver) {
  mps_dynamics *dynamics = solver;
  list_setting(s, dynamics);
  int64_t boundaries = 0;
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    boundaries += mpsi_dynamics_boundary_of(dynamics, k) != NULL;
  mpsi_state_agree_integer(s, "boundaries", boundaries);
  for (int32_t k = 0; k < mpsi_dynamics_boundary_count(dynamics); k++)
    if (mpsi_dynamics_boundary_of(dynamics, k))
      list_boundary(s, mpsi_dynamics_boundary_of(dynamics, k), k);
  mpsi_state_f64(s, "dt", &dynamics->dt, 1);
  mpsi_state_f64(s, "length", &dynamics->length, 1);
  mpsi_state_f64(s, "kept", &dynamics->kept, 1);
  mpsi_state_f64(s, "lag", &dynamics->lag, 1);
  mpsi_state_f64(s, "base_time", &dynamics->base_time, 1);
  mpsi_state_i64(s, "base_step", &dynamics->base_step, 1);
  mpsi_state_i64(s, "steps", &dynamics->steps, 1);
  mpsi_state_bool(s, "fresh", &dynamics->fresh);
  mpsi_state_bool(s, "diverged", &dynamics->diverged);
  mpsi_state_bool(s, "begun", &dynamics->begun);
  mpsi_state_bool(s, "no_rate", &dynamics->no_rate);
  mpsi_state_exact(s, "work_loads", &dynamics->works.loads, 1);
  mpsi_state_exact(s, "work_boundaries", &dynamics->works.boundaries, 1);
  mpsi_state_exact(s, "work_damping", &dynamics->works.damping, 1);
  mpsi_state_f64(s, "energy_start", &dynamics->works.start, 1);
  mpsi_state_add_table(s, "held_values", &bounds_table);
  mpsi_state_add_table(s, "dashpot_forces", &dashpots_table);
}

static void bind(void *solver) {
  mps_dynamics *dynamics = solver;
  mpsi_dynamics_bind(dynamics);
  if (!dynamics->change) return;
  mpsi_dynamics_use_change(dynamics);
  mpsi_dynamics_drop_change(dynamics);
}

/* Quantities that follow from the state. */
static void after(void *solver) {
  mps_dynamics *dynamics = solver;
  const mpsi_dynamics_state *s = &dynamics->state;
  if (mpsi_dynamics_set_coefficients(dynamics)) {
    mpsi_dynamics_renew_dashpots(dynamics);
    dynamics->forces_stale = true; /* masses may be others */
    dynamics->have_limit = false;
  }
  dynamics->unread = false;
  dynamics->rewritten = dynamics->broken = NULL;
  dynamics->begins = false;
  dynamics->kernels->trig[dynamics->def.rotation](s, 0, dynamics->count);
  for (int64_t k = 0; k < dynamics->bounds; k++) {
    mpsi_dynamics_bound *q = &dynamics->bound[k];
    q->c = s->c[q->particle];
    q->s = s->s[q->particle];
  }
  dynamics->checked = dynamics->chosen = !isnan(dynamics->dt); /* steps of it have been taken */
}

static mps_status agree_to_restore(void *solver, const char *function, mps_status status) {
  return mpsi_domain_agree(((mps_dynamics *)solver)->domain, function, status);
}

static mpsi_state_of state_of(mps_dynamics *dynamics) {
  return (mpsi_state_of){.solver = dynamics,
                         .name = "explicit dynamics",
                         .context = dynamics->context,
                         .particles = dynamics->particles,
                         .identity = &dynamics->identity,
                         .list = list_state,
                         .prepare = mpsi_dynamics_prepare_state,
                         .settle = agree_to_restore,
                         .take_share = mpsi_dynamics_take_values,
                         .bind = bind,
                         .after = after,
                         .time = mpsi_dynamics_time(dynamics),
                         .dt = isnan(dynamics->dt) ? 0.0 : dynamics->dt,
                         .steps = dynamics->steps};
}

/* ---- what the caller does -------------------------------------------------------------------- */

/* A state is kept not of a run that has diverged, and of a set without an open edit. */
mps_status mpsi_dynamics_settle(void *solver, const char *function) {
  const mps_dynamics *dynamics = solver;
  MPSI_TRY(mpsi_dynamics_check_diverged(dynamics, function));
  return mpsi_particles_ready(dynamics->particles, function);
}

static mps_status take_in(void *solver, const char *function, mps_status status) {
  return mpsi_dynamics_read_edits(solver, function, status);
}

/* The state with the edited fields, once no error is possible. */
mpsi_state_of mpsi_dynamics_describe(void *solver) {
  mpsi_state_of of = state_of(solver);
  of.take_in = take_in;
  return of;
}

/* Quantities that follow from a state and lie on other ranks. */
static mps_status agree_on_restore(mps_dynamics *dynamics, const char *function,
                                   mps_status status) {
  double other = !dynamics->have_limit;
  if (status != MPS_OK || !mpsi_domain_many(dynamics->domain)) return status;
  status = mpsi_dynamics_join_coefficients(dynamics, function, MPS_OK);
  if (status == MPS_OK) status = mpsi_domain_max(dynamics->domain, function, 1, &other);
  if (other != 0.0) dynamics->have_limit = false;
  return status;
}

/* ---- the state before a step ---------------------------------------------------------------- */

static mps_status save_before(mps_dynamics *dynamics, const char *function,
                              mps_snapshot **snapshot) {
  const mpsi_state_of of = state_of(dynamics);
  return mpsi_state_snapshot(&of, function, snapshot);
}

/* The steps' own state: the choice of dt stays. Collective. */
static mps_status restore_before(mps_dynamics *dynamics, const char *function,
                                 const mps_snapshot *snapshot) {
  const mpsi_state_of of = state_of(dynamics);
  const bool checked = dynamics->checked, chosen = dynamics->chosen;
  const mps_status status =
      agree_on_restore(dynamics, function, mpsi_state_rollback(&of, function, snapshot));
  dynamics->checked = checked, dynamics->chosen = chosen;
  return status;
}

const mpsi_dynamics_keeper mpsi_dynamics_keep = {save_before, restore_before};

mps_status mpsi_dynamics_returned(void *solver, const char *function) {
  return agree_on_restore(solver, function, MPS_OK);
}

mps_status mpsi_dynamics_save(void *solver, const mpsi_state_of *of, const char *function,
                              const char *path, const mps_checkpoint *info) {
  return mpsi_domain_many(((mps_dynamics *)solver)->domain)
             ? mpsi_dynamics_save_partitions(solver, of, function, path, info)
             : mpsi_checkpoint_save(of, function, path, info);
}

/* ---- the step to come ------------------------------------------------------------------------ */

/* After a run that has diverged, accelerations may not be finite. */
static mps_status check_kept(mps_dynamics *dynamics, const char *function, const double *kept) {
  const int64_t n = dynamics->count;
  mps_status status = MPS_OK;
  for (int64_t k = 0; k < 3 * n && status == MPS_OK; k++) {
    if (isfinite(kept[k])) continue;
    const long long id = (long long)mpsi_particles_integers(dynamics->particles, "id")[k % n];
    status = mpsi_fail(dynamics->context, function, MPS_ERROR_DIVERGED,
                       "particle %lld would have acceleration (%g, %g) m/s2 and pressure %g Pa, "
                       "must be finite: the state has diverged; mps_dynamics_rollback recovers it",
                       id, kept[k % n], kept[n + k % n], kept[2 * n + k % n]);
    mpsi_fail_where(dynamics->context, dynamics->steps, id);
  }
  return mpsi_domain_agree(dynamics->domain, function, status);
}

/* Takes a step and restores the state, keeping the step's accelerations and pressures in `kept`. */
static mps_status look_ahead(mps_dynamics *dynamics, const char *function, double *kept) {
  const size_t bytes = (size_t)dynamics->count * sizeof(double);
  const mpsi_state_of of = state_of(dynamics);
  const double limit = dynamics->def.divergence;
  mpsi_state_prepared back;
  mps_status status = mpsi_domain_agree(dynamics->domain, function,
                                        mpsi_state_snapshot(&of, function, &dynamics->present));
  if (status == MPS_OK) /* copy of the state to restore; agreed upon by all ranks */
    status = mpsi_state_prepare_restore(&of, function, dynamics->present, &back);
  if (status != MPS_OK) return status;
  dynamics->def.divergence = INFINITY; /* that is for the step itself to find */
  mpsi_guard_enter(&dynamics->guard, dynamics->context, function);
  status = mpsi_dynamics_advance(dynamics, function, 1, dynamics->dt, true);
  mpsi_guard_end(&dynamics->guard);
  dynamics->def.divergence = limit;
  memcpy(kept, dynamics->state.ax, bytes);
  memcpy(kept + dynamics->count, dynamics->state.ay, bytes);
  memcpy(kept + 2 * dynamics->count, dynamics->state.p, bytes);
  mpsi_state_restore(&of, &back);
  const mps_status settled = agree_on_restore(dynamics, function, MPS_OK);
  if (status != MPS_OK && status != MPS_ERROR_DIVERGED) return status;
  return settled == MPS_OK ? check_kept(dynamics, function, kept) : settled;
}

mps_status mps_dynamics_refresh(mps_dynamics *dynamics) {
  if (!dynamics) return mpsi_null(__func__, "dynamics");
  mps_status status = mpsi_dynamics_ready(dynamics, __func__);
  if (status != MPS_OK) return status;
  double *kept = mpsi_alloc(dynamics->context, 3 * dynamics->count, sizeof *kept);
  if (dynamics->begins)
    status = mpsi_dynamics_begin(dynamics, __func__, mpsi_dynamics_time(dynamics));
  if (status == MPS_OK && !kept)
    status =
        mpsi_fail_memory(dynamics->context, __func__, (size_t)dynamics->count * 3 * sizeof *kept);
  status = mpsi_domain_agree(dynamics->domain, __func__, status);
  if (status == MPS_OK) status = look_ahead(dynamics, __func__, kept);
  const size_t bytes = (size_t)dynamics->count * sizeof(double);
  if (status == MPS_OK) {
    memcpy(dynamics->state.ax, kept, bytes);
    memcpy(dynamics->state.ay, kept + dynamics->count, bytes);
    memcpy(dynamics->state.p, kept + 2 * dynamics->count, bytes);
  }
  mpsi_free(dynamics->context, kept);
  return status;
}
