/* restart.c - the state of a motion (core/state.h): snapshots, rollback, checkpoints.
 * SPDX-License-Identifier: BSD-3-Clause */
#include "elastic_private.h"

#include "core/state.h"
#include "io/checkpoint.h"

static void list_state(mpsi_state *s, void *solver) {
  mps_elastic *e = solver;
  mpsi_elastic_motion *m = e->motion;
  mpsi_ledger *l = &e->ledger;
  const int64_t all = e->n * e->dim;
  mpsi_state_agree_integer(s, "motion", m != NULL);
  mpsi_state_agree_number(s, "spacing", e->spacing);
  mpsi_state_agree_number(s, "measure", e->def.measure);
  mpsi_state_agree_integer(s, "fixed_particles", e->support_count);
  mpsi_state_f64(s, "displacement", e->displacement, all);
  mpsi_state_f64(s, "reaction", e->reaction, all);
  double *works[] = {&l->loads,        &l->boundaries, &l->inner,
                     &l->mass_damping, &l->kinetic,    &l->strain};
  static const char *const names[] = {"work_loads",   "work_boundaries", "work_inner",
                                      "mass_damping", "kinetic_start",   "strain_start"};
  for (int k = 0; k < 6; k++) mpsi_state_f64(s, names[k], works[k], 1);
  for (int32_t k = 0; k < e->boundary_count; k++) {
    if (!e->boundaries[k].used) continue;
    mpsi_state_enter(s, "boundary%d", k);
    mpsi_state_agree_integer(s, "particles", e->boundaries[k].count);
    mpsi_state_reaction(s, &e->boundaries[k].reaction);
    mpsi_state_leave(s);
  }
  if (!m) return;
  mpsi_state_agree_number(s, "alpha_m", m->alpha_m);
  mpsi_state_agree_number(s, "alpha_f", m->alpha_f);
  mpsi_state_agree_number(s, "beta", m->beta);
  mpsi_state_agree_number(s, "gamma", m->gamma);
  mpsi_state_agree_number(s, "mass_damping_coefficient", m->a0);
  mpsi_state_agree_number(s, "stiffness_damping_coefficient", m->a1);
  mpsi_state_f64(s, "time", &m->time, 1);
  mpsi_state_i64(s, "steps", &m->steps, 1);
  mpsi_state_f64(s, "velocity", m->velocity, all);
  mpsi_state_f64(s, "acceleration", m->acceleration, all);
  mpsi_state_f64(s, "force", m->force, all);
  mpsi_state_f64(s, "inner", m->inner, all);
  mpsi_state_f64(s, "held", m->held, all);
}

static mpsi_state_of state_of(mps_elastic *e) {
  return (mpsi_state_of){.solver = e,
                         .name = "implicit elasticity",
                         .context = e->context,
                         .particles = e->particles,
                         .identity = &e->identity,
                         .list = list_state,
                         .time = mps_elastic_time(e),
                         .dt = mps_elastic_dt(e),
                         .steps = mps_elastic_steps(e)};
}

/* Between steps, and to change the state not from a callback either. */
static mps_status check(mps_elastic *e, const char *function, bool changes) {
  mps_status status = mpsi_elastic_check_between(e, function);
  if (status == MPS_OK && changes) {
    status = mpsi_elastic_enter(e, function);
    if (status == MPS_OK) (void)mpsi_elastic_leave(e, status);
  }
  if (status == MPS_OK && !e->motion)
    status = mpsi_fail(e->context, function, MPS_ERROR_STATE,
                       "no motion under way: call mps_elastic_start first");
  return status;
}

mps_status mps_elastic_snapshot(mps_elastic *e, mps_snapshot **snapshot) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, false);
  return status == MPS_OK ? mpsi_state_snapshot(&of, __func__, snapshot) : status;
}

mps_status mps_elastic_rollback(mps_elastic *e, const mps_snapshot *snapshot) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, true);
  return status == MPS_OK ? mpsi_state_rollback(&of, __func__, snapshot) : status;
}

mps_status mps_elastic_save(mps_elastic *e, const char *path, const mps_checkpoint *info) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, false);
  return status == MPS_OK ? mpsi_checkpoint_save(&of, __func__, path, info) : status;
}

mps_status mps_elastic_restore(mps_elastic *e, const char *path, mps_checkpoint *info) {
  if (!e) return MPS_ERROR_ARGUMENT;
  const mpsi_state_of of = state_of(e);
  const mps_status status = check(e, __func__, true);
  return status == MPS_OK ? mpsi_checkpoint_restore(&of, __func__, path, info) : status;
}
